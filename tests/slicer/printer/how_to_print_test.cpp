// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/how_to_print.h"

#include <cstdio>

#include <catch2/catch.hpp>

#include "io/layers/orient.h"
#include "tests/io/layers/stack_samples.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Contains;

namespace {

/// A stack whose bitmaps have so many columns and rows, described whole.
io::StackDescription stack_of(std::uint32_t columns, std::uint32_t rows, io::Orientation orientation = {}) {
    io::StackDescription stack = io::sample_description(40, columns, rows);
    stack.orientation = orientation;
    stack.size_mm = io::stack_size_mm(stack);
    stack.content_sha256 = std::string(64, '0');
    return stack;
}

std::string page(const HowToPrint& what, const io::StackDescription& stack = stack_of(70, 40)) {
    return how_to_print_page(stack, find_printer("stratasys-j750-hm"), what);
}

HowToPrint print_with(io::StackOutputs outputs) { return {"A cow", outputs, {}, {}, {}}; }

std::string text_of_part(const PartFinish& part) {
    HowToPrint what = print_with({});
    what.parts = {part};
    return page(what);
}

}  // namespace

TEST_CASE("Who washes a print is told of walls that may break") {
    HowToPrint what = print_with({});
    CHECK_THAT(page(what), !Contains("Wash with care"));
    what.fragile = {"cow: walls under 0.6 mm may break: <ear>"};
    CHECK_THAT(page(what), Contains("<b>Wash with care.</b> cow: walls under 0.6 mm may break: &lt;ear&gt;"));
}

TEST_CASE("A column of the model is found in bitmaps that were turned as the printer wants them") {
    // 5 x 3 columns of the model, each with a material of its own: turned by the writer's own function.
    constexpr std::uint32_t width = 5, height = 3;
    std::vector<io::Material> pixels;
    for (std::uint32_t n = 0; n < width * height; ++n) pixels.push_back(io::Material(n + 1));
    const io::LayerRuns layer = io::layer_from_pixels(pixels, width, height);  // rows from the top: j counts down
    for (int bits = 0; bits < 8; ++bits) {
        const io::Orientation orientation{bool(bits & 1), bool(bits & 2), bool(bits & 4)};
        CAPTURE(bits);
        const std::vector<io::Material> turned = io::layer_pixels(io::oriented(layer, orientation));
        const io::StackDescription stack =
            orientation.swap_xy ? stack_of(height, width, orientation) : stack_of(width, height, orientation);
        for (std::uint32_t j = 0; j < height; ++j)
            for (std::uint32_t i = 0; i < width; ++i)
                CHECK(turned[pixel_of_column(stack, i, j)] == pixels[(height - 1 - j) * width + i]);
    }
}

TEST_CASE("Parts are told apart once they are washed: number, whose they are, what is written on them") {
    io::StackDescription stack = stack_of(70, 40);
    stack.members = {{"cow-1", {{0, 0, 0, 1.2, 0.5, 1}}, 0.1, "good", "customer Klein; label \"7\""},
                     {"a-part-of-a-long-name", {{1.5, 0, 0, 1.8, 3, 1}}, 0.1, "", ""}};
    HowToPrint what = print_with({});
    what.from_above = {{2, 2, 3, std::vector<std::uint8_t>(12, 9)}, "as it is"};
    const std::string html = page(what, stack);
    CHECK_THAT(html, Contains("<td class=\"n\">1</td><td>cow-1<br>customer Klein; label &quot;7&quot;</td>"));
    CHECK_THAT(html, Contains(">2</td><td>a-part-of-a-long-name</td>"));
    CHECK_THAT(html, Contains(">2</text>") && !Contains(">2 a-part-of-a-long-name</text>"));  // it has no room there
}

TEST_CASE("Copies of one part are told apart on the plan") {
    io::StackDescription stack = stack_of(60, 30);
    stack.members = {{"cow", {{0, 0, 0, 1.2, 1.2, 1}, {1.3, 0, 0, 2.5, 1.2, 1}}, 0.1, "good", ""},
                     {"tag", {{0, 1.3, 0, 2.5, 2.5, 1}}, 0.1, "", ""}};
    HowToPrint what = print_with({});
    what.from_above = {{2, 2, 3, std::vector<std::uint8_t>(12, 9)}, "as it is"};
    const std::string html = page(what, stack);
    CHECK_THAT(html, Contains(">1.1 cow</text>") && Contains(">1.2 cow</text>") && Contains(">2 tag</text>"));
    CHECK_THAT(html, Contains("2 (1.1 to 1.2)"));
    // The plan says where its sides are.
    CHECK_THAT(html, Contains(">front</text>") && Contains(">back, ") && Contains(" mm</text>"));
    // A number stays in its part's box, also where that is wide and low or high and narrow.
    for (const auto& [wide, deep] : {std::pair{2.4, 0.1}, {0.1, 1.2}}) {
        stack.members = {{"bar", {{0, 0, 0, wide, deep, 1}}, 0.1, "", ""}};
        const std::string plan = page(what, stack);
        const auto at = plan.find("<text x=");
        REQUIRE(at != std::string::npos);
        double x = 0, y = 0, size = 0;
        REQUIRE(std::sscanf(plan.c_str() + at, "<text x=\"%lf\" y=\"%lf\" font-size=\"%lf\"", &x, &y, &size) == 3);
        CAPTURE(wide, deep, size);
        CHECK(size <= deep);
        CHECK(0.5 * size <= wide);
        CHECK(size >= 0.5 * std::min(wide, deep));
    }
}

