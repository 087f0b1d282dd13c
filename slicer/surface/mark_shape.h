// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a mark shows, in its true size, before it lies anywhere: the ink of a text or code, or the pixels of a picture.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/files/read_options.h"
#include "io/lettering/coverage.h"
#include "io/pictures/alpha_picture.h"
#include "slicer/options/mark_options.h"

namespace voxtone::slicer {

struct MarkShape {
    io::Coverage ink;                                ///< with a quiet zone around codes; of pictures their alpha
    std::shared_ptr<const io::AlphaPicture> pixels;  ///< of pictures
    double width_mm = 0, height_mm = 0;              ///< pictures laid by texture coordinates have a ratio alone
    double module_mm = 0;                            ///< of codes
    std::vector<std::string> warnings;               ///< of the picture's reader
    std::vector<std::string> notes;                  ///< what may be worth a thought
};

/// Codes of smaller modules are hardly read: one of 0.31 mm was in one print and not in the next (printed_codes.h).
inline constexpr double least_module_mm = 0.3;

/// Text of a smaller face is hardly read: of 1.2 mm it was pale on a cow's white, and of 0.85 mm gone.
inline constexpr double least_type_mm = 1.2;

/// Sets the text, makes the code or reads the picture, a drawing with a pixel for each `pitch_mm` (needed of these
/// alone). Throws FileError, InputError that begins with the mark.
[[nodiscard]] MarkShape shape_of(const MarkOptions& mark, const io::ReadOptions& reading, double pitch_mm = 0);

/// The shape in its colours.
[[nodiscard]] std::shared_ptr<const io::AlphaPicture> coloured(const MarkShape& shape, const Eigen::Vector3f* ink_rgb,
                                                               const std::optional<Eigen::Vector3f>& ground_rgb);

}  // namespace voxtone::slicer
