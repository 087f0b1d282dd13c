// SPDX-License-Identifier: GPL-3.0-or-later
//
// The range of colours in files that do not name it: one rule for OBJ, MTL, PLY and floats of glTF.
//
// Bytes are of 0 to 255. Numbers with a point are of 0 to 1 as long as none is above 1.5, or none above 16 and some are
// no whole numbers (1.02 and 1.7 are colours too bright, and clamped). All other numbers are of the smallest of 0 to
// 255, 65535 and 2^32 - 1 that holds them all; 256 still counts as the first. The rule looks at the whole file; alpha
// is of 0 to 1 beside numbers with a point as long as none of it is above 1.5. Values are sRGB codes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

enum class ColourNumbers : char { bytes, integers, reals };

/// Colours as they stand in a file.
struct FileColours {
    std::vector<Eigen::Vector4d> value;  ///< red, green, blue, alpha; red is not a number: there is no colour
    ColourNumbers numbers = ColourNumbers::reals, alpha_numbers = ColourNumbers::reals;
    bool has_alpha = false;  ///< else alpha is not looked at
};

/// What stands for full light, where the largest value is `most`. `whole`: all values are whole numbers.
[[nodiscard]] double colour_range(double most, ColourNumbers numbers, bool whole = true);

/// Linear, alpha in [0, 1]; not a number where there is no colour. What is not usual (another range, values beyond it)
/// is said in `warnings`: the colours are those of `whose` ("vertex", "face") in `file`. Where clamping leaves one
/// colour of several, that is said in `lost`.
[[nodiscard]] std::vector<Eigen::Vector4f> settled_colours(const FileColours& colours, std::string_view whose,
                                                           std::string_view file, std::vector<std::string>& warnings,
                                                           std::vector<std::string>* lost = nullptr);

/// The sentence for colours that clamping to 0 to `range` has made one.
[[nodiscard]] std::string all_clamped_to_one(std::string_view whose, std::string_view file, double range);

/// The sentence for colours that only some vertices or faces (`whose`) have.
[[nodiscard]] std::string white_without_colour(std::size_t count, std::string_view whose, std::string_view file);

}  // namespace voxtone::io
