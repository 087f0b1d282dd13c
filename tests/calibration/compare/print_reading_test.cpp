// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_reading.h"

#include <catch2/catch.hpp>

#include "calibration/compare/print_difference.h"
#include "compare_samples.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

const CheckerChart& no_chart() {
    static const CheckerChart chart = find_checker("colorchecker24");
    return chart;
}

SimulatedPhoto photo_of(const PredictedPrint& print, const PhotoOptions& o, double blur_mm = 0) {
    return simulate_photo(thing_of(print, blur_mm), no_chart(), o);
}

/// The largest distance, in cells, between where cells were found and where they are, of those that are compared (not
/// the border of 0.3 mm).
double worst_place(const FoundPrint& found, const SimulatedPhoto& photo, const PredictedPrint& print) {
    double worst = 0;
    for (int j = 0; j <= 8; ++j)
        for (int i = 0; i <= 12; ++i) {
            const Eigen::Vector2d cell(4 + (print.columns - 8) * i / 12.0, 4 + (print.rows - 8) * j / 8.0);
            const Eigen::Vector2d mm = cell.cwiseProduct(print.cell_mm);
            const Eigen::Vector2d truth = photo.to_px({mm.x(), print.rows * print.cell_mm.y() - mm.y()});
            worst = std::max(worst, (found.place.to_px(cell) - truth).norm() / found.place.px_per_cell());
        }
    return worst;
}

