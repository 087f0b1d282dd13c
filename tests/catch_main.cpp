// SPDX-License-Identifier: GPL-3.0-or-later
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>

#include "tests/outcomes.h"
#include "tests/places.h"

namespace {

bool skipped = false;

}  // namespace

namespace voxtone::test {

void skip(const std::string& reason) {
    skipped = true;
    std::cout << "SKIPPED: " << reason << std::endl;
}

}  // namespace voxtone::test

/// The tests of a tree run the helper programs of that tree, whatever else is installed.
int main(int argc, char** argv) {
    setenv("VOXTONE_HELPERS", voxtone::test::helpers_dir().c_str(), 0);
    const int failed = Catch::Session().run(argc, argv);
    return failed == 0 && skipped ? 77 : failed;
}
