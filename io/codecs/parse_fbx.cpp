// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_fbx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/counted.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/polygon_triangles.h"
#include "io/codecs/tiled_textures.h"
#include "io/models/colour_range.h"
#include "io/pictures/srgb_code.h"
#include "io/scenes/fbx_mesh.h"
#include "io/scenes/fbx_transform.h"
#include "io/scenes/fbx_tree.h"

namespace voxtone::io {

namespace {

/// What shaders call the colour of a surface, and the property that a picture of it hangs on.
constexpr std::array<std::string_view, 9> diffuse_names{"DiffuseColor",
                                                        "Maya|baseColor",
                                                        "Maya|base_color",
                                                        "Maya|TEX_color_map",
                                                        "3dsMax|Parameters|base_color",
                                                        "3dsMax|Parameters|base_color_map",
                                                        "3dsMax|main|baseColor",
                                                        "3dsMax|main|base_color_map",
                                                        "3dsMax|main|baseColorMap"};
constexpr std::array<std::string_view, 5> transparency_names{"TransparentColor", "TransparencyFactor", "Opacity",
                                                             "3dsMax|Parameters|cutout_map", "3dsMax|main|opacity_map"};

Eigen::Vector3f clamped(const Eigen::Vector3d& code) {
    if (!code.allFinite()) return Eigen::Vector3f::Zero();
    return Eigen::Vector3d(code.cwiseMax(0).cwiseMin(1)).cast<float>();
}

/// "Cube" of "Cube\0\1Model", and of "Model::Cube", as it is in text.
std::string plain_name(std::string_view name) {
    if (const std::size_t end = name.find('\0'); end != name.npos) return printable(name.substr(0, end));
    const std::size_t colons = name.find("::");
    return printable(colons == name.npos ? name : name.substr(colons + 2));
}

/// How a texture is laid: placed on the surface by scaling, turning and moving it, of which this is the inverse.
struct FbxTextureLay {
    Eigen::Affine2d onto = Eigen::Affine2d::Identity();
    std::string set;  ///< of coordinates; the first where there is none of that name
};

struct FbxColour {
    PartMaterial as_it_is;  ///< with its texture
    Eigen::Vector3f rgb = Eigen::Vector3f::Ones();
    bool has_map = false;
    std::string file;  ///< of its texture, where it may be one of several tiles
    FbxTextureLay lay;
};

class FbxParser {
public:
    explicit FbxParser(ParseContext& context)
        : context_(context), tree_(context.bytes(), context.name(), context.options().max_unpacked_bytes) {}

    ModelParts parse() {
        parts_.format = "FBX";
        read_lists();
        read_settings();
        for (const auto& [id, node] : objects_)
            if (node->name == "Model" && !has_parent_.contains(id)) read_models(id);
        if (parts_.materials.empty()) parts_.materials.emplace_back();
        tiles_.lay(parts_, context_);
        report();
        return std::move(parts_);
    }

private:
    struct Link {
        std::int64_t child = 0;
        std::string_view property;  ///< of the parent that it hangs on; empty: on the parent itself
    };

    void warn(std::string warning) { parts_.warnings.push_back(std::move(warning)); }

    // ---- objects and their properties

    void read_lists() {
        if (const FbxNode* const objects = tree_.root().child("Objects"))
            for (const FbxNode& object : objects->children)
                if (object.integer(0) != 0) objects_.emplace(object.integer(0), &object);
        if (const FbxNode* const connections = tree_.root().child("Connections"))
            for (const FbxNode& c : connections->children) {
                if (c.text(0) != "OO" && c.text(0) != "OP") continue;
                links_[c.integer(2)].push_back({c.integer(1), c.text(0) == "OP" ? c.text(3) : std::string_view()});
                const FbxNode* const parent = object(c.integer(2));
                if (parent && parent->name == "Model" && c.text(0) == "OO") has_parent_.insert(c.integer(1));
            }
        if (const FbxNode* const definitions = tree_.root().child("Definitions"))
            for (const FbxNode& type : definitions->children)
                if (const FbxNode* const found = type.child("PropertyTemplate")) templates_[type.text(0)] = found;
    }

    const FbxNode* object(std::int64_t id) const {
        const auto found = objects_.find(id);
        return found == objects_.end() ? nullptr : found->second;
    }

