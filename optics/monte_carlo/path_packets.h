// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many light paths at once through the voxels of a volume: the vector twin of scalar_paths.h, the same physics with
// free paths drawn as path_volume.h says, in single precision.
//
// Where the scene names spheres, paths deep inside step through these (first_passage.h): the same light by fewer
// events.
//
// Every lane of a packet carries its own path and does one event at a time: it meets a particle, or the side of its
// box. A path that ends makes room for the next. What a path does is a function of its start alone, never of the lane,
// of the paths beside it or of the machine: no operation depends on the vector's length, none is fused. Run-time
// dispatch.
#pragma once

#include <array>
#include <cstdint>

#include "optics/media/droplet_spread.h"
#include "optics/media/lateral_spread.h"
#include "optics/monte_carlo/clear_spheres.h"
#include "optics/monte_carlo/path_random.h"
#include "optics/monte_carlo/path_volume.h"
#include "optics/monte_carlo/surface_finish.h"

namespace voxtone::optics {

/// A path just inside the surface.
struct PathStart {
    std::array<float, 3> at{};         ///< in voxels from the path volume's corner; at the face exactly
    std::array<float, 3> direction{};  ///< in mm, unit length
    std::array<std::int32_t, 3> voxel{};
    std::array<std::uint32_t, 4> random{};  ///< state of its generator (path_random.h)
    float depth = 0;                        ///< optical depth of the first free path
    std::uint32_t tag = 0;                  ///< given back with the weight
};

/// Where a path went out through the boundary, for those who go on with it.
struct PathExit {
    Point at{};                             ///< mm from the volume's corner
    Point way{};                            ///< in air, unit length
    std::array<std::uint32_t, 4> random{};  ///< state of its generator
};

/// Where packets take paths from and what they do with them.
class PathSource {
public:
    virtual ~PathSource() = default;
    /// The next path; false where there is none any more.
    virtual bool next(PathStart& start) = 0;
    /// `at`: where it left or ended, as in PathStart; exact at the side that it left through.
    virtual void finished(std::uint32_t tag, float weight, const std::array<float, 3>& at) = 0;
    /// In the place of `finished`, for a path that left where PacketScene::tells_exits is set.
    virtual void left(std::uint32_t /*tag*/, float /*weight*/, const PathExit& /*exit*/) {}
    /// The direction of light that a white sheet sends back up through the surface; draws from `random`.
    virtual std::array<float, 3> entering_up(std::array<std::uint32_t, 4>& random) = 0;
};

/// Spheres of one resin that paths may cross in one step (clear_spheres.h); `fitting` nullptr: none.
struct PacketSpheres {
    std::int32_t material = 0;
    const std::uint8_t* fitting = nullptr;
    std::array<int, 3> cells{};
    std::array<float, ClearSpheres::most_radii + 1> radius_mm{};  ///< by how many fit, the largest of these
    const float *weights = nullptr, *cosines = nullptr;           ///< weight 0: no step
};

/// What stays the same for all paths of one channel.
struct PacketScene {
    const std::uint16_t* voxels = nullptr;
    const std::uint32_t* base = nullptr;
    const float* majorant = nullptr;
    std::array<int, 3> blocks{}, size{};
    std::array<float, 3> pitch_mm{};
    const BodyBoundary* boundary = nullptr;  ///< nullptr: the faces of the voxels
    bool follow_outside = false;             ///< MonteCarloOptions
    // With a boundary only, and without follow_outside:
    const SurfaceFinish* finish = nullptr;  ///< nullptr: smooth
    bool tells_exits = false;               ///< paths that leave are handed over with their way (PathSource::left)
    float offset = 0;                       ///< voxels between the corner of path coordinates and the scene's volume
    std::size_t materials = 0;
    std::array<float, 256> sigma_t{}, albedo{};  ///< per material
    std::array<float, 256> g_of{}, eta_of{};     ///< likewise; of air the set's
    bool own_g = false, own_eta = false;         ///< some are not the set's
    float g = 0, eta = 1, roulette_weight = 0.1f;
    DropletSpread droplets;  ///< within blocks of path_volume.h, at whose sides the box is folded back
    LateralSpread spread;    ///< across blocks, before that
    PacketSpheres spheres;
    Backing backing = Backing::none;
    Sides sides = Sides::open;
    std::shared_ptr<const Sheet> sheet;
    std::size_t channel = 0;
    double surface_in_air = 0;  ///< what the surface reflects of the light of a sheet
};

[[nodiscard]] PacketScene packet_scene(const Scene& scene, const PathVolume& volume, std::size_t channel,
                                       double roulette_weight);
/// Which must outlive the packets.
[[nodiscard]] PacketSpheres packet_spheres(const ClearSpheres& spheres, std::size_t channel);

/// Traces all paths of the source.
void trace_packets(const PacketScene& scene, PathSource& source);

}  // namespace voxtone::optics
