// SPDX-License-Identifier: GPL-3.0-or-later
//
// Five slabs of one albedo and rising width: the experiment of Hasan et al. 2010, Sec. 8.2, with resins of the tree and
// Monte Carlo in the place of printer and camera (docs/laminate-search.md).
//
//   widening_experiment [FOLDER [paths, default 262144]]
//
// Materials: VeroWhite and VeroBlack (data/resins/vero-opaque.json, green), and a support as the paper's printer has
// it, clear with white in it: 5 % VeroWhite in a clear resin that does nothing, an ideal mixture. 5 mm at most on
// black, 64 steps, 6 blocks, support at least 0.2 mm below the surface, smooth surface to air, printed layers of 14 um
// (data/printers/stratasys-j750-hq.json). Coefficients weigh what they do beyond the edge of a shadow.
//
// Targets: the widest is what Monte Carlo sees of 0.2 mm of white upon 4.8 mm of support; the narrowest is 5 mm of
// white, scaled to the same total; three lie between in even shares. Every laminate found is traced anew with other
// random numbers. Prints the tables as Markdown, the second with every voxel of the printed slabs traced, support as a
// halftone; FOLDER gets widening.svg (profiles), widening-edge.svg and widening-edge.png (lit evenly and by a sharp
// edge).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "io/report/plot_svg.h"
#include "optics/media/resin_volume.h"
#include "optics/profiles/resin_laminate.h"
#include "optics/profiles/saunderson.h"
#include "optics/profiles/wave_laminates.h"
#include "scattering/design/laminate_design.h"
#include "scattering/design/laminate_materials.h"
#include "scattering/design/widening_targets.h"
#include "scattering/jobs/profile_plots.h"
#include "slicer/print/print_boxes.h"
#include "tests/optics/monte_carlo/point_spread.h"

using namespace voxtone;
using scattering::ChannelProfiles;

