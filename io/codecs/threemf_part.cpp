// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/threemf_part.h"

#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "io/files/xml_reader.h"
#include "io/models/threemf_namespace.h"

namespace voxtone::io {

namespace {

std::string_view trimmed_token(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> list;
    for (text = trimmed_token(text); !text.empty();) {
        const std::size_t end = std::min(text.find_first_of(" \t\r\n"), text.size());
        list.push_back(text.substr(0, end));
        text = trimmed_token(text.substr(end));
    }
    return list;
}

class PartParser {
public:
    PartParser(std::string_view xml, const std::string& what) : xml_(xml, what) {}

    ThreemfPart parse() {
        bool any = false;
        for (XmlReader::Event event; (event = xml_.next()) != XmlReader::Event::finished;) {
            if (passed_over_ > 0) {
                pass(event);
                continue;
            }
            if (event == XmlReader::Event::end) {
                leave();
                continue;
            }
            if (xml_.depth() == 1 && xml_.name() != "model")
                xml_.fail(fmt::format("it begins with <{}> and not with <model>", xml_.full_name()));
            any = true;
            enter();
        }
        if (!any) xml_.fail("it holds no <model>");
        for (const auto& [id, element] : foreign_)
            if (const auto [place, is_new] = part_.groups.try_emplace(id); is_new) place->second.element = element;
        return std::move(part_);
    }

private:
    [[nodiscard]] ThreemfNamespace space_of(std::string_view uri) {
        // Nearly all elements are of the one that the one before was of.
        if (uri.data() != uri_.data() || uri.size() != uri_.size()) {
            uri_ = uri;
            space_ = uri.empty() || uri == core_uri_ ? ThreemfNamespace::core : threemf_namespace(uri);
        }
        return space_;
    }

    [[nodiscard]] double number(std::string_view text, std::string_view key) const {
        std::string_view digits = trimmed_token(text);
        if (digits.starts_with('+')) digits.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (digits.empty() || end != digits.data() + digits.size() ||
            (error != std::errc() && error != std::errc::result_out_of_range))
            xml_.fail(fmt::format("'{}' is no number for {}", text, key));
        return value;
    }
    [[nodiscard]] static std::optional<std::uint32_t> index_of(std::string_view text) {
        const std::string_view digits = trimmed_token(text);
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (digits.empty() || end != digits.data() + digits.size() || error != std::errc() || value == no_property)
            return std::nullopt;
        return value;
    }
    [[nodiscard]] std::uint32_t index(std::string_view text, std::string_view key) const {
        const auto value = index_of(text);
        if (!value) xml_.fail(fmt::format("'{}' is no index for {}", text, key));
        return *value;
    }
    [[nodiscard]] std::uint32_t required_index(std::string_view key) const {
        const std::string_view value = xml_.attribute(key);
        if (!value.data()) xml_.fail(fmt::format("<{}> has no {}", xml_.full_name(), key));
        return index(value, key);
    }
    [[nodiscard]] std::uint32_t optional_index(std::string_view key) const {
        const std::string_view value = xml_.attribute(key);
        return value.data() ? index(value, key) : no_property;
    }
    [[nodiscard]] double required_number(std::string_view key) const {
        const std::string_view value = xml_.attribute(key);
        if (!value.data()) xml_.fail(fmt::format("<{}> has no {}", xml_.full_name(), key));
        return number(value, key);
    }

    /// #RRGGBB or #RRGGBBAA
    [[nodiscard]] Eigen::Vector4f colour(std::string_view key) const {
        const std::string_view text = trimmed_token(xml_.attribute(key));
        std::uint32_t bits = 0;
        const bool known_length = text.size() == 7 || text.size() == 9;
        if (!known_length || text[0] != '#' ||
            std::from_chars(text.data() + 1, text.data() + text.size(), bits, 16).ptr != text.data() + text.size())
            xml_.fail(fmt::format("'{}' is no colour", text));
        if (text.size() == 7) bits = (bits << 8) | 0xff;
        return Eigen::Vector4f(float(bits >> 24), float((bits >> 16) & 0xff), float((bits >> 8) & 0xff),
                               float(bits & 0xff)) /
               255.0f;
    }

    /// Twelve numbers, row by row, of a 4 x 3 matrix that row vectors are multiplied with from the left.
    [[nodiscard]] Eigen::Affine3d transform() const {
        Eigen::Affine3d result = Eigen::Affine3d::Identity();
        const std::string_view text = xml_.attribute("transform");
        if (!text.data()) return result;
        const auto list = words(text);
        if (list.size() != 12) xml_.fail(fmt::format("a transform has {} numbers and not 12", list.size()));
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 3; ++column)
                result.matrix()(column, row) = number(list[std::size_t(3 * row + column)], "transform");
        if (!result.matrix().allFinite()) xml_.fail("a transform is infinite");
        return result;
    }