    const std::vector<Link>& children(std::int64_t id) const {
        static const std::vector<Link> none;
        const auto found = links_.find(id);
        return found == links_.end() ? none : found->second;
    }

    /// A line "P: name, type, label, flags, values" of an object.
    static const FbxNode* own_property(const FbxNode& object, std::string_view name) {
        const FbxNode* const list = object.child("Properties70");
        if (!list) return nullptr;
        for (const FbxNode& line : list->children)
            if (line.text(0) == name) return &line;
        return nullptr;
    }
    /// The same, or what its kind has where it says nothing.
    const FbxNode* property(const FbxNode& object, std::string_view name) const {
        if (const FbxNode* const own = own_property(object, name)) return own;
        const auto found = templates_.find(object.name);
        return found == templates_.end() ? nullptr : own_property(*found->second, name);
    }
    double number(const FbxNode& object, std::string_view name, double otherwise) const {
        const FbxNode* const found = property(object, name);
        return found && found->values.size() > 4 ? found->real(4) : otherwise;
    }
    static Eigen::Vector3d vector_of(const FbxNode* line, const Eigen::Vector3d& otherwise) {
        return line && line->values.size() > 6 ? Eigen::Vector3d(line->real(4), line->real(5), line->real(6))
                                               : otherwise;
    }
    Eigen::Vector3d vector(const FbxNode& object, std::string_view name,
                           const Eigen::Vector3d& otherwise = Eigen::Vector3d::Zero()) const {
        return vector_of(property(object, name), otherwise);
    }
    std::string_view text_property(const FbxNode& object, std::string_view name) const {
        const FbxNode* const found = property(object, name);
        return found ? found->text(4) : std::string_view();
    }

    void read_settings() {
        static const FbxNode none;
        const FbxNode* const found = tree_.root().child("GlobalSettings");
        const FbxNode& settings = found ? *found : none;
        constexpr double mm_per_cm = 10;
        const double unit = number(settings, "UnitScaleFactor", 1);
        parts_.mm_per_file_unit = mm_per_cm * (unit > 0 && unit < 1e9 ? unit : 1);
        // Right, towards the viewer, up; where they are no three axes, y is up.
        Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
        const std::array<std::string, 3> names{"CoordAxis", "FrontAxis", "UpAxis"};
        const std::array<double, 3> usual{0, 2, 1};
        for (std::size_t i = 0; i < 3; ++i) {
            const double axis = number(settings, names[i], usual[i]), sign = number(settings, names[i] + "Sign", 1);
            if (axis == 0 || axis == 1 || axis == 2)
                axes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(axis)) = sign < 0 ? -1 : 1;
        }
        if (std::abs(axes.determinant()) != 1) axes << 1, 0, 0, 0, 0, 1, 0, 1, 0;
        axes.row(1) *= -1;
        top_.transform.linear() = top_.rotation = axes;
        const FbxNode* const header = tree_.root().child("FBXHeaderExtension");
        for (const FbxNode* node : {&tree_.root(), header})
            if (const FbxNode* const creator = node ? node->child("Creator") : nullptr)
                by_blender_ = by_blender_ || creator->text(0).starts_with("Blender");
    }

    // ---- models

    FbxLocalTransform local_of(const FbxNode& model) const {
        FbxLocalTransform local;
        local.translation = vector(model, "Lcl Translation");
        local.rotation = vector(model, "Lcl Rotation");
        local.scaling = vector(model, "Lcl Scaling", Eigen::Vector3d::Ones());
        local.rotation_offset = vector(model, "RotationOffset");
        local.rotation_pivot = vector(model, "RotationPivot");
        local.scaling_offset = vector(model, "ScalingOffset");
        local.scaling_pivot = vector(model, "ScalingPivot");
        local.inherit = static_cast<int>(std::clamp(number(model, "InheritType", 1), 0.0, 2.0));
        // What an orientation that is not active says is not looked at.
        if (number(model, "RotationActive", 1) == 0 || number(model, "RotationSpaceForLimitOnly", 0) != 0) return local;
        local.pre_rotation = vector(model, "PreRotation");
        local.post_rotation = vector(model, "PostRotation");
        local.rotation_order = static_cast<int>(std::clamp(number(model, "RotationOrder", 0), 0.0, 6.0));
        return local;
    }

