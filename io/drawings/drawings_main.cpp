// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-read-drawings: draws SVG for another program, which started it under limits of memory and time.
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "io/drawings/draw_svg.h"
#include "io/files/file_reader.h"
#include "io/files/serve_isolated.h"
#include "io/pictures/packed_image.h"

namespace {

using namespace voxtone;

io::Packing answer(std::span<const std::byte> bytes) {
    const io::ReadRequest request = io::unpack_request(bytes);
    if (request.kind != io::ReadKind::other_picture) throw InputError("what is to be read is no drawing");
    return packing_of(
        io::draw_svg(request.bytes, request.path, {.max_pixels = request.max_pixels, .drawing = request.drawing}));
}

}  // namespace

int main() {
    setenv("RAYON_NUM_THREADS", "1", 1);  // librsvg's filters: a thread each would take address space from its budget
    io::serve_isolated(answer);
    std::fputs("voxtone-read-drawings draws SVG for voxtone, which starts it; it has no use by hand\n", stderr);
    return 2;
}
