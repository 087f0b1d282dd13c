// SPDX-License-Identifier: GPL-3.0-or-later
//
// The 68 % interval of a value that cannot be negative, from an estimate that can: Feldman, Cousins 1998, Phys. Rev. D
// 57:3873, Sec. IV.B. An estimate x with a normal error of 1 gives [low, high]; far from 0 that is x - 1 to x + 1; near
// it and below, the interval ends at 0 and still holds the truth in 68 % of all cases, where cutting off x - 1 to x + 1
// does not.
#pragma once

namespace voxtone::calibration {

struct Interval {
    double low = 0, high = 0;
};

/// `x`: the estimate in units of its standard error; below -3 it counts as -3. Error of the ends: 1e-6.
[[nodiscard]] Interval interval_above_zero(double x);

}  // namespace voxtone::calibration
