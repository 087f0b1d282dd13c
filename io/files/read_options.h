// SPDX-License-Identifier: GPL-3.0-or-later
//
// What reading a model or a picture may cost: files are taken for hostile.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/named_values.h"
#include "base/progress.h"
#include "io/files/isolate.h"

namespace voxtone::io {

/// Half of the memory that there is for this process (base/machine_memory.h), 8 GiB at most; a limit of address space
/// is its own, and is told as such: the largest picture that is allowed, 16,384 x 16,384 RGBA, takes 2.1 GiB at 8 bits
/// and 4.2 at 16.
[[nodiscard]] std::uint64_t default_read_memory();

/// How a texture's colours are found between the middles of its texels.
enum class TextureFilter : std::uint8_t {
    as_file,  ///< as the model's file says; linear where it does not
    nearest,  ///< the nearest texel's: sharp edges, of pixel art
    linear,   ///< blended
};

/// How many pixels a drawing (SVG) gets, which has none: those of the print that it is for.
struct DrawingRaster {
    double pitch_mm = 0;                              ///< of the print's finest places; 0: drawings are refused
    double width_mm = 0, height_mm = 0, size_mm = 0;  ///< of the print, the first that is not 0: its longer side last
    double px_per_inch = 0;                           ///< of what the file counts in px; 0: 96, as CSS has it
};

struct ReadOptions {
    std::uint64_t memory_bytes = default_read_memory();  ///< what parsing may take; 0: no limit (sanitizers need that)
    double timeout_s = 120;                              ///< of the processor; > 0
    std::uint64_t max_file_bytes = std::uint64_t{2} << 30;
    std::uint64_t max_pixels = std::uint64_t{1} << 28;          ///< of one picture
    std::uint64_t max_unpacked_bytes = std::uint64_t{2} << 30;  ///< of all of a 3MF's parts
    bool fill_gutters = true;
    std::filesystem::path texture;  ///< of a model: laid on what has coordinates and no picture; empty: none
    TextureFilter texture_filter = TextureFilter::as_file;
    bool keep_alpha = false;             ///< beside the colours, instead of laying these over white
    DrawingRaster drawing;               ///< of a picture that is a drawing
    std::string more = {};               ///< for messages: how the user allows more, if there is a way
    const Progress* progress = nullptr;  ///< asked for cancellation
};

/// Throws UsageError naming the option that is out of range.
void validate(const ReadOptions& options);

/// Of the program that parses.
[[nodiscard]] IsolationLimits isolation_limits(const ReadOptions& options);

}  // namespace voxtone::io

template <>
struct voxtone::NamesOf<voxtone::io::TextureFilter> {
    using Filter = io::TextureFilter;
    static constexpr auto table = std::to_array<Named<Filter>>(
        {{Filter::as_file, "file"}, {Filter::nearest, "nearest"}, {Filter::linear, "linear"}});
};
