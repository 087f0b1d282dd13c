// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/places.h"

namespace voxtone::test {

std::string source_dir() { return VOXTONE_SOURCE_DIR; }
std::string test_data() { return source_dir() + "/tests/data"; }
std::string build_dir() { return VOXTONE_BUILD_DIR; }
std::string helpers_dir() { return VOXTONE_HELPERS; }
std::string program() { return helpers_dir() + "/voxtone"; }

}  // namespace voxtone::test
