// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/model_contents.h"

#include <array>
#include <fstream>

#include <catch2/catch.hpp>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "slicer/part/contents_text.h"
#include "tests/io/files/schema.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

/// Files to look into.
struct Shelf {
    Shelf() {
        picture("bark.png", 12, 8, 0);
        write("two.mtl",
              "newmtl bark\nmap_Kd bark.png\nnewmtl leaf\nKd 0.25 0.5 1\nnewmtl unused\nKd 1 0 0\nnewmtl twig\n"
              "Kd 0.25 0.5 0.5\n");
        // Two tetrahedra that share no corner, and a triangle more.
        write("two.obj",
              "mtllib two.mtl\nvt 0 0\nvt 1 0\nvt 0 1\n"
              "v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 10\nv 50 0 0\nv 60 0 0\nv 50 5 0\nv 50 0 5\n"
              "usemtl bark\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 2/1 3/2 4/3\nf 3/1 1/2 4/3\n"
              "usemtl leaf\nf 5 7 6\nf 5 6 8\nf 6 7 8\nusemtl twig\nf 7/1 5/2 8/3\n");
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    void picture(const std::string& name, std::uint32_t width, std::uint32_t height, double px_per_mm) const {
        io::LinearPicture pixels{width, height, {}};
        pixels.pixels.assign(std::size_t{width} * height, Eigen::Vector4f(0.2f, 0.4f, 0.6f, 1));
        io::write_whole_file(path(name),
                             io::png_bytes(io::encode_over(pixels, Eigen::Vector3f::Zero()), {px_per_mm, px_per_mm}));
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (folder.path() / name).string(); }
    [[nodiscard]] ModelContents read(const std::string& name, const std::string& unit = "auto") const {
        SliceOptions options;
        options.model = path(name);
        options.out = "unused";
        options.unit = unit;
        return read_contents(options);
    }
    ModelContents read_contents(const SliceOptions& options, const MeshViewer& view = {}) const {
        Progress progress;
        return slicer::read_contents(options, progress, view);
    }
    io::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("What is in a model: its pieces, corners, materials, pictures, unit and size") {
    const Shelf shelf;
    const ModelContents two = shelf.read("two.obj");
    CHECK(two.error.empty());
    CHECK(two.format == "OBJ");
    CHECK(two.unit_is == "assumed");
    CHECK(two.parts == 2);
    CHECK(two.triangles == 8);
    REQUIRE(two.size_mm);
    CHECK((*two.size_mm)[0] == Approx(60));
    CHECK((*two.size_mm)[1] == Approx(20));
    CHECK((*two.size_mm)[2] == Approx(10));
    CHECK(two.refused.empty());
    CHECK(two.textures == std::vector<std::array<std::uint32_t, 2>>{{12, 8}});
    REQUIRE(two.materials.size() == 3);  // one that no triangle has is none
    for (const ContentsMaterial& material : two.materials) {
        CAPTURE(material.name);
        CHECK(material.triangles == (material.name == "bark" ? 4 : material.name == "leaf" ? 3 : 1));
        CHECK(material.texture == (material.name == "bark" ? std::optional<std::size_t>(0) : std::nullopt));
    }
    CHECK(two.material_colours);
    CHECK_FALSE(two.vertex_colours);
    const std::string text = contents_text(std::array{two});
    CHECK_THAT(text, Contains("OBJ, 60 x 20 x 10 mm (unit: mm assumed") && Contains("2 parts, 8 triangles") &&
                         Contains("colour: texture 12 x 8 px; colours of materials") && Contains("bark texture 1") &&
                         Contains("leaf #") && !Contains("unused") && !Contains("not there") && !Contains("refused"));
    CHECK(io::schema_faults("contents", contents_json(std::array{two})) == std::vector<std::string>{});

    SliceOptions viewed;
    viewed.model = shelf.path("two.obj"), viewed.out = "unused";
    std::size_t seen = 0;
    (void)shelf.read_contents(viewed, [&](const io::TexturedMesh& mesh, bool is_picture) {
        seen += mesh.triangles.size();
        CHECK_FALSE(is_picture);
    });
    CHECK(seen == 8);

    const ModelContents inches = shelf.read("two.obj", "inch");
    CHECK(inches.unit_is == "asked");
    CHECK(inches.mm_per_unit == Approx(25.4));
    CHECK_FALSE(inches.refused.empty());  // 1.5 m
    CHECK_THAT(contents_text(std::array{inches}), Contains("25.4 mm as asked") && Contains("would be refused: "));
    CHECK(io::schema_faults("contents", contents_json(std::array{inches, two})) == std::vector<std::string>{});
}

TEST_CASE("Colours of corners, one piece alone, and a picture that is not there") {
    const Shelf shelf;
    shelf.write("one.obj",
                "v 0 0 0 1 0 0\nv 30 0 0 1 0 0\nv 0 20 0 0 1 0\nv 0 0 10 0 0 1\n"
                "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const ModelContents one = shelf.read("one.obj");
    CHECK(one.vertex_colours);
    CHECK_FALSE(one.material_colours);
    CHECK(one.parts == 1);
    CHECK_THAT(contents_text(std::array{one}), Contains("1 part, 4 triangles") && Contains("colours of vertices"));
    shelf.write("plain.obj", "v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    CHECK_FALSE(shelf.read("plain.obj").vertex_colours);
    CHECK_THAT(contents_text(std::array{shelf.read("plain.obj")}), Contains("colour: none"));
    std::filesystem::remove(shelf.path("bark.png"));
    const ModelContents bare = shelf.read("two.obj");
    CHECK_THAT(contents_text(std::array{bare}), Contains("not there: ") && Contains("bark.png"));
    CHECK_THAT(contents_json(std::array{bare}), Contains("\"found\": false"));
}

TEST_CASE("A picture has its size where it says so, or where it is asked for, else it is looked at 100 mm wide") {
    const Shelf shelf;
    shelf.picture("plain.png", 20, 10, 0);
    shelf.picture("sized.png", 20, 10, 2);
    SliceOptions options;
    options.out = "unused";
    double wide_mm = 0;
    int looks = 0;
    const MeshViewer view = [&](const io::TexturedMesh& mesh, bool is_picture) {
        CHECK(is_picture);
        ++looks;
        double low = 1e9, high = -1e9;
        for (const Eigen::Vector3d& p : mesh.positions) low = std::min(low, p.x()), high = std::max(high, p.x());
        wide_mm = high - low;
    };
    options.model = shelf.path("plain.png");
    const ModelContents plain = shelf.read_contents(options, view);
    CHECK(plain.format == "picture");
    CHECK(plain.picture_px == std::array<std::uint32_t, 2>{20, 10});
    CHECK(plain.dpi == 0);
    CHECK_FALSE(plain.size_mm);
    CHECK(plain.unit_is.empty());
    CHECK(wide_mm == Approx(100));
    CHECK_THAT(contents_text(std::array{plain}), Contains("picture, 20 x 10 px\n") && Contains("give --width"));
    options.model = shelf.path("sized.png");
    const ModelContents sized = shelf.read_contents(options, view);
    CHECK(sized.dpi == Approx(50.8).epsilon(1e-3));
    REQUIRE(sized.size_mm);
    CHECK((*sized.size_mm)[0] == Approx(10));
    CHECK((*sized.size_mm)[1] == Approx(5));
    CHECK((*sized.size_mm)[2] == Approx(4));
    CHECK(sized.unit_is == "file");
    CHECK(wide_mm == Approx(10));
    CHECK_THAT(contents_text(std::array{sized}), Contains("20 x 10 px of 51 dpi, 10 x 5 x 4 mm\n"));
    options.model = shelf.path("plain.png"), options.width_mm = 30;
    const ModelContents asked = shelf.read_contents(options, view);
    CHECK(asked.unit_is == "asked");
    REQUIRE(asked.size_mm);
    CHECK((*asked.size_mm)[1] == Approx(15));
    CHECK(wide_mm == Approx(30));
    CHECK(looks == 3);
    options.width_mm = 3000;
    CHECK_FALSE(shelf.read_contents(options).refused.empty());
    CHECK(io::schema_faults("contents", contents_json(std::array{plain, sized, asked})) == std::vector<std::string>{});
    CHECK_THAT(contents_json(std::array{sized}), Contains("\"dpi\": 50.8"));
    CHECK_THAT(contents_json(std::array{plain}), !Contains("\"dpi\""));
}

TEST_CASE("What cannot be read is told with its kind, and the other files all the same") {
    const Shelf shelf;
    shelf.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    shelf.write("plan.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"model": "a.obj"}]})");
    const ModelContents broken = shelf.read("broken.obj"), gone = shelf.read("gone.obj"),
                        plan = shelf.read("plan.json"), folder = shelf.read(".");
    CHECK(broken.exit_code == ExitCode::invalid_input);
    CHECK(gone.exit_code == ExitCode::file);
    CHECK_THAT(plan.error, Contains("a plan, and no model"));
    CHECK_THAT(folder.error, Contains("a folder, not a model"));
    const std::vector<ModelContents> all{broken, gone, plan, folder, shelf.read("two.obj")};
    CHECK_THAT(contents_text(all), Contains("gone.obj\n  cannot be read: ") && Contains("2 parts"));
    CHECK(io::schema_faults("contents", contents_json(all)) == std::vector<std::string>{});
    SliceOptions wrong;
    wrong.model = shelf.path("two.obj"), wrong.out = "unused", wrong.unit = "cubit";
    CHECK_THROWS_AS(shelf.read_contents(wrong), UsageError);
}