    /// Of the mesh alone, not of what hangs below.
    Eigen::Affine3d geometric_of(const FbxNode& model) const {
        Eigen::Affine3d transform = Eigen::Affine3d::Identity();
        transform.linear() = fbx_rotation(vector(model, "GeometricRotation")) *
                             vector(model, "GeometricScaling", Eigen::Vector3d::Ones()).asDiagonal();
        transform.translation() = vector(model, "GeometricTranslation");
        return transform;
    }

    /// A tree of models, with a stack of our own: files may nest deeper than the program's.
    void read_models(std::int64_t root) {
        struct Open {
            std::int64_t id = 0;
            FbxPlace parent;
            bool hidden = false;
        };
        std::vector<Open> open{{root, top_, false}};
        while (!open.empty()) {
            const Open next = open.back();
            open.pop_back();
            const FbxNode& model = *object(next.id);
            if (!visited_.insert(next.id).second) continue;  // of several parents the first
            const FbxPlace place = place_below(next.parent, local_of(model));
            const bool inherits = number(model, "Visibility Inheritance", 1) != 0;
            const bool visible = number(model, "Visibility", 1) != 0 && !(inherits && next.hidden);
            read_model(next.id, model, place.transform, visible && number(model, "Show", 1) != 0);
            std::vector<std::int64_t> below;
            bool levels = false;
            for (const Link& link : children(next.id)) {
                const FbxNode* const child = object(link.child);
                if (!child || !link.property.empty()) continue;
                if (child->name == "Model") below.push_back(link.child);
                levels = levels || (child->name == "NodeAttribute" && child->text(2) == "LodGroup");
            }
            if (levels && below.size() > 1) below.erase(below.begin() + 1, below.end()), ++levels_;
            for (std::size_t i = below.size(); i-- > 0;) open.push_back({below[i], place, !visible});
        }
    }

    void read_model(std::int64_t id, const FbxNode& model, const Eigen::Affine3d& transform, bool visible) {
        std::vector<std::int64_t> materials;
        for (const Link& link : children(id))
            if (const FbxNode* const child = object(link.child); child && child->name == "Material")
                materials.push_back(link.child);
        for (const Link& link : children(id)) {
            const FbxNode* const child = object(link.child);
            if (!child || child->name != "Geometry" || !link.property.empty()) continue;
            const std::string_view type = child->text(2);
            if (!visible) {
                ++hidden_;
            } else if (type == "Mesh") {
                add_mesh(link.child, *child, transform * geometric_of(model), materials);
            } else if (type == "Line" || type.find("Curve") != type.npos) {
                ++lines_;
            } else if (type != "Shape") {
                throw InputError(fmt::format(
                    "{}: '{}' is a surface that is no mesh ({}), which is not read; turn it into polygons and export "
                    "it again",
                    context_.name(), plain_name(model.text(1)), printable(type)));
            }
        }
    }

    // ---- colours

    /// In linear light.
    Eigen::Vector3f linear(const Eigen::Vector3d& colour) const {
        return by_blender_ ? clamped(colour) : srgb_to_linear(clamped(colour));
    }

