// SPDX-License-Identifier: GPL-3.0-or-later
//
// The last part of a job: what a person will see of the layers just made, beside what was asked for.
//
// The volume is filled from the layers while they are written. A body that needs more memory than allowed is printed
// all the same: the prediction is left out, and the job says so.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "halftone/loop/colour_regions.h"
#include "halftone/loop/lost_contrast.h"
#include "halftone/loop/seen_target.h"
#include "io/layers/layer_runs.h"
#include "optics/colour/colour.h"
#include "slicer/colour/job_loop.h"
#include "slicer/colour/lost_texture.h"
#include "slicer/colour/sides_seen.h"
#include "slicer/layers/layer_volume.h"
#include "slicer/look/surface_prediction.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"

namespace voxtone::slicer {

/// The volume of a job, filled layer by layer from any thread.
class JobVolume {
public:
    JobVolume(const VoxelGrid& grid, std::uint64_t memory_bytes);
    void add(int k, const io::LayerRuns& layer);
    /// Nothing where it took too much memory; `why_not` says so.
    [[nodiscard]] std::optional<optics::ResinVolume> finish();
    [[nodiscard]] const std::string& why_not() const { return why_not_; }

private:
    std::mutex mutex_;
    std::optional<LayerVolume> volume_;
    std::atomic<bool> given_up_{false};
    std::string why_not_;
};

/// Target and print after the eye filter, per cell: as they are seen from the viewing distance by who takes the print's
/// own paper for white (halftone/loop/paper.h), and region by region (halftone/loop/colour_regions.h). Differences are
/// those of colours with a room's light over both, 1 % of white: what sRGB's codes stand for is seen so (IEC 61966-2-1,
/// encoding viewing flare), so that nobody who wrote (0, 0, 0) has ever seen less.
struct SeenPrint {
    std::vector<Eigen::Vector3f> target, print;  ///< linear sRGB, not clamped; the print over its paper's level
    std::vector<double> difference;              ///< CIEDE2000
    float paper = 1;                             ///< the level
    std::vector<halftone::ColourRegion> regions;
    std::vector<halftone::RegionLook> looks;
    std::vector<double> rims;                  ///< of regions that are solids (rim_chroma); 0 of others
    std::vector<halftone::FineContrast> fine;  ///< per cell: within a millimetre
    std::vector<TextureLook> texture;          ///< per cell
};

struct JobPrediction {
    std::string model;
    optics::ResinVolume volume;
    SurfacePrediction predicted;
    optics::Channels channels;            ///< of the values in `predicted`
    std::vector<Eigen::Vector3f> target;  ///< per cell, linear sRGB
    std::vector<double> difference;       ///< per cell, CIEDE2000
    optics::DifferenceSummary summary;    ///< by area
    std::array<double, 3> cell_um{};
    double seconds = 0;
    std::vector<Eigen::Vector3f>
        open_loop;  ///< per cell, what the open loop would have shown; empty without an appearance loop
    SeenPrint seen;
    SidesSeen sides;  ///< from where its cells can be seen
};

/// `adapts`: the print's own paper is taken for white; not where white is absolute. `asked`: of the same cells, where
/// it is known.
[[nodiscard]] SeenPrint seen_from(const JobPrediction& prediction, double viewing_distance_mm, bool adapts,
                                  std::shared_ptr<const halftone::SeenTarget> asked = nullptr);

/// What the appearance loop itself predicted of the print that it chose, by its last look where it took one; the
/// volume is that print. Colours only: what the loop saw by channel is not kept.
[[nodiscard]] JobPrediction prediction_of_loop(const JobLoop& loop, optics::ResinVolume volume);

/// `known`: the cells of this print; null: they are found here. `white`: what it is where clear resin lies over the
/// colours, and as it is seen in those cells. Throws what the model throws.
[[nodiscard]] JobPrediction predict_print(const ResolvedJob& job, PredictionModel model, const JobBody& body,
                                          const LoadedResins& resins, optics::ResinVolume volume,
                                          const ViewedCells* known, const WhiteTwin& white, Progress& progress);

}  // namespace voxtone::slicer
