// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"

namespace voxtone::calibration {
namespace {

constexpr double white_level = 0.8, chart_black = 0.04, chart_patch_share = 0.84;
constexpr std::uint32_t noise_stream = 3;

using Pixels = std::vector<Eigen::Vector3f>;

Pixels transposed(const Pixels& pixels, std::size_t width, std::size_t height) {
    Pixels turned(pixels.size());
    parallel_for(0, width, 16, [&](std::size_t x) {
        for (std::size_t y = 0; y < height; ++y) turned[x * height + y] = pixels[y * width + x];
    });
    return turned;
}

// Whole rows of samples at a time, for vectors; of each sample in the kernel's order.
void blur_columns(Pixels& pixels, std::size_t width, double sigma) {
    const int reach = int(std::ceil(4 * sigma)), last = int(pixels.size() / width) - 1;
    std::vector<float> kernel;
    float sum = 0;
    for (int i = -reach; i <= reach; ++i) sum += kernel.emplace_back(float(std::exp(-0.5 * i * i / (sigma * sigma))));
    const Pixels sharp = std::exchange(pixels, Pixels(pixels.size(), Eigen::Vector3f::Zero()));
    parallel_for(0, std::size_t(last) + 1, 8, [&](std::size_t y) {
        float* const out = pixels[y * width].data();
        for (std::size_t i = 0; i < kernel.size(); ++i) {
            const float* const in = sharp[std::size_t(std::clamp(int(y) + int(i) - reach, 0, last)) * width].data();
            const float share = kernel[i];
            for (std::size_t k = 0; k < 3 * width; ++k) out[k] += share * in[k];
        }
        for (std::size_t k = 0; k < 3 * width; ++k) out[k] /= sum;
    });
}

Eigen::Matrix3d camera_colours(const Sensor& sensor) {
    Eigen::Matrix3d mixing;
    mixing << 0.71, 0.25, 0.04, 0.16, 0.74, 0.10, 0.03, 0.21, 0.76;  // rows sum to 1
    const Eigen::Matrix3d some = Eigen::Matrix3d::Identity() + sensor.matrix * (mixing - Eigen::Matrix3d::Identity());
    return sensor.white_balance.asDiagonal() * some * (sensor.exposure * white_level / sensor.white_balance.maxCoeff());
}

}  // namespace

void expect_within(std::string_view name, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw InputError(fmt::format("{} is {}; it must be from {} to {}", name, value, least, most));
}

void Sensor::validate() const {
    expect_within("--vignetting", vignetting, 0, 0.9);
    expect_within("--exposure", exposure, 1e-3, 100);
    for (const double gain : white_balance) expect_within("--white-balance", gain, 0.05, 20);
    expect_within("how much the camera mixes colours", matrix, 0, 1.2);
    expect_within("--electrons", electrons, 0, 1e9);
    expect_within("--read-noise", read_noise, 0, 1);
}

double normal_number(RandomStream& random) {
    const double u = 1 - random.uniform(), v = random.uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

double with_noise(double value, double electrons, double read_noise, RandomStream& random) {
    if (electrons <= 0) return value;
    return value + normal_number(random) * std::sqrt(std::max(value, 0.0) / electrons + read_noise * read_noise);
}

io::Photograph black_photograph(std::uint32_t width_px, std::uint32_t height_px) {
    io::Photograph photo;
    photo.name = "simulated";
    photo.width_px = width_px, photo.height_px = height_px;
    photo.pixels.assign(std::size_t{width_px} * height_px, Eigen::Vector3f::Zero());
    return photo;
}

void expose(io::Photograph& photo, const Sensor& sensor, double blur_px, std::uint64_t seed) {
    if (blur_px > 0) {
        Pixels turned = transposed(photo.pixels, photo.width_px, photo.height_px);
        blur_columns(turned, photo.height_px, blur_px);
        photo.pixels = transposed(turned, photo.height_px, photo.width_px);
        blur_columns(photo.pixels, photo.width_px, blur_px);
    }
    const Eigen::Matrix3d colours = camera_colours(sensor);
    const Eigen::Vector2d middle = Eigen::Vector2d(photo.width_px, photo.height_px) / 2;
    const double fall = 1 / std::sqrt(1 - sensor.vignetting) - 1;
    parallel_for(0, photo.height_px, 16, [&](std::size_t y) {
        for (std::uint32_t x = 0; x < photo.width_px; ++x) {
            const std::size_t i = photo.index(x, std::uint32_t(y));
            const double r2 = (Eigen::Vector2d(x + 0.5, double(y) + 0.5) - middle).squaredNorm() / middle.squaredNorm();
            Eigen::Vector3d signal = colours * photo.pixels[i].cast<double>() / std::pow(1 + fall * r2, 2);
            RandomStream random(seed, i, noise_stream);
            for (double& value : signal) value = with_noise(value, sensor.electrons, sensor.read_noise, random);
            photo.pixels[i] = signal.cwiseMax(0).cwiseMin(1).cast<float>();
        }
    });
}

Eigen::Vector3d chart_colour(const CheckerChart& chart, std::span<const Eigen::Vector3d> colours,
                             const Eigen::Vector2d& cell) {
    const double column = std::floor(cell.x()), row = std::floor(cell.y());
    const double off = (cell - Eigen::Vector2d(column + 0.5, row + 0.5)).cwiseAbs().maxCoeff();
    if (column < 0 || row < 0 || column >= chart.columns || row >= chart.rows || off > chart_patch_share / 2)
        return Eigen::Vector3d::Constant(chart_black);
    return colours[std::size_t(int(row) * chart.columns + int(column))];
}

bool Stroke::hits(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d along = to - from;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((p - from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (p - from - t * along).squaredNorm() < radius_mm * radius_mm;
}

}  // namespace voxtone::calibration
