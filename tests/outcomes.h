// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two outcomes that Catch2 has no word for.
#pragma once

#include <string>

#include <catch2/catch.hpp>

/// A figure that was asked for and is not reached yet. The test goes on and says so; a CHECK beside it guards what was
/// reached, and docs/benchmarks.md says what limits it. `grep -rn WANTED tests` lists them all.
#define WANTED(...) CHECK_NOFAIL(__VA_ARGS__)

namespace voxtone::test {

/// What the test needs is not on this machine. The program of tests ends with 77 where nothing failed and something
/// was skipped, and ctest, which runs every test case by itself, counts it as skipped. Return after it.
void skip(const std::string& reason);

}  // namespace voxtone::test
