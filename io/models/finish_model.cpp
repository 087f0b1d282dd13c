// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/finish_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/models/colour_range.h"
#include "io/models/fill_gutters.h"
#include "io/models/texel_coverage.h"
#include "io/models/weld.h"
#include "io/pictures/picture.h"

namespace voxtone::io {

namespace {

void check(ModelParts& parts, const std::string& name) {
    if (parts.triangles.empty())
        throw InputError(
            fmt::format("{} holds no faces, so there is nothing to print; check that it was exported as a mesh", name));
    std::size_t bad = 0;
    for (const Eigen::Vector3d& p : parts.positions) bad += !p.allFinite();
    if (bad)
        throw InputError(fmt::format(
            "{} of the {} vertices of {} are infinite or not numbers, so that its shape is unknown; export it "
            "again or repair it in a mesh editor",
            bad, parts.positions.size(), name));
    for (const auto& triangle : parts.triangles)
        for (const std::uint32_t corner : triangle)
            if (corner >= parts.positions.size())
                throw InputError(fmt::format("a face of {} uses vertex {}, but there are only {}; the file is damaged",
                                             name, corner, parts.positions.size()));
    if (parts.materials.empty()) parts.materials.emplace_back();
    for (const std::uint32_t material : parts.material_of_triangle)
        if (material >= parts.materials.size())
            throw InputError(fmt::format("a face of {} uses material {}, but there are only {}; the file is damaged",
                                         name, material, parts.materials.size()));
    // Attributes may have been set for the first triangles only.
    if (!parts.corner_uv.empty()) {
        parts.corner_uv.resize(parts.triangles.size(),
                               {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()});
        std::size_t not_finite = 0;
        for (auto& corners : parts.corner_uv)
            for (Eigen::Vector2f& uv : corners)
                if (!uv.allFinite()) {
                    uv.setZero();
                    ++not_finite;
                }
        if (not_finite)
            parts.warnings.push_back(named_warning(
                "damaged",
                fmt::format("{} texture coordinates of {} are infinite or not numbers; they were taken as 0.",
                            not_finite, name)));
    }
    if (!parts.corner_rgba.empty())
        parts.corner_rgba.resize(parts.triangles.size(),
                                 {Eigen::Vector4f::Ones(), Eigen::Vector4f::Ones(), Eigen::Vector4f::Ones()});
}

/// Below one step of eight bits nothing is seen of a colour.
constexpr float least_seen_alpha = 1 / 255.0f;

/// As near as makes no difference on a print: within one in L*.
bool is_white(const Eigen::Vector3f& linear_rgb) { return linear_rgb.minCoeff() > 0.97f; }
bool is_black(const Eigen::Vector3f& linear_rgb) { return linear_rgb.maxCoeff() <= 0; }

/// What tells one prepared picture from another.
struct Variant {
    std::int32_t image;
    bool transparent;
    std::array<float, 4> tint;  // baked in where the picture is transparent: the product is composed as a whole
    std::array<float, 3> under;
    std::int32_t through_image = -1;  // where alpha is kept, and light goes through by a picture; and how
    float through = 0, within = 0;
    std::array<float, 3> glass{1, 1, 1};
    auto operator<=>(const Variant&) const = default;
    [[nodiscard]] bool has_picture() const { return image >= 0 || through_image >= 0; }
};

class Finisher {
public:
    Finisher(ModelParts parts, const std::string& name, const FinishOptions& options)
        : parts_(std::move(parts)), name_(name), options_(options) {}