std::string refusal(const io::Photograph& photo, const PredictedPrint& print, const ReadPrintOptions& options = {}) {
    try {
        (void)read_print(photo, print, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("a print is found to a quarter of a cell: tilted by 20 degrees, behind a lens, in uneven light") {
    const PredictedPrint print = discs();
    for (const double turn : {4.0, 94.0, 184.0, 274.0}) {
        PhotoOptions o = hand_camera();
        o.turn_deg = turn;
        const SimulatedPhoto photo = photo_of(print, o);
        const PrintReading reading = read_print(photo.photograph, print, {});
        INFO(turn);
        CHECK(worst_place(reading.found, photo, print) < 0.25);
        CHECK(reading.found.correlation > 0.9);
        CHECK(reading.light_from_ground);
        CHECK(reading.warnings.empty());
        CHECK(reading.light_falls_to < 0.97);
        CHECK(reading.found.turned_deg % 180 == (int(turn) / 90 * 90) % 180);
    }
}

TEST_CASE("a finger's shadow on one corner hardly moves a place, and counts where it lies") {
    const PredictedPrint print = discs();
    const FlatThing lit = thing_of(print);
    // Half the light at the lower left corner, all of it 4 mm away.
    const FlatThing shaded{lit.size_mm, [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
                               return lit.at(p) * (0.5 + 0.5 * std::min(p.norm() / 4, 1.0));
                           }};
    const SimulatedPhoto photo = simulate_photo(shaded, no_chart(), hand_camera());
    const PrintReading reading = read_print(photo.photograph, print, {});
    WANTED(worst_place(reading.found, photo, print) < 0.25);  // 0.26, in the shade
    CHECK(worst_place(reading.found, photo, print) < 0.3);
    const PrintDifference d = difference_of(print, {reading});
    CHECK(d.ciede2000.median < 1);
    CHECK(d.tiles.front().corner_mm.x() < 2);
    CHECK(d.tiles.front().corner_mm.y() > 6);
    CHECK_THAT(tile_words(d.tiles.front()), Contains("darker"));
    REQUIRE(reading.warnings.size() == 1);
    CHECK_THAT(reading.warnings.front(), Contains("lower left corner") && Contains("[shaded-corner]"));
}

TEST_CASE("a print that is like its prediction in parts only is refused") {
    const PredictedPrint print = discs();
    PredictedPrint other = print;
    const PredictedPrint foreign = discs(2);
    for (int row = 0; row < print.rows; ++row)
        for (int column = print.columns * 11 / 20; column < print.columns; ++column)
            other.rgb[print.index(column, row)] = foreign.rgb[print.index(column, row)];
    CHECK_THROWS_WITH(read_print(photo_of(other, hand_camera()).photograph, print, {}), Contains("in parts only"));
}

TEST_CASE("a print that is as predicted differs by little, whatever the camera") {
    const PredictedPrint print = discs();
    const PrintReading reading = read_print(photo_of(print, hand_camera()).photograph, print, {});
    const PrintDifference d = difference_of(print, {reading});
    // Cell by cell: no eye takes the noise out, nor the blur at every edge.
    WANTED(d.ciede2000.mean < 0.4);
    CHECK(d.ciede2000.mean < 0.8);
    CHECK(d.print_spread_mm < 0.03);
}

TEST_CASE("corners given by hand do as well, in any order round the print") {
    const PredictedPrint print = discs();
    PhotoOptions o = hand_camera();
    o.sheet = 0.7;  // as light as the print
    const SimulatedPhoto photo = photo_of(print, o);
    ReadPrintOptions options;
    options.corners = {photo.target_corners_px[2], photo.target_corners_px[1], photo.target_corners_px[0],
                       photo.target_corners_px[3]};
    for (Eigen::Vector2d& corner : *options.corners) corner += Eigen::Vector2d(5, -4);
    CHECK(worst_place(read_print(photo.photograph, print, options).found, photo, print) < 0.25);
    std::swap((*options.corners)[0], (*options.corners)[1]);
    CHECK_THAT(refusal(photo.photograph, print, options), Contains("--corners") && Contains("one after the other"));
}

TEST_CASE("what is wrong with a photograph of a print is told in a sentence") {
    const PredictedPrint print = discs();
    CHECK_THAT(refusal(photo_of(discs(2), hand_camera()).photograph, print),
               Contains("no photograph of out/discs") && Contains("--corners"));
    PhotoOptions o = hand_camera();
    o.mirrored = true;
    CHECK_THAT(refusal(photo_of(print, o).photograph, print), Contains("mirrored") && Contains("along x"));
    o = hand_camera();
    o.width_px = 180, o.height_px = 140;
    CHECK_THAT(refusal(photo_of(print, o).photograph, print), Contains("too small") && Contains("--cell"));
    o = hand_camera();
    o.exposure = 0.01;
    CHECK_THAT(refusal(photo_of(print, o).photograph, print), Contains("expose"));
    o = hand_camera();
    o.exposure = 3;
    CHECK_THAT(refusal(photo_of(print, o).photograph, print), Contains("out/discs") || Contains("overexposed"));
    o = hand_camera();
    o.margin = 0;
    CHECK_THAT(refusal(photo_of(print, o).photograph, print), Contains("--corners"));
    PredictedPrint stretched = print;
    stretched.cell_mm.x() *= 1.6;
    CHECK_THAT(refusal(photo_of(stretched, hand_camera()).photograph, print), Contains("to 1"));
    PredictedPrint plain = print;
    plain.rgb.assign(plain.rgb.size(), Eigen::Vector3f(0.5f, 0.5f, 0.5f));
    CHECK_THAT(refusal(photo_of(plain, hand_camera()).photograph, plain), Contains("of one colour"));
}

TEST_CASE("a checker beside the print tells the camera's colours from the print's") {
    const PredictedPrint print = discs();
    PhotoOptions o = hand_camera();
    o.checker = true;
    o.checker_cell_mm = 2.5;
    o.margin = 0.1;
    o.lens = 0;
    o.matrix = 1;  // sensor's colours
    o.white_balance = {0.62, 1, 0.75};
    ReadPrintOptions options;
    options.checker = no_chart();
    const SimulatedPhoto photo = photo_of(print, o);
    const PrintReading reading = read_print(photo.photograph, print, options);
    CHECK(reading.has_checker);
    const PrintDifference d = difference_of(print, {reading});
    CHECK(d.cast[0] == Approx(1).margin(0.03));
    CHECK(d.cast[2] == Approx(1).margin(0.03));
    // The same camera, were its colours those of the print: what is left is of its lens, its noise and its pixels.
    PhotoOptions plain = o;
    plain.matrix = 0;
    plain.white_balance = {1, 1, 1};
    const double best = difference_of(print, {read_print(photo_of(print, plain).photograph, print, {})}).ciede2000.mean;
    INFO(best << " with the print's colours, " << d.ciede2000.mean << " by the checker");
    // Without it the sensor's colours are taken for the print's.
    const double without = difference_of(print, {read_print(photo.photograph, print, {})}).ciede2000.mean;
    CHECK(d.ciede2000.mean - best < 0.5 * (without - best));
    WANTED(d.ciede2000.mean < best + 0.5);  // discs are more saturated than the chart's squares: 1.3 was found
}
