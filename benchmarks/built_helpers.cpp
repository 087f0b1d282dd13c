// SPDX-License-Identifier: GPL-3.0-or-later
//
// The programs of this folder run the helper programs of the build that they are of, whatever else is installed
// (io/programs/helper_program.h).
#include <cstdlib>

#include "tests/places.h"

namespace {

[[maybe_unused]] const bool is_set = setenv("VOXTONE_HELPERS", voxtone::test::helpers_dir().c_str(), 0) == 0;

}  // namespace
