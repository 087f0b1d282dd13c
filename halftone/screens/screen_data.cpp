// SPDX-License-Identifier: GPL-3.0-or-later
//
// A unit by itself: it names a file of the build, for which no compiler cache answers.
#include "halftone/screens/screen_data.h"

// 2 bytes a voxel, in the machine's byte order.
__asm__(
    ".pushsection .rodata\n"
    ".balign 64\n"
    "voxtone_built_in_screens:\n"
    ".incbin \"" VOXTONE_SCREENS_FILE
    "\"\n"
    ".popsection\n");
extern "C" const std::uint16_t voxtone_built_in_screens[] __attribute__((visibility("hidden")));

namespace voxtone::halftone {

const std::uint16_t* screen_data() { return voxtone_built_in_screens; }

}  // namespace voxtone::halftone
