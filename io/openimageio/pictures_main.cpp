// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-read-pictures: decodes pictures that voxtone-read does not, and photographs, for another program, which
// started it under limits of memory and time.
#include <cstdio>

#include "base/error.h"
#include "io/files/file_reader.h"
#include "io/files/serve_isolated.h"
#include "io/openimageio/decode_other.h"
#include "io/openimageio/decode_photograph.h"
#include "io/openimageio/no_threads.h"
#include "io/pictures/packed_image.h"

namespace {

using namespace voxtone;

io::Packing answer(std::span<const std::byte> bytes) {
    const io::ReadRequest request = io::unpack_request(bytes);
    if (request.kind == io::ReadKind::photograph)
        return packing_of(io::decode_photograph(request.path, request.use_profile));
    if (request.kind != io::ReadKind::other_picture) throw InputError("what is to be read is no picture");
    return packing_of(io::decode_other(
        request.bytes, request.format, request.path,
        {.max_pixels = request.max_pixels, .use_profile = request.use_profile, .turn_upright = request.turn_upright}));
}

}  // namespace

int main() {
    io::end_threads();
    io::serve_isolated(answer);
    std::fputs("voxtone-read-pictures reads pictures for voxtone, which starts it; it has no use by hand\n", stderr);
    return 2;
}
