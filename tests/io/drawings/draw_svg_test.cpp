// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/drawings/draw_svg.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/units.h"
#include "io/files/base64.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

std::string svg(const std::string& attributes, const std::string& content) {
    return fmt::format("<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' {}>{}</svg>",
                       attributes, content);
}

const std::string square_10mm = "width='10mm' height='10mm' viewBox='0 0 10 10'";
const std::string red_rectangle = "<rect width='100%' height='100%' fill='#c82828'/>";

DecodedImage draw(const std::string& text, const DrawingRaster& raster = {.pitch_mm = 0.1}) {
    return draw_svg(std::as_bytes(std::span(text)), "a.svg", {.drawing = raster});
}

/// As the product reads it: behind the walls, by two programs.
DecodedImage read(const std::string& text, DrawingRaster raster = {.pitch_mm = 0.1}, ReadOptions options = {}) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.svg";
    std::ofstream(file) << text;
    options.drawing = raster;
    return read_picture_with_alpha(file, options);
}

double ink_of(const DecodedImage& image) {
    double ink = 0;
    for (std::size_t i = 0; i < image.texels.pixels(); ++i) ink += double(image.texels.alpha(i));
    return ink;
}

std::array<int, 4> pixel(const DecodedImage& image, std::uint32_t x, std::uint32_t y) {
    const std::uint8_t* const p = &image.texels.srgb8[4 * (std::size_t{y} * image.texels.width_px + x)];
    return {p[0], p[1], p[2], p[3]};
}

struct Size {
    double width_mm, height_mm;
};
Size own_size(const DecodedImage& image) {
    const double width = image.texels.width_px / image.dpi_x * mm_per_inch;
    return {width, width * image.pixel_aspect * image.texels.height_px / image.texels.width_px};
}

