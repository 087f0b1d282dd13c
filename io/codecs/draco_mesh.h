// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes that are compressed with Draco (libdraco), as glTF's extension KHR_draco_mesh_compression holds them. What a
// stream declares is compared with a limit before the library is asked to believe it. Positions are off by half a
// quantum at most, as the encoder rounded them; what lay together in it lies together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace voxtone::io {

/// Values of all points of a mesh, packed.
struct DracoValues {
    std::int64_t component_type = 0;  ///< as glTF numbers them: 5120 to 5123 or 5126
    std::size_t components = 0;
    std::vector<std::byte> bytes{};
};

/// An attribute of the stream, and the type that the file says it has, which tells how small its integers were.
struct DracoAttribute {
    std::uint32_t id = 0;
    std::int64_t component_type = 0;
};

struct DracoMesh {
    std::size_t points = 0;
    std::vector<std::uint32_t> corners;  ///< three a triangle, each below `points`
    double quantum = 0;                  ///< the step of positions, in their unit; 0: they were not rounded
    std::vector<DracoValues> values;     ///< in the order of the attributes that were asked for
};

/// Throws InputError saying what is wrong with the stream (not whose it is), also where its triangles and points take
/// more than `most_bytes`.
[[nodiscard]] DracoMesh decode_draco(std::span<const std::byte> stream, std::span<const DracoAttribute> attributes,
                                     std::uint64_t most_bytes);

}  // namespace voxtone::io
