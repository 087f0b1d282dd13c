// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogeneous.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "compare.h"
#include "optics/colour/colour.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;

constexpr Material mixture_material = 7;  // after C M Y K W T

/// The suite's resins and one more: this mixture of C M Y K W as a resin of its own.
ResinSet with_mixture(const std::array<double, 5>& fractions) {
    ResinSet set = suite_resins();
    std::vector<double> of_set(fractions.begin(), fractions.end());
    of_set.push_back(0);
    Resin mixture;
    mixture.name = mixture.role = "mixture";
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium medium = set.mix(of_set, c);
        mixture.sigma_t_per_mm.push_back(medium.sigma_t());
        mixture.albedo.push_back(medium.albedo());
    }
    set.resins.push_back(mixture);
    return set;
}

Eigen::Vector3d lab_of(const std::array<double, 3>& relative) {
    return lab_from_linear_srgb({std::max(0.0, relative[0]), std::max(0.0, relative[1]), std::max(0.0, relative[2])});
}

/// Mean over cells, per channel.
std::array<double, 3> mean_appearance(const TransportPredictor& predictor, const Scene& scene, const Surface& surface) {
    const Appearance seen = predictor.predict(scene, surface);
    std::array<double, 3> mean{};
    for (std::size_t i = 0; i < seen.value.size(); ++i)
        mean[i % 3] += static_cast<double>(seen.value[i]) / static_cast<double>(surface.cells.size());
    return mean;
}

using Turn = std::array<std::array<double, 3>, 3>;  // rows: the slab's axes in the world

/// About y by `tilt`, then about z by `around`, degrees.
Turn turned(double tilt, double around) {
    const double t = tilt * std::numbers::pi / 180, a = around * std::numbers::pi / 180;
    const double ct = std::cos(t), st = std::sin(t), ca = std::cos(a), sa = std::sin(a);
    return {{{ct * ca, ct * sa, -st}, {-sa, ca, 0}, {st * ca, st * sa, ct}}};
}

constexpr double slab_width_mm = 2.4, slab_thickness_mm = 1.0, looked_at_mm = 0.7, radius_mm = 1.2;

struct Seen {
    std::vector<std::array<double, 3>> rgb;  ///< media-relative
    std::vector<double> area;
    std::vector<std::array<float, 3>> normal;
    [[nodiscard]] std::array<double, 3> mean() const {
        std::array<double, 3> sum{};
        const double all = std::accumulate(area.begin(), area.end(), 0.0);
        for (std::size_t i = 0; i < rgb.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) sum[c] += rgb[i][c] * area[i] / all;
        return sum;
    }
};

template <class Keep>
Seen look_at(const TransportPredictor& predictor, const ResinSet& set, const ResinVolume& volume, Keep&& keep) {
    const ResinVolume white = all_of(volume, resin::W);
    const Scene scene{&volume, &set, Backing::none, Sides::open}, white_scene{&white, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const Appearance of_body = predictor.predict(scene, surface), of_white = predictor.predict(white_scene, surface);
    Seen seen;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const SurfaceCell& cell = surface.cells[i];
        if (!keep(cell)) continue;
        seen.rgb.push_back({});
        for (std::size_t c = 0; c < 3; ++c)
            seen.rgb.back()[c] =
                static_cast<double>(of_body.value[3 * i + c]) / static_cast<double>(of_white.value[3 * i + c]);
        seen.area.push_back(static_cast<double>(cell.area_mm2));
        seen.normal.push_back(cell.normal);
    }
    return seen;
}

