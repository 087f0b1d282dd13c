// SPDX-License-Identifier: GPL-3.0-or-later
//
// Will the print look as asked; what is worst on it; and if it will not, why, and what to try.
//
// The figure is the mean CIEDE2000 between what is predicted and what was asked for, both after the eye filter
// (halftone/loop/eye_filter.h, at the viewing distance), the print over the level of its own paper (paper.h), over the
// whole coloured surface, each cell by its area and by how far it can be seen (sides_seen.h): colours that the resins
// cannot reach count, as they do for whoever looks at it. The level is that of the whole alone (whole_verdict.h); good
// and bad are options (VerdictLimits). The worst thing (region_verdict.h) is a sentence of its own, which changes no
// level: "On the whole good, 2.3 ... But both eyes come out olive." How much of the figure no mixture of the loaded
// resins could avoid is told with it: the mean of the smaller of a cell's difference and its target's distance from the
// gamut of a thick body.
//
// Why: each cell that is off by more than `good` counts with area, sight and difference for the first of
//   - out of gamut: the thick body's separation alone is off by half of the cell's difference or more;
//   - thin walls: going inward along the normal the body ends within two shell depths, so that there is no core behind
//     the colour, and light passes, or the other side's colour shows;
//   - neighbours' light: all else. Light spreads between neighbouring colours, at edges and in corners.
// It is a count by rules, no analysis of what each alone would do: two causes in one cell count as the first.
//
// Nothing is said of looks where nothing was predicted: what the resins reach on a thick body is no print (level
// `unknown`). A model that lost colours (ModelFile::lost_colour) will not look as asked, whatever is known of the rest.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "base/named_values.h"
#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

enum class LossCause { gamut, thin_wall, neighbours };

struct CellLoss {
    LossCause cause;
    double wall_mm;  ///< how thick the body is there, `thin_mm` at most
};
/// What limits a cell; `thin_mm`: two shell depths.
[[nodiscard]] CellLoss loss_of_cell(const JobPrediction& prediction, const JobColour& colour, std::size_t cell,
                                    double thin_mm);

/// How thick the body is behind a cell, at most `most_mm`; where its faces look both ways, as those of a sheet of one
/// voxel do, which has no normal, as thick as the cell.
[[nodiscard]] double wall_of_cell_mm(const JobPrediction& prediction, std::size_t cell, double most_mm);

struct VerdictSources {
    const OpenedJob& job;
    const JobBody& body;
    const JobColour& colour;
    const std::optional<JobPrediction>& prediction;
    const std::string& why_not_predicted;  ///< a sentence, or empty
    const io::ReportGamut& gamut;
    const std::optional<JobLoop>& loop;  ///< that rearranged the resins
    bool all_white = false;              ///< white was asked for everywhere, and white resin is printed
};

[[nodiscard]] io::ReportVerdict judge(const VerdictSources& sources);

/// How much body there is behind a point of its surface: from `from_mm` along `-normal` (unit length) to the first air,
/// at most `most_mm`. Steps of half a voxel.
[[nodiscard]] double wall_thickness_mm(const optics::ResinVolume& volume, const Eigen::Vector3d& from_mm,
                                       const Eigen::Vector3d& normal, double most_mm);

}  // namespace voxtone::slicer

template <>
struct voxtone::NamesOf<voxtone::slicer::LossCause> {
    using E = slicer::LossCause;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::gamut, "colours out of the resins' reach"},
                                 {E::thin_wall, "thin walls"},
                                 {E::neighbours, "light between neighbouring colours and at edges"}});
};
