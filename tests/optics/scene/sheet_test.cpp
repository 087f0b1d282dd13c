// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/sheet.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "optics/layered/shell_appearance.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/scene/surface.h"
#include "optics/transport/transport.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750_mm{0.04233, 0.08467, 0.027};

std::shared_ptr<const Sheet> grey(float reflectance) {
    Sheet sheet;
    sheet.channels = 3;
    sheet.reflectance.assign(3, reflectance);
    return std::make_shared<const Sheet>(sheet);
}

/// Mean over the surface cells whose middle lies between these, mm along x.
double mean_seen(const Scene& scene, const AppearanceModel& model, std::size_t channel, double from_mm = 0,
                 double to_mm = 1e9) {
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    const Appearance seen = model.predict(scene, surface);
    double sum = 0, count = 0;
    for (std::size_t cell = 0; cell < surface.cells.size(); ++cell) {
        const auto x = double(surface.cells[cell].centre_mm[0]);
        if (x < from_mm || x > to_mm) continue;
        sum += double(seen.value[cell * seen.channels + channel]);
        ++count;
    }
    return sum / count;
}

}  // namespace

TEST_CASE("A place of a sheet is that of its cell, and the outermost ones go on", "[sheet]") {
    Sheet sheet{2, {2, 1}, {1, 0}, {0.5, 0.5}, {0.1f, 0.2f, 0.6f, 0.8f}};
    CHECK(sheet.at(1.2, 0.2, 0) == 0.1f);
    CHECK(sheet.at(1.6, 0.2, 1) == 0.8f);
    CHECK(sheet.at(-7, 9, 1) == 0.2f);
    CHECK(sheet.at(7, -9, 0) == 0.6f);
    CHECK(sheet.mean(0) == Approx(0.35));
    CHECK(reflectance_in_air(1.5) == Approx(0.0918).margin(2e-4));
    CHECK(share_sent_back(1, 0.0918) == Approx(1));
    CHECK(share_sent_back(0, 0.0918) == 0);
}

TEST_CASE("A thin slab over a grey sheet looks as by adding and doubling, to light paths and to the predictor",
          "[sheet][slow]") {
    const ResinSet set = vero_opaque();
    constexpr int layers = 10;
    const ResinVolume slab = make_resin_volume({24, 12, layers}, j750_mm, [](int, int, int) { return 5; });
    const MonteCarlo packets({.paths = 600}), scalar({.paths = 600, .tracer = PathTracer::scalar});
    for (const float reflectance : {0.0f, 0.3f, 1.0f}) {
        ShellGeometry geometry;
        geometry.core_resin = 4;
        geometry.shell_mm = 4 * j750_mm[2];
        geometry.core_mm = (layers - 4) * j750_mm[2];
        geometry.backing = Backing::sheet;
        geometry.sheet.assign(3, double(reflectance));
        const ShellAppearance shell(set, geometry);
        const std::vector<double> white{0, 0, 0, 0, 1}, exact = shell.exact(white);
        Scene scene{&slab, &set, Backing::sheet, Sides::mirrored, grey(reflectance)};
        for (const std::size_t c : {0u, 2u}) {
            const double by_packets = mean_seen(scene, packets, c), by_scalar = mean_seen(scene, scalar, c),
                         predicted = mean_seen(scene, TransportPredictor(), c);
            INFO("sheet " << reflectance << ", channel " << c << ": exact " << exact[c] << ", packets " << by_packets
                          << ", scalar " << by_scalar << ", predicted " << predicted);
            CHECK(by_packets == Approx(exact[c]).margin(0.004));
            CHECK(by_scalar == Approx(exact[c]).margin(0.004));
            CHECK(predicted == Approx(exact[c]).margin(0.006));
            CHECK(shell.appearance(white)[c] == Approx(exact[c]).margin(1e-3));
        }
    }
}

TEST_CASE("A sheet of two halves is seen through a thin slab where they are", "[sheet][slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume slab = make_resin_volume({96, 12, 8}, j750_mm, [](int, int, int) { return 5; });
    Sheet halves{3, {2, 1}, {}, {48 * j750_mm[0], 1}, {0.1f, 0.1f, 0.1f, 0.9f, 0.9f, 0.9f}};
    Scene scene{&slab, &set, Backing::sheet, Sides::mirrored, std::make_shared<const Sheet>(halves)};
    const MonteCarlo paths({.paths = 300});
    for (const auto& [from, to] : {std::pair{0.0, 1.4}, std::pair{1.6, 2.4}, std::pair{2.6, 4.1}}) {
        const double seen = mean_seen(scene, paths, 0, from, to),
                     predicted = mean_seen(scene, TransportPredictor(), 0, from, to);
        INFO("from " << from << " to " << to << " mm: " << seen << ", predicted " << predicted);
        CHECK(predicted == Approx(seen).margin(0.01));
    }
    CHECK(mean_seen(scene, paths, 0, 2.6, 4.1) - mean_seen(scene, paths, 0, 0, 1.4) > 0.1);
}
