// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/files/whole_file.h"
#include "io/files/xxh64.h"
#include "io/pictures/texture.h"
#include "io/shards/shard_folder.h"
#include "slicer/part/prepared_body.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

namespace fs = std::filesystem;

const std::string this_job(64, 'a');

JobBody body_with_texture() {
    io::TexelImage image;
    image.width_px = image.height_px = 2;
    image.srgb8.assign(16, 200);
    JobBody body;
    body.name = "tile";
    body.model.mesh.materials.push_back(
        {"glaze", Eigen::Vector3f(0.25f, 0.5f, 1),
         std::make_shared<const io::Texture>(std::move(image), io::Wrap{}, io::Wrap{}, false), 1, nullptr});
    return body;
}

using Bytes = std::vector<std::uint8_t>;

/// Where the bytes of `what` stand in the file.
template <class Value>
std::size_t place_of(const Bytes& bytes, const std::vector<Value>& what) {
    const auto* const begin = reinterpret_cast<const std::uint8_t*>(what.data());
    const auto found = std::search(bytes.begin(), bytes.end(), begin, begin + what.size() * sizeof(Value));
    REQUIRE(found != bytes.end());
    return std::size_t(found - bytes.begin());
}

/// Puts a number in, and the sum that is right for it.
template <class Number>
void forge(const fs::path& file, Bytes bytes, std::size_t at, Number number) {
    REQUIRE(at + sizeof number < bytes.size() - sizeof(std::uint64_t));
    std::memcpy(bytes.data() + at, &number, sizeof number);
    const std::uint64_t sum = io::xxh64(std::span(bytes).first(bytes.size() - sizeof(std::uint64_t)));
    std::memcpy(bytes.data() + bytes.size() - sizeof sum, &sum, sizeof sum);
    io::write_whole_file(file, bytes);
}

}  // namespace

TEST_CASE("A prepared body comes back as it was, for its own job", "[shards]") {
    const io::TemporaryFolder folder;
    fs::create_directories(io::shards_folder(folder.path()));
    keep_prepared(folder.path(), this_job, body_with_texture());
    const auto body = read_prepared(folder.path(), this_job);
    REQUIRE(body);
    CHECK(body->name == "tile");
    REQUIRE(body->model.mesh.materials.size() == 1);
    const io::SurfaceMaterial& back = body->model.mesh.materials[0];
    const JobBody before = body_with_texture();
    CHECK(back.name == "glaze");
    CHECK(back.rgb == Eigen::Vector3f(0.25f, 0.5f, 1));
    CHECK(back.texture->pyramid()->texels() == before.model.mesh.materials[0].texture->pyramid()->texels());
    CHECK_FALSE(read_prepared(folder.path(), std::string(64, 'b')));
}

TEST_CASE("All that is told of a prepared body is told of it again", "[shards]") {
    const io::TemporaryFolder folder;
    fs::create_directories(io::shards_folder(folder.path()));
    JobBody body = body_with_texture();
    std::uint64_t n = 10;
    const auto fill = [&](MeshDiagnosis& d) {
        const auto count = [&](auto&... of) { ((of = std::remove_reference_t<decltype(of)>(n++)), ...); };
        count(d.triangles, d.boundary_edges, d.nonmanifold_edges, d.inconsistent_edges, d.open_edges,
              d.degenerate_faces, d.duplicate_faces, d.shells, d.crossing_pairs);
        d.area_mm2 = double(n++), d.volume_mm3 = double(n++);
    };
    fill(body.repair.before), fill(body.repair.after);
    body.warnings = {"one", "two"}, body.notes = {"a note"};
    body.model.format = "OBJ", body.model.mm_per_file_unit = 25.4;
    body.placement.mm_per_file_unit = 0.1, body.placement.unit_assumed = true, body.placement.summary = "so large";
    body.placement.extent_mm = {1, 2, 3}, body.placement.corner_mm = {4, 5, 6};
    body.grid.origin_mm = {7, 8, 9}, body.grid.pitch_mm = {0.1, 0.2, 0.3}, body.grid.size = {11, 12, 13};
    keep_prepared(folder.path(), this_job, body);
    const auto back = read_prepared(folder.path(), this_job);
    REQUIRE(back);
    for (const auto& [was, is] :
         {std::pair{&body.repair.before, &back->repair.before}, {&body.repair.after, &back->repair.after}}) {
        CHECK(is->triangles == was->triangles);
        CHECK(is->boundary_edges == was->boundary_edges);
        CHECK(is->nonmanifold_edges == was->nonmanifold_edges);
        CHECK(is->inconsistent_edges == was->inconsistent_edges);
        CHECK(is->open_edges == was->open_edges);
        CHECK(is->degenerate_faces == was->degenerate_faces);
        CHECK(is->duplicate_faces == was->duplicate_faces);
        CHECK(is->shells == was->shells);
        CHECK(is->crossing_pairs == was->crossing_pairs);
        CHECK(is->area_mm2 == was->area_mm2);
        CHECK(is->volume_mm3 == was->volume_mm3);
    }
    CHECK(back->warnings == body.warnings);
    CHECK(back->notes == body.notes);
    CHECK(back->model.format == "OBJ");
    CHECK(back->model.mm_per_file_unit == 25.4);
    CHECK(back->placement.mm_per_file_unit == 0.1);
    CHECK(back->placement.unit_assumed);
    CHECK(back->placement.summary == "so large");
    CHECK(back->placement.extent_mm == body.placement.extent_mm);
    CHECK(back->placement.corner_mm == body.placement.corner_mm);
    CHECK(back->grid.origin_mm == body.grid.origin_mm);
    CHECK(back->grid.pitch_mm == body.grid.pitch_mm);
    CHECK(back->grid.size == body.grid.size);
}

