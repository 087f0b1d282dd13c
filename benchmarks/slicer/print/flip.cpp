// SPDX-License-Identifier: GPL-3.0-or-later
#include "flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::loop_benchmark {

namespace {

using std::numbers::pi;

constexpr double colour_exponent = 0.7, knee = 0.4, at_knee = 0.95;  // 4.1: q_c, p_c, p_t
constexpr double feature_degrees = 0.082, feature_exponent = 0.5;    // 4.2: w, q_f

/// Separable up to a sum of two.
struct Spread {
    double a1, b1, a2, b2;
};
constexpr Spread achromatic{1, 0.0047, 0, 1e-5}, red_green{1, 0.0053, 0, 1e-5}, blue_yellow{34.1, 0.04, 13.5, 0.025};

using Kernel = std::vector<double>;  // (2 radius + 1)^2

int radius_of(const Kernel& kernel) { return (static_cast<int>(std::lround(std::sqrt(kernel.size()))) - 1) / 2; }

Kernel kernel_of(int radius, const std::function<double(int, int)>& value) {
    Kernel kernel;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) kernel.push_back(value(x, y));
    return kernel;
}

Kernel sensitivity(const Spread& s, double pixels_per_degree) {
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(blue_yellow.b1 / (2 * pi * pi)) * pixels_per_degree));
    Kernel kernel = kernel_of(radius, [&](int x, int y) {
        const double d2 = (x * x + y * y) / (pixels_per_degree * pixels_per_degree);
        return s.a1 * std::sqrt(pi / s.b1) * std::exp(-pi * pi * d2 / s.b1) +
               s.a2 * std::sqrt(pi / s.b2) * std::exp(-pi * pi * d2 / s.b2);
    });
    double sum = 0;
    for (const double v : kernel) sum += v;
    for (double& v : kernel) v /= sum;
    return kernel;
}

/// What is positive sums to 1, what is negative to -1.
Kernel balanced(Kernel kernel) {
    double up = 0, down = 0;
    for (const double v : kernel) (v > 0 ? up : down) += std::abs(v);
    for (double& v : kernel) v /= v > 0 ? up : down;
    return kernel;
}

/// Along x, of a Gaussian as wide as a feature.
std::array<Kernel, 2> feature_kernels(double pixels_per_degree) {
    const double sigma = 0.5 * feature_degrees * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const auto gauss = [&](int x, int y) { return std::exp(-(x * x + y * y) / (2 * sigma * sigma)); };
    return {balanced(kernel_of(radius, [&](int x, int y) { return -x * gauss(x, y); })),
            balanced(kernel_of(radius, [&](int x, int y) { return (x * x / (sigma * sigma) - 1) * gauss(x, y); }))};
}

using Plane = std::vector<double>;

/// Borders are continued by their pixels. `turned`: x and y of the kernel exchanged.
Plane filtered(const Plane& plane, int columns, int rows, const Kernel& kernel, bool turned = false) {
    const int radius = radius_of(kernel), width = 2 * radius + 1;
    Plane out(plane.size());
    parallel_for(0, static_cast<std::size_t>(rows), 4, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < columns; ++x) {
            double sum = 0;
            for (int dy = -radius; dy <= radius; ++dy)
                for (int dx = -radius; dx <= radius; ++dx) {
                    const int px = std::clamp(x + dx, 0, columns - 1), py = std::clamp(y + dy, 0, rows - 1);
                    const int kx = turned ? dy : dx, ky = turned ? dx : dy;
                    sum += kernel[static_cast<std::size_t>((ky + radius) * width + kx + radius)] *
                           plane[static_cast<std::size_t>(py * columns + px)];
                }
            out[static_cast<std::size_t>(y * columns + x)] = sum;
        }
    });
    return out;
}

