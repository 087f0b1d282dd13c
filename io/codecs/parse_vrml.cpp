// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_vrml.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "base/counted.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/polygon_triangles.h"
#include "io/files/deflate.h"
#include "io/models/colour_range.h"
#include "io/models/model_text.h"
#include "io/pictures/srgb_code.h"
#include "io/scenes/vrml_shapes.h"

namespace voxtone::io {

namespace {

bool is_one_of(std::string_view type, std::string_view list) {
    return (" " + std::string(list) + " ").find(" " + std::string(type) + " ") != std::string::npos;
}

constexpr std::string_view
    groups = "Group Transform Anchor Billboard Collision",
    without_shape =
        "Background Fog NavigationInfo Viewpoint WorldInfo DirectionalLight PointLight SpotLight "
        "Sound AudioClip Script TimeSensor TouchSensor CylinderSensor PlaneSensor "
        "ProximitySensor SphereSensor VisibilitySensor",
    animations =
        "ColorInterpolator CoordinateInterpolator NormalInterpolator OrientationInterpolator "
        "PositionInterpolator ScalarInterpolator",
    flat = "PointSet IndexedLineSet Text";

/// Three numbers of a field.
Eigen::Vector3d vector_of(const VrmlNode& node, std::string_view field, const Eigen::Vector3d& otherwise) {
    const std::vector<double>& numbers = node.numbers(field);
    return numbers.size() < 3 ? otherwise : Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

Eigen::Vector2d pair_of(const VrmlNode& node, std::string_view field, const Eigen::Vector2d& otherwise) {
    const std::vector<double>& numbers = node.numbers(field);
    return numbers.size() < 2 ? otherwise : Eigen::Vector2d(numbers[0], numbers[1]);
}

Eigen::Matrix3d rotation_of(const VrmlNode& node, std::string_view field) {
    const std::vector<double>& numbers = node.numbers(field);
    const Eigen::Vector3d axis = vector_of(node, field, Eigen::Vector3d::Zero());
    if (numbers.size() < 4 || !(axis.norm() > 0)) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(numbers[3], axis.normalized()).toRotationMatrix();
}

/// Clause 6.52: T C R SR S -SR -C.
Eigen::Affine3d transform_of(const VrmlNode& node) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero(), centre = vector_of(node, "center", zero);
    const Eigen::Matrix3d turn = rotation_of(node, "scaleOrientation");
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    transform.linear() = rotation_of(node, "rotation") * turn *
                         vector_of(node, "scale", Eigen::Vector3d::Ones()).asDiagonal() * turn.transpose();
    transform.translation() = vector_of(node, "translation", zero) + centre - transform.linear() * centre;
    return transform;
}

/// How an appearance lays its picture: clause 6.50, -C S R C T.
struct TextureLay {
    Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
    Eigen::Vector2d before = Eigen::Vector2d::Zero(), after = Eigen::Vector2d::Zero();

    explicit TextureLay(const VrmlNode* node) {
        if (!node) return;
        const Eigen::Vector2d zero = Eigen::Vector2d::Zero(), centre = pair_of(*node, "center", zero);
        linear = pair_of(*node, "scale", Eigen::Vector2d::Ones()).asDiagonal() *
                 Eigen::Rotation2Dd(node->number("rotation", 0)).toRotationMatrix();
        before = pair_of(*node, "translation", zero) + centre;
        after = -centre;
    }
    [[nodiscard]] Eigen::Vector2f operator()(const Eigen::Vector2f& uv) const {
        return (linear * (uv.cast<double>() + before) + after).cast<float>();
    }
};

class VrmlParser {
public:
    explicit VrmlParser(ParseContext& context) : context_(context), text_(text_of(context)) {
        if (text_.starts_with("#VRML V1.0"))
            throw InputError(fmt::format(
                "{} is a scene of VRML 1.0, and only VRML 2 (VRML97) can be read; export it as VRML 2, GLB or OBJ",
                context.name()));
        if (!text_.starts_with("#VRML V2.0"))
            throw InputError(fmt::format(
                "{} does not begin with '#VRML V2.0', as VRML 2 does; export it again, as VRML 2, GLB or OBJ",
                context.name()));
        scene_ = read_vrml(text_, context.name());
    }