    ModelFile finish() {
        check(parts_, name_);
        weld_positions(parts_.positions, parts_.triangles);
        drop_unusable_images();
        cover();
        ModelFile file;
        file.wants_colour = parts_.has_colour && some_colour_is_not_white();
        // Where alpha is how clear a print is to be, all of it may be; but for Tr 1 (model_reader.h).
        if (!options_.keep_alpha || parts_.format == "OBJ") keep_invisible_colours();
        make_materials();
        compose_corners();
        report_transparency();
        file.lost_colour = lost_colour();
        if (!file.lost_colour.empty()) parts_.warnings.push_back(named_warning("lost-colour", file.lost_colour));
        file.format = parts_.format;
        file.mm_per_file_unit = parts_.mm_per_file_unit;
        file.has_colour = parts_.has_colour;
        file.warnings = std::move(parts_.warnings);
        file.mesh = std::move(mesh_);
        file.mesh.positions = std::move(parts_.positions);
        file.mesh.triangles = std::move(parts_.triangles);
        file.mesh.material_of_triangle = std::move(parts_.material_of_triangle);
        const bool textured = std::any_of(file.mesh.materials.begin(), file.mesh.materials.end(),
                                          [](const auto& m) { return bool(m.texture); });
        if (textured) file.mesh.corner_uv = std::move(parts_.corner_uv);
        return file;
    }

private:
    /// A texture without coordinates cannot be laid down.
    void drop_unusable_images() {
        std::vector<bool> used(parts_.materials.size());
        for (const std::uint32_t m : parts_.material_of_triangle) used[m] = true;
        for (std::size_t m = 0; m < parts_.materials.size(); ++m) {
            PartMaterial& material = parts_.materials[m];
            if (material.image >= static_cast<std::int32_t>(parts_.images.size())) material.image = -1;
            if (material.through_image >= static_cast<std::int32_t>(parts_.images.size()) || parts_.corner_uv.empty())
                material.through_image = -1;
            if (material.image < 0 || !parts_.corner_uv.empty()) continue;
            if (used[m])
                parts_.lose_colour(fmt::format(
                    "{} has the texture {} but no texture coordinates, so that it cannot be laid on the surface: "
                    "its colours are LOST.",
                    name_, parts_.image_names[static_cast<std::size_t>(material.image)]));
            material.image = -1;
        }
    }

    /// Texels that the mesh uses, per picture over all materials.
    void cover() {
        for (const DecodedImage& image : parts_.images)
            coverage_.emplace_back(image.texels.width_px, image.texels.height_px);
        used_material_.resize(parts_.materials.size());
        for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
            const std::uint32_t m = parts_.material_of_triangle[t];
            used_material_[m] = true;
            const PartMaterial& material = parts_.materials[m];
            if (material.image >= 0)
                coverage_[static_cast<std::size_t>(material.image)].add(parts_.corner_uv[t], material.wrap_u,
                                                                        material.wrap_v);
        }
    }

    bool some_colour_is_not_white() const {
        for (const PartMaterial& material : parts_.materials)
            if (!is_white(material.rgb)) return true;
        for (const auto& corners : parts_.corner_rgba)
            for (const Eigen::Vector4f& rgba : corners)
                if (!is_white(rgba.head<3>()) && (rgba.w() >= least_seen_alpha || !is_black(rgba.head<3>())))
                    return true;
        for (const DecodedImage& image : parts_.images)
            for (std::size_t i = 0; i < image.texels.pixels(); ++i)
                if (image.texels.alpha(i) >= least_seen_alpha && !is_white(image.texels.rgb(i))) return true;
        return false;
    }

    /// What is transparent as a whole was not meant to be: a print of nothing is white.
    void keep_invisible_colours() {
        for (std::size_t m = 0; m < parts_.materials.size(); ++m) {
            PartMaterial& material = parts_.materials[m];
            if (!used_material_[m] || material.opaque || material.alpha >= least_seen_alpha) continue;
            material.alpha = 1;
            invisible_.push_back(fmt::format("the material '{}'", material.name));
        }
        for (std::size_t image = 0; image < parts_.images.size(); ++image) {
            if (!parts_.images[image].has_alpha || !is_invisible(image)) continue;
            TexelImage& texels = parts_.images[image].texels;
            for (std::size_t i = 0; i < texels.pixels(); ++i) texels.set_opaque(i);
            parts_.images[image].has_alpha = false;
            invisible_.push_back(fmt::format("the texture {}", parts_.image_names[image]));
        }
        keep_invisible_corners();
    }

    /// Of a texture: has colour wherever it is used, and none of it would be seen. What it lies on is white: another
    /// colour below is shown by a transparent picture.
    bool is_invisible(std::size_t image) const {
        bool shows_below = true, used = false;
        for (std::size_t m = 0; m < parts_.materials.size(); ++m) {
            if (!used_material_[m] || parts_.materials[m].image != static_cast<std::int32_t>(image)) continue;
            used = true;
            if (parts_.materials[m].opaque || parts_.materials[m].under != Eigen::Vector3f::Ones()) return false;
        }
        if (!used) return false;
        const TexelImage& texels = parts_.images[image].texels;
        for (std::size_t i = 0; i < texels.pixels(); ++i) {
            if (!coverage_[image].used(i)) continue;
            if (texels.alpha(i) >= least_seen_alpha) return false;
            shows_below = shows_below && is_black(texels.rgb(i));
        }
        return !shows_below;
    }

