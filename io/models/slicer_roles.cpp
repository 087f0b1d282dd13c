// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/slicer_roles.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "io/files/xml_reader.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

std::optional<std::uint32_t> id_of(std::string_view text) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

SlicerRole role_of(std::string_view word) {
    const std::string name = lower_case(word);
    if (name.find("negative") != std::string::npos) return SlicerRole::negative;
    const bool is_part = name.empty() || name == "modelpart" || name == "normal_part";
    return is_part ? SlicerRole::part : SlicerRole::modifier;
}

/// "#RRGGBB", or with alpha behind.
std::optional<Eigen::Vector3f> filament_colour(std::string_view text) {
    text = trimmed(text);
    std::uint32_t code = 0;
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, code, 16);
    if (error != std::errc() || end != text.data() + 7) return std::nullopt;
    return Eigen::Vector3f(float(code >> 16), float(code >> 8 & 0xff), float(code & 0xff)) / 255;
}

using FilamentColours = std::vector<std::optional<Eigen::Vector3f>>;

/// Behind a key that stands alone, and not in a longer one; empty where there is none.
std::string_view behind_key(std::string_view text, std::string_view key) {
    const auto is_part = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
    for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
        const std::string_view behind = text.substr(at + key.size());
        if ((at == 0 || !is_part(text[at - 1])) && (behind.empty() || !is_part(behind.front()))) return behind;
    }
    return {};
}

/// The list of a key, up to the end of its line or of its brackets; an entry that is no colour is nothing.
FilamentColours colours_behind(std::string_view text, std::string_view key) {
    text = behind_key(text, key);
    text = text.substr(std::min(text.find_first_of("=:"), text.size()));
    const std::string_view list = trimmed(text.substr(std::min<std::size_t>(text.size(), 1)));
    text = list.starts_with('[') ? list.substr(0, list.find(']')) : text.substr(0, text.find_first_of("\r\n"));
    FilamentColours colours;
    while (!text.empty()) {
        text.remove_prefix(1);  // what stands before an entry
        const std::string_view entry = text.substr(0, text.find_first_of(";,"));
        const std::size_t mark = entry.find('#');
        colours.push_back(mark == entry.npos ? std::nullopt : filament_colour(entry.substr(mark, 7)));
        text.remove_prefix(entry.size());
    }
    return colours;
}

SlicerVolume of_run(const SlicerRoles::Run& run, const SlicerVolume& whole) {
    SlicerVolume volume = run.volume;
    if (volume.extruder == 0) volume.extruder = whole.extruder;
    return volume;
}

/// Divisions of a triangle. A digit's low two bits say how many sides are divided, 0: none; of a leaf the high two are
/// its state, 3: the next digit and 3. A node of n divided sides has n + 1 children.
class PaintReader {
public:
    PaintReader(std::string_view digits, std::vector<PaintNode>& nodes) : digits_(digits), nodes_(nodes) {}

    /// Adds a node and all below it; false where there is no such node.
    bool add(int depth = 0) {
        constexpr int deepest = 64;
        const auto digit = depth < deepest ? next() : std::nullopt;
        if (!digit) return false;
        PaintNode node{static_cast<std::uint8_t>(*digit & 3u), static_cast<std::uint8_t>((*digit >> 2) % 3), 0};
        if (node.sides == 0) {
            node.extruder = static_cast<std::uint16_t>(*digit >> 2);
            if (node.extruder == 3) {
                const auto more = next();
                if (!more) return false;
                node.extruder = static_cast<std::uint16_t>(node.extruder + *more);
            }
        }
        nodes_.push_back(node);
        for (int child = 0; child <= node.sides && node.sides > 0; ++child)
            if (!add(depth + 1)) return false;
        return true;
    }
    [[nodiscard]] bool is_read() const { return digits_.empty(); }

private:
    std::optional<unsigned> next() {
        if (digits_.empty()) return std::nullopt;
        const char c = digits_.back();
        digits_.remove_suffix(1);
        if (c >= '0' && c <= '9') return unsigned(c - '0');
        if (c >= 'A' && c <= 'F') return unsigned(c - 'A' + 10);
        if (c >= 'a' && c <= 'f') return unsigned(c - 'a' + 10);
        return std::nullopt;
    }

    std::string_view digits_;
    std::vector<PaintNode>& nodes_;
};

/// Adds the leaves' shares of a tree from node `at` on, children taken to be of one size; returns the node behind it.
std::size_t add_shares(const std::vector<PaintNode>& nodes, std::size_t at, double share,
                       std::map<std::uint16_t, double>& shares) {
    const PaintNode& node = nodes[at++];
    if (node.sides == 0) shares[node.extruder] += share;
    for (int child = 0; child <= node.sides && node.sides > 0; ++child)
        at = add_shares(nodes, at, share / (node.sides + 1), shares);
    return at;
}

}  // namespace

bool SlicerRoles::tells_colours() const {
    std::set<int> used;
    std::set<std::uint32_t> told;  // objects whose parts say it themselves
    for (const auto& [object, list] : runs) {
        const SlicerVolume whole = of(object, object);
        for (const Run& run : list)
            if (run.volume.role == SlicerRole::part) {
                used.insert(of_run(run, whole).extruder);
                told.insert(object);
            }
    }
    for (const auto& [ids, volume] : parts)
        if (volume.role == SlicerRole::part) {
            used.insert(of(ids.first, ids.second).extruder);
            told.insert(ids.first);
        }
    for (const auto& [object, of_all] : extruder)
        if (!told.contains(object)) used.insert(of_all);
    used.erase(0);
    return used.size() > 1;
}

