// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbered pictures, as other programs write the layers of a print: which files of a folder belong together, in which
// order, which numbers are missing, and which files beside them look as if they belonged.
//
// A name is text and numbers ("slice_12.png", "slice-0.27mm.png", "x_12_3.png"). Names with the same text, in any case
// of letters, are a series; of several numbers the one that differs most counts, the others tell series apart. A number
// may have a fraction, or commas or points between its thousands; a minus counts as one where no letter, digit or sign
// stands before it ("slice_-3", not "slice-3").
#pragma once

#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

struct PictureSeries {
    std::vector<std::string> names;      ///< of the largest series of PNG files, by rising number; each number once
    std::vector<std::string> strangers;  ///< all other files, by name
};
/// Of the names of a folder's files. The same for any order of them.
[[nodiscard]] PictureSeries find_series(std::span<const std::string> files);

/// Numbers that are missing in a series that `find_series` found: whole sentences, none where all are there.
[[nodiscard]] std::vector<std::string> series_gaps(std::span<const std::string> names);
/// Strangers that look like pictures of the series, and numbers below 0: whole sentences.
[[nodiscard]] std::vector<std::string> series_doubts(std::span<const std::string> names,
                                                     std::span<const std::string> strangers);

/// What numbered pictures there are among files without a PNG: "60 files like slice_1.tif"; empty: none.
[[nodiscard]] std::string other_pictures(std::span<const std::string> files);

}  // namespace voxtone::io