/// YCxCz, 4.1.1: linear in XYZ over white's.
Eigen::Vector3d opponent(const Eigen::Vector3d& rgb) {
    static const Eigen::Vector3d white = optics::xyz_from_linear_srgb(Eigen::Vector3d::Ones());
    const Eigen::Vector3d v = optics::xyz_from_linear_srgb(rgb).cwiseQuotient(white);
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

Eigen::Vector3d from_opponent(const Eigen::Vector3d& v) {
    static const Eigen::Vector3d white = optics::xyz_from_linear_srgb(Eigen::Vector3d::Ones());
    const double y = (v[0] + 16) / 116;
    return optics::linear_srgb_from_xyz(Eigen::Vector3d(y + v[1] / 500, y, y - v[2] / 200).cwiseProduct(white));
}

/// Colours fade with light.
Eigen::Vector3d hunt_adjusted(const Eigen::Vector3d& rgb) {
    Eigen::Vector3d lab = optics::lab_from_linear_srgb(rgb);
    lab.tail<2>() *= 0.01 * lab[0];
    return lab;
}

double hyab(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::abs(a[0] - b[0]) + (a - b).tail<2>().norm();
}

struct Seen {
    std::vector<Eigen::Vector3d> colour;  ///< Hunt-adjusted
    Plane edge, point;
};

Seen seen(const FlipPicture& picture, double pixels_per_degree) {
    const int columns = static_cast<int>(picture.columns), rows = static_cast<int>(picture.rows);
    std::array<Plane, 3> plane;
    Plane light;
    for (const Eigen::Vector3f& rgb : picture.rgb) {
        const Eigen::Vector3d v = opponent(rgb.cast<double>().cwiseMax(0).cwiseMin(1));
        for (int c = 0; c < 3; ++c) plane[static_cast<std::size_t>(c)].push_back(v[c]);
        light.push_back((v[0] + 16) / 116);
    }
    const std::array<Spread, 3> spread{achromatic, red_green, blue_yellow};
    for (std::size_t c = 0; c < 3; ++c)
        plane[c] = filtered(plane[c], columns, rows, sensitivity(spread[c], pixels_per_degree));
    Seen out;
    for (std::size_t i = 0; i < light.size(); ++i)
        out.colour.push_back(
            hunt_adjusted(from_opponent({plane[0][i], plane[1][i], plane[2][i]}).cwiseMax(0).cwiseMin(1)));
    const std::array<Kernel, 2> kernel = feature_kernels(pixels_per_degree);
    for (std::size_t k = 0; k < 2; ++k) {
        const Plane along = filtered(light, columns, rows, kernel[k]),
                    across = filtered(light, columns, rows, kernel[k], true);
        Plane& feature = k == 0 ? out.edge : out.point;
        for (std::size_t i = 0; i < light.size(); ++i) feature.push_back(std::hypot(along[i], across[i]));
    }
    return out;
}

}  // namespace

std::vector<double> flip(const FlipPicture& reference, const FlipPicture& test, double pixels_per_degree) {
    VOXTONE_EXPECT(reference.columns == test.columns && reference.rows == test.rows && pixels_per_degree > 0);
    VOXTONE_EXPECT(reference.rgb.size() == reference.columns * reference.rows &&
                   test.rgb.size() == reference.rgb.size());
    const Seen r = seen(reference, pixels_per_degree), t = seen(test, pixels_per_degree);
    const double most = std::pow(hyab(hunt_adjusted({0, 1, 0}), hunt_adjusted({0, 0, 1})), colour_exponent);
    std::vector<double> difference(r.colour.size());
    for (std::size_t i = 0; i < difference.size(); ++i) {
        const double far = std::pow(hyab(r.colour[i], t.colour[i]), colour_exponent), bend = knee * most;
        const double colour =
            far < bend ? at_knee * far / bend : at_knee + (far - bend) / (most - bend) * (1 - at_knee);
        const double feature =
            std::pow(std::max(std::abs(r.edge[i] - t.edge[i]), std::abs(r.point[i] - t.point[i])) / std::numbers::sqrt2,
                     feature_exponent);
        difference[i] = std::pow(colour, 1 - feature);
    }
    return difference;
}

}  // namespace voxtone::loop_benchmark