TEST_CASE("Meshes, marks, files and repairs of a prepared body come back, each list by itself", "[shards]") {
    const io::TemporaryFolder folder;
    fs::create_directories(io::shards_folder(folder.path()));
    JobBody body = body_with_texture();
    io::TexturedMesh& mesh = body.model.mesh;
    mesh.materials[0].alpha = 0.75f;
    mesh.materials.push_back({"plain", Eigen::Vector3f(0, 1, 0), nullptr, 0.5f, mesh.materials[0].texture, true, 0.25});
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}};
    mesh.material_of_triangle = {1, 0};
    mesh.corner_uv = {{Eigen::Vector2f(0, 0.5f), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)}, {}};
    mesh.corner_rgb = {{Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, 0, 1)}, {}};
    mesh.corner_alpha = {{0.25f, 0.5f, 1}, {1, 1, 0}};
    io::Decal& decal = mesh.decals.emplace_back();
    decal.picture = std::make_shared<const io::AlphaPicture>(
        2, 1, std::vector<io::AlphaPicture::Pixel>{io::AlphaPicture::Pixel(), io::AlphaPicture::Pixel()});
    decal.width_mm = 5, decal.height_mm = 4, decal.slack_mm = 0.25, decal.by_uv = true;
    decal.first_hit.columns = 2, decal.first_hit.rows = 3, decal.first_hit.depth_mm = {0.5f, 1.5f, 2, 3, 4, 5};
    decal.corner_mm = {1, 2, 3}, decal.right = {0, 1, 0}, decal.up = {0, 0, 1}, decal.out = {1, 0, 0};
    body.resin_of_decal = {"K"};
    body.relief = Relief({{4, 3, 1, 2, true}}, {{5, 6, 7, 8, -1, 0.5f}});
    SolidMesh solid;
    solid.positions_mm = mesh.positions, solid.triangles = {{0, 1, 2}}, solid.source_triangle = {-1};
    body.solid = SolidIndex(solid);
    VisibleSurface surface;
    surface.positions_mm = mesh.positions, surface.triangles = {{1, 2, 3}}, surface.source_triangle = {1};
    surface.source_uv = {{Eigen::Vector2f(0.25f, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)}};
    body.surface = SurfaceIndex(surface);
    body.side_files = {{"two.mtl", std::string(64, '1')}, {"gone.png", ""}};
    body.is_picture = body.placement.is_picture = true;
    body.model.has_colour = body.model.wants_colour = true;
    body.model.warnings = {"a warning"}, body.model.lost_colour = "lost";
    RepairReport& r = body.repair;
    r.welded_vertices = 1, r.dropped_faces = 2, r.turned_faces = 3, r.turned_shells = 4, r.cavities = 5;
    r.filled_holes = 6, r.filled_area_mm2 = 7, r.wrapped_faces = 8, r.wrap_alpha_mm = 9, r.wrap_offset_mm = 10;
    Cavity& one = r.voids.emplace_back();
    one.volume_mm3 = 11, one.wall_mm = 12, one.centre_mm = {13, 14, 15}, one.filled = true, one.crossed = true;
    r.messages = {"mended"};
    body.wrapped_triangles = {1};
    keep_prepared(folder.path(), this_job, body);
    const auto back = read_prepared(folder.path(), this_job);
    REQUIRE(back);
    const io::TexturedMesh& is = back->model.mesh;
    CHECK((is.positions == mesh.positions && is.triangles == mesh.triangles));
    CHECK(is.material_of_triangle == mesh.material_of_triangle);
    CHECK((is.corner_uv == mesh.corner_uv && is.corner_rgb == mesh.corner_rgb && is.corner_alpha == mesh.corner_alpha));
    REQUIRE(is.materials.size() == 2);
    CHECK((is.materials[1].alpha_of_lengths && is.materials[1].times_as_large == 0.25));
    CHECK((is.materials[0].texture && !is.materials[0].alpha_texture && is.materials[0].alpha == 0.75f));
    CHECK((!is.materials[1].texture && is.materials[1].alpha_texture && is.materials[1].name == "plain"));
    // A picture that two materials share is there once.
    CHECK(is.materials[0].texture->pyramid() == is.materials[1].alpha_texture->pyramid());
    REQUIRE(is.decals.size() == 1);
    const io::Decal& mark = is.decals[0];
    CHECK((mark.picture->width_px() == 2 && mark.picture->height_px() == 1 && mark.picture->pixels().size() == 2));
    CHECK((mark.width_mm == 5 && mark.height_mm == 4 && mark.slack_mm == 0.25 && mark.by_uv));
    CHECK((mark.first_hit.columns == 2 && mark.first_hit.rows == 3));
    CHECK(mark.first_hit.depth_mm == decal.first_hit.depth_mm);
    CHECK((mark.corner_mm == decal.corner_mm && mark.right == decal.right));
    CHECK((mark.up == decal.up && mark.out == decal.out));
    CHECK(back->resin_of_decal == body.resin_of_decal);
    REQUIRE((back->relief.runs().size() == 1 && back->relief.depths().size() == 1));
    CHECK((back->relief.runs()[0].k == 4 && back->relief.runs()[0].adds && back->relief.depths()[0].offset_mm == 0.5f));
    CHECK((back->solid->triangles == solid.triangles && back->solid->source_triangle == solid.source_triangle));
    CHECK(back->solid->positions_mm == solid.positions_mm);
    CHECK((back->surface->triangles == surface.triangles && back->surface->source_uv == surface.source_uv));
    CHECK(back->surface->source_triangle == surface.source_triangle);
    CHECK(back->surface->positions_mm == surface.positions_mm);
    REQUIRE(back->side_files.size() == 2);
    CHECK((back->side_files[0].name == "two.mtl" && back->side_files[0].sha256 == std::string(64, '1')));
    CHECK((back->side_files[1].name == "gone.png" && back->side_files[1].sha256.empty()));
    CHECK((back->is_picture && back->placement.is_picture && back->model.has_colour && back->model.wants_colour));
    CHECK((back->model.warnings == body.model.warnings && back->model.lost_colour == "lost"));
    const RepairReport& mended = back->repair;
    CHECK((mended.welded_vertices == 1 && mended.dropped_faces == 2 && mended.turned_faces == 3));
    CHECK((mended.turned_shells == 4 && mended.cavities == 5 && mended.filled_holes == 6));
    CHECK((mended.filled_area_mm2 == 7 && mended.wrapped_faces == 8));
    CHECK((mended.wrap_alpha_mm == 9 && mended.wrap_offset_mm == 10 && mended.messages == r.messages));
    REQUIRE(mended.voids.size() == 1);
    CHECK((mended.voids[0].volume_mm3 == 11 && mended.voids[0].wall_mm == 12 && mended.voids[0].filled));
    CHECK((mended.voids[0].crossed && mended.voids[0].centre_mm == one.centre_mm));
    CHECK(back->wrapped_triangles == body.wrapped_triangles);
    // Where nothing can be written, and of nothing that is there, nothing is said.
    CHECK_NOTHROW(keep_prepared(folder.path() / "not-there", this_job, body));
    CHECK_FALSE(read_prepared(folder.path() / "not-there", this_job));
}