SlicerVolume SlicerRoles::of(std::uint32_t parent, std::uint32_t object) const {
    SlicerVolume volume;
    for (const std::uint32_t id : {parent, object})
        if (const auto whole = extruder.find(id); whole != extruder.end()) volume.extruder = whole->second;
    if (const auto part = parts.find({parent, object}); part != parts.end()) {
        volume.role = part->second.role;
        if (part->second.extruder > 0) volume.extruder = part->second.extruder;
    }
    return volume;
}

std::vector<SlicerSpan> SlicerRoles::spans(std::uint32_t parent, std::uint32_t object, std::size_t triangles) const {
    const SlicerVolume whole = of(parent, object);
    const auto list = runs.find(object);
    if (list == runs.end()) return {{triangles, whole}};
    // Where runs begin and end, from the first triangle to the last, with those that are open between.
    std::map<std::size_t, std::vector<std::size_t>> begin, end;
    std::set<std::size_t> places{triangles};
    for (std::size_t i = 0; i < list->second.size(); ++i) {
        const Run& run = list->second[i];
        if (run.last < run.first || run.first >= triangles) continue;
        const std::size_t behind = std::min(run.last, triangles - 1) + 1;
        begin[run.first].push_back(i);
        end[behind].push_back(i);
        places.insert({run.first, behind});
    }
    std::vector<SlicerSpan> spans;
    std::set<std::size_t> open;
    for (const std::size_t place : places) {
        if (place > 0) spans.push_back({place, open.empty() ? whole : of_run(list->second[*open.rbegin()], whole)});
        for (const std::size_t i : end[place]) open.erase(i);
        for (const std::size_t i : begin[place]) open.insert(i);
    }
    return spans;
}

std::optional<std::vector<PaintNode>> paint_tree(std::string_view text) {
    std::vector<PaintNode> nodes;
    PaintReader reader{text, nodes};
    if (!reader.add() || !reader.is_read()) return std::nullopt;
    return nodes;
}

std::optional<TrianglePaint> triangle_paint(std::string_view text) {
    const auto nodes = paint_tree(text);
    if (!nodes) return std::nullopt;
    std::map<std::uint16_t, double> shares;
    add_shares(*nodes, 0, 1, shares);
    const auto most = std::ranges::max_element(shares, {}, [](const auto& share) { return share.second; });
    return TrianglePaint{most->first, shares.size() > 1};
}

void read_slicer_volumes(std::string_view text, const std::string& what, SlicerRoles& roles) {
    XmlReader xml(text, what);
    constexpr std::uint32_t none = 0xffffffff;
    std::uint32_t object = none, part = none;
    SlicerRoles::Run* run = nullptr;
    for (XmlReader::Event event; (event = xml.next()) != XmlReader::Event::finished;) {
        const std::string_view name = xml.name();
        if (event == XmlReader::Event::end) {
            if (name == "object") object = none;
            if (name == "part") part = none;
            if (name == "volume") run = nullptr;
            continue;
        }
        if (name == "object") {
            object = id_of(xml.attribute("id")).value_or(none);
        } else if (name == "part" && object != none) {
            part = id_of(xml.attribute("id")).value_or(none);
            if (part != none) roles.parts[{object, part}].role = role_of(xml.attribute("subtype"));
        } else if (name == "volume" && object != none) {
            const auto first = id_of(xml.attribute("firstid")), last = id_of(xml.attribute("lastid"));
            if (first && last) run = &roles.runs[object].emplace_back(SlicerRoles::Run{*first, *last, {}});
        } else if (name == "metadata" && object != none) {
            const std::string_view key = xml.attribute("key"), value = xml.attribute("value");
            SlicerVolume* const volume = run ? &run->volume : part != none ? &roles.parts[{object, part}] : nullptr;
            if (key == "extruder") {
                const int of = static_cast<int>(std::min<std::uint32_t>(id_of(value).value_or(0), 1000));
                if (volume)
                    volume->extruder = of;
                else
                    roles.extruder[object] = of;
            } else if (key == "volume_type" && run) {
                run->volume.role = role_of(value);
            } else if (key == "modifier" && value == "1" && run && run->volume.role == SlicerRole::part) {
                run->volume.role = SlicerRole::modifier;  // before there were types
            }
        }
    }
}

void read_slicer_colours(std::string_view text, SlicerRoles& roles) {
    if (!roles.colours.empty()) return;
    FilamentColours colours = colours_behind(text, "filament_colour");
    // In JSON that key is of the machine and not of what it prints with.
    if (!trimmed(text).starts_with('{')) {
        const FilamentColours of_extruders = colours_behind(text, "extruder_colour");
        colours.resize(std::max(colours.size(), of_extruders.size()));
        for (std::size_t i = 0; i < of_extruders.size(); ++i)
            if (of_extruders[i]) colours[i] = of_extruders[i];
    }
    const auto is_there = [](const auto& colour) { return colour.has_value(); };
    if (std::ranges::any_of(colours, is_there)) roles.colours = std::move(colours);
}

}  // namespace voxtone::io
