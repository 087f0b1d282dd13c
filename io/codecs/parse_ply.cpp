// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/ply_header.h"
#include "io/codecs/ply_values.h"
#include "io/codecs/polygon_triangles.h"
#include "io/models/colour_range.h"

namespace voxtone::io {

namespace {

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, std::string_view(name)) != names.end();
}

ColourNumbers numbers_of(PlyType type) {
    return bytes_of(type) == 1 ? ColourNumbers::bytes : is_float(type) ? ColourNumbers::reals : ColourNumbers::integers;
}

/// Some write unsigned numbers into signed properties.
double unsigned_of(double value, PlyType type) {
    if (!(value < 0) || is_float(type)) return value;
    return value + std::ldexp(1.0, 8 * static_cast<int>(bytes_of(type)));
}

Eigen::Vector4d no_colour() { return {std::nan(""), std::nan(""), std::nan(""), 1}; }

class PlyParser {
public:
    explicit PlyParser(ParseContext& context)
        : context_(context), header_(read_ply_header(context.bytes(), context.name())) {}

    ModelParts parse() {
        parts_.format = "PLY";
        expect_lists_to_fit(context_.bytes(), header_, context_.name());
        PlyValues values(context_.bytes(), header_, context_.name());
        for (const PlyElement& element : header_.elements) read(element, values);
        if (values.commas())
            parts_.warnings.push_back(named_warning(
                "decimal-commas", fmt::format("{} has decimal commas; they were read as points.", context_.name())));
        if (values.has_number_left())
            parts_.warnings.push_back(named_warning(
                "damaged", fmt::format("{} goes on behind the last item that its header tells of; what stands there "
                                       "was left aside. Export it again.",
                                       context_.name())));
        make_materials();
        settle_colours();
        for (std::size_t f = 0; f < faces_.size(); ++f) add(f);
        say_what_was_lost();
        return std::move(parts_);
    }

private:
    struct Face {
        std::size_t first = 0, corners = 0;
        std::int64_t page = -1, material = -1;
    };
    /// What stands behind a single item of an element.
    struct Item {
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        Eigen::Vector4d colour = Eigen::Vector4d::Ones();
        Eigen::Vector2f uv = Eigen::Vector2f::Zero();
        std::int64_t page = -1, material = -1;
        std::vector<double> corners;
        std::vector<float> corner_uv;
    };
    /// An element, and what its properties are.
    struct Columns {
        const PlyElement& element;
        std::vector<PlyRole> roles;
        [[nodiscard]] const PlyProperty* property(PlyRole role) const {
            const auto found = std::ranges::find(roles, role);
            return found == roles.end() ? nullptr
                                        : &element.properties[static_cast<std::size_t>(found - roles.begin())];
        }
        [[nodiscard]] bool coloured() const { return property(PlyRole::red) != nullptr; }
    };

    void read(const PlyElement& element, PlyValues& values) {
        const Columns columns{element, ply_roles(element)};
        if (element.name == "vertex") return read_vertices(columns, values);
        if (element.name == "face") return read_faces(columns, values);
        if (element.name == "material") return read_materials(columns, values);
        if (element.name == "edge") points_and_lines_ += element.count;
        const bool strips = is_one_of(element.name, {"tristrips", "tristrip", "triangle_strips"});
        for (std::uint64_t i = 0; i < element.count; ++i)
            strips ? read_strip(columns, values) : skip_item(element, values);
    }

    static Item read_item(const Columns& columns, PlyValues& values) {
        Item item;
        for (std::size_t i = 0; i < columns.roles.size(); ++i) {
            const PlyProperty& p = columns.element.properties[i];
            const PlyRole role = columns.roles[i];
            if (role >= PlyRole::red && role <= PlyRole::alpha)
                item.colour[int(role) - int(PlyRole::red)] = unsigned_of(values.next(p.type), p.type);
            else if (role >= PlyRole::x && role <= PlyRole::z)
                item.place[int(role) - int(PlyRole::x)] = values.next(p.type);
            else if (role == PlyRole::u || role == PlyRole::v)
                item.uv[int(role) - int(PlyRole::u)] = static_cast<float>(values.next(p.type));
            else if (role == PlyRole::page)
                item.page = number_from_0(values.next(p.type));
            else if (role == PlyRole::material)
                item.material = number_from_0(values.next(p.type));
            else if (role == PlyRole::corners)
                for (std::uint64_t n = values.length(p.count_type); n-- > 0;)
                    item.corners.push_back(values.next(p.type));
            else if (role == PlyRole::corner_uv)
                for (std::uint64_t n = values.length(p.count_type); n-- > 0;)
                    item.corner_uv.push_back(static_cast<float>(values.next(p.type)));
            else
                values.skip(p.type, p.is_list ? values.length(p.count_type) : 1);
        }
        return item;
    }

    static std::int64_t number_from_0(double value) {
        return value >= 0 && value < 1e6 ? static_cast<std::int64_t>(value) : -1;
    }

