// SPDX-License-Identifier: GPL-3.0-or-later
//
// The phases that a job goes through, what users and farms know them by, and what one of them takes.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/named_values.h"
#include "halftone/loop/appearance_loop.h"

namespace voxtone::slicer {

/// In the order in which they come. Each is a stage of Progress by its name, but for the first, which is several.
enum class Phase : std::uint8_t {
    read,      ///< and repair
    separate,  ///< colours into mixtures
    prepare_loop,
    loop,
    profiles,  ///< of the resins, for a layered print
    search,    ///< for the stacks of a layered print
    layers,
    finish,  ///< manifest, container, the old stack out and the new one in
    predict,
    report,
};

}  // namespace voxtone::slicer

namespace voxtone {

template <>
struct NamesOf<slicer::Phase> {
    using P = slicer::Phase;
    static constexpr auto table = std::to_array<Named<P>>({{P::read, "read and repair"},
                                                           {P::separate, "separate colours"},
                                                           {P::prepare_loop, "prepare the loop"},
                                                           {P::loop, halftone::loop_stage},
                                                           {P::profiles, "profiles of the resins"},
                                                           {P::search, "search stacks"},
                                                           {P::layers, "layers"},
                                                           {P::finish, "finish"},
                                                           {P::predict, "predict"},
                                                           {P::report, "report"}});
};

}  // namespace voxtone

namespace voxtone::slicer {

/// What a phase of a job takes.
struct PhaseEstimate {
    Phase phase = Phase::read;
    double cpu_s = 0;                ///< seconds of processors, summed over threads
    double seconds = 0;              ///< of wall clock, on a machine that does nothing else
    std::uint64_t memory_bytes = 0;  ///< most that is held at once; not below the truth
    bool measured = false;           ///< was done for this estimate, and took that
};

}  // namespace voxtone::slicer