    const FbxColour& colour(std::int64_t id) {
        const auto [known, added] = colours_.try_emplace(id);
        FbxColour& made = known->second;
        const FbxNode* const material = added ? object(id) : nullptr;
        if (!material) return made;
        made.as_it_is.name = plain_name(material->text(1));
        made.as_it_is.alpha = alpha_of(*material);
        const Eigen::Vector3d none = Eigen::Vector3d::Constant(-1);
        Eigen::Vector3d rgb = none;
        for (const std::string_view name : diffuse_names) {  // of several the last: shaders beside the old properties
            const Eigen::Vector3d own = vector_of(own_property(*material, name), none);
            const char* const share = name == "DiffuseColor" ? "DiffuseFactor" : "Maya|base";
            if (own != none) rgb = own * number(*material, share, 1);
        }
        if (rgb == none) rgb = vector(*material, "DiffuseColor", none) * number(*material, "DiffuseFactor", 1);
        const FbxNode* texture = texture_of(id, diffuse_names);
        const bool black = rgb.maxCoeff() <= 0;
        if (black && !texture) {
            constexpr std::array<std::string_view, 1> glow_names{"EmissiveColor"};
            texture = texture_of(id, glow_names);
            const Eigen::Vector3d glow = vector(*material, "EmissiveColor") * number(*material, "EmissiveFactor", 1);
            if (glow.maxCoeff() > 0) rgb = glow;
            if (texture || glow.maxCoeff() > 0)
                warn(named_warning("which-colour",
                                   fmt::format("The material '{}' has a black colour or none; its emission was taken "
                                               "for its colour.",
                                               made.as_it_is.name)));
        }
        if (rgb.minCoeff() >= 0) {
            parts_.has_colour = true;
            made.rgb = linear(rgb);
            linear_colours_ = linear_colours_ || (by_blender_ && !texture && rgb.maxCoeff() < 1);
        }
        if (texture) read_texture(*texture, made);
        // Alpha of a picture counts where it hangs on transparency, too.
        made.as_it_is.opaque = made.as_it_is.alpha >= 1 && !texture_of(id, transparency_names);
        if (made.as_it_is.image < 0) {
            made.as_it_is.rgb = made.rgb;
        } else if (made.rgb.maxCoeff() - made.rgb.minCoeff() > 0.01f) {
            warn(named_warning("which-colour",
                               fmt::format("The material '{}' has both a texture and a colour; the texture is printed "
                                           "as it is, the colour is left aside.",
                                           made.as_it_is.name)));
        }
        return made;
    }

    /// Opacity where a material says it, else what its transparent colour leaves.
    float alpha_of(const FbxNode& material) const {
        if (const FbxNode* const opacity = own_property(material, "Opacity"); opacity && opacity->values.size() > 4)
            return static_cast<float>(std::clamp(opacity->real(4), 0.0, 1.0));
        const FbxNode *const factor = own_property(material, "TransparencyFactor"), *const colour = own_property(
                                                                                        material, "TransparentColor");
        const double share = factor && factor->values.size() > 4 ? factor->real(4) : 1;
        const double through = vector_of(colour, Eigen::Vector3d::Constant(factor ? 1 : 0)).mean() * share;
        return static_cast<float>(std::clamp(1 - through, 0.0, 1.0));
    }

    const FbxNode* texture_of(std::int64_t material, std::span<const std::string_view> names) {
        for (const Link& link : children(material)) {
            const FbxNode* child = object(link.child);
            if (std::ranges::find(names, link.property) == names.end() || !child) continue;
            if (child->name == "Texture") return child;
            if (child->name != "LayeredTexture") continue;
            std::vector<const FbxNode*> layers;
            for (const Link& below : children(link.child))
                if (const FbxNode* const layer = object(below.child); layer && layer->name == "Texture")
                    layers.push_back(layer);
            if (layers.size() > 1)
                warn(
                    named_warning("which-colour",
                                  fmt::format("The material '{}' has {} textures over each other; the first was taken.",
                                              plain_name(object(material)->text(1)), layers.size())));
            if (!layers.empty()) return layers.front();
        }
        return nullptr;
    }

    static std::string_view text_in(const FbxNode& node, std::string_view child) {
        const FbxNode* const found = node.child(child);
        return found ? found->text(0) : std::string_view();
    }

    void read_texture(const FbxNode& texture, FbxColour& made) {
        parts_.has_colour = made.has_map = true;
        std::vector<std::string> names;
        const auto add_names = [&](const FbxNode& node) {
            for (const char* field : {"RelativeFilename", "FileName", "Filename"})
                if (const std::string name(text_in(node, field)); !name.empty()) names.push_back(name);
        };
        const FbxNode* content = nullptr;
        for (const Link& link : children(texture.integer(0)))
            if (const FbxNode* const video = object(link.child); video && video->name == "Video") {
                add_names(*video);
                const FbxNode* const inside = video->child("Content");
                if (inside && !inside->text(0).empty()) content = inside;
            }
        add_names(texture);
        PartMaterial& material = made.as_it_is;
        const std::string label = names.empty() ? plain_name(texture.text(1)) : printable(names.front());
        if (names.empty() && !content) {
            parts_.lose_texture(
                fmt::format("The texture '{}' of {} is no picture: its colours are LOST and the material's own colour "
                            "is used. Bake "
                            "it into one.",
                            label, context_.name()));
        } else if (content) {
            material.image = context_.add_image_bytes(parts_, label, tree_.content(content), context_.decode_options());
        } else {
            auto there = std::ranges::find_if(
                names, [&](const auto& name) { return tile_file(name, {}) || context_.finds(name); });
            if (there == names.end()) there = names.begin();
            made.file = *there;
            if (!tile_file(*there, {}))
                material.image = context_.add_image_file(parts_, *there, context_.decode_options());
        }
        material.wrap_u = number(texture, "WrapModeU", 0) == 1 ? Wrap::clamp : Wrap::repeat;
        material.wrap_v = number(texture, "WrapModeV", 0) == 1 ? Wrap::clamp : Wrap::repeat;
        made.lay = lay_of(texture);
    }

