// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-read: parses one model or picture for another program, which started it under limits of memory and time.
// Pictures that are not PNG, JPEG or WebP it has decoded by that program's leave.
#include <cstdio>

#include "io/codecs/read_here.h"
#include "io/files/serve_isolated.h"

int main() {
    voxtone::io::serve_isolated(voxtone::io::answer);
    std::fputs("voxtone-read reads models and pictures for voxtone, which starts it; it has no use by hand\n", stderr);
    return 2;
}
