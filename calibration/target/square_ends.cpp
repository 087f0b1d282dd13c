// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/square_ends.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "calibration/target/clear_wells.h"
#include "optics/scene/fresnel.h"

namespace voxtone::calibration {

namespace {

constexpr double cell_mm = 1, first_base_mm = 0.1, growth = 1.35;
constexpr std::size_t top_layers = 8;

/// Columns from the lower left, layers from the top.
struct Grid {
    std::size_t nx = 0, ny = 0;
    double dx = 0, dy = 0;
    std::vector<double> dz;
    std::vector<std::size_t> box;  ///< of each cell, layer by layer
    [[nodiscard]] std::size_t columns() const { return nx * ny; }
};

std::size_t cells_of(double mm) { return std::size_t(std::max(3.0, std::round(mm / cell_mm))); }

Grid grid_of(const Target& target, const std::vector<TargetBox>& boxes) {
    Grid grid;
    grid.nx = cells_of(target.size_mm.x()), grid.ny = cells_of(target.size_mm.y());
    grid.dx = target.size_mm.x() / double(grid.nx), grid.dy = target.size_mm.y() / double(grid.ny);
    grid.dz.assign(top_layers, target.top_mm / double(top_layers));
    double depth = 0;
    for (double d = first_base_mm; depth < target.base_mm; d *= growth) grid.dz.push_back(d), depth += d;
    for (std::size_t k = top_layers; k < grid.dz.size(); ++k) grid.dz[k] *= target.base_mm / depth;
    grid.box.assign(grid.columns() * grid.dz.size(), 0);
    for (std::size_t b = 0; b < boxes.size(); ++b) {
        if (boxes[b].min_mm.z() > 0 && boxes[b].min_mm.z() < target.base_mm - 1e-9) continue;  // deep: clear_wells.h
        const auto range = [](double from, double to, double d, std::size_t n) {
            const auto cell = [&](double mm) { return std::size_t(std::clamp(std::round(mm / d), 0.0, double(n))); };
            return std::pair{cell(from), cell(to)};
        };
        const auto [x0, x1] = range(boxes[b].min_mm.x(), boxes[b].max_mm.x(), grid.dx, grid.nx);
        const auto [y0, y1] = range(boxes[b].min_mm.y(), boxes[b].max_mm.y(), grid.dy, grid.ny);
        const std::size_t layers = boxes[b].min_mm.z() < target.base_mm ? grid.dz.size() : top_layers;
        for (std::size_t k = 0; k < layers; ++k)
            for (std::size_t y = y0; y < y1; ++y)
                std::fill_n(grid.box.begin() + std::ptrdiff_t(k * grid.columns() + y * grid.nx + x0), x1 - x0, b);
    }
    return grid;
}

/// (1 + R_j) / (1 - R_p): of currents and of densities that a smooth surface sends back.
double surface_factor(double eta) {
    constexpr int steps = 2000;
    double density = 0, current = 0;
    for (int i = 0; i < steps; ++i) {
        const double mu = (i + 0.5) / steps, in_air = 1 - eta * eta * (1 - mu * mu);
        const double r = in_air > 0 ? optics::fresnel_reflectance(std::sqrt(in_air), eta) : 1;
        density += 2 * mu * r / steps, current += 3 * mu * mu * r / steps;
    }
    return (1 + current) / (1 - density);
}

/// One channel: fluence by diffusion, with or without what columns exchange.
class Diffusion {
public:
    Diffusion(const Grid& grid, const std::vector<optics::Medium>& of_box, double g, double eta, bool air_below)
        : grid_(grid), n_(grid.columns()), layers_(grid.dz.size()) {
        const std::size_t all = n_ * layers_;
        source_.resize(all), seen_.resize(all), d_.resize(all), down_.resize(all), column_.resize(all);
        const double slanted = std::sqrt(0.5), refracted = optics::cosine_in_resin(slanted, eta);
        const double a = surface_factor(eta);
        scale_ = (1 - optics::fresnel_reflectance(1, eta)) * (1 - optics::fresnel_reflectance(slanted, eta)) /
                 (4 * eta * eta * refracted);
        std::vector<double> depth(n_, 0.0);
        for (std::size_t k = 0; k < layers_; ++k)
            for (std::size_t c = 0; c < n_; ++c) {
                const std::size_t i = k * n_ + c;
                const optics::Medium& medium = of_box[grid.box[i]];
                const double s = medium.sigma_s * (1 - g), t = std::max(medium.sigma_a + s, 1e-4), dz = grid.dz[k];
                const double after = depth[c] + t * dz;
                source_[i] = s / t * refracted * (std::exp(-depth[c] / refracted) - std::exp(-after / refracted));
                seen_[i] = s / t * (std::exp(-depth[c]) - std::exp(-after));
                d_[i] = 1 / (3 * t);
                column_[i] = medium.sigma_a * dz;
                depth[c] = after;
            }
        for (std::size_t k = 0; k + 1 < layers_; ++k)
            for (std::size_t c = 0; c < n_; ++c) {
                const std::size_t i = k * n_ + c, j = i + n_;
                down_[i] = 2 / (grid.dz[k] / d_[i] + grid.dz[k + 1] / d_[j]);
                column_[i] += down_[i], column_[j] += down_[i];
            }
        for (std::size_t c = 0; c < n_; ++c) {
            const std::size_t last = (layers_ - 1) * n_ + c;
            column_[c] += 1 / (2 * a + grid.dz.front() / (2 * d_[c]));
            column_[last] += 1 / ((air_below ? 2 * a : 2) + grid.dz.back() / (2 * d_[last]));
        }
    }

