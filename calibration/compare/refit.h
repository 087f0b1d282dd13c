// SPDX-License-Identifier: GPL-3.0-or-later
//
// A set of resins made better by photographs of prints: what is known (the set) and what regions of prints say of it
// (print_regions.h), by linear least squares in x = ln sigma_t and ln (sigma_a / sigma_s) of every resin and channel:
//
//   sum of  rho((printed / gain - predicted - veil - D (x - x_print)) / (sigma s))  +  (x - x_set)' C^-1 (x - x_set)
//
// s makes an error as large as CIELAB's L sees it; rho is Tukey's biweight, sigma the scale of what is left. Gains of
// red, green, blue, a veil of stray light and what is left of uneven light (a quadratic) are every print's own. C: the
// amount of pigment in a cartridge, which moves all channels alike (12 %), and what the set errs in each channel (6 %).
//
// Cannot see: resins that the prints hardly hold; g and eta; what all prints share (a wrong white of the checker).
// Steps are linear about the set by which a print was predicted: where a resin moves by far, compare again with the new
// set, and fit again with the first one as --prior.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/compare/print_regions.h"

namespace voxtone::calibration {

struct ResinChange {
    double extinction = 0, extinction_error = 0;  ///< ln, mean over the channels, and its standard error
    double absorption = 0, absorption_error = 0;  ///< of sigma_a / sigma_s
};

struct Refit {
    optics::ResinSet set;
    std::vector<ResinChange> resins;
    double before = 0, after = 0;  ///< mean CIEDE2000 of regions, gains and light of each print taken out
    /// The same of prints that took no part, one after the other; nothing of one print.
    std::optional<double> left_out;
};

/// `sheets`: one at least. Throws InputError where they are of other resins or channels than `known`, or of none that
/// counts.
[[nodiscard]] Refit refit_resins(std::span<const RegionSheet> sheets, const optics::ResinSet& known);

}  // namespace voxtone::calibration