Seen look_at_slab(const TransportPredictor& predictor, const ResinSet& set, const Turn& turn) {
    std::array<int, 3> size{};
    std::array<double, 3> middle{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double reach =
            (std::abs(turn[0][a]) + std::abs(turn[1][a])) * slab_width_mm + std::abs(turn[2][a]) * slab_thickness_mm;
        size[a] = static_cast<int>(std::ceil(reach / j750_mm[a])) + 2;
        middle[a] = 0.5 * size[a] * j750_mm[a] + 0.1 * j750_mm[a];  // not on a border of voxels
    }
    const auto along = [&](const std::array<double, 3>& p, std::size_t axis) {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) sum += turn[axis][a] * (p[a] - middle[a]);
        return sum;
    };
    const ResinVolume volume = make_resin_volume(size, j750_mm, [&](int x, int y, int z) {
        const std::array<double, 3> p{(x + 0.5) * j750_mm[0], (y + 0.5) * j750_mm[1], (z + 0.5) * j750_mm[2]};
        return std::abs(along(p, 0)) < slab_width_mm / 2 && std::abs(along(p, 1)) < slab_width_mm / 2 &&
                       std::abs(along(p, 2)) < slab_thickness_mm / 2
                   ? mixture_material
                   : air;
    });
    return look_at(predictor, set, volume, [&](const SurfaceCell& cell) {
        const std::array<double, 3> p{static_cast<double>(cell.centre_mm[0]), static_cast<double>(cell.centre_mm[1]),
                                      static_cast<double>(cell.centre_mm[2])};
        return std::abs(along(p, 0)) < looked_at_mm && std::abs(along(p, 1)) < looked_at_mm;
    });
}

Seen look_at_sphere(const TransportPredictor& predictor, const ResinSet& set) {
    std::array<int, 3> size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<int>(std::ceil(2 * radius_mm / j750_mm[a])) + 2;
    const ResinVolume volume = make_resin_volume(size, j750_mm, [&](int x, int y, int z) {
        const double dx = (x + 0.4 - 0.5 * size[0]) * j750_mm[0], dy = (y + 0.45 - 0.5 * size[1]) * j750_mm[1],
                     dz = (z + 0.55 - 0.5 * size[2]) * j750_mm[2];
        return std::hypot(dx, dy, dz) < radius_mm ? mixture_material : air;
    });
    return look_at(predictor, set, volume, [](const SurfaceCell&) { return true; });
}

/// Which of 26 directions, to the sides, edges and corners of a cube, a normal is nearest to.
std::size_t direction_of(const std::array<float, 3>& n) {
    std::size_t best = 0, index = 0;
    double nearest = -2;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const double length = std::hypot(x, y, z);
                if (length == 0) continue;
                const double cosine =
                    (x * static_cast<double>(n[0]) + y * static_cast<double>(n[1]) + z * static_cast<double>(n[2])) /
                    length;
                if (cosine > nearest) {
                    nearest = cosine;
                    best = index;
                }
                ++index;
            }
    return best;
}

Spread spread_of(std::string body, std::string colour, const std::vector<Seen>& parts) {
    Spread s{std::move(body), std::move(colour), 0, 0, 0, {}};
    Seen all;
    std::vector<Eigen::Vector3d> means;
    for (const Seen& part : parts) {
        if (part.rgb.empty()) continue;
        means.push_back(lab_of(part.mean()));
        s.lightness.push_back(means.back()[0]);
        all.rgb.insert(all.rgb.end(), part.rgb.begin(), part.rgb.end());
        all.area.insert(all.area.end(), part.area.begin(), part.area.end());
    }
    for (const auto& a : means)
        for (const auto& b : means) s.between = std::max(s.between, ciede2000(a, b));
    const Eigen::Vector3d mean = lab_of(all.mean());
    const double area = std::accumulate(all.area.begin(), all.area.end(), 0.0);
    std::vector<double> errors;
    for (std::size_t i = 0; i < all.rgb.size(); ++i) {
        errors.push_back(ciede2000(lab_of(all.rgb[i]), mean));
        s.cells_mean += errors.back() * all.area[i] / area;
    }
    s.cells_95 = weighted_percentile(errors, all.area, 0.95);
    return s;
}

}  // namespace

