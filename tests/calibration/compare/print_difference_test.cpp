// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_difference.h"

#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "calibration/compare/compare_page.h"
#include "calibration/compare/print_spread.h"
#include "compare_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

/// A reading without a camera: every cell as it is.
PrintReading reading_of(const PredictedPrint& print) {
    PrintReading reading;
    reading.cells.value = print.rgb;
    reading.cells.good.assign(print.cells(), 1);
    reading.camera_blur_mm = 0;
    return reading;
}

}  // namespace

TEST_CASE("the Gaussian of cells is the integral over both cells") {
    // A step from 0 to 1 at x = 0, smoothed: its mean over cell n is the integral of Phi(x / s).
    std::vector<Eigen::Vector3f> step(40, Eigen::Vector3f::Zero());
    for (std::size_t i = 20; i < 40; ++i) step[i].setOnes();
    for (const double sigma : {0.3, 0.7, 2.0}) {
        const auto spread = spread_cells(step, 40, {sigma, 0});
        for (int n = -6; n < 6; ++n) {
            double mean = 0;
            for (int k = 0; k < 1000; ++k)
                mean += 0.5 * std::erfc(-(n + (k + 0.5) / 1000) / sigma / std::sqrt(2)) / 1000;
            CHECK(double(spread[std::size_t(20 + n)][0]) == Approx(mean).margin(1e-5));
        }
    }
}

TEST_CASE("exposure, a cast and a spread are told apart and by how much") {
    const PredictedPrint print = discs();
    PrintReading reading = reading_of(print);
    reading.cells.value = spread_cells(print.rgb, print.columns, 0.06 * print.cell_mm.cwiseInverse());
    for (Eigen::Vector3f& rgb : reading.cells.value) rgb = rgb.cwiseProduct(Eigen::Vector3f(1.1f, 1, 0.9f)) * 1.2311f;
    const PrintDifference d = difference_of(print, {reading});
    CHECK(d.exposure_ev == Approx(0.3).margin(0.03));
    CHECK(d.cast[0] / d.cast[2] == Approx(1.1 / 0.9).epsilon(0.01));
    CHECK(d.print_spread_mm == Approx(0.06).margin(0.003));
    REQUIRE(d.causes.size() == 3);
    CHECK_THAT(d.causes[0], Contains("cast"));
    CHECK_THAT(d.causes[1], Contains("exposure") && Contains("brighter"));
    CHECK_THAT(d.causes[2], Contains("0.06 mm"));
    CHECK(d.as_taken > d.after_exposure);
    CHECK(d.after_exposure > d.after_cast);
    CHECK(d.after_cast > d.after_spread);
    CHECK(d.after_spread < 0.1);
}

TEST_CASE("what is left out is shown as it was photographed, and has no colour of a difference") {
    const PredictedPrint print = discs();
    PrintReading reading = reading_of(print);
    const std::size_t mirrored = print.index(70, 40), rim = print.index(0, 40);
    reading.cells.value[mirrored] = reading.cells.value[rim] = {3, 3, 3};
    reading.cells.good[mirrored] = 0;
    const PrintDifference d = difference_of(print, {reading});
    for (const std::size_t cell : {mirrored, rim}) {
        CHECK_FALSE(d.counts[cell]);
        CHECK(d.shown[cell][0] == Approx(3).margin(1e-3));
        CHECK(d.printed[cell] == print.rgb[cell]);
    }
    const std::size_t beside = print.index(71, 40);
    CHECK(d.counts[beside]);
    CHECK(d.shown[beside] == d.printed[beside]);
    CHECK_THAT(compare_page(print, {reading}, d, 300), Contains("</span> left out</span>"));
}

TEST_CASE("with a checker a cast is the print's own and counts") {
    const PredictedPrint print = discs();
    PrintReading reading = reading_of(print);
    for (Eigen::Vector3f& rgb : reading.cells.value) rgb = rgb.cwiseProduct(Eigen::Vector3f(1.1f, 1, 0.9f));
    CHECK(difference_of(print, {reading}).ciede2000.mean < 0.1);
    reading.has_checker = true;
    const PrintDifference d = difference_of(print, {reading});
    CHECK(d.ciede2000.mean > 2);
    CHECK_THAT(d.causes.at(0), Contains("by the colour checker"));
}

