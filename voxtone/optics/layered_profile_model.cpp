// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/layered_profile_model.h"

#include <algorithm>
#include <cmath>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/layer_profile.h"
#include "voxtone/optics/surfaced_table.h"

namespace voxtone::optics {
namespace {

constexpr double deepest_mm = 15;
constexpr double depth_steps = 16;  // a step of the walk is one voxel, deeper down a sixteenth of the depth
constexpr std::size_t most_walks = 16;

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

struct Step {
    double mm = 0;
    std::size_t first = 0;  // of its shares of materials
};

enum class End { endless, open, black_sheet, white_sheet };

// What lies under a cell: steps from the surface inwards, each with shares of materials.
struct Column {
    std::vector<Step> steps;
    std::vector<float> shares;
    End end = End::endless;
    double mm = 0;
};

class Walk {
public:
    explicit Walk(const Scene& scene) : scene_(scene), volume_(*scene.volume), materials_(scene.resins->resins.size() + 1) {
        step_mm_ = *std::min_element(volume_.pitch_mm().begin(), volume_.pitch_mm().end());
    }

    void under(const Surface& surface, const SurfaceCell& cell, Column& column) const {
        column.steps.clear();
        column.shares.clear();
        column.mm = 0;
        const std::size_t walks = std::min<std::size_t>(cell.faces, most_walks);
        std::vector<std::array<double, 3>> from;
        for (std::size_t w = 0; w < walks; ++w) from.push_back(centre(surface.faces[cell.first_face + w * cell.faces / walks]));
        std::vector<char> inside(walks, 1);
        std::size_t left = walks, on_sheet = 0;
        column.end = End::endless;
        while (column.mm < deepest_mm) {
            const double mm = std::max(step_mm_, column.mm / depth_steps), depth = column.mm + 0.5 * mm;
            std::vector<float> shares(materials_);
            for (std::size_t w = 0; w < walks; ++w) {
                if (!inside[w]) continue;
                bool below = false;
                const Material material = at(from[w], cell.normal, depth, below);
                if (material != air) {
                    shares[material] += 1;
                    continue;
                }
                inside[w] = 0;
                --left;
                on_sheet += below ? 1 : 0;
            }
            if (2 * left < walks || left == 0) {
                column.end = end(2 * on_sheet > walks);
                return;
            }
            for (float& share : shares) share /= static_cast<float>(left);
            column.steps.push_back({mm, column.shares.size()});
            column.shares.insert(column.shares.end(), shares.begin(), shares.end());
            column.mm += mm;
        }
    }

private:
    [[nodiscard]] std::array<double, 3> centre(const SurfaceFace& face) const {
        std::array<double, 3> place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = (face.voxel[a] + 0.5) * volume_.pitch_mm()[a];
        const auto axis = static_cast<std::size_t>(face.facing) / 2;
        place[axis] += (static_cast<int>(face.facing) % 2 == 1 ? 0.5 : -0.5) * volume_.pitch_mm()[axis];
        return place;
    }

    [[nodiscard]] Material at(const std::array<double, 3>& from, const std::array<float, 3>& normal, double depth,
                              bool& below) const {
        std::array<int, 3> voxel{};
        for (std::size_t a = 0; a < 3; ++a)
            voxel[a] = static_cast<int>(std::floor((from[a] - depth * normal[a]) / volume_.pitch_mm()[a]));
        below = voxel[2] < 0;
        if (scene_.sides == Sides::mirrored)
            for (std::size_t a = 0; a < 2; ++a) {
                const int n = volume_.size()[a];
                while (voxel[a] < 0 || voxel[a] >= n) voxel[a] = voxel[a] < 0 ? -1 - voxel[a] : 2 * n - 1 - voxel[a];
            }
        return volume_.at(voxel[0], voxel[1], voxel[2]);
    }

    [[nodiscard]] End end(bool on_plane) const {
        if (!on_plane || scene_.backing == Backing::none) return End::open;
        return scene_.backing == Backing::white ? End::white_sheet : End::black_sheet;
    }

