// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/local_profiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "scattering/local_profiles/banded_blocks.h"
#include "scattering/local_profiles/conjugate_gradient.h"

namespace voxtone::scattering {
namespace {

using Images = std::vector<double>;  ///< [knot][point]

/// A pair of a point with itself has half the paths of others.
constexpr double own_weight = 0.5;
/// Counts that a start is drawn towards the mean by.
constexpr double shrinkage = 3;
/// Values without noise: smoothness counts as if the largest had this many counts.
constexpr double counts_without_noise = 1e12;

class Problem {
public:
    Problem(const optics::SampledBssrdf& responses, const optics::ChannelResponses& data, double curvature)
        : grid_{responses.width, responses.height},
          rings_(profile_rings(responses.radius)),
          points_(grid_.points()),
          knots_(std::size_t{responses.radius} + 1),
          smoothness_(1 / (curvature * curvature)),
          noise_(data.noise > 0 ? data.noise
                                : *std::max_element(data.pairs.begin(), data.pairs.end()) / counts_without_noise),
          blocks_(points_, knots_) {
        count(responses, data);
        root_.assign(rings_.size(), std::vector<double>(points_));
        around_ = root_;
        ring_image_.resize(points_);
    }

    [[nodiscard]] std::size_t size() const { return knots_ * points_; }
    [[nodiscard]] double all_counts() const { return all_counts_; }
    [[nodiscard]] double noise() const { return noise_; }

    /// Light by knot over what all points have on average, drawn to it where there is little.
    [[nodiscard]] Images start() const {
        Images p(size());
        for (std::size_t k = 0; k < knots_; ++k) {
            const auto light = of_knot(counts_, k), pairs = of_knot(pairs_, k);
            const double all = std::accumulate(pairs.begin(), pairs.end(), 0.0);
            const double mean = std::max(0.5, std::accumulate(light.begin(), light.end(), 0.0)) / std::max(all, 1.0);
            for (std::size_t i = 0; i < points_; ++i)
                p[k * points_ + i] = std::log((light[i] + shrinkage) / (pairs[i] + shrinkage / mean));
        }
        return p;
    }

    /// Takes p as the place of what follows, gives the value of the function there.
    double move_to(const Images& p) {
        std::vector<double> row_value(grid_.height, 0.0);
        for (std::size_t r = 1; r < rings_.size(); ++r) {
            const auto [low, high] = shares(r);
            for_rows([&](std::size_t y) {
                for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i)
                    root_[r][i] = std::exp(0.5 * (low * at(p, r, i) + high * at(p, r, i, 1)));
            });
            for_rows([&](std::size_t y) {
                const auto sum = row_of(around_[r], y);
                sum_over_ring(grid_, rings_[r], root_[r], static_cast<std::uint32_t>(y), sum);
                for (std::size_t x = 0; x < grid_.width; ++x)
                    row_value[y] += 0.5 * root_[r][y * grid_.width + x] * sum[x];
            });
        }
        for_rows([&](std::size_t y) {
            for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i) {
                root_[0][i] = std::exp(0.5 * p[i]);
                row_value[y] += own_weight * root_[0][i] * root_[0][i];
                for (std::size_t k = 0; k < knots_; ++k) row_value[y] -= p[k * points_ + i] * counts_[k * points_ + i];
                for (std::size_t k = 1; k + 1 < knots_; ++k) {
                    const double bend = bend_at(p, k, i);
                    row_value[y] += 0.5 * smoothness_ * bend * bend;
                }
            }
        });
        return std::accumulate(row_value.begin(), row_value.end(), 0.0);
    }

