// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/edge/edge_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/contracts.h"
#include "optics/numerics/dense.h"
#include "optics/numerics/quadrature.h"

namespace voxtone::optics {
namespace {

constexpr double half_edges[] = {0.01, 0.02, 0.04, 0.06, 0.08, 0.1,  0.13, 0.16, 0.2,  0.25, 0.3, 0.36,
                                 0.43, 0.5,  0.6,  0.7,  0.8,  0.95, 1.1,  1.3,  1.5,  1.75, 2.0, 2.3,
                                 2.6,  3.0,  3.5,  4.0,  4.6,  5.3,  6.5,  8.0,  10.0, 14.0};

// Sums of counts times alpha^n.
struct Weighted {
    explicit Weighted(double albedo) : powers(order_bins().size()) {
        for (std::size_t n = 0; n < powers.size(); ++n) powers[n] = order_bins().mean_power(n, albedo);
    }
    [[nodiscard]] double light(const PathCounts& counts) const {
        double sum = 0;
        for (std::size_t n = 0; n < powers.size(); ++n) sum += powers[n] * counts.to_light[n];
        return sum / static_cast<double>(counts.paths);
    }
    [[nodiscard]] Eigen::VectorXd base(const PathCounts& counts) const {
        const std::size_t bins = distance_bins().size();
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins));
        for (std::size_t n = 0; n < powers.size(); ++n)
            for (std::size_t x = 0; x < bins; ++x)
                sum[static_cast<Eigen::Index>(x)] += powers[n] * counts.to_base[n * bins + x];
        return sum / static_cast<double>(counts.paths);
    }
    std::vector<double> powers;
};

// Share of a Gaussian-blurred pixel's sight that lies at a distance from its middle, per mm.
double sight(double distance, const PixelView& view) {
    const double half = view.pixel_mm / 2;
    if (view.blur_mm <= 0) return std::abs(distance) <= half ? 1 / view.pixel_mm : 0.0;
    const double s = view.blur_mm * std::numbers::sqrt2;
    return (std::erf((distance + half) / s) - std::erf((distance - half) / s)) / (2 * view.pixel_mm);
}

// One row of the map: sights of a pixel integrated against the parabolas.
class Reconstruction {
public:
    explicit Reconstruction(const EdgeCells& cells) : edges_(cells.edges()), last_(cells.size() - 1) {
        zero_ = static_cast<Eigen::Index>(std::ranges::find(edges_, 0.0) - edges_.begin());
    }

    // Adds weight * F(x) to the row, F as a combination of cell means.
    void add(double x, double weight, Eigen::Ref<Eigen::RowVectorXd> row) const {
        const auto above = std::upper_bound(edges_.begin(), edges_.end(), x) - edges_.begin();
        const Eigen::Index cell = above;
        if (cell == 0 || cell == last_) {
            row[cell] += weight;
            return;
        }
        const double a = edge(cell - 1), b = edge(cell), u = (x - a) / (b - a);
        // A parabola of mean m and ends l, r: l (1-u) + r u + 6 (m - (l+r)/2) u (1-u)
        const double bump = 6 * u * (1 - u);
        row[cell] += weight * bump;
        add_end(cell - 1, true, weight * (1 - u - bump / 2), row);
        add_end(cell, false, weight * (u - bump / 2), row);
    }

private:
    [[nodiscard]] double edge(Eigen::Index k) const { return edges_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] double width(Eigen::Index cell) const { return edge(cell) - edge(cell - 1); }

    // The value at edge k, as seen from the cell after it (`from_right`) or before it.
    void add_end(Eigen::Index k, bool from_right, double weight, Eigen::Ref<Eigen::RowVectorXd> row) const {
        if (k == 0 || k == last_ - 1) {  // the neighbour has no end: its value
            row[k == 0 ? 0 : last_] += weight;
        } else if (k == zero_) {  // from its own side only
            const Eigen::Index near = from_right ? k + 1 : k, next = from_right ? k + 2 : k - 1;
            const double slope = width(near) / (width(near) + width(next));
            row[near] += weight * (1 + slope);
            row[next] -= weight * slope;
        } else {
            const double before = width(k), after = width(k + 1);
            row[k] += weight * after / (before + after);
            row[k + 1] += weight * before / (before + after);
        }
    }

    const std::vector<double>& edges_;
    Eigen::Index last_, zero_ = 0;
};

}  // namespace

EdgeKernels edge_kernels(const PathBatch& batch, const EdgeUnits& units, double albedo) {
    const Weighted weighted(albedo);
    return {weighted.light(batch.camera) / units.window_share,
            weighted.base(batch.light).sum() / (units.base_index * units.base_index), weighted.base(batch.camera),
            weighted.base(batch.base)};
}

EdgeKernels edge_kernels(const EdgeCounts& counts, const EdgeUnits& units, double albedo) {
    EdgeKernels mean = edge_kernels(counts[0], units, albedo);
    for (std::size_t b = 1; b < edge_batches; ++b) {
        const EdgeKernels one = edge_kernels(counts[b], units, albedo);
        mean.from_camera += one.from_camera;
        mean.from_base += one.from_base;
        mean.P += one.P;
        mean.K += one.K;
    }
    constexpr double n = edge_batches;
    return {mean.from_camera / n, mean.from_base / n, mean.P / n, mean.K / n};
}

double far_from_edge(const EdgeKernels& kernels, double reflectance) {
    const double q = kernels.from_base / (1 - kernels.K.sum() * reflectance);
    return kernels.from_camera + kernels.P.sum() * reflectance * q;
}

