// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a report says of the colours of a small page whose areas are known.
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"
#include "tests/slicer/print/small_print.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

/// 120 x 90 pixels, `code` of each in sRGB's codes.
template <class Code>
void write_page(const PrintDesk& desk, const char* name, const Code& code) {
    io::LinearPicture page{120, 90, {}};
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 120; ++x) {
            const std::array<int, 3> of = code(x, y);
            Eigen::Vector4f& pixel = page.pixels.emplace_back(0, 0, 0, 1);
            for (Eigen::Index c = 0; c < 3; ++c) pixel[c] = float(optics::srgb_decode(of[std::size_t(c)] / 255.0));
        }
    io::write_whole_file(desk.path(name), io::png_bytes(io::encode_over(page, Eigen::Vector3f::Zero()), {0, 0}));
}

/// Grey paper: a red square of 30 on the upper left, one of 40 on the lower left, blue of 45 x 60 on the right.
void write_squares(const PrintDesk& desk) {
    write_page(desk, "squares.png", [](int x, int y) {
        const bool red = x >= 8 && ((y >= 8 && y < 38 && x < 38) || (y >= 44 && y < 84 && x < 48)),
                   blue = x >= 66 && x < 111 && y >= 15 && y < 75;
        return red ? std::array{170, 60, 60} : blue ? std::array{60, 90, 140} : std::array{200, 200, 196};
    });
}

json report_of_page(PrintDesk& desk, const char* name) {
    SliceOptions options = desk.options("out");
    options.model = desk.path(name).string();
    options.unit.assign("auto");
    options.width_mm = 6;
    options.thickness_mm = 2;
    options.predict.assign("transport");
    return json::parse(desk.print(options).json);
}

const json* region_of(const json& verdict, const char* asked) {
    for (const json& region : verdict.at("regions"))
        if (region.at("kind") == "solid" && region.at("asked").get<std::string>().starts_with(asked)) return &region;
    return nullptr;
}

}  // namespace

TEST_CASE("A page's areas are told with their colours, sizes and places, those of one colour together") {
    PrintDesk desk;
    write_squares(desk);
    const json report = report_of_page(desk, "squares.png"), &verdict = report.at("verdict");
    INFO(verdict.dump(1));
    const json *red = region_of(verdict, "red"), *blue = region_of(verdict, "blue");
    REQUIRE(red);
    REQUIRE(blue);
    CHECK(red->at("asked") == "red (170, 60, 60)");
    CHECK(blue->at("asked") == "blue (60, 90, 140)");
    CHECK(red->at("printed").get<std::string>().starts_with("red ("));
    CHECK(blue->at("printed").get<std::string>().starts_with("blue ("));
    CHECK(red->at("pieces") == 2);
    CHECK(blue->at("pieces") == 1);
    // 20 pixels a mm, without rims of half a millimetre at the most.
    const double of_red = (30 * 30 + 40 * 40) / 400.0, of_blue = 45 * 60 / 400.0;
    CHECK(red->at("area_mm2").get<double>() < 1.05 * of_red);
    CHECK(red->at("area_mm2").get<double>() > 0.5 * of_red);
    CHECK(blue->at("area_mm2").get<double>() < 1.05 * of_blue);
    CHECK(blue->at("area_mm2").get<double>() > 0.5 * of_blue);
    // The larger of the red ones is shown.
    CHECK(red->at("place") == "lower left");
    CHECK_THAT(blue->at("place").get<std::string>(), Contains("right"));
    CHECK(blue->at("place_mm")[0].get<double>() == Approx(88.5 / 20).margin(0.4));
    CHECK(blue->at("place_mm")[1].get<double>() == Approx((90 - 45) / 20.0).margin(0.4));
    CHECK(blue->at("place_mm")[2].get<double>() == Approx(2).margin(0.03));
    for (const json* region : {red, blue}) {
        CHECK(region->at("seen_share").get<double>() == Approx(1));
        CHECK(region->at("de2000").get<double>() < 8);
        if (region->at("de2000").get<double>() > 5) CHECK(region->at("good") == false);
    }
    CHECK(blue->at("good") == true);
    // The sum of causes is all of it, and each advice is nearer than what there is.
    double causes = 0;
    for (const json& cause : verdict.at("causes")) causes += cause.at("share").get<double>();
    if (!verdict["causes"].empty()) CHECK(causes == Approx(1).margin(0.02));
    const double mean = verdict.at("seen_de2000").at("mean");
    CHECK(verdict["seen_de2000"]["p95"].get<double>() >= mean);
    CHECK(verdict["seen_de2000"]["out_of_reach"].get<double>() <= mean);
    for (const json& advice : verdict.at("advice")) {
        CHECK(advice.at("now").get<double>() == Approx(mean).margin(0.01));
        CHECK(advice.at("then").get<double>() < advice["now"].get<double>());
    }
    CHECK_THAT(verdict.at("headline").get<std::string>(), Contains(fmt::format("{:.1f}", mean)));
    // The histogram's shares are all of the surface.
    double shares = 0;
    const json& predicted = report.at("predicted");
    for (const json& bin : predicted.at("de2000").at("histogram")) shares += bin.at("share").get<double>();
    CHECK(shares == Approx(1).margin(1e-3));
    CHECK(predicted["de2000"]["median"].get<double>() <= predicted["de2000"]["p95"].get<double>());
    CHECK(predicted["de2000"]["p95"].get<double>() <= predicted["de2000"]["max"].get<double>());
}