TEST_CASE("A tray that is narrower than its caption has room for it beside") {
    io::StackDescription stack = stack_of(60, 3000);  // 2.5 mm wide, 254 mm deep
    HowToPrint what = print_with({});
    what.from_above = {{2, 2, 3, std::vector<std::uint8_t>(12, 9)}, "as it is"};
    const std::string html = page(what, stack);
    const auto at = html.find("viewBox=\"");
    REQUIRE(at != std::string::npos);
    double left = 0, top = 0, width = 0, height = 0;
    REQUIRE(std::sscanf(html.c_str() + at, "viewBox=\"%lf %lf %lf %lf", &left, &top, &width, &height) == 4);
    // "back, 2.5 mm" in letters of 3.5 % of its depth, half as wide as high at least.
    CHECK(width >= 12 * 0.5 * 0.035 * 254);
    CHECK(-left == Approx(width / 2 - 25.4 / 600 * 60 / 2));
}

TEST_CASE("The print from above shows the highest of each pixel's columns, its back at the top") {
    const io::StackDescription stack = stack_of(600, 4);  // 25.4 mm wide, 0.34 mm deep
    io::TopmostLayers topmost(600, 4);
    // Layer 4 has one voxel at the front left, layer 9 one at the back, beside the middle.
    const auto one_voxel = [](std::uint32_t x, std::uint32_t y) {
        std::vector<io::Material> pixels(600 * 4, io::background);
        pixels[y * 600 + x] = 1;
        return io::layer_from_pixels(pixels, 600, 4);
    };
    topmost.add(4, one_voxel(0, 3));
    topmost.add(9, one_voxel(300, 0));
    std::vector<std::array<std::uint32_t, 3>> asked;
    const PictureFromAbove picture = picture_from_above(
        stack, topmost,
        [&](std::uint32_t i, std::uint32_t j, std::uint16_t top) {
            asked.push_back({i, j, top});
            return io::Rgb{200, 100, 50};
        },
        "so");
    CHECK(picture.caption == "so");
    CHECK(picture.picture.width_px == 480);
    CHECK(picture.picture.height_px == 4);  // no more than there are rows, though 6 are wanted
    REQUIRE(asked.size() == 2);
    CHECK(asked[0] == std::array<std::uint32_t, 3>{300, 3, topmost.indices()[300]});
    CHECK(asked[1] == std::array<std::uint32_t, 3>{0, 0, topmost.indices()[3 * 600]});
    const auto red = [&](std::size_t x, std::size_t y) { return picture.picture.codes[3 * (y * 480 + x)]; };
    CHECK(red(240, 0) == 200);
    CHECK(red(0, 3) == 200);
    CHECK(std::count(picture.picture.codes.begin(), picture.picture.codes.end(), 100) == 2);
}

TEST_CASE("The page names the files that were written, and how they are loaded") {
    const std::string layers = page(print_with({}));
    CHECK_THAT(layers, Contains("<title>How to print A cow"));
    CHECK_THAT(layers, Contains("40 pictures from slice_00000.png (the lowest) to slice_00039.png"));
    CHECK_THAT(layers, Contains("Load the folder layers with these values") && Contains("slice_NUMBER.png"));
    CHECK_THAT(layers, Contains("0 to 39") && Contains("70 x 40 px") && Contains("600 x 300 dpi"));
    CHECK_THAT(layers, Contains("27 um = 0.027 mm"));
    CHECK_THAT(layers, Contains("give each colour its resin by hand"));
    CHECK_THAT(layers, !Contains("stack.gcvf") && !Contains("one bitmap per resin and layer"));

    const std::string gcvf = page(print_with({.gcvf = true}));
    CHECK_THAT(gcvf, Contains("<b>stack.gcvf</b>, the whole print in one file.") && Contains("Load stack.gcvf."));
    CHECK_THAT(gcvf, Contains("names the resin of each colour") && !Contains("give each colour its resin by hand") &&
                         !Contains("Names of the slices"));
    CHECK_THAT(gcvf, Contains("Number of slices"));

    const std::string both = page(print_with({.gcvf = true, .png = true}));
    CHECK_THAT(both,
               Contains("in one file, and <b>layers</b>") && Contains("or the folder layers where it is not taken"));

    const std::string resins = page(print_with({.resin_bitmaps = io::ResinBitmaps::png1}));
    CHECK_THAT(resins, Contains("Load the folder resins") && Contains("Give each folder of bitmaps its resin"));
    CHECK_THAT(resins, !Contains("Names of the slices"));
    CHECK_THAT(resins, Contains("white is resin, black is none"));
    CHECK_THAT(page(print_with({.resin_bitmaps = io::ResinBitmaps::tiff1})), Contains("black is resin, white is none"));
    CHECK_THAT(page(print_with({.resin_bitmaps = io::ResinBitmaps::png8})), !Contains("is resin,"));

    const std::string all = page(print_with({.resin_bitmaps = io::ResinBitmaps::png1, .gcvf = true, .png = true}));
    CHECK_THAT(all, Contains("in one file, <b>layers</b>") && Contains("nothing else, and <b>resins</b>"));

    io::StackDescription later = stack_of(70, 40);
    later.first_layer = 100;
    later.content_sha256 = std::string(64, '0');
    CHECK_THAT(page(print_with({}), later), Contains("100 to 139"));
}