    FbxTextureLay lay_of(const FbxNode& texture) const {
        const Eigen::Vector3d scale = vector(texture, "Scaling", Eigen::Vector3d::Ones()),
                              scale_pivot = vector(texture, "TextureScalingPivot"),
                              turn_pivot = vector(texture, "TextureRotationPivot");
        const auto moved = [](const Eigen::Vector3d& by) { return Eigen::Translation2d(by.head<2>()); };
        FbxTextureLay lay;
        lay.set = text_property(texture, "UVSet");
        if (scale.head<2>().cwiseAbs().minCoeff() <= 0) return lay;
        if (by_blender_) {  // which writes how coordinates move, but scales and turns as others do, in radians
            lay.onto = moved(vector(texture, "Translation")) * Eigen::Rotation2Dd(-vector(texture, "Rotation").z()) *
                       Eigen::Scaling(1 / scale.x(), 1 / scale.y());
            return lay;
        }
        const Eigen::Affine2d placed =
            moved(vector(texture, "Translation")) * moved(turn_pivot) *
            Eigen::Affine2d(Eigen::Matrix2d(fbx_rotation(vector(texture, "Rotation")).topLeftCorner<2, 2>())) *
            moved(-turn_pivot) * moved(scale_pivot) * Eigen::Scaling(scale.x(), scale.y()) * moved(-scale_pivot);
        if (placed.matrix().allFinite() && std::abs(placed.linear().determinant()) > 1e-12) lay.onto = placed.inverse();
        return lay;
    }

    /// How a face shows its material.
    enum class Shown : char { as_it_is, colours, plain };

    std::uint32_t material(std::int64_t id, Shown shown) {
        const auto [known, added] = made_.try_emplace({id, shown}, static_cast<std::uint32_t>(parts_.materials.size()));
        if (!added) return known->second;
        const FbxColour& found = colour(id);
        PartMaterial made = found.as_it_is;
        if (shown == Shown::as_it_is && !found.file.empty()) tiles_.note(known->second, found.file);
        if (shown != Shown::as_it_is) {
            made.image = -1;
            made.opaque = false;
            made.rgb = shown == Shown::plain ? found.rgb : Eigen::Vector3f::Ones();
        }
        parts_.materials.push_back(std::move(made));
        return known->second;
    }

    // ---- meshes

    const FbxMesh& mesh_of(std::int64_t id, const FbxNode& geometry) {
        const auto [known, added] = meshes_.try_emplace(id);
        if (!added) return known->second;
        known->second = fbx_mesh(tree_, geometry);
        for (FbxLayer& layer : known->second.colours)
            if (std::ranges::all_of(layer.values, [](double value) { return value == 1; })) layer.values.clear();
        std::erase_if(known->second.colours, [](const FbxLayer& layer) { return layer.values.empty(); });
        if (!known->second.colours.empty()) make_linear(known->second.colours.front().values);
        for (const Link& link : children(id))
            if (const FbxNode* const child = object(link.child); child && child->name == "Deformer") {
                ++deformed_;
                break;
            }
        return known->second;
    }

    /// Colours of whatever range the file has them.
    void make_linear(std::vector<double>& values) {
        FileColours given;
        given.has_alpha = true;
        for (std::size_t i = 0; i + 3 < values.size(); i += 4)
            given.value.emplace_back(values[i], values[i + 1], values[i + 2], values[i + 3]);
        std::vector<std::string> said;
        values.clear();
        for (const Eigen::Vector4f& rgba : settled_colours(given, "vertex", context_.name(), said))
            for (const float value : rgba) values.push_back(static_cast<double>(value));
        for (std::string& warning : said)
            if (std::ranges::find(parts_.warnings, warning) == parts_.warnings.end()) warn(std::move(warning));
    }