TEST_CASE("A label on a picture's back is printed as it is, whatever the loop makes of its face") {
    PrintDesk desk;
    write_squares(desk);
    const auto lowest_layer = [&](const char* out, const char* iterations) {
        SliceOptions options = desk.options(out);
        options.model = desk.path("squares.png").string();
        options.unit.assign("auto");
        options.width_mm = 6;
        options.thickness_mm = 1.5;
        options.labels = {"A-17; size=1.5mm"};
        options.iterations.assign(iterations);
        options.report = false;
        (void)desk.print(options);
        std::ifstream in(desk.path(std::string(out) + "/layers/slice_00000.png"), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    const std::string open = lowest_layer("open", "0");
    CHECK(open.size() > 100);
    CHECK(lowest_layer("looped", "1") == open);
}

TEST_CASE("The inside of a letter is ground, and no type of its colour") {
    PrintDesk desk;
    write_page(desk, "rings.png", [](int x, int y) {
        const double from = std::hypot((x - 4) % 28 - 13.5, (y - 3) % 28 - 13.5);
        const bool ink = x >= 4 && y >= 3 && x < 116 && y < 87 && from < 13.5 && from > 9;
        return ink ? std::array{10, 10, 10} : std::array{225, 215, 190};
    });
    const json verdict = report_of_page(desk, "rings.png").at("verdict");
    INFO(verdict.dump(1));
    bool is_ground = false;
    for (const json& region : verdict.at("regions")) {
        const std::string kind = region.at("kind"), asked = region.at("asked");
        is_ground = is_ground || (kind == "solid" && asked.starts_with("beige"));
        if (kind == "type and lines") CHECK_FALSE(asked.starts_with("beige"));
    }
    CHECK(is_ground);
}

TEST_CASE("Of a picture without flat areas the worst is where most of it is off") {
    PrintDesk desk;
    write_page(desk, "sunset.png", [](int x, int y) {  // to a blue in the upper right that no mixture reaches
        const double blue = std::clamp((x - 0.9 * y) / 110.0, 0.0, 1.0);
        return std::array{int(200 - 200 * blue), int(150 - 130 * blue) + y / 6, int(90 + 165 * blue)};
    });
    const json report = report_of_page(desk, "sunset.png"), &verdict = report.at("verdict");
    INFO(verdict.dump(1));
    // Below 1 CIEDE2000 nothing is said to be mapped.
    const json& gamut = report.at("gamut");
    const double mapped = gamut.at("mapped_share"), mean = gamut.at("de2000").at("mean");
    CHECK(mapped > 0.02);
    CHECK(mean > mapped);
    CHECK(mean < gamut["de2000"]["p95"].get<double>());
    CHECK(gamut["de2000"]["p95"].get<double>() < gamut["de2000"]["max"].get<double>());
    // Places that are looked at more closely lie a twelfth of the page apart, the worst first.
    const std::string page = io::text_of(desk.path("out/report.html"));
    const std::size_t from = page.find("\"worst\": [");
    REQUIRE(from != std::string::npos);
    const json places = json::parse(page.substr(from + 9, page.find("}]", from) + 2 - from - 9), nullptr, false);
    REQUIRE(places.is_array());
    CHECK(places.size() > 1);
    for (std::size_t a = 0; a < places.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            double apart = 0;
            for (std::size_t axis = 0; axis < 3; ++axis)
                apart = std::hypot(
                    apart, places[a].at("at_mm")[axis].get<double>() - places[b].at("at_mm")[axis].get<double>());
            CHECK(apart > 0.99 * 6 / 12);
        }
    REQUIRE_FALSE(verdict.at("regions").empty());
    const json& worst = verdict["regions"][0];
    CHECK(worst.at("kind") == "colour");
    CHECK(worst.at("place") == "upper right");
    CHECK(worst.at("asked").get<std::string>().starts_with("blue"));
    CHECK(worst.at("de2000").get<double>() > 5);
    CHECK_THAT(verdict.at("sentence").get<std::string>(), Contains("blue (upper right"));
}

TEST_CASE("A thin page over black is told to be thin, and that a thicker one would be nearer") {
    PrintDesk desk;
    write_squares(desk);
    SliceOptions options = desk.options("out");
    options.model = desk.path("squares.png").string();
    options.unit.assign("auto");
    options.width_mm = 6;
    options.thickness_mm = 0.85;
    options.predict.assign("transport");
    const json verdict = json::parse(desk.print(options).json).at("verdict");
    INFO(verdict.dump(1));
    bool told = false, advised = false;
    for (const json& region : verdict.at("regions"))
        if (region.at("kind") == "thin walls") {
            told = true;
            CHECK_THAT(region.at("why").get<std::string>(), Contains("let light pass") || Contains("0.8 mm"));
            CHECK(region.at("area_mm2").get<double>() > 9);
            CHECK(region.at("area_mm2").get<double>() <= 27.1);  // all of the page
            // Paper, red and blue together.
            CHECK_THAT(region.at("asked").get<std::string>(), !Catch::StartsWith("black") && !Contains("(0, 0, 0)"));
            CHECK(region.at("pieces") == 1);
            // Of its own size, not of its area's: between what is good and what is black for white.
            CHECK(region.at("de2000").get<double>() > 2);
            CHECK(region.at("de2000").get<double>() < 25);
            CHECK(region.at("printed").get<std::string>().find("(255, 255, 255)") == std::string::npos);
        }
    for (const json& advice : verdict.at("advice"))
        advised = advised || advice.at("options").get<std::string>().starts_with("--thickness ");
    CHECK(told);
    CHECK(advised);
    REQUIRE_FALSE(verdict.at("causes").empty());
    CHECK(verdict["causes"][0].at("cause") == "thin walls");
}
