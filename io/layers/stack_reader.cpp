// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layers/stack_reader.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/files/zip_reader.h"
#include "voxtone/io/layers/stack_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_layer_bytes = std::uint64_t{256} << 20;
constexpr std::uint64_t most_layers = 1'000'000;
constexpr std::uint64_t most_missing = 1000;  // kept by name

std::uint32_t word(const Rgba& c) {
    return std::uint32_t{c[0]} << 24 | std::uint32_t{c[1]} << 16 | std::uint32_t{c[2]} << 8 | c[3];
}

}  // namespace

LayerScan scan_layer(std::span<const std::uint8_t> file, const std::string& source, std::span<const Rgb> palette) {
    LayerScan scan;
    const PngHeader claimed = read_png_header(file, source);
    if (!palette.empty()) scan.runs.emplace(claimed.width_px, claimed.height_px);
    std::map<std::uint32_t, std::size_t> place;  // colour -> index into scan.colours
    std::map<std::uint32_t, Material> material;
    for (std::size_t m = palette.size(); m-- > 0;)
        material[word({palette[m][0], palette[m][1], palette[m][2], 255})] = static_cast<Material>(m);

    // What is known of the colour of the run before: halftones change between few colours, so a small memory of them
    // pays.
    struct Known {
        std::uint32_t colour = 0;
        std::size_t place = 0;
        int material = -1;
        bool set = false;
    };
    std::array<Known, 16> memory;
    scan.header = read_png(file, source, [&](std::uint32_t y, std::span<const std::uint8_t> rgba) {
        const auto width = static_cast<std::uint32_t>(rgba.size() / 4);
        for (std::uint32_t x = 0; x < width;) {
            const std::uint8_t* const first = rgba.data() + std::size_t{4} * x;
            std::uint32_t end = x + 1;
            while (end < width && std::memcmp(rgba.data() + std::size_t{4} * end, first, 4) == 0) ++end;
            const Rgba colour = {first[0], first[1], first[2], first[3]};
            const std::uint32_t w = word(colour);
            Known& known = memory[(w * 0x9E3779B1u) >> 28];
            if (!known.set || known.colour != w) {
                known = {w, LayerScan::most_colours, -1, true};
                if (const auto found = material.find(w); found != material.end()) known.material = found->second;
                if (const auto found = place.find(w); found != place.end()) {
                    known.place = found->second;
                } else if (scan.colours.size() < LayerScan::most_colours) {
                    known.place = place[w] = scan.colours.size();
                    scan.colours.push_back({colour, 0, x, y});
                }
            }
            if (known.place < LayerScan::most_colours)
                scan.colours[known.place].pixels += end - x;
            else
                scan.other_pixels += end - x;
            if (known.material < 0)
                scan.runs.reset();
            else if (scan.runs)
                scan.runs->push(end - x, static_cast<Material>(known.material));
            x = end;
        }
        if (scan.runs) scan.runs->end_row();
    });
    return scan;
}

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

struct StackReader::State {
    Kind kind = Kind::folder;
    fs::path root;
    std::optional<StackDescription> description;
    std::optional<GcvfConfig> config;
    std::unique_ptr<ZipReader> zip;
    std::vector<std::string> names;    // of layers, bottom first
    std::vector<std::size_t> entries;  // of a container, per layer
    std::vector<std::string> strangers, missing;
    std::uint64_t missing_count = 0;

