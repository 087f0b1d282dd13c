// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/mixture_descent.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::halftone {

namespace {

constexpr std::size_t grain = 512;  // cells

// Chosen on the fitting set (benchmarks/sets.json, without the colour checker and the gratings):
// `appearance_loop_benchmark slabs --crop 10x10 --set iterations=12` (docs/decisions/003); the
// most that rates may become, far from the target, on pieces of 8 x 6 mm by Monte Carlo, ten iterations.
constexpr float most_own_rate = 0.35f, most_shared_rate = 0.5f, least_rate = 0.01f;
constexpr float slower = 0.4f, own_faster = 2, shared_faster = 3;  // factors of a rate from step to step
// A step / the secant's: own ones go farther, for cells hinder each other less than they did along it.
constexpr float own_beyond = 1.3f, shared_beyond = 0.5f;
constexpr float momentum_share = 0.4f;  // mu; more makes bodies swing, whose cells share light over millimetres
constexpr float mean_scale = 0.2f;      // part of the cells' mean in s
constexpr float scale_kept = 0.9f;      // of s from step to step, at the least

/// Numbers per cell, layer and resin.
struct Table {
    std::size_t cells, resins, length;  ///< length = layers * resins
    explicit Table(const SkinMixtures& mixtures)
        : cells(mixtures.cells()), resins(mixtures.resins()), length(mixtures.layers() * mixtures.resins()) {}
    /// 1 - R h.
    [[nodiscard]] float rest() const { return 1 - static_cast<float>(resins) * least_fraction; }
    template <class Number>
    [[nodiscard]] std::span<Number> cell(std::vector<Number>& all, std::size_t c) const {
        return {all.data() + c * length, length};
    }
    void normalise(std::span<float> f) const {
        for (std::size_t first = 0; first < length; first += resins) {
            float sum = 0;
            for (std::size_t k = first; k < first + resins; ++k) sum += f[k];
            for (std::size_t k = first; k < first + resins; ++k) f[k] /= sum;
        }
    }
    /// The largest share of a layer takes what the others leave: scaling all of them would change the amounts of the
    /// small ones.
    void give_rest_to_largest(std::span<float> f) const {
        for (std::size_t first = 0; first < length; first += resins) {
            const std::span<float> layer = f.subspan(first, resins);
            const auto most = std::max_element(layer.begin(), layer.end());
            float others = 0;
            for (auto share = layer.begin(); share != layer.end(); ++share)
                if (share != most) others += *share;
            *most = std::max(1 - others, least_fraction);
        }
        normalise(f);
    }
    /// g - <g>_f.
    void take_means(std::span<const float> f, std::span<float> g) const {
        for (std::size_t first = 0; first < length; first += resins) {
            float mean = 0;
            for (std::size_t k = first; k < first + resins; ++k) mean += f[k] * g[k];
            for (std::size_t k = first; k < first + resins; ++k) g[k] -= mean;
        }
    }
};

Eigen::Vector3f three_of(const float* from, std::size_t count) {
    Eigen::Vector3f v = Eigen::Vector3f::Zero();
    for (std::size_t k = 0; k < count; ++k) v[static_cast<Eigen::Index>(k)] = from[k];
    return v;
}

/// S of each of `length` numbers per cell, in place.
void smooth_all(std::vector<float>& numbers, std::size_t length, const CellSmoothing& smooth) {
    std::vector<Eigen::Vector3f> three(numbers.size() / length);
    for (std::size_t first = 0; first < length; first += 3) {
        const std::size_t count = std::min<std::size_t>(3, length - first);
        parallel_for(0, three.size(), grain,
                     [&](std::size_t c) { three[c] = three_of(numbers.data() + c * length + first, count); });
        smooth(three);
        parallel_for(0, three.size(), grain,
                     [&](std::size_t c) { std::copy_n(three[c].data(), count, numbers.data() + c * length + first); });
    }
}

/// p = -d F / d rate along the shared part of the last step, resin by resin, and along the own part.
std::vector<float> directional_decreases(const Table& table, std::vector<float>& gradient, const CellSmoothing& smooth,
                                         DescentState& state) {
    const std::size_t parts = table.resins + 1;
    std::vector<float> decreases(table.cells * parts);
    parallel_for(0, table.cells, grain, [&](std::size_t c) {
        const auto f = state.mixtures.cell(c);
        const auto g = table.cell(gradient, c), m = table.cell(state.momentum, c), e = table.cell(state.shared, c);
        float* const decrease = decreases.data() + c * parts;
        float shared = 0, all = 0;
        for (std::size_t k = 0; k < table.length; ++k) {
            const float along = -f[k] * g[k] * e[k];
            decrease[k % table.resins] += along;
            shared += along;
            all += f[k] * g[k] * m[k];
        }
        decrease[table.resins] = all / state.divisor[c] - shared;
    });
    smooth_all(decreases, parts, smooth);
    return decreases;
}

/// The factor of a rate by the secant rule.
float secant_factor(float p0, float p1, float beyond, float faster) {
    if (!(p0 > 0)) return 1;  // momentum went uphill here: that says nothing of the rate
    if (p1 >= p0) return faster;
    return std::clamp(beyond * p0 / (p0 - p1), slower, faster);
}

void update_rates(const Table& table, std::span<const float> now, float near, DescentState& state) {
    const std::size_t parts = table.resins + 1;
    parallel_for(0, now.size(), grain, [&](std::size_t i) {
        const bool own = i % parts == table.resins;
        const float factor = secant_factor(state.decrease[i], now[i], own ? own_beyond : shared_beyond,
                                           own ? own_faster : shared_faster);
        state.rate[i] = std::clamp(state.rate[i] * factor, least_rate,
                                   std::max(least_rate, near * (own ? most_own_rate : most_shared_rate)));
    });
}

/// m and s.
void update_momentum(const Table& table, std::vector<float>& gradient, DescentState& state) {
    parallel_for(0, table.cells, grain, [&](std::size_t c) {
        const auto f = state.mixtures.cell(c);
        const auto g = table.cell(gradient, c), m = table.cell(state.momentum, c);
        float largest = 0;
        for (std::size_t k = 0; k < table.length; ++k) {
            largest = std::max(largest, std::abs(g[k]) * std::sqrt(f[k]));
            m[k] = momentum_share * m[k] + (1 - momentum_share) * g[k];
        }
        state.scale[c] = std::max(scale_kept * state.scale[c], largest);
    });
    double sum = 0;
    for (const float s : state.scale) sum += static_cast<double>(s);
    const float mean =
        mean_scale * static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, table.cells)));
    for (std::size_t c = 0; c < table.cells; ++c)
        state.divisor[c] = state.scale[c] + mean > 0 ? state.scale[c] + mean : 1;
}

