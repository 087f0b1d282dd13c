// SPDX-License-Identifier: GPL-3.0-or-later
//
// Will the print look as asked, and if not, why, and what to try: one sentence and one figure.
//
// The figure is the mean CIEDE2000 between what is predicted and what was asked for, both after the eye filter
// (halftone/loop/eye_filter.h, at the viewing distance), the print over the level of its own paper (paper.h), over the
// whole coloured surface by area: colours that the resins cannot reach count, as they do for whoever looks at it. The
// loop tells the same figure. Good and bad are options (VerdictLimits). Where more than a tenth of the surface is above
// `bad`, or a solid, type or paper is not good (region_verdict.h), a good mean is called fair at best; where type that
// was legible cannot be read, or a solid is off by more than three times `bad`, it is called bad. The sentence names
// the worst of them.
//
// Why: each cell that is off by more than `good` counts with area times difference for the first of
//   - out of gamut: the thick body's separation alone is off by half of the cell's difference or more;
//   - thin walls: going inward along the normal the body ends within two shell depths, so that there is no core behind
//     the colour, and light passes, or the other side's colour shows;
//   - neighbours' light: all else. Light spreads between neighbouring colours, at edges and in corners.
// It is a count by rules, no analysis of what each alone would do: two causes in one cell count as the first.
// A model that lost colours (ModelFile::lost_colour) will not look as asked, whatever the figure says of the rest.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "base/named_values.h"
#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/prepare/job_body.h"
#include "slicer/prepare/job_colour.h"
#include "slicer/prepare/opened_job.h"

namespace voxtone::slicer {

enum class LossCause { gamut, thin_wall, neighbours };

struct CellLoss {
    LossCause cause;
    double wall_mm;  ///< how thick the body is there, `thin_mm` at most
};
/// What limits a cell; `thin_mm`: two shell depths.
[[nodiscard]] CellLoss loss_of_cell(const JobPrediction& prediction, const JobColour& colour, std::size_t cell,
                                    double thin_mm);

struct VerdictSources {
    const OpenedJob& job;
    const JobBody& body;
    const JobColour& colour;
    const std::optional<JobPrediction>& prediction;
    const std::string& why_not_predicted;  ///< a sentence, or empty
    const io::ReportGamut& gamut;
    bool looped = false;     ///< the resins were rearranged
    bool cut_short = false;  ///< and might have gained more, had they been rearranged more often
    bool all_white = false;  ///< white was asked for everywhere, and white resin is printed
};

[[nodiscard]] io::ReportVerdict judge(const VerdictSources& sources);

/// What to try where colours are out of the resins' reach. Takes as long as separating a few thousand colours.
[[nodiscard]] std::string gamut_advice(const OpenedJob& job, const JobBody& body);

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
