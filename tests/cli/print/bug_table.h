// SPDX-License-Identifier: GPL-3.0-or-later
//
// tests/data/bugs/expected.json: inputs made after public bug reports of other programs, and what is to come of each.
// Its keys are the names below (`exit` is exit_code). A report's own keys hold for all its lines; `body` names a line
// of `bodies`, keys that many lines share, and the line's own come after it.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "glb_sides.h"

namespace voxtone::test {

/// A place of a picture, as shares of its width and height from the top left, and its colour.
struct Spot {
    std::array<double, 2> at{};
    Codes codes{};
};

/// One run of the program.
struct BugLine {
    std::string id;       ///< of the report
    std::string file;     ///< below tests/data/bugs
    std::string verb;     ///< slice (the default), predict or verify
    std::string options;  ///< as a shell reads them; slice gets besides a fast screen and no prediction
    int exit_code = 0;
    std::vector<std::string> says, unsaid;             ///< what the messages hold, and what they may not
    bool lost = false;                                 ///< colours are LOST: said, and with --strict 3 is the exit code
    std::optional<std::array<double, 3>> size_mm;      ///< of OUT/layers to one voxel, of target.glb to 0.01 mm
    std::optional<double> volume_mm3;                  ///< of OUT/layers
    double volume_error = 0;                           ///< as a share: what a voxel at the body's faces makes
    std::map<std::string, Codes> sides;                ///< of target.glb: sRGB, median over a side of its box
    std::vector<Spot> spots;                           ///< of target.png
    std::map<std::string, std::array<double, 2>> top;  ///< least and most share of resins in the middle from above
    std::string like;                                  ///< another input, which gives the same picture
    int code_error = 2;  ///< a rounding to linear 16 or 8 bits and the filter at a texel's edge; JPEG: 3, 4
};

[[nodiscard]] std::filesystem::path bug_folder();
/// Throws std::exception on a key that is not known.
[[nodiscard]] std::vector<BugLine> bug_table();

}  // namespace voxtone::test
