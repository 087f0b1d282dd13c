// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each part of the virtual setup does to a profile: the same slab with everything, and with one part switched off
// after the other, as a drawing (docs/edge-setup-parts.svg). Under it what is left when the profile with everything is
// taken off. Run:
//   build/release/benchmarks/edge_parts FILE.svg [PATHS 2097152]
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibration/edge/edge_dictionary.h"
#include "io/report/plot_svg.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

struct Part {
    const char* name;
    const char* colour;
    EdgeSetup setup;
};

std::vector<Part> parts() {
    const EdgeSetup all;
    EdgeSetup no_gel = all, no_glass = all, no_surface = all, smooth = all, bare = all;
    no_gel.assembly.gel = false;
    no_glass.assembly.glass = false;
    no_surface.assembly.sheet_surface = false;
    smooth.assembly.slab_roughness = smooth.assembly.sheet_roughness = 0;
    bare.assembly.gel = bare.assembly.glass = bare.assembly.sheet_surface = false;
    bare.assembly.slab_roughness = 0;
    return {{"everything", "#222", all},         {"no gel", "#1565c0", no_gel},
            {"no glass", "#2e7d32", no_glass},   {"no surface on the sheet", "#c62828", no_surface},
            {"no roughness", "#d9730d", smooth}, {"only slab and sheet, smooth", "#6a1b9a", bare}};
}

// A slab of 0.5 mm like white in red: 6 per mm, albedo 0.999, g 0.4.
Eigen::VectorXd profile(const EdgeSetup& setup, std::uint32_t paths, const std::vector<double>& x, double& noise) {
    optics::EdgeRun run;
    run.assembly = setup.assembly;
    run.light = optics::light_window(setup.assembly);
    run.sigma_t = 6, run.g = 0.4, run.slab_mm = 0.5;
    run.paths = paths;
    const optics::EdgeCounts counts = optics::trace_edge_paths(run);
    const optics::EdgeUnits units(run);
    const optics::EdgeCells cells;
    const Eigen::MatrixXd see = optics::pixels_from_cells(cells, x, {setup.pitch_mm, 0, 1});
    const Eigen::VectorXd F = see * cells.profile(optics::edge_kernels(counts, units, 0.999), setup.sheet(0));
    double squares = 0;
    for (const optics::PathBatch& batch : counts) {
        const Eigen::VectorXd one = see * cells.profile(optics::edge_kernels(batch, units, 0.999), setup.sheet(0));
        squares += (one - F).squaredNorm() / static_cast<double>(F.size());
    }
    noise = std::sqrt(squares / optics::edge_batches / (optics::edge_batches - 1));
    return F;
}

io::Plot::Points points(const std::vector<double>& x, const Eigen::VectorXd& y) {
    io::Plot::Points list;
    for (std::size_t k = 0; k < x.size(); ++k) list.emplace_back(x[k], y[static_cast<Eigen::Index>(k)]);
    return list;
}

}  // namespace

int main(int count, char** words) {
    if (count < 2) return fmt::print("FILE.svg [PATHS]\n"), 2;
    const auto paths = static_cast<std::uint32_t>(count > 2 ? std::atoi(words[2]) : 1 << 21);
    std::vector<double> x;
    for (double at = -3; at <= 3.001; at += 0.03) x.push_back(at);
    const std::vector<double> marks{-3, -2, -1, 0, 1, 2, 3};
    io::Plot values({-3, 3, false, marks, "mm across the edge"},
                    {0, 1, false, {0, 0.2, 0.4, 0.6, 0.8, 1}, "reflectance"},
                    "White resin in red (6 per mm, albedo 0.999, g 0.4), 0.5 mm", 460, 260);
    io::Plot rest({-3, 3, false, marks, "mm across the edge"},
                  {-0.06, 0.06, false, {-0.06, -0.04, -0.02, 0, 0.02, 0.04, 0.06}, "less the one with everything"}, "",
                  460, 200);
    Eigen::VectorXd all;
    fmt::print(
        "| | black side | at the edge | white side | width from 25 to 75 %, mm | noise |\n|---|---|---|---|---|---|\n");
    double y = 0.95;
    for (const Part& part : parts()) {
        double noise = 0;
        const Eigen::VectorXd F = profile(part.setup, paths, x, noise);
        if (all.size() == 0) all = F;
        values.line(points(x, F), part.colour);
        values.label(-2.95, y, part.name, part.colour);
        y -= 0.055;
        rest.line(points(x, F - all), part.colour);
        const double black = F[0], white = F[F.size() - 1];
        const auto reached = [&](double share) {
            Eigen::Index k = 0;
            while (F[k] < black + share * (white - black)) ++k;
            return x[static_cast<std::size_t>(k)];
        };
        fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} | {:.4f} |\n", part.name, black, F[F.size() / 2], white,
                   reached(0.75) - reached(0.25), noise);
    }
    std::ofstream(words[1]) << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"540\" height=\"600\" "
                               "font-family=\"sans-serif\">\n<rect width=\"540\" height=\"600\" fill=\"white\"/>\n"
                            << values.svg() << "<g transform=\"translate(0,325)\">\n"
                            << rest.svg() << "</g>\n</svg>\n";
    return 0;
}
