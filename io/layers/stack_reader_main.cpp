// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-read-stack: reads a layer stack for another program, which started it under limits of memory and time. It is
// not voxtone-read, because it starts ten times as fast without the libraries of pictures and models.
#include <cstdio>

#include "io/files/serve_isolated.h"
#include "io/layers/stack_service.h"

int main() {
    voxtone::io::StackService service;
    voxtone::io::serve_isolated(
        [&](std::span<const std::byte> request) { return voxtone::io::packing_of(service.answer(request)); });
    std::fputs("voxtone-read-stack reads layer stacks for voxtone, which starts it; it has no use by hand\n", stderr);
    return 2;
}
