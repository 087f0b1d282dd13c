// SPDX-License-Identifier: GPL-3.0-or-later
//
// Buffer views that are compressed by meshoptimizer (libmeshoptimizer), as glTF's extensions EXT_meshopt_compression
// and KHR_meshopt_compression hold them. Decoding loses nothing; filters give what their encoder rounded to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

/// As the file says it.
struct MeshoptStream {
    std::span<const std::byte> bytes;
    std::int64_t count = 0, stride = 0;
    std::string mode, filter = "NONE";  ///< ATTRIBUTES, TRIANGLES or INDICES; OCTAHEDRAL, QUATERNION, EXPONENTIAL
};

struct MeshoptResult {
    std::vector<std::byte> bytes;  ///< count * stride
    std::string newer;             ///< what the library is too old for ("version 1 of its coding"); empty: nothing
};

/// Throws InputError saying what is wrong with the stream (not whose it is), also where it takes more than
/// `most_bytes`.
[[nodiscard]] MeshoptResult decode_meshopt(const MeshoptStream& stream, std::uint64_t most_bytes);

}  // namespace voxtone::io
