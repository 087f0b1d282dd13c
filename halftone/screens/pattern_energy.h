// SPDX-License-Identifier: GPL-3.0-or-later
//
// The inner loop of void-and-cluster: the dither pattern, filtered (R. Ulichney, SPIE 1913 (1993); later authors
// call its values energies), in integers on a periodic cube of 64^3 voxels,
//
//   energy(v) = sum over marked u of  near(v - u) + far_weight * prod over axes of max(0, 16 - |v - u|),
//
// and the search for the smallest and the largest of them. The second term's factor is the number of cubes of 16^3
// voxels that hold both voxels. Extremes are kept over groups of 8 voxels along y, and over planes: a step touches the
// neighbourhood of one voxel, and nothing is reduced across vector lanes. Vector code with run-time dispatch; integers,
// so that every target gives the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxtone::halftone {

inline constexpr int field_size = 64;
inline constexpr int overlap_box = 16;  ///< voxels along the edge of the cubes whose counts are kept even
/// The far term of one marked voxel at itself, and its sum over all voxels (both before the weight).
inline constexpr double overlap_peak = double{overlap_box} * overlap_box * overlap_box;
inline constexpr double overlap_sum = overlap_peak * overlap_peak;

/// One row of the near kernel: its offset from the centre, in [-31, 31], and its values at dx = 0 .. 63 on the torus,
/// twice, so that every shift of it is contiguous.
struct KernelRow {
    int dy = 0, dz = 0;
    std::array<std::int32_t, 2 * field_size> value{};
};

class PatternEnergy {
public:
    /// `marked_offset` lies on top of a marked voxel's energy: the lowest is always unmarked, the highest always marked
    /// (where there are such), if no energy reaches the offset.
    PatternEnergy(std::vector<KernelRow> near, std::int32_t far_weight, std::int32_t marked_offset);

    /// Voxels are numbered x + 64 (y + 64 z). Without `keep_highest`, `highest` has no meaning afterwards.
    void mark(int voxel, bool keep_highest = true) { change(1, voxel, keep_highest); }
    void unmark(int voxel) { change(-1, voxel, true); }
    /// An unmarked voxel of least energy; a marked voxel of most. Among equals the choice is fixed.
    [[nodiscard]] int lowest() const;
    [[nodiscard]] int highest() const;
    [[nodiscard]] std::int32_t at(int voxel) const { return data_.energy[static_cast<std::size_t>(voxel)]; }

    /// What the vector code works on.
    struct Data {
        std::vector<KernelRow> near;
        int reach_x = 0, reach_y = 0, reach_z = 0;  ///< voxels that a change touches, to either side
        std::int32_t far_weight = 0;
        std::vector<std::int32_t> energy;                 ///< x + 64 (y + 64 z)
        std::vector<std::int32_t> group_low, group_high;  ///< x + 64 (y / 8 + 8 z)
        std::vector<std::int32_t> plane_low, plane_high;  ///< x + 64 z
    };

private:
    void change(int sign, int voxel, bool keep_highest);

    std::int32_t marked_offset_;
    Data data_;
};

}  // namespace voxtone::halftone