EdgeCells::EdgeCells(int halvings) {
    std::vector<double> half{0};
    half.insert(half.end(), std::begin(half_edges), std::end(half_edges));
    for (int h = 0; h < halvings; ++h) {
        std::vector<double> finer{0};
        for (std::size_t k = 1; k < half.size(); ++k) {
            finer.push_back((half[k - 1] + half[k]) / 2);
            finer.push_back(half[k]);
        }
        half = std::move(finer);
    }
    for (std::size_t k = half.size() - 1; k > 0; --k) edges_.push_back(-half[k]);
    edges_.insert(edges_.end(), half.begin(), half.end());
    const auto& bins = distance_bins().edges();
    for (const double a : edges_)
        for (const double b : edges_) {
            const double d = std::abs(b - a);
            const std::size_t bin = std::min(distance_bins().of(d), bins.size() - 2);
            places_.push_back({bin, d - bins[bin]});
        }
}

// S_ij: of what goes from a place in cell i, on average over the cell, the share that comes to cell j. Only rows of
// cells that have ends.
Eigen::MatrixXd EdgeCells::pairs(const Eigen::VectorXd& kernel) const {
    const auto& bins = distance_bins().edges();
    const std::size_t n = bins.size() - 1, m = edges_.size();
    // First and second antiderivative of the even density, at the bins' edges.
    std::vector<double> density(n), first(n + 1, 0.0), second(n + 1, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        const double w = bins[k + 1] - bins[k];
        density[k] = kernel[static_cast<Eigen::Index>(k)] / (2 * w);
        first[k + 1] = first[k] + density[k] * w;
        second[k + 1] = second[k] + first[k] * w + density[k] * w * w / 2;
    }
    Eigen::MatrixXd C(m, m);  // second antiderivative at edge b - edge a
    for (std::size_t a = 0; a < m; ++a)
        for (std::size_t b = 0; b < m; ++b) {
            const Place& at = places_[a * m + b];
            C(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
                second[at.bin] + at.beyond * (first[at.bin] + density[at.bin] * at.beyond / 2);
        }
    const auto cells = static_cast<Eigen::Index>(m) - 1;
    const double total = first[n];  // one side
    Eigen::MatrixXd S(cells, cells + 2);
    for (Eigen::Index i = 0; i < cells; ++i) {
        const double w = edges_[static_cast<std::size_t>(i) + 1] - edges_[static_cast<std::size_t>(i)];
        for (Eigen::Index j = 0; j < cells; ++j)
            S(i, j + 1) = (C(i, j + 1) - C(i + 1, j + 1) - C(i, j) + C(i + 1, j)) / w;
        S(i, 0) = total - (C(i + 1, 0) - C(i, 0)) / w;
        S(i, cells + 1) = total - (C(i, cells) - C(i + 1, cells)) / w;
    }
    return S;
}

Eigen::VectorXd EdgeCells::profile(const EdgeKernels& kernels, const EdgeSheet& sheet) const {
    const auto cells = static_cast<Eigen::Index>(edges_.size()) - 1;
    const Eigen::MatrixXd K = pairs(kernels.K), P = pairs(kernels.P);
    Eigen::VectorXd R(cells + 2), q(cells + 2);
    R.head(cells / 2 + 1).setConstant(sheet.black);
    R.tail(cells / 2 + 1).setConstant(sheet.white);
    const double total = kernels.K.sum();
    q[0] = kernels.from_base / (1 - total * sheet.black);
    q[cells + 1] = kernels.from_base / (1 - total * sheet.white);
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::Identity(cells, cells) - K.middleCols(1, cells) * R.segment(1, cells).asDiagonal();
    const Eigen::VectorXd b =
        (K.col(0) * (R[0] * q[0]) + K.col(cells + 1) * (R[cells + 1] * q[cells + 1])).array() + kernels.from_base;
    q.segment(1, cells) = preimage(A, b);
    Eigen::VectorXd F(cells + 2);
    F.segment(1, cells) = (P * (R.array() * q.array()).matrix()).array() + kernels.from_camera;
    F[0] = far_from_edge(kernels, sheet.black);
    F[cells + 1] = far_from_edge(kernels, sheet.white);
    return F;
}

Eigen::MatrixXd pixels_from_cells(const EdgeCells& cells, const std::vector<double>& x_mm, const PixelView& view) {
    VOXTONE_EXPECT(view.pixel_mm > 0 && view.blur_mm >= 0 && view.stretch > 0);
    static const Rule rule = gauss_legendre(3, 0, 1);
    const Reconstruction reconstruction(cells);
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(x_mm.size()), cells.size());
    const double reach = view.pixel_mm / 2 + 4 * view.blur_mm;
    const double finest = view.blur_mm > 0 ? view.blur_mm / 2 : view.pixel_mm;
    for (std::size_t s = 0; s < x_mm.size(); ++s) {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(cells.size());
        const double from = x_mm[s] - reach, to = x_mm[s] + reach;
        std::vector<double> cuts{from};
        for (const double edge : cells.edges())
            if (edge * view.stretch > from && edge * view.stretch < to) cuts.push_back(edge * view.stretch);
        cuts.push_back(to);
        for (std::size_t k = 1; k < cuts.size(); ++k) {
            const double w = cuts[k] - cuts[k - 1];
            const int parts = std::max(1, static_cast<int>(std::ceil(w / finest)));
            for (int p = 0; p < parts; ++p)
                for (std::size_t r = 0; r < rule.x.size(); ++r) {
                    const double x = cuts[k - 1] + w * (p + rule.x[r]) / parts;
                    reconstruction.add(x / view.stretch, rule.w[r] * w / parts * sight(x - x_mm[s], view), row);
                }
        }
        map.row(static_cast<Eigen::Index>(s)) = row / row.sum();
    }
    return map;
}

}  // namespace voxtone::optics