namespace {

/// Inks by which colours absorb, and a white that makes them lighter; by channel of linear sRGB, cell by cell.
Eigen::Vector3f by_extinction(const Eigen::Vector3f& rgb, std::size_t resin) {
    const Eigen::Vector3f absorbed = -rgb.array().log().matrix();
    const std::array<Eigen::Vector3f, 3> part{Eigen::Vector3f(-0.5f, -0.1f, -0.05f),
                                              Eigen::Vector3f(-0.05f, -0.5f, -0.15f),
                                              Eigen::Vector3f(0.3f, 0.3f, 0.3f)};
    return absorbed.cwiseProduct(part[resin]);
}

PredictedPrint discs_of_resins() {
    PredictedPrint print = discs();
    for (const char* role : {"C", "M", "W"}) print.set.resins.push_back({role, role, {1, 1, 1}, {0.5, 0.5, 0.5}});
    ResinResponse& r = print.response;
    r.columns = (print.columns + 3) / 4, r.rows = (print.rows + 3) / 4;
    r.channels = r.resins = 3;
    const std::size_t blocks = std::size_t(r.columns) * std::size_t(r.rows);
    r.value.assign(3 * blocks, 0.0f);
    r.by_extinction.assign(9 * blocks, 0.0f);
    std::vector<float> cells(blocks, 0.0f);
    const auto block_of = [&](int column, int row) {
        return std::size_t(row / 4) * std::size_t(r.columns) + std::size_t(column / 4);
    };
    for (int row = 0; row < print.rows; ++row)
        for (int column = 0; column < print.columns; ++column) cells[block_of(column, row)] += 1;
    for (int row = 0; row < print.rows; ++row)
        for (int column = 0; column < print.columns; ++column) {
            const std::size_t block = block_of(column, row);
            const Eigen::Vector3f rgb = print.rgb[print.index(column, row)];
            for (std::size_t c = 0; c < 3; ++c) {
                r.value[3 * block + c] += rgb[Eigen::Index(c)] / cells[block];
                for (std::size_t resin = 0; resin < 3; ++resin)
                    r.by_extinction[(block * 3 + resin) * 3 + c] +=
                        rgb[Eigen::Index(c)] * by_extinction(rgb, resin)[Eigen::Index(c)] / cells[block];
            }
        }
    return print;
}

}  // namespace

TEST_CASE("the resin whose extinction is off is named, and by how much") {
    const PredictedPrint print = discs_of_resins();
    for (std::size_t off = 0; off < 3; ++off) {
        PrintReading reading = reading_of(print);
        for (std::size_t cell = 0; cell < print.cells(); ++cell)
            reading.cells.value[cell] = reading.cells.value[cell].cwiseProduct(
                (0.1f * by_extinction(print.rgb[cell], off)).array().exp().matrix());
        // A lamp at one side, which no ground told of, is no resin; nor is a smear on a twentieth of the print.
        for (int row = 0; row < print.rows; ++row)
            for (int column = 0; column < print.columns; ++column) {
                Eigen::Vector3f& rgb = reading.cells.value[print.index(column, row)];
                rgb *= 1 + 0.1f * float(column) / float(print.columns);
                if (column < 20 && row < 30) rgb = rgb.cwiseProduct(Eigen::Vector3f(0.6f, 0.9f, 0.9f));
            }
        const PrintDifference d = difference_of(print, {reading});
        INFO(off << " " << d.hints.resins[off].change << " " << d.hints.resins[off].explained);
        REQUIRE(d.hints.named == off);
        CHECK(d.hints.resins[off].change == Approx(0.1).margin(0.02));
        CHECK(std::ranges::any_of(d.causes, [&](const std::string& cause) {
            return cause.starts_with("resin: " + print.resin(off)) && cause.find("larger") != std::string::npos;
        }));
    }
    const PrintDifference none = difference_of(print, {reading_of(print)});
    CHECK_FALSE(none.hints.named);
    CHECK(none.causes.empty());
}

TEST_CASE("tiles say what a person would") {
    PrintTile tile;
    tile.off_lab = {3.14, 0.2, -0.4};
    CHECK(tile_words(tile) == "printed 3.1 lighter than predicted");
    tile.off_lab = {-1, 0.4, -2.5};
    CHECK(tile_words(tile) == "printed 2.5 bluer and 1.0 darker than predicted");
    tile.off_lab = {0.1, 0.1, 0.1};
    CHECK(tile_words(tile) == "printed as predicted");
}

TEST_CASE("the worst places come first, and photographs are averaged") {
    const PredictedPrint print = discs();
    PrintReading bad = reading_of(print);
    for (int row = 40; row < 56; ++row)
        for (int column = 70; column < 90; ++column) bad.cells.value[print.index(column, row)] *= 1.5f;
    const PrintDifference one = difference_of(print, {bad});
    const PrintTile& worst = one.tiles.front();
    CHECK(worst.corner_mm.x() > 69 * 0.0847 - 0.7);
    CHECK(worst.corner_mm.x() < 90 * 0.0847);
    CHECK(worst.corner_mm.y() > 40 * 0.0847 - 0.7);
    CHECK(worst.corner_mm.y() < 56 * 0.0847);
    CHECK(worst.off_lab[0] > 1);
    CHECK_THAT(tile_words(worst), Contains("lighter"));
    const PrintDifference both = difference_of(print, {bad, reading_of(print)});
    CHECK(both.tiles.front().off_lab[0] < 0.8 * worst.off_lab[0]);
}
