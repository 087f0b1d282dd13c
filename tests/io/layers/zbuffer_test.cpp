// SPDX-License-Identifier: GPL-3.0-or-later
//
// Zbuffer.png of a GCVF: against the layers as they are read back, and as libpng sees it; the other parts of a GCVF
// that are no layers; and what a GCVF cannot hold.
#include <png.h>
#include <zip.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/files/zip_reader.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/gcvf_writer.h"
#include "io/layers/stack_folder.h"
#include "io/layers/stack_reader.h"
#include "io/layers/topmost_layers.h"
#include "io/pictures/picture_writer.h"
#include "stack_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

using Indices = std::vector<std::uint16_t>;

std::vector<std::uint8_t> entry(const fs::path& container, const std::string& name) {
    const ZipReader zip(container);
    return zip.read(zip.find(name).value(), 1 << 26);
}

/// As libpng's own simple reader has it: 16-bit grey is linear there, and read as it is.
Indices indices_in(const std::vector<std::uint8_t>& png, std::uint32_t width, std::uint32_t height) {
    REQUIRE(png.size() > 26);
    CHECK(png[24] == 16);  // IHDR: bits
    CHECK(png[25] == 0);   // and grey
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&image, png.data(), png.size()));
    CHECK(image.width == width);
    CHECK(image.height == height);
    image.format = PNG_FORMAT_LINEAR_Y;
    Indices indices(std::size_t{width} * height);
    REQUIRE(png_image_finish_read(&image, nullptr, indices.data(), 0, nullptr));
    return indices;
}

/// From the layers as they lie on the disk.
Indices topmost_of(const fs::path& stack) {
    const StackReader reader(stack);
    const auto palette = reader.palette();
    Indices top;
    for (std::uint32_t k = 0; k < reader.layers(); ++k) {
        const std::vector<Material> pixels = layer_pixels(reader.read(k, palette));
        top.resize(pixels.size(), 0);
        for (std::size_t p = 0; p < pixels.size(); ++p)
            if (pixels[p] != 0) top[p] = static_cast<std::uint16_t>(k);
    }
    return top;
}

/// Layers of pixels that are seldom filled, so that columns end at all heights, and some nowhere.
LayerRuns sparse_layer(std::uint32_t k) {
    RandomStream random(5, k);
    std::vector<Material> pixels(70 * 40, 0);
    for (std::size_t p = 0; p < pixels.size(); ++p)
        if (p % 7 != 0 && random.uniform() < 0.1) pixels[p] = static_cast<Material>(1 + p % 5);
    if (k == 0) pixels[0] = 1;
    pixels[14] = 2;  // a full column
    return layer_from_pixels(pixels, 70, 40);
}

fs::path write_sparse(const fs::path& out, const Orientation& orientation = {}, bool downward = false) {
    StackDescription stack = sample_description(300);
    stack.orientation = orientation;
    LayerStackWriter writer(out, stack, {ResinBitmaps::none, true, false}, true);
    parallel_for(0, 300, 1, [&](std::size_t n) {
        const auto k = static_cast<std::uint32_t>(downward ? 299 - n : n);
        writer.write(k, sparse_layer(k));
    });
    (void)writer.finish();
    return out;
}

struct Discard {
    void operator()(zip_t* zip) const { zip_discard(zip); }
};

/// The container with another part of this name, or without where there are no bytes.
void replace_part(const fs::path& container, const char* name, const std::vector<std::uint8_t>& bytes) {
    std::unique_ptr<zip_t, Discard> zip(zip_open(container.c_str(), 0, nullptr));
    REQUIRE(zip);
    const zip_int64_t index = zip_name_locate(zip.get(), name, 0);
    REQUIRE(index >= 0);
    if (bytes.empty()) {
        REQUIRE(zip_delete(zip.get(), std::uint64_t(index)) == 0);
    } else {
        zip_source_t* source = zip_source_buffer(zip.get(), bytes.data(), bytes.size(), 0);
        REQUIRE(zip_file_replace(zip.get(), std::uint64_t(index), source, 0) == 0);
    }
    REQUIRE(zip_close(zip.get()) == 0);
    (void)zip.release();
}

void replace_zbuffer(const fs::path& container, const std::vector<std::uint8_t>& bytes) {
    replace_part(container, "Zbuffer.png", bytes);
}

std::vector<std::uint8_t> cut(std::vector<std::uint8_t> bytes) {
    bytes.resize(bytes.size() / 2);
    return bytes;
}

}  // namespace

