// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job takes of the machine, before its model is read.
#pragma once

#include <cstdint>

#include "voxtone/slicer/options/slice_options.h"

namespace voxtone::slicer {

struct JobWeight {
    std::uint64_t memory_bytes = 0;  ///< at its peak
    int threads = 0;                 ///< that the job was told to take; 0: as many as it is given
};

/// Changes nothing on disk, reads no model, throws nothing. The memory is a guess by the size of the model's file.
[[nodiscard]] JobWeight weigh(const SliceOptions& options);

}  // namespace voxtone::slicer