    /// What is known of colours before their values.
    static void begin_colours(const Columns& columns, FileColours& colours) {
        const PlyProperty* alpha = columns.property(PlyRole::alpha);
        if (!columns.coloured()) return;
        colours.numbers = numbers_of(columns.property(PlyRole::red)->type);
        colours.has_alpha = alpha != nullptr;
        if (alpha) colours.alpha_numbers = numbers_of(alpha->type);
    }

    void read_vertices(const Columns& columns, PlyValues& values) {
        begin_colours(columns, vertex_colours_);
        const bool coloured = columns.coloured(), with_uv = columns.property(PlyRole::u) != nullptr,
                   with_material = columns.property(PlyRole::material) != nullptr;
        for (std::uint64_t i = 0; i < columns.element.count; ++i) {
            const Item item = read_item(columns, values);
            parts_.positions.push_back(item.place);
            if (coloured) vertex_colours_.value.push_back(item.colour);
            if (with_uv) vertex_uv_.push_back(item.uv);
            if (with_material) vertex_material_.push_back(item.material);
        }
    }

    void read_materials(const Columns& columns, PlyValues& values) {
        begin_colours(columns, material_colours_);
        for (std::uint64_t i = 0; i < columns.element.count; ++i) {
            const Item item = read_item(columns, values);
            if (columns.coloured()) material_colours_.value.push_back(item.colour);
        }
    }

    std::int64_t index_of(double value) const {
        const auto vertices = static_cast<double>(parts_.positions.size());
        if (!(value >= 0 && value < vertices))
            throw InputError(fmt::format("a face of {} uses vertex {:g}, but there are only {}; the file is damaged",
                                         context_.name(), value, parts_.positions.size()));
        return static_cast<std::int64_t>(value);
    }

    void read_faces(const Columns& columns, PlyValues& values) {
        begin_colours(columns, face_colours_);
        for (std::uint64_t i = 0; i < columns.element.count; ++i) {
            const Item item = read_item(columns, values);
            if (item.corners.size() < 3) {
                ++points_and_lines_;
                continue;
            }
            const Face face{corners_.size(), item.corners.size(), item.page, item.material};
            corners_.insert(corners_.end(), item.corners.begin(), item.corners.end());
            if (!item.corner_uv.empty() || !corner_uv_.empty()) {
                corner_uv_.resize(corners_.size(), Eigen::Vector2f::Constant(std::nanf("")));
                for (std::size_t c = 0; c < face.corners && 2 * c + 1 < item.corner_uv.size(); ++c)
                    corner_uv_[face.first + c] = {item.corner_uv[2 * c], item.corner_uv[2 * c + 1]};
            }
            if (columns.coloured()) {
                face_colours_.value.resize(faces_.size(), no_colour());
                face_colours_.value.push_back(item.colour);
            }
            faces_.push_back(face);
        }
    }