    /// Where no corner would be seen, alpha is not in use, and black is a colour too; else transparent black is what
    /// corners without a colour have.
    void keep_invisible_corners() {
        const auto counts = [&](std::size_t t) { return !parts_.materials[parts_.material_of_triangle[t]].opaque; };
        bool some_seen = false, some_colour = false;
        for (std::size_t t = 0; t < parts_.corner_rgba.size(); ++t)
            for (const Eigen::Vector4f& rgba : parts_.corner_rgba[t]) {
                const bool invisible = rgba.w() < least_seen_alpha;
                some_seen |= !invisible;
                some_colour |= invisible && counts(t) && !is_black(rgba.head<3>());
            }
        if (!some_colour) return;
        std::size_t kept = 0;
        for (std::size_t t = 0; t < parts_.corner_rgba.size(); ++t)
            for (Eigen::Vector4f& rgba : parts_.corner_rgba[t]) {
                if (!counts(t) || !(rgba.w() < least_seen_alpha) || (some_seen && is_black(rgba.head<3>()))) continue;
                rgba.w() = 1;
                ++kept;
            }
        invisible_.push_back(fmt::format("the colours of {} corners", kept));
    }

    /// Pixels in use that are not opaque.
    std::size_t transparent_pixels(std::size_t image) const {
        const TexelImage& texels = parts_.images[image].texels;
        std::size_t count = 0;
        if (parts_.images[image].has_alpha)
            for (std::size_t i = 0; i < texels.pixels(); ++i) count += coverage_[image].used(i) && texels.alpha(i) < 1;
        return count;
    }

    void make_materials() {
        std::map<Variant, std::shared_ptr<const MipPyramid>> pyramids;
        std::vector<Variant> variants;
        for (const PartMaterial& m : parts_.materials) {
            const bool transparent =
                m.image >= 0 && !m.opaque && (m.alpha < 1 || transparent_pixels(static_cast<std::size_t>(m.image)) > 0);
            variants.push_back(
                {m.image, transparent,
                 transparent ? std::array{m.rgb.x(), m.rgb.y(), m.rgb.z(), m.alpha} : std::array{1.f, 1.f, 1.f, 1.f},
                 transparent ? std::array{m.under.x(), m.under.y(), m.under.z()} : std::array{1.f, 1.f, 1.f}});
            if (Variant& v = variants.back(); keeps_alpha(v) && m.through_image >= 0) {
                v.through_image = m.through_image, v.through = m.through, v.within = m.within;
                v.glass = {m.tint.x(), m.tint.y(), m.tint.z()};
            }
        }
        for (std::size_t i = 0; i < variants.size(); ++i)
            if (variants[i].has_picture() && used_material_[i]) wanted_.insert(variants[i]);
        for (std::size_t i = 0; i < variants.size(); ++i) {
            const PartMaterial& part = parts_.materials[i];
            const Variant& variant = variants[i];
            SurfaceMaterial material;
            material.name = part.name, material.rgb = part.rgb;
            if (keeps_alpha(variant)) {
                material.alpha_of_lengths = part.alpha_of_lengths;
                if (!part.opaque) material.alpha = std::clamp(part.alpha, 0.0f, 1.0f);
                if (part.through > 0 && part.through_image < 0) {
                    material.alpha *= 1 - part.through * (1 - part.within);
                    material.rgb.array() *= 1 - part.through * (1 - part.tint.array());
                }
            } else if (variant.transparent) {
                material.rgb.setOnes();
                transparent_materials_ +=
                    part.under == Eigen::Vector3f::Ones();  // else the file itself says what shows through
            } else if (!part.opaque && part.alpha < 1) {
                material.rgb = part.rgb * part.alpha + Eigen::Vector3f::Constant(1 - part.alpha);
                transparent_materials_ += used_material_[i];
            }
            if (variant.has_picture() && used_material_[i]) {
                auto& pyramid = pyramids[variant];
                if (!pyramid) pyramid = prepare(variant);
                const bool nearest = options_.filter == TextureFilter::as_file
                                         ? part.nearest
                                         : options_.filter == TextureFilter::nearest;
                material.texture = std::make_shared<const Texture>(pyramid, part.wrap_u, part.wrap_v, nearest);
                if (const auto alpha = alpha_pyramids_.find(variant); alpha != alpha_pyramids_.end())
                    material.alpha_texture =
                        std::make_shared<const Texture>(alpha->second, part.wrap_u, part.wrap_v, nearest);
            }
            mesh_.materials.push_back(std::move(material));
        }
    }

