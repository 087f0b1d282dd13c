// SPDX-License-Identifier: GPL-3.0-or-later
//
// A printer that mirrors: its profile's flips reach every bitmap of every verb that prints, and nothing that is
// predicted of them.
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>

#include <fmt/core.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include "io/layers/layer_digest.h"
#include "io/layers/stack_reader.h"
#include "run_program.h"

using namespace voxtone;
using namespace voxtone::test;
namespace fs = std::filesystem;

namespace {

struct Flips {
    bool x = false, y = false, swap = false;
};

// The ratios of a built-in screen: others take seconds to make in every job.
constexpr double column_um = 100, row_um = 200, layer_um = 63.78;

std::string profile(const Flips& flips, double column = column_um, double row = row_um, double layer = layer_um) {
    return fmt::format(
        R"({{"format": "voxtone-printer", "version": 1, "name": "of the test", "pitch_um": [{}, {}, {}],
             "flip_x": {}, "flip_y": {}, "swap_xy": {}}})",
        column, row, layer, flips.x, flips.y, flips.swap);
}

/// Where a pixel of a flipped bitmap of this size comes from in the bitmap that was not flipped.
std::array<int, 2> before(const Flips& flips, int column, int row, int width, int height) {
    if (flips.x) column = width - 1 - column;
    if (flips.y) row = height - 1 - row;
    if (flips.swap) std::swap(column, row);
    return {column, row};
}

void compare(const Bitmap& flipped, const Bitmap& plain, const Flips& flips) {
    REQUIRE(flipped.width == (flips.swap ? plain.height : plain.width));
    REQUIRE(flipped.height == (flips.swap ? plain.width : plain.height));
    std::size_t wrong = 0;
    for (int y = 0; y < flipped.height; ++y)
        for (int x = 0; x < flipped.width; ++x) {
            const auto from = before(flips, x, y, flipped.width, flipped.height);
            wrong += flipped.at(x, y) != plain.at(from[0], from[1]);
        }
    CHECK(wrong == 0);
}

Bitmap read_tiff(const std::string& path) {
    TIFF* tiff = TIFFOpen(path.c_str(), "r");
    REQUIRE(tiff);
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    Bitmap bitmap{int(width), int(height), {}};
    std::vector<std::uint8_t> row(std::size_t(TIFFScanlineSize(tiff)));
    for (std::uint32_t y = 0; y < height; ++y) {
        REQUIRE(TIFFReadScanline(tiff, row.data(), y) == 1);
        for (std::uint32_t x = 0; x < width; ++x)
            bitmap.pixels.push_back({std::uint8_t((row[x / 8] >> (7 - x % 8)) & 1), 0, 0, 0});
    }
    TIFFClose(tiff);
    return bitmap;
}

std::vector<fs::path> files_below(const fs::path& folder, const std::string& extension) {
    std::vector<fs::path> files;
    if (!fs::exists(folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().extension() == extension) files.push_back(fs::relative(entry.path(), folder));
    std::sort(files.begin(), files.end());
    return files;
}

std::size_t resins_in(const fs::path& stack) {
    return nlohmann::json::parse(read_file(stack / "manifest.json"))["resins"].size();
}

void compare_folders(const fs::path& flipped, const fs::path& plain, const Flips& flips, bool is_slice) {
    const auto layers = files_below(flipped / "layers", ".png");
    REQUIRE(layers.size() >= 5);
    CHECK(layers == files_below(plain / "layers", ".png"));
    for (const fs::path& layer : layers)
        compare(read_png(flipped / "layers" / layer), read_png(plain / "layers" / layer), flips);
    const auto bitmaps = files_below(flipped / "resins", ".tif");
    CHECK(bitmaps.size() == (is_slice ? layers.size() * resins_in(flipped) : 0));
    for (const fs::path& layer : bitmaps)
        compare(read_tiff(flipped / "resins" / layer), read_tiff(plain / "resins" / layer), flips);
}

void compare_containers(const fs::path& flipped) {
    const io::StackReader container(flipped / "stack.gcvf"), folder(flipped);
    REQUIRE(container.layers() == folder.layers());
    const auto palette = folder.palette();
    for (std::uint32_t k = 0; k < folder.layers(); ++k)
        CHECK(io::layer_digest(container.read(k, palette)) == io::layer_digest(folder.read(k, palette)));
}

openvdb::Int32Grid::Ptr volume_of(const fs::path& out) {
    openvdb::initialize();
    openvdb::io::File file((out / "volume-int32.vdb").string());
    file.open();
    return openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("resin"));
}