    /// The gradient at p, where the problem was moved to.
    void gradient(const Images& p, Images& g) const {
        for (std::size_t i = 0; i < size(); ++i) g[i] = -counts_[i];
        for_rows([&](std::size_t y) {
            for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i) {
                g[i] += own_weight * root_[0][i] * root_[0][i];
                for (std::size_t r = 1; r < rings_.size(); ++r) spread(g, r, i, 0.5 * root_[r][i] * around_[r][i]);
            }
            add_smoothness(p, g, y);
        });
    }

    /// h = Hessian x.
    void multiply(const Images& x, Images& h) {
        for_rows([&](std::size_t y) {
            for (std::size_t k = 0; k < knots_; ++k) std::fill_n(h.begin() + offset(k, y), grid_.width, 0.0);
            for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i)
                h[i] = own_weight * root_[0][i] * root_[0][i] * x[i];
            add_smoothness(x, h, y);
        });
        for (std::size_t r = 1; r < rings_.size(); ++r) {
            const auto [low, high] = shares(r);
            const double* at_knot = x.data() + rings_[r].knot * points_;
            for_rows([&](std::size_t y) {
                for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i)
                    ring_image_[i] = root_[r][i] * (low * at_knot[i] + high * at_knot[points_ + i]);
            });
            for_rows([&](std::size_t y) {
                std::vector<double> sum(grid_.width);
                sum_over_ring(grid_, rings_[r], ring_image_, static_cast<std::uint32_t>(y), sum);
                double* to = h.data() + offset(rings_[r].knot, y);
                const std::size_t first = y * grid_.width;
                for (std::size_t c = 0; c < grid_.width; ++c) {
                    const std::size_t i = first + c;
                    const double value = 0.25 * (ring_image_[i] * around_[r][i] + root_[r][i] * sum[c]);
                    to[c] += low * value;
                    to[points_ + c] += high * value;
                }
            });
        }
    }

    /// The blocks of the Hessian that couple the knots of one point.
    void prepare_blocks() {
        for_rows([&](std::size_t y) {
            for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i) {
                BandedBlocks::Block block = blocks_.clear(i);
                block.add(0, 0, own_weight * root_[0][i] * root_[0][i]);
                for (std::size_t r = 1; r < rings_.size(); ++r) {
                    const auto [low, high] = shares(r);
                    const std::size_t k = rings_[r].knot;
                    const double weight = 0.25 * root_[r][i] * around_[r][i];
                    block.add(k, k, weight * low * low);
                    block.add(k + 1, k, weight * low * high);
                    block.add(k + 1, k + 1, weight * high * high);
                }
                constexpr double bend[] = {1, -2, 1};
                for (std::size_t k = 1; k + 1 < knots_; ++k)
                    for (std::size_t a = 0; a < 3; ++a)
                        for (std::size_t b = 0; b <= a; ++b)
                            block.add(k - 1 + a, k - 1 + b, smoothness_ * bend[a] * bend[b]);
                // A point without neighbours or light leaves a block that cannot be inverted.
                for (std::size_t k = 0; k < knots_; ++k) block.add(k, k, 1e-9 * smoothness_);
                block.factorise();
            }
        });
    }
    void precondition(const Images& residual, Images& z) const {
        for_rows([&](std::size_t y) { blocks_.solve(residual, z, y * grid_.width, (y + 1) * grid_.width); });
    }

    /// Sum of a function of the index, in an order that does not depend on threads.
    template <class Term>
    [[nodiscard]] double sum(Term term) const {
        std::vector<double> row_sum(grid_.height, 0.0);
        for_rows([&](std::size_t y) {
            for (std::size_t k = 0; k < knots_; ++k) {
                const auto first = static_cast<std::size_t>(offset(k, y));
                for (std::size_t i = first; i < first + grid_.width; ++i) row_sum[y] += term(i);
            }
        });
        return std::accumulate(row_sum.begin(), row_sum.end(), 0.0);
    }

private:
    template <class Body>
    void for_rows(Body&& body) const {
        parallel_for(0, grid_.height, rows_per_task, body);
    }
    [[nodiscard]] std::ptrdiff_t offset(std::size_t knot, std::size_t row) const {
        return static_cast<std::ptrdiff_t>(knot * points_ + row * grid_.width);
    }
    [[nodiscard]] std::pair<double, double> shares(std::size_t r) const {
        return {rings_[r].low_share, 1 - rings_[r].low_share};
    }
    [[nodiscard]] double at(const Images& p, std::size_t r, std::size_t i, std::size_t next = 0) const {
        return p[(rings_[r].knot + next) * points_ + i];
    }
    [[nodiscard]] std::span<const double> of_knot(const Images& images, std::size_t k) const {
        return std::span(images).subspan(k * points_, points_);
    }
    [[nodiscard]] std::span<double> row_of(std::vector<double>& image, std::size_t y) const {
        return std::span(image).subspan(y * grid_.width, grid_.width);
    }
    void spread(Images& to, std::size_t r, std::size_t i, double value) const {
        const auto [low, high] = shares(r);
        to[rings_[r].knot * points_ + i] += low * value;
        to[(rings_[r].knot + 1) * points_ + i] += high * value;
    }
    [[nodiscard]] double bend_at(const Images& p, std::size_t k, std::size_t i) const {
        return p[(k - 1) * points_ + i] - 2 * p[k * points_ + i] + p[(k + 1) * points_ + i];
    }
    void add_smoothness(const Images& p, Images& to, std::size_t y) const {
        for (std::size_t k = 1; k + 1 < knots_; ++k)
            for (std::size_t i = y * grid_.width; i < (y + 1) * grid_.width; ++i) {
                const double bend = smoothness_ * bend_at(p, k, i);
                to[(k - 1) * points_ + i] += bend;
                to[k * points_ + i] -= 2 * bend;
                to[(k + 1) * points_ + i] += bend;
            }
    }

    /// Counts and pairs by point and knot: all that is taken from the data.
    void count(const optics::SampledBssrdf& responses, const optics::ChannelResponses& data) {
        counts_.assign(size(), 0.0);
        pairs_ = counts_;
        const auto offsets = optics::half_window(responses.radius);
        const int width = static_cast<int>(grid_.width), height = static_cast<int>(grid_.height);
        const auto ring_of = rings_of_half_window(rings_, responses.radius);
        for_rows([&](std::size_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < width; ++x) {
                const std::size_t i = row * grid_.width + static_cast<std::size_t>(x);
                counts_[i] += own_weight * static_cast<double>(data.pairs[i]) / noise_;
                pairs_[i] += own_weight;
                for (std::size_t s = 1; s < offsets.size(); ++s)
                    for (const int sign : {1, -1}) {
                        const int to_x = x + sign * offsets[s].x, to_y = y + sign * offsets[s].y;
                        if (to_x < 0 || to_y < 0 || to_x >= width || to_y >= height) continue;
                        const std::size_t from = sign > 0 ? i : static_cast<std::size_t>(to_y * width + to_x);
                        spread(counts_, ring_of[s], i,
                               0.5 * static_cast<double>(data.pairs[s * points_ + from]) / noise_);
                        spread(pairs_, ring_of[s], i, 0.5);
                    }
            }
        });
        all_counts_ = sum([&](std::size_t i) { return counts_[i]; });
    }

    PointGrid grid_;
    std::vector<ProfileRing> rings_;
    std::size_t points_, knots_;
    double smoothness_, noise_, all_counts_ = 0;
    Images counts_, pairs_;
    std::vector<std::vector<double>> root_;    ///< by ring: sqrt(P / noise)
    std::vector<std::vector<double>> around_;  ///< by ring: the sum of that over the ring's offsets
    std::vector<double> ring_image_;
    BandedBlocks blocks_;
};

