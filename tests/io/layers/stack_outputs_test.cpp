// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a stack can be written as besides the PNG folder: GCVF, bitmaps per resin, a sparse volume; and resin sets.
#include <png.h>
#include <tiffio.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/files/zip_reader.h"
#include "io/layers/gcvf_writer.h"
#include "io/layers/resin_bitmap.h"
#include "io/layers/stack_folder.h"
#include "io/layers/stack_reader.h"
#include "io/layers/volume_vdb.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "stack_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

float float_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
    float value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

/// One voxel of magenta in a box of 70 x 40 x 5: nothing about it is symmetric.
constexpr std::uint32_t mark_i = 9, mark_j = 31, mark_k = 3;

fs::path write_marker(const fs::path& out, Orientation orientation) {
    auto stack = sample_description(5);
    stack.orientation = orientation;
    stack.origin_mm = {10, 20, 30};
    LayerStackWriter writer(out, stack, {ResinBitmaps::none, true, true});
    for (std::uint32_t k = 0; k < 5; ++k) {
        std::vector<Material> pixels(70 * 40, 0);
        if (k == mark_k) pixels[(39 - mark_j) * 70 + mark_i] = 2;  // the top row is the largest y
        writer.write(k, layer_from_pixels(pixels, 70, 40));
    }
    (void)writer.finish();
    return out;
}

}  // namespace

TEST_CASE("one marker proves every axis and mirror, in PNG, GCVF and VDB", "[marker]") {
    TemporaryFolder folder;
    openvdb::initialize();
    for (int bits = 0; bits < 8; ++bits) {
        const Orientation o{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
        const auto out = write_marker(folder.path() / std::to_string(bits), o);
        // Column and row as they must lie: swap, then mirrors.
        std::uint32_t column = mark_i, row = 39 - mark_j, width = 70, height = 40;
        if (o.swap_xy) std::swap(column, row), std::swap(width, height);
        if (o.flip_x) column = width - 1 - column;
        if (o.flip_y) row = height - 1 - row;
        for (const auto& place : {out, out / "stack.gcvf"}) {
            const StackReader reader(place);
            const auto palette = reader.palette();
            for (std::uint32_t k = 0; k < 5; ++k) {
                const auto layer = reader.read(k, palette);
                CHECK(layer.width_px() == width);
                const auto pixels = layer_pixels(layer);
                for (std::uint32_t p = 0; p < pixels.size(); ++p)
                    if ((pixels[p] != 0) != (k == mark_k && p == row * width + column))
                        FAIL("orientation " << bits << " layer " << k << " pixel " << p);
            }
        }
        // The volume is in the model's frame, whatever was done to the bitmaps.
        openvdb::io::File file((out / "volume-int32.vdb").string());
        file.open();
        const auto grid = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("resin"));
        CHECK(grid->activeVoxelCount() == 1);
        CHECK(grid->tree().getValue(openvdb::Coord(mark_i, mark_j, mark_k)) == 2);
        const auto centre = grid->transform().indexToWorld(openvdb::Coord(mark_i, mark_j, mark_k));
        CHECK(centre.x() == Approx(10 + (mark_i + 0.5) * 25.4 / 600));
        CHECK(centre.y() == Approx(20 + (mark_j + 0.5) * 25.4 / 300));
        CHECK(centre.z() == Approx(30 + (mark_k + 0.5) * 0.027));
    }
}