    static const FbxLayer* uv_of(const FbxMesh& mesh, const std::string& set) {
        for (const FbxLayer& layer : mesh.uv)
            if (layer.name == set) return &layer;
        return mesh.uv.empty() ? nullptr : &mesh.uv.front();
    }

    void add_mesh(std::int64_t id, const FbxNode& geometry, const Eigen::Affine3d& transform,
                  const std::vector<std::int64_t>& materials) {
        const FbxMesh& mesh = mesh_of(id, geometry);
        lines_ += mesh.thin;
        if (mesh.polygons.empty()) return;
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        check_size(mesh.vertices.size());
        for (const Eigen::Vector3d& vertex : mesh.vertices) parts_.positions.push_back(transform * vertex);
        const bool mirrored = transform.linear().determinant() < 0;
        std::vector<Eigen::Vector3d> outline;
        for (const FbxPolygon& polygon : mesh.polygons) {
            outline.clear();
            for (std::size_t c = 0; c < polygon.corners; ++c)
                outline.push_back(parts_.positions[first + mesh.corner(polygon, c).vertex]);
            const std::int64_t m = material_of(mesh, mesh.corner(polygon, 0), materials);
            const FbxColour& look = colour(m);
            const FbxLayer* const uv = uv_of(mesh, look.lay.set);
            const Shown shown = shown_on(mesh, look, uv);
            for (std::array<std::uint32_t, 3> triangle : polygon_triangles(outline, context_.name())) {
                if (mirrored) std::swap(triangle[1], triangle[2]);
                std::array<FbxCorner, 3> corners;
                std::array<std::uint32_t, 3> vertices{};
                for (std::size_t c = 0; c < 3; ++c) {
                    corners[c] = mesh.corner(polygon, triangle[c]);
                    vertices[c] = first + static_cast<std::uint32_t>(corners[c].vertex);
                }
                const std::size_t t = parts_.add_triangle(vertices, material(m, shown));
                if (uv) set_uv(t, *uv, look.lay, corners);
                if (shown == Shown::colours) set_colours(t, mesh.colours.front(), corners);
            }
            check_size(0);
        }
    }

    Shown shown_on(const FbxMesh& mesh, const FbxColour& look, const FbxLayer* uv) {
        const bool textured = look.has_map && uv, painted = !mesh.colours.empty();
        if (look.has_map && !uv) ++without_coordinates_;
        if (textured && painted) left_aside_ = true;
        if (textured) return Shown::as_it_is;
        if (painted) parts_.has_colour = true;
        return painted ? Shown::colours : look.has_map ? Shown::plain : Shown::as_it_is;
    }

    /// A number of an object; 0, which is the scene itself: the mesh has none there.
    std::int64_t material_of(const FbxMesh& mesh, const FbxCorner& corner, const std::vector<std::int64_t>& materials) {
        if (materials.empty()) return 0;
        if (!mesh.materials) return materials.front();
        const std::optional<std::size_t> place = mesh.materials->at(corner);
        const double most = static_cast<double>(materials.size()),
                     number = place ? mesh.materials->values[*place] : most;
        if (number >= 0 && number < most) return materials[static_cast<std::size_t>(number)];
        without_material_ += number >= most;  // below 0: none is meant
        return 0;
    }

    void set_uv(std::size_t t, const FbxLayer& layer, const FbxTextureLay& lay,
                const std::array<FbxCorner, 3>& corners) {
        std::array<Eigen::Vector2f, 3> uv;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::optional<std::size_t> place = layer.at(corners[c]);
            unlaid_ += !place;
            uv[c].setZero();
            if (place)
                uv[c] = (lay.onto * Eigen::Vector2d(layer.values[*place], layer.values[*place + 1])).cast<float>();
        }
        parts_.set_uv(t, uv);
    }

