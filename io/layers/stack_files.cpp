// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/stack_files.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/pictures/picture_series.h"
#include "io/printer/printer_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_layer_bytes = std::uint64_t{256} << 20;
constexpr std::uint64_t most_missing = 1000;  // kept by name
constexpr std::uint64_t most_sheet_bytes = std::uint64_t{1} << 20;

std::string text_or_nothing(const JsonObject& object, std::string_view key) {
    return object.is_text(key) ? object.text(key) : std::string();
}

/// Or cannot be opened, which the reader of archives has words for.
bool begins_as_zip(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    char mark[2] = {};
    return !in || (in.read(mark, 2) && mark[0] == 'P' && mark[1] == 'K');
}

StackOrigin origin_in(const fs::path& folder) {
    const fs::path file = folder / job_file_name;
    if (!fs::is_regular_file(file)) return {};
    try {
        const JsonObject job = JsonObject::read(file);
        if (text_or_nothing(job, "format") != "voxtone-job") return {};
        const auto text = [&](std::string_view key) { return text_or_nothing(job, key); };
        return {text("model"), text("resins"), text("illuminant"), text("backing"),
                text("view"),  text("coat"),   text("enclose"),    {}};
    } catch (const Error& error) {
        StackOrigin none;  // a stack needs none
        none.fault = error.what();
        return none;
    }
}

/// Empty where it is no text of a sheet's size: then it says nothing of any resin.
std::optional<std::string> sheet_in(const fs::path& folder) {
    const fs::path file = folder / sheet_text_name;
    if (!fs::is_regular_file(file)) return std::nullopt;
    try {
        const auto bytes = read_whole_file(file, most_sheet_bytes);
        return std::string(bytes.begin(), bytes.end());
    } catch (const Error&) {
        return "";
    }
}

/// A folder in `folder` that holds numbered PNG files; empty: none.
fs::path inner_series(const fs::path& folder) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (!entry.is_directory()) continue;
        std::vector<std::string> files;
        for (const auto& file : fs::directory_iterator(entry.path())) files.push_back(file.path().filename().string());
        if (!find_series(files).names.empty()) found.push_back(entry.path());
    }
    return found.empty() ? fs::path() : *std::min_element(found.begin(), found.end());
}

/// Whether a link leads to something outside of a folder.
bool leads_out(const fs::path& link, const fs::path& folder) {
    std::error_code gone;
    const fs::path target = fs::canonical(link, gone), base = fs::canonical(folder.empty() ? "." : folder, gone);
    return std::mismatch(base.begin(), base.end(), target.begin(), target.end()).first != base.end();
}

/// PrusaSlicer's settings, which it puts into its archives for resin printers (SL1) beside the layers. Their bitmaps
/// lie as the panel wants them: landscape has the model's x along its columns and -y along its rows; in portrait
/// columns run along y and rows along x; display_mirror_x turns columns round, display_mirror_y rows. Its columns are
/// mirrored once more by the exchange, so that the mirror that is usual there, of x, leaves them along +y.
std::optional<Orientation> orientation_of_slicer(const fs::path& folder) {
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 20;
    std::map<std::string, std::string, std::less<>> said;
    for (const char* const name : {"config.ini", "prusaslicer.ini"}) {
        std::error_code none;
        if (!fs::is_regular_file(fs::symlink_status(folder / name, none))) continue;
        try {
            const auto bytes = read_whole_file(folder / name, most_bytes);
            std::istringstream text(std::string(bytes.begin(), bytes.end()));
            for (std::string line; std::getline(text, line);) {
                const std::size_t equals = line.find('=');
                if (equals == std::string::npos) continue;
                const auto trimmed = [](std::string_view part) {
                    const std::size_t begin = std::min(part.find_first_not_of(" \t\r"), part.size());
                    return std::string(part.substr(begin, part.find_last_not_of(" \t\r") + 1 - begin));
                };
                said[trimmed(std::string_view(line).substr(0, equals))] =
                    trimmed(std::string_view(line).substr(equals + 1));
            }
        } catch (const Error&) {  // it is of another program, and says nothing
        }
    }
    const auto turned = said.find("display_orientation");
    if (turned == said.end()) return std::nullopt;
    const bool portrait = turned->second == "portrait";
    const bool mirror_x = said["display_mirror_x"] == "1", mirror_y = said["display_mirror_y"] == "1";
    return Orientation{mirror_x, portrait != mirror_y, portrait};
}

