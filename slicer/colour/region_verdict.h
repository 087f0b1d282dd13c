// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is said of the solids, the type and the paper of a print, each as the one thing that a person sees
// (halftone/loop/colour_regions.h), those of one kind and colour together: six letters of a word are one row. A region
// is good where the CIEDE2000 of its means is not above the verdict's "bad"; where it is even (evenness.h); where type
// and lines, if they were asked for with a contrast of a half or more, have that: ISO 9241-303 asks for as much of
// characters. Contrast is (a - b) / (a + b) of the luminances of strokes and of what lies within 0.5 mm of them. Below
// which size type cannot be read is a row of its own (type_size.h), the first. Type whose strokes are not wider than a
// cell is no region: where three tenths of the surface are regions, and the target has a fine contrast of 0.08 and more
// in Oklab's lightness of which not 0.6 is left (halftone/loop/lost_contrast.h), over a quarter of a square millimetre,
// that is said of the place where most is lost. Of textures
// lost_texture.h speaks, of codes that a scanner cannot read printed_codes.h, of labels printed_labels.h. A solid is
// not good either whose rim, the chroma of print less target within 0.6 mm of its edge, is above twice "bad": CIEDE2000
// divides chroma by 1 + 0.045 C, by two at C = 22. The figures were chosen on the small print of public bug reports,
// which nobody can read, and on type of 4 to 14 points.
//
// The worst come first: by how far they are from good, times the edge of a square as large as what can be seen of them
// (sides_seen.h). A small thing that is wholly wrong is noted before a large one that is hardly so.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/colour/place_words.h"
#include "slicer/colour/sides_seen.h"
#include "slicer/colour/whole_verdict.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_colour.h"

namespace voxtone::slicer {

/// "orange", from linear sRGB. A grey of chroma 4 to 9 (13 below L* 80) is told with its tint ("bluish white"). Where
/// one word ends and the next begins is ours: the tints were chosen on a sign's paper (233, 243, 255), chroma 7; no one
/// was asked.
[[nodiscard]] std::string colour_word(const Eigen::Vector3f& rgb);

/// How a colour differs from the one that was asked for, by the part of the difference that is largest: "darker",
/// "greyer", "yellower". CIELAB.
[[nodiscard]] std::string shift_word(const Eigen::Vector3d& asked, const Eigen::Vector3d& printed);

/// What is said of flecks in `why`.
inline constexpr std::string_view not_even = "not even";

/// What regions are judged by.
struct RegionSources {
    const JobPrediction& prediction;
    const JobColour& colour;
    const SidesSeen& sides;
    const PlaceWords& places;
    const std::vector<double>& seen;  ///< per cell, its area by how far it can be seen
    const VerdictLimits& limits;
    bool is_picture = false;
    double viewing_distance_mm = 0;
    const io::TexturedMesh* mesh = nullptr;  ///< with a slab's picture, and what marks became
    std::span<const MarkOptions> marks = {};
    Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  ///< where the prediction's 0, 0, 0 lies in the mesh
};

/// Cells that are off because the body ends behind them.
struct ThinWalls {
    std::vector<std::uint32_t> cells;
    double wall_mm = 0;  ///< how thick they are about
};

struct JudgedRegions {
    std::vector<io::ReportRegion> rows;  ///< the worst first; empty where nothing is flat, as in photographs
    std::vector<char> spoilt;            ///< per cell: in a flat area that is uneven, or in a texture that is lost
    PageVerdict page;
};
[[nodiscard]] JudgedRegions judge_regions(const RegionSources& sources, const ThinWalls& walls);

}  // namespace voxtone::slicer