    void set_colours(std::size_t t, const FbxLayer& layer, const std::array<FbxCorner, 3>& corners) {
        std::array<Eigen::Vector4f, 3> rgba;
        for (std::size_t c = 0; c < 3; ++c) {
            rgba[c].setOnes();
            const std::optional<std::size_t> place = layer.at(corners[c]);
            unpainted_ += !place;
            if (!place) continue;
            rgba[c] = Eigen::Map<const Eigen::Vector4d>(layer.values.data() + *place).cast<float>();
        }
        parts_.set_rgba(t, rgba);
    }

    /// Meshes that are used again and again make much of a little file.
    void check_size(std::size_t more_vertices) const {
        constexpr std::uint64_t bytes_each = 32;
        if (std::max(parts_.triangles.size(), parts_.positions.size() + more_vertices) >
            context_.options().max_unpacked_bytes / bytes_each)
            throw InputError(fmt::format(
                "{} comes to more than {} vertices or triangles, by meshes that are used again; export it with fewer",
                context_.name(), context_.options().max_unpacked_bytes / bytes_each));
    }

    // ---- what is said

    void report() {
        if (without_coordinates_)
            parts_.lose_colour(fmt::format(
                "{} of {} have a material with a texture and no texture coordinates: its colours are LOST there and "
                "the material's own colour is used.",
                counted(without_coordinates_, "face"), context_.name()));
        if (without_material_)
            parts_.lose_colour(
                fmt::format("{} of {} name materials that their models do not have: their colours are "
                            "LOST. Export it again.",
                            counted(without_material_, "face"), context_.name()));
        if (unlaid_ || unpainted_)
            parts_.lose_colour(
                fmt::format("{} of {} have no texture coordinate or no colour, where others have one: "
                            "their colours are LOST. Export it again.",
                            counted(unlaid_ + unpainted_, "corner"), context_.name()));
        if (linear_colours_)
            warn(named_warning("which-colour",
                               fmt::format("{} was written by Blender, whose colours of materials are linear; they "
                                           "were read as such.",
                                           context_.name())));
        if (left_aside_)
            warn(named_warning("which-colour",
                               fmt::format("{} has textures and colours of vertices on the same faces; the textures "
                                           "are printed.",
                                           context_.name())));
        if (lines_)
            warn(named_warning("no-volume", fmt::format("{} has {}; they have no volume and are left aside.",
                                                        context_.name(), counted(lines_, "line"))));
        const auto left_out = [&](std::size_t count, const char* what, const char* how) {
            if (count)
                warn(named_warning("left-out",
                                   fmt::format("{} has {}: {}.", context_.name(), counted(count, what), how)));
        };
        left_out(deformed_, "skinned or blended model", "they are taken as they are stored, before skins and shapes");
        left_out(hidden_, "hidden model", "what is hidden is left aside");
        left_out(levels_, "LOD group", "the first level of each was taken");
        const auto curves =
            std::ranges::count_if(objects_, [](const auto& o) { return o.second->name == "AnimationCurve"; });
        left_out(static_cast<std::size_t>(curves), "animation curve", "animations are left aside");
        for (const std::string& warning : context_.side_file_warnings()) warn(warning);
        context_.expect_faces(
            parts_, {lines_ ? "lines or curves, which have no volume: make a mesh of them in a mesh editor" : "",
                     hidden_ ? "hidden meshes: show what is to be printed and export it again" : ""});
    }

    ParseContext& context_;
    FbxTree tree_;
    ModelParts parts_;
    FbxPlace top_;  ///< from the file's axes to z up
    TiledTextures tiles_;
    bool by_blender_ = false, linear_colours_ = false, left_aside_ = false;
    std::map<std::int64_t, const FbxNode*> objects_;
    std::map<std::int64_t, std::vector<Link>> links_;  ///< by the parent
    std::map<std::string_view, const FbxNode*> templates_;
    std::set<std::int64_t> has_parent_, visited_;
    std::map<std::int64_t, FbxColour> colours_;
    std::map<std::pair<std::int64_t, Shown>, std::uint32_t> made_;
    std::map<std::int64_t, FbxMesh> meshes_;
    std::size_t lines_ = 0, hidden_ = 0, levels_ = 0, deformed_ = 0, without_coordinates_ = 0, without_material_ = 0,
                unlaid_ = 0, unpainted_ = 0;
};

}  // namespace

ModelParts parse_fbx(ParseContext& context) { return FbxParser(context).parse(); }

}  // namespace voxtone::io