    ModelParts parse() {
        parts_.format = "VRML";
        Eigen::Affine3d z_up = Eigen::Affine3d::Identity();
        z_up.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
        for (const std::uint32_t root : scene_.roots) read_node(root, z_up);
        if (parts_.materials.empty()) parts_.materials.emplace_back();
        say_what_was_left();
        return std::move(parts_);
    }

private:
    static std::string text_of(const ParseContext& context) {
        const std::span<const std::byte> bytes = context.bytes();
        if (bytes.size() < 2 || bytes[0] != std::byte{0x1f} || bytes[1] != std::byte{0x8b}) return model_text(bytes);
        try {
            return model_text(gunzipped(bytes, context.options().max_unpacked_bytes));
        } catch (const InputError& error) {
            throw InputError(fmt::format("{} is packed by gzip, and that {}; export it again, unpacked", context.name(),
                                         error.what()));
        }
    }

    [[noreturn]] void refuse(const VrmlNode& node, const std::string& why) const {
        throw InputError(fmt::format("{}, line {}: {}", context_.name(), node.line, why));
    }
    void warn(std::string warning) {
        if (std::ranges::find(parts_.warnings, warning) == parts_.warnings.end())
            parts_.warnings.push_back(std::move(warning));
    }

    // ---- groups

    void read_nodes(const VrmlNode& parent, std::string_view field, const Eigen::Affine3d& transform) {
        if (const VrmlField* const found = parent.field(field))
            for (const std::uint32_t child : found->nodes) read_node(child, transform);
    }

    void read_node(std::uint32_t index, const Eigen::Affine3d& transform) {
        const VrmlNode& node = scene_.nodes[index];
        if (++visits_ > most_visits_)
            refuse(node, fmt::format("with USE it has more than {} nodes; export it without", most_visits_));
        if (node.type == "Shape") return read_shape(node, transform);
        if (node.type == "Transform") return read_nodes(node, "children", transform * transform_of(node));
        if (is_one_of(node.type, groups)) return read_nodes(node, "children", transform);
        if (node.type == "LOD" || node.type == "Switch") return read_choice(node, transform);
        if (node.type == "Inline")
            refuse(node, fmt::format("a part of the model lies in the file '{}' (Inline), which is not read; save all "
                                     "in one file, or give that one",
                                     printable(first_name(node))));
        if (is_one_of(node.type, animations)) has_animations_ = true;
        if (is_one_of(node.type, without_shape) || is_one_of(node.type, animations)) return;
        if (holds_shape(node)) refuse_unknown(node);
        unknown_.insert(printable(node.type));
    }

    /// Of a Switch what it shows, of levels of detail the finest.
    void read_choice(const VrmlNode& node, const Eigen::Affine3d& transform) {
        const bool levels = node.type == "LOD";
        const VrmlField* const all = node.field(levels ? "level" : "choice");
        if (!all || all->nodes.empty()) return;
        const double shown = levels ? 0 : node.number("whichChoice", -1);
        if (shown >= 0 && shown < static_cast<double>(all->nodes.size()))
            read_node(all->nodes[static_cast<std::size_t>(shown)], transform);
        else
            ++hidden_;
    }

    [[noreturn]] void refuse_unknown(const VrmlNode& node) const {
        refuse(node,
               fmt::format("'{}' is not read, so that a part of the model would be missing; export the model with "
                           "faces (IndexedFaceSet), or as GLB or OBJ",
                           printable(node.type)));
    }

    bool holds_shape(const VrmlNode& node) {
        if (++visits_ > most_visits_ || node.type == "Shape" || node.type == "Inline" || node.type == "Extrusion" ||
            is_vrml_shape(node.type))
            return true;
        for (const VrmlField& field : node.fields)
            for (const std::uint32_t child : field.nodes)
                if (holds_shape(scene_.nodes[child])) return true;
        return false;
    }

    static std::string first_name(const VrmlNode& node) {
        const VrmlField* const url = node.field("url");
        return url && !url->strings.empty() ? url->strings.front() : "";
    }

    // ---- colours

    struct MadeMaterial {
        std::uint32_t index = 0;  ///< of the parts
        bool shows_colours = false;
    };

    /// Of an appearance, on faces that have colours of their own or none.
    MadeMaterial material(const VrmlNode* appearance, bool coloured) {
        const auto [known, added] = made_.try_emplace({appearance, coloured});
        if (!added) return known->second;
        const VrmlNode* const material = appearance ? scene_.node(*appearance, "material") : nullptr;
        const VrmlNode* const texture = appearance ? scene_.node(*appearance, "texture") : nullptr;
        PartMaterial made;
        for (const VrmlNode* node : {appearance, material})
            if (node && !node->name.empty()) made.name = printable(node->name);
        if (made.name.empty() && appearance) made.name = fmt::format("of line {}", appearance->line);
        if (material) take_colour(*material, made, coloured || texture);
        if (texture) take_texture(*texture, made);
        const bool hidden = made.image >= 0 && !shades_.contains(made.image);
        if (hidden && differs(made.rgb)) warn_of_plain(made);
        if (hidden || coloured) made.rgb.setOnes();
        known->second = {static_cast<std::uint32_t>(parts_.materials.size()), coloured && !hidden};
        parts_.materials.push_back(std::move(made));
        return known->second;
    }

