// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs that cannot be measured, and what is said of them.
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "photo_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

struct Scene {
    Target target = target_of(TargetLayout::a);
    TargetColours colours = reflected_colours(target, optics::vero_opaque());
    CheckerChart chart = find_checker("colorchecker24");
    PhotoOptions options;
    Scene() {
        options.width_px = 900;
        options.height_px = 600;
        options.rays = 2;
        options.dust = options.scratches = 0;
    }
    [[nodiscard]] SimulatedPhoto photo() const { return simulate_photo(target, colours, chart, options); }
    [[nodiscard]] PhotoMeasurement measured(const Target& described) const {
        return measure_photo(photo().photograph, described, chart, {});
    }
};

std::array<Eigen::Vector2d, 4> four(const std::vector<Eigen::Vector2d>& points) {
    return {points[0], points[1], points[2], points[3]};
}

}  // namespace

TEST_CASE("a photograph without a target is refused") {
    const Scene scene;
    io::Photograph empty{"empty", 900, 600, io::SampleCoding::linear, 16, {}};
    for (std::size_t i = 0; i < 900 * 600; ++i)
        empty.pixels.emplace_back(Eigen::Vector3f::Constant(0.3f + 0.1f * float(i % 7)));
    CHECK_THROWS_WITH(measure_photo(std::move(empty), scene.target, scene.chart, {}),
                      Contains("no target found") && Contains("--corners"));
}

TEST_CASE("a blurred photograph is refused") {
    Scene scene;
    scene.options.blur_px = 5.5;  // no marker is seen
    CHECK_THROWS_WITH(scene.measured(scene.target), Contains("sharp"));
    // With corners by hand the markers are still told by their cells, and the blur is measured.
    scene.options.blur_px = 3.75;
    const SimulatedPhoto photo = scene.photo();
    PhotoMeasureOptions by_hand;
    by_hand.corners = four(photo.target_corners_px);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("blur"));
}

TEST_CASE("clipped channels are refused with the square and the channel") {
    Scene scene;
    scene.options.exposure = 1.6;
    CHECK_THROWS_WITH(scene.measured(scene.target),
                      Contains("square") && Contains("on W") && Contains("overexposed") && Contains("green"));
    scene.options.exposure = 1;
    CHECK_NOTHROW(scene.measured(scene.target));
}

TEST_CASE("an underexposed photograph is refused") {
    Scene scene;
    scene.options.exposure = 0.03;
    CHECK_THROWS_WITH(scene.measured(scene.target), Contains("underexposed"));
}

TEST_CASE("a photograph of another target is refused with both numbers") {
    Scene scene;
    const Target other = target_of(TargetLayout::a, {"M", "C", "Y", "K", "W"});
    CHECK_THROWS_WITH(scene.measured(other), Contains("another target") &&
                                                 Contains(std::to_string(scene.target.markers[0].id)) &&
                                                 Contains(std::to_string(other.markers[0].id)));
}

TEST_CASE("black and white exchanged in the printer are told from the markers") {
    Scene scene;
    Target exchanged = scene.target;
    std::swap(exchanged.light, exchanged.dark);
    for (TargetSquare& square : exchanged.squares) {
        square.backing.assign(1, square.backing == "W" ? 'K' : 'W');
        for (ResinShare& share : square.top)
            if (share.role == "W" || share.role == "K") share.role.assign(1, share.role == "W" ? 'K' : 'W');
    }
    scene.colours = reflected_colours(exchanged, optics::vero_opaque());
    const SimulatedPhoto photo = scene.photo();
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, {}),
                      Contains("exchanged") && Contains("W") && Contains("K"));
    PhotoMeasureOptions by_hand;
    by_hand.corners = four(photo.target_corners_px);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("exchanged"));
}

TEST_CASE("a mirrored print is told from the markers") {
    Scene scene;
    scene.options.mirrored = true;
    const SimulatedPhoto photo = scene.photo();
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, {}),
                      Contains("mirrored") && Contains("flip_x"));
    PhotoMeasureOptions by_hand;
    by_hand.corners = four(photo.target_corners_px);
    std::swap((*by_hand.corners)[0], (*by_hand.corners)[1]);
    std::swap((*by_hand.corners)[2], (*by_hand.corners)[3]);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("mirrored"));
}

TEST_CASE("corners by hand measure as markers do, and wrong ones are told") {
    Scene scene;
    scene.options.tilt_x_deg = 10;
    const SimulatedPhoto photo = scene.photo();
    PhotoMeasureOptions by_hand;
    by_hand.corners = four(photo.target_corners_px);
    for (Eigen::Vector2d& corner : *by_hand.corners) corner += Eigen::Vector2d(2, -1);  // as a hand points
    by_hand.checker_corners = four(photo.checker_corners_px);
    CHECK(worst_error(measure_photo(photo.photograph, scene.target, scene.chart, by_hand).rho, scene.colours) < 0.005);
    std::rotate(by_hand.corners->begin(), by_hand.corners->begin() + 1, by_hand.corners->end());
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("turned by"));
    by_hand.corners = four(photo.checker_corners_px);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("not the markers"));
}

