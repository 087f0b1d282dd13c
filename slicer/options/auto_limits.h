// SPDX-License-Identifier: GPL-3.0-or-later
//
// What "auto" goes by: coloured surfaces, in cm2.
#pragma once

namespace voxtone::slicer {

/// Up to which `--loop-method auto` goes on downhill after feedback, of pictures and where contrast is asked for, which
/// feedback knows nothing of: beyond it, and on bodies, feedback alone gains as much in a quarter to a half of the time
/// and two thirds of the memory (docs/decisions/002).
inline constexpr double descent_cm2 = 15;

/// Of a print that `slice` predicts without being asked: half a minute on two idle cores of 2.5 GHz, and 2.5 GB.
inline constexpr double auto_prediction_cm2 = 10;

}  // namespace voxtone::slicer
