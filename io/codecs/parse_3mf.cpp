// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_3mf.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/cut_volumes.h"
#include "io/codecs/texture_baker.h"
#include "io/codecs/threemf_part.h"
#include "io/models/model_text.h"
#include "io/models/painted_triangles.h"
#include "io/models/slicer_roles.h"
#include "io/models/threemf_namespace.h"
#include "io/models/threemf_package.h"
#include "optics/layered/translucency_alpha.h"

namespace voxtone::io {

namespace {

constexpr int deepest_component = 64;
constexpr std::size_t most_instances = 1'000'000, most_triangles = std::size_t{1} << 28;

std::string_view text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What a required extension brings, by its name space.
std::string_view what_extends(std::string_view extension) {
    static constexpr std::pair<std::string_view, std::string_view> known[]{
        {"/beamlattice/", "a beam lattice"},
        {"/slice/", "slices in place of its mesh"},
        {"/booleanoperations/", "boolean operations of bodies"},
        {"/displacement/", "a displaced surface"},
        {"/volumetric/", "colours or shapes given by a volume (Volumetric Extension 1.0.0)"},
        {"/implicit/", "shapes given by formulas"}};
    for (const auto& [part, words] : known)
        if (extension.find(part) != extension.npos) return words;
    return "something that is not known here";
}

bool is_utf16(const std::vector<std::byte>& bytes) {
    const std::string_view text = text_of(bytes);
    return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
}

Eigen::Vector4f to_linear(const Eigen::Vector4f& code) {
    const Eigen::Vector3f rgb = srgb_to_linear(Eigen::Vector3f(code.head<3>()));
    return {rgb.x(), rgb.y(), rgb.z(), code.w()};
}

/// What a property means at one corner.
struct Corner {
    Eigen::Vector4f rgba = Eigen::Vector4f::Ones();  // linear; what lies under the texture, if there is one
    Eigen::Vector2f uv = Eigen::Vector2f::Zero();
    std::uint32_t texture = no_property;  // texture2d on top of the colour
    bool alpha_of_lengths = false;
};

class ThreemfParser {
public:
    explicit ThreemfParser(ParseContext& context)
        : context_(context), package_(context.bytes(), context.name(), context.options().max_unpacked_bytes) {}

    ModelParts parse() {
        parts_.format = "3MF";
        parts_.materials.emplace_back().name = "(colours)";
        const std::string root = package_.root_part();
        read_slicer_files();
        const ThreemfPart& part = load(root);
        parts_.mm_per_file_unit = part.mm_per_unit;
        if (part.items.empty()) {
            warn(named_warning(
                "damaged",
                fmt::format(
                    "{} has no build items, so that nothing in it is meant to be printed; all its objects were taken.",
                    context_.name())));
            std::set<std::uint32_t> used;
            for (const auto& [id, object] : part.objects)
                for (const ThreemfReference& component : object.components) used.insert(component.object);
            for (const auto& [id, object] : part.objects)
                if (!used.contains(id))
                    add_object(root, {id, {}, Eigen::Affine3d::Identity()}, Eigen::Affine3d::Identity(), 0);
        }
        std::size_t off = 0;
        for (const ThreemfReference& item : part.items) {
            if (item.printable)
                add_object(root, item, Eigen::Affine3d::Identity(), 0);
            else
                ++off;
        }
        if (off > 0 && off == part.items.size())
            throw InputError(
                fmt::format("all {} items of {} are switched off (printable=\"0\"); switch on in the slicer "
                            "what is to be printed",
                            off, context_.name()));
        if (off > 0)
            warn(named_warning(
                "left-out", fmt::format("{} items of {} are switched off (printable=\"0\"); they are left aside.", off,
                                        context_.name())));
        lay_baked();
        colour_by_filament();
        cut_volumes(parts_, cuts_, context_.name());
        if (!cuts_.empty() && parts_.triangles.empty())
            throw InputError(fmt::format("nothing is left of {} when its negative volumes are cut out of its parts",
                                         context_.name()));
        report();
        if (!modifiers_.empty())
            say_why_nothing("modifiers or blockers of support, which are no body: export the body with them");
        if (package_.has_ending(".gcode"))
            say_why_nothing("instructions for a printer (G-code): save the slicer's project itself as 3MF");
        context_.expect_faces(parts_, why_nothing_);
        return std::move(parts_);
    }

private:
    void warn(std::string warning) { parts_.warnings.push_back(std::move(warning)); }
    /// A kind of loss, said once however often it occurs.
    void lose(const std::string& warning) { ++losses_[warning]; }
    void lose_colour(const std::string& warning) { ++colour_losses_[warning]; }

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{} is no valid 3MF file: {}; export it again", context_.name(), what));
    }