TEST_CASE("the preview of a GCVF lies where the bitmaps show the body", "[gcvf]") {
    // One triangle whose corners are voxel corners: its box in pixels must be those indices, rows from the top.
    auto stack = sample_description(5);
    stack.size_mm = stack_size_mm(stack);
    stack.origin_mm = {10, 20, 30};
    const double px = 25.4 / 600, py = 25.4 / 300, pz = 0.027;
    auto corner = [&](double i, double j, double k) {
        return std::array<float, 3>{static_cast<float>(10 + i * px), static_cast<float>(20 + j * py),
                                    static_cast<float>(30 + k * pz)};
    };
    const std::vector<std::array<float, 3>> vertices = {corner(5, 30, 1), corner(25, 30, 1), corner(5, 38, 4)};
    const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 1, 2}};
    auto box = [&](Orientation o) {
        auto turned = stack;
        turned.orientation = o;
        if (o.swap_xy)
            std::swap(turned.size_mm[0], turned.size_mm[1]), std::swap(turned.pitch_um[0], turned.pitch_um[1]),
                std::swap(turned.size_px[0], turned.size_px[1]);
        const auto preview = gcvf_preview(turned, {vertices, triangles});
        REQUIRE(preview.box.size() == 24);
        REQUIRE(preview.stl.size() == 84 + 50);
        // Columns and layers positive, rows downward: y negative.
        for (std::size_t c = 0; c < 3; ++c) CHECK(float_at(preview.stl, 84 + 12 + 12 * c + 4) <= 0);
        std::array<double, 6> result{};
        for (std::size_t i = 0; i < 6; ++i) result[i] = std::round(100 * float_at(preview.box, 4 * i)) / 100;
        return result;
    };
    CHECK(box({}) == std::array<double, 6>{5, 2, 1, 25, 10, 4});
    CHECK(box({true, false, false}) == std::array<double, 6>{45, 2, 1, 65, 10, 4});
    CHECK(box({false, true, false}) == std::array<double, 6>{5, 30, 1, 25, 38, 4});
    CHECK(box({false, false, true}) == std::array<double, 6>{2, 5, 1, 10, 25, 4});
    // It faces upward, and no orientation of bitmaps turns that over or leans it more: the normal is computed anew from
    // corners in mended order. The triangle rises by 3 layers over 8 rows.
    const double upward = 8 * py / std::hypot(8 * py, 3 * pz);
    for (int bits = 0; bits < 8; ++bits) {
        CAPTURE(bits);
        auto turned = stack;
        turned.orientation = {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
        const auto preview = gcvf_preview(turned, {vertices, triangles});
        CHECK(float_at(preview.stl, 84 + 8) == Approx(upward));
    }
}

TEST_CASE("a GCVF has its parts and is the same every time", "[gcvf]") {
    TemporaryFolder folder;
    const auto stack = write_sample_stack(folder.path() / "a", 31, {ResinBitmaps::none, true, false});
    (void)write_sample_stack(folder.path() / "b", 31, {ResinBitmaps::none, true, false});
    CHECK(text_of(folder.path() / "a" / "stack.gcvf") == text_of(folder.path() / "b" / "stack.gcvf"));
    const ZipReader zip(folder.path() / "a" / "stack.gcvf");
    CHECK(zip.names().size() == 31 + 4);
    for (const auto* name : {"ConfigFile.xml", "layer_0.png", "layer_30.png", "Mesh.stl", "MeshBbx.ktn", "Zbuffer.png"})
        CHECK(std::find(zip.names().begin(), zip.names().end(), name) != zip.names().end());
    const StackReader reader(folder.path() / "a" / "stack.gcvf");
    const auto& config = *reader.gcvf();
    CHECK(config == gcvf_config(stack));
    CHECK(config.x_dpi == 600);
    CHECK(config.y_dpi == 300);
    CHECK(config.slice_thickness_nm == 27000);
    std::vector<std::string> called;
    for (const GcvfMaterial& material : config.materials) called.push_back(material.name);
    CHECK(called == std::vector<std::string>{"VeroCyan", "VeroMgnt", "VeroYellow", "VeroBlack", "VeroPureWht"});
    CHECK(config.materials[4].voxels == stack.resins[4].voxels);
    CHECK(gcvf_material_name({"VeroCY-V", "C"}) == "VeroCY-V");
    CHECK(gcvf_material_name({"VeroMagentaV", "M"}) == "VeroMGT-V");
    CHECK(role_of_gcvf_material("VeroMgnt") == "M");
}

