// SPDX-License-Identifier: GPL-3.0-or-later
//
// Composites of single-layer profiles against Monte Carlo of the composite (docs/profiles.md).
//
//   profile_laminates [paths, default 1048576] [picture.svg]
//
// Prints tables as Markdown: laminates of index-matched layers; the same between smooth surfaces to air; both in all
// directions, wave by wave (optics/profiles/wave_laminates.h); forward scattering at one reduced scattering; layers of
// another thickness than the known one. % are of the value itself.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "drawing.h"
#include "laminates.h"
#include "optics/profiles/wave_laminates.h"

using namespace voxtone::optics;
using namespace voxtone::optics::profile_laminates;

namespace {

const HankelGrid& grid() {
    static const HankelGrid hankel(10, 128);
    return hankel;
}

struct Bench {
    LayerPathOptions options;
    std::map<std::array<double, 4>, LayerProfile> known;  // by medium, g and thickness: every layer is traced once

    const LayerProfile& layer(const PlainLayer& of, double g) {
        const auto found = known.find(key(of, g));
        if (found != known.end()) return found->second;
        const ResinProfile made = resin_profile(of.medium, g, of.thickness_mm, grid(), options);
        return known.emplace(key(of, g), made.layer().of_thickness(of.thickness_mm)).first->second;
    }

    /// The surfaces of a scene as layers of their own.
    LayerProfile predicted(const LayerScene& scene) {
        LayerProfile all = smooth_surface(scene.eta_top, grid().size());
        for (const PlainLayer& of : scene.layers) all = laminate(all, layer(of, scene.g));
        return laminate(all, turned_over(smooth_surface(scene.eta_bottom, grid().size())));
    }

    static std::array<double, 4> key(const PlainLayer& of, double g) {
        return {of.medium.sigma_a, of.medium.sigma_s, g, of.thickness_mm};
    }
};

/// All of it in all directions, wave by wave.
LayerProfile by_waves(const Laminate& laminate, double g, double eta) {
    ResinSet set = vero_opaque();
    set.g = g;
    set.channels.wavelengths_nm = {540};
    for (Resin& resin : set.resins) {
        resin.sigma_t_per_mm = {resin.sigma_t_per_mm[laminate.channel]};
        resin.albedo = {resin.albedo[laminate.channel]};
    }
    std::vector<ResinLayer> layers;
    for (const LaminateLayer& of : laminate.layers)
        layers.push_back({static_cast<std::size_t>(set.find(of.role)), of.thickness_mm});
    const LaminateLight light = WaveLaminates(set, {eta, eta, 0}, grid(), {}).light(layers);
    return {light.T[0], light.R[0], light.R[0]};
}

struct Truth {
    std::vector<double> R, T;
    double R_error = 0, T_error = 0;
};

Truth traced(const LayerScene& scene, LayerPathOptions options) {
    options.seed += 1000;
    const TracedProfile profile = trace_layers(scene, grid(), options);
    RingLight T = profile.T;
    for (std::size_t i = 0; i < T.light.size(); ++i) T.light[i] += profile.T_direct.light[i];
    Truth truth;
    truth.R = grid().from_rings(profile.edges_mm, profile.R.light);
    truth.T = grid().from_rings(profile.edges_mm, T.light);
    truth.R_error = profile.R.standard_error;
    truth.T_error = std::hypot(profile.T.standard_error, profile.T_direct.standard_error);
    return truth;
}

// The radius that 80 % of the light stays within.
double width(const std::vector<double>& coefficients) {
    double inside = 0, outside = grid().reach_mm();
    for (int step = 0; step < 40; ++step) {
        const double r = 0.5 * (inside + outside);
        (grid().light_within(coefficients, r) < 0.8 * coefficients[0] ? inside : outside) = r;
    }
    return inside;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

void header(const char* title) {
    fmt::print(
        "\n### {}\n\n"
        "| laminate, mm | R | predicted | % of R | T | predicted | % of T | R^ off by | T^ off by | width of R, mm | "
        "predicted "
        "| of T | predicted |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        title);
}

void row(const std::string& name, const Truth& truth, const LayerProfile& model) {
    fmt::print(
        "| {} | {:.4f} ± {:.4f} | {:.4f} | {:+.1f} | {:.4f} ± {:.4f} | {:.4f} | {:+.1f} | {:.4f} | {:.4f} | {:.2f} | "
        "{:.2f} | "
        "{:.2f} "
        "| {:.2f} |\n",
        name, truth.R[0], truth.R_error, model.R_top[0], 100 * (model.R_top[0] / truth.R[0] - 1), truth.T[0],
        truth.T_error, model.T[0], 100 * (model.T[0] / truth.T[0] - 1), largest_difference(truth.R, model.R_top),
        largest_difference(truth.T, model.T), width(truth.R), width(model.R_top), width(truth.T), width(model.T));
    std::fflush(stdout);
}

// Both curves are drawn through the same blur, which takes the ripples of a series that ends.
Curve curve_of(const std::vector<double>& coefficients) {
    const std::vector<double> soft =
        grid().blurred(coefficients, 1.5 * grid().reach_mm() / static_cast<double>(grid().size()));
    Curve curve;
    for (int i = 0; i <= 120; ++i) {
        curve.r_mm.push_back(0.05 * i);
        curve.light.push_back(grid().profile(soft, curve.r_mm.back()));
    }
    return curve;
}

}  // namespace

int main(int argc, char** argv) {
    Bench bench;
    bench.options.paths = argc > 1 ? static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)) : 1u << 20;
    std::vector<Panel> panels;