    void read_slicer_files() {
        for (const char* file : {"/Metadata/Slic3r_PE_model.config", "/Metadata/model_settings.config"}) try {
                if (const auto part = package_.find(file))
                    read_slicer_volumes(text_of(package_.read(*part)), context_.name() + ":" + file, roles_);
            } catch (const InputError& error) {
                warn(named_warning(
                    "damaged",
                    fmt::format("What a slicer says of its parts could not be read ({}); all are taken for bodies.",
                                error.what())));
            }
        for (const char* file : {"/Metadata/Slic3r_PE.config", "/Metadata/project_settings.config"})
            if (const auto part = package_.find(file)) read_slicer_colours(text_of(package_.read(*part)), roles_);
        by_extruder_ = roles_.tells_colours();
        if (by_extruder_ && roles_.colours.empty())
            lose_colour(
                fmt::format("{} tells its parts apart by extruder and does not say what colours these have: "
                            "their colours are LOST. Export the model with colour groups or as OBJ or GLB",
                            context_.name()));
    }

    /// Whether a part of this role has a place in the print: bodies, and what is cut out of them. `first`: its first
    /// triangle.
    bool has_place(SlicerRole role, std::uint32_t parent, std::uint32_t object, std::size_t first = 0) {
        if (role == SlicerRole::modifier) modifiers_.insert({parent, object, first});
        return role != SlicerRole::modifier;
    }

    /// Triangles from `first` on are of a part of this role.
    void note_volume(VolumeCut& cut, SlicerRole role, std::size_t first) const {
        const TriangleRange range{first, parts_.triangles.size()};
        if (range.first < range.last) (role == SlicerRole::negative ? cut.tools : cut.bodies).push_back(range);
    }
    void note_cut(VolumeCut cut) {
        if (!cut.tools.empty()) cuts_.push_back(std::move(cut));
    }

    const ThreemfPart& load(const std::string& path) {
        if (const auto known = model_parts_.find(path); known != model_parts_.end()) return known->second;
        const std::vector<std::byte> bytes = package_.read(path);
        const std::string what = context_.name() + ":" + path;
        ThreemfPart& part = model_parts_[path] =
            parse_threemf_part(is_utf16(bytes) ? model_text(bytes) : text_of(bytes), what);
        part.path = path;
        for (const std::string& extension : part.required_extensions) {
            if (is_understood(threemf_namespace(extension))) continue;
            if (extension.find("/securecontent/") != std::string::npos)
                throw InputError(fmt::format("{} is encrypted; export it without protection", context_.name()));
            throw InputError(
                fmt::format("{} has {}, without which it is not to be read (extension {}): what would be printed is "
                            "not what is meant. Export it as a plain mesh",
                            context_.name(), what_extends(extension), printable(extension)));
        }
        return part;
    }

    /// `parent_object`: of which it is a component.
    void add_object(const std::string& part_path, const ThreemfReference& reference, const Eigen::Affine3d& parent,
                    int depth, std::uint32_t parent_object = no_property) {
        if (depth > deepest_component) fail("its components are nested too deep, or hold themselves");
        if (++instances_ > most_instances) fail(fmt::format("it has more than {} components", most_instances));
        const std::string path = reference.path.empty() ? part_path : part_named(reference.path, part_path);
        const ThreemfPart& part = load(path);
        const auto found = part.objects.find(reference.object);
        if (found == part.objects.end())
            fail(fmt::format("object {} is used, but does not exist in {}", reference.object, path));
        const ThreemfObject& object = found->second;
        Eigen::Affine3d transform = parent * reference.transform;
        transform.linear() *= part.mm_per_unit / load(part_path).mm_per_unit;  // each part has a unit of its own
        if (object.type == "support" || object.type == "solidsupport" || object.type == "other") {
            lose(fmt::format("{} has objects of the type '{}', which are no part of the model; they are left aside",
                             context_.name(), object.type));
            say_why_nothing(
                fmt::format("an object of the type '{}', which is no part of the model: make it one in the "
                            "program that wrote it",
                            object.type));
            return;
        }
        note_other_shapes(part, object);
        VolumeCut cut;
        for (const ThreemfReference& component : object.components) {
            const SlicerRole role = roles_.of(reference.object, component.object).role;
            if (!has_place(role, reference.object, component.object)) continue;
            const std::size_t before = parts_.triangles.size();
            add_object(path, component, transform, depth + 1, reference.object);
            note_volume(cut, role, before);
        }
        note_cut(std::move(cut));
        if (!object.triangles.empty()) add_mesh(part, object, transform, {parent_object, reference.object});
    }

