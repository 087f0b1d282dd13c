// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/lost_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "drawn_page.h"
#include "slicer/colour/whole_verdict.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Like fur: hairs so many a millimetre, none quite like its neighbour.
float fur(double x, double y, double waves) {
    return float(std::sin(2 * pi * waves * (x + 0.2 * std::sin(y))) *
                 std::sin(2 * pi * waves * (y + 0.3 * std::sin(x))));
}

/// Of a page of 10 x 8 mm that is lighter from left to right, on whose left half there is fur of this light.
JobPrediction furred(double waves, float light = 0.4f, float contrast = 0.5f) {
    return test::page_of(10, 8, [=](double x, double y) {
        const float shade = 1 + 0.06f * float(x - 5);
        return Eigen::Vector3f::Constant(light * (shade + (x < 5 ? contrast * fur(x, y, waves) : 0)));
    });
}

/// Printed with this part of its contrast, and with grain.
void print_with(JobPrediction& p, float part, float light = 0.4f, float grain = 0) {
    RandomStream draw(11, 3);
    for (std::size_t i = 0; i < p.target.size(); ++i) {
        const float off = grain * light * float(draw.uniform() - 0.5);
        p.predicted.rgb[i] =
            Eigen::Vector3f::Constant(light + off) + part * (p.target[i] - Eigen::Vector3f::Constant(light));
    }
}

std::vector<double> areas_of(const JobPrediction& p) {
    std::vector<double> areas;
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells) areas.push_back(double(cell.area_mm2));
    return areas;
}

std::optional<LostTexture> lost_on(JobPrediction& p, double distance_mm = 300) {
    p.seen = seen_from(p, distance_mm, false);
    return lost_texture(p.predicted.surface, p.seen.texture, areas_of(p));
}

}  // namespace

TEST_CASE("Of a texture that is printed paler its place is told, and how much of its contrast is kept") {
    for (const float part : {0.0f, 0.15f, 0.3f, 0.45f})
        for (const float grain : {0.0f, 0.2f}) {
            CAPTURE(part, grain);
            JobPrediction p = furred(1);
            print_with(p, part, 0.4f, grain);
            const auto lost = lost_on(p);
            REQUIRE(lost);
            CHECK(lost->kept == Approx(double(part)).margin(0.04));
            CHECK(lost->seen_share == Approx(0.5).margin(0.08));
            CHECK(lost->area_mm2 == Approx(40).margin(7));
            double middle = 0;
            for (const std::uint32_t i : lost->cells)
                middle += double(p.predicted.surface.cells[i].centre_mm[0]) / double(lost->cells.size());
            CHECK(middle < 3);
        }
}

TEST_CASE("A texture that is there is not lost, nor is one that nobody sees") {
    const auto is_lost = [](JobPrediction p, float part, float light, double distance_mm = 300) {
        print_with(p, part, light);
        return lost_on(p, distance_mm).has_value();
    };
    CHECK_FALSE(is_lost(furred(1), 1, 0.4f));
    CHECK_FALSE(is_lost(furred(1), 0.6f, 0.4f));
    CHECK(is_lost(furred(1), 0.2f, 0.4f));
    // Finer than the eye sees; seen from nearer it is.
    CHECK_FALSE(is_lost(furred(3), 0, 0.4f));
    CHECK(is_lost(furred(3), 0, 0.4f, 100));
    // So faint, or so dark in a room's light, that there is nothing to lose.
    CHECK_FALSE(is_lost(furred(1, 0.4f, 0.04f), 0, 0.4f));
    CHECK_FALSE(is_lost(furred(1, 0.4f, 0.04f), -3, 0.4f));
    CHECK_FALSE(is_lost(furred(1, 0.0008f), 0, 0.0008f));
    // A corner of a print is no matter of the whole.
    JobPrediction p = test::page_of(10, 8, [](double x, double y) {
        return Eigen::Vector3f::Constant(0.4f *
                                         (1 + 0.06f * float(x - 5) + (x < 0.5 && y < 0.5 ? 0.5f * fur(x, y, 1) : 0)));
    });
    CHECK_FALSE(is_lost(std::move(p), 0, 0.4f));
}

TEST_CASE("Flat areas, their edges and letters are no texture, however they are printed") {
    for (const double square_mm : {1.3, 2.0}) {
        JobPrediction p = test::page_of(10, 8, [&](double x, double y) {
            return Eigen::Vector3f::Constant((int(x / square_mm) + int(y / square_mm)) % 2 ? 0.2f : 0.6f);
        });
        print_with(p, 0.1f);
        CHECK_FALSE(lost_on(p));
    }
    // As wide a way from one to the other as a picture of few pixels has.
    JobPrediction soft = test::page_of(12, 12, [](double x, double y) {
        const auto stripe = [](double at) {
            return std::clamp((std::abs(std::fmod(at, 6) - 3) - 1.25) / 0.5, 0.0, 1.0);
        };
        return Eigen::Vector3f::Constant(float(0.2 + 0.4 * stripe(x) * stripe(y)));
    });
    print_with(soft, 0.1f);
    CHECK_FALSE(lost_on(soft));
    const test::SetLine line("Serial 00417-B", 9, 1, 3);
    JobPrediction page =
        test::page_of(24, 8, [&](double x, double y) { return Eigen::Vector3f::Constant(1 - 0.99f * line.at(x, y)); });
    print_with(page, 0.2f, 1);
    CHECK_FALSE(lost_on(page));
}

TEST_CASE("A print whose texture is lost over more than a tenth of it is fair, and no worse for that alone") {
    const VerdictLimits limits;
    JobPrediction p = furred(1);
    print_with(p, 0.2f);
    const auto lost = lost_on(p);
    REQUIRE(lost);
    std::vector<char> spoilt(p.target.size(), 0);
    for (const std::uint32_t i : lost->cells) spoilt[i] = 1;
    const std::vector<double> near(p.target.size(), 1.0);
    CHECK(judge_whole(near, areas_of(p), {}, limits).level == io::VerdictLevel::good);
    const WholeVerdict whole = judge_whole(near, areas_of(p), spoilt, limits);
    CHECK(whole.level == io::VerdictLevel::fair);
    CHECK(whole.wrong_share == Approx(lost->seen_share));
    CHECK_THAT(opening_of(whole, limits), Catch::Matchers::Contains("is flecked or blurred"));
}
