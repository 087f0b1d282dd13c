// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/body_reading.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "body_samples.h"
#include "calibration/compare/print_difference.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

/// How far places of the body that the camera sees are off in the picture, in cells: root of the mean square.
double off_in_cells(const PrintReading& found, const PredictedBody& body, const optics::CameraView& view) {
    const auto point = [](const Eigen::Vector3d& p) { return optics::Point{p.x(), p.y(), p.z()}; };
    const optics::Camera truth(view), as_found({.position = point(found.camera->position),
                                                .target = point(found.camera->look_at),
                                                .up = point(found.camera->up),
                                                .focal_mm = found.camera->focal_mm,
                                                .width_px = view.width_px,
                                                .height_px = view.height_px});
    const Eigen::Vector3d from(view.position[0], view.position[1], view.position[2]);
    double squares = 0, seen = 0;
    for (std::size_t i = 0; i < body.position.size(); ++i) {
        const Eigen::Vector3d p = body.position[i].cast<double>(), n = body.normal[i].cast<double>();
        if (n.dot((from - p).normalized()) < 0.4 || hit(p + 0.01 * n, (from - p).normalized())) continue;
        const auto a = truth.picture_of(point(p)), b = as_found.picture_of(point(p));
        squares += std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2);
        ++seen;
    }
    return std::sqrt(squares / seen) / found.found.place.px_per_cell();
}

std::string refused(const io::Photograph& photo, const PredictedBody& body) {
    try {
        (void)read_body(photo, body, io::SampleCoding::linear);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("a body is found to a quarter of a cell, and is what was predicted, whatever its gloss and the light on it",
          "[slow]") {
    const PredictedBody body = eared_body();
    for (const double gloss : {0.0, 1.0}) {
        BodyPhoto o = hand_photo();
        o.gloss = gloss;
        const BodyReading read = read_body(photo_of(o), body, io::SampleCoding::linear);
        INFO(gloss);
        CHECK(off_in_cells(read.reading, body, o.view) < 0.25);
        CHECK(read.reading.found.correlation > 0.9);
        CHECK(read.reading.overlap > 0.95);
        const double mean = difference_of(read.print, {read.reading}).ciede2000.mean;
        CHECK(mean < 0.7);
        WANTED(mean < 0.4);
    }
}

TEST_CASE("photographs of other bodies, other sides and mirrored ones are told apart", "[slow]") {
    const PredictedBody body = eared_body();
    BodyPhoto o = hand_photo();
    PredictedBody from_behind = body;
    from_behind.start = body.other_sides[1].start;
    CHECK_THAT(refused(photo_of(o), from_behind), Contains("seen from another side: --view front"));

    io::Photograph mirrored = photo_of(o);
    for (std::uint32_t y = 0; y < mirrored.height_px; ++y)
        std::reverse(mirrored.pixels.begin() + y * mirrored.width_px,
                     mirrored.pixels.begin() + (y + 1) * mirrored.width_px);
    CHECK_THAT(refused(mirrored, body), Contains("the print is mirrored"));

    o.pattern = 2;
    CHECK_THAT(refused(photo_of(o), body), Contains("is no photograph of out/eared"));
}

TEST_CASE("it is told where little of a body counts", "[slow]") {
    const PredictedBody body = eared_body();
    BodyPhoto o = hand_photo();
    o.gain *= 2.8;  // more than half of what would count is clipped
    const BodyReading read = read_body(photo_of(o), body, io::SampleCoding::linear);
    INFO(read.reading.left_out << " " << read.reading.clipped);
    REQUIRE(read.reading.warnings.size() == 1);
    CHECK_THAT(read.reading.warnings.front(),
               Contains("of what is seen of the body were left out") && Contains("[body-left-out]"));
}