    /// Of what lies over a colour of the file's own the file itself says what is seen.
    bool keeps_alpha(const Variant& variant) const {
        return options_.keep_alpha && variant.under == std::array{1.f, 1.f, 1.f};
    }

    /// Of a picture that lets light through: as many texels as the larger of both has, each with its colour and alpha.
    TexelImage with_transmission(const TexelImage& colours, const Variant& variant) const {
        const TexelImage& through = parts_.images[static_cast<std::size_t>(variant.through_image)].texels;
        TexelImage out{
            std::max(colours.width_px, through.width_px), std::max(colours.height_px, through.height_px), {}, {}};
        out.linear16.resize(4 * out.pixels());
        const auto at = [&](const TexelImage& image, std::size_t x, std::size_t y) {
            return y * image.height_px / out.height_px * image.width_px + x * image.width_px / out.width_px;
        };
        const Eigen::Array3f glass(variant.glass[0], variant.glass[1], variant.glass[2]);
        for (std::size_t y = 0, i = 0; y < out.height_px; ++y)
            for (std::size_t x = 0; x < out.width_px; ++x, ++i) {
                const std::size_t of_colours = at(colours, x, y), of_through = at(through, x, y);
                // Not a colour: its numbers as they are in the file.
                const float red = float(linear_to_srgb8(through.rgb(of_through).x())) / 255.0f;
                const float share = variant.through * red;
                out.set(i, (colours.rgb(of_colours).array() * (1 - share * (1 - glass))).matrix());
                const float alpha =
                    (variant.transparent ? colours.alpha(of_colours) : 1) * (1 - share * (1 - variant.within));
                out.linear16[4 * i + 3] = static_cast<std::uint16_t>(alpha * 65535.0f + 0.5f);
            }
        return out;
    }

    /// The last of an image's variants takes its texels, which may be most of the memory there is.
    std::shared_ptr<const MipPyramid> prepare(const Variant& variant) {
        wanted_.erase(variant);
        if (variant.image < 0) {
            TexelImage texels = with_transmission(TexelImage{1, 1, {255, 255, 255, 255}, {}}, variant);
            alpha_pyramids_[variant] = std::make_shared<const MipPyramid>(take_alpha(texels));
            return std::make_shared<const MipPyramid>(std::move(texels));
        }
        const auto index = static_cast<std::size_t>(variant.image);
        const bool last =
            variant.through_image != variant.image && std::ranges::none_of(wanted_, [&](const Variant& v) {
                return v.image == variant.image || v.through_image == variant.image;
            });
        TexelImage& image = parts_.images[index].texels;
        TexelImage texels = last ? std::move(image) : image;
        if (options_.fill_gutters) fill_gutters(texels, coverage_[index]);
        if (last) coverage_[index] = TexelCoverage(0, 0);
        if (variant.transparent && looks_premultiplied(texels))
            parts_.warnings.push_back(premultiplied_warning(parts_.image_names[index]));
        if (variant.transparent && !keeps_alpha(variant))
            compose_over(texels, {variant.under[0], variant.under[1], variant.under[2]},
                         {variant.tint[0], variant.tint[1], variant.tint[2]}, variant.tint[3]);
        if (variant.through_image >= 0) texels = with_transmission(texels, variant);
        if (keeps_alpha(variant) && (variant.transparent || variant.through_image >= 0))
            alpha_pyramids_[variant] = std::make_shared<const MipPyramid>(take_alpha(texels));
        return std::make_shared<const MipPyramid>(std::move(texels));
    }

