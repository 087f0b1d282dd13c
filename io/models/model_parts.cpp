// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/model_parts.h"

#include <type_traits>

#include "voxtone/io/files/packed_values.h"
#include "voxtone/io/pictures/packed_image.h"

namespace voxtone::io {

template <class Stream, class Material>
requires std::is_same_v<std::remove_const_t<Material>, PartMaterial>
void describe(Stream& stream, Material& m) {
    stream(m.name, m.rgb, m.alpha, m.opaque, m.under, m.image, m.wrap_u, m.wrap_v, m.nearest);
}

template <class Stream, class Parts>
requires std::is_same_v<std::remove_const_t<Parts>, ModelParts>
void describe(Stream& stream, Parts& p) {
    stream(p.format, p.mm_per_file_unit, p.has_colour, p.positions, p.triangles, p.material_of_triangle, p.corner_uv,
           p.corner_rgba, p.materials, p.images, p.image_names, p.warnings);
}

std::vector<std::byte> pack(const ModelParts& parts) {
    PackedWriter writer;
    describe(writer, parts);
    return std::move(writer.bytes);
}

ModelParts unpack_model(std::span<const std::byte> bytes) {
    ModelParts parts;
    PackedReader reader(bytes);
    describe(reader, parts);
    return parts;
}

}  // namespace voxtone::io
