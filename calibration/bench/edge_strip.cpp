// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/edge_strip.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double clipped_part = 0.002;         // of the strip's pixels: more is refused
constexpr double block_mm = 0.25, off_by = 6;  // of what is left out
constexpr double least_absolute = 4e-4;        // of a perfect diffuser: less is nothing on a dark slab
constexpr double least_off = 0.002;            // of the strip's brightest level: less is nothing
constexpr double likely_alike = 1.5;           // interpolation makes neighbours alike: blocks are as much noisier
constexpr int trend_blocks = 4;                // on both sides: what changes slowly along the edge may stay
constexpr std::size_t pieces = 10, error_reach = 4;

double keys(double t) {
    t = std::abs(t);
    if (t < 1) return (1.5 * t - 2.5) * t * t + 1;
    if (t < 2) return ((-0.5 * t + 2.5) * t - 4) * t + 2;
    return 0;
}

// Between pixels; inside of the picture by two.
Vector3d bicubic(const io::Photograph& photo, const Vector2d& px) {
    const double x = px.x() - 0.5, y = px.y() - 0.5;
    const double i = std::floor(x), j = std::floor(y);
    Vector3d sum = Vector3d::Zero();
    for (int b = -1; b <= 2; ++b)
        for (int a = -1; a <= 2; ++a)
            sum += keys(x - i - a) * keys(y - j - b) *
                   photo.pixels[photo.index(std::uint32_t(i + a), std::uint32_t(j + b))].cast<double>();
    return sum;
}

std::vector<double> middles(double length, double pitch) {
    const int half = int(std::floor(length / pitch / 2 + 1e-9));
    std::vector<double> x;
    for (int k = -half; k < half; ++k) x.push_back((k + 0.5) * pitch);
    return x;
}

// Index of the block that a row or column lies in.
std::vector<std::size_t> blocks_of(const std::vector<double>& middles_mm) {
    std::vector<std::size_t> blocks;
    for (const double x : middles_mm) blocks.push_back(std::size_t((x - middles_mm.front()) / block_mm));
    return blocks;
}

class StripMaker {
public:
    explicit StripMaker(EdgeStrip& strip)
        : strip_(strip),
          columns_(strip.x_mm.size()),
          rows_(strip.y_mm.size()),
          of_row_(blocks_of(strip.y_mm)),
          of_column_(blocks_of(strip.x_mm)) {}

    void average() {
        strip_.left_out.assign(strip_.rho.size(), false);
        strip_.mean = means(0, rows_);
        const double brightest =
            std::ranges::max(strip_.mean, {}, [](const Vector3d& v) { return v.sum(); }).maxCoeff();
        for (int channel = 0; channel < 3; ++channel) leave_out(channel, brightest);
        strip_.mean = means(0, rows_);
        errors();
        count();
    }

private:
    [[nodiscard]] std::size_t at(std::size_t row, std::size_t column) const { return row * columns_ + column; }

    // Of each column over rows [from, to), without what is left out.
    [[nodiscard]] std::vector<Vector3d> means(std::size_t from, std::size_t to) const {
        std::vector<Vector3d> mean(columns_, Vector3d::Zero());
        for (std::size_t column = 0; column < columns_; ++column) {
            double used = 0;
            for (std::size_t row = from; row < to; ++row) {
                if (strip_.left_out[at(row, column)]) continue;
                mean[column] += strip_.rho[at(row, column)];
                ++used;
            }
            mean[column] = used > 0 ? Vector3d(mean[column] / used) : Vector3d::Constant(std::nan(""));
        }
        return mean;
    }