TEST_CASE("Zbuffer.png has the topmost filled layer of every column, however bitmaps are turned", "[zbuffer]") {
    TemporaryFolder folder;
    for (int bits = 0; bits < 8; ++bits) {
        CAPTURE(bits);
        const Orientation o{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
        const fs::path out = write_sparse(folder.path() / std::to_string(bits), o);
        const Indices wanted = topmost_of(out);
        const Indices found =
            indices_in(entry(out / gcvf_name, "Zbuffer.png"), o.swap_xy ? 40 : 70, o.swap_xy ? 70 : 40);
        CHECK(found == wanted);
        CHECK(topmost_of(out / gcvf_name) == wanted);
        CHECK(verify_stack(out / gcvf_name).passed());
    }
    const Indices as_sliced = topmost_of(folder.path() / "0");
    CHECK(as_sliced[14] == 299);  // full to the top: one less than there are layers
    CHECK(as_sliced[0] == 0);     // of layer 0 alone
    CHECK(as_sliced[7] == 0);     // empty
    CHECK(*std::max_element(as_sliced.begin(), as_sliced.end()) > 255);
}

TEST_CASE("A container is the same for one thread and many, whichever layer comes first", "[zbuffer]") {
    TemporaryFolder folder;
    const auto many = read_whole_file(write_sparse(folder.path() / "many") / gcvf_name, 1 << 26);
    CHECK(read_whole_file(write_sparse(folder.path() / "down", {}, true) / gcvf_name, 1 << 26) == many);
    const ThreadLimit one(1);
    CHECK(read_whole_file(write_sparse(folder.path() / "one") / gcvf_name, 1 << 26) == many);
}

TEST_CASE("A Zbuffer of few layers has 16 bits too", "[zbuffer]") {
    TopmostLayers topmost(3, 2);
    topmost.add(7, layer_from_pixels({0, 1, 0, 0, 0, 2}, 3, 2));
    topmost.add(2, layer_from_pixels({1, 1, 0, 0, 0, 0}, 3, 2));
    CHECK(indices_in(topmost.png(), 3, 2) == Indices{2, 7, 0, 0, 0, 7});
    TopmostLayers high(1, 1);
    high.add(TopmostLayers::most_layers - 1, layer_from_pixels({1}, 1, 1));
    CHECK(indices_in(high.png(), 1, 1) == Indices{65534});
}

TEST_CASE("verify compares a container's Zbuffer with its layers", "[zbuffer]") {
    TemporaryFolder folder;
    const fs::path container = write_sparse(folder.path() / "s") / gcvf_name;
    const auto good = entry(container, "Zbuffer.png");
    Indices indices = indices_in(good, 70, 40);
    indices[100] ^= 1;
    TopmostLayers small(70, 39);
    struct Case {
        std::vector<std::uint8_t> zbuffer;
        const char* words;
    };
    const std::vector<Case> cases{
        {grey16_png_bytes(70, 40, indices), "topmost filled layer of every column"},
        {number_png_bytes(70, 40, Indices(70 * 40, 3)), "is 8-bit grey"},
        {small.png(), "is 70 x 39 px, the layers 70 x 40"},
        {cut(good), "cut short"},
        {{'n', 'o'}, "Zbuffer.png"},
        {png_bytes({70, 40, 3, std::vector<std::uint8_t>(70 * 40 * 3, 1)}), "8-bit RGB"},
    };
    for (const Case& c : cases) {
        CAPTURE(c.words);
        replace_zbuffer(container, c.zbuffer);
        const StackReport report = verify_stack(container);
        INFO(report_text(report));
        CHECK(report.fault_count == 1);
        CHECK(has(report, "zbuffer", c.words));
    }
    replace_zbuffer(container, good);
    CHECK(verify_stack(container).passed());
    // Others' containers do without: no fault, and said.
    replace_zbuffer(container, {});
    const StackReport without = verify_stack(container);
    CHECK(without.passed());
    CHECK_THAT(report_text(without), Contains("note: Zbuffer.png is not in it"));
}

TEST_CASE("A container without a part, or of another kind, does not pass", "[zbuffer]") {
    TemporaryFolder folder;
    const fs::path container = write_sparse(folder.path() / "s") / gcvf_name;
    const auto check = [&](const char* part, const std::vector<std::uint8_t>& bytes, const std::string& words) {
        const auto good = entry(container, part);
        REQUIRE(bytes != good);
        replace_part(container, part, bytes);
        const StackReport report = verify_stack(container);
        INFO(report_text(report));
        CHECK(report.fault_count == 1);
        CHECK(has(report, "container", words));
        std::unique_ptr<zip_t, Discard> zip(zip_open(container.c_str(), 0, nullptr));
        REQUIRE(zip_file_add(zip.get(), part, zip_source_buffer(zip.get(), good.data(), good.size(), 0),
                             ZIP_FL_OVERWRITE) >= 0);
        REQUIRE(zip_close(zip.release()) == 0);
        REQUIRE(verify_stack(container).passed());
    };
    const auto xml = entry(container, "ConfigFile.xml");
    const auto config = [&](const std::string& from, const std::string& to) {
        std::string text(xml.begin(), xml.end());
        text.replace(text.find(from), from.size(), to);
        return std::vector<std::uint8_t>(text.begin(), text.end());
    };
    for (const char* part : {"Mesh.stl", "MeshBbx.ktn"}) {
        check(part, {}, "is missing");
        check(part, {1, 2, 3}, "has 3 bytes");
    }
    check("ConfigFile.xml", config("<Version>2<", "<Version>3<"), "Version 3 is not known here");
    check("ConfigFile.xml", config("<Version>2</Version>", ""), "does not say its Version");
    check("ConfigFile.xml", config(">Materials<", ">Colors<"), "DataSemantics Colors");
    check("ConfigFile.xml", config("<BitDepth>4<", "<BitDepth>1<"), "BitDepth 1");
    check("ConfigFile.xml", config("<MaxNumberOfColors>6<", "<MaxNumberOfColors>2<"), "names 5 materials");
    check("ConfigFile.xml", config("<MaxNumberOfColors>6<", "<MaxNumberOfColors>many<"), "MaxNumberOfColors");
    replace_part(container, "ConfigFile.xml", {});
    CHECK(has(verify_stack(container), "container", "no GCVF container"));
    std::unique_ptr<zip_t, Discard> zip(zip_open(container.c_str(), 0, nullptr));
    REQUIRE(zip_file_add(zip.get(), "config.ini", zip_source_buffer(zip.get(), "a = b", 5, 0), 0) >= 0);
    REQUIRE(zip_close(zip.release()) == 0);
    CHECK(has(verify_stack(container), "container", "(SL1): unpack it"));
}

TEST_CASE("What a GCVF cannot hold is refused before a layer is made", "[zbuffer]") {
    StackDescription stack = sample_description(TopmostLayers::most_layers);
    stack.resins.push_back({"UltraClear", "T", {170, 205, 230}});
    CHECK_NOTHROW(expect_gcvf(stack));
    StackDescription high = stack, many = stack;
    ++high.layers;
    CHECK_THROWS_WITH(expect_gcvf(high), Contains("65536 layers") && Contains("65535 at most"));
    many.resins.push_back({"Agilus", "A", {1, 2, 3}});
    CHECK_THROWS_WITH(expect_gcvf(many), Contains("7 resins") && Contains("6 at most"));
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    CHECK_THROWS_AS(LayerStackWriter(out, many, {ResinBitmaps::none, true, false}), InputError);
    CHECK_FALSE(fs::exists(out));
    CHECK_NOTHROW(LayerStackWriter(out, many, {ResinBitmaps::none, false, false}));

    CHECK(gcvf_size_note(0xfffffffe, 65534).empty());
    CHECK_THAT(gcvf_size_note(0xffffffff, 34), Contains("ZIP64") && Contains("not known"));
    CHECK_THAT(gcvf_size_note(1000, 65535), Contains("ZIP64"));
}

TEST_CASE("A GCVF of more entries than the printer's software is known to read is written, and said to be one",
          "[zbuffer][slow]") {
    class Warnings final : public Progress {
    public:
        std::string all;

    private:
        void on_warning(const std::string& message) override { all += message + '\n'; }
    };
    const TemporaryFolder folder;
    StackDescription stack = sample_description(65531);  // and four entries besides
    fs::create_directories((folder.path() / stack.layer_path(0)).parent_path());
    const fs::path layer = folder.path() / "layer.png";
    write_whole_file(layer, std::string(1, 'x'));  // a writer of containers looks at no layer
    for (std::uint32_t k = 0; k < stack.layers; ++k) fs::create_symlink(layer, folder.path() / stack.layer_path(k));
    Warnings warnings;
    write_gcvf(folder.path() / "more.gcvf", stack, folder.path(), TopmostLayers(1, 1), gcvf_preview(stack, {}),
               &warnings);
    CHECK_THAT(warnings.all, Contains("more.gcvf: ") && Contains("65535 entries") && Contains("[gcvf-zip64]"));
}
