// SPDX-License-Identifier: GPL-3.0-or-later
//
// The state of an appearance loop on disk, so that an interrupted job can go on to the same bits: OUT/loop.checkpoint,
// written after an iteration under a temporary name and renamed, removed when the job is done. With the light that
// the predictor keeps it has some 200 bytes for each surface cell and 25 for each cell that light is followed through:
// 216 MB for a body of 30 mm. It is written while the next print is made, without a copy; a state that takes more than
// a second is written less often (CheckpointKeeper in job_loop.cpp).
//
// A state belongs to one job, and another job's is refused. Its key (artefact.h): what a job is known by before its
// model is read; and the job's identity as far as it matters to the loop (job_identity.h: what the inputs hold, not
// their names; not --iterations) with the target of every cell.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "halftone/loop/appearance_loop.h"
#include "slicer/part/artefact.h"

namespace voxtone::slicer {

class LoopCheckpoint {
public:
    /// `opened_identity`: opened_loop_identity of the job; `loop_identity`: JobIdentity::loop.
    LoopCheckpoint(const std::filesystem::path& folder, std::string_view opened_identity,
                   std::string_view loop_identity, std::span<const Eigen::Vector3f> target);

    /// Throws FileError, TryAgain; what was written before stays then. From any thread, one at a time; what it writes
    /// is read as it goes.
    void write(const halftone::LoopState& state, const optics::AppearanceSequence& sequence) const;
    /// Nothing, with a note, where there is none. Throws InputError for one of another job, FileError for a broken one.
    [[nodiscard]] std::optional<halftone::ResumedLoop> read(Progress& progress) const;
    [[nodiscard]] bool exists() const { return file_.exists(); }
    [[nodiscard]] const std::filesystem::path& file() const { return file_.path(); }

    /// Throws InputError where `folder` holds the state of an interrupted loop that this job would throw away.
    static void refuse_loss(const std::filesystem::path& folder, bool resume, bool overwrite);
    /// What of `read` can be said before the model is read: throws as it does. Nothing there is no fault.
    static void expect_same_job(const std::filesystem::path& folder, std::string_view opened_identity);
    /// For who stops a job whose loop is saved in `folder`: how to go on (base/stop_deadline.h).
    [[nodiscard]] static std::string advice(const std::filesystem::path& folder);
    /// How many steps the loop has taken whose state `folder` holds, whosever it is; 0: there is none, or one of
    /// another version.
    [[nodiscard]] static std::size_t saved_steps(const std::filesystem::path& folder);
    /// Once the job is done.
    static void remove_from(const std::filesystem::path& folder);

private:
    Artefact file_;
    ArtefactKey key_;
    std::size_t cells_;
};

}  // namespace voxtone::slicer
