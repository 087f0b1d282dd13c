// SPDX-License-Identifier: GPL-3.0-or-later
#include "make_reference.h"

#include <cmath>
#include <ctime>

#include "body_cases.h"
#include "colour_cases.h"
#include "flat_cases.h"
#include "optics/colour/colour.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "photo_cases.h"

namespace voxtone::accuracy {

using namespace optics;

namespace {

constexpr std::uint32_t pilot_paths = 1000, fewest = 1 << 9, most = 1 << 22;
constexpr std::uint64_t pilot_seed = 4711, white_seed = 1000;

/// Squared noise of a cell in CIEDE2000.
double noise_2(const Appearance& seen, std::size_t cell) {
    Eigen::Vector3d rgb;
    for (std::size_t c = 0; c < 3; ++c)
        rgb[static_cast<Eigen::Index>(c)] = static_cast<double>(seen.value[3 * cell + c]);
    const Eigen::Vector3d lab = lab_from_linear_srgb(rgb);
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        Eigen::Vector3d moved = rgb;
        // A dark channel that no path has reached yet is not free of noise.
        moved[static_cast<Eigen::Index>(c)] +=
            std::max(static_cast<double>(seen.standard_error[3 * cell + c]), 1.0 / pilot_paths);
        sum += std::pow(ciede2000(lab, lab_from_linear_srgb(moved)), 2);
    }
    return sum;
}

/// Paths of a half for every cell: those that the wanted noise takes, rounded up to a power of two.
std::vector<std::uint32_t> paths_wanted(const SuiteCase& c, const Surface& cells, double effort) {
    const Appearance seen = MonteCarlo({.paths = pilot_paths, .seed = pilot_seed, .boundary = c.true_boundary.get()})
                                .predict(c.scene(), cells);
    std::vector<std::uint32_t> wanted;
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        const double paths = effort * pilot_paths * noise_2(seen, i) / (2 * c.noise * c.noise);
        std::uint32_t n = fewest;
        while (n < most && n < paths) n *= 2;
        wanted.push_back(n);
    }
    return wanted;
}

/// Appearance of every cell of a surface with its own number of paths.
std::vector<float> trace(const Scene& scene, const BodyBoundary* boundary, const Surface& cells,
                         const std::vector<std::uint32_t>& wanted, std::uint64_t seed, std::uint64_t& paths) {
    std::vector<float> values(3 * cells.cells.size());
    for (std::uint32_t n = fewest; n <= most; n *= 2) {
        Groups chosen;
        for (std::size_t i = 0; i < wanted.size(); ++i)
            if (wanted[i] == n) chosen.first_cell.push_back(static_cast<std::uint32_t>(i));
        if (chosen.first_cell.empty()) continue;
        MonteCarloSummary summary;
        const MonteCarlo model({.paths = n, .seed = seed, .boundary = boundary});
        const Appearance seen = model.predict(scene, first_cells(cells, chosen), summary);
        for (std::size_t k = 0; k < chosen.first_cell.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c) values[3 * chosen.first_cell[k] + c] = seen.value[3 * k + c];
        paths += summary.paths;
    }
    return values;
}

/// The mean by area in every cell.
void make_one(const Surface& cells, std::vector<float>& values) {
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0, area = 0;
        for (std::size_t i = 0; i < cells.cells.size(); ++i) {
            sum += static_cast<double>(values[3 * i + c]) * static_cast<double>(cells.cells[i].area_mm2);
            area += static_cast<double>(cells.cells[i].area_mm2);
        }
        for (std::size_t i = 0; i < cells.cells.size(); ++i) values[3 * i + c] = static_cast<float>(sum / area);
    }
}

}  // namespace

std::vector<SuiteCase> suite_cases(const std::filesystem::path& models) {
    std::vector<SuiteCase> cases = flat_cases();
    for (SuiteCase& c : colour_cases()) cases.push_back(std::move(c));
    for (SuiteCase& c : photo_cases(models)) cases.push_back(std::move(c));
    for (SuiteCase& c : body_cases()) cases.push_back(std::move(c));
    return cases;
}

Reference make_reference(SuiteCase c, std::uint64_t seed, double effort) {
    const Surface whole = find_surface(c.scene(), viewing_cell, c.part);
    const Surface cells = first_cells(whole, group_cells(c, whole));
    Reference r;
    r.seed = seed;
    const std::vector<std::uint32_t> wanted = paths_wanted(c, cells, effort);
    const std::clock_t begin = std::clock();
    for (std::size_t half = 0; half < 2; ++half)
        r.half[half] = trace(c.scene(), c.true_boundary.get(), cells, wanted, seed + half, r.all_paths);
    r.core_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (c.sides == Sides::open) {
        const ResinVolume white = all_of(c.volume, c.white());
        Scene scene = c.scene();
        scene.volume = &white;
        std::uint64_t paths = 0;
        const std::vector<std::uint32_t> few(wanted.size(), fewest);
        for (std::size_t half = 0; half < 2; ++half) {
            r.white[half] = trace(scene, c.true_boundary.get(), cells, c.white_is_one ? few : wanted,
                                  seed + white_seed + half, paths);
            if (c.white_is_one) make_one(cells, r.white[half]);
        }
    }
    r.of = std::move(c);
    return r;
}

}  // namespace voxtone::accuracy