    /// What an object is of besides its triangles.
    void note_other_shapes(const ThreemfPart& part, const ThreemfObject& object) {
        if (part.is_translucent && !context_.options().keep_alpha)
            lose_colour(
                fmt::format("{} has materials that light goes through (translucentdisplayproperties); a print of "
                            "colours is opaque: that one sees through them is LOST. Give them the colour that they are "
                            "to have, or --alpha translucency",
                            context_.name()));
        if (!object.volume.empty() && !part.plain_volumes.contains(object.volume)) {
            parts_.has_colour = true;
            lose_colour(
                fmt::format("{} gives colours by a volume (volumedata {}, Volumetric Extension 1.0.0), which is not "
                            "read: they are LOST. Export it with colours of vertices or a texture",
                            context_.name(), printable(object.volume)));
        }
        if (part.shaping_volumes.contains(object.volume))
            lose_colour(
                fmt::format("{} shapes a mesh by a volume (boundary of volumedata {}, Volumetric Extension), which "
                            "is not read: that shape is LOST, the mesh is taken whole. Export the shape as a mesh",
                            context_.name(), printable(object.volume)));
        if (object.has_beams) {
            lose_colour(
                fmt::format("{} has a beam lattice, which cannot be read: its beams are LOST. Export it as a mesh",
                            context_.name()));
            say_why_nothing("a beam lattice, which cannot be read: export it as a mesh");
        } else if (!object.other_shape.empty()) {
            const std::string kind = printable(object.other_shape);
            if (object.triangles.empty() && object.components.empty())
                lose_colour(fmt::format(
                    "{} has a body whose shape is a '{}', which cannot be read: it is LOST. Export it as a mesh",
                    context_.name(), kind));
            say_why_nothing(fmt::format("a shape of the kind '{}', which cannot be read: export it as a mesh", kind));
        } else if (object.triangles.empty() && !object.vertices.empty()) {
            say_why_nothing("an object of points without triangles: export it as a mesh");
        }
    }

    void say_why_nothing(std::string why) {
        if (std::ranges::find(why_nothing_, why) == why_nothing_.end()) why_nothing_.push_back(std::move(why));
    }

    /// A part that another one names.
    std::string part_named(const std::string& path, const std::string& from) {
        const auto found = package_.find(path, from);
        if (!found) fail(fmt::format("it has no part '{}'; in it {}", printable(path), package_.parts_there()));
        return *found;
    }

    struct PlacedMesh {
        std::uint32_t first_vertex;
        std::size_t vertices;
        bool mirrored;
    };

    void add_mesh(const ThreemfPart& part, const ThreemfObject& object, const Eigen::Affine3d& transform,
                  const std::pair<std::uint32_t, std::uint32_t>& ids) {
        if (parts_.triangles.size() + object.triangles.size() > most_triangles ||
            parts_.positions.size() + object.vertices.size() > std::size_t{no_property})
            fail(fmt::format("its components add up to more than {} triangles", most_triangles));
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        const PaintedMesh painted = cut_painted(object);
        for (const Eigen::Vector3d& vertex : painted.first.empty() ? object.vertices : painted.vertices)
            parts_.positions.push_back(transform * vertex);
        const PlacedMesh placed{first, parts_.positions.size() - first, transform.linear().determinant() < 0};
        std::size_t number = 0;
        VolumeCut cut;
        for (const SlicerSpan& span : roles_.spans(ids.first, ids.second, object.triangles.size())) {
            const std::size_t before = parts_.triangles.size();
            if (has_place(span.volume.role, ids.first, ids.second, number))
                for (; number < span.end; ++number)
                    add_pieces(part, object, number, painted, placed, span.volume.extruder);
            note_volume(cut, span.volume.role, before);
            number = span.end;
        }
        note_cut(std::move(cut));
    }