    // Standard deviation of a block's mean by the noise of its samples alone: from rows that are two apart, so that
    // interpolation has not made them alike.
    [[nodiscard]] double noise_of_block(int channel) const {
        std::vector<double> steps;
        for (std::size_t row = 2; row < rows_; row += 3)
            for (std::size_t column = 0; column < columns_; ++column)
                steps.push_back(
                    std::abs(strip_.rho[at(row, column)][channel] - strip_.rho[at(row - 2, column)][channel]));
        const double in_block = std::pow(block_mm / (strip_.x_mm[1] - strip_.x_mm[0]), 2);
        return 1.4826 * optics::median(std::move(steps)) / std::sqrt(2 * std::max(in_block, 1.0));
    }

    void leave_out(int channel, double brightest) {
        const std::size_t high = of_row_.back() + 1, wide = of_column_.back() + 1;
        std::vector<double> off(high * wide, 0), pixels(high * wide, 0);
        for (std::size_t row = 0; row < rows_; ++row)
            for (std::size_t column = 0; column < columns_; ++column) {
                const std::size_t block = of_row_[row] * wide + of_column_[column];
                off[block] += strip_.rho[at(row, column)][channel] - strip_.mean[column][channel];
                ++pixels[block];
            }
        for (std::size_t b = 0; b < off.size(); ++b) off[b] /= pixels[b];
        std::vector<bool> bad(off.size(), false);
        std::vector<double> deviations;
        for (std::size_t column = 0; column < wide; ++column) {
            std::vector<double> rest(high), sizes(high);
            for (std::size_t row = 0; row < high; ++row) {
                std::vector<double> near;
                for (int k = -trend_blocks; k <= trend_blocks; ++k)
                    near.push_back(off[std::size_t(std::clamp(int(row) + k, 0, int(high) - 1)) * wide + column]);
                rest[row] = off[row * wide + column] - optics::median(near);
                sizes[row] = std::abs(rest[row]);
            }
            deviations.push_back(1.4826 * optics::median(sizes));
            const double most = std::max(off_by * deviations.back(), std::max(least_off * brightest, least_absolute));
            for (std::size_t row = 0; row < high; ++row) bad[row * wide + column] = std::abs(rest[row]) > most;
        }
        const double rough = optics::median(deviations), noise = likely_alike * noise_of_block(channel);
        if (rough > noise) strip_.roughness = std::max(strip_.roughness, std::sqrt(rough * rough - noise * noise));
        for (std::size_t row = 0; row < rows_; ++row)
            for (std::size_t column = 0; column < columns_; ++column)
                if (bad[of_row_[row] * wide + of_column_[column]]) strip_.left_out[at(row, column)] = true;
    }

    void errors() {
        std::vector<Vector3d> variance(columns_, Vector3d::Zero());
        std::vector<double> used(columns_, 0);
        for (std::size_t piece = 0; piece < pieces; ++piece) {
            const std::vector<Vector3d> mean = means(rows_ * piece / pieces, rows_ * (piece + 1) / pieces);
            for (std::size_t column = 0; column < columns_; ++column) {
                if (!mean[column].allFinite()) continue;
                variance[column] += (mean[column] - strip_.mean[column]).cwiseAbs2();
                ++used[column];
            }
        }
        for (std::size_t column = 0; column < columns_; ++column)
            variance[column] /= std::max(1.0, used[column] * (used[column] - 1));
        for (std::size_t column = 0; column < columns_; ++column) {
            const std::size_t from = column < error_reach ? 0 : column - error_reach,
                              to = std::min(columns_, column + error_reach + 1);
            Vector3d sum = Vector3d::Zero();
            for (std::size_t k = from; k < to; ++k) sum += variance[k] / double(to - from);
            strip_.error.emplace_back(sum.cwiseSqrt().cwiseMax(1e-6));
        }
    }

    void count() {
        for (std::size_t column = 0; column < columns_; ++column) {
            double out = 0;
            for (std::size_t row = 0; row < rows_; ++row) out += strip_.left_out[at(row, column)];
            strip_.left_out_most = std::max(strip_.left_out_most, out / double(rows_));
            strip_.left_out_share += out / double(rows_ * columns_);
        }
    }

