// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functions of float with the same bits on every system: glibc's own differ in the last place between 2.36 and 2.41,
// whose are correctly rounded (Debian 12, 13). Those of double are the same bits in both (as expf, powf, hypotf are),
// and rounded to float nearly always the nearest one. tests/same_math looks that no program draws another.
#pragma once

#include <cmath>

namespace voxtone::portable {

[[nodiscard]] inline float cbrt(float x) { return static_cast<float>(std::cbrt(static_cast<double>(x))); }
[[nodiscard]] inline float sinh(float x) { return static_cast<float>(std::sinh(static_cast<double>(x))); }
[[nodiscard]] inline float tanh(float x) { return static_cast<float>(std::tanh(static_cast<double>(x))); }
[[nodiscard]] inline float atan2(float y, float x) {
    return static_cast<float>(std::atan2(static_cast<double>(y), static_cast<double>(x)));
}

}  // namespace voxtone::portable
