// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/orientations.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "slicer/options/option_values.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using voxtone::test::body_of;
using voxtone::test::SampleJob;

namespace {

Matrix3d turn_of(const std::string& rotate) {
    return rotate.empty() ? Matrix3d(Matrix3d::Identity()) : parse_rotation(rotate);
}

/// Two of the triangles of `shapes::box` make each side: -z, +z, -y, +y, -x, +x.
const Vector3d side_normal[] = {{0, 0, -1}, {0, 0, 1}, {0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}};

/// A box whose sides are coloured where it is said, else white; 1 mm of light grey is white still.
std::vector<Vector3f> coloured_sides(const std::vector<std::size_t>& sides) {
    std::vector<Vector3f> rgb(12, Vector3f::Constant(0.95f));
    for (const std::size_t side : sides) rgb[2 * side] = rgb[2 * side + 1] = Vector3f(1, 1, 0.5f);
    return rgb;
}

double side_area(const Vector3d& size, std::size_t side) {
    return size.prod() / size.dot(side_normal[side].cwiseAbs());
}

}  // namespace

TEST_CASE("Each way to turn a box is another, and lays the sides down that its turn does, and the best comes first") {
    const Vector3d size(12, 8, 5);
    const std::vector<std::size_t> coloured{0, 3};  // below, and behind
    for (int mirrors = 0; mirrors < 8; ++mirrors) {
        CAPTURE(mirrors);
        SampleJob sample;
        sample.options.flip_x = mirrors & 1, sample.options.flip_y = mirrors & 2, sample.options.swap_xy = mirrors & 4;
        Matrix3d mirror = Matrix3d::Identity();  // the swap comes first, then the flips
        if (mirrors & 4) mirror = (Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, 1).finished() * mirror;
        if (mirrors & 1) mirror = Vector3d(-1, 1, 1).asDiagonal() * mirror;
        if (mirrors & 2) mirror = Vector3d(1, -1, 1).asDiagonal() * mirror;
        // The body as the job has placed it.
        SolidMesh placed = shapes::moved(shapes::box(Vector3d::Zero(), size), Eigen::Affine3d(mirror));
        if (mirror.determinant() < 0) placed = shapes::flipped(placed);
        const OpenedJob job = sample.opened();
        const JobBody body = body_of(placed, job.printer.sliced_pitch_mm(), coloured_sides(coloured));
        const std::vector<Orientation> found = orientations(job, body, Progress());
        REQUIRE(found.size() == 12);
        // What tells them apart: the side that lies down, and how wide the print is then.
        std::set<std::vector<long>> keys;
        for (const Orientation& orientation : found) {
            CAPTURE(orientation.rotate);
            // As the job that is asked for this would place the file's box.
            const Matrix3d map = mirror * turn_of(orientation.rotate);
            const Vector3d extent = (map * size).cwiseAbs();
            double down = 0, coloured_down = 0;
            for (std::size_t side = 0; side < 6; ++side) {
                if ((map * side_normal[side]).z() > -0.99) continue;
                keys.insert({long(side), std::lround(extent.x())});
                down += side_area(size, side);
                if (std::count(coloured.begin(), coloured.end(), side)) coloured_down += side_area(size, side);
            }
            for (int axis = 0; axis < 3; ++axis) CHECK(orientation.size_mm[std::size_t(axis)] == Approx(extent[axis]));
            CHECK(orientation.layers == std::lround(extent.z() / job.printer.sliced_pitch_mm().z()));
            CHECK(orientation.fits);
            CHECK(orientation.under_ml == 0);
            // 50,000 pieces of equal area: the root of their number, four times.
            const double error = 4 * std::sqrt(down / 392 / 50'000) * 392;
            CHECK(std::abs(orientation.downward_mm2 - down) < error);
            CHECK(std::abs(orientation.coloured_down_mm2 - coloured_down) < error);
        }
        CHECK(keys.size() == 12);
        CHECK(std::ranges::count_if(found, &Orientation::as_it_is) == 1);
        for (std::size_t n = 1; n < found.size(); ++n) {
            const Orientation &before = found[n - 1], &after = found[n];
            CHECK(before.coloured_down_mm2 <= after.coloured_down_mm2 + 0.01 * 392);
            if (before.coloured_down_mm2 == after.coloured_down_mm2) CHECK(before.layers <= after.layers);
        }
        // Neither coloured side lies down, and the thinnest way that does so is with the white top down.
        const auto advice = advised_orientation(found, 392);
        REQUIRE(advice);
        CHECK(advice->rotate == found.front().rotate);
        CHECK((mirror * turn_of(advice->rotate) * side_normal[1]).z() < -0.99);
        CHECK_THAT(advice->reason, Catch::Contains("0.00 cm2") && Catch::Contains("instead of 0.9"));
    }
}

TEST_CASE("What a turn costs in time is told where it is a tenth or more, against the job's own and the fastest way") {
    const auto advice = [](Orientation best, std::vector<Orientation> others) {
        others.insert(others.begin(), std::move(best));
        return advised_orientation(others, 100).value().reason;
    };
    const Orientation turned{.rotate = "x90", .layers = 100, .passes = 100, .under_ml = 1},
        own{.rotate = "", .layers = 105, .passes = 105, .under_ml = 2, .as_it_is = true};
    const auto times = Catch::Contains("times its printing time"), fewer = Catch::Contains("100 layers instead of");
    CHECK_THAT(advice(turned, {own}), fewer && Catch::Contains("and is lower") && !times);
    Orientation slow = own;
    slow.layers = slow.passes = 50;
    CHECK_THAT(advice(turned, {slow}), Catch::Contains("some 2 times its printing time") && fewer &&
                                           Catch::Contains("as it is prints in some 50 % of that time (50 layers)"));
    // Passes decide where they are known, and what does not fit is no way.
    slow.passes = 95;
    CHECK_THAT(advice(turned, {slow}), fewer && !times && !Catch::Contains("of that time"));
    slow.passes = 50, slow.fits = false;
    CHECK_THAT(advice(turned, {slow}),
               Catch::StartsWith("it does not fit as it is") && !Catch::Contains("of that time"));
    // The job's own way is compared with no other of its own.
    CHECK_THAT(advice(own, {turned}), Catch::StartsWith("no other way") && !times && !Catch::Contains("instead of"));
}

TEST_CASE("A body that is turned is too high for a printer before it is too wide for it") {
    SampleJob sample;
    const OpenedJob job = sample.opened();
    const Vector3d tray = job.printer.sliced_tray_mm();
    REQUIRE(tray.z() < tray.x());
    // Lies, and does not stand.
    const Vector3d size(tray.x() - 1, 30, 0.5 * tray.z());
    const JobBody body = body_of(shapes::box(Vector3d::Zero(), size), Vector3d::Constant(1));
    std::size_t fitting = 0;
    for (const Orientation& orientation : orientations(job, body, Progress())) {
        const std::array<double, 3>& mm = orientation.size_mm;
        CHECK(orientation.fits == (mm[0] <= tray.x() && mm[1] <= tray.y() && mm[2] <= tray.z()));
        fitting += orientation.fits;
    }
    CHECK(fitting > 0);
    CHECK(fitting < 12);
    // One that is longer than the tray is wide fits no way, not even along it.
    const JobBody beam = body_of(shapes::box(Vector3d::Zero(), Vector3d(tray.x() + 5, 30, 30)), Vector3d::Constant(1));
    for (const Orientation& orientation : orientations(job, beam, Progress())) CHECK_FALSE(orientation.fits);
}

TEST_CASE("Each way to turn a body has its picture from the front, as wide and as high as it stands there") {
    const OpenedJob job = SampleJob().opened();
    const Vector3d size(12, 8, 5);
    for (const Orientation& orientation :
         orientations(job, body_of(shapes::box(Vector3d::Zero(), size), Vector3d::Constant(1)), Progress())) {
        CAPTURE(orientation.rotate);
        REQUIRE_FALSE(orientation.front.empty());
        // A letter of the picture is a column of two halves, as wide as each is high.
        std::size_t columns = 0, halves = 0, filled = 0;
        for (const std::string& line : orientation.front) {
            std::size_t in_line = 0;
            for (std::size_t at = 0; at < line.size(); ++in_line)
                if (const std::string letter = line.substr(at, line[at] == ' ' ? 1 : 3); letter == " ")
                    ++at;
                else
                    filled += letter == "\u2588" ? 2 : 1, at += 3;
            columns = std::max(columns, in_line), halves += 2;
        }
        const double aspect = orientation.size_mm[0] / orientation.size_mm[2];
        CHECK(double(columns) / double(halves) == Approx(aspect).epsilon(0.35));
        CHECK(double(filled) > 0.7 * double(columns * (halves - 1)));
    }
}

TEST_CASE("A body that is as wide as deep has no quarter turns about the upright, and a cube six ways in all") {
    const OpenedJob job = SampleJob().opened();
    const auto of = [&](const Vector3d& size) {
        return orientations(job, body_of(shapes::box(Vector3d::Zero(), size), Vector3d::Constant(1)), Progress());
    };
    CHECK(of({20, 20, 30}).size() == 2 + 4 * 2);
    CHECK(of({20, 20, 20}).size() == 6);
}

TEST_CASE("The advice says what is better: that it fits, colour kept off support, height, or less to support") {
    const Orientation own{
        .rotate = "", .size_mm = {}, .layers = 300, .under_ml = 2, .coloured_down_mm2 = 500, .as_it_is = true};
    Orientation other = own;
    other.rotate = "x90", other.as_it_is = false;
    const auto advice = [](const Orientation& first, const Orientation& second) {
        return advised_orientation(std::vector{first, second}, 1000);
    };
    CHECK(advice(own, other)->rotate.empty());
    CHECK_THAT(advice(own, other)->reason, Catch::StartsWith("no other way"));
    other.under_ml = 1;
    CHECK(advice(other, own)->rotate == "x90");
    CHECK_THAT(advice(other, own)->reason, Catch::Contains("1.00 ml instead of 2.00"));
    other.layers = 200;
    CHECK_THAT(advice(other, own)->reason, Catch::Contains("is lower; 200 layers instead of 300") &&
                                               Catch::Contains("some 0.67 times its printing time"));
    // What the advice costs is said with it: the fastest way, with its colour on support. Passes tell, not layers.
    Orientation quick = own;
    quick.rotate = "y90", quick.as_it_is = false, quick.layers = 100, quick.coloured_down_mm2 = 900;
    CHECK_THAT(advised_orientation(std::vector{other, own, quick}, 1000)->reason,
               Catch::Contains("--rotate y90 prints in some 50 % of that time (100 layers), with 9.00 cm2"));
    CHECK_THAT(advised_orientation(std::vector{own, quick}, 1000)->reason, Catch::Contains("33 % of that time"));
    quick.passes = 600, other.passes = 200, quick.fits = true;
    CHECK_THAT(advised_orientation(std::vector{other, own, quick}, 1000)->reason, !Catch::Contains("y90"));
    other.passes = quick.passes = 0, quick.fits = false;
    CHECK_THAT(advised_orientation(std::vector{other, own, quick}, 1000)->reason, !Catch::Contains("y90"));
    other.coloured_down_mm2 = 100;
    CHECK_THAT(advice(other, own)->reason,
               Catch::Contains("1.00 cm2 of coloured surface") && Catch::Contains("5.00 cm2"));
    Orientation large = own;
    large.fits = false;
    CHECK_THAT(advice(other, large)->reason, Catch::StartsWith("it does not fit as it is"));
    other.fits = false;
    CHECK_FALSE(advice(other, large));
    CHECK_FALSE(advised_orientation({}, 1000));
}

TEST_CASE("Air under a body is what lies below its overhang") {
    // A mushroom: a stem of 2 x 2 x 4 under a cap of 6 x 6 x 2.
    const SolidMesh mushroom = shapes::joined(shapes::box({2, 2, 0}, {4, 4, 4}), shapes::box({0, 0, 4}, {6, 6, 6}));
    const OpenedJob job = SampleJob().opened();
    const JobBody body = body_of(mushroom, Vector3d::Constant(0.1));
    for (const Orientation& orientation : orientations(job, body, Progress())) {
        CAPTURE(orientation.rotate);
        const Vector3d up = turn_of(orientation.rotate).transpose() * Vector3d::UnitZ();  // of the mushroom as it is
        // Upright: below the cap beside the stem. On its head: nothing. On its side: the stem lies over a hollow as
        // wide as itself and as long, 2 mm high.
        const double wanted = up.z() > 0.5 ? (36 - 4) * 4 : up.z() < -0.5 ? 0 : 2 * 4 * 2;
        // A grid of 1 % of its 6 mm, half a voxel off on each side.
        CHECK(orientation.under_ml == Approx(wanted * 1e-3).epsilon(0.06).margin(1e-9));
    }
}