    /// pi L / E of each column.
    [[nodiscard]] std::vector<double> alone() const { return seen(by_column(column_, source_)); }

    /// Conjugate gradients, preconditioned by the columns' own exchange.
    [[nodiscard]] std::vector<double> together() const {
        constexpr int most_rounds = 500;
        constexpr double enough = 1e-9;  // of the squared residual
        std::vector<double> diagonal = column_;
        for_neighbours([&](std::size_t i, std::size_t j, double w) { diagonal[i] += w, diagonal[j] += w; });
        std::vector<double> x = by_column(diagonal, source_), r = source_, q = times(diagonal, x);
        for (std::size_t i = 0; i < r.size(); ++i) r[i] -= q[i];
        std::vector<double> z = by_column(diagonal, r), p = z;
        const double first = dot(source_, by_column(diagonal, source_));
        double rz = dot(r, z);
        for (int round = 0; round < most_rounds && rz > enough * first; ++round) {
            q = times(diagonal, p);
            const double step = rz / dot(p, q);
            for (std::size_t i = 0; i < r.size(); ++i) x[i] += step * p[i], r[i] -= step * q[i];
            z = by_column(diagonal, r);
            const double next = dot(r, z), turn = next / rz;
            rz = next;
            for (std::size_t i = 0; i < r.size(); ++i) p[i] = z[i] + turn * p[i];
        }
        return seen(x);
    }

private:
    using Values = std::vector<double>;

    static double dot(const Values& a, const Values& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
        return sum;
    }

    template <class Pair>
    void for_neighbours(const Pair& pair) const {
        const double x2 = grid_.dx * grid_.dx, y2 = grid_.dy * grid_.dy;
        const auto between = [&](std::size_t i, std::size_t j) { return 2 * d_[i] * d_[j] / (d_[i] + d_[j]); };
        for (std::size_t k = 0; k < layers_; ++k)
            for (std::size_t y = 0; y < grid_.ny; ++y)
                for (std::size_t x = 0; x < grid_.nx; ++x) {
                    const std::size_t i = k * n_ + y * grid_.nx + x;
                    if (x + 1 < grid_.nx) pair(i, i + 1, between(i, i + 1) * grid_.dz[k] / x2);
                    if (y + 1 < grid_.ny) pair(i, i + grid_.nx, between(i, i + grid_.nx) * grid_.dz[k] / y2);
                }
    }

    [[nodiscard]] Values times(const Values& diagonal, const Values& v) const {
        Values out(v.size());
        for (std::size_t i = 0; i < v.size(); ++i) out[i] = diagonal[i] * v[i];
        for (std::size_t i = 0; i + n_ < v.size(); ++i) {
            out[i] -= down_[i] * v[i + n_];
            out[i + n_] -= down_[i] * v[i];
        }
        for_neighbours([&](std::size_t i, std::size_t j, double w) { out[i] -= w * v[j], out[j] -= w * v[i]; });
        return out;
    }