    EdgeStrip& strip_;
    std::size_t columns_, rows_;
    std::vector<std::size_t> of_row_, of_column_;
};

void check_clipping(const io::Photograph& photo, const Vector2d& low, const Vector2d& high, const Vector3d& clip) {
    Vector3d clipped = Vector3d::Zero();
    double pixels = 0;
    for (auto y = std::uint32_t(low.y()); y < std::uint32_t(high.y()); ++y)
        for (auto x = std::uint32_t(low.x()); x < std::uint32_t(high.x()); ++x) {
            const Vector3d value = photo.pixels[photo.index(x, y)].cast<double>();
            clipped += (value.array() >= clip.array()).cast<double>().matrix();
            ++pixels;
        }
    for (int channel = 0; channel < 3; ++channel)
        if (clipped[channel] > clipped_part * pixels)
            throw InputError(fmt::format(
                "{}: the {} channel is clipped in {:.1f} % of the pixels about the edge, so that its value "
                "there is not known; take all photographs again with a shorter exposure",
                photo.name, std::array{"red", "green", "blue"}[std::size_t(channel)], 100 * clipped[channel] / pixels));
}

}  // namespace

EdgeStrip cut_strip(const io::Photograph& photo, const BoardView& board, const PhotoScale& scale,
                    const StripOptions& options) {
    EdgeStrip strip;
    const double pitch = 1 / board.px_per_mm;
    strip.x_mm = middles(options.width_mm, pitch);
    strip.y_mm = middles(options.length_mm, pitch);
    Vector2d low = Vector2d::Constant(1e30), high = -low;
    for (const double x : {-options.width_mm / 2, options.width_mm / 2})
        for (const double y : {-options.length_mm / 2, options.length_mm / 2}) {
            const Vector2d px = board.place.to_px(options.middle_mm + Vector2d(x, y));
            low = low.cwiseMin(px);
            high = high.cwiseMax(px);
        }
    if (!(low.x() >= 3 && low.y() >= 3 && high.x() <= photo.width_px - 3.0 && high.y() <= photo.height_px - 3.0))
        throw InputError(fmt::format("{}: the {:g} x {:g} mm about the edge are cut off by the picture's border",
                                     photo.name, options.width_mm, options.length_mm));
    check_clipping(photo, low, high, scale.clip);
    strip.rho.resize(strip.x_mm.size() * strip.y_mm.size());
    parallel_for(0, strip.y_mm.size(), 8, [&](std::size_t row) {
        for (std::size_t column = 0; column < strip.x_mm.size(); ++column) {
            const Vector2d px = board.place.to_px(options.middle_mm + Vector2d(strip.x_mm[column], strip.y_mm[row]));
            strip.rho[row * strip.x_mm.size() + column] = scale.model->reflectance(px, bicubic(photo, px));
        }
    });
    StripMaker(strip).average();
    return strip;
}

Vector3d side_mean(const EdgeStrip& strip, double from_mm, double to_mm) {
    Vector3d sum = Vector3d::Zero();
    double used = 0;
    for (std::size_t k = 0; k < strip.x_mm.size(); ++k)
        if (strip.x_mm[k] >= from_mm && strip.x_mm[k] <= to_mm) sum += strip.mean[k], ++used;
    return sum / std::max(used, 1.0);
}