namespace {

constexpr double dc_weight = 1, white_in_support = 0.05, layer_mm = 0.014;
constexpr std::size_t W = 0, K = 1, support = 2, targets = 5;
constexpr const char* names[3] = {"W", "K", "S"};

// Green alone.
optics::ResinSet green_set() {
    const optics::ResinSet rgb = optics::vero_opaque();
    optics::ResinSet set = rgb;
    set.name = "white, black and support, green";
    set.channels.wavelengths_nm = {540};
    set.resins.clear();
    for (const char* role : {"W", "K"}) {
        optics::Resin resin = rgb.resins[static_cast<std::size_t>(rgb.find(role))];
        resin.sigma_t_per_mm = {resin.sigma_t_per_mm[1]};
        resin.albedo = {resin.albedo[1]};
        set.resins.push_back(resin);
    }
    const optics::Resin& white = set.resins[W];
    set.resins.push_back({"support", "S", {white_in_support * white.sigma_t_per_mm[0]}, white.albedo});
    set.validate();
    return set;
}

struct Slab {
    ChannelProfiles wanted;
    scattering::LaminateDesign plain, design;  // without and with correction by Monte Carlo
    std::vector<double> plain_seen, seen;
    double seen_error = 0;
    optics::RingLight rings;   // the same, by distance
    std::vector<double> edge;  // light at `edge_x`
};

std::string layers_text(const std::vector<scattering::LaminateLayer>& layers) {
    std::string text;
    for (const auto& [material, mm] : layers)
        text += fmt::format("{}{} {:.3f}", text.empty() ? "" : " / ", names[material], mm);
    return text;
}

// Light at x where all of the surface at x < 0 is lit: of a ring of radius r about the point a share acos(x / r) / pi
// is lit.
double beside_edge(const optics::TracedProfile& profile, double x) {
    double light = 0;
    for (std::size_t ring = 0; ring < profile.R.light.size(); ++ring) {
        const double r = 0.5 * (profile.edges_mm[ring] + profile.edges_mm[ring + 1]);
        light += profile.R.light[ring] * std::acos(std::clamp(x / r, -1.0, 1.0)) / std::numbers::pi;
    }
    return light;
}

// The slab as it is printed, voxel by voxel (slicer/print/print_boxes.h): 24 x 24 mm with mirrors at its sides,
// light enters evenly over the 4 x 4 mm in the middle, 10 mm from the sides. In contact with black (an ideal ink of
// 0.056 mm below) or laid on black paper, with a film of air between.
struct InVoxels {
    optics::RingLight on_black, on_paper;
};
InVoxels seen_in_voxels(const optics::ResinSet& set, const optics::HankelGrid& grid,
                        const std::vector<scattering::LaminateLayer>& layers, std::uint32_t paths) {
    constexpr double side_mm = 24, entry_mm = 4;
    constexpr int ink_layers = 4;
    optics::ResinSet pure = set;  // W, K, clear, ink
    pure.resins[support] = {"clear", "T", {0}, {1}};
    pure.resins.push_back({"ideal black", "B", {1000}, {0}});
    const slicer::PrinterProfile printer = slicer::find_printer("stratasys-j750-hq");
    InVoxels seen;
    for (const bool contact : {true, false}) {
        std::vector<slicer::PrintBox> boxes;
        double top = contact ? ink_layers * layer_mm : 0;
        if (contact) boxes.push_back({{0, 0, 0}, {side_mm, side_mm, top}, {0, 0, 0, 1}});
        for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
            std::vector<double> shares(4, 0.0);
            shares[layer->material] = 1;
            if (layer->material == support) shares = {white_in_support, 0, 1 - white_in_support, 0};
            boxes.push_back({{0, 0, top}, {side_mm, side_mm, top + layer->thickness_mm}, shares});
            top += layer->thickness_mm;
        }
        const slicer::BoxLayers print(boxes, {side_mm, side_mm, top}, printer.sliced_pitch_um(), 8);
        const auto [width, depth, height] = print.size();
        optics::ResinVolumeBuilder builder(
            {int(width), int(depth), int(height)},
            {printer.sliced_pitch_mm().x(), printer.sliced_pitch_mm().y(), printer.sliced_pitch_mm().z()});
        std::vector<optics::Material> voxels(std::size_t{width} * depth);
        for (std::uint32_t k = 0; k < height; ++k) {
            const io::LayerRuns runs = print.layer(k);
            for (std::uint32_t row = 0; row < depth; ++row) {
                auto voxel = voxels.begin() + std::ptrdiff_t(depth - 1 - row) * std::ptrdiff_t(width);
                for (const io::Run& run : runs.row(row))
                    voxel = std::fill_n(voxel, run.length, static_cast<optics::Material>(run.material));
            }
            builder.add_layer(voxels);
        }
        const optics::ResinVolume volume = builder.finish();
        const optics::Scene scene{&volume, &pure, optics::Backing::black, optics::Sides::mirrored};
        optics::testing::PointSpreadOptions options;
        options.edges_mm = optics::ring_edges(grid);
        options.paths = paths;
        options.seed = 5;
        for (std::size_t a = 0; a < 2; ++a) {
            const double pitch = volume.pitch_mm()[a];
            options.first[a] = static_cast<int>((side_mm - entry_mm) / 2 / pitch);
            options.end[a] = static_cast<int>((side_mm + entry_mm) / 2 / pitch);
        }
        (contact ? seen.on_black : seen.on_paper) = optics::testing::trace_point_spread(scene, options)[0];
    }
    return seen;
}

constexpr double edge_mm = 5;
constexpr int edge_samples = 200;
double edge_x(int i) { return edge_mm * (2.0 * (i + 0.5) / edge_samples - 1); }

// Samples of 10 mm: above under even light, below lit to the left of a sharp edge. Exposed so that the brightest is
// 0.9.
io::Picture8 edge_picture(const std::vector<Slab>& slabs) {
    constexpr std::uint32_t side = edge_samples, gap = 10;
    io::LinearPicture picture{gap + (side + gap) * targets, gap + 2 * (side + gap), {}};
    picture.pixels.assign(std::size_t{picture.width_px} * picture.height_px, Eigen::Vector4f(0.05F, 0.05F, 0.05F, 1));
    double most = 0;
    for (const Slab& slab : slabs) most = std::max(most, slab.seen[0]);
    for (std::uint32_t column = 0; column < targets; ++column)
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const std::size_t left = gap + column * (side + gap) + x;
                const auto put = [&](std::size_t top, double light) {
                    const auto value = static_cast<float>(0.9 * light / most);
                    picture.pixels[(top + y) * picture.width_px + left] = {value, value, value, 1};
                };
                put(gap, slabs[column].seen[0]);
                put(2 * gap + side, slabs[column].edge[x]);
            }
    return io::encode_over(picture, Eigen::Vector3f::Zero());
}