/// What lies in the place of a layer, before it is opened: a pipe would be waited for. Of links those within the stack
/// are followed; what is outside is no business of this program (stack_reader.h).
void expect_layer_file(const fs::path& root, const std::string& name) {
    std::error_code error;
    const fs::file_type type = fs::status(root / name, error).type();
    std::error_code no_link;
    if (fs::is_symlink(root / name, no_link)) {
        if (type == fs::file_type::not_found || error == std::errc::too_many_symbolic_link_levels)
            throw InputError(name + ": is a link that leads nowhere: put the file itself there");
        if (leads_out(root / name, root))
            throw InputError(name + ": is a link out of the stack, which is not followed: put the file itself there");
    }
    const char* const what = type == fs::file_type::directory   ? "folder"
                             : type == fs::file_type::fifo      ? "pipe"
                             : type == fs::file_type::socket    ? "socket"
                             : type == fs::file_type::character ? "device"
                             : type == fs::file_type::block     ? "device"
                                                                : nullptr;
    if (what) throw InputError(fmt::format("{}: is a {}: put the layer's file there", name, what));
}

[[noreturn]] void refuse_no_layers(const fs::path& folder, const std::vector<std::string>& files) {
    if (fs::is_directory(folder / "layers"))
        throw InputError(
            fmt::format("{}: has a folder of layers and no {}, which says what their colours mean: copy the whole "
                        "stack, slice again, or name {} for bitmaps of another program",
                        folder.string(), manifest_name, (folder / "layers").string()));
    if (const std::string pictures = other_pictures(files); !pictures.empty())
        throw InputError(
            fmt::format("{}: holds no layer: its {} are no PNG; save them as PNG, one colour for each "
                        "resin",
                        folder.string(), pictures));
    if (const fs::path inner = inner_series(folder); !inner.empty())
        throw InputError(
            fmt::format("{}: holds no layer itself; name {}, which does", folder.string(), inner.string()));
    throw InputError(fmt::format("{}: holds no layer: expected numbered files like slice_00000.png", folder.string()));
}

}  // namespace

std::optional<SliceName> parse_slice_name(const std::string& file_name) {
    if (file_name.size() < 5) return std::nullopt;
    std::string extension = file_name.substr(file_name.size() - 4);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension != ".png" || file_name.front() == '.') return std::nullopt;
    const std::string base = file_name.substr(0, file_name.size() - 4);
    std::size_t begin = base.size();
    while (begin > 0 && base[begin - 1] >= '0' && base[begin - 1] <= '9') --begin;
    const std::size_t digits = base.size() - begin;
    if (digits == 0 || digits > 18) return std::nullopt;
    return SliceName{base.substr(0, begin), std::stoull(base.substr(begin)), static_cast<int>(digits)};
}

/// Slices of a folder by number, what is no file in their place among them: `bytes` says what it is. What is no slice
/// of the largest series is a stranger.
void StackFiles::list_folder(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    PictureSeries series = find_series(names);
    if (series.names.empty()) refuse_no_layers(folder, names);
    listing_.names = std::move(series.names);
    listing_.strangers = std::move(series.strangers);
    std::sort(listing_.strangers.begin(), listing_.strangers.end());
    listing_.orientation = orientation_of_slicer(folder);
}

void StackFiles::read_beside_manifest() {
    listing_.seal = seal_of_manifest(root_ / manifest_name);
    listing_.origin = origin_in(root_);
    listing_.sheet = sheet_in(root_);
}

