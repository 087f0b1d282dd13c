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

TEST_CASE("A prepared body whose parts do not fit together is made anew, though its sum is right", "[shards]") {
    const io::TemporaryFolder folder;
    fs::create_directories(io::shards_folder(folder.path()));
    keep_prepared(folder.path(), this_job, body_with_texture());
    const fs::path file = io::prepared_file(folder.path(), this_job);
    const Bytes whole = io::read_whole_file(file, 1 << 20);

    // Behind the material's name, its colour, its alpha, and that it has a texture: which one.
    const std::size_t name = place_of(whole, std::vector<char>{'g', 'l', 'a', 'z', 'e'});
    const std::size_t number = name + 5 + sizeof(Eigen::Vector3f) + sizeof(float) + sizeof(bool);
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