    static bool differs(const Eigen::Vector3f& rgb) { return rgb.maxCoeff() - rgb.minCoeff() > 0.01f; }

    void warn_of_plain(const PartMaterial& made) {
        warn(
            named_warning("which-colour",
                          fmt::format("The material '{}' has both a texture and a diffuseColor; the texture is printed "
                                      "as it is, the colour is left aside.",
                                      made.name)));
    }

    void take_colour(const VrmlNode& material, PartMaterial& made, bool covered) {
        const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::nan(""));
        Eigen::Vector3d code = vector_of(material, "diffuseColor", none);
        const Eigen::Vector3d glow = vector_of(material, "emissiveColor", none);
        if (!(code.maxCoeff() > 0) && glow.maxCoeff() > 0) {
            code = glow;
            if (!covered)
                warn(named_warning("which-colour",
                                   fmt::format("The material '{}' has a black diffuseColor or none; its emissiveColor "
                                               "was taken for its colour.",
                                               made.name)));
        }
        made.alpha = static_cast<float>(std::clamp(1 - material.number("transparency", 0), 0.0, 1.0));
        if (!code.allFinite()) return;
        parts_.has_colour = true;
        const bool whole = code == Eigen::Vector3d(code.array().floor());
        code /= colour_range(code.maxCoeff(), ColourNumbers::reals, whole);
        made.rgb = srgb_to_linear(Eigen::Vector3f(code.cwiseMax(0).cwiseMin(1).cast<float>()));
    }

    void take_texture(const VrmlNode& texture, PartMaterial& made) {
        if (texture.type == "ImageTexture")
            made.image = image(texture);
        else if (texture.type == "PixelTexture")
            made.image = pixels(texture);
        else
            parts_.lose_texture(fmt::format(
                "The texture '{}' of {} is a {}, which is not read: its colours are LOST and the material's own colour "
                "is used. Use an ImageTexture.",
                printable(first_name(texture)), context_.name(), printable(texture.type)));
        made.wrap_u = texture.number("repeatS", 1) != 0 ? Wrap::repeat : Wrap::clamp;
        made.wrap_v = texture.number("repeatT", 1) != 0 ? Wrap::repeat : Wrap::clamp;
        // A picture's own transparency stands for the material's.
        if (made.image >= 0 && parts_.images[static_cast<std::size_t>(made.image)].has_alpha) made.alpha = 1;
    }

    std::int32_t image(const VrmlNode& texture) {
        const VrmlField* const url = texture.field("url");
        if (!url || url->strings.empty()) return -1;
        parts_.has_colour = true;
        for (const std::string& name : url->strings)
            if (context_.finds(name)) return context_.add_image_file(parts_, name, context_.decode_options());
        return context_.add_image_file(parts_, url->strings.front(), context_.decode_options());
    }

    /// Clause 5.5: width, height, components, then a number a pixel, from the lower left.
    std::int32_t pixels(const VrmlNode& texture) {
        if (const auto known = pixels_.find(&texture); known != pixels_.end()) return known->second;
        const std::vector<double>& numbers = texture.numbers("image");
        std::int32_t& index = pixels_[&texture] = -1;
        if (numbers.size() < 3 || numbers[0] == 0 || numbers[1] == 0) return index;
        parts_.has_colour = true;
        const double width = numbers[0], height = numbers[1], components = numbers[2];
        const auto limit = static_cast<double>(std::min<std::uint64_t>(context_.options().max_pixels, 1u << 31));
        if (!(width >= 1 && height >= 1 && width * height <= std::min(limit, static_cast<double>(numbers.size() - 3)) &&
              components >= 1 && components <= 4)) {
            parts_.lose_texture(
                fmt::format("The PixelTexture on line {} of {} has {} pixels for {} x {} of {} components: its colours "
                            "are LOST and "
                            "the material's own colour is used.",
                            texture.line, context_.name(), numbers.size() - 3, width, height, components));
            return index;
        }
        DecodedImage image;
        const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
        image.texels.width_px = columns;
        image.texels.height_px = rows;
        const int parts = static_cast<int>(components);
        for (std::size_t i = 0; i < std::size_t{columns} * rows; ++i) {
            const double number = numbers[3 + (rows - 1 - i / columns) * columns + i % columns];
            const auto value = number >= 0 && number <= 0xffffffff ? static_cast<std::uint32_t>(number) : 0u;
            const auto byte = [&](int from_end) { return static_cast<std::uint8_t>(value >> (8 * from_end)); };
            const int alpha_parts = parts % 2 == 0, first = parts - 1;
            const std::uint8_t alpha = alpha_parts ? byte(0) : 255;
            for (int c = 0; c < 3; ++c) image.texels.srgb8.push_back(byte(parts < 3 ? first : first - c));
            image.texels.srgb8.push_back(alpha);
            image.has_alpha = image.has_alpha || alpha < 255;
        }
        index = static_cast<std::int32_t>(parts_.images.size());
        if (parts < 3) shades_.insert(index);
        parts_.images.push_back(std::move(image));
        parts_.image_names.push_back(fmt::format("of line {}", texture.line));
        return index;
    }

