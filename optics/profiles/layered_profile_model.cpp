// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/layered_profile_model.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "optics/profiles/bounded_table.h"
#include "optics/profiles/column_sampling.h"
#include "optics/profiles/lateral_transport.h"
#include "optics/profiles/layer_profile.h"
#include "optics/profiles/saunderson.h"

namespace voxtone::optics {
namespace {

// Absorption and scattering of one resin in one channel, as the two models see it; mm^-1.
struct Coefficients {
    double K = 0, S = 0, sigma_a = 0, sigma_s = 0;
    void add(const Coefficients& other, double share) {
        K += share * other.K;
        S += share * other.S;
        sigma_a += share * other.sigma_a;
        sigma_s += share * other.sigma_s;
    }
};

// Of materials, [material * channels + channel]; 0 is air.
std::vector<Coefficients> coefficients_of(const ResinSet& set, double known_mm) {
    const std::size_t channels = set.channels.size();
    std::vector<Coefficients> all(channels * (set.resins.size() + 1));
    for (std::size_t m = 0; m < set.resins.size(); ++m)
        for (std::size_t c = 0; c < channels; ++c) {
            const Medium medium = set.resins[m].medium(c);
            const DiffuseTotals totals = diffuse_totals({{{medium, known_mm}}, set.g, 1, 1});
            // A resin that absorbs nothing loses nothing to rounding.
            const double T = medium.sigma_a > 0 ? totals.T : 1 - totals.R;
            const HomogeneousLayer layer(std::vector<double>{T}, std::vector<double>{totals.R}, known_mm);
            all[(m + 1) * channels + c] = {layer.K()[0], layer.S()[0], medium.sigma_a, medium.sigma_s};
        }
    return all;
}

struct Totals {
    double R_top = 0, R_bottom = 0, T = 1;
};

// Kubelka and Munk's layer (layer_profile.h): x and y of light from both sides, alike and opposed.
Totals homogeneous(const Coefficients& of, double mm) {
    const double gamma = std::sqrt(of.K * (of.K + 2 * of.S));
    const double t_over_gamma = gamma * mm > 1e-9 ? std::tanh(0.5 * gamma * mm) / gamma : 0.5 * mm;
    const double x = of.K * t_over_gamma, y = (of.K + 2 * of.S) * t_over_gamma;
    const double sum = (1 - x) / (1 + x), difference = (1 - y) / (1 + y);
    const double R = 0.5 * (sum - difference);
    return {R, R, 0.5 * (sum + difference)};
}

Totals upon(const Totals& upper, const Totals& lower) {
    const double between = 1 - upper.R_bottom * lower.R_top;
    return {upper.R_top + upper.T * upper.T * lower.R_top / between,
            lower.R_bottom + lower.T * lower.T * upper.R_bottom / between, upper.T * lower.T / between};
}

// The same for waves. To a wave, light that runs sideways is lost as if absorbed: of light that flies freely with a
// mean free path of 1 / sigma a wave leaves so much as if sigma were kappa / atan(kappa / sigma), for which stands
// (sigma + 2 sqrt(sigma^2 + kappa^2)) / 3 here: exact for long waves (diffusion), 5 % more for short ones.
struct WaveTotals {
    Waves R_top = Waves::Zero(), R_bottom = Waves::Zero(), T = Waves::Ones();
};

struct WaveRates {
    Waves A, B, gamma;  // K + 2 S, K, root of their product
    explicit WaveRates(const Coefficients& of) {
        // Two fluxes diffuse as light of this transport extinction does.
        const float sigma = std::max(static_cast<float>((of.K + 2 * of.S) / 1.5), 1e-3F);
        B = static_cast<float>(of.K) + 4.0F / 3 * ((sigma * sigma + wave_numbers().square()).sqrt() - sigma);
        A = B + 2 * static_cast<float>(of.S);
        gamma = (A * B).sqrt();
    }
};

WaveTotals waves_of(const Coefficients& of, double mm) {
    const WaveRates rates(of);
    const auto h = static_cast<float>(mm);
    const Waves t = (0.5F * h * rates.gamma).tanh(),
                t_over_gamma = (rates.gamma > 1e-4F).select(t / rates.gamma, 0.5F * h);
    const Waves x = rates.B * t_over_gamma, y = rates.A * t_over_gamma, below = (1 + x) * (1 + y);
    const Waves R = (y - x) / below;
    return {R, R, (1 - x * y) / below};
}

WaveTotals upon(const WaveTotals& upper, const WaveTotals& lower) {
    const Waves between = 1 / (1 - upper.R_bottom * lower.R_top);
    return {upper.R_top + upper.T.square() * lower.R_top * between,
            lower.R_bottom + lower.T.square() * upper.R_bottom * between, upper.T * lower.T * between};
}

Waves half_space_of_waves(const Coefficients& of) {
    const WaveRates rates(of);
    return (rates.A - rates.gamma) / (rates.A + rates.gamma);
}

// What an endless layer reflects.
double half_space(const Coefficients& of) {
    if (of.S == 0) return 0;
    const double a = of.K / of.S;
    return 1 + a - std::sqrt(a * (a + 2));
}

// Light that left on the side where it entered, and that came from the other side.
struct Seen {
    double R = 0, across = 0;
};

class Stacked {
public:
    Stacked(const std::vector<Coefficients>& coefficients, const BoundedTable& bounded, double bounded_mm,
            double turned_back, std::size_t channels)
        : coefficients_(coefficients),
          bounded_(bounded),
          bounded_mm_(bounded_mm),
          turned_back_(turned_back),
          channels_(channels) {}

