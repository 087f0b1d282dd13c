// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `slice` would print of a line of bug_table.h, by the rooms that it goes through until there is a body: options,
// reader, placement, repair, voxels, colours. No colour is separated, no layer is written, no page is drawn.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "bug_table.h"

namespace voxtone::test {

struct BodyOfLine {
    int exit_code = 0;  ///< that `slice` would end with
    std::string said;   ///< as stderr has it
    std::array<double, 3> size_mm{};
    double volume_mm3 = 0;
    std::vector<Codes> spots;  ///< seen there from above, in the order of the line's
};

/// `target`: gets the GLB that a report has of it, where sides are looked at. With `strict` as with --strict.
[[nodiscard]] BodyOfLine body_of_line(const BugLine& line, const std::filesystem::path& target, bool strict = false);

}  // namespace voxtone::test