    /// Triangles of three that follow on each other, every second one turned; a negative number begins a new strip,
    /// also where the type has none.
    void read_strip(const Columns& columns, PlyValues& values) {
        for (std::size_t i = 0; i < columns.roles.size(); ++i) {
            const PlyProperty& p = columns.element.properties[i];
            if (columns.roles[i] != PlyRole::corners) {
                values.skip(p.type, p.is_list ? values.length(p.count_type) : 1);
                continue;
            }
            std::vector<double> strip;
            for (std::uint64_t n = values.length(p.count_type); n-- > 0;) {
                const double index = values.next(p.type);
                if (index < 0 || index == unsigned_of(-1, p.type)) {
                    strip.clear();
                    continue;
                }
                strip.push_back(index);
                const std::size_t k = strip.size();
                if (k < 3) continue;
                const double a = strip[k - 3], b = strip[k - 2], c = index;
                if (a == b || b == c || a == c) continue;  // joins two strips
                const bool turned = k % 2 == 0;
                faces_.push_back({corners_.size(), 3, -1, -1});
                for (const double corner : {turned ? b : a, turned ? a : b, c}) corners_.push_back(corner);
            }
        }
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

    void settle_colours() {
        const auto settle = [&](const FileColours& colours, const char* whose) {
            return settled_colours(colours, whose, context_.name(), parts_.warnings, &parts_.lost_colours);
        };
        of_vertices_ = settle(vertex_colours_, "vertex");
        of_faces_ = settle(face_colours_, "face");
        if (of_vertices_.empty() && of_faces_.empty()) take_materials(settle(material_colours_, "material"));
        parts_.has_colour = parts_.has_colour || !of_vertices_.empty() || !of_faces_.empty();
        by_face_ = face_colours_count();
    }

    /// By the number that a face or its first corner has; a material that is alone needs none.
    void take_materials(const std::vector<Eigen::Vector4f>& materials) {
        if (materials.empty()) return;
        for (const Face& face : faces_) {
            std::int64_t number = face.material;
            if (number < 0 && !vertex_material_.empty())
                number = vertex_material_[static_cast<std::size_t>(index_of(corners_[face.first]))];
            if (number < 0 && materials.size() == 1) number = 0;
            of_faces_.push_back(number >= 0 && number < static_cast<std::int64_t>(materials.size())
                                    ? materials[static_cast<std::size_t>(number)]
                                    : Eigen::Vector4f(no_colour().cast<float>()));
        }
    }

    /// Colours of faces count where they are all that tells places apart.
    bool face_colours_count() {
        if (of_faces_.empty()) return false;
        const auto differ = [](const std::vector<Eigen::Vector4f>& colours) {
            return std::adjacent_find(colours.begin(), colours.end(), std::not_equal_to<>()) != colours.end();
        };
        if (differ(of_vertices_) && differ(of_faces_))
            parts_.warnings.push_back(
                named_warning("which-colour",
                              fmt::format("{} has colours of vertices and of faces; those of the vertices are printed.",
                                          context_.name())));
        return !differ(of_vertices_) && (of_vertices_.empty() || differ(of_faces_));
    }

    /// Of a corner, white where it has no colour though others have.
    Eigen::Vector4f colour_of(std::size_t face, std::uint32_t vertex) {
        const Eigen::Vector4f none = Eigen::Vector4f(no_colour().cast<float>());
        const Eigen::Vector4f& rgba = !by_face_                 ? of_vertices_[vertex]
                                      : face < of_faces_.size() ? of_faces_[face]
                                                                : none;
        if (!std::isnan(rgba[0])) return rgba;
        white_.insert(by_face_ ? face : vertex);
        return Eigen::Vector4f::Ones();
    }

    void add(std::size_t f) {
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
        const bool coloured = !picture && (by_face_ || !of_vertices_.empty());
        for (const auto& triangle : polygon_triangles(outline, context_.name(), true)) {
            const std::array<std::uint32_t, 3> corner{vertex[triangle[0]], vertex[triangle[1]], vertex[triangle[2]]};
            const std::size_t t = parts_.add_triangle(corner, m);
            if (coordinates) {
                std::array<Eigen::Vector2f, 3> uv;
                for (std::size_t c = 0; c < 3; ++c)
                    uv[c] = at_corners ? corner_uv_[face.first + triangle[c]] : vertex_uv_[corner[c]];
                parts_.set_uv(t, uv);
            }
            if (coloured)
                parts_.set_rgba(t, {colour_of(f, corner[0]), colour_of(f, corner[1]), colour_of(f, corner[2])});
        }
    }

    void say_what_was_lost() {
        for (const PlyElement& element : header_.elements)
            if (const std::string name = ply_unread_colour(element); !name.empty())
                parts_.lose_colour(
                    fmt::format("{} has colours by the name of '{}', which is not known: they are LOST. Call them red, "
                                "green and blue.",
                                context_.name(), printable(name)));
        if (!white_.empty())
            parts_.lose_colour(white_without_colour(white_.size(), by_face_ ? "faces" : "vertices", context_.name()));
        if (without_page_)
            parts_.lose_colour(
                fmt::format("{} faces of {} have no texture of their own or no texture coordinates, where "
                            "others have: their colours are LOST.",
                            without_page_, context_.name()));
        if (points_and_lines_)
            parts_.warnings.push_back(named_warning(
                "no-volume", fmt::format("{} has {} points or lines; they have no volume and are left aside.",
                                         context_.name(), points_and_lines_)));
        for (const std::string& warning : context_.side_file_warnings()) parts_.warnings.push_back(warning);
        const bool splats = std::ranges::any_of(header_.elements, ply_holds_splats);
        context_.expect_faces(parts_, {splats ? std::string(what_splats_are)
                                       : parts_.positions.empty() && !points_and_lines_
                                           ? ""
                                           : "points or lines, which have no volume: make a mesh of them (MeshLab or "
                                             "CloudCompare do)"});
    }

    ParseContext& context_;
    const PlyHeader header_;
    ModelParts parts_;
    FileColours vertex_colours_, face_colours_, material_colours_;
    std::vector<Eigen::Vector4f> of_vertices_, of_faces_;  ///< settled
    std::vector<std::int64_t> vertex_material_;
    std::set<std::size_t> white_;                         ///< vertices or faces that are white for want of a colour
    bool by_face_ = false;                                ///< of the two the second are printed
    std::vector<Eigen::Vector2f> vertex_uv_, corner_uv_;  ///< per vertex; per corner, not a number where there is none
    std::vector<double> corners_;
    std::vector<Face> faces_;
    std::size_t pages_ = 0, without_page_ = 0, points_and_lines_ = 0;
};

/// assimp 5 writes colours as floats where its header says bytes.
bool is_broken_by_assimp(std::span<const std::byte> bytes) {
    constexpr std::size_t header = 4096;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), header));
    const std::string_view before = text.substr(0, text.find("end_header"));
    return before.find("Open Asset Import Library") != before.npos && before.find("format binary") != before.npos &&
           before.find("uchar red") != before.npos;
}

}  // namespace

ModelParts parse_ply(ParseContext& context) {
    try {
        return PlyParser(context).parse();
    } catch (const InputError&) {
        if (!is_broken_by_assimp(context.bytes())) throw;
        throw InputError(fmt::format(
            "{} was written by assimp as binary PLY, whose colours are of another size there than its header "
            "says, so that it cannot be read, and would not be if it were exported again: write it as text "
            "PLY (-fply), OBJ or GLB",
            context.name()));
    }
}

}  // namespace voxtone::io