    /// Cut up where triangles are painted in parts and it is known in which colours; else empty.
    PaintedMesh cut_painted(const ThreemfObject& object) const {
        if (object.paint_in_parts.empty() || roles_.colours.empty()) return {};
        const auto has_corner = [&](std::uint32_t corner) { return corner < object.vertices.size(); };
        const bool in_order = std::ranges::all_of(
            object.triangles, [&](const ThreemfTriangle& t) { return std::ranges::all_of(t.corners, has_corner); });
        if (!in_order) return {};
        std::vector<PaintInput> triangles;
        for (const ThreemfTriangle& t : object.triangles)
            triangles.push_back({{t.corners, t.paint.extruder}, {}, has_property(object, t)});
        for (const auto& [number, paint] : object.paint_in_parts) triangles[number].paint = paint;
        return cut_by_paint(object.vertices, triangles);
    }

    /// Of the model's own, which comes before what a slicer painted.
    static bool has_property(const ThreemfObject& object, const ThreemfTriangle& t) {
        const bool own = t.p[0] != no_property;
        return (own && t.pid != no_property ? t.pid : object.pid) != no_property &&
               (own ? t.p[0] : object.pindex) != no_property;
    }

    void add_pieces(const ThreemfPart& part, const ThreemfObject& object, std::size_t number,
                    const PaintedMesh& painted, const PlacedMesh& placed, int extruder) {
        ThreemfTriangle triangle = object.triangles[number];
        if (!has_property(object, triangle)) {
            painted_ += triangle.paint.extruder > 0 || triangle.paint.is_divided;
            painted_otherwise_ += triangle.paint.is_divided && !object.paint_in_parts.contains(number);
        }
        if (painted.first.empty()) return add_triangle(part, object, triangle, placed, extruder);
        const bool in_parts = object.paint_in_parts.contains(number);
        for (std::size_t i = painted.first[number]; i < painted.first[number + 1]; ++i) {
            triangle.corners = painted.pieces[i].corners;
            if (in_parts) triangle.paint = {painted.pieces[i].extruder, false};
            add_triangle(part, object, triangle, placed, extruder);
        }
    }

    void add_triangle(const ThreemfPart& part, const ThreemfObject& object, const ThreemfTriangle& triangle,
                      const PlacedMesh& placed, int extruder) {
        std::array<std::uint32_t, 3> corners = triangle.corners;
        for (const std::uint32_t corner : corners)
            if (corner >= placed.vertices)
                fail(fmt::format("a triangle uses vertex {}, but its object has {}", corner, object.vertices.size()));
        std::array<std::uint32_t, 3> p{triangle.p[0], triangle.p[1] == no_property ? triangle.p[0] : triangle.p[1],
                                       triangle.p[2] == no_property ? triangle.p[0] : triangle.p[2]};
        std::uint32_t pid = triangle.pid;
        if (pid == no_property) pid = object.pid;
        if (p[0] == no_property) {
            pid = object.pid;
            p = {object.pindex, object.pindex, object.pindex};
        }
        if (placed.mirrored) {
            std::swap(corners[1], corners[2]);
            std::swap(p[1], p[2]);
        }
        const std::uint32_t v = placed.first_vertex;
        const std::size_t t = parts_.add_triangle({v + corners[0], v + corners[1], v + corners[2]}, 0);
        if (pid != no_property && p[0] != no_property)
            colour_triangle(part, t, pid, p);
        else
            note_filament(t, triangle.paint, extruder);
    }

    /// By which filament it is printed; what no extruder is named for is printed by the first.
    void note_filament(std::size_t t, const TrianglePaint& paint, int extruder) {
        if (roles_.colours.empty()) return;
        filament_.resize(t + 1, 0);
        filament_[t] = paint.extruder > 0 ? paint.extruder : static_cast<std::uint16_t>(std::max(extruder, 1));
    }

