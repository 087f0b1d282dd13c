// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a person sees of a volume of resins: the question that every forward model answers.
//
// The scene. The body floats in uniform diffuse white light that reaches every point of its surface alike; light that
// leaves is gone (no shadow, no second bounce between parts of a body that is not convex). Its lowest faces, those on
// the plane z = 0 of the volume, may lie on a sheet (`backing`) with a film of air between; then no light reaches
// them from outside but what the sheet sends back. With `sides` mirrored the four vertical faces of the volume's box
// reflect everything: the pattern goes on for ever, for plane-parallel problems.
//
// Appearance of a surface cell, per channel: flux that leaves through its part of the refractive surface / flux that
// entered there; the first reflection left out; exactly 1 for a body that absorbs nothing. Media-relative values divide
// by the appearance of the same body all of white resin at the same place.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/media/resin_volume.h"
#include "voxtone/optics/media/resins.h"
#include "voxtone/optics/scene/backing.h"

namespace voxtone::optics {

enum class Sides {
    open,      ///< where the volume ends the body ends, and is lit
    mirrored,  ///< the x and y borders of the volume's box are perfect mirrors
};

/// Everything that decides what is seen. The volume and the resins must outlive the scene.
struct Scene {
    const ResinVolume* volume = nullptr;
    const ResinSet* resins = nullptr;  ///< material m of the volume is resins[m - 1]
    Backing backing = Backing::none;   ///< under the faces on the plane z = 0
    Sides sides = Sides::open;
};

/// Which way a voxel's face looks; `axis = direction / 2`, odd ones look along the positive axis.
enum class Facing : std::uint8_t { minus_x, plus_x, minus_y, plus_y, minus_z, plus_z };

/// A voxel's face between resin and air.
struct SurfaceFace {
    std::array<std::int32_t, 3> voxel{};  ///< the solid side
    Facing facing{};
};

/// A piece of surface that is seen as one: the exposed faces of the voxels of one cell of the viewing grid.
struct SurfaceCell {
    std::array<std::int32_t, 3> cell{};  ///< place in the viewing grid: voxel / cell size
    std::uint32_t first_face = 0, faces = 0;
    std::array<float, 3> centre_mm{};  ///< of the faces
    std::array<float, 3> normal{};     ///< outward, unit length: of the smooth surface that the staircase stands for
    float area_mm2 = 0;                ///< of that surface
};

/// Surface cells, in order of z, y, x of the viewing grid, and their faces.
struct Surface {
    std::array<int, 3> cell_voxels{};
    std::vector<SurfaceCell> cells;
    std::vector<SurfaceFace> faces;
    std::vector<std::array<float, 3>> face_normal;  ///< per face: of the smooth surface
};

enum class SurfacePart {
    all,  ///< every face that sees light
    top,  ///< the uppermost face of each column, looking up, as a picture on a slab is looked at; normals are +z
};

/// Voxels per viewing cell that come nearest to cubes of `cell_mm`; J750 and 0.085 mm: 2 x 1 x 3.
[[nodiscard]] std::array<int, 3> cell_voxels(const std::array<double, 3>& pitch_mm, double cell_mm);

/// A box of voxels: the first and one past the last along each axis.
struct VoxelBox {
    std::array<int, 3> begin{}, end{};
    [[nodiscard]] bool holds(const std::array<int, 3>& voxel) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (voxel[a] < begin[a] || voxel[a] >= end[a]) return false;
        return true;
    }
};

/// The surface of a scene's volume. Faces on a sheet and on mirrored sides do not count.
[[nodiscard]] Surface find_surface(const Scene& scene, const std::array<int, 3>& cell_voxels, SurfacePart part);
/// All of it inside a box, and perhaps some around.
[[nodiscard]] Surface find_surface_near(const Scene& scene, const std::array<int, 3>& cell_voxels, const VoxelBox& box);

/// The cells of a surface that are listed, with their faces.
[[nodiscard]] Surface part_of(const Surface& surface, std::span<const std::uint32_t> cells);

/// What a model says of a surface: value[cell * channels + channel].
struct Appearance {
    std::size_t channels = 0;
    std::vector<float> value;
    std::vector<float> standard_error;  ///< one sigma, same shape; empty where the model draws no random numbers
};

/// Derivative of a function F of the appearance with respect to what voxels are filled with.
class ResinGradient {
public:
    virtual ~ResinGradient() = default;
    /// d F / d (fraction of a resin in a voxel), all fractions taken as free: a change that keeps their sum, resin a
    /// for resin b, is a difference of two. 0 outside the cells that light is followed through. May be asked from
    /// several threads.
    [[nodiscard]] virtual float at(const std::array<int, 3>& voxel, std::size_t resin) const = 0;
    /// The same of the first out.size() resins: cheaper than one by one.
    virtual void all_at(const std::array<int, 3>& voxel, std::span<float> out) const {
        for (std::size_t resin = 0; resin < out.size(); ++resin) out[resin] = at(voxel, resin);
    }
};

/// One model asked again and again about bodies of one shape, of which only the resins change: what an appearance loop
/// does.
class AppearanceSequence {
public:
    virtual ~AppearanceSequence() = default;
    /// `volume` has the size, pitch and air of the scene's that the sequence was made for, and lives until the next
    /// prediction.
    [[nodiscard]] virtual Appearance next(const ResinVolume& volume, const Progress* progress = nullptr) = 0;
    /// Takes the derivatives of the voxels in a box; they are good during the call.
    using GradientVisitor = std::function<void(const ResinGradient&, const VoxelBox&)>;
    /// At the last prediction, of a function F with these d F / d value (as Appearance::value): handed over box by box,
    /// which together hold every voxel once. False, and nothing visited, where the model has none or not the memory for
    /// it.
    [[nodiscard]] virtual bool gradient(std::span<const float> by_value, const GradientVisitor& visit,
                                        const Progress* progress = nullptr);
};

class AppearanceModel {
public:
    virtual ~AppearanceModel() = default;
    /// Appearance of every cell of the surface in every channel of the scene's resins. Throws InputError for a material
    /// without a resin, ResourceError where it would need more memory than allowed, Cancelled.
    [[nodiscard]] virtual Appearance predict(const Scene& scene, const Surface& surface,
                                             const Progress* progress = nullptr) const = 0;
    /// Predictions of volumes of the scene's shape, one after the other; what they share may be kept between them. The
    /// default predicts each anew. Scene, surface and model must outlive the sequence.
    [[nodiscard]] virtual std::unique_ptr<AppearanceSequence> sequence(const Scene& scene,
                                                                       const Surface& surface) const;
};

/// Throws InputError that names the first material that has no resin in the set.
void expect_resins_for(const Scene& scene);

}  // namespace voxtone::optics