    std::vector<Laminate> laminates = thick_laminates();
    for (const Laminate& films : film_laminates()) laminates.push_back(films);
    header("Index-matched layers");
    std::vector<Truth> matched;
    for (const Laminate& laminate : laminates) {
        const LayerScene scene = scene_of(laminate);
        const Truth& truth = matched.emplace_back(traced(scene, bench.options));
        const LayerProfile model = bench.predicted(scene);
        row(name_of(laminate), truth, model);
        panels.push_back({"R: " + name_of(laminate), curve_of(truth.R), curve_of(model.R_top)});
        panels.push_back({"T: " + name_of(laminate), curve_of(truth.T), curve_of(model.T)});
    }
    header("Index-matched layers, in all directions, wave by wave");
    for (std::size_t i = 0; i < laminates.size(); ++i)
        row(name_of(laminates[i]), matched[i], by_waves(laminates[i], 0.4, 1));
    if (argc > 2) std::ofstream(argv[2]) << draw_panels(panels, 4, 6);

    std::vector<Truth> in_air;
    for (const Laminate& laminate : laminates) in_air.push_back(traced(scene_of(laminate, 0.4, 1.5), bench.options));
    header("Between smooth surfaces to air, index 1.5: the surfaces as layers of their own");
    for (std::size_t i = 0; i < laminates.size(); ++i)
        row(name_of(laminates[i]), in_air[i], bench.predicted(scene_of(laminates[i], 0.4, 1.5)));

    header("Between smooth surfaces to air, index 1.5, in all directions, wave by wave");
    for (std::size_t i = 0; i < laminates.size(); ++i)
        row(name_of(laminates[i]), in_air[i], by_waves(laminates[i], 0.4, 1.5));

    header("Forward scattering: W 0.5 / K 0.2 with the same reduced scattering at every g");
    for (const double g : {-0.3, 0.0, 0.4, 0.8, 0.95}) {
        LayerScene scene = scene_of({{{"W", 0.5}, {"K", 0.2}}}, g);
        for (PlainLayer& of : scene.layers) of.medium.sigma_s *= (1 - 0.4) / (1 - g);
        row(fmt::format("g = {}", g), traced(scene, bench.options), bench.predicted(scene));
    }

    header("Layers of another thickness than the known one, 0.3 mm");
    for (const char* role : {"W", "Y", "C", "K"})
        for (const double mm : {0.054, 0.15, 0.6, 1.2}) {
            const LayerScene scene = scene_of({{{role, mm}}});
            const ResinProfile known = resin_profile(scene.layers[0].medium, 0.4, 0.3, grid(), bench.options);
            row(fmt::format("{} {}", role, mm), traced(scene, bench.options), known.layer().of_thickness(mm));
        }
    return 0;
}
