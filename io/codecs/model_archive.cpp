// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/model_archive.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/printable.h"
#include "io/models/foreign_kind.h"
#include "io/models/model_reader.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_parts = 100'000;

/// From the root, with slashes, without "." and doubled slashes; ".." stays.
std::string slashed(std::string_view entry) {
    std::string path, step;
    const auto close = [&] {
        if (!step.empty() && step != ".") path += (path.empty() ? "" : "/") + step;
        step.clear();
    };
    for (const char c : entry)
        if (c == '/' || c == '\\')
            close();
        else
            step += c;
    close();
    return path;
}

bool leads_out(std::string_view path) {
    return path == ".." || path.starts_with("../") || path.ends_with("/..") || path.find("/../") != path.npos;
}

/// What systems add on their own, and what is hidden.
bool is_left_aside(std::string_view path) {
    if (path.starts_with("__MACOSX/") || path.starts_with('.') || path.find("/.") != path.npos ||
        path.find("/__MACOSX/") != path.npos)
        return true;
    const std::string file = lower_case(path.substr(path.rfind('/') + 1));
    return file == "thumbs.db" || file == "desktop.ini";
}

std::string key_of(const fs::path& path) { return slashed(path.lexically_normal().generic_string()); }

std::string stem_of_part(const std::string& path) { return lower_case(fs::path(path).stem().string()); }

/// Licences and the like, which are beside every model.
bool is_read_by_people(const std::string& path) {
    static constexpr std::array<std::string_view, 8> endings{"txt", "md", "pdf", "html", "htm", "rtf", "url", "docx"};
    return std::ranges::find(endings, extension_of(path)) != endings.end();
}

/// "'a', 'b' and 3 more"
std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t most = 6;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
        text += fmt::format("{}'{}'", i > 0 ? ", " : "", printable(names[i]));
    if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
    return text;
}

}  // namespace

ModelArchive::ModelArchive(const fs::path& file, const std::string& inner, const ReadOptions& options)
    : name_(file.filename().string()),
      most_bytes_(options.max_unpacked_bytes),
      left_bytes_(options.max_unpacked_bytes) {
    archives_.push_back(std::make_unique<ZipReader>(file, ZipLimits{.part_bytes = most_bytes_}));
    add_parts("");
    open_inner_archive(inner);
    for (const auto& [path, part] : parts_) files_.emplace_back(path);
    choose(inner);
}

/// Those of the last archive.
void ModelArchive::add_parts(const std::string& below) {
    const std::vector<std::string>& names = archives_.back()->names();
    if (names.size() > most_parts)
        throw InputError(
            fmt::format("{} has {} parts, more than the {} of an archive that is looked through; pack the "
                        "model and its textures alone",
                        name_, names.size(), most_parts));
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string path = slashed(names[i]);
        if (leads_out(path))
            throw InputError(
                fmt::format("{} has a part '{}', whose path could lead out of the archive ('..'); it is "
                            "damaged or made to write over files: pack it again",
                            name_, printable(names[i])));
        const bool is_folder = names[i].ends_with('/') || names[i].ends_with('\\');
        if (!is_folder && !path.empty() && !is_left_aside(path))
            parts_.emplace(below + path, Part{archives_.size() - 1, i});
    }
}

/// One that has the model in it, or is named.
void ModelArchive::open_inner_archive(const std::string& inner) {
    std::vector<std::string> archives = ending_as("zip");
    if (const std::string key = lower_case(key_of(inner)); !inner.empty())
        std::erase_if(archives,
                      [&](const std::string& path) { return !(key + "/").starts_with(lower_case(path) + "/"); });
    else if (!models().empty())
        return;
    if (archives.empty()) return;
    if (archives.size() > 1)
        throw InputError(
            fmt::format("{} holds no model itself, but {} archives ({}): name one of them behind it, as in "
                        "{}/{}, or unpack it and give one",
                        name_, archives.size(), some_of(archives), name_, printable(archives.front())));
    const std::string path = archives.front();
    inner_bytes_.push_back(read(path, most_bytes_));
    parts_.erase(path);
    archives_.push_back(
        std::make_unique<ZipReader>(inner_bytes_.back(), name_ + "/" + path, ZipLimits{.part_bytes = most_bytes_}));
    add_parts(path + "/");
}

std::vector<std::string> ModelArchive::models() const {
    std::vector<std::string> found;
    for (const auto& [path, part] : parts_)
        if (is_model_name(path) && extension_of(path) != "zip") found.push_back(path);
    return found;
}

std::vector<std::string> ModelArchive::ending_as(std::string_view extension) const {
    std::vector<std::string> found;
    for (const auto& [path, part] : parts_)
        if (extension_of(path) == extension) found.push_back(path);
    return found;
}