TEST_CASE("bitmaps per resin hold that resin's pixels", "[resin-bitmaps]") {
    const auto layer = sample_layer(3, 77, 23);
    const auto pixels = layer_pixels(layer);
    const std::array<double, 2> pitch = {25400.0 / 600, 25400.0 / 300};
    for (Material m = 0; m < 6; ++m) {
        const auto file = encode_png1(layer, m, pitch);
        CHECK(file == encode_png1(layer, m, pitch));
        const auto header = read_png_header(file, "png1");
        CHECK(header.bit_depth == 1);
        CHECK(header.colour_type == PNG_COLOR_TYPE_GRAY);
        CHECK(header.x_per_metre == 23622);
        std::size_t wrong = 0;
        (void)read_png(file, "png1", [&](std::uint32_t y, std::span<const std::uint8_t> rgba) {
            for (std::uint32_t x = 0; x < 77; ++x) wrong += (rgba[4 * x] == 255) != (pixels[y * 77 + x] == m);
        });
        CHECK(wrong == 0);

        TemporaryFolder folder;
        const auto path = folder.path() / "r.tif";
        const auto tiff_bytes = encode_tiff1(layer, m, pitch);
        CHECK(tiff_bytes == encode_tiff1(layer, m, pitch));
        write_whole_file(path, tiff_bytes);
        TIFF* tiff = TIFFOpen(path.c_str(), "r");
        REQUIRE(tiff);
        std::uint16_t depth = 0, photometric = 0;
        float x_dpi = 0;
        TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &depth);
        TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
        TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x_dpi);
        CHECK(depth == 1);
        CHECK(photometric == PHOTOMETRIC_MINISWHITE);
        CHECK(x_dpi == Approx(600));
        std::vector<std::uint8_t> row(static_cast<std::size_t>(TIFFScanlineSize(tiff)));
        for (std::uint32_t y = 0; y < 23; ++y) {
            REQUIRE(TIFFReadScanline(tiff, row.data(), y) == 1);
            for (std::uint32_t x = 0; x < 77; ++x)
                wrong += ((row[x / 8] >> (7 - x % 8)) & 1) != (pixels[y * 77 + x] == m);
        }
        TIFFClose(tiff);
        CHECK(wrong == 0);
    }
    const auto palette = sample_description(1).palette();
    const auto indexed = encode_png8(layer, palette, pitch);
    const auto scan = scan_layer(indexed, "png8", palette);
    CHECK(scan.header.colour_type == PNG_COLOR_TYPE_PALETTE);
    CHECK(layer_pixels(*scan.runs) == pixels);
}

TEST_CASE("TIFF and PNG of one bit are each other's negative: the manifest says which, and both are refused",
          "[resin-bitmaps]") {
    TemporaryFolder folder;
    const auto said = [&](ResinBitmaps bitmaps) {
        const auto out = folder.path() / std::to_string(int(bitmaps));
        const StackDescription stack = write_sample_stack(out, 2, {bitmaps, false, false});
        CHECK(read_manifest(out / manifest_name) == stack);
        CHECK(StackReader(out).description() == stack);
        return stack.resin_pixels;
    };
    CHECK(said(ResinBitmaps::png1) == ResinPixels::white);
    CHECK(said(ResinBitmaps::tiff1) == ResinPixels::black);
    CHECK(said(ResinBitmaps::png8) == ResinPixels::unsaid);
    CHECK(said(ResinBitmaps::none) == ResinPixels::unsaid);
    CHECK_THROWS_WITH(outputs_for(std::array{LayerFormat::tiff, LayerFormat::png1}), Contains("negative"));
    CHECK_THROWS_AS(outputs_for(std::array{LayerFormat::png1, LayerFormat::png, LayerFormat::tiff}), InputError);
    CHECK(outputs_for(std::array{LayerFormat::png, LayerFormat::tiff}).resin_bitmaps == ResinBitmaps::tiff1);
}