    // ---- shapes

    void read_shape(const VrmlNode& shape, const Eigen::Affine3d& transform) {
        const VrmlNode* const geometry = scene_.node(shape, "geometry");
        if (!geometry) return;
        if (is_one_of(geometry->type, flat)) {
            flat_.insert(std::string(geometry->type));
            return;
        }
        if (!is_vrml_shape(geometry->type)) refuse_unknown(*geometry);
        const VrmlFaces faces = vrml_faces(scene_, *geometry, context_.name());
        const VrmlNode* const appearance = scene_.node(shape, "appearance");
        const bool has_colours = !faces.colours.empty();
        const MadeMaterial made = material(appearance, has_colours);
        parts_.has_colour = parts_.has_colour || has_colours;
        left_aside_ = left_aside_ || (has_colours && !made.shows_colours);
        by_count_ = by_count_ || (faces.by_count && made.shows_colours);
        thin_ += faces.thin;
        const bool textured = parts_.materials[made.index].image >= 0;
        if (made.shows_colours && faces.uncoloured) say_missing(faces.uncoloured, "colour", *geometry);
        if (textured && faces.unlaid) say_missing(faces.unlaid, "place in the texture", *geometry);
        const TextureLay lay(appearance ? scene_.node(*appearance, "textureTransform") : nullptr);
        const bool laid = geometry->field("texCoord") || (appearance && appearance->field("texture"));
        const std::vector<Eigen::Vector4f> colours = made.shows_colours ? linear_of(faces.colours) : no_colours_;
        add_faces(faces, transform, made.index, laid ? &lay : nullptr, colours);
    }

    /// Of whatever range the file has them.
    std::vector<Eigen::Vector4f> linear_of(const std::vector<Eigen::Vector3f>& colours) {
        FileColours given;
        for (const Eigen::Vector3f& colour : colours)
            given.value.emplace_back(static_cast<double>(colour.x()), static_cast<double>(colour.y()),
                                     static_cast<double>(colour.z()), 1.0);
        std::vector<std::string> said;
        std::vector<Eigen::Vector4f> made = settled_colours(given, "vertex", context_.name(), said);
        for (std::string& warning : said) warn(std::move(warning));
        return made;
    }

    void say_missing(std::size_t corners, const char* what, const VrmlNode& geometry) {
        parts_.lose_colour(fmt::format(
            "{} of the faces on line {} of {} have no {}, where others have one: their colours are LOST. Export it "
            "again.",
            counted(corners, "corner"), geometry.line, context_.name(), what));
    }

    /// `colours`: of the faces', linear; empty: they show none.
    void add_faces(const VrmlFaces& faces, const Eigen::Affine3d& transform, std::uint32_t m, const TextureLay* lay,
                   const std::vector<Eigen::Vector4f>& colours) {
        check_size(faces.points.size());
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (const Eigen::Vector3d& point : faces.points) parts_.positions.push_back(transform * point);
        const bool mirrored = transform.linear().determinant() < 0;
        std::vector<Eigen::Vector3d> outline;
        std::size_t begin = 0;
        for (const std::size_t end : faces.ends) {
            const auto polygon = std::span(faces.corners).subspan(begin, end - begin);
            begin = end;
            outline.clear();
            for (const VrmlCorner& corner : polygon)
                outline.push_back(parts_.positions[first + static_cast<std::size_t>(corner.point)]);
            for (std::array<std::uint32_t, 3> triangle : polygon_triangles(outline, context_.name())) {
                if (mirrored) std::swap(triangle[1], triangle[2]);
                add_triangle(faces, {polygon[triangle[0]], polygon[triangle[1]], polygon[triangle[2]]}, first, m, lay,
                             colours);
            }
            check_size(0);
        }
    }

