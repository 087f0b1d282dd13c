// SPDX-License-Identifier: GPL-3.0-or-later
//
// The state of an appearance loop on disk, so that an interrupted job can go on: OUT/loop.checkpoint, written after
// each iteration under a temporary name and renamed, removed when the loop is done.
//
// A state belongs to one job: options that decide its result (all but threads, iterations, report and the like) and the
// target of every cell are part of a digest in the file, and another job's state is refused. Digests are XXH64: nobody
// gains by a forged state, and it must cost nothing beside the iteration.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "voxtone/base/progress.h"
#include "voxtone/halftone/loop/appearance_loop.h"
#include "voxtone/slicer/options/slice_options.h"

namespace voxtone::slicer {

class LoopCheckpoint {
public:
    LoopCheckpoint(const std::filesystem::path& folder, const SliceOptions& options,
                   std::span<const Eigen::Vector3f> target);

    /// Throws FileError.
    void write(const halftone::LoopState& state) const;
    /// Nothing, with a note, where there is none. Throws InputError for one of another job, FileError for a broken one.
    [[nodiscard]] std::optional<halftone::LoopState> read(Progress& progress) const;
    void remove() const;

private:
    std::filesystem::path file_;
    std::uint64_t digest_;
    std::size_t cells_;
};

}  // namespace voxtone::slicer