TEST_CASE("bitmaps per resin lie in folders of their own", "[resin-bitmaps]") {
    TemporaryFolder folder;
    (void)write_sample_stack(folder.path() / "s", 3, {ResinBitmaps::tiff1, false, false});
    CHECK(fs::exists(folder.path() / "s" / "resins" / "01-C" / "slice_00000.tif"));
    CHECK(fs::exists(folder.path() / "s" / "resins" / "05-W" / "slice_00002.tif"));
    // The next stack in the same place leaves none of them behind.
    (void)write_sample_stack(folder.path() / "s", 2, {ResinBitmaps::png8, false, false});
    CHECK_FALSE(fs::exists(folder.path() / "s" / "resins" / "01-C"));
    CHECK(fs::exists(folder.path() / "s" / "resins" / "indexed" / "slice_00001.png"));
}

TEST_CASE("a volume counts what the stack counts, and a uniform core is tiles", "[vdb]") {
    TemporaryFolder folder;
    auto stack = sample_description(64, 128, 96);
    LayerStackWriter writer(folder.path() / "s", stack, {ResinBitmaps::none, false, true});
    for (std::uint32_t k = 0; k < 64; ++k) {
        auto pixels = layer_pixels(sample_layer(k, 128, 96));
        for (std::uint32_t y = 8; y < 88; ++y)
            for (std::uint32_t x = 8; x < 120; ++x)
                if (k >= 8 && k < 56) pixels[y * 128 + x] = 5;
        writer.write(k, layer_from_pixels(pixels, 128, 96));
    }
    const auto done = writer.finish();
    openvdb::io::File file((folder.path() / "s" / "volume-int32.vdb").string());
    file.open();
    const auto grid = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("resin"));
    std::uint64_t all = 0;
    for (const auto& resin : done.resins) all += resin.voxels;
    CHECK(grid->activeVoxelCount() == all);
    // 16 x 12 x 8 blocks of 8^3; the core's 14 x 10 x 6 are tiles.
    CHECK(grid->tree().leafCount() == 16 * 12 * 8 - 14 * 10 * 6);
    std::array<std::uint64_t, 6> counts{};
    for (auto value = grid->cbeginValueOn(); value; ++value)
        counts[static_cast<std::size_t>(*value)] += value.getVoxelCount();
    for (std::size_t r = 0; r < 5; ++r) CHECK(counts[r + 1] == done.resins[r].voxels);

    // What other programs read: floating point alone, the body and each resin.
    openvdb::io::File floats((folder.path() / "s" / "volume.vdb").string());
    floats.open();
    CHECK(floats.readAllGridMetadata()->size() == 6);
    const std::vector<std::string> names{"density", "C", "M", "Y", "K", "W"};
    for (std::size_t g = 0; g < names.size(); ++g) {
        INFO(names[g]);
        const auto one = openvdb::gridPtrCast<openvdb::FloatGrid>(floats.readGrid(names[g]));
        REQUIRE(one);
        CHECK(one->transform() == grid->transform());
        CHECK(one->activeVoxelCount() == (g == 0 ? all : done.resins[g - 1].voxels));
        std::size_t wrong = 0;
        for (auto value = grid->cbeginValueOn(); value; ++value)
            wrong += one->tree().getValue(value.getCoord()) !=
                     (g == 0 || *value == static_cast<std::int32_t>(g) ? 1.0f : 0.0f);
        CHECK(wrong == 0);
        CHECK(one->tree().getValue(openvdb::Coord(-1, 0, 0)) == 0);
        if (g > 0) CHECK(one->metaValue<std::string>("resin") == done.resins[g - 1].name);
    }
}

