// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/parse_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/base/printable.h"
#include "voxtone/io/codecs/ply_header.h"
#include "voxtone/io/codecs/ply_values.h"
#include "voxtone/io/codecs/polygon_triangles.h"
#include "voxtone/io/models/model_text.h"
#include "voxtone/io/models/mtl_library.h"
#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, std::string_view(name)) != names.end();
}

/// Raw values of vertices or of faces, until it is known what range they have.
struct RawColours {
    std::vector<Eigen::Vector4d> value;
    PlyType type = PlyType::uint8;
    bool has_alpha = false;
};

class PlyParser {
public:
    explicit PlyParser(ParseContext& context)
        : context_(context), header_(read_ply_header(context.bytes(), context.name())) {}

    ModelParts parse() {
        parts_.format = "PLY";
        expect_lists_to_fit(context_.bytes(), header_, context_.name());
        PlyValues values(context_.bytes(), header_, context_.name());
        for (const PlyElement& element : header_.elements) read(element, values);
        make_materials();
        const std::vector<Eigen::Vector4f> of_vertices = settled(vertex_colours_, "vertex"),
                                           of_faces = settled(face_colours_, "face");
        const bool by_face = face_colours_count(of_vertices, of_faces);
        for (std::size_t f = 0; f < faces_.size(); ++f) add(f, of_vertices, of_faces, by_face);
        say_what_was_lost();
        return std::move(parts_);
    }

private:
    struct Face {
        std::size_t first = 0, corners = 0;
        std::int64_t page = -1;
    };

    void read(const PlyElement& element, PlyValues& values) {
        if (element.name == "vertex") return read_vertices(element, values);
        const bool strips = is_one_of(element.name, {"tristrips", "tristrip", "triangle_strips"});
        if (element.name != "face" && !strips) {
            if (element.name == "edge") points_and_lines_ += element.count;
            for (std::uint64_t i = 0; i < element.count; ++i) skip_item(element, values);
            return;
        }
        for (std::uint64_t i = 0; i < element.count; ++i)
            strips ? read_strip(element, values) : read_face(element, values);
    }