std::string edge_plot(const std::vector<Slab>& slabs) {
    io::Plot plot({-2, edge_mm, false, {-2, -1, 0, 1, 2, 3, 4, 5}, "distance from the edge into the shadow, mm"},
                  {1e-4, 1, true, {1e-3, 1e-2, 0.1, 1}, "light / light far from the edge"}, "Lit up to a sharp edge",
                  420, 280);
    constexpr const char* colours[targets] = {"#08306b", "#2171b5", "#41ab5d", "#fe9929", "#cc4c02"};
    double legend = 0.7;
    for (std::size_t t = 0; t < slabs.size(); ++t) {
        io::Plot::Points points;
        for (int i = 0; i < edge_samples; ++i)
            if (edge_x(i) > -2)
                points.emplace_back(edge_x(i), slabs[t].edge[static_cast<std::size_t>(i)] / slabs[t].seen[0]);
        plot.line(points, colours[t]);
        plot.label(3, legend,
                   fmt::format("{}{}", t + 1,
                               t == 0             ? " (narrowest)"
                               : t + 1 == targets ? " (widest)"
                                                  : ""),
                   colours[t]);
        legend /= 1.5;
    }
    std::string svg = plot.svg();
    return svg.insert(4, " xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" style=\"background:white\"");
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1u << 18);
    const optics::ResinSet set = green_set();
    const optics::HankelGrid grid(12, 64);
    const optics::LaminateEnds ends{set.eta, 1, 0};
    const optics::LayerPathOptions tracing{paths, 1}, checking{4 * paths, 99};
    const auto traced = [&](std::span<const scattering::LaminateLayer> layers,
                            const optics::LayerPathOptions& options) {
        std::vector<optics::ResinLayer> of_resin;
        for (const auto& [material, mm] : layers) of_resin.push_back({material, mm});
        return optics::traced_light(set, of_resin, ends, grid, options);
    };

    const std::vector<scattering::LaminateLayer> translucent{{W, 0.2}, {support, 4.8}}, solid{{W, 5}};
    const std::vector<double> wide = traced(translucent, tracing).R[0], narrow = traced(solid, tracing).R[0];
    std::printf("translucent sample: R %.4f, white: R %.4f\n\n", wide[0], narrow[0]);

    std::vector<scattering::LaminateMaterial> materials;
    scattering::LaminateDesignOptions options;
    for (std::size_t m = 0; m < 3; ++m) {
        const double known[] = {
            scattering::fitting_known_mm(set.resins[m].medium(0), set.g, options.search.thickness_mm)};
        materials.push_back(scattering::resin_material(set, m, known, grid, tracing));
    }
    options.search.clear_top_mm = {0, 0, 0.2};
    options.turned_back = optics::internal_diffuse_reflectance(set.eta);
    options.layer_mm = layer_mm;
    options.rounds = 3;
    options.search.dc_weight = dc_weight;
    options.search.edge_weights = true;
    const scattering::LaminateSearch search(materials, options.search);
    const optics::WaveLaminates waves(set, ends, grid, {4, 4, 4, 0.001});
    const scattering::LaminateJudge judge = [&](std::span<const scattering::LaminateLayer> layers) {
        std::vector<optics::ResinLayer> of_resin;
        for (const auto& [material, mm] : layers) of_resin.push_back({material, mm});
        return waves.light(of_resin).R;
    };

    const std::vector<ChannelProfiles> wanted = scattering::widening_targets({narrow}, {wide}, targets);
    std::vector<Slab> slabs(targets);
    for (std::size_t t = 0; t < targets; ++t) {
        Slab& slab = slabs[t];
        slab.wanted = wanted[t];
        slab.plain = design_laminate(search, materials, slab.wanted, options);
        slab.design = design_laminate(search, materials, slab.wanted, options, judge);
        slab.plain_seen = traced(slab.plain.layers, checking).R[0];
        const optics::LaminateLight light = traced(slab.design.layers, checking);
        slab.seen = light.R[0];
        slab.seen_error = light.R_error[0];
        optics::LayerScene scene{{}, set.g, ends.eta_top, 1};
        for (const auto& [material, mm] : slab.design.layers)
            scene.layers.push_back({set.resins[material].medium(0), mm});
        const optics::TracedProfile profile = optics::trace_layers(scene, grid, checking);
        slab.rings = profile.R;
        for (int i = 0; i < edge_samples; ++i) slab.edge.push_back(beside_edge(profile, edge_x(i)));
    }

    const auto radius = [&](const std::vector<double>& R, double share) {
        return optics::radius_of_share(grid, R, share);
    };
    std::printf(
        "| slab | layers from the top, mm | R wanted | R | 50 %% within, wanted, mm | 50 %% within | 80 %% within, "
        "wanted | 80 "
        "%% within | "
        "distance | uncorrected: R | 80 %% within |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (std::size_t t = 0; t < targets; ++t) {
        const Slab& slab = slabs[t];
        const ChannelProfiles seen(1, slab.seen);
        std::printf("| %zu | %s | %.4f | %.4f ± %.4f | %.2f | %.2f | %.2f | %.2f | %.4f | %.4f | %.2f |\n", t + 1,
                    layers_text(slab.design.layers).c_str(), slab.wanted[0][0], slab.seen[0], slab.seen_error,
                    radius(slab.wanted[0], 0.5), radius(slab.seen, 0.5), radius(slab.wanted[0], 0.8),
                    radius(slab.seen, 0.8), scattering::profile_distance(seen, slab.wanted, {dc_weight, true}),
                    slab.plain_seen[0], radius(slab.plain_seen, 0.8));
    }
    std::printf(
        "\n| slab | R in layers | R in voxels | 50 %% within, layers | voxels | 80 %% within, wanted | layers | voxels "
        "| on black paper, voxels: R | 50 "
        "%% within | 80 %% within |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    const std::vector<double> edges = optics::ring_edges(grid);
    for (std::size_t t = 0; t < targets; ++t) {
        const Slab& slab = slabs[t];
        const InVoxels voxels = seen_in_voxels(set, grid, slab.design.layers, paths);
        const auto within = [&](const optics::RingLight& light, double share) {
            return optics::testing::radius_of_share(light, edges, share);
        };
        std::printf("| %zu | %.4f ± %.4f | %.4f ± %.4f | %.2f | %.2f | %.2f | %.2f | %.2f | %.4f | %.2f | %.2f |\n",
                    t + 1, slab.seen[0], slab.seen_error, voxels.on_black.total, voxels.on_black.standard_error,
                    within(slab.rings, 0.5), within(voxels.on_black, 0.5), radius(slab.wanted[0], 0.8),
                    within(slab.rings, 0.8), within(voxels.on_black, 0.8), voxels.on_paper.total,
                    within(voxels.on_paper, 0.5), within(voxels.on_paper, 0.8));
        std::fflush(stdout);
    }
    if (argc < 2) return 0;
    const std::filesystem::path folder(argv[1]);
    std::filesystem::create_directories(folder);
    // Slabs side by side, as channels are elsewhere.
    scattering::ProfileRow row{
        "", {{"wanted", "black", {}, false}, {"layers", "#2266dd", {}, true}, {"Monte Carlo", "#cc2222", {}, true}}};
    std::vector<std::string> titles;
    for (std::size_t t = 0; t < targets; ++t) {
        titles.push_back(fmt::format("Slab {}", t + 1));
        row.curves[0].coefficients.push_back(slabs[t].wanted[0]);
        row.curves[1].coefficients.push_back(slabs[t].design.modelled[0]);
        row.curves[2].coefficients.push_back(slabs[t].seen);
    }
    io::write_whole_file(folder / "widening.svg", scattering::profile_plots(grid, titles, {row}, 6));
    io::write_whole_file(folder / "widening-edge.svg", edge_plot(slabs));
    io::write_whole_file(folder / "widening-edge.png", io::png_bytes(edge_picture(slabs)));
    return 0;
}