/// The volume is in the model's frame, whatever is done to bitmaps.
void compare_volumes(const fs::path& flipped, const fs::path& plain) {
    const auto a = volume_of(flipped), b = volume_of(plain);
    CHECK(a->activeVoxelCount() == b->activeVoxelCount());
    CHECK(a->transform() == b->transform());
    std::size_t wrong = 0;
    for (auto voxel = b->cbeginValueOn(); voxel; ++voxel)
        wrong += a->tree().getValue(voxel.getCoord()) != voxel.getValue();
    CHECK(wrong == 0);
}

/// White with a dark quarter where x is small and y is large: the upper left.
std::string quartered_picture() {
    std::string ppm = "P6 24 16 255\n";
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 24; ++x) ppm.append(3, x < 12 && y < 8 ? char(30) : char(255));
    return ppm;
}

std::string must_run(const std::string& command) {
    const Outcome outcome = run_program(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome.err;
}

/// What `verify`, and `predict` where it is asked for, read of a flipped stack, in both formats, is the body and not
/// its mirror image.
void read_back(const fs::path& flipped, const fs::path& plain, bool is_predicted) {
    const std::string folder = flipped.string(), container = folder + "/stack.gcvf --printer " + folder + ".json";
    must_run("verify " + folder + " --printer " + folder + ".json");
    must_run("verify " + container);
    if (!is_predicted) return;
    const auto predicted = [&](const std::string& stack) {
        const std::string picture = folder + ".predicted.png";
        must_run("predict --quiet --overwrite --view top --cell 0.5mm " + stack + " -o " + picture);
        return read_file(picture);
    };
    const std::string wanted = predicted(plain.string());
    CHECK(predicted(folder) == wanted);
    CHECK(predicted(container) == wanted);
}

}  // namespace

TEST_CASE("Every verb that prints turns its bitmaps as the printer's profile says") {
    for (const Flips flips : {Flips{false, true, false}, Flips{true, false, true}}) {
        const Folder folder("flips");
        folder.write("flipping.json", profile(flips));
        // What the body looks like to a printer that does not flip and whose voxels lie as the other's do.
        folder.write("plain.json", flips.swap ? profile({}, row_um, column_um) : profile({}));
        folder.write("marker.obj", marker_obj());
        folder.write("picture.ppm", quartered_picture());
        for (const std::string& command :
             {"slice --formats png,gcvf,tiff,vdb --no-report --iterations 0 " + folder / "marker.obj",
              "slice --formats png,gcvf,tiff,vdb --no-report --iterations 0 --width 5mm --thickness 1mm " +
                  folder / "picture.ppm",
              std::string("calibrate target --resins K,W --layout A --square 4mm --gap 1mm --base 0.5mm --top 0.5mm "
                          "--marker 8mm --quiet-zone 2mm --gcvf"),
              std::string("laminate print \"W 0.5, K 0.3\" \"K 1\" --width 3mm --depth 2mm --gcvf")}) {
            INFO(command << " flips " << flips.x << flips.y << flips.swap);
            for (const char* printer : {"flipping", "plain"})
                must_run(fmt::format("{} --quiet --overwrite --printer {} -o {}", command,
                                     folder / (std::string(printer) + ".json"), folder / printer));
            const fs::path flipped = folder / "flipping", plain = folder / "plain";
            const bool is_slice = command.starts_with("slice");
            compare_folders(flipped, plain, flips, is_slice);
            compare_containers(flipped);
            if (is_slice) compare_volumes(flipped, plain);
            // One set of flips holds both kinds; a target is larger than a prediction of it is worth.
            read_back(flipped, plain, flips.swap && !command.starts_with("calibrate"));
            const auto manifest = nlohmann::json::parse(read_file(flipped / "manifest.json"));
            CHECK(manifest["pitch_um"] == nlohmann::json({column_um, row_um, layer_um}));
            CHECK(manifest["orientation"]["flip_x"] == flips.x);
            CHECK(manifest["orientation"]["flip_y"] == flips.y);
            CHECK(manifest["orientation"]["swap_xy"] == flips.swap);
            fs::remove_all(flipped);
            fs::remove_all(plain);
        }
    }
}

