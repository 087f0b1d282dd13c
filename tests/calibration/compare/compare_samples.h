// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print that was never made, and photographs of it, for several tests.
#pragma once

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "calibration/compare/predicted_print.h"
#include "calibration/rehearsal/photo_simulation.h"

namespace voxtone::calibration::testing {

/// Discs of many colours on light grey, 12 mm x 8 mm in cells of a J750; asymmetric in every way.
inline PredictedPrint discs(std::uint64_t seed = 1) {
    PredictedPrint print;
    print.name = "out/discs";
    print.model = "transport";
    print.columns = 142, print.rows = 95;
    print.cell_mm = {0.0847, 0.0847};
    print.rgb.assign(std::size_t(142 * 95), Eigen::Vector3f(0.75f, 0.76f, 0.72f));
    RandomStream random(seed, 0);
    for (int disc = 0; disc < 60; ++disc) {
        const double x = 142 * random.uniform(), y = 95 * random.uniform(), r = 2 + 10 * random.uniform();
        const double red = random.uniform(), green = random.uniform(), blue = random.uniform();
        const Eigen::Vector3f rgb(float(0.05 + 0.8 * red), float(0.05 + 0.8 * green), float(0.05 + 0.8 * blue));
        for (int row = 0; row < 95; ++row)
            for (int column = 0; column < 142; ++column)
                if (std::hypot(column + 0.5 - x, row + 0.5 - y) < r) print.rgb[print.index(column, row)] = rgb;
    }
    print.by_paths = print.rgb;
    print.seen = [](std::span<const Eigen::Vector3f> rgb) {
        return std::vector<Eigen::Vector3f>(rgb.begin(), rgb.end());
    };
    return print;
}

/// Its colours where they lie, blurred by a Gaussian: a mean over 13 x 13 places, of which none is a cell's.
inline FlatThing thing_of(const PredictedPrint& print, double blur_mm = 0) {
    const Eigen::Vector2d size_mm = print.size().cwiseProduct(print.cell_mm);
    return {size_mm, [=](const Eigen::Vector2d& p) {
                const auto sharp = [&](double x, double y) -> Eigen::Vector3d {
                    const int column = std::clamp(int(x / print.cell_mm.x()), 0, print.columns - 1),
                              row = std::clamp(int((size_mm.y() - y) / print.cell_mm.y()), 0, print.rows - 1);
                    return print.rgb[print.index(column, row)].cast<double>();
                };
                if (blur_mm == 0) return sharp(p.x(), p.y());
                Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                double weights = 0;
                for (int j = -6; j <= 6; ++j)
                    for (int i = -6; i <= 6; ++i) {
                        const double weight = std::exp(-0.125 * (i * i + j * j));
                        sum += weight * sharp(p.x() + 0.5 * i * blur_mm, p.y() + 0.5 * j * blur_mm);
                        weights += weight;
                    }
                return Eigen::Vector3d(sum / weights);
            }};
}

/// A camera in the hand over a table: tilted, with a lens, vignette, one lamp, noise, a white balance.
inline PhotoOptions hand_camera() {
    PhotoOptions o;
    o.width_px = 1200, o.height_px = 900;
    o.rays = 2;
    o.tilt_x_deg = 14, o.tilt_y_deg = 14;  // 20 degrees between them
    o.turn_deg = 4;
    o.margin = 0.12;
    o.lens = 0.01;
    o.sheet = 0.12;
    o.lamp_mm = 400;
    o.vignetting = 0.2;
    o.white_balance = {0.9, 1, 0.8};
    o.matrix = 0;
    o.dust = o.scratches = 0;
    o.checker = false;
    return o;
}

}  // namespace voxtone::calibration::testing