TEST_CASE("A prepared body whose parts do not fit together is made anew, though its sum is right", "[shards]") {
    const io::TemporaryFolder folder;
    fs::create_directories(io::shards_folder(folder.path()));
    keep_prepared(folder.path(), this_job, body_with_texture());
    const fs::path file = io::prepared_file(folder.path(), this_job);
    const Bytes whole = io::read_whole_file(file, 1 << 20);

    // Behind the material's name, its colour, its alpha with what it comes of, and that it has a texture: which one.
    const std::size_t name = place_of(whole, std::vector<char>{'g', 'l', 'a', 'z', 'e'});
    const std::size_t number =
        name + 5 + sizeof(Eigen::Vector3f) + sizeof(float) + sizeof(bool) + sizeof(double) + sizeof(bool);
    forge(file, whole, number, std::uint32_t{0});
    CHECK(read_prepared(folder.path(), this_job));
    forge(file, whole, number, std::uint32_t{1});
    CHECK_FALSE(read_prepared(folder.path(), this_job));

    // Levels of 2 x 2 texels and of one: the second lies behind the texels, or is wider than what is there.
    using Level = io::MipPyramid::Level;
    const std::size_t second = place_of(whole, std::vector<std::uint32_t>{2, 2, 0, 0, 1, 1}) + sizeof(Level);
    forge(file, whole, second + offsetof(Level, first), std::size_t{5});
    CHECK_FALSE(read_prepared(folder.path(), this_job));
    forge(file, whole, second + offsetof(Level, width), std::uint32_t{3});
    CHECK_FALSE(read_prepared(folder.path(), this_job));
    forge(file, whole, second + offsetof(Level, width), std::uint32_t{0});
    CHECK_FALSE(read_prepared(folder.path(), this_job));
}