    /// Of the production extension; without prefix, too.
    [[nodiscard]] std::string_view path_of_part() {
        for (const auto& [key, value] : xml_.attributes()) {
            if (XmlReader::local(key) != "path") continue;
            const ThreemfNamespace space = space_of(xml_.attribute_namespace(key));
            if (space == ThreemfNamespace::core || space == ThreemfNamespace::production) return value;
        }
        return {};
    }

    [[nodiscard]] ThreemfReference reference() {
        return {required_index("objectid"), std::string(path_of_part()), transform(), true};
    }

    [[nodiscard]] Wrap tile_style(std::string_view key) const {
        const std::string_view style = xml_.attribute(key);
        return style == "mirror"  ? Wrap::mirror
               : style == "clamp" ? Wrap::clamp
               : style == "none"  ? Wrap::decal
                                  : Wrap::repeat;
    }

    /// A new entry of this element's id. Were one to take the place of another, a body or its colours would be lost.
    template <class Resource>
    Resource& add_resource(std::map<std::uint32_t, Resource>& resources) {
        const std::uint32_t id = required_index("id");
        const auto [place, is_new] = resources.try_emplace(id);
        if (!is_new)
            xml_.fail(fmt::format("<{}> has the id {}, which another has already, so that what is meant by it is open",
                                  xml_.full_name(), id));
        return place->second;
    }

    ThreemfGroup& start_group(ThreemfGroup::Kind kind) {
        ThreemfGroup& group = add_resource(part_.groups);
        group.kind = kind;
        group.element = xml_.name();
        return *(group_ = &group);
    }

    void pass(XmlReader::Event event) {
        const std::string_view name = xml_.name();
        if (event == XmlReader::Event::end) {
            if (xml_.depth() != passed_over_) return;
            passed_over_ = 0;
            volume_.reset();
        } else if (volume_ && (name == "color" || name == "colormapping" || name == "composite")) {
            part_.plain_volumes.erase(*volume_);
        } else if (volume_ && name == "boundary") {
            part_.shaping_volumes.insert(*volume_);
        }
    }

    /// What is not understood, with all in it.
    void pass_over() {
        passed_over_ = xml_.depth();
        if (xml_.name() == "volumedata") {
            const std::string_view id = xml_.attribute("id");
            volume_ = id.empty() ? fmt::format("of mesh {}", part_.objects.size()) : std::string(id);
            part_.plain_volumes.insert(*volume_);
            if (object_) object_->volume = *volume_;
        }
        if (xml_.depth() == 3)
            if (const auto id = index_of(xml_.attribute("id"))) foreign_.try_emplace(*id, xml_.name());
        if (xml_.depth() == 4 && object_) object_->other_shape = xml_.name();
    }

    void enter() {
        const std::string_view name = xml_.name();
        using Kind = ThreemfGroup::Kind;
        if (xml_.depth() == 1) {
            core_uri_ = xml_.namespace_uri();
            return read_model();
        }
        const ThreemfNamespace space = space_of(xml_.namespace_uri());
        if (space == ThreemfNamespace::other) return pass_over();
        const bool is_core = space == ThreemfNamespace::core;
        if (xml_.depth() == 3) {  // children of <resources> and <build>
            group_ = nullptr;
            object_ = nullptr;
            if (is_core && name == "item") {
                part_.items.push_back(reference());
                part_.items.back().printable = xml_.attribute("printable") != "0";
            } else if (is_core && name == "object") {
                object_ = &add_resource(part_.objects);
                if (const auto type = xml_.attribute("type"); type.data()) object_->type = type;
                object_->name = xml_.attribute("name");
                object_->pid = optional_index("pid");
                object_->pindex = optional_index("pindex");
            } else if (name == "texture2d") {
                add_resource(part_.textures) = {std::string(xml_.attribute("path")), tile_style("tilestyleu"),
                                                tile_style("tilestylev"), xml_.attribute("filter") == "nearest"};
            } else if (name == "basematerials") {
                start_group(Kind::base_materials).display =
                    index_of(xml_.attribute("displaypropertiesid")).value_or(no_property);
            } else if (name == "colorgroup") {
                start_group(Kind::colours);
            } else if (name == "texture2dgroup") {
                start_group(Kind::texture).refers_to = required_index("texid");
            } else if (name == "compositematerials") {
                ThreemfGroup& group = start_group(Kind::composites);
                group.refers_to = required_index("matid");
                for (const auto word : words(xml_.attribute("matindices")))
                    group.members.push_back(index(word, "matindices"));
            } else if (name == "multiproperties") {
                ThreemfGroup& group = start_group(Kind::multi);
                for (const auto word : words(xml_.attribute("pids"))) group.members.push_back(index(word, "pids"));
                for (const auto word : words(xml_.attribute("blendmethods")))
                    group.multiply.push_back(word == "multiply");
            } else if (xml_.attribute("id").data()) {
                part_.is_translucent = part_.is_translucent || name == "translucentdisplayproperties";
                start_group(Kind::unknown);
            }
            return;
        }
        if (object_) return enter_in_object(name, space);
        if (!group_) return;
        if (name == "base" && group_->kind == Kind::base_materials) group_->rgba.push_back(colour("displaycolor"));
        if (name == "color" && group_->kind == Kind::colours) group_->rgba.push_back(colour("color"));
        if (name == "tex2coord" && group_->kind == Kind::texture)
            group_->uv.push_back(Eigen::Vector2d(required_number("u"), required_number("v")).cast<float>());
        if (name == "composite" && group_->kind == Kind::composites) add_values("values");
        if (name == "multi" && group_->kind == Kind::multi) add_values("pindices");
        if (name == "translucent" && group_->kind == Kind::unknown) add_values("attenuation", group_->attenuation);
    }

