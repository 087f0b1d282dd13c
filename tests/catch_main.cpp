// SPDX-License-Identifier: GPL-3.0-or-later
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>

/// The tests of a tree run the helper programs of that tree, whatever else is installed.
int main(int argc, char** argv) {
    setenv("VOXTONE_HELPERS", VOXTONE_HELPERS, 0);
    return Catch::Session().run(argc, argv);
}
