// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edge profiles as CSV, one line a sample; lines that begin with # are comments:
//
//   resin,thickness_mm,x_mm,R,G,B           and optionally  error_R,error_G,error_B
//
// x grows from the black to the white side, 0 is the edge; values are relative to a perfect diffuser. A sample in which
// all channels are clipped or unknown is left out of the file; one value may be empty or "nan".
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::calibration {

/// What was measured across the edge through one slab.
struct EdgeProfile {
    std::string resin;  ///< role: C, M, ...
    double thickness_mm = 0;
    std::vector<double> x_mm;                  ///< ascending
    std::array<std::vector<double>, 3> value;  ///< by channel
    std::array<std::vector<double>, 3> error;  ///< standard errors; empty: not given
};

/// Throws InputError that names file, line and column.
[[nodiscard]] std::vector<EdgeProfile> parse_edge_profiles(std::string_view text, const std::string& source);
/// Throws FileError, InputError.
[[nodiscard]] std::vector<EdgeProfile> read_edge_profiles(const std::filesystem::path& file);
/// `comment`: written before the header, a # before each of its lines.
[[nodiscard]] std::string edge_profiles_text(const std::vector<EdgeProfile>& profiles, std::string_view comment = {});

/// Throws InputError that says what no bench gives: the edge the wrong way round or not there, samples that do not
/// reach both sides, values outside [-0.2, 2].
void check_edge_profiles(const std::vector<EdgeProfile>& profiles, const std::string& source);

}  // namespace voxtone::calibration
