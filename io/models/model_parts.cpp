// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/model_parts.h"

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/packed_values.h"
#include "io/pictures/packed_image.h"

namespace voxtone::io {

template <class Stream, class Material>
requires std::is_same_v<std::remove_const_t<Material>, PartMaterial>
void describe(Stream& stream, Material& m) {
    stream(m.name, m.rgb, m.alpha, m.opaque, m.under, m.image, m.wrap_u, m.wrap_v, m.nearest, m.glass, m.through,
           m.through_image, m.within, m.alpha_of_lengths, m.tint);
}

template <class Stream, class File>
requires std::is_same_v<std::remove_const_t<File>, SideFile>
void describe(Stream& stream, File& f) { stream(f.name, f.sha256); }

template <class Stream, class Parts>
requires std::is_same_v<std::remove_const_t<Parts>, ModelParts>
void describe(Stream& stream, Parts& p) {
    stream(p.format, p.mm_per_file_unit, p.has_colour, p.positions, p.triangles, p.material_of_triangle, p.corner_uv,
           p.corner_rgba, p.materials, p.images, p.image_names, p.warnings, p.notes, p.lost_colours, p.lost_textures,
           p.side_files);
}

namespace {

void expect(bool holds, const char* what) {
    if (!holds) throw InputError(fmt::format("what the reader left is no model: {}", what));
}

bool is_wrap(Wrap wrap) { return wrap <= Wrap::decal; }

/// What finish_model takes for granted; it looks at indices and values itself.
void check(const ModelParts& parts) {
    expect(parts.material_of_triangle.size() == parts.triangles.size(), "triangles without a material");
    expect(parts.corner_uv.size() <= parts.triangles.size(), "texture coordinates without a triangle");
    expect(parts.corner_rgba.size() <= parts.triangles.size(), "colours without a triangle");
    expect(parts.image_names.size() == parts.images.size(), "pictures without a name");
    for (const DecodedImage& image : parts.images) check_decoded(image);
    for (const PartMaterial& material : parts.materials)
        expect(is_wrap(material.wrap_u) && is_wrap(material.wrap_v), "a texture laid down in an unknown way");
}

}  // namespace

std::vector<std::byte> pack(const ModelParts& parts) { return packed(parts); }

Packing packing_of(ModelParts parts) { return packing(std::move(parts)); }

ModelParts unpack_model(std::span<const std::byte> bytes) {
    PackedReader reader(bytes);
    return unpack_model(reader);
}

ModelParts unpack_model(PackedReader& reader) {
    auto parts = unpacked<ModelParts>(reader);
    check(parts);
    return parts;
}

}  // namespace voxtone::io
