// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the appearance loop of a job came to, on disk: OUT/skin.mixtures. Shards of the body read it, and so does a
// whole job: the loop is run once. It has the mixture of every surface cell and depth, as the screens read it, and what
// the report says of the loop, the white and the last look among it; some 100 bytes a surface cell. A loop that was
// left out is told too, so that all shards agree, however much memory each has.
//
// It belongs to one job, as a checkpoint does (loop_checkpoint.h): to what the inputs hold, all options that decide the
// loop, --iterations among them, and the version of the program; another job's is refused. A loop that settled before
// --iterations auto would have ended it is that of `long`, too. The values: size of what follows before it was
// deflated, that.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/appearance_loop.h"
#include "halftone/separation/mixture.h"
#include "optics/scene/surface.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/artefact.h"

namespace voxtone::slicer {

/// What is known once a loop has run.
struct SavedSkin {
    std::string left_out;  ///< not empty: there was no loop; why, in a sentence
    std::string model;     ///< that predicted
    double seconds = 0;
    optics::Surface surface;              ///< its cells, without their faces
    std::vector<Eigen::Vector3f> target;  ///< per cell, linear sRGB
    std::array<double, 3> cell_um{};
    halftone::LoopResult result;                        ///< what a report tells of it: no state to go on from
    std::vector<halftone::CumulativeMixture> mixtures;  ///< [cell * layers + layer]; empty: the open loop was best
};

class SkinFile {
public:
    /// `opened_identity`, `loop_identity`: as LoopCheckpoint takes them. Of `loop`: how long it may go on.
    SkinFile(std::filesystem::path file, std::string_view opened_identity, std::string_view loop_identity,
             const JobLoopOptions& loop);

    [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }
    [[nodiscard]] bool exists() const { return file_.exists(); }
    /// Whether what is there is of this job. Throws FileError for a broken one.
    [[nodiscard]] bool is_of_this_job() const;
    /// Throws FileError, TryAgain.
    void write(const SavedSkin& skin) const;
    /// `layers`: of mixtures, of each cell. Throws InputError for one of another job or version, FileError for one that
    /// is broken or not there.
    [[nodiscard]] SavedSkin read(std::size_t layers) const;

    /// What of `read` can be said before the model is read. Nothing there is no fault.
    static void expect_same_job(const std::filesystem::path& file, std::string_view opened_identity,
                                const JobLoopOptions& loop);

private:
    Artefact file_;
    ArtefactKey asked_, settled_;  ///< one where there is a limit
};

}  // namespace voxtone::slicer
