// SPDX-License-Identifier: GPL-3.0-or-later
//
// A case of the accuracy suite: a scene, what is looked at, and which cells look alike by symmetry.
//
// A case is made once by code (flat_cases.h, colour_cases.h, photo_cases.h, body_cases.h) and kept with its reference
// (reference_file.h), so that a change of a screen or of the separation does not change what the predictor is judged
// by.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "optics/scene/appearance_model.h"
#include "optics/scene/boundary.h"

namespace voxtone::accuracy {

/// J750 High Mix: voxels, and the cells of 0.085 mm that a viewer sees.
inline constexpr std::array<double, 3> j750_mm{25.4 / 600, 25.4 / 300, 0.027};
inline constexpr std::array<int, 3> viewing_cell{2, 1, 3};
/// The slabs of the suite: 120 layers, 3.24 mm, the upper 18, 0.486 mm, are the coloured skin.
inline constexpr int slab_layers = 120, skin_layers = 18;

/// Which cells of a scene have the same appearance because the scene is the same seen from them.
enum class Symmetry {
    none,
    along_y,    ///< nothing changes along y
    mirror_xy,  ///< the scene is its own mirror image in x and in y
};

struct SuiteCase {
    std::string name;    ///< short, a file name
    std::string shown;   ///< one line of words
    bool tuning = true;  ///< false: never looked at while the predictor was tuned
    optics::ResinVolume volume;
    optics::ResinSet resins;
    optics::Backing backing = optics::Backing::black;
    optics::Sides sides = optics::Sides::mirrored;
    optics::SurfacePart part = optics::SurfacePart::top;
    Symmetry symmetry = Symmetry::none;
    std::string boundary = "the voxels' faces";                 ///< where the reference refracts light, in words
    std::shared_ptr<const optics::BodyBoundary> true_boundary;  ///< while the reference is made; null: those faces
    bool white_is_one = false;                                  ///< a body whose white is the same all over: a sphere
    double noise = 0.5;  ///< wanted of the mean of both halves, CIEDE2000, per group of cells

    [[nodiscard]] optics::Scene scene() const { return {&volume, &resins, backing, sides}; }
    /// Material of the white resin, the "paper white" of media-relative colour.
    [[nodiscard]] optics::Material white() const { return static_cast<optics::Material>(resins.find("W") + 1); }
};

/// Group of every cell of the surface; groups are numbered in order of their first cell.
struct Groups {
    std::vector<std::uint32_t> of_cell;
    std::vector<std::uint32_t> first_cell;
};
[[nodiscard]] Groups group_cells(const SuiteCase& c, const optics::Surface& surface);

/// The surface that has the first cell of each group alone.
[[nodiscard]] optics::Surface first_cells(const optics::Surface& surface, const Groups& groups);

/// C M Y K W of Elek et al. 2017 and clear (neither absorbs nor scatters), as materials 1 to 6.
[[nodiscard]] optics::ResinSet suite_resins();
namespace resin {
inline constexpr optics::Material C = 1, M = 2, Y = 3, K = 4, W = 5, T = 6;
}

}  // namespace voxtone::accuracy