    void add_values(std::string_view key) { add_values(key, group_->values); }
    void add_values(std::string_view key, std::vector<std::vector<double>>& to) {
        std::vector<double>& values = to.emplace_back();
        for (const auto word : words(xml_.attribute(key))) values.push_back(number(word, key));
    }

    /// PrusaSlicer and its kin, Bambu Studio and its kin
    [[nodiscard]] bool is_paint(std::string_view key) const {
        if (key == "paint_color") return true;
        return key.ends_with("mmu_segmentation") && XmlReader::local(key) == "mmu_segmentation" &&
               (key.find(':') == key.npos || xml_.attribute_namespace(key).find("slic3r") != key.npos);
    }

    void enter_in_object(std::string_view name, ThreemfNamespace space) {
        const bool is_core = space == ThreemfNamespace::core;
        if (is_core && name == "vertex") {
            object_->vertices.emplace_back(required_number("x"), required_number("y"), required_number("z"));
        } else if (is_core && name == "triangle") {
            ThreemfTriangle triangle{{required_index("v1"), required_index("v2"), required_index("v3")}};
            for (const auto& [key, value] : xml_.attributes()) {
                if (key == "pid") triangle.pid = index(value, key);
                if (key == "p1") triangle.p[0] = index(value, key);
                if (key == "p2") triangle.p[1] = index(value, key);
                if (key == "p3") triangle.p[2] = index(value, key);
                if (!is_paint(key)) continue;
                const auto paint = triangle_paint(trimmed_token(value));
                triangle.paint = paint.value_or(TrianglePaint{0, true});
                if (paint && paint->is_divided)
                    object_->paint_in_parts.insert_or_assign(object_->triangles.size(), trimmed_token(value));
            }
            object_->triangles.push_back(triangle);
        } else if (is_core && name == "component") {
            object_->components.push_back(reference());
        } else if (name == "beam" && (is_core || space == ThreemfNamespace::beam_lattice)) {
            object_->has_beams = true;
        } else if (name == "mesh") {
            for (const auto& [key, value] : xml_.attributes())
                if (XmlReader::local(key) == "volumeid") object_->volume = value;
        } else if (xml_.depth() == 4 && name != "components" && name != "metadatagroup") {
            object_->other_shape = name;
        }
    }

    void leave() {
        if (xml_.depth() != 3) return;
        group_ = nullptr;
        object_ = nullptr;
    }

    void read_model() {
        const std::string_view unit = xml_.attribute("unit");
        const std::pair<std::string_view, double> units[] = {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10},
                                                             {"inch", 25.4},    {"foot", 304.8},   {"meter", 1000}};
        bool known = unit.empty();
        for (const auto& [name, mm] : units)
            if (unit == name) {
                part_.mm_per_unit = mm;
                known = true;
            }
        if (!known)
            xml_.fail(
                fmt::format("the unit '{}' is unknown (micron, millimeter, centimeter, inch, foot, meter)", unit));
        for (const auto prefix : words(xml_.attribute("requiredextensions")))
            part_.required_extensions.emplace_back(xml_.meaning(prefix));
    }

    XmlReader xml_;
    ThreemfPart part_;
    std::string_view core_uri_, uri_;  // of <model>; that `space_` was last asked for
    ThreemfNamespace space_ = ThreemfNamespace::core;
    std::size_t passed_over_ = 0;                        // depth of an element that is not understood; 0: none
    std::map<std::uint32_t, std::string_view> foreign_;  // resources that are not understood, by id
    std::optional<std::string> volume_;                  // id of the volumedata that is passed over
    ThreemfGroup* group_ = nullptr;                      // being read
    ThreemfObject* object_ = nullptr;
};

}  // namespace

ThreemfPart parse_threemf_part(std::string_view xml, const std::string& what) { return PartParser(xml, what).parse(); }

}  // namespace voxtone::io