    void read_vertices(const PlyElement& element, PlyValues& values) {
        vertex_colours_.type = colour_type(element);
        const bool coloured = has_colour(element), with_uv = has_uv(element);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            Eigen::Vector3d place = Eigen::Vector3d::Zero();
            Eigen::Vector4d colour = Eigen::Vector4d::Ones();
            Eigen::Vector2f uv = Eigen::Vector2f::Zero();
            for (const PlyProperty& p : element.properties) {
                const int channel = p.is_list ? -1 : ply_colour_channel(p.name);
                if (p.is_list)
                    values.skip(p.type, values.length(p.count_type));
                else if (p.name == "x")
                    place.x() = values.next(p.type);
                else if (p.name == "y")
                    place.y() = values.next(p.type);
                else if (p.name == "z")
                    place.z() = values.next(p.type);
                else if (is_one_of(p.name, {"s", "u", "texture_u", "texture_s", "tx"}))
                    uv.x() = static_cast<float>(values.next(p.type));
                else if (is_one_of(p.name, {"t", "v", "texture_v", "texture_t", "ty"}))
                    uv.y() = static_cast<float>(values.next(p.type));
                else if (channel >= 0 && coloured)
                    take(colour, channel, values.next(p.type), vertex_colours_);
                else
                    values.skip(p.type, 1);
            }
            parts_.positions.push_back(place);
            if (coloured) vertex_colours_.value.push_back(colour);
            if (with_uv) vertex_uv_.push_back(uv);
        }
    }

    static void take(Eigen::Vector4d& colour, int channel, double value, RawColours& raw) {
        colour[channel] = value;
        raw.has_alpha = raw.has_alpha || channel == 3;
    }
    static bool has_colour(const PlyElement& element) {
        return std::ranges::any_of(element.properties,
                                   [](const PlyProperty& p) { return !p.is_list && ply_colour_channel(p.name) == 0; });
    }
    static PlyType colour_type(const PlyElement& element) {
        for (const PlyProperty& p : element.properties)
            if (!p.is_list && ply_colour_channel(p.name) == 0) return p.type;
        return PlyType::uint8;
    }
    static bool has_uv(const PlyElement& element) {
        return std::ranges::any_of(element.properties, [](const PlyProperty& p) {
            return !p.is_list && is_one_of(p.name, {"s", "u", "texture_u", "texture_s", "tx"});
        });
    }
    static bool is_index_list(const PlyProperty& p) {
        return p.is_list && is_one_of(p.name, {"vertex_indices", "vertex_index", "vertex_indexes"});
    }

    std::int64_t index_of(double value) const {
        const auto vertices = static_cast<double>(parts_.positions.size());
        if (!(value >= 0 && value < vertices))
            throw InputError(fmt::format("a face of {} uses vertex {:g}, but there are only {}; the file is damaged",
                                         context_.name(), value, parts_.positions.size()));
        return static_cast<std::int64_t>(value);
    }

    void read_face(const PlyElement& element, PlyValues& values) {
        face_colours_.type = colour_type(element);
        const bool coloured = has_colour(element);
        Face face{corners_.size(), 0, -1};
        Eigen::Vector4d colour = Eigen::Vector4d::Ones();
        std::vector<float> uv;
        for (const PlyProperty& p : element.properties) {
            const int channel = p.is_list ? -1 : ply_colour_channel(p.name);
            if (is_index_list(p)) {
                for (std::uint64_t n = values.length(p.count_type); n-- > 0;) corners_.push_back(values.next(p.type));
            } else if (p.is_list && p.name == "texcoord") {
                for (std::uint64_t n = values.length(p.count_type); n-- > 0;)
                    uv.push_back(static_cast<float>(values.next(p.type)));
            } else if (p.is_list) {
                values.skip(p.type, values.length(p.count_type));
            } else if (p.name == "texnumber") {
                const double page = values.next(p.type);
                face.page = page >= 0 && page < 1e6 ? static_cast<std::int64_t>(page) : -1;
            } else if (channel >= 0 && coloured) {
                take(colour, channel, values.next(p.type), face_colours_);
            } else {
                values.skip(p.type, 1);
            }
        }
        face.corners = corners_.size() - face.first;
        if (face.corners < 3) {
            corners_.resize(face.first);
            ++points_and_lines_;
            return;
        }
        if (!uv.empty() || !corner_uv_.empty()) {
            corner_uv_.resize(corners_.size(), Eigen::Vector2f::Constant(std::nanf("")));
            for (std::size_t c = 0; c < face.corners && 2 * c + 1 < uv.size(); ++c)
                corner_uv_[face.first + c] = {uv[2 * c], uv[2 * c + 1]};
        }
        if (coloured) {
            face_colours_.value.resize(faces_.size(), Eigen::Vector4d::Ones());
            face_colours_.value.push_back(colour);
        }
        faces_.push_back(face);
    }

    /// Triangles of three that follow on each other, every second one turned; a negative number begins a new strip.
    void read_strip(const PlyElement& element, PlyValues& values) {
        for (const PlyProperty& p : element.properties) {
            if (!is_index_list(p)) {
                values.skip(p.type, p.is_list ? values.length(p.count_type) : 1);
                continue;
            }
            std::vector<double> strip;
            for (std::uint64_t n = values.length(p.count_type); n-- > 0;) {
                const double index = values.next(p.type);
                if (index < 0) {
                    strip.clear();
                    continue;
                }
                strip.push_back(index);
                const std::size_t k = strip.size();
                if (k < 3) continue;
                const double a = strip[k - 3], b = strip[k - 2], c = index;
                if (a == b || b == c || a == c) continue;  // joins two strips
                const bool turned = k % 2 == 0;
                faces_.push_back({corners_.size(), 3, -1});
                for (const double corner : {turned ? b : a, turned ? a : b, c}) corners_.push_back(corner);
            }
        }
    }

    /// Linear, alpha as it is; empty where there are none.
    std::vector<Eigen::Vector4f> settled(RawColours& raw, const char* whose) {
        if (raw.value.empty()) return {};
        parts_.has_colour = true;
        const double wrap = raw.type == PlyType::int8    ? 256
                            : raw.type == PlyType::int16 ? 65536
                            : raw.type == PlyType::int32 ? 4294967296.0
                                                         : 0;
        double most = 0;
        const Eigen::Index channels = raw.has_alpha ? 4 : 3;
        for (Eigen::Vector4d& colour : raw.value)
            for (Eigen::Index c = 0; c < channels; ++c) {
                if (colour[c] < 0) colour[c] += wrap;
                if (c < 3) most = std::max(most, colour[c]);
            }
        const double range = range_of(raw.type, most);
        const bool usual = bytes_of(raw.type) == 1 || (is_float(raw.type) && range == 1);
        if (!usual)
            parts_.warnings.push_back(
                fmt::format("The {} colours of {} go up to {:g}: they were taken as of 0 to {:.0f}.", whose,
                            context_.name(), most, range));
        std::vector<Eigen::Vector4f> out;
        std::size_t clamped = 0;
        for (const Eigen::Vector4d& colour : raw.value) {
            Eigen::Vector4f rgba = Eigen::Vector4f::Ones();
            for (Eigen::Index c = 0; c < channels; ++c) rgba[c] = static_cast<float>(colour[c] / range);
            const Eigen::Vector3f code = rgba.head<3>().cwiseMax(0).cwiseMin(1);
            clamped += static_cast<std::size_t>(!((code - rgba.head<3>()).cwiseAbs().maxCoeff() <= 0));
            rgba.head<3>() = srgb_to_linear(code);
            out.push_back(rgba);
        }
        if (clamped)
            parts_.warnings.push_back(fmt::format("{} {} colours of {} lie outside 0 to 1; they were clamped.", clamped,
                                                  whose, context_.name()));
        raw.value.clear();
        return out;
    }

    static double range_of(PlyType type, double most) {
        constexpr double bytes = 255, words = 65535, all = 4294967295.0;
        if (bytes_of(type) == 1) return bytes;
        if (is_float(type) && most <= static_cast<double>(most_of_unit_range)) return 1;
        if (most <= bytes) return bytes;
        return most <= words ? words : all;
    }

    void make_materials() {
        const std::vector<std::string>& files = header_.texture_files;
        const bool by_number = std::ranges::any_of(faces_, [](const Face& f) { return f.page >= 0; });
        pages_ = files.empty() ? 0 : by_number ? files.size() : 1;
        if (files.size() > 1 && !by_number)
            parts_.lose_colour(
                fmt::format("{} has {} textures and does not say which face has which (texnumber): the "
                            "first is laid on all of them, the colours of the others are LOST.",
                            context_.name(), files.size()));
        for (std::size_t page = 0; page < pages_; ++page) {
            parts_.has_colour = true;
            PartMaterial& material = parts_.materials.emplace_back();
            material.name = files[page];
            material.image = context_.add_image_file(parts_, files[page], context_.decode_options());
        }
        parts_.materials.emplace_back();  // of what has no texture
    }

    /// Colours of faces count where they are all that tells places apart.
    bool face_colours_count(const std::vector<Eigen::Vector4f>& of_vertices,
                            const std::vector<Eigen::Vector4f>& of_faces) {
        if (of_faces.empty()) return false;
        const auto differ = [](const std::vector<Eigen::Vector4f>& colours) {
            return std::adjacent_find(colours.begin(), colours.end(), std::not_equal_to<>()) != colours.end();
        };
        if (differ(of_vertices) && differ(of_faces))
            parts_.warnings.push_back(fmt::format(
                "{} has colours of vertices and of faces; those of the vertices are printed.", context_.name()));
        return !differ(of_vertices) && (of_vertices.empty() || differ(of_faces));
    }

    void add(std::size_t f, const std::vector<Eigen::Vector4f>& of_vertices,
             const std::vector<Eigen::Vector4f>& of_faces, bool by_face) {
        const Face& face = faces_[f];
        std::vector<Eigen::Vector3d> outline;
        std::vector<std::uint32_t> vertex;
        for (std::size_t c = 0; c < face.corners; ++c) {
            vertex.push_back(static_cast<std::uint32_t>(index_of(corners_[face.first + c])));
            outline.push_back(parts_.positions[vertex.back()]);
        }
        const bool at_corners = face.first + face.corners <= corner_uv_.size() && corner_uv_[face.first].allFinite();
        const bool coordinates = at_corners || !vertex_uv_.empty();
        const auto page = static_cast<std::size_t>(std::max<std::int64_t>(face.page, 0));
        const bool has_page = page < pages_ && !(face.page < 0 && pages_ > 1);
        if (pages_ > 0 && !has_page) ++without_page_;
        // Without coordinates for any face the page says what is lost.
        const bool textured = has_page && (coordinates || (vertex_uv_.empty() && corner_uv_.empty()));
        if (has_page && !textured) ++without_page_;
        const auto m = static_cast<std::uint32_t>(textured ? page : pages_);
        const bool picture = textured && coordinates && parts_.materials[m].image >= 0;
        for (const auto& triangle : polygon_triangles(outline)) {
            const std::size_t t =
                parts_.add_triangle({vertex[triangle[0]], vertex[triangle[1]], vertex[triangle[2]]}, m);
            if (coordinates) {
                std::array<Eigen::Vector2f, 3> uv;
                for (std::size_t c = 0; c < 3; ++c)
                    uv[c] = at_corners ? corner_uv_[face.first + triangle[c]] : vertex_uv_[vertex[triangle[c]]];
                parts_.set_uv(t, uv);
            }
            if (picture) continue;
            if (by_face && f < of_faces.size()) {
                parts_.set_rgba(t, {of_faces[f], of_faces[f], of_faces[f]});
            } else if (!of_vertices.empty()) {
                std::array<Eigen::Vector4f, 3> rgba;
                for (std::size_t c = 0; c < 3; ++c) rgba[c] = of_vertices[vertex[triangle[c]]];
                parts_.set_rgba(t, rgba);
            }
        }
    }

    void say_what_was_lost() {
        for (const PlyElement& element : header_.elements)
            for (const PlyProperty& p : element.properties)
                if (ply_colour_channel(p.name) < 0 && lower_case(p.name).find("red") != std::string::npos &&
                    !has_colour(element))
                    parts_.lose_colour(
                        fmt::format("{} has colours by the name of '{}', which is not known: they are "
                                    "LOST. Call them red, green and blue.",
                                    context_.name(), printable(p.name)));
        if (without_page_)
            parts_.lose_colour(
                fmt::format("{} faces of {} have no texture of their own or no texture coordinates, where "
                            "others have: their colours are LOST.",
                            without_page_, context_.name()));
        if (points_and_lines_)
            parts_.warnings.push_back(fmt::format("{} has {} points or lines; they have no volume and are left aside.",
                                                  context_.name(), points_and_lines_));
        for (const std::string& warning : context_.side_file_warnings()) parts_.warnings.push_back(warning);
    }

    ParseContext& context_;
    const PlyHeader header_;
    ModelParts parts_;
    RawColours vertex_colours_, face_colours_;
    std::vector<Eigen::Vector2f> vertex_uv_, corner_uv_;  ///< per vertex; per corner, not a number where there is none
    std::vector<double> corners_;
    std::vector<Face> faces_;
    std::size_t pages_ = 0, without_page_ = 0, points_and_lines_ = 0;
};

}  // namespace

ModelParts parse_ply(ParseContext& context) { return PlyParser(context).parse(); }

}  // namespace voxtone::io