void StackFiles::open_ours() {
    listing_.kind = StackKind::voxtone;
    if (!fs::is_regular_file(root_ / manifest_name))
        throw InputError(
            fmt::format("{}: is no file; copy the whole stack, or slice again", (root_ / manifest_name).string()));
    listing_.description = read_manifest(root_ / manifest_name);
    read_beside_manifest();
    list_ours();
}

/// What was copied to the printer's computer: its page has the manifest of the layers beside it.
void StackFiles::open_for_printer() {
    if (fs::exists(root_ / gcvf_name) && !fs::exists(root_ / layers_name)) {
        root_ /= gcvf_name;
        return open_gcvf();
    }
    if (!fs::exists(root_ / layers_name))
        throw InputError(
            fmt::format("{}: has bitmaps of single resins, which are not looked into: verify the folder "
                        "that the job made, of which this is a part",
                        root_.string()));
    read_page(read_whole_file(root_ / how_to_print_name, most_how_to_print_bytes));
    for (const auto& entry : fs::directory_iterator(root_))
        if (const std::string name = entry.path().filename().string();
            name != how_to_print_name && name != layers_name && name != gcvf_name && name != resin_folder_name)
            listing_.strangers.push_back(name);
    list_ours();
}

/// The page of how to print, with the manifest in it.
void StackFiles::read_page(const std::vector<std::uint8_t>& bytes) {
    const std::string source = (root_ / how_to_print_name).string();
    const auto manifest = manifest_in_page({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!manifest)
        throw InputError(
            fmt::format("{}: does not say what the colours of the layers mean, as it was changed: copy it "
                        "again, or name {} for bitmaps without a manifest",
                        source, (root_ / layers_name).string()));
    listing_.kind = StackKind::voxtone;
    listing_.description = parse_manifest(*manifest, source);
    listing_.seal = seal_of_manifest_text(*manifest, source);
}

/// An entry of the archive, or what is missing of it.
void StackFiles::take_layer(const std::string& name, std::map<std::string, std::size_t>& index) {
    const auto found = index.find(name);
    if (found == index.end()) return add_missing(name);
    listing_.names.push_back(name);
    entries_.push_back(found->second);
    index.erase(found);
}

/// The same as `open_for_printer`, packed as ZIP. `index`: its entries.
void StackFiles::open_packed(std::map<std::string, std::size_t> index) {
    const auto page = index.find(std::string(how_to_print_name));
    read_page(zip_->read(page->second, most_how_to_print_bytes));
    index.erase(page);
    for (std::uint32_t k = 0; k < listing_.description->layers; ++k) {
        take_layer(listing_.description->layer_path(k), index);
    }
    if (listing_.names.empty())
        throw InputError(
            fmt::format("{}: is a printer's folder packed as ZIP, without {}: unpack it, and name the "
                        "folder",
                        root_.string(), layers_name));
    for (const auto& [name, i] : index)
        if (!name.ends_with('/') && !name.starts_with(std::string(resin_folder_name) + "/") && name != gcvf_name)
            listing_.strangers.push_back(name);
}

/// The layers that the manifest announces.
void StackFiles::list_ours() {
    const fs::path folder = (root_ / listing_.description->layer_path(0)).parent_path();
    // The manifest says which layers there are; the folder, what else lies there.
    const fs::path inner = fs::path(listing_.description->layer_path(0)).parent_path();
    const std::string prefix = inner.empty() ? std::string() : inner.string() + "/";
    std::set<std::string> there;
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder)) there.insert(entry.path().filename().string());
    for (std::uint32_t k = 0; k < listing_.description->layers; ++k) {
        const std::string name = listing_.description->layer_path(k);
        if (there.erase(fs::path(name).filename().string()))
            listing_.names.push_back(name);
        else
            add_missing(name);
    }
    for (const auto& name : there)
        if (!prefix.empty() || parse_slice_name(name)) listing_.strangers.push_back(prefix + name);
    std::sort(listing_.strangers.begin(), listing_.strangers.end());
}