    /// Each column by elimination.
    [[nodiscard]] Values by_column(const Values& diagonal, const Values& right) const {
        Values pivot = diagonal, x = right;
        for (std::size_t i = n_; i < x.size(); ++i) {
            const double w = down_[i - n_] / pivot[i - n_];
            pivot[i] -= w * down_[i - n_];
            x[i] += w * x[i - n_];
        }
        for (std::size_t i = x.size(); i-- > 0;) {
            if (i + n_ < x.size()) x[i] += down_[i] * x[i + n_];
            x[i] /= pivot[i];
        }
        return x;
    }

    [[nodiscard]] Values seen(const Values& fluence) const {
        Values sum(n_, 0.0);
        for (std::size_t i = 0; i < fluence.size(); ++i) sum[i % n_] += scale_ * seen_[i] * fluence[i];
        return sum;
    }

    const Grid& grid_;
    std::size_t n_, layers_;
    double scale_ = 0;
    Values source_, seen_, d_, down_, column_;
};

double middle_of(const Grid& grid, const Area& area, const std::vector<double>& of_column) {
    const Eigen::Vector2d rim = (1 - sampled_share) / 2 * area.size();
    const Eigen::Vector2d low = area.min_mm + rim, high = area.max_mm - rim;
    const auto cell = [](double mm, double d, std::size_t n) {
        return std::size_t(std::clamp(std::round(mm / d), 0.0, double(n - 1)));
    };
    const std::size_t x0 = cell(low.x(), grid.dx, grid.nx), y0 = cell(low.y(), grid.dy, grid.ny);
    const std::size_t x1 = std::max(x0 + 1, cell(high.x(), grid.dx, grid.nx));
    const std::size_t y1 = std::max(y0 + 1, cell(high.y(), grid.dy, grid.ny));
    double sum = 0;
    for (std::size_t y = y0; y < y1; ++y)
        for (std::size_t x = x0; x < x1; ++x) sum += of_column[y * grid.nx + x];
    return sum / double((x1 - x0) * (y1 - y0));
}

}  // namespace

double SquareLight::more(double rho) const {
    const double difference = together - alone;
    return difference < 0 && alone > 0 ? difference / alone * rho : difference;
}

LightOfSquares light_of_deep_squares(const Target& target, const optics::ResinSet& resins, double paths) {
    LightOfSquares light(target.squares.size());
    for (std::size_t s = 0; s < light.size(); ++s) {
        const TargetSquare& square = target.squares[s];
        if (square.depth_mm == 0) continue;
        const std::vector<double> alone = well_without_end(square, target.under_mm(square), resins),
                                  together =
                                      light_of_well(square, target.under_mm(square), resins, sampled_share, paths);
        for (std::size_t c = 0; c < alone.size(); ++c) light[s].push_back({alone[c], together[c]});
    }
    return light;
}

LightOfSquares light_of_squares(const Target& target, const optics::ResinSet& resins, bool air_below,
                                const LightOfSquares& deep) {
    VOXTONE_EXPECT(deep.size() == target.squares.size());
    const optics::ResinSet set = resins.subset(target.roles);
    const std::vector<TargetBox> boxes = target_boxes(target);
    const Grid grid = grid_of(target, boxes);
    LightOfSquares light(target.squares.size(), std::vector<SquareLight>(set.channels.size()));
    parallel_for(0, set.channels.size(), 1, [&](std::size_t c) {
        std::vector<optics::Medium> of_box;
        for (const TargetBox& box : boxes) of_box.push_back(set.mix(box.fractions, c));
        const Diffusion diffusion(grid, of_box, set.g, set.eta, air_below);
        const std::vector<double> alone = diffusion.alone(), together = diffusion.together();
        for (std::size_t s = 0; s < light.size(); ++s)
            light[s][c] = {middle_of(grid, target.squares[s].area, alone),
                           middle_of(grid, target.squares[s].area, together)};
    });
    for (std::size_t s = 0; s < light.size(); ++s)
        if (!deep[s].empty()) light[s] = deep[s];
    return light;
}

}  // namespace voxtone::calibration