    /// Where filaments tell parts apart, or paint.
    void colour_by_filament() {
        if (painted_ > 0 && roles_.colours.empty())
            lose_colour(
                fmt::format("{} has {} painted in a slicer and does not say what colours the filaments have: their "
                            "colours are LOST. Export the model with colour groups or as OBJ or GLB",
                            context_.name(), counted(painted_, "triangle")));
        if (roles_.colours.empty() || (painted_ == 0 && !by_extruder_)) return;
        if (painted_otherwise_ > 0)
            lose_colour(fmt::format(
                "{} of {} painted triangles of {} are painted in a way that is not known: their colours are "
                "LOST. Export the model with colour groups or as OBJ or GLB",
                painted_otherwise_, painted_, context_.name()));
        for (std::size_t t = 0; t < filament_.size(); ++t)
            if (filament_[t] > 0) colour_by_extruder(t, filament_[t]);
        for (const std::size_t extruder : uncoloured_extruders_)
            lose_colour(fmt::format("{} has parts of extruder {} and does not say what colour it has: theirs is LOST",
                                    context_.name(), extruder));
    }

    void colour_by_extruder(std::size_t t, std::size_t extruder) {
        if (extruder > roles_.colours.size() || !roles_.colours[extruder - 1]) {
            uncoloured_extruders_.insert(extruder);
            return;
        }
        const Eigen::Vector3f rgb = srgb_to_linear(*roles_.colours[extruder - 1]);
        const Eigen::Vector4f rgba(rgb.x(), rgb.y(), rgb.z(), 1);
        parts_.set_rgba(t, {rgba, rgba, rgba});
        parts_.has_colour = true;
    }

    void colour_triangle(const ThreemfPart& part, std::size_t t, std::uint32_t pid, std::array<std::uint32_t, 3> p) {
        const auto group = part.groups.find(pid);
        if (group == part.groups.end())
            return lose_colour(
                fmt::format("{}: triangles use the property group {}, which does not exist: their colours are LOST",
                            context_.name(), pid));
        // Base materials and their composites have no gradients: the first corner's holds for all.
        using Kind = ThreemfGroup::Kind;
        if (group->second.kind == Kind::base_materials || group->second.kind == Kind::composites) p[1] = p[2] = p[0];
        if (group->second.kind == Kind::multi && bake(t, layers_of(part, group->second, p))) return;
        std::array<Corner, 3> corner;
        for (int c = 0; c < 3; ++c) corner[c] = resolve(part, group->second, p[c], 0);
        if (group->second.kind == Kind::unknown) return;
        parts_.has_colour = true;
        if (corner[0].texture != no_property) return lay_texture(part, t, corner);
        if (corner[0].rgba != Eigen::Vector4f::Ones() || corner[1].rgba != Eigen::Vector4f::Ones() ||
            corner[2].rgba != Eigen::Vector4f::Ones())
            parts_.set_rgba(t, {corner[0].rgba, corner[1].rgba, corner[2].rgba});
        if (corner[0].alpha_of_lengths) parts_.material_of_triangle[t] = clear_material();
    }

    /// Colours that light goes through: how far, lengths of the file say.
    std::uint32_t clear_material() {
        if (clear_material_ == no_property) {
            clear_material_ = static_cast<std::uint32_t>(parts_.materials.size());
            PartMaterial& material = parts_.materials.emplace_back();
            material.name = "(clear colours)", material.alpha_of_lengths = true;
        }
        return clear_material_;
    }

    /// Layers of a multiproperty over a triangle, from the bottom up.
    std::vector<BakedLayer> layers_of(const ThreemfPart& part, const ThreemfGroup& group,
                                      const std::array<std::uint32_t, 3>& p) {
        std::vector<BakedLayer> layers;
        for (std::size_t member = 0; member < group.members.size(); ++member) {
            BakedLayer layer;
            bool is_there = true;
            layer.multiply = member > 0 && member - 1 < group.multiply.size() && group.multiply[member - 1];
            for (int c = 0; c < 3; ++c) {
                if (p[c] >= group.values.size())
                    fail(fmt::format("a triangle uses item {} of a {}, which has {}", p[c], group.element,
                                     group.values.size()));
                const Corner corner = member_at(part, group, member, group.values[p[c]]);
                layer.uv[c] = corner.uv;
                layer.rgba[c] = corner.rgba;
                if (corner.texture == no_property) continue;
                layer.image = picture_index(part, corner.texture);
                is_there = layer.image >= 0;
                if (!is_there) continue;
                const ThreemfTexture& texture = part.textures.find(corner.texture)->second;
                layer.wrap_u = texture.wrap_u;
                layer.wrap_v = texture.wrap_v;
            }
            if (is_there) layers.push_back(layer);
        }
        return layers;
    }