    [[nodiscard]] Seen seen(const MaterialColumn& column, std::size_t channel) const {
        if (column.steps.empty()) return {};
        const bool ends = column.end != LayersEnd::endless;
        const double most_mm = std::min(bounded_mm_, ends ? 0.5 * column.mm : column.mm);
        const double top_mm = first_layer(column, most_mm, false);
        const double bottom_from = column.mm - (ends ? first_layer(column, most_mm, true) : 0);
        Coefficients top, bottom, last;
        Totals middle;
        double above = 0;
        for (const MaterialColumn::Step& step : column.steps) {
            last = mixture(column, step, channel);
            const double below = above + step.mm;
            const double in_top = std::clamp(top_mm - above, 0.0, step.mm),
                         in_bottom = std::clamp(below - bottom_from, 0.0, step.mm);
            top.add(last, in_top);
            bottom.add(last, in_bottom);
            const double rest = step.mm - in_top - in_bottom;
            if (rest > 1e-9) middle = upon(middle, homogeneous(last, rest));
            above = below;
        }
        const BoundedTotals first = bounded_.at(top.sigma_a, top.sigma_s);
        if (!ends) return {through(first, upon(middle, {half_space(last), 0, 0}).R_top), 0};
        const BoundedTotals other = bounded_.at(bottom.sigma_a, bottom.sigma_s);
        double R_other = other.R_bottom;
        if (column.end == LayersEnd::white_sheet) R_other += other.T_up * other.T_down / (1 - other.R_top);
        const double under = upon(middle, {R_other, 0, 0}).R_top, R = through(first, under);
        if (column.end != LayersEnd::open) return {R, 0};
        // As much light enters on the other side; so much of it comes up to the first layer.
        const double across = other.T_down * middle.T / (1 - middle.R_bottom * R_other);
        return {R, across * first.T_up / (1 - first.R_bottom * under)};
    }

    // R of the same layers without the surface, in waves of light, in parts of their total.
    [[nodiscard]] Waves shape(const MaterialColumn& column, std::size_t channel) const {
        constexpr float least = 1e-3F;  // deeper down is seen twice as little
        WaveTotals all;
        Coefficients last;
        for (std::size_t i = 0; i < column.steps.size() && all.T[0] >= least;) {
            const std::size_t first = i;
            double mm = 0;
            for (; i < column.steps.size() && alike(column, first, i); ++i) mm += column.steps[i].mm;
            last = mixture(column, column.steps[first], channel);
            all = upon(all, waves_of(last, mm));
        }
        const auto s = static_cast<float>(turned_back_);
        Waves below = Waves::Constant(column.end == LayersEnd::white_sheet ? 1.0F : s);
        if (column.end == LayersEnd::endless) below = half_space_of_waves(last);
        const Waves R = all.R_top + all.T.square() * below / (1 - all.R_bottom * below);
        return R / std::max(R[0], 1e-12F);
    }

private:
    // How thick the layer next to the surface is (from behind: next to the other one), most_mm at most: up to where the
    // mixture above and as much below it differ most, if they differ by three quarters or more; voxels of a halftone do
    // not, taken together.
    [[nodiscard]] double first_layer(const MaterialColumn& column, double most_mm, bool from_behind) const {
        constexpr std::size_t fewest = 2;
        constexpr float border = 0.75F;
        const std::size_t n = column.steps.size(), materials = coefficients_.size() / channels_;
        const auto step = [&](std::size_t i) -> const MaterialColumn::Step& {
            return column.steps[from_behind ? n - 1 - i : i];
        };
        double mm = 0, best_mm = most_mm;
        float most = border;
        for (std::size_t count = 1; 2 * count <= n; ++count) {
            mm += step(count - 1).mm;
            if (mm > most_mm) break;
            if (count < fewest) continue;
            float contrast = 0;
            for (std::size_t m = 1; m < materials; ++m) {
                float above = 0, below = 0;
                for (std::size_t i = 0; i < count; ++i) {
                    above += column.shares[step(i).first + m];
                    below += column.shares[step(count + i).first + m];
                }
                contrast += 0.5F * std::abs(above - below) / static_cast<float>(count);
            }
            if (contrast > most) most = contrast, best_mm = mm;
        }
        return best_mm;
    }