/// Solves Hessian x = -g roughly; how many iterations it took.
int newton_step(Problem& problem, const Images& g, Images& x, double tolerance, int most) {
    Images downhill(g.size());
    for (std::size_t i = 0; i < g.size(); ++i) downhill[i] = -g[i];
    return conjugate_gradient(
        std::move(downhill), x, [&](const Images& d, Images& out) { problem.multiply(d, out); },
        [&](const Images& r, Images& out) { problem.precondition(r, out); },
        [&](const Images& a, const Images& b) { return problem.sum([&](std::size_t i) { return a[i] * b[i]; }); },
        tolerance, most);
}

/// Newton's steps, halved where they go too far.
Images minimise(Problem& problem, const LocalProfileOptions& options, FactorSummary& summary,
                const Progress* progress) {
    Images p = problem.start(), g(p.size()), step(p.size()), candidate(p.size());
    double value = problem.move_to(p);
    for (;;) {
        if (progress) progress->check_cancelled();
        problem.gradient(p, g);
        summary.residual = problem.sum([&](std::size_t i) { return std::abs(g[i]); }) / problem.all_counts();
        summary.converged = summary.residual <= options.tolerance;
        if (summary.converged || summary.steps == options.max_steps) return p;
        problem.prepare_blocks();
        summary.iterations +=
            newton_step(problem, g, step, std::clamp(summary.residual, 0.01, 0.1), options.max_iterations);
        const double slope = problem.sum([&](std::size_t i) { return g[i] * step[i]; });
        double length = 1, next = 0;
        const double rounding = 1e-13 * std::abs(value);
        for (int halvings = 0;; ++halvings) {
            for (std::size_t i = 0; i < p.size(); ++i) candidate[i] = p[i] + length * step[i];
            next = problem.move_to(candidate);
            if (next <= value + 1e-4 * length * slope + rounding) break;
            if (halvings == 30) {  // nothing to gain that rounding does not hide
                problem.move_to(p);
                return p;
            }
            length /= 2;
        }
        p.swap(candidate);
        value = next;
        ++summary.steps;
    }
}

}  // namespace

void LocalProfileOptions::validate() const {
    if (!(curvature > 0 && std::isfinite(curvature)))
        throw InputError(
            fmt::format("The curvature of local profiles is {}, expected a number above 0, such as 0.5.", curvature));
    if (!(tolerance > 0 && tolerance < 1))
        throw InputError(fmt::format(
            "The tolerance of the factorisation is {}, expected a number between 0 and 1, such as 1e-4.", tolerance));
    if (max_steps < 1 || max_iterations < 1)
        throw InputError(
            fmt::format("The factorisation may take {} steps of {} iterations; it needs at least one of both.",
                        max_steps, max_iterations));
}

LocalProfiles factor_responses(const optics::SampledBssrdf& responses, const LocalProfileOptions& options,
                               std::vector<FactorSummary>& summary, Progress* progress) {
    options.validate();
    LocalProfiles profiles{{responses.width, responses.height}, responses.radius, responses.pitch_mm, {}};
    summary.assign(responses.channels.size(), {});
    for (std::size_t c = 0; c < responses.channels.size(); ++c) {
        const optics::ChannelResponses& data = responses.channels[c];
        VOXTONE_EXPECT(data.pairs.size() == responses.points() * optics::half_window(responses.radius).size());
        if (!(*std::max_element(data.pairs.begin(), data.pairs.end()) > 0))
            throw InputError(
                fmt::format("Channel {} of the data set holds no light at all: there is nothing to be factored.", c));
        Problem problem(responses, data, options.curvature);
        ProfileImages P = minimise(problem, options, summary[c], progress);
        parallel_for(0, P.size(), 4096, [&](std::size_t i) { P[i] = problem.noise() * std::exp(P[i]); });
        profiles.channels.push_back(std::move(P));
        if (progress) progress->advance();
    }
    return profiles;
}

}  // namespace voxtone::scattering