    /// One picture of them all, where neither the topmost texture nor the colours alone would do.
    bool bake(std::size_t t, const std::vector<BakedLayer>& layers) {
        if (!need_baking(layers)) return false;
        const auto patch = baker_.bake(layers, parts_.images);
        if (!patch) return false;
        parts_.has_colour = true;
        baked_.push_back({t, *patch});
        return true;
    }

    bool need_baking(const std::vector<BakedLayer>& layers) const {
        const auto is_picture = [](const BakedLayer& layer) { return layer.image >= 0; };
        const auto first = std::find_if(layers.begin(), layers.end(), is_picture);
        if (first == layers.end()) return false;
        if (first + 1 != layers.end()) return true;  // something lies over it
        const bool shows_below = first->multiply || parts_.images[static_cast<std::size_t>(first->image)].has_alpha;
        const auto is_gradient = [](const BakedLayer& layer) {
            return layer.rgba[0] != layer.rgba[1] || layer.rgba[0] != layer.rgba[2];
        };
        return first != layers.begin() && shows_below &&
               (first->multiply || std::any_of(layers.begin(), first, is_gradient));
    }

    /// The pages are pictures like others; before, nobody knows how high they are.
    void lay_baked() {
        std::vector<std::array<Eigen::Vector2f, 3>> uv;
        for (const auto& [t, patch] : baked_) uv.push_back(baker_.uv_of(patch));
        const auto first_material = static_cast<std::uint32_t>(parts_.materials.size());
        for (DecodedImage& page : baker_.take_pages()) {
            PartMaterial& material = parts_.materials.emplace_back();
            material.name = "(layers)";
            material.image = static_cast<std::int32_t>(parts_.images.size());
            material.wrap_u = material.wrap_v = Wrap::clamp;
            parts_.images.push_back(std::move(page));
            parts_.image_names.emplace_back("(layers)");
        }
        for (std::size_t n = 0; n < baked_.size(); ++n) {
            const auto& [t, patch] = baked_[n];
            parts_.material_of_triangle[t] = first_material + static_cast<std::uint32_t>(patch.page);
            parts_.set_uv(t, uv[n]);
        }
    }

    void lay_texture(const ThreemfPart& part, std::size_t t, const std::array<Corner, 3>& corner) {
        // A transparent texture shows what lies under it. That colour is laid under the picture as a whole, so it has
        // to be the same at all three corners.
        const Eigen::Vector4f &a = corner[0].rgba, &b = corner[1].rgba, &c = corner[2].rgba;
        Eigen::Vector4f under = a;
        if (a != b || a != c) {
            under = (a + b + c) / 3;
            lose(fmt::format("{}: a texture lies over a colour gradient; its mean is taken under each triangle",
                             context_.name()));
        }
        const std::uint32_t material = texture_material(part, corner[0].texture, under);
        parts_.material_of_triangle[t] = material;
        if (parts_.materials[material].image >= 0)
            parts_.set_uv(t, {corner[0].uv, corner[1].uv, corner[2].uv});
        else if (under != Eigen::Vector4f::Ones())
            parts_.set_rgba(t, {under, under, under});
    }

    std::uint32_t texture_material(const ThreemfPart& part, std::uint32_t id, const Eigen::Vector4f& under) {
        const auto key = std::make_tuple(part.path, id, std::array{under.x(), under.y(), under.z(), under.w()});
        if (const auto known = materials_.find(key); known != materials_.end()) return known->second;
        const auto index = static_cast<std::uint32_t>(parts_.materials.size());
        PartMaterial material;
        material.image = picture_index(part, id);
        if (const auto found = part.textures.find(id); found != part.textures.end()) {
            const ThreemfTexture& texture = found->second;
            material.name = std::filesystem::path(texture.path).stem().string();
            material.wrap_u = texture.wrap_u;
            material.wrap_v = texture.wrap_v;
            material.nearest = texture.nearest;
            material.under = under.head<3>() * under.w() + Eigen::Vector3f::Constant(1 - under.w());
        }
        parts_.materials.push_back(material);
        return materials_[key] = index;
    }

