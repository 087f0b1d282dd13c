// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mixtures that fill what a printer can print: shares of inks that sum to 1 at most, the rest being another resin.
//
// First nothing of all inks and each solid, then ramps of two resins (the rest among them) in up to seven steps, then a
// low-discrepancy set: the additive recurrence of Roberts 2018 ("The unreasonable effectiveness of quasirandom
// sequences"), u_kj = frac(1/2 + k phi^-j) with phi^(d+1) = phi + 1, one dimension for each resin, and shares
// proportional to (-ln u)^2. With the exponent 1 these would be even over all mixtures; 2 has more of them where one
// share is small, where colours change fastest.
#pragma once

#include <cstddef>
#include <vector>

namespace voxtone::calibration {

/// `count` mixtures, each the shares of the inks in 1/10000; the same at every call. Ramps are at most a quarter of
/// them. Contract: at least one ink, and count > inks.
[[nodiscard]] std::vector<std::vector<double>> mixture_samples(std::size_t inks, std::size_t count);

}  // namespace voxtone::calibration
