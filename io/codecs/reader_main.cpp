// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-read: parses one model, picture or layer stack for another program, which started it under limits of memory
// and time. Pictures that are not PNG, JPEG or WebP it has decoded by that program's leave.
#include <cstdio>

#include "io/codecs/read_here.h"
#include "io/files/serve_isolated.h"
#include "io/layers/stack_service.h"

int main() {
    voxtone::io::StackService stack;
    voxtone::io::serve_isolated([&](std::span<const std::byte> request) {
        return stack.serves(request) ? voxtone::io::packing_of(stack.answer(request)) : voxtone::io::answer(request);
    });
    std::fputs(
        "voxtone-read reads models, pictures and layer stacks for voxtone, which starts it; it has no use by hand\n",
        stderr);
    return 2;
}
