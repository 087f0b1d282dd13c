// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the tree and this build of it lie. One source alone is compiled with these paths, so that a compiler cache
// answers for all others in whatever folder a clone lies.
#pragma once

#include <string>

namespace voxtone::test {

/// The root of the tree, without a slash at the end, as are all.
[[nodiscard]] std::string source_dir();
[[nodiscard]] std::string test_data();
[[nodiscard]] std::string build_dir();
/// Helper programs and modules of this build (io/programs/helper_program.h).
[[nodiscard]] std::string helpers_dir();
/// The program `voxtone` of this build.
[[nodiscard]] std::string program();

}  // namespace voxtone::test