    void add_triangle(const VrmlFaces& faces, const std::array<VrmlCorner, 3>& corners, std::uint32_t first,
                      std::uint32_t m, const TextureLay* lay, const std::vector<Eigen::Vector4f>& colours) {
        std::array<std::uint32_t, 3> vertices{};
        std::array<Eigen::Vector2f, 3> uv;
        std::array<Eigen::Vector4f, 3> rgba;
        for (std::size_t c = 0; c < 3; ++c) {
            const VrmlCorner& corner = corners[c];
            vertices[c] = first + static_cast<std::uint32_t>(corner.point);
            uv[c].setZero();
            rgba[c].setOnes();
            if (lay && corner.uv >= 0) uv[c] = (*lay)(faces.uv[static_cast<std::size_t>(corner.uv)]);
            if (!colours.empty() && corner.colour >= 0) rgba[c] = colours[static_cast<std::size_t>(corner.colour)];
        }
        const std::size_t t = parts_.add_triangle(vertices, m);
        if (lay) parts_.set_uv(t, uv);
        if (!colours.empty()) parts_.set_rgba(t, rgba);
    }

    /// Names that are used again and again make much of a little file.
    void check_size(std::size_t more_points) const {
        constexpr std::uint64_t bytes_each = 32;
        if (std::max(parts_.triangles.size(), parts_.positions.size() + more_points) >
            context_.options().max_unpacked_bytes / bytes_each)
            throw InputError(
                fmt::format("{} comes to more than {} points or triangles, by shapes that are used again (USE); export "
                            "it with fewer",
                            context_.name(), context_.options().max_unpacked_bytes / bytes_each));
    }

    // ---- what is said

    void say_what_was_left() {
        if (by_count_)
            warn(named_warning("which-colour",
                               fmt::format("{} has as many colours of vertices as faces, and fewer than vertices; they "
                                           "were taken for those of the faces.",
                                           context_.name())));
        if (left_aside_)
            warn(named_warning("which-colour",
                               fmt::format("{} has textures and colours on the same faces; the textures are printed.",
                                           context_.name())));
        if (!flat_.empty() || thin_)
            warn(named_warning("no-volume",
                               fmt::format("{} has points, lines or flat text ({}{}); they have no volume and are left "
                                           "aside.",
                                           context_.name(), fmt::join(flat_, ", "),
                                           thin_ ? fmt::format("{}{} with two corners", flat_.empty() ? "" : ", ",
                                                               counted(thin_, "face"))
                                                 : "")));
        if (has_animations_)
            warn(named_warning("left-out", fmt::format("{} has animations; they are left aside.", context_.name())));
        if (hidden_)
            warn(named_warning("left-out", fmt::format("{} has {} that show nothing (Switch); what they hold is left "
                                                       "aside.",
                                                       context_.name(), counted(hidden_, "choice"))));
        if (!unknown_.empty())
            warn(named_warning("left-out",
                               fmt::format("{} has nodes that VRML 2 has not ({}); they hold no shapes and are left "
                                           "aside.",
                                           context_.name(), fmt::join(unknown_, ", "))));
        for (const std::string& warning : context_.side_file_warnings()) warn(warning);
        context_.expect_faces(
            parts_,
            {flat_.empty() && !thin_ ? ""
                                     : "points, lines or flat text, which have no volume: make a mesh of them in a "
                                       "mesh editor",
             hidden_ ? "choices that show nothing (Switch): show what is to be printed and export it again" : ""});
    }

    static constexpr std::size_t most_visits_ = 4'000'000;

    ParseContext& context_;
    const std::string text_;  ///< the scene points into it
    VrmlScene scene_;
    ModelParts parts_;
    std::map<std::pair<const VrmlNode*, bool>, MadeMaterial> made_;
    std::map<const VrmlNode*, std::int32_t> pixels_;
    std::set<std::int32_t> shades_;  ///< pictures of greys, which colours below shine through
    std::set<std::string> flat_, unknown_;
    const std::vector<Eigen::Vector4f> no_colours_ = {};
    std::size_t visits_ = 0, thin_ = 0, hidden_ = 0;
    bool left_aside_ = false, by_count_ = false, has_animations_ = false;
};

}  // namespace

ModelParts parse_vrml(ParseContext& context) { return VrmlParser(context).parse(); }

}  // namespace voxtone::io
