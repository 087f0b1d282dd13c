// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where patches lie, as a picture to look at: on their target, or as a chart where it is not known. Pixels are squares
// seen from above, rows from the largest y.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/patches/patch_table.h"
#include "calibration/target/target_layout.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct PatchMap {
    std::uint32_t width_px = 0, height_px = 0;
    double px_per_mm = 0;
    std::vector<std::uint16_t> patch_of;      ///< a pixel: the number of its patch in the table, from 1; 0: none
    std::vector<Eigen::Vector2d> middles_mm;  ///< of the patches; x to the right, y up, (0, 0) the lower left corner
    std::vector<std::uint8_t> photograph;     ///< of the target, sRGB codes, three a pixel; empty: none
    bool is_target = false;                   ///< false: a chart; its places are nobody's

    [[nodiscard]] Eigen::Vector2d size_mm() const { return Eigen::Vector2d(width_px, height_px) / px_per_mm; }
};

/// A row of patches for every resin that lies under some.
[[nodiscard]] PatchMap chart_of_patches(const PatchTable& table);

/// Of each of the target's squares its patch in the table, from 1; 0: it has none.
[[nodiscard]] std::vector<std::size_t> patches_of_squares(const PatchTable& table, const Target& target);

/// Between the squares, and in markers and frame, lie the patches of the same resins. `photograph`: of the whole
/// target, straightened (photo/target_picture.h); nullptr: none. Throws InputError where the table has no patch of the
/// target, a square without one excepted, or the photograph has other proportions.
[[nodiscard]] PatchMap patches_on_target(const PatchTable& table, const Target& target,
                                         const io::Photograph* photograph);

/// What a page of patches is told beside its table: files, which may be empty.
struct PatchMapFiles {
    std::string target;   ///< its description (target/target_file.h)
    std::string picture;  ///< its photograph, which needs the target

    /// `page`: of the patches; empty: none is asked for. Throws UsageError.
    void validate(const std::string& page) const;
    /// The same where the target alone is of use without a page: for the ends of its squares (ended_fit.h).
    void validate_of_squares(const std::string& page) const;
};

/// Throws FileError, InputError, Cancelled.
[[nodiscard]] PatchMap read_patch_map(const PatchTable& table, const PatchMapFiles& files, const Progress& progress);

}  // namespace voxtone::calibration