HomogeneousErrors compare_mixtures(TransportOptions options, int steps) {
    options.sweeps = 12;
    const TransportPredictor predictor(options);
    constexpr int layers = 40;
    const double thickness = layers * j750_mm[2];
    const auto slab_of = [](Material material) {
        return make_resin_volume({8, 4, layers}, j750_mm, [material](int, int, int) { return material; });
    };
    const ResinVolume volume = slab_of(mixture_material), white_volume = slab_of(resin::W);
    const ResinSet resins = suite_resins();
    const Scene white_scene{&white_volume, &resins, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(white_scene, viewing_cell, SurfacePart::top);
    const std::array<double, 3> white = mean_appearance(predictor, white_scene, surface);
    const std::vector<double> exact_white = exact_slab(resins, resin::W - 1, thickness, Backing::black);
    HomogeneousErrors result;
    std::vector<double> errors;
    for (int c = 0; c <= steps; ++c)
        for (int m = 0; c + m <= steps; ++m)
            for (int y = 0; c + m + y <= steps; ++y)
                for (int k = 0; c + m + y + k <= steps; ++k) {
                    const double n = steps;
                    const ResinSet set = with_mixture({c / n, m / n, y / n, k / n, (steps - c - m - y - k) / n});
                    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
                    const std::array<double, 3> seen = mean_appearance(predictor, scene, surface);
                    const std::vector<double> exact = exact_slab(set, mixture_material - 1, thickness, Backing::black);
                    std::array<double, 3> p{}, e{};
                    for (std::size_t i = 0; i < 3; ++i) {
                        p[i] = seen[i] / white[i];
                        e[i] = exact[i] / exact_white[i];
                        result.largest[i] = std::max(result.largest[i], std::abs(seen[i] - exact[i]));
                    }
                    errors.push_back(ciede2000(lab_of(p), lab_of(e)));
                    if (errors.back() > result.max) {
                        result.max = errors.back();
                        result.worst =
                            fmt::format("C {} M {} Y {} K {} W {} of {}", c, m, y, k, steps - c - m - y - k, steps);
                    }
                }
    const DifferenceSummary summary = summarize(errors);
    result.mixtures = errors.size();
    result.mean = summary.mean;
    result.percentile_95 = summary.percentile_95;
    return result;
}

std::vector<Spread> one_colour_bodies(const TransportOptions& options) {
    const TransportPredictor predictor(options);
    std::vector<Spread> table;
    struct Colour {
        const char* name;
        std::array<double, 5> fractions;
    };
    for (const Colour& colour : {Colour{"orange", {0, 0.15, 0.35, 0, 0.5}},
                                 {"dark blue", {0.4, 0.3, 0, 0.2, 0.1}},
                                 {"light grey", {0, 0, 0, 0.01, 0.99}}}) {
        const ResinSet set = with_mixture(colour.fractions);
        std::vector<Seen> tilts;
        for (const auto& [tilt, around] : {std::pair{0.0, 0.0},
                                           {10.0, 0.0},
                                           {25.0, 0.0},
                                           {45.0, 0.0},
                                           {60.0, 0.0},
                                           {80.0, 0.0},
                                           {90.0, 0.0},
                                           {35.0, 45.0},
                                           {60.0, 30.0},
                                           {45.0, 90.0},
                                           {90.0, 90.0}})
            tilts.push_back(look_at_slab(predictor, set, turned(tilt, around)));
        table.push_back(spread_of("slab, eleven tilts", colour.name, tilts));
        const Seen sphere = look_at_sphere(predictor, set);
        std::vector<Seen> directions(26);
        for (std::size_t i = 0; i < sphere.rgb.size(); ++i) {
            Seen& d = directions[direction_of(sphere.normal[i])];
            d.rgb.push_back(sphere.rgb[i]);
            d.area.push_back(sphere.area[i]);
        }
        table.push_back(spread_of("sphere", colour.name, directions));
    }
    return table;
}

}  // namespace voxtone::accuracy