    void compose_corners() {
        if (parts_.corner_rgba.empty()) return;
        mesh_.corner_rgb.resize(parts_.corner_rgba.size());
        if (options_.keep_alpha) mesh_.corner_alpha.resize(parts_.corner_rgba.size());
        std::size_t clamped = 0;
        bool differ_before = false, differ = false;
        const Eigen::Vector3f first = parts_.corner_rgba[0][0].head<3>();
        for (std::size_t t = 0; t < parts_.corner_rgba.size(); ++t) {
            const bool opaque = parts_.materials[parts_.material_of_triangle[t]].opaque;
            for (int c = 0; c < 3; ++c) {
                const Eigen::Vector4f& rgba = parts_.corner_rgba[t][c];
                Eigen::Vector3f rgb = rgba.head<3>();
                for (float& x : rgb) {
                    clamped += !(x >= 0 && x <= 1);
                    x = x > 0 ? std::min(x, 1.0f) : 0.0f;
                }
                differ_before |= rgba.head<3>() != first;
                differ |= rgb != first.cwiseMax(0).cwiseMin(1);
                const float alpha = opaque || !(rgba.w() < 1) ? 1.0f : std::max(rgba.w(), 0.0f);
                if (options_.keep_alpha) {
                    mesh_.corner_alpha[t][c] = alpha;
                    mesh_.corner_rgb[t][c] = rgb;
                    continue;
                }
                transparent_corners_ += alpha < 1;
                mesh_.corner_rgb[t][c] = rgb * alpha + Eigen::Vector3f::Constant(1 - alpha);
            }
        }
        if (clamped)
            parts_.warnings.push_back(named_warning(
                "colour-range", fmt::format("{} values of vertex colours in {} lie outside 0 to 1; they were clamped.",
                                            clamped, name_)));
        if (clamped && differ_before && !differ) parts_.lose_colour(all_clamped_to_one("vertex", name_, 1));
    }

    void report_transparency() {
        if (!invisible_.empty())
            parts_.warnings.push_back(named_warning(
                "transparent",
                fmt::format(
                    "{} has colours that are fully transparent ({}), so that nothing of them would be seen; they were "
                    "taken to be opaque{}.",
                    name_, first_few(invisible_, ", "),
                    parts_.format == "OBJ" ? " (some programs write 'Tr 1' in a material library and mean that)"
                                           : "")));
        if (transparent_materials_ == 0 && transparent_corners_ == 0) return;
        parts_.warnings.push_back(named_warning(
            "transparent",
            fmt::format("{} has transparent colours ({} materials, {} vertex colours); they were laid over white. "
                        "--alpha translucency prints them so that light goes through.",
                        name_, transparent_materials_, transparent_corners_)));
    }

    /// All that is lost, said once: in up to three sentences.
    std::string lost_colour() const {
        std::vector<std::string> all = parts_.lost_colours;
        all.insert(all.end(), parts_.lost_textures.begin(), parts_.lost_textures.end());
        if (const std::string glass = lost_glass(); !glass.empty()) all.push_back(glass);
        return first_few(all, " ");
    }

    std::string lost_glass() const {
        std::vector<std::string> names;
        for (std::size_t m = 0; m < parts_.materials.size(); ++m)
            if (used_material_[m] && parts_.materials[m].glass &&
                !(options_.keep_alpha && parts_.materials[m].through > 0))
                names.push_back(fmt::format("'{}'", printable(parts_.materials[m].name)));
        if (names.empty()) return {};
        if (options_.keep_alpha)
            return fmt::format(
                "{} has materials that let light through diffusely ({}), and no volume says how far: that is LOST, "
                "they are printed opaque. Give them a volume with an attenuation distance, or alpha.",
                name_, first_few(names, ", "));
        return fmt::format(
            "{} has materials of glass ({}); a print of colours is opaque: that one sees through them is LOST. Give "
            "them the colour that they are to have, or --alpha translucency.",
            name_, first_few(names, ", "));
    }

    static std::string first_few(const std::vector<std::string>& all, const char* between) {
        constexpr std::size_t most = 3;
        std::string text;
        for (std::size_t i = 0; i < std::min(all.size(), most); ++i) text += (i ? between : "") + all[i];
        if (all.size() > most) text += fmt::format("{}and {} more", between, all.size() - most);
        return text;
    }

    ModelParts parts_;
    const std::string& name_;
    const FinishOptions options_;
    std::set<Variant> wanted_;                                             ///< that are still to be prepared
    std::map<Variant, std::shared_ptr<const MipPyramid>> alpha_pyramids_;  ///< where alpha is kept
    TexturedMesh mesh_;
    std::vector<TexelCoverage> coverage_;
    std::vector<bool> used_material_;
    std::size_t transparent_materials_ = 0, transparent_corners_ = 0;
    std::vector<std::string> invisible_;  // what was fully transparent and was taken to be opaque
};

}  // namespace

ModelFile finish_model(ModelParts parts, const std::string& name, const FinishOptions& options) {
    return Finisher(std::move(parts), name, options).finish();
}

}  // namespace voxtone::io