EdgeBlur fit_bare_edge(const EdgeStrip& strip) {
    const double end = strip.x_mm.back(), pitch = strip.x_mm[1] - strip.x_mm[0];
    const Vector3d white = side_mean(strip, end / 2, end), black = side_mean(strip, -end, -end / 2);
    EdgeBlur best{0, 0, (white - black).mean()};
    // Mean over a pixel of a blurred step; s: standard deviation.
    const auto step = [&](double x, double s) {
        if (s < 0.02 * pitch) return std::clamp(x / pitch + 0.5, 0.0, 1.0);
        const auto antiderivative = [&](double t) {  // of the normal distribution's integral
            return t * 0.5 * std::erfc(-t / (s * std::sqrt(2.0))) +
                   s * std::exp(-0.5 * t * t / (s * s)) / std::sqrt(2 * 3.14159265358979323846);
        };
        return (antiderivative(x + pitch / 2) - antiderivative(x - pitch / 2)) / pitch;
    };
    const auto misfit = [&](double offset, double s) {
        double sum = 0;
        for (std::size_t k = 0; k < strip.x_mm.size(); ++k) {
            if (std::abs(strip.x_mm[k]) > end / 2) continue;
            const Vector3d expected = black + (white - black) * step(strip.x_mm[k] - offset, s);
            sum += (strip.mean[k] - expected).squaredNorm();
        }
        return sum;
    };
    // A net that gets finer about its least.
    double least = misfit(0, pitch), reach_offset = 3 * pitch, reach_s = 6 * pitch, s0 = 6 * pitch;
    best.blur_mm = pitch;
    for (int round = 0; round < 14; ++round) {
        const double offset0 = best.offset_mm;
        for (int i = -4; i <= 4; ++i)
            for (int j = -4; j <= 4; ++j) {
                const double offset = offset0 + reach_offset * i / 4, s = std::max(0.0, s0 + reach_s * j / 4);
                const double now = misfit(offset, s);
                if (now < least) least = now, best.offset_mm = offset, best.blur_mm = s;
            }
        s0 = best.blur_mm;
        reach_offset /= 2;
        reach_s /= 2;
    }
    return best;
}

SeenEdge seen_edge(const EdgeStrip& strip) {
    constexpr double reach_mm = 2, level_mm = 0.5;
    const std::size_t columns = strip.x_mm.size(), rows = strip.y_mm.size();
    const Vector3d steps =
        side_mean(strip, reach_mm, reach_mm + level_mm) - side_mean(strip, -reach_mm - level_mm, -reach_mm);
    Eigen::Index channel = 0;
    SeenEdge edge;
    edge.step = steps.maxCoeff(&channel);
    if (edge.step <= 0) return edge;
    Eigen::VectorXd at(pieces), y(pieces);
    for (std::size_t piece = 0; piece < pieces; ++piece) {
        double below = 0, above = 0, inside = 0, count_below = 0, count_above = 0, count = 0, sum_y = 0, sum_rows = 0;
        for (std::size_t row = rows * piece / pieces; row < rows * (piece + 1) / pieces; ++row, ++sum_rows) {
            sum_y += strip.y_mm[row];
            for (std::size_t column = 0; column < columns; ++column) {
                if (strip.left_out[row * columns + column]) continue;
                const double x = strip.x_mm[column], v = strip.rho[row * columns + column][channel];
                if (std::abs(x) < reach_mm)
                    inside += v, ++count;
                else if (std::abs(x) < reach_mm + level_mm)
                    (x < 0 ? below : above) += v, ++(x < 0 ? count_below : count_above);
            }
        }
        const double black = below / std::max(count_below, 1.0), white = above / std::max(count_above, 1.0);
        // By parts: the mean of the profile within the reach says where its step lies.
        const auto k = Eigen::Index(piece);
        at[k] = reach_mm * (white + black - 2 * inside / std::max(count, 1.0)) / (white - black);
        y[k] = sum_y / std::max(sum_rows, 1.0);
    }
    edge.offset_mm = at.mean();
    const Eigen::VectorXd off = y.array() - y.mean();
    const double slope = off.dot(at) / off.squaredNorm();
    const Eigen::VectorXd rest = at.array() - at.mean() - slope * off.array();
    constexpr double degrees = 180 / 3.14159265358979323846;
    edge.turn_deg = std::atan(slope) * degrees;
    edge.turn_error_deg = std::sqrt(rest.squaredNorm() / double(pieces - 2) / off.squaredNorm()) * degrees;
    return edge;
}

}  // namespace voxtone::calibration
