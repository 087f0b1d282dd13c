// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lower layers of a slab that shows one picture by light that falls on it, and another by light from behind: night
// colours, as deep from the lower face as day colours are from the upper one, and core between them, which keeps the
// night from being seen by day.
//
// Light from behind passes night, core and day, and is taken for a product of what each lets through:
//
//   seen = through(night, core) * through(day, core) / through(clear, core)
//
// with `through` of a shell over the core by the separation's own model (shell_appearance.h). So a place asks its night
// layers for what it is to show over what the day's colour lets through there. All of it is scaled by one level, that
// at which lightness comes out best: a brighter lamp makes up for it. What asks for more is as bright as clear resin
// is.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "halftone/separation/separation.h"
#include "io/models/mesh.h"
#include "io/pictures/texture.h"
#include "optics/layered/shell_appearance.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

class NightSide {
public:
    /// What is below is what is seen of `slab`, whose picture this stands in for. `day`: colours of the other side;
    /// `clear`: index of the clear resin. Throws InputError where the slab is too thin for both.
    NightSide(const optics::ShellAppearance& day, const halftone::Separation& day_separation,
              const SurfaceColour& day_colour, const VisibleSurface& surface, const io::TexturedMesh& slab,
              std::shared_ptr<const io::Texture> picture, double thickness_mm, double spacing_mm, int clear);
    NightSide(const NightSide&) = delete;
    NightSide& operator=(const NightSide&) = delete;

    [[nodiscard]] float day_mm() const { return day_mm_; }                ///< core is below
    [[nodiscard]] float from_mm() const { return from_mm_; }              ///< night is below
    [[nodiscard]] const io::TexturedMesh& slab() const { return mesh_; }  ///< with the night's picture
    [[nodiscard]] const halftone::Separation& separation() const { return separation_; }
    /// As the picture has it, linear sRGB.
    [[nodiscard]] Eigen::Vector3f asked(std::uint32_t triangle, float u, float v) const {
        return colour_.at(triangle, u, v);
    }
    /// What `separation` is asked for under a colour of the day.
    [[nodiscard]] Eigen::Vector3f wanted(const Eigen::Vector3f& asked, const Eigen::Vector3f& day) const;
    /// Which share of the picture asks for more light.
    [[nodiscard]] double beyond() const { return beyond_; }

private:
    [[nodiscard]] Eigen::Vector3f let_through(const Eigen::Vector3f& day) const;

    float day_mm_, from_mm_;
    const io::TexturedMesh mesh_;
    optics::ShellAppearance appearance_;
    halftone::Separation separation_;
    SurfaceColour colour_;
    std::vector<Eigen::Vector3f> lattice_;  ///< what colours of the day let through, over the brightest of them
    Eigen::Vector3f brightest_;             ///< of the night's layers, media-relative
    float gain_ = 1;
    double beyond_ = 0;
};

}  // namespace voxtone::slicer