    [[nodiscard]] bool alike(const MaterialColumn& column, std::size_t a, std::size_t b) const {
        const auto materials = static_cast<std::ptrdiff_t>(coefficients_.size() / channels_);
        const auto of = column.shares.begin() + static_cast<std::ptrdiff_t>(column.steps[a].first);
        return a == b || std::equal(of, of + materials,
                                    column.shares.begin() + static_cast<std::ptrdiff_t>(column.steps[b].first));
    }

    [[nodiscard]] Coefficients mixture(const MaterialColumn& column, const MaterialColumn::Step& step,
                                       std::size_t channel) const {
        Coefficients mixed;
        const std::size_t materials = coefficients_.size() / channels_;
        for (std::size_t m = 1; m < materials; ++m)
            if (const float share = column.shares[step.first + m]; share > 0)
                mixed.add(coefficients_[m * channels_ + channel], share);
        return mixed;
    }

    // Through the surface layer, of what reflects R below it.
    static double through(const BoundedTotals& first, double R) {
        return first.R_top + first.T_down * R * first.T_up / (1 - first.R_bottom * R);
    }

    const std::vector<Coefficients>& coefficients_;
    const BoundedTable& bounded_;
    double bounded_mm_, turned_back_;
    std::size_t channels_;
};

double largest_depth(const ResinSet& set, double mm) {
    double sigma_t = 1e-6;
    for (const Resin& resin : set.resins)
        for (const double value : resin.sigma_t_per_mm) sigma_t = std::max(sigma_t, value);
    return sigma_t * mm;
}

}  // namespace

LayeredProfileModel::LayeredProfileModel(const LayeredProfileOptions& options) : options_(options) {
    VOXTONE_EXPECT(options.known_mm > 0 && options.bounded_mm > 0);
}

Appearance LayeredProfileModel::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    require_resins(scene);
    if (scene.backing == Backing::sheet)
        throw InputError("layered-profile knows black and white sheets alone; predict by transport or monte-carlo");
    const ResinSet& set = *scene.resins;
    Appearance appearance;
    appearance.channels = set.channels.size();
    appearance.value.resize(surface.cells.size() * appearance.channels);
    const std::vector<Coefficients> coefficients = coefficients_of(set, options_.known_mm);
    const BoundedTable bounded(set.g, set.eta, largest_depth(set, options_.bounded_mm), progress);
    const double turned_back = internal_diffuse_reflectance(set.eta);
    const ColumnSampler walk(scene);
    const Stacked stacked(coefficients, bounded, options_.bounded_mm, turned_back, appearance.channels);
    std::vector<GaussianWeights> profiles(options_.sideways ? appearance.value.size() : 0);
    parallel_ranges(
        0, surface.cells.size(), 256,
        [&](std::size_t first, std::size_t last) {
            MaterialColumn column;
            for (std::size_t cell = first; cell < last; ++cell) {
                walk.under(surface, surface.cells[cell], column);
                for (std::size_t c = 0; c < appearance.channels; ++c) {
                    const std::size_t at = cell * appearance.channels + c;
                    const Seen seen = stacked.seen(column, c);
                    if (options_.sideways)
                        profiles[at] = gaussian_weights(static_cast<float>(behind_surface(seen.R, turned_back)) *
                                                        stacked.shape(column, c));
                    appearance.value[at] = static_cast<float>(options_.sideways ? seen.across : seen.R + seen.across);
                }
            }
        },
        progress);
    if (!options_.sideways) return appearance;
    const std::vector<float> R =
        with_lateral_transport(surface_points(surface), profiles, appearance.channels, turned_back);
    for (std::size_t i = 0; i < R.size(); ++i) appearance.value[i] = std::min(1.0F, appearance.value[i] + R[i]);
    return appearance;
}

}  // namespace voxtone::optics