std::string refusal(const std::string& text) {
    try {
        (void)read(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing is refused";
}

}  // namespace

TEST_CASE("A circle covers its area at every size, and its rim is one pixel wide") {
    const std::string circle = svg(square_10mm, "<circle cx='5' cy='5' r='4' fill='#123456'/>");
    for (const double width_mm : {2.0, 10.0, 77.7}) {
        const DecodedImage image = draw(circle, {.pitch_mm = 0.05, .width_mm = width_mm});
        CHECK(image.texels.width_px == Approx(width_mm / 0.05).margin(1));
        CHECK(image.has_alpha);
        const double px_mm = width_mm / image.texels.width_px, radius_mm = 0.4 * width_mm;
        const double area = std::numbers::pi * radius_mm * radius_mm;
        // Curves of third order come within 0.027 % of a circle's radius; the rim is drawn to 0.01 of a pixel, and
        // coverage is counted in 1/255.
        const double rim_mm = px_mm * (0.01 + 1.0 / 255) + 0.00027 * radius_mm;
        CHECK(ink_of(image) * px_mm * px_mm == Approx(area).margin(2 * std::numbers::pi * radius_mm * rim_mm));
        std::size_t between = 0;
        for (std::size_t i = 0; i < image.texels.pixels(); ++i)
            between += image.texels.alpha(i) > 0 && image.texels.alpha(i) < 1 ? 1 : 0;
        CHECK(double(between) <= 8 * radius_mm / px_mm * 1.01);  // a circle of radius r crosses 8 r squares of a grid
        CHECK(pixel(image, image.texels.width_px / 2, image.texels.height_px / 2) == std::array{0x12, 0x34, 0x56, 255});
    }
}

TEST_CASE("A drawing is as large as it says") {
    struct Case {
        std::string attributes;
        double width_mm, height_mm, px_per_inch = 0;
    };
    const double px = mm_per_inch / 96, pt = mm_per_inch / 72;
    for (const auto& [attributes, width_mm, height_mm, px_per_inch] : std::initializer_list<Case>{
             {"width='40mm' height='2.5cm'", 40, 25},
             {"width='1in' height='0.5in'", 25.4, 12.7},
             {"width='30pt' height='4pc'", 30 * pt, 48 * pt},
             {"width='200' height='100px'", 200 * px, 100 * px},
             {"viewBox='5 5 60 90'", 60 * px, 90 * px},
             {"width='100%' height='100%' viewBox='0 0 60 90'", 60 * px, 90 * px},
             {"width='12mm' viewBox='0 0 60 90'", 12, 18},
             {"height='12mm' viewBox='0 0 60 90'", 8, 12},
             {"width='72' height='36'", 25.4, 12.7, 72},  // as programs of 72 px an inch write them
             {"width='10mm' height='20mm'", 10, 20, 72},
             {"", 30 * px, 20 * px}}) {
        INFO(attributes << " at " << px_per_inch);
        const DecodedImage image = draw(svg(attributes, "<rect x='3' y='5' width='30' height='20'/>"),
                                        {.pitch_mm = 0.1, .px_per_inch = px_per_inch});
        CHECK(own_size(image).width_mm == Approx(width_mm).epsilon(1e-4));
        CHECK(own_size(image).height_mm == Approx(height_mm).epsilon(1e-4));
        CHECK(image.texels.width_px >= width_mm / 0.1 - 1e-3);
        CHECK(image.texels.width_px < width_mm / 0.1 + 1);
    }
}

TEST_CASE("What is asked decides the pixels, and the file its own size") {
    const std::string tall = svg("width='10mm' height='40mm'", red_rectangle);
    for (const DrawingRaster& raster :
         {DrawingRaster{.pitch_mm = 0.1, .width_mm = 5}, DrawingRaster{.pitch_mm = 0.1, .height_mm = 20},
          DrawingRaster{.pitch_mm = 0.1, .size_mm = 20}}) {
        const DecodedImage image = draw(tall, raster);
        CHECK(image.texels.width_px == 50);
        CHECK(image.texels.height_px == 200);
        CHECK(own_size(image).width_mm == Approx(10));
        CHECK(image.pixel_aspect == Approx(1));
        CHECK_FALSE(image.has_alpha);
        CHECK(pixel(image, 0, 0) == std::array{200, 40, 40, 255});
    }
    // No more pixels than are allowed: fewer, and no refusal.
    const DecodedImage few =
        draw_svg(std::as_bytes(std::span(tall)), "a.svg", {.max_pixels = 10000, .drawing = {.pitch_mm = 1e-4}});
    CHECK(few.texels.pixels() <= 10000);
    CHECK(few.texels.pixels() > 9000);
    CHECK(own_size(few).height_mm == Approx(40));
    CHECK(draw(svg("width='100000cm' height='100cm'", red_rectangle)).texels.width_px == 32767);
}

TEST_CASE("Transparent parts and half-transparent ones stay so, in their own colour") {
    const DecodedImage image =
        draw(svg(square_10mm,
                 "<rect width='5' height='10' fill='#c82828' fill-opacity='0.5'/><rect x='5' width='2' height='10' "
                 "fill='#0a141e' opacity='0.02'/>"));
    CHECK(image.has_alpha);
    const auto [r, g, b, a] = pixel(image, 10, 50);
    CHECK(a == Approx(128).margin(1));
    CHECK(r == Approx(200).margin(1));
    CHECK(g == Approx(40).margin(1));
    CHECK(b == Approx(40).margin(1));
    CHECK(pixel(image, 60, 50)[3] == Approx(5).margin(1));
    CHECK(pixel(image, 90, 50) == std::array{0, 0, 0, 0});
}

TEST_CASE("A drawing is read behind the walls, packed or not, with pictures and filters in it") {
    CHECK(pixel(read(svg(square_10mm, red_rectangle)), 50, 50) == std::array{200, 40, 40, 255});
    const std::string packed("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10);
    CHECK_THAT(refusal(packed + "nonsense"), Contains("a.svg"));

    const DecodedImage with_picture =
        read(svg(square_10mm,
                 fmt::format("<filter id='f'><feGaussianBlur stdDeviation='0.1'/></filter><image width='10' height='5' "
                             "preserveAspectRatio='none' xlink:href='data:image/png;base64,{}'/><rect y='5' "
                             "width='10' height='5' filter='url(#f)'/>",
                             base64(png_bytes({2, 1, 3, {255, 0, 0, 0, 0, 255}})))));
    CHECK(pixel(with_picture, 5, 20) == std::array{255, 0, 0, 255});
    CHECK(pixel(with_picture, 95, 20) == std::array{0, 0, 255, 255});
    CHECK(pixel(with_picture, 50, 75) == std::array{0, 0, 0, 255});
    CHECK(with_picture.warnings.empty());
    CHECK(with_picture.lost_colour.empty());
}

TEST_CASE("Text is set, and it is said where the font is another or a letter is in none") {
    const auto with = [](const std::string& attributes, const std::string& letters) {
        return read(svg(square_10mm, fmt::format("<text x='0' y='8' font-size='8' {}>{}</text>", attributes, letters)));
    };
    const DecodedImage plain = with("font-family='DejaVu Sans, Arial'", "M");
    CHECK(ink_of(plain) > 500);
    CHECK(plain.warnings.empty());
    CHECK(with("font-family='sans-serif'", "M").warnings.empty());
    for (const std::string family :
         {"font-family='\"No Such Font\", DejaVu Sans'", "style='font-family:No Such Font;fill:red'"}) {
        const DecodedImage other = with(family, "M");
        REQUIRE(other.warnings.size() == 1);
        CHECK_THAT(other.warnings[0], Contains("[other-font]") && Contains("No Such Font") && Contains("DejaVu Sans") &&
                                          Contains("paths"));
        CHECK(ink_of(other) > 500);
    }
    const DecodedImage styled =
        read(svg(square_10mm, "<style><![CDATA[ text { font-family : Nowhere ; } ]]></style><text y='8'>M</text>"));
    REQUIRE(styled.warnings.size() == 1);
    CHECK_THAT(styled.warnings[0], Contains("Nowhere"));
    const DecodedImage unknown = with("font-family='DejaVu Sans'", "&#x12000;a");
    REQUIRE(unknown.warnings.size() == 1);
    CHECK_THAT(unknown.warnings[0], Contains("letters") && Contains("boxes"));
    // A font that no text is set in is nobody's loss.
    CHECK(read(svg(square_10mm, "<g font-family='No Such Font'>" + red_rectangle + "</g>")).warnings.empty());
}

TEST_CASE("What a drawing shows of other files is lost, and said") {
    const TemporaryFolder folder;
    const fs::path secret = folder.path() / "secret.svg";
    std::ofstream(secret) << svg(square_10mm, "<rect id='r' width='10' height='10' fill='#c82828'/>");
    for (const std::string& element : {fmt::format("<image width='10' height='10' xlink:href='{}'/>", secret.string()),
                                       fmt::format("<image width='10' height='10' href='file://{}'/>", secret.string()),
                                       fmt::format("<use xlink:href='{}#r'/>", secret.string())}) {
        INFO(element);
        const DecodedImage image = read(svg(square_10mm, "<rect width='2' height='2' fill='#123456'/>" + element));
        CHECK_THAT(image.lost_colour, Contains("another file") && Contains("secret.svg"));
        CHECK(pixel(image, 80, 80)[3] == 0);
        CHECK(pixel(image, 10, 10)[3] == 255);
    }
    const std::string html =
        "<foreignObject width='5' height='5'><p xmlns='http://www.w3.org/1999/xhtml'>x</p></foreignObject>";
    CHECK_THAT(read(svg(square_10mm, red_rectangle + html)).lost_colour, Contains("HTML"));
    CHECK(read(svg(square_10mm, red_rectangle + "<switch>" + html + "<text>x</text></switch>")).lost_colour.empty());
}

TEST_CASE("A broken or hostile drawing is one sentence, in time", "[slow]") {
    const auto begin = std::chrono::steady_clock::now();
    CHECK_THAT(refusal("<svg xmlns='http://www.w3.org/2000/svg'><rect"),
               Contains("cannot be drawn") && Contains("Inkscape"));
    CHECK_THAT(refusal(""), Contains("a.svg"));
    CHECK_THAT(refusal("no drawing"), Contains("cannot be drawn"));
    CHECK_THAT(refusal(svg(square_10mm, "")), Contains("nothing is drawn"));
    CHECK_THAT(refusal(svg("viewBox='900 900 10 10'", "<rect width='10' height='10'/>")), Contains("nothing is drawn"));
    CHECK_THAT(refusal(svg("width='1e9' height='1'", red_rectangle)), Contains("nothing can be seen"));
    CHECK_THAT(refusal(svg("width='0' height='0'", red_rectangle)), Contains("a.svg"));
    std::string entities = "<!ENTITY e0 '<rect width=\"1\" height=\"1\"/>'>", opens = "<g>", closes = "</g>",
                uses = "<rect id='u0' width='1' height='1'/>";
    for (int i = 1; i < 20; ++i) {
        std::string ten, ten_uses;
        for (int k = 0; k < 10; ++k) {
            ten += fmt::format("&e{};", i - 1);
            ten_uses += fmt::format("<use xlink:href='#u{}'/>", i - 1);
        }
        entities += fmt::format("<!ENTITY e{} '{}'>", i, ten);
        uses += fmt::format("<g id='u{}'>{}</g>", i, ten_uses);
    }
    for (int i = 0; i < 17; ++i) {  // 2^17 elements in one another
        opens += opens;
        closes += closes;
    }
    CHECK_THAT(refusal("<!DOCTYPE svg [" + entities + "]>" + svg(square_10mm, "&e19;")), Contains("a.svg"));
    CHECK_THAT(refusal("<!DOCTYPE svg [<!ENTITY f SYSTEM 'file:///etc/passwd'>]>" +
                       svg(square_10mm, "<text y='5'>&f;</text>")),
               Contains("a.svg"));
    CHECK_THAT(refusal(svg(square_10mm, uses)), Contains("a.svg"));
    CHECK_THAT(refusal(svg(square_10mm, "<use id='a' xlink:href='#b'/><use id='b' xlink:href='#a'/>")),
               Contains("a.svg"));
    CHECK_THAT(refusal(svg(square_10mm, opens + red_rectangle + closes)), Contains("a.svg"));
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::minutes(2));
}
