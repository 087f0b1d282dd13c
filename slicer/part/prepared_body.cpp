// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/prepared_body.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/pictures/texture.h"
#include "io/programs/build_identity.h"
#include "io/shards/shard_folder.h"
#include "slicer/part/artefact.h"

namespace voxtone::slicer {

template <class Stream, class Void>
requires std::is_same_v<std::remove_const_t<Void>, Cavity>
void describe(Stream& stream, Void& v) { stream(v.volume_mm3, v.wall_mm, v.centre_mm, v.filled, v.crossed); }

namespace {

using io::PackedReader;
using io::PackedWriter;

constexpr ArtefactKind prepared_kind{"voxtone-prepared", 2, "is not whole", "is of another job",
                                     "is of another version"};

Artefact prepared_of(const std::filesystem::path& out, std::string_view job) {
    return {io::prepared_file(out, job), prepared_kind};
}

ArtefactKey key_of(std::string_view job) { return {digest_of_text(io::build_identity()), digest_of_text(job)}; }

template <class Stream, class Vector>
void vector_in(Stream& stream, Vector& v) {
    stream(v[0], v[1], v[2]);
}

template <class Stream, class Mesh>
void mesh_in(Stream& stream, Mesh& mesh) {
    stream(mesh.positions, mesh.triangles, mesh.material_of_triangle, mesh.corner_uv, mesh.corner_rgb,
           mesh.corner_alpha);
}

template <class Stream, class Solid>
void solid_in(Stream& stream, Solid& solid) {
    stream(solid.positions_mm, solid.triangles, solid.source_triangle);
}

template <class Stream, class Surface>
void surface_in(Stream& stream, Surface& surface) {
    stream(surface.positions_mm, surface.triangles, surface.source_triangle, surface.source_uv);
}

template <class Stream, class Diagnosis>
void diagnosis_in(Stream& stream, Diagnosis& d) {
    stream(d.triangles, d.boundary_edges, d.nonmanifold_edges, d.inconsistent_edges, d.open_edges, d.degenerate_faces,
           d.duplicate_faces, d.shells, d.crossing_pairs, d.area_mm2, d.volume_mm3);
}

/// All that is no mesh, texture or index.
template <class Stream, class Body>
void rest_in(Stream& stream, Body& body) {
    auto& model = body.model;
    stream(model.format, model.mm_per_file_unit, model.has_colour, model.wants_colour, model.warnings,
           model.lost_colour);
    stream(body.name, body.is_picture, body.warnings, body.notes);
    auto& placement = body.placement;
    stream(placement.mm_per_file_unit, placement.unit_assumed, placement.is_picture, placement.summary);
    vector_in(stream, placement.extent_mm);
    vector_in(stream, placement.corner_mm);
    vector_in(stream, body.grid.origin_mm);
    vector_in(stream, body.grid.pitch_mm);
    stream(body.grid.size);
    auto& r = body.repair;
    diagnosis_in(stream, r.before);
    diagnosis_in(stream, r.after);
    stream(r.welded_vertices, r.dropped_faces, r.turned_faces, r.turned_shells, r.cavities, r.filled_holes,
           r.filled_area_mm2, r.wrapped_faces, r.wrap_alpha_mm, r.wrap_offset_mm, r.voids, r.messages,
           body.wrapped_triangles);
}

/// Materials share textures, and these their pyramids: each pyramid is written once.
void put_materials(PackedWriter& to, const std::vector<io::SurfaceMaterial>& materials) {
    std::map<const io::MipPyramid*, std::uint32_t> number;
    std::vector<const io::MipPyramid*> pyramids;
    for (const io::SurfaceMaterial& material : materials)
        for (const auto& texture : {material.texture, material.alpha_texture})
            if (texture && number.emplace(texture->pyramid().get(), std::uint32_t(pyramids.size())).second)
                pyramids.push_back(texture->pyramid().get());
    to(std::uint64_t{pyramids.size()});
    for (const io::MipPyramid* pyramid : pyramids)
        to(pyramid->levels(), pyramid->texels().srgb8, pyramid->texels().linear16);
    to(std::uint64_t{materials.size()});
    for (const io::SurfaceMaterial& material : materials) {
        to(material.name, material.rgb, material.alpha, material.alpha_of_lengths, material.times_as_large);
        for (const auto& texture : {material.texture, material.alpha_texture}) {
            to(texture != nullptr);
            if (texture)
                to(number.at(texture->pyramid().get()), texture->wrap_u(), texture->wrap_v(), texture->nearest());
        }
    }
}

/// All its levels lie within its texels.
std::shared_ptr<const io::MipPyramid> pyramid_from(PackedReader& from) {
    std::vector<io::MipPyramid::Level> levels;
    io::MipPyramid::Texels texels;
    from(levels, texels.srgb8, texels.linear16);
    const std::size_t all = texels.count();
    if (texels.srgb8.empty() == texels.linear16.empty())
        throw InputError("what the first shard left has a texture of no kind");
    const bool fit = std::ranges::all_of(levels, [&](const io::MipPyramid::Level& level) {
        const std::uint64_t own = std::uint64_t{level.width} * level.height;
        return own >= 1 && own <= all && level.first <= all - own;
    });
    if (levels.empty() || !fit) throw InputError("what the first shard left has a texture without its texels");
    return std::make_shared<const io::MipPyramid>(std::move(levels), std::move(texels));
}

std::vector<io::SurfaceMaterial> materials_from(PackedReader& from) {
    std::uint64_t count = 0;
    from(count);
    std::vector<std::shared_ptr<const io::MipPyramid>> pyramids;
    for (std::uint64_t i = 0; i < count; ++i) pyramids.push_back(pyramid_from(from));
    from(count);
    std::vector<io::SurfaceMaterial> materials;
    for (std::uint64_t i = 0; i < count; ++i) {
        io::SurfaceMaterial& material = materials.emplace_back();
        from(material.name, material.rgb, material.alpha, material.alpha_of_lengths, material.times_as_large);
        for (auto* texture : {&material.texture, &material.alpha_texture}) {
            bool has_texture = false;
            from(has_texture);
            if (!has_texture) continue;
            std::uint32_t pyramid = 0;
            io::Wrap wrap_u{}, wrap_v{};
            bool nearest = false;
            from(pyramid, wrap_u, wrap_v, nearest);
            if (pyramid >= pyramids.size())
                throw InputError("what the first shard left has a material without its texture");
            *texture = std::make_shared<const io::Texture>(pyramids[pyramid], wrap_u, wrap_v, nearest);
        }
    }
    return materials;
}

template <class Stream, class Decal>
void decal_in(Stream& stream, Decal& d) {
    stream(d.width_mm, d.height_mm, d.slack_mm, d.by_uv, d.first_hit.columns, d.first_hit.rows, d.first_hit.depth_mm);
    vector_in(stream, d.corner_mm);
    vector_in(stream, d.right);
    vector_in(stream, d.up);
    vector_in(stream, d.out);
}

void put_decals(PackedWriter& to, const std::vector<io::Decal>& decals) {
    to(std::uint64_t{decals.size()});
    for (const io::Decal& decal : decals) {
        decal_in(to, decal);
        to(decal.picture->width_px(), decal.picture->height_px(), decal.picture->pixels());
    }
}

std::vector<io::Decal> decals_from(PackedReader& from) {
    std::uint64_t count = 0;
    from(count);
    std::vector<io::Decal> decals;
    for (std::uint64_t i = 0; i < count; ++i) {
        io::Decal& decal = decals.emplace_back();
        decal_in(from, decal);
        std::uint32_t width = 0, height = 0;
        std::vector<io::AlphaPicture::Pixel> pixels;
        from(width, height, pixels);
        decal.picture = std::make_shared<const io::AlphaPicture>(width, height, std::move(pixels));
    }
    return decals;
}

void put_body(PackedWriter& to, const JobBody& body) {
    rest_in(to, body);
    to(std::uint64_t{body.side_files.size()});
    for (const io::SideFile& file : body.side_files) to(file.name, file.sha256);
    mesh_in(to, body.model.mesh);
    put_materials(to, body.model.mesh.materials);
    put_decals(to, body.model.mesh.decals);
    to(body.resin_of_decal, body.relief.runs(), body.relief.depths());
    solid_in(to, *body.solid);
    surface_in(to, *body.surface);
}

JobBody body_from(PackedReader& from) {
    JobBody body;
    rest_in(from, body);
    std::uint64_t files = 0;
    from(files);
    for (std::uint64_t i = 0; i < files; ++i) {
        io::SideFile& file = body.side_files.emplace_back();
        from(file.name, file.sha256);
    }
    mesh_in(from, body.model.mesh);
    body.model.mesh.materials = materials_from(from);
    body.model.mesh.decals = decals_from(from);
    std::vector<ReliefRun> relief;
    std::vector<DepthRun> depths;
    from(body.resin_of_decal, relief, depths);
    body.relief = Relief(relief, depths);
    SolidMesh solid;
    solid_in(from, solid);
    body.solid = SolidIndex(std::move(solid));
    VisibleSurface surface;
    surface_in(from, surface);
    body.surface = SurfaceIndex(std::move(surface));
    from.expect_end();
    return body;
}

}  // namespace

void keep_prepared(const std::filesystem::path& out, std::string_view job, const JobBody& body) {
    try {
        prepared_of(out, job).write(key_of(job), [&](PackedWriter& to) { put_body(to, body); });
    } catch (const Error&) {
        // A full disk will be told of by the layers.
    }
}

std::optional<JobBody> read_prepared(const std::filesystem::path& out, std::string_view job) {
    try {
        const Artefact::Content content = prepared_of(out, job).read(std::array{key_of(job)});
        PackedReader reader(content.values);
        return body_from(reader);
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace voxtone::slicer