    /// Slices of a folder by number; what is no slice of the most frequent stem is a stranger.
    void list_folder(const fs::path& folder, const std::string& prefix) {
        std::map<std::string, std::vector<std::pair<std::uint64_t, std::string>>> stems;
        std::vector<std::string> others;
        for (const auto& entry : fs::directory_iterator(folder)) {
            const std::string name = entry.path().filename().string();
            const auto slice = entry.is_regular_file() ? parse_slice_name(name) : std::nullopt;
            if (slice && slice->number < most_layers)
                stems[slice->stem].push_back({slice->number, name});
            else
                others.push_back(name);
        }
        if (stems.empty())
            throw InputError(fmt::format("{}: holds no layer: expected files like slice_00000.png", folder.string()));
        auto most = std::max_element(stems.begin(), stems.end(),
                                     [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
        std::sort(most->second.begin(), most->second.end());
        for (const auto& [number, name] : most->second) names.push_back(prefix + name);
        for (const auto& [stem, slices] : stems)
            if (stem != most->first)
                for (const auto& slice : slices) others.push_back(slice.second);
        std::sort(others.begin(), others.end());
        for (const auto& name : others) strangers.push_back(prefix + name);
    }
    void open_ours() {
        kind = Kind::voxtone;
        description = read_manifest(root / manifest_name);
        const fs::path folder = (root / description->layer_path(0)).parent_path();
        if (!fs::is_directory(folder))
            throw InputError(fmt::format("{}: the folder with the layers is not there", folder.string()));
        // The manifest says which layers there are; the folder, what else lies there.
        const fs::path inner = fs::path(description->layer_path(0)).parent_path();
        const std::string prefix = inner.empty() ? std::string() : inner.string() + "/";
        std::set<std::string> there;
        for (const auto& entry : fs::directory_iterator(folder)) {
            const std::string name = entry.path().filename().string();
            if (entry.is_regular_file())
                there.insert(name);
            else if (!prefix.empty())
                strangers.push_back(prefix + name);
        }
        for (std::uint32_t k = 0; k < description->layers; ++k) {
            const std::string name = description->layer_path(k);
            if (there.erase(fs::path(name).filename().string()))
                names.push_back(name);
            else
                add_missing(name);
        }
        for (const auto& name : there)
            if (!prefix.empty() || parse_slice_name(name)) strangers.push_back(prefix + name);
        std::sort(strangers.begin(), strangers.end());
        if (names.empty())
            throw InputError(fmt::format("{}: holds none of the layers that the manifest names", folder.string()));
    }
    void add_missing(const std::string& name) {
        if (++missing_count <= most_missing) missing.push_back(name);
    }
    void open_gcvf() {
        kind = Kind::gcvf;
        zip = std::make_unique<ZipReader>(root);
        std::map<std::string, std::size_t> index;
        for (std::size_t i = 0; i < zip->names().size(); ++i) index.emplace(zip->names()[i], i);
        const auto config_entry = index.find("ConfigFile.xml");
        if (config_entry == index.end())
            throw InputError(
                fmt::format("{}: has no ConfigFile.xml at its root: it is no GCVF container", root.string()));
        const auto xml = zip->read(config_entry->second, 16 << 20);
        config = parse_gcvf_config({reinterpret_cast<const char*>(xml.data()), xml.size()},
                                   root.string() + ": ConfigFile.xml");
        index.erase(config_entry);
        index.erase("Mesh.stl");
        index.erase("MeshBbx.ktn");
        for (std::uint32_t k = 0; k < config->slices; ++k) {
            const std::string name = fmt::format("{}{}.png", config->prefix, std::uint64_t{config->start_index} + k);
            if (const auto found = index.find(name); found != index.end()) {
                names.push_back(name);
                entries.push_back(found->second);
                index.erase(found);
            } else {
                add_missing(name);
            }
        }
        for (const auto& [name, i] : index) strangers.push_back(name);
        if (names.empty())
            throw InputError(fmt::format("{}: holds none of the layers that ConfigFile.xml names", root.string()));
    }
};

StackReader::StackReader(const fs::path& path) : state_(std::make_unique<State>()) {
    state_->root = path;
    try {
        if (!fs::exists(path)) throw FileError(fmt::format("{}: is not there", path.string()));
        if (!fs::is_directory(path)) {
            if (path.filename() == fs::path(manifest_name)) {
                state_->root = path.parent_path();
                state_->open_ours();
            } else {
                state_->open_gcvf();
            }
        } else if (fs::exists(path / manifest_name)) {
            state_->open_ours();
        } else if (fs::exists(path / unfinished_name)) {
            throw InputError(
                fmt::format("{}: is a stack whose making was stopped: it is not whole; slice again", path.string()));
        } else {
            state_->list_folder(path, "");
        }
    } catch (const fs::filesystem_error& error) {
        throw FileError(fmt::format("{}: cannot be read ({})", path.string(), error.what()));
    }
}

StackReader::~StackReader() = default;
StackReader::StackReader(StackReader&&) noexcept = default;
StackReader& StackReader::operator=(StackReader&&) noexcept = default;

StackReader::Kind StackReader::kind() const { return state_->kind; }
const std::optional<StackDescription>& StackReader::description() const { return state_->description; }
const std::optional<GcvfConfig>& StackReader::gcvf() const { return state_->config; }
std::uint32_t StackReader::layers() const { return static_cast<std::uint32_t>(state_->names.size()); }
const std::string& StackReader::layer_name(std::uint32_t index) const { return state_->names.at(index); }
const std::vector<std::string>& StackReader::strangers() const { return state_->strangers; }
const std::vector<std::string>& StackReader::missing() const { return state_->missing; }
std::uint64_t StackReader::missing_count() const { return state_->missing_count; }

std::vector<std::uint8_t> StackReader::bytes(std::uint32_t index) const {
    if (state_->zip) return state_->zip->read(state_->entries.at(index), most_layer_bytes);
    return read_whole_file(state_->root / state_->names.at(index), most_layer_bytes);
}

LayerRuns StackReader::read(std::uint32_t index, std::span<const Rgb> palette) const {
    const std::string& name = layer_name(index);
    auto scan = scan_layer(bytes(index), name, palette);
    if (scan.runs) return std::move(*scan.runs);
    for (const auto& colour : scan.colours) {
        const bool known = std::any_of(palette.begin(), palette.end(), [&](const Rgb& c) {
            return Rgba{c[0], c[1], c[2], 255} == colour.rgba;
        });
        if (!known)
            throw InputError(fmt::format(
                "{}: pixel ({}, {}) has the colour {} {} {} with alpha {}, which stands for no resin", name,
                colour.first_x, colour.first_y, colour.rgba[0], colour.rgba[1], colour.rgba[2], colour.rgba[3]));
    }
    throw InputError(
        fmt::format("{}: has more than {} colours; a layer has one per resin", name, LayerScan::most_colours));
}

std::vector<Rgb> StackReader::palette() const {
    if (state_->description) return state_->description->palette();
    std::vector<Rgb> result;
    if (state_->config) {
        const auto& b = state_->config->background;
        result.push_back({b[0], b[1], b[2]});
        for (const auto& m : state_->config->materials) result.push_back({m.rgba[0], m.rgba[1], m.rgba[2]});
    } else {
        std::vector<std::vector<Rgb>> found(layers());
        parallel_for(0, layers(), 1, [&](std::size_t k) {
            const auto index = static_cast<std::uint32_t>(k);
            for (const auto& colour : scan_layer(bytes(index), layer_name(index), {}).colours)
                found[k].push_back({colour.rgba[0], colour.rgba[1], colour.rgba[2]});
        });
        result.push_back({0, 0, 0});
        for (const auto& colours : found)
            for (const auto& colour : colours)
                if (std::find(result.begin(), result.end(), colour) == result.end()) {
                    if (result.size() >= max_materials)
                        throw InputError(
                            fmt::format("{}: its layers have more than {} colours; a stack has one per resin",
                                        state_->root.string(), max_materials));
                    result.push_back(colour);
                }
    }
    if (result.size() > max_materials)
        throw InputError(fmt::format("{}: names {} materials, more than the {} that a stack can have",
                                     state_->root.string(), result.size() - 1, max_materials - 1));
    return result;
}

}  // namespace voxtone::io