void ModelArchive::choose(const std::string& inner) {
    std::vector<std::string> all = models();
    const bool names_archive = extension_of(inner) == "zip";
    if (!inner.empty() && !names_archive) {
        model_ = meant_by(inner, all);
        if (const std::string path = model_.generic_string(); path != key_of(inner))
            notes_.push_back(fmt::format("of {} the model '{}' was taken", name_, printable(path)));
        return;
    }
    if (names_archive)
        std::erase_if(all, [below = lower_case(key_of(inner)) + "/"](const std::string& path) {
            return !lower_case(path).starts_with(below);
        });
    if (all.empty()) refuse_without_model();
    if (all.size() == 1) {
        model_ = all.front();
        notes_.push_back(fmt::format("of {} the model '{}' was taken", name_, printable(all.front())));
        return;
    }
    const std::string best = best_format(all);
    if (best.empty())
        throw InputError(
            fmt::format("{} holds {} models ({}): name the one that is meant behind it, as in {}/{}; several such "
                        "names come in one print",
                        name_, all.size(), some_of(all), name_, printable(all.front())));
    model_ = best;
    notes_.push_back(fmt::format(
        "of {}, which holds one model in {} formats, '{}' was taken; another is taken by its "
        "name behind the archive, as in {}/{}",
        name_, all.size(), printable(best), name_, printable(all.front() == best ? all.back() : all.front())));
}

/// By its path, in any case, or by its name alone where one is called so.
std::string ModelArchive::meant_by(const std::string& inner, const std::vector<std::string>& all) const {
    const std::string wanted = lower_case(key_of(inner));
    std::vector<std::string> by_path, by_name;
    for (const std::string& path : all) {
        if (path == key_of(inner)) return path;
        if (lower_case(path) == wanted) by_path.push_back(path);
        if (lower_case(path).ends_with("/" + wanted)) by_name.push_back(path);
    }
    if (by_path.size() == 1) return by_path.front();
    if (by_path.empty() && by_name.size() == 1) return by_name.front();
    if (all.empty()) refuse_without_model();
    throw InputError(fmt::format("{} holds no model '{}'; in it {} {}", name_, printable(inner),
                                 all.size() == 1 ? "is" : "are", some_of(all)));
}

/// Of one model that is there in several formats; empty: there are several models.
std::string ModelArchive::best_format(const std::vector<std::string>& all) const {
    static constexpr std::array<std::string_view, 10> best_first{"glb", "gltf", "3mf",  "obj", "fbx",
                                                                 "ply", "wrl",  "vrml", "wrz", "stl"};
    std::set<std::string> formats;
    for (const std::string& path : all)
        if (stem_of_part(path) != stem_of_part(all.front()) || !formats.insert(extension_of(path)).second) return {};
    for (const std::string_view format : best_first)
        for (const std::string& path : all)
            if (extension_of(path) == format) return path;
    return {};
}

void ModelArchive::refuse_without_model() const {
    std::vector<std::string> all;
    for (const auto& [path, part] : parts_) {
        all.push_back(path);
        if (extension_of(path) == "zip")
            throw InputError(
                fmt::format("{} holds an archive within an archive ('{}'), and only one within another is opened: "
                            "unpack it and give the one with the model",
                            name_, printable(path)));
        if (extension_of(path) == "model")
            throw InputError(
                fmt::format("{} is a 3MF model by what is in it, and models are known by their names: "
                            "rename it {}.3mf",
                            name_, fs::path(name_).stem().string()));
    }
    for (const std::string& path : all) {
        if (is_read_by_people(path) || is_picture_name(path)) continue;
        const std::string why = foreign_kind(printable(path), {}, 0, Wanted::model_or_picture);
        if (!why.empty()) throw InputError(fmt::format("{} holds no model that can be read: {}", name_, why));
    }
    throw InputError(fmt::format("{} holds no model ({}); in it {}", name_, model_name_endings,
                                 all.empty() ? "is nothing" : (all.size() == 1 ? "is " : "are ") + some_of(all)));
}

bool ModelArchive::exists(const fs::path& path) const {
    const std::string key = key_of(path);
    if (key.empty() || parts_.contains(key)) return true;
    const auto next = parts_.lower_bound(key + "/");
    return next != parts_.end() && next->first.starts_with(key + "/");
}

bool ModelArchive::is_file(const fs::path& path) const { return parts_.contains(key_of(path)); }

std::vector<fs::path> ModelArchive::entries(const fs::path& folder) const {
    const std::string key = key_of(folder), start = key.empty() ? "" : key + "/";
    std::set<std::string> names;
    for (auto part = parts_.lower_bound(start); part != parts_.end() && part->first.starts_with(start); ++part) {
        const std::string_view rest = std::string_view(part->first).substr(start.size());
        names.emplace(rest.substr(0, rest.find('/')));
    }
    std::vector<fs::path> found;
    for (const std::string& name : names) found.push_back(folder / name);
    return found;
}

std::vector<std::byte> ModelArchive::read(const fs::path& file, std::uint64_t max_bytes) const {
    const auto part = parts_.find(key_of(file));
    if (part == parts_.end()) throw FileError(fmt::format("{}: has no part '{}'", name_, file.generic_string()));
    const auto [archive, index] = part->second;
    const std::uint64_t size = archives_[archive]->size(index), most = std::min(left_bytes_, max_bytes);
    if (size > most)
        throw InputError(fmt::format("{}: part '{}' claims {} bytes, more than the {} that may be unpacked of it",
                                     name_, printable(part->first), size, most));
    std::vector<std::byte> bytes = archives_[archive]->read(index);
    left_bytes_ -= std::min<std::uint64_t>(left_bytes_, bytes.size());
    return bytes;
}

}  // namespace voxtone::io
