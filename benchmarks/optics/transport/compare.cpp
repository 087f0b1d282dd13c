// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "optics/colour/colour.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;

std::vector<Rgb> relative(const std::vector<float>& value, const std::vector<float>& white) {
    std::vector<Rgb> rgb(value.size() / 3);
    for (std::size_t i = 0; i < rgb.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) rgb[i][c] = std::max(0.0f, value[3 * i + c]) / white[3 * i + c];
    return rgb;
}

std::vector<float> mean_of(const std::vector<float>& a, const std::vector<float>& b) {
    std::vector<float> mean(a.size());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5f * (a[i] + b[i]);
    return mean;
}

/// The white of either half, per group and channel.
std::array<std::vector<float>, 2> white_of(const Reference& reference) {
    if (!reference.white[0].empty()) return reference.white;
    const SuiteCase& c = reference.of;
    const std::vector<double> exact =
        exact_slab(c.resins, c.white() - 1u, c.volume.size()[2] * c.volume.pitch_mm()[2], c.backing);
    std::vector<float> all(reference.half[0].size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<float>(exact[i % 3]);
    return {all, all};
}

Eigen::Vector3d lab(const Rgb& rgb) {
    return lab_from_linear_srgb(
        {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
}

ResinVolume refined(const ResinVolume& volume, const std::array<int, 3>& parts) {
    std::array<int, 3> size{};
    std::array<double, 3> pitch{};
    for (std::size_t a = 0; a < 3; ++a) {
        size[a] = volume.size()[a] * parts[a];
        pitch[a] = volume.pitch_mm()[a] / parts[a];
    }
    return make_resin_volume(size, pitch,
                             [&](int x, int y, int z) { return volume.at(x / parts[0], y / parts[1], z / parts[2]); });
}

}  // namespace

std::vector<double> exact_slab(const ResinSet& set, std::size_t resin, double thickness_mm, Backing backing) {
    const OrdinatePlan plan = appearance_plan(set.g, set.eta, 10, 10);
    const Admittance base =
        backing == Backing::white ? Admittance::white_sheet(plan) : Admittance::air(plan, backing == Backing::none);
    std::vector<double> seen;
    for (std::size_t channel = 0; channel < set.channels.size(); ++channel) {
        const LayerOf layer{set.resins[resin].medium(channel), thickness_mm};
        seen.push_back(layered_appearance(plan, std::span(&layer, 1), base));
    }
    return seen;
}

double weighted_percentile(std::span<const double> values, std::span<const double> weights, double share) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
    double below = 0;
    for (const std::size_t i : order)
        if ((below += weights[i]) >= share * all) return values[i];
    return 0;
}

Comparison compare(const Reference& reference, const TransportOptions& options, const std::array<int, 3>& refine) {
    const SuiteCase& c = reference.of;
    const ResinVolume volume = refined(c.volume, refine);
    Scene scene = c.scene();
    scene.volume = &volume;
    std::array<int, 3> cut_cell = viewing_cell;
    for (std::size_t a = 0; a < 3; ++a) cut_cell[a] *= refine[a];
    Comparison r;
    r.surface = find_surface(scene, cut_cell, c.part);
    const Groups groups = group_cells(c, r.surface);
    const TransportPredictor predictor(options);
    TransportSummary summary;
    const std::clock_t begin = std::clock();
    const Appearance seen = predictor.predict(scene, r.surface, summary);
    r.core_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    r.cells = r.surface.cells.size();
    r.optical_cells = summary.cells;
    const ResinVolume white_volume = all_of(volume, c.white());
    Scene white_scene = scene;
    white_scene.volume = &white_volume;
    const std::vector<float> seen_white = predictor.predict(white_scene, r.surface).value;
    r.predicted = relative(seen.value, seen_white);

    const auto white = white_of(reference);
    const std::vector<Rgb> half_1 = relative(reference.half[0], white[0]),
                           half_2 = relative(reference.half[1], white[1]),
                           both = relative(mean_of(reference.half[0], reference.half[1]), mean_of(white[0], white[1]));
    std::vector<double> errors, areas;
    for (const SurfaceCell& cell : r.surface.cells) areas.push_back(static_cast<double>(cell.area_mm2));
    r.area_mm2 = std::accumulate(areas.begin(), areas.end(), 0.0);
    double with_noise = 0, noise_2 = 0;
    for (std::size_t i = 0; i < r.cells; ++i) {
        const std::size_t g = groups.of_cell[i];
        const double share = areas[i] / r.area_mm2;
        for (std::size_t k = 0; k < 3; ++k) {
            const double m = 0.5 * static_cast<double>(white[0][3 * g + k] + white[1][3 * g + k]);
            r.white_bias[k] += share * (static_cast<double>(seen_white[3 * i + k]) / m - 1);
        }
        r.reference.push_back(both[g]);
        const Eigen::Vector3d p = lab(r.predicted[i]), m = lab(both[g]);
        const double error = ciede2000(p, m), noise = 0.5 * ciede2000(lab(half_1[g]), lab(half_2[g]));
        errors.push_back(error);
        r.error.push_back(static_cast<float>(error));
        r.mean += share * error;
        r.max = std::max(r.max, error);
        with_noise += share * error * error;
        noise_2 += share * noise * noise;
        r.noise += share * noise;
        r.bias += share * (p[0] - m[0]);
        for (std::size_t k = 0; k < 3; ++k)
            r.channel_bias[k] += share * static_cast<double>(r.predicted[i][k] - both[g][k]);
    }
    r.percentile_95 = weighted_percentile(errors, areas, 0.95);
    r.rms = std::sqrt(std::max(0.0, with_noise - noise_2));
    r.mean_without_noise = with_noise > 0 ? r.mean * r.rms / std::sqrt(with_noise) : 0;
    // Monte Carlo of all cells, without symmetry: its variance falls as one over the paths.
    const double all_cells = static_cast<double>(r.cells) / static_cast<double>(groups.first_cell.size());
    r.times_faster =
        reference.core_seconds * all_cells * noise_2 / std::max(0.01 * noise_2, r.rms * r.rms) / r.core_seconds;
    return r;
}

}  // namespace voxtone::accuracy