TEST_CASE("a missing or wrong colour checker is refused") {
    Scene scene;
    scene.options.checker = false;
    CHECK_THROWS_WITH(scene.measured(scene.target), Contains("no colour checker") && Contains("--checker-corners"));
    scene.options.checker = true;
    const SimulatedPhoto photo = scene.photo();
    PhotoMeasureOptions by_hand;
    by_hand.checker_corners = four(photo.target_corners_px);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, by_hand), Contains("colours"));
}

TEST_CASE("a colour checker that is somewhat off is told, and one that is another's is refused") {
    Scene scene;
    const SimulatedPhoto photo = scene.photo();
    // Greens of every second patch by as much as no matrix of colours takes back.
    const auto aged = [&](double by) {
        CheckerChart chart = scene.chart;
        for (std::size_t p = 0; p < chart.linear_srgb.size(); ++p) chart.linear_srgb[p].y() += p % 2 ? by : -by;
        return measure_photo(photo.photograph, scene.target, chart, {}).warnings;
    };
    CHECK(aged(0).empty());
    const std::vector<std::string> told = aged(0.07);
    REQUIRE(told.size() == 1);
    CHECK_THAT(told[0], Contains("the checker's patches are still off by 0.0") && Contains("[checker-off]"));
    CHECK_THROWS_WITH(aged(0.15), Contains("another chart"));
}

TEST_CASE("three markers are enough and two are not") {
    Scene scene;
    SimulatedPhoto photo = scene.photo();
    const auto cover = [&](double x, double y) {  // a finger on the slab, 14 mm
        const Rectification place =
            Rectification::fit(std::array{Eigen::Vector2d(0, scene.target.size_mm.y()), scene.target.size_mm,
                                          Eigen::Vector2d(scene.target.size_mm.x(), 0), Eigen::Vector2d(0, 0)},
                               photo.target_corners_px);
        for (std::uint32_t v = 0; v < photo.photograph.height_px; ++v)
            for (std::uint32_t u = 0; u < photo.photograph.width_px; ++u)
                if ((place.from_px({u + 0.5, v + 0.5}) - Eigen::Vector2d(x, y)).norm() < 7)
                    photo.photograph.pixels[photo.photograph.index(u, v)] = {0.3f, 0.25f, 0.15f};
    };
    cover(3, 3);
    const PhotoMeasurement m = measure_photo(photo.photograph, scene.target, scene.chart, {});
    CHECK(m.view.markers == 3);
    CHECK(worst_error(m.rho, scene.colours) < 0.005);
    REQUIRE_FALSE(m.warnings.empty());
    CHECK_THAT(m.warnings.back(), Contains("[markers]"));
    cover(scene.target.size_mm.x() - 3, 3);
    CHECK_THROWS_WITH(measure_photo(photo.photograph, scene.target, scene.chart, {}), Contains("2 of the markers"));
}

TEST_CASE("samples that do not say what they mean are told by the checker's greys") {
    Scene scene;
    io::Photograph photo = scene.photo().photograph;
    photo.coding = io::SampleCoding::unknown;
    CHECK(worst_error(measure_photo(photo, scene.target, scene.chart, {}).rho, scene.colours) < 0.005);
    for (Eigen::Vector3f& pixel : photo.pixels)
        for (float& value : pixel)
            value = float(value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1 / 2.4f) - 0.055f);
    const PhotoMeasurement m = measure_photo(photo, scene.target, scene.chart, {});
    CHECK(worst_error(m.rho, scene.colours) < 0.005);
    CHECK_THAT(m.warnings.back(), Contains("sRGB") && Contains("[coding-guessed]"));
    PhotoMeasureOptions wrong;
    wrong.coding = io::SampleCoding::linear;
    CHECK_THROWS_WITH(measure_photo(photo, scene.target, scene.chart, wrong), Contains("tone curve"));
}

TEST_CASE("several photographs are averaged and their spread is told") {
    Scene scene;
    std::vector<PhotoMeasurement> photos;
    for (const std::uint64_t seed : {1, 2, 3}) {
        scene.options.seed = seed;
        scene.options.turn_deg = 20.0 * double(seed);
        photos.push_back(scene.measured(scene.target));
    }
    const MeasuredTable mean = average_photos(photos, scene.target);
    CHECK(mean.warnings.empty());
    for (std::size_t s = 0; s < mean.table.patches.size(); ++s)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            CHECK(std::abs(mean.table.patches[s].rho[channel] - scene.colours.squares[s][Eigen::Index(channel)]) <
                  0.005);
            CHECK(mean.spread[s][Eigen::Index(channel)] > 0);
        }
    photos[1].rho[4] += Eigen::Vector3d::Constant(0.1);
    CHECK_THAT(average_photos(photos, scene.target).warnings.at(0), Contains("square 5"));
}
