// SPDX-License-Identifier: GPL-3.0-or-later
//
// Native units are mm, mm^-1, nm and radians; anything else carries its unit in its name. This header turns what a user
// writes ("60mm", "2.5 in", "1500MB", "2min") into numbers of one unit.
#pragma once

#include <string>
#include <string_view>

namespace voxtone {

inline constexpr double mm_per_inch = 25.4;  // exact by definition (1959)

/// Millimetres in one `unit`: um, mm, cm, m, in (inch), ft (foot). Throws UsageError naming the known units.
[[nodiscard]] double mm_per_unit(std::string_view unit);

/// "10.5mm" for "10,5mm"; empty for a text without a comma between digits. For messages: a comma is not understood, for
/// "1,000mm" might be a metre.
[[nodiscard]] std::string with_decimal_point(std::string_view text);

/// A length in mm from a number with an optional unit ("60", "60mm", "6 cm", "2.5in"); a bare number is in mm.
/// `what` names the option in the error. Throws UsageError.
[[nodiscard]] double parse_length_mm(std::string_view text, std::string_view what);
/// Memory in GiB (2^30 bytes) from a number with KiB, MiB, GiB, TiB or kB, MB, GB, TB (powers of ten) behind it; a bare
/// number is in GiB. Throws as above.
[[nodiscard]] double parse_memory_gib(std::string_view text, std::string_view what);
/// A time in s from a number with s, min, h or d behind it; a bare number is in s. Throws as above.
[[nodiscard]] double parse_time_s(std::string_view text, std::string_view what);

}  // namespace voxtone