void StackFiles::add_missing(const std::string& name) {
    if (++listing_.missing_count <= most_missing) listing_.missing.push_back(name);
}

void StackFiles::open_gcvf() {
    listing_.kind = StackKind::gcvf;
    if (!begins_as_zip(root_))
        throw InputError(
            fmt::format("{}: is no layer stack, neither a folder of layers nor a GCVF container; a model or a picture "
                        "becomes one with `voxtone slice`",
                        root_.string()));
    zip_ = std::make_unique<ZipReader>(root_);
    std::map<std::string, std::size_t> index;
    for (std::size_t i = 0; i < zip_->names().size(); ++i) index.emplace(zip_->names()[i], i);
    const auto config_entry = index.find("ConfigFile.xml");
    if (config_entry == index.end() && index.contains(std::string(how_to_print_name)))
        return open_packed(std::move(index));
    if (config_entry == index.end() && index.contains("config.ini"))
        throw InputError(fmt::format(
            "{}: is an archive of layers of a slicer for resin printers (SL1): unpack it, and name the folder",
            root_.string()));
    if (config_entry == index.end())
        throw InputError(fmt::format("{}: has no ConfigFile.xml at its root: it is no GCVF container", root_.string()));
    const auto xml = zip_->read(config_entry->second, 16 << 20);
    listing_.gcvf =
        parse_gcvf_config({reinterpret_cast<const char*>(xml.data()), xml.size()}, root_.string() + ": ConfigFile.xml");
    index.erase(config_entry);
    for (std::size_t part = 0; part < preview_names.size(); ++part)
        if (const auto found = index.find(std::string(preview_names[part])); found != index.end()) {
            listing_.preview_bytes[part] = zip_->size(found->second);
            index.erase(found);
        }
    if (const auto found = index.find(std::string(zbuffer_name)); found != index.end()) {
        zbuffer_entry_ = found->second;
        listing_.has_zbuffer = true;
        index.erase(found);
    }
    for (std::uint32_t k = 0; k < listing_.gcvf->slices; ++k) {
        take_layer(fmt::format("{}{}.png", listing_.gcvf->prefix, std::uint64_t{listing_.gcvf->start_index} + k),
                   index);
    }
    for (const auto& [name, i] : index) listing_.strangers.push_back(name);
}

StackFiles::StackFiles(const fs::path& path) : root_(path) {
    try {
        if (!fs::exists(path)) throw FileError(fmt::format("{}: is not there", path.string()));
        if (!fs::is_directory(path)) {
            if (path.filename() == fs::path(manifest_name)) {
                root_ = path.parent_path();
                open_ours();
            } else {
                open_gcvf();
            }
        } else if (fs::exists(path / manifest_name)) {
            open_ours();
        } else if (fs::exists(path / how_to_print_name)) {
            open_for_printer();
        } else if (fs::exists(path / unfinished_name) || fs::exists(path / new_name)) {
            throw InputError(
                fmt::format("{}: is a stack that is being made, or whose making was stopped: it is not whole; slice "
                            "again, which says which of the two it is",
                            path.string()));
        } else {
            list_folder(path);
        }
    } catch (const fs::filesystem_error& error) {
        throw FileError(fmt::format("{}: cannot be read ({})", path.string(), error.what()));
    }
}

std::vector<std::uint8_t> StackFiles::bytes(std::uint32_t index) const {
    if (zip_) return zip_->read(entries_.at(index), most_layer_bytes);
    const std::string& name = listing_.names.at(index);
    expect_layer_file(root_, name);
    return read_whole_file(root_ / name, most_layer_bytes);
}

std::vector<std::uint8_t> StackFiles::zbuffer_bytes() const {
    return zip_->read(zbuffer_entry_.value(), most_layer_bytes);
}

}  // namespace voxtone::io