TEST_CASE("What is predicted of flipped bitmaps is not mirrored, and verify takes them") {
    const Folder folder("unflipped");
    folder.write("flipping.json", profile({true, false, true}, 42.333333, 84.666667, 27));
    folder.write("picture.ppm", quartered_picture());
    const std::string printer = " --printer " + folder / "flipping.json";
    must_run("slice --quiet --formats png,gcvf --iterations 0 --load K,W --width 6mm --thickness 3mm " +
             folder / "picture.ppm" + printer + " -o " + folder / "out");
    CHECK(run_program("verify " + folder / "out" + printer).exit_code == 0);
    must_run("predict --quiet " + folder / "out" + " -o " + folder / "own.png");
    must_run("predict --quiet --view top " + folder / "out/stack.gcvf" + printer + " -o " + folder / "gcvf.png");
    const auto manifest = nlohmann::json::parse(read_file(folder.path() / "out/manifest.json"));
    std::string assign;
    for (const auto& resin : manifest["resins"])
        assign += fmt::format("{}#{:02x}{:02x}{:02x}={}", assign.empty() ? "" : ",", int(resin["rgb"][0]),
                              int(resin["rgb"][1]), int(resin["rgb"][2]), std::string(resin["role"]));
    must_run("predict --quiet --view top " + folder / "out/layers" + printer + " --assign \"" + assign + "\" -o " +
             folder / "foreign.png");
    for (const char* picture : {"out/predicted.png", "own.png", "gcvf.png", "foreign.png"}) {
        INFO(picture);
        const Bitmap seen = read_png(folder / picture);
        CHECK(seen.width > seen.height);
        for (const int right : {0, 1})
            for (const int bottom : {0, 1}) {
                const auto pixel = seen.at(seen.width * (1 + 2 * right) / 4, seen.height * (1 + 2 * bottom) / 4);
                CHECK((pixel[1] < 128) == (right == 0 && bottom == 0));
            }
    }
}

TEST_CASE("Assigned colours that look swapped, and those that never occur, are warned about") {
    const Folder folder("swapped");
    must_run("laminate print \"C 1\" \"M 1.1\" \"W 0.9\" --width 2mm --depth 2mm --quiet -o " + folder / "out");
    const std::string predict = "predict " + folder / "out/layers" +
                                " --printer stratasys-j750-hm --cell 0.5mm --overwrite -o " + folder / "p.glb" +
                                " --assign ";
    const std::string right = run_program(predict + "\"#0096c8=C,#cd196e=M,#dcded8=W\"").err;
    CHECK(right.find("looks far more like") == std::string::npos);
    CHECK(right.find("no pixel") == std::string::npos);
    const std::string swapped = run_program(predict + "\"#0096c8=M,#cd196e=C,#dcded8=W\"").err;
    CHECK(swapped.find("\"#0096c8=M\": this colour looks far more like the resin 'C'") != std::string::npos);
    CHECK(swapped.find("\"#cd196e=C\": this colour looks far more like the resin 'M'") != std::string::npos);
    CHECK(swapped.find("#dcded8=W\": this") == std::string::npos);
    const std::string absent = run_program(predict + "\"#0096c8=C,#cd196e=M,#dcded8=W,#00ff00=Y\"").err;
    CHECK_THAT(absent, Catch::Contains("\"#00ff00=Y\": no pixel of") && Catch::Contains("[assigned-colours]"));
}