    const Scene& scene_;
    const ResinVolume& volume_;
    std::size_t materials_;
    double step_mm_ = 0;
};

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

// What an endless layer reflects.
double half_space(const Coefficients& of) {
    if (of.S == 0) return 0;
    const double a = of.K / of.S;
    return 1 + a - std::sqrt(a * (a + 2));
}

class Stacked {
public:
    Stacked(const std::vector<Coefficients>& coefficients, const SurfacedTable& surfaced, double surfaced_mm,
            std::size_t channels)
        : coefficients_(coefficients), surfaced_(surfaced), surfaced_mm_(surfaced_mm), channels_(channels) {}

    [[nodiscard]] double appearance(const Column& column, std::size_t channel) const {
        if (column.steps.empty()) return 0;
        const bool ends = column.end != End::endless;
        const double most_mm = std::min(surfaced_mm_, ends ? 0.5 * column.mm : column.mm);
        const double top_mm = first_layer(column, most_mm, false);
        const double bottom_from = column.mm - (ends ? first_layer(column, most_mm, true) : 0);
        Coefficients top, bottom, last;
        Totals middle;
        double above = 0;
        for (const Step& step : column.steps) {
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
        const SurfacedTotals first = surfaced_.at(top.sigma_a, top.sigma_s);
        if (!ends) return seen(first, upon(middle, {half_space(last), 0, 0}).R_top);
        const SurfacedTotals other = surfaced_.at(bottom.sigma_a, bottom.sigma_s);
        double R_other = other.R_bottom;
        if (column.end == End::white_sheet) R_other += other.T_up * other.T_down / (1 - other.R_top);
        const double under = upon(middle, {R_other, 0, 0}).R_top, R = seen(first, under);
        if (column.end != End::open) return R;
        // As much light enters on the other side; so much of it comes up to the first layer.
        const double across = other.T_down * middle.T / (1 - middle.R_bottom * R_other);
        return R + across * first.T_up / (1 - first.R_bottom * under);
    }

private:
    // How thick the layer next to the surface is (from behind: next to the other one), most_mm at most: up to where the mixture
    // above and as much below it differ most, if they differ by three quarters or more; voxels of a halftone do not, taken
    // together.
    [[nodiscard]] double first_layer(const Column& column, double most_mm, bool from_behind) const {
        constexpr std::size_t fewest = 2;
        constexpr float border = 0.75F;
        const std::size_t n = column.steps.size(), materials = coefficients_.size() / channels_;
        const auto step = [&](std::size_t i) -> const Step& { return column.steps[from_behind ? n - 1 - i : i]; };
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

    [[nodiscard]] Coefficients mixture(const Column& column, const Step& step, std::size_t channel) const {
        Coefficients mixed;
        const std::size_t materials = coefficients_.size() / channels_;
        for (std::size_t m = 1; m < materials; ++m)
            if (const float share = column.shares[step.first + m]; share > 0)
                mixed.add(coefficients_[m * channels_ + channel], share);
        return mixed;
    }

    // Through the surface layer, of what reflects R below it.
    static double seen(const SurfacedTotals& first, double R) {
        return first.R_top + first.T_down * R * first.T_up / (1 - first.R_bottom * R);
    }

    const std::vector<Coefficients>& coefficients_;
    const SurfacedTable& surfaced_;
    double surfaced_mm_;
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
    VOXTONE_EXPECT(options.known_mm > 0 && options.surfaced_mm > 0);
}

Appearance LayeredProfileModel::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    expect_resins_for(scene);
    const ResinSet& set = *scene.resins;
    Appearance appearance;
    appearance.channels = set.channels.size();
    appearance.value.resize(surface.cells.size() * appearance.channels);
    const std::vector<Coefficients> coefficients = coefficients_of(set, options_.known_mm);
    const SurfacedTable surfaced(set.g, set.eta, largest_depth(set, options_.surfaced_mm), progress);
    const Walk walk(scene);
    const Stacked stacked(coefficients, surfaced, options_.surfaced_mm, appearance.channels);
    parallel_ranges(
        0, surface.cells.size(), 256,
        [&](std::size_t first, std::size_t last) {
            Column column;
            for (std::size_t cell = first; cell < last; ++cell) {
                walk.under(surface, surface.cells[cell], column);
                for (std::size_t c = 0; c < appearance.channels; ++c)
                    appearance.value[cell * appearance.channels + c] = static_cast<float>(stacked.appearance(column, c));
            }
        },
        progress);
    return appearance;
}

}  // namespace voxtone::optics
