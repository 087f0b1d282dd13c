// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job takes of the machine.
//
// A bound by its options and the size of its model's file costs nothing and is enough where the memory of the machine
// is not short. Where it is, `voxtone estimate` is asked in a process of its own (docs/estimate.md): seconds, for jobs
// that take minutes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "farm/batch/job_state.h"
#include "slicer/options/slice_options.h"

namespace voxtone::farm {

struct JobWeight {
    std::uint64_t memory_bytes = 0;       ///< at its peak
    int threads = 0;                      ///< that the job was told to take; 0: as many as it is given
    double cpu_s = 0;                     ///< of processors; 0: not known
    bool bound = false;                   ///< the memory is no more than a bound, that of a body like a full box
    [[nodiscard]] bool is_known() const;  ///< something can be said of the memory
};

/// Changes nothing on disk, reads no model, throws nothing. Where nothing can be said of its size the bound is beyond
/// every machine. `known`: of a job that was done with the same words, whose peak is taken then; may be null.
[[nodiscard]] JobWeight weigh(const slicer::SliceOptions& options, const std::vector<std::string>& command,
                              const JobState* known);

/// Words behind `voxtone` that estimate what these slice.
[[nodiscard]] std::vector<std::string> estimate_words(const std::vector<std::string>& slice_words);

/// Of a job that was killed for memory: twice as much, so that it runs beside fewer others, or alone.
[[nodiscard]] JobWeight with_more_memory(const JobWeight& before);

/// How the line begins that they print at last.
inline constexpr const char* estimate_begin = R"({"event":"result","result":)";
/// Of what stands behind that, with the weight that was taken until then where that cannot be read.
[[nodiscard]] JobWeight weigh_by_estimate(const JobWeight& before, const std::string& rest_of_line);

}  // namespace voxtone::farm
