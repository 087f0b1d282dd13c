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

/// Grey paper, 120 x 90 pixels: a red square of 30 on the upper left, one of 40 on the lower left, blue of 45 x 60 on
/// the right.
void write_squares(const PrintDesk& desk) {
    const auto linear = [](std::array<int, 3> code) {
        Eigen::Vector4f pixel(0, 0, 0, 1);
        for (Eigen::Index c = 0; c < 3; ++c) pixel[c] = float(optics::srgb_decode(code[std::size_t(c)] / 255.0));
        return pixel;
    };
    io::LinearPicture page{120, 90, {}};
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 120; ++x) {
            const bool red = x >= 8 && ((y >= 8 && y < 38 && x < 38) || (y >= 44 && y < 84 && x < 48)),
                       blue = x >= 66 && x < 111 && y >= 15 && y < 75;
            page.pixels.push_back(linear(red    ? std::array{170, 60, 60}
                                         : blue ? std::array{60, 90, 140}
                                                : std::array{200, 200, 196}));
        }
    io::write_whole_file(desk.path("squares.png"),
                         io::png_bytes(io::encode_over(page, Eigen::Vector3f::Zero()), {0, 0}));
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
    SliceOptions options = desk.options("out");
    options.model = desk.path("squares.png").string();
    options.unit.assign("auto");
    options.width_mm = 6;
    options.thickness_mm = 2;
    options.predict.assign("transport");
    const json report = json::parse(desk.print(options).json), &verdict = report.at("verdict");
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