/// e = S d.
void find_shared_direction(const Table& table, const CellSmoothing& smooth, DescentState& state) {
    parallel_for(0, table.cells, grain, [&](std::size_t c) {
        const auto m = table.cell(state.momentum, c), e = table.cell(state.shared, c);
        for (std::size_t k = 0; k < table.length; ++k) e[k] = m[k] / -state.divisor[c];
    });
    smooth_all(state.shared, table.length, smooth);
}

/// f exp(x), both parts of x; into `by_shared` what the shared one makes by itself.
void exponentiated_step(const Table& table, DescentState& state, std::vector<float>& by_shared) {
    const auto exponentiated = [](float f, float exponent) {
        return std::clamp(f * std::exp(std::clamp(exponent, -1.0f, 1.0f)), least_fraction, 1.0f);
    };
    parallel_for(0, table.cells, grain, [&](std::size_t c) {
        const std::span<float> f = state.mixtures.cell(c), a = table.cell(by_shared, c);
        const auto m = table.cell(state.momentum, c), e = table.cell(state.shared, c);
        const float* const rate = state.rate.data() + c * (table.resins + 1);
        for (std::size_t k = 0; k < table.length; ++k) {
            const float shared = rate[k % table.resins] * e[k];
            a[k] = exponentiated(f[k], shared);
            f[k] = exponentiated(f[k], shared - rate[table.resins] * (m[k] / state.divisor[c] + e[k]));
        }
        table.normalise(a);
        table.normalise(f);
    });
}

/// Smoothed amounts of resin become those of `wanted`; three numbers of a cell at a time, which saves two more tables.
void conserve_amounts(const Table& table, std::vector<float>& wanted, const CellSmoothing& smooth,
                      SkinMixtures& mixtures) {
    std::vector<Eigen::Vector3f> is(table.cells), should(table.cells);
    for (std::size_t first = 0; first < table.length; first += 3) {
        const std::size_t count = std::min<std::size_t>(3, table.length - first);
        parallel_for(0, table.cells, grain, [&](std::size_t c) {
            is[c] = three_of(mixtures.cell(c).data() + first, count);
            should[c] = three_of(table.cell(wanted, c).data() + first, count);
        });
        smooth(is);
        smooth(should);
        parallel_for(0, table.cells, grain, [&](std::size_t c) {
            for (std::size_t k = 0; k < count; ++k) {
                const auto i = static_cast<Eigen::Index>(k);
                if (is[c][i] > 0) mixtures.cell(c)[first + k] *= should[c][i] / is[c][i];
            }
        });
    }
    parallel_for(0, table.cells, grain, [&](std::size_t c) { table.give_rest_to_largest(mixtures.cell(c)); });
}

}  // namespace

DescentState begin_descent(SkinMixtures mixtures, const DescentRates& rates) {
    DescentState state;
    state.mixtures = std::move(mixtures);
    const Table table(state.mixtures);
    state.rate.assign(table.cells * (table.resins + 1), std::max(rates.shared, least_rate));
    for (std::size_t i = table.resins; i < state.rate.size(); i += table.resins + 1)
        state.rate[i] = std::max(rates.own, least_rate);
    state.momentum.assign(table.cells * table.length, 0.0f);
    state.scale.assign(table.cells, 0.0f);
    parallel_for(0, table.cells, grain, [&](std::size_t c) {
        table.normalise(state.mixtures.cell(c));
        for (float& f : state.mixtures.cell(c)) f = least_fraction + table.rest() * f;
    });
    return state;
}

void descend(std::vector<float> gradient, const CellSmoothing& smooth, DescentState& state, float near) {
    const Table table(state.mixtures);
    VOXTONE_EXPECT(gradient.size() == table.cells * table.length);
    parallel_for(0, table.cells, grain,
                 [&](std::size_t c) { table.take_means(state.mixtures.cell(c), table.cell(gradient, c)); });
    if (!state.shared.empty()) update_rates(table, directional_decreases(table, gradient, smooth, state), near, state);
    state.shared.resize(gradient.size());
    state.divisor.resize(table.cells);
    update_momentum(table, gradient, state);
    find_shared_direction(table, smooth, state);
    state.decrease = directional_decreases(table, gradient, smooth, state);
    exponentiated_step(table, state, gradient);
    conserve_amounts(table, gradient, smooth, state.mixtures);
}

SkinMixtures printed(const SkinMixtures& mixtures) {
    SkinMixtures out = mixtures;
    const float rest = Table(mixtures).rest();
    for (float& f : out.all()) f = std::max(f - least_fraction, 0.0f) / rest;
    return out;
}

}  // namespace voxtone::halftone