    /// Of a texture2d; -1, and said, where there is none.
    std::int32_t picture_index(const ThreemfPart& part, std::uint32_t id) {
        const auto found = part.textures.find(id);
        if (found == part.textures.end()) {
            parts_.lose_texture(fmt::format("{} uses the texture {}, which does not exist: its colours are LOST.",
                                            context_.name(), id));
            return -1;
        }
        const std::string& written = found->second.path;
        const std::string path = package_.find(written, part.path).value_or(written);
        if (const auto known = pictures_.find(path); known != pictures_.end()) return known->second;
        const auto picture = picture_of(path);
        if (!picture)
            parts_.lose_texture(
                fmt::format("The texture '{}' that {} names is not in it (there {}): its colours are "
                            "LOST.",
                            written, context_.name(), package_.parts_there()));
        return pictures_[path] =
                   picture ? context_.add_image_bytes(parts_, path, *picture, context_.decode_options()) : -1;
    }

    std::optional<std::vector<std::byte>> picture_of(const std::string& path) const {
        const auto found = package_.find(path);
        if (!found) return std::nullopt;
        try {
            return package_.read(*found);
        } catch (const InputError&) {  // a damaged part: said as missing
            return std::nullopt;
        }
    }

    /// What index `p` of a group means at a corner. `level` guards multiproperties of multiproperties.
    Corner resolve(const ThreemfPart& part, const ThreemfGroup& group, std::uint32_t p, int level) {
        using Kind = ThreemfGroup::Kind;
        Corner corner;
        const auto check = [&](std::size_t size) {
            if (p >= size) fail(fmt::format("a triangle uses item {} of a {}, which has {}", p, group.element, size));
        };
        switch (group.kind) {
            case Kind::base_materials:
            case Kind::colours:
                check(group.rgba.size());
                corner.rgba = to_linear(group.rgba[p]);
                if (context_.options().keep_alpha) take_alpha_of_display(part, group, p, corner);
                break;
            case Kind::texture:
                check(group.uv.size());
                corner.uv = group.uv[p];
                corner.texture = group.refers_to;
                break;
            case Kind::composites:
                check(group.values.size());
                corner.rgba = mix(part, group, group.values[p]);
                break;
            case Kind::multi:
                check(group.values.size());
                corner = stack(part, group, group.values[p], level);
                break;
            case Kind::unknown:
                lose_colour(fmt::format("{} has properties of the kind '{}', which cannot be read: they are LOST",
                                        context_.name(), group.element));
                break;
        }
        return corner;
    }

    /// Translucency alpha of a material that light goes through. The file says what is lost of a beam, absorbed or
    /// scattered: what all colours lose alike is taken for scattered, the rest for absorbed.
    static void take_alpha_of_display(const ThreemfPart& part, const ThreemfGroup& group, std::uint32_t p,
                                      Corner& corner) {
        const auto display = part.groups.find(group.display);
        if (display == part.groups.end() || p >= display->second.attenuation.size()) return;
        const std::vector<double>& per_m = display->second.attenuation[p];
        if (per_m.size() != 3 || !std::ranges::all_of(per_m, [](double a) { return a >= 0 && std::isfinite(a); }))
            return;
        constexpr double cm_per_m = 100;
        const double mean = (per_m[0] + per_m[1] + per_m[2]) / 3, alike = std::ranges::min(per_m);
        corner.rgba.w() *= static_cast<float>(
            optics::translucency_alpha(optics::translucency_eta((mean - alike) / cm_per_m, alike / cm_per_m)));
        corner.alpha_of_lengths = true;
    }

    /// The display colours of a composite, mixed by their shares in linear light.
    Eigen::Vector4f mix(const ThreemfPart& part, const ThreemfGroup& group, const std::vector<double>& shares) {
        lose(fmt::format(
            "{} has composite materials; what they are mixed from is LOST, only their display colours are mixed",
            context_.name()));
        const auto base = part.groups.find(group.refers_to);
        if (base == part.groups.end() || base->second.kind != ThreemfGroup::Kind::base_materials)
            fail("a composite has no base materials");
        Eigen::Vector4f sum = Eigen::Vector4f::Zero();
        double total = 0;
        for (std::size_t i = 0; i < shares.size() && i < group.members.size(); ++i) {
            if (group.members[i] >= base->second.rgba.size())
                fail("a composite uses a base material that does not exist");
            if (!(shares[i] > 0) || !std::isfinite(shares[i])) continue;
            sum += static_cast<float>(shares[i]) * to_linear(base->second.rgba[group.members[i]]);
            total += shares[i];
        }
        return total > 0 ? Eigen::Vector4f(sum / static_cast<float>(total)) : Eigen::Vector4f(Eigen::Vector4f::Ones());
    }