TEST_CASE("resin sets", "[resin-file]") {
    const auto names = known_resin_sets();
    CHECK(names == std::vector<std::string>{"j750-opaque", "j750-vivid", "j750-vivid-clear", "vero-opaque",
                                            "vero-opaque-clear"});
    for (const std::string& name : names)
        CHECK(resin_family(name) == (name.starts_with("j750-vivid") ? "Vero Vivid" : "Vero opaque"));
    // The set in the code and the one in data/ are one.
    const auto ours = optics::vero_opaque(), file = find_resin_set("vero-opaque");
    CHECK(file.name == ours.name);
    CHECK(file.source == ours.source);
    CHECK(file.g == ours.g);
    CHECK(file.eta == ours.eta);
    REQUIRE(file.resins.size() == ours.resins.size());
    for (std::size_t r = 0; r < ours.resins.size(); ++r) {
        CHECK(file.resins[r].name == ours.resins[r].name);
        CHECK(file.resins[r].role == ours.resins[r].role);
        CHECK(file.resins[r].sigma_t_per_mm == ours.resins[r].sigma_t_per_mm);
        CHECK(file.resins[r].albedo == ours.resins[r].albedo);
    }
    // What the clear twin of the default has is the default's, but for T.
    const auto vivid = find_resin_set("j750-vivid"), with_clear = find_resin_set("j750-vivid-clear");
    REQUIRE(with_clear.find("T") == 5);
    for (std::size_t r = 0; r < vivid.resins.size(); ++r) {
        CHECK(with_clear.resins[r].sigma_t_per_mm == vivid.resins[r].sigma_t_per_mm);
        CHECK(with_clear.resins[r].albedo == vivid.resins[r].albedo);
    }
    const auto clear = find_resin_set("vero-opaque-clear");
    REQUIRE(clear.find("T") == 5);
    CHECK(clear.resins[5].medium(1).sigma_t() == 0);
    // Round trip, spectral too.
    auto spectral = ours;
    spectral.channels.wavelengths_nm = {450, 550.5, 650};
    for (const auto& set : {ours, spectral, clear}) {
        const auto back = parse_resin_set(resin_set_text(set), "text");
        CHECK(resin_set_text(back) == resin_set_text(set));
        CHECK(back.channels == set.channels);
        CHECK(back.resins[0].albedo == set.resins[0].albedo);
    }
    const auto text = resin_set_text(ours);
    for (std::size_t n = 0; n + 2 < text.size(); ++n)
        CHECK_THROWS_AS(parse_resin_set(text.substr(0, n), "cut"), InputError);
    auto fault = [&](const std::string& from, const std::string& to) {
        auto changed = text;
        changed.replace(changed.find(from), from.size(), to);
        try {
            (void)parse_resin_set(changed, "FILE");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    using Catch::Contains;
    CHECK_THAT(fault("\"albedo\"", "\"albdo\""), Contains("albdo") && Contains("'albedo'"));
    CHECK_THAT(fault("0.98]", "1.98]"), Contains("albedo") && Contains("1.98"));
    CHECK_THAT(fault("\"rgb\"", "\"cmyk\""), Contains("kind"));
    CHECK_THAT(fault("\"role\": \"M\"", "\"role\": \"C\""), Contains("FILE") && Contains("twice"));
    CHECK_THAT(fault("\"g\": 0.4", "\"g\": 1"), Contains("g"));
    TemporaryFolder folder;
    const auto family_of = [&](const std::string& key) {
        std::string own = text;
        own.insert(own.find("\"channels\""), key);
        const std::string own_file = (folder.path() / "own.json").string();
        std::ofstream(own_file) << own;
        CHECK(find_resin_set(own_file).resins.size() == ours.resins.size());
        return resin_family(own_file);
    };
    CHECK(family_of("").empty());
    CHECK(family_of("\"family\": \"Mine\", ") == "Mine");
    CHECK_THROWS_WITH(family_of("\"family\": \"\", "), Contains("family") && Contains("is empty"));
    CHECK_THROWS_WITH(find_resin_set("vero-opaqe"), Contains("did you mean \"vero-opaque\"?"));
}
