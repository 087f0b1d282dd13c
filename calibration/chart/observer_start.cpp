// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/observer_start.h"

#include <algorithm>
#include <cmath>

#include "optics/colour/colour.h"

namespace voxtone::calibration {

namespace {

double bell(double nm, double middle, double width) {
    const double x = (nm - middle) / width;
    return std::exp(-0.5 * x * x);
}

// 0 far below `edge`, 1 far above.
double step(double nm, double edge, double width) { return 1 / (1 + std::exp(-(nm - edge) / width)); }

double absorption(const ChartData& data, Eigen::Index resin, double nm) {
    const std::string& role = data.roles[static_cast<std::size_t>(resin)];
    if (role == "W") return 0.004;
    if (role == "C") return 0.02 + 2 * step(nm, 570, 15);
    if (role == "M") return 0.05 + 1.2 * bell(nm, 540, 30);
    if (role == "Y") return 0.003 + 2.5 * (1 - step(nm, 495, 8));
    if (role == "K") return 0.9;
    return absorption_by_colour(data.lab.row(purest_patch(data, resin)).transpose(), data.white, nm);
}

// How much of a resin a laminate shows: its share of the layers above the base, the uppermost counting once more.
double shown_of(const Patch& laminate, const std::string& role) {
    double sum = 2, of = laminate.top.front().role == role ? 2 : 0;
    for (std::size_t k = 0; k + 1 < laminate.under.size(); ++k) {
        sum += 1;
        if (laminate.under[k].role == role) of += 1;
    }
    return of / sum;
}

}  // namespace

double absorption_by_reflectance(double rho) {
    const double seen = std::clamp(rho, 0.02, 0.95);
    return (1 - seen) * (1 - seen) / (2 * seen);
}

double absorption_by_colour(const Eigen::Vector3d& lab, const Eigen::Vector3d& white, double nm) {
    const Eigen::Vector3d xyz = optics::adapt_white(optics::xyz_from_lab(lab, white), white, optics::d65_white());
    const Eigen::Vector3d rgb = optics::linear_srgb_from_xyz(xyz);
    const double blue = 1 - step(nm, 495, 8), red = step(nm, 585, 8), green = 1 - blue - red;
    return absorption_by_reflectance(red * rgb[0] + green * rgb[1] + blue * rgb[2]);
}

double start_nm(Eigen::Index channel, Eigen::Index channels) {
    const double first = 430, last = 650;
    return first + (last - first) * static_cast<double>(channel) / static_cast<double>(channels - 1);
}

Eigen::MatrixX3d start_weights(Eigen::Index channels) {
    Eigen::MatrixX3d weights(channels, 3);
    const double floor = 1e-3;
    for (Eigen::Index c = 0; c < channels; ++c) {
        const double nm = start_nm(c, channels);
        weights(c, 0) = 1.06 * bell(nm, 600, 38) + 0.36 * bell(nm, 445, 20) + floor;
        weights(c, 1) = bell(nm, 555, 42) + floor;
        weights(c, 2) = bell(nm, 450, 22) + floor;
    }
    for (Eigen::Index k = 0; k < 3; ++k) weights.col(k) /= weights.col(k).sum();
    return weights;
}

Eigen::Index purest_patch(const ChartData& data, Eigen::Index resin) {
    Eigen::Index best = 0;
    data.shares.col(resin).maxCoeff(&best);
    return best;
}

Eigen::Index white_resin(const ChartData& data) {
    const auto named = std::ranges::find(data.roles, "W");
    if (named != data.roles.end()) return named - data.roles.begin();
    Eigen::Index lightest = 0;
    for (Eigen::Index r = 1; r < data.resins(); ++r)
        if (data.lab(purest_patch(data, r), 0) > data.lab(purest_patch(data, lightest), 0)) lightest = r;
    return lightest;
}

ObserverParts observer_start(const ChartData& data, Eigen::Index channels) {
    ObserverParts start;
    start.a.resize(data.resins(), channels), start.s.setConstant(data.resins(), channels, 0.45);
    start.s.row(white_resin(data)).setOnes();
    start.weights = start_weights(channels);
    start.surface = 0.015, start.gain = 1;
    for (Eigen::Index c = 0; c < channels; ++c)
        for (Eigen::Index r = 0; r < data.resins(); ++r) start.a(r, c) = absorption(data, r, start_nm(c, channels));
    return start;
}

ObserverParts laminate_start(const ChartData& data, Eigen::Index channels) {
    constexpr double usual_scattering_per_mm = 3;
    ObserverParts start;
    start.weights = start_weights(channels);
    start.s.setConstant(data.resins(), channels, usual_scattering_per_mm);
    start.a.resize(data.resins(), channels);
    start.scattering.setOnes(channels);
    start.surface = 0.015, start.gain = 1, start.dot_spread = 0;
    const std::vector<Patch>& laminates = data.squares.patches;
    for (Eigen::Index r = 0; r < data.resins(); ++r) {
        const auto most = std::ranges::max_element(laminates, {}, [&](const Patch& laminate) {
            return shown_of(laminate, data.roles[static_cast<std::size_t>(r)]);
        });
        const Eigen::Vector3d lab =
            lab_of_roots() * data.squares.roots.row(most - laminates.begin()).transpose() - Eigen::Vector3d(16, 0, 0);
        for (Eigen::Index c = 0; c < channels; ++c)
            start.a(r, c) = usual_scattering_per_mm * absorption_by_colour(lab, data.white, start_nm(c, channels));
    }
    return start;
}

}  // namespace voxtone::calibration
