// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fit of a target whose squares have ends (calibration/target/square_ends.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/resin_fit.h"
#include "calibration/target/square_ends.h"
#include "calibration/target/target_layout.h"

namespace voxtone::calibration {

struct SquareEnds {
    /// Of each patch and channel: seen less what a square without end shows; 0 where it is no square of the target.
    std::vector<std::vector<double>> more;
};

/// By resins that are known to a first approximation. Contract: the set has the channels of the table. Throws
/// InputError where no patch is one of the target's squares.
[[nodiscard]] SquareEnds square_ends(const PatchTable& table, const Target& target, const optics::ResinSet& resins,
                                     UnderBase under);
/// By what is known of the deep squares.
[[nodiscard]] SquareEnds square_ends(const PatchTable& table, const Target& target, const optics::ResinSet& resins,
                                     UnderBase under, const LightOfSquares& deep);

/// A reading keeps a fifth of itself.
void take_ends_off(PatchTable& table, const SquareEnds& ends);

/// The fit of a table less the ends of its squares, found together: from the resins follow the ends, from the table
/// without them the resins. Light paths of deep squares, `paths` each, are drawn for the first two of these turns: what
/// moves later is less than their noise. Throws InputError as both.
struct EndedFit {
    ResinFit fit;
    PatchTable table;            ///< without the ends
    std::optional<double> most;  ///< that was taken from a value, signed
    std::string where;           ///< "Y on W in R"
};
[[nodiscard]] EndedFit fit_ended_squares(PatchTable table, const Target& target, const FitOptions& options,
                                         const Progress* progress = nullptr, double paths = 20000);
/// Empty where the target is not known.
[[nodiscard]] std::string ends_sentence(const EndedFit& ended);

}  // namespace voxtone::calibration