    /// What member `i` of a multiproperty means at a corner.
    Corner member_at(const ThreemfPart& part, const ThreemfGroup& group, std::size_t i,
                     std::span<const double> indices) {
        const auto member = part.groups.find(group.members[i]);
        if (member == part.groups.end())
            fail(fmt::format("a multiproperty uses the group {}, which does not exist", group.members[i]));
        const double index = i < indices.size() ? indices[i] : 0;
        if (!(index >= 0 && index < 4e9)) fail("a multiproperty has an index that is no index");
        return resolve(part, member->second, static_cast<std::uint32_t>(index), 1);
    }

    /// Layers of a multiproperty from the bottom up: colours as the specification says; of textures the topmost is
    /// kept.
    Corner stack(const ThreemfPart& part, const ThreemfGroup& group, const std::vector<double>& indices, int level) {
        if (level > 0) fail("a multiproperty refers to another one");
        Corner corner;
        int textures = 0;
        bool colour_over_texture = false;
        for (std::size_t i = 0; i < group.members.size(); ++i) {
            const Corner layer = member_at(part, group, i, indices);
            const bool multiply = i > 0 && i - 1 < group.multiply.size() && group.multiply[i - 1];
            if (layer.texture != no_property) {
                ++textures;
                corner.texture = layer.texture;
                corner.uv = layer.uv;
                if (multiply)
                    lose(fmt::format(
                        "{}: a texture multiplies what lies under it (multiproperties); it is laid over it instead",
                        context_.name()));
            } else {
                colour_over_texture |= textures > 0;
                corner.rgba = i == 0 ? layer.rgba : lay_over(corner.rgba, layer.rgba, multiply);
            }
        }
        if (textures > 1)
            lose_colour(fmt::format(
                "{} lays several textures over each other (multiproperties), more than can be made into one; only "
                "the topmost is kept there, the colours of the others are LOST. Bake them into one texture",
                context_.name()));
        if (colour_over_texture)
            lose_colour(
                fmt::format("{} lays a colour over a texture (multiproperties); it is taken under it instead. Bake "
                            "them into one texture",
                            context_.name()));
        return corner;
    }

    void report() {
        const auto sentence = [](const std::string& what, std::size_t times) {
            return times > 1 ? fmt::format("{} ({} times).", what, times) : what + ".";
        };
        for (const std::string& warning : package_.warnings()) warn(warning);
        if (!modifiers_.empty())
            warn(named_warning(
                "left-out",
                fmt::format("{} has {} that {} no part of the body (modifiers or blockers of support); left aside.",
                            context_.name(), counted(modifiers_.size(), "volume"),
                            modifiers_.size() == 1 ? "is" : "are")));
        for (const auto& [what, times] : losses_) warn(named_warning("which-colour", sentence(what, times)));
        for (const auto& [what, times] : colour_losses_) parts_.lose_colour(sentence(what, times));
    }

    ParseContext& context_;
    ThreemfPackage package_;
    ModelParts parts_;
    std::map<std::string, ThreemfPart> model_parts_;
    std::map<std::tuple<std::string, std::uint32_t, std::array<float, 4>>, std::uint32_t> materials_;
    std::uint32_t clear_material_ = no_property;
    std::map<std::string, std::int32_t> pictures_;  // by path
    TextureBaker baker_;
    std::vector<std::pair<std::size_t, TextureBaker::Patch>> baked_;  // triangles and their patches
    std::map<std::string, std::size_t> losses_, colour_losses_;
    std::size_t instances_ = 0;
    SlicerRoles roles_;
    bool by_extruder_ = false;             ///< parts are told apart by the colours of their filaments
    std::vector<std::uint16_t> filament_;  ///< of triangles without a colour of their own, from 1; 0: none
    std::set<std::size_t> uncoloured_extruders_;
    std::size_t painted_ = 0, painted_otherwise_ = 0;  ///< triangles
    std::vector<VolumeCut> cuts_;                      ///< volumes of slicers that are cut out of others
    std::set<std::tuple<std::uint32_t, std::uint32_t, std::size_t>> modifiers_;  ///< volumes that are no body
    std::vector<std::string> why_nothing_;                                       ///< why what is there is no body
};

}  // namespace

ModelParts parse_3mf(ParseContext& context) { return ThreemfParser(context).parse(); }

}  // namespace voxtone::io
