// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "optics/media/resins.h"
#include "optics/profiles/saunderson.h"
#include "slicer/predict/parts_in_sight.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr double pitch = 0.05, eta = 1.5;
constexpr std::array<int, 3> cell{1, 1, 1};

/// A body in voxels of `pitch`, and its whole surface.
struct Body {
    optics::ResinVolume volume;
    optics::Surface surface;

    Body(const std::array<int, 3>& size, const std::function<bool(double x, double y, double z)>& holds)
        : volume(optics::make_resin_volume(size, {pitch, pitch, pitch},
                                           [&](int x, int y, int z) {
                                               return holds((x + 0.5) * pitch, (y + 0.5) * pitch, (z + 0.5) * pitch)
                                                          ? optics::Material{1}
                                                          : optics::air;
                                           })),
          surface(optics::find_surface({&volume, &resins(), optics::Backing::none, optics::Sides::open}, cell,
                                       optics::SurfacePart::all)) {}

private:
    static const optics::ResinSet& resins() {
        static const optics::ResinSet set = optics::vero_opaque();
        return set;
    }
};

Body ball() {
    return {{60, 60, 60}, [](double x, double y, double z) { return std::hypot(x - 1.5, y - 1.5, z - 1.5) < 1.4; }};
}

constexpr double pit_radius = 1.5, open_share = 0.25;

/// A block with a pit of the shape of a ball, of whose surface a quarter is missing.
Body pitted_block() {
    constexpr double top = 3.2, height = top - pit_radius + 2 * pit_radius * open_share;
    return {{80, 80, 64},
            [](double x, double y, double z) { return std::hypot(x - 2, y - 2, z - height) > pit_radius; }};
}

bool in_pit(const optics::SurfaceCell& c) {
    const auto x = static_cast<double>(c.centre_mm[0]), y = static_cast<double>(c.centre_mm[1]),
               z = static_cast<double>(c.centre_mm[2]);
    return std::hypot(x - 2, y - 2) < pit_radius + pitch && z > 0.5 &&
           z < 2.8;  // not the rim, whose steps are as high as it is
}

}  // namespace

TEST_CASE("A ball sees nothing but the sky, its steps do not shade it") {
    const Body body = ball();
    const PartsInSight parts(body.volume, body.surface);
    const std::vector<float> open = parts.open_sky();
    REQUIRE(open.size() == body.surface.cells.size());
    double sum = 0;
    for (const float o : open) sum += static_cast<double>(o);
    CHECK(sum / static_cast<double>(open.size()) > 0.98);
    CHECK(*std::min_element(open.begin(), open.end()) > 0.85f);
}

TEST_CASE("Every place of a pit that is part of a ball sees the same share of the sky, and is as dark as it should be",
          "[slow]") {
    const Body body = pitted_block();
    const PartsInSight parts(body.volume, body.surface);
    const std::vector<float> open = parts.open_sky();
    const double mirrored = 1 - eta * eta * (1 - optics::internal_diffuse_reflectance(eta));
    CHECK(mirrored == Approx(0.092).margin(0.002));
    for (const float a : {0.0f, 0.2f, 0.6f, 1.0f}) {
        std::vector<float> value(open.size(), a);
        parts.shade(value, 1, eta);
        double light = 0, sky = 0, cells = 0;
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (!in_pit(body.surface.cells[i])) continue;
            light += static_cast<double>(value[i]);
            sky += static_cast<double>(open[i]);
            ++cells;
        }
        light /= cells;
        sky /= cells;
        REQUIRE(cells > 1000);
        CHECK(sky == Approx(open_share).margin(0.02));  // the rim is cut by half a cell
        const double leaves = mirrored + (1 - mirrored) * static_cast<double>(a);
        INFO("a " << a << ": " << light);
        CHECK(light == Approx(static_cast<double>(a) * sky / (1 - leaves * (1 - sky))).epsilon(0.03));
        if (a == 1)
            for (const float v : value) REQUIRE(v == Approx(1).margin(1e-3));
    }
}

TEST_CASE("Light between parts has the same bits for one thread and five, and channels do not mix", "[slow]") {
    const Body body = pitted_block();
    const std::size_t n = body.surface.cells.size();
    std::vector<std::vector<float>> shaded;
    for (const std::size_t threads : {1u, 5u}) {
        const ThreadLimit limit(threads);
        const PartsInSight parts(body.volume, body.surface);
        std::vector<float> value(3 * n);
        for (std::size_t i = 0; i < value.size(); ++i) value[i] = 0.3f * static_cast<float>(i % 3);
        parts.shade(value, 3, eta);
        shaded.push_back(value);
        std::vector<float> alone(n, 0.3f);
        parts.shade(alone, 1, eta);
        for (std::size_t i = 0; i < n; ++i) {
            REQUIRE(value[3 * i] == 0);
            REQUIRE(value[3 * i + 1] == Approx(alone[i]).margin(2e-4));
        }
    }
    CHECK(shaded[0] == shaded[1]);
}