TEST_CASE("The page names resins by their colours, and mirrors as they were written") {
    const std::string plain = page(print_with({}));
    CHECK_THAT(plain, Contains("background:#ec008c\"></span>236, 0, 140</td><td><b>VeroMagenta</b></td><td>M</td>"));
    CHECK_THAT(plain, Contains("no mirror and no exchange"));
    const auto mirrors = [](io::Orientation o) { return page(print_with({}), stack_of(70, 40, o)); };
    CHECK_THAT(mirrors({true, false, false}), Contains("written with columns mirrored (flip_x), as"));
    CHECK_THAT(mirrors({false, true, false}), Contains("written with rows mirrored (flip_y), as"));
    CHECK_THAT(mirrors({false, false, true}), Contains("written with rows and columns exchanged, as"));
    CHECK_THAT(mirrors({true, true, true}),
               Contains("rows and columns exchanged, columns mirrored (flip_x), rows mirrored (flip_y), as"));
}

TEST_CASE("The page says how glossy or matt a part should be, by what of its colour support touches") {
    PartFinish part;
    part.name = "cow & calf";
    part.copies = 3;
    part.surface_mm2 = 2000, part.matt_mm2 = 500;
    CHECK_THAT(text_of_part(part), Contains("cow &amp; calf (3 times)") && Contains("5.00 of 20.00 cm<sup>2</sup>"));
    CHECK_THAT(text_of_part(part), Contains("<td>none</td><td>either: nothing of it is coloured"));
    part.copies = 1;
    CHECK_THAT(text_of_part(part), !Contains("times)"));
    part.coloured_mm2 = 1000;
    part.coloured_matt_mm2 = 0.49;
    CHECK_THAT(text_of_part(part), Contains("<td>none</td>") && Contains("support touches no coloured face"));
    part.coloured_matt_mm2 = 99, part.coloured_down_mm2 = 99, part.coloured_matt_height_mm = {1.25, 30};
    CHECK_THAT(text_of_part(part), Contains("0.99 cm<sup>2</sup>, facing down; 1.2 to 30.0 mm above the tray") &&
                                       Contains("little of its colour is touched"));
    part.coloured_matt_mm2 = 100, part.coloured_down_mm2 = 0;
    CHECK_THAT(text_of_part(part), Contains(", upright below what hangs over; ") && Contains("matt, to look alike"));
    part.coloured_down_mm2 = 40;
    CHECK_THAT(text_of_part(part), Contains("1.00 cm<sup>2</sup>: 0.40 cm<sup>2</sup> facing down, the rest upright"));
    part.coloured_down_mm2 = 5.1;
    CHECK_THAT(text_of_part(part), Contains(": 0.05 cm<sup>2</sup> facing down"));
    part.coloured_down_mm2 = 95.1;
    CHECK_THAT(text_of_part(part), Contains("cm<sup>2</sup>, facing down;"));
    part.coloured_matt_height_mm = {0, 0.03};
    CHECK_THAT(text_of_part(part), Contains("facing down; on the tray itself"));
    CHECK_THAT(page(print_with({})), !Contains("Advice"));
}

TEST_CASE("The page lists what is on the tray, and remarks where there are any") {
    HowToPrint what = print_with({});
    CHECK_THAT(page(what),
               Contains("Print the marker first") && !Contains("Once it is printed") && !Contains("on the tray</h2>"));
    what.remarks = {"Read it < so."};
    CHECK_THAT(page(what), !Contains("Print the marker first") && Contains("<li>Read it &lt; so.</li>"));
    io::StackDescription stack = stack_of(70, 40);
    stack.members.resize(2);
    stack.members[0].name = "cow", stack.members[0].ml = 1.5, stack.members[0].verdict = "as asked";
    stack.members[0].boxes_mm = {{1, 2, 0, 4, 8, 9.5}, {0, 0, 0, 1, 1, 1}};
    stack.members[1].name = "calf";
    const std::string text = page(print_with({}), stack);
    CHECK_THAT(
        text,
        Contains(
            "<td>cow</td><td class=\"n\">2 (1.1 to 1.2)</td><td>3.0 x 6.0 x 9.5 mm</td><td class=\"n\">1.50 ml</td>"
            "<td>as asked</td>"));
    CHECK_THAT(text, Contains("<td>calf</td><td class=\"n\">0</td><td>-</td>") && Contains("not predicted by itself"));
}
