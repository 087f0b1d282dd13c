// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far the fast predictor is from Monte Carlo, and what it costs.
//
//   predictor_accuracy report             all of the tables below
//   predictor_accuracy compare [FOLDER]   a row per case; what the columns mean: compare.h; seen: the mean of what an
//                                         eye at 300 mm sees of the difference, noise and all (eye_filter.h)
//   predictor_accuracy homogeneous        slabs of all mixtures of a 10 % lattice; tilted slabs, spheres of one colour
//   predictor_accuracy speed              cost per cell, square centimetre and byte
//   predictor_accuracy dial [FOLDER]      sweeps and skin cells: error and price
//   predictor_accuracy make [FOLDER]      Monte Carlo references of the suite, case by case
//   predictor_accuracy picture CASE FILE  target, Monte Carlo, prediction, difference side by side (PNG)
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/parallel.h"
#include "compare.h"
#include "halftone/loop/eye_filter.h"
#include "homogeneous.h"
#include "make_reference.h"
#include "optics/colour/colour.h"
#include "photo_cases.h"
#include "pictures.h"
#include "speed.h"
#include "tests/places.h"

namespace {

using namespace voxtone;
using namespace voxtone::accuracy;
namespace fs = std::filesystem;

struct Arguments {
    fs::path folder = fs::path(test::source_dir()) / "tests/data/appearance",
             models = fs::path(test::source_dir()) / "../shared/models", file, cells;
    std::string only;
    std::uint64_t seed = 1, threads = 1;
    double effort = 0.5, largest = 1e7;
    int steps = 10;
    std::array<int, 3> refine{1, 1, 1};
    bool again = false;
    int fine = 1;
    optics::TransportOptions transport;
};

void make(const Arguments& a) {
    fs::create_directories(a.folder);
    for (SuiteCase& c : suite_cases(a.models)) {
        const fs::path file = a.folder / (c.name + ".ref");
        if (c.name.find(a.only) == std::string::npos || (fs::exists(file) && !a.again)) continue;
        const std::string name = c.name;
        Reference r = make_reference(std::move(c), a.seed, a.effort);
        r.made = fmt::format("predictor_accuracy make --seed {} --effort {}, {:%Y-%m-%d}", a.seed, a.effort,
                             fmt::gmtime(std::time(nullptr)));
        write_reference(file, r);
        fmt::print("{:<16} {:>8.1f} s of one core, {:.3g} paths, {} bytes\n", name, r.core_seconds,
                   static_cast<double>(r.all_paths), fs::file_size(file));
        std::fflush(stdout);
    }
}

std::vector<fs::path> references(const Arguments& a) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(a.folder))
        if (entry.path().extension() == ".ref" && entry.path().stem().string().find(a.only) != std::string::npos)
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// Colours of every cell, to look for the place of an error.
void write_cells(const fs::path& file, const Comparison& c) {
    std::ofstream out(file);
    out << "x,y,z,predicted_r,predicted_g,predicted_b,reference_r,reference_g,reference_b,error\n";
    for (std::size_t i = 0; i < c.cells; ++i) {
        const auto& at = c.surface.cells[i].cell;
        const Rgb &p = c.predicted[i], &m = c.reference[i];
        out << fmt::format("{},{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.3f}\n", at[0], at[1], at[2], p[0],
                           p[1], p[2], m[0], m[1], m[2], c.error[i]);
    }
}

/// Mean CIEDE2000 between the predicted and the reference's cells, the noise of these included, after the eye's filter.
double seen_error(const Comparison& c) {
    const halftone::EyeFilter eye(c.surface, 300);
    const auto lab_of = [&](const std::vector<Rgb>& colours) {
        std::vector<Eigen::Vector3f> rgb;
        for (const Rgb& one : colours) rgb.emplace_back(one[0], one[1], one[2]);
        std::vector<Eigen::Vector3d> lab;
        for (const Eigen::Vector3f& seen : eye.filter(rgb))
            lab.push_back(optics::lab_from_linear_srgb(seen.cast<double>().cwiseMax(0.0)));
        return lab;
    };
    const std::vector<Eigen::Vector3d> predicted = lab_of(c.predicted), reference = lab_of(c.reference);
    double sum = 0;
    for (std::size_t i = 0; i < c.cells; ++i)
        sum += static_cast<double>(c.surface.cells[i].area_mm2) * optics::ciede2000(predicted[i], reference[i]);
    return sum / c.area_mm2;
}

void compare_all(const Arguments& a) {
    fmt::print(
        "| case | mean without noise | mean | rms without noise | 95 % | max | bias of L* | noise | bias R, G, B | of "
        "white, % | cells | core s | us/cell | "
        "s/cm2 | x faster | seen |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    double sum = 0, sum_with = 0, sum_seen = 0, worst = 0, n = 0;
    struct Set {
        double sum = 0, cases = 0;
    };
    std::array<Set, 2> sets;  // unseen, looked at while tuning
    for (const fs::path& file : references(a)) {
        const Reference reference = read_reference(file);
        const Comparison c = compare(reference, a.transport, a.refine);
        sum += c.mean_without_noise;
        sum_with += c.mean;
        const double seen = seen_error(c);
        sum_seen += seen;
        worst = std::max(worst, c.mean_without_noise);
        ++n;
        sets[reference.of.tuning].sum += c.mean_without_noise;
        ++sets[reference.of.tuning].cases;
        fmt::print(
            "| {}{} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:+.2f} | {:.2f} | {:+.4f} {:+.4f} {:+.4f} | "
            "{:+.2f} {:+.2f} {:+.2f} | {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.2f} |\n",
            reference.of.name, reference.of.tuning ? "" : " (unseen)", c.mean_without_noise, c.mean, c.rms,
            c.percentile_95, c.max, c.bias, c.noise, c.channel_bias[0], c.channel_bias[1], c.channel_bias[2],
            100 * c.white_bias[0], 100 * c.white_bias[1], 100 * c.white_bias[2], c.optical_cells, c.core_seconds,
            1e6 * c.core_seconds / static_cast<double>(c.optical_cells), 100 * c.core_seconds / c.area_mm2,
            c.times_faster, seen);
        std::fflush(stdout);
        if (!a.cells.empty()) write_cells(a.cells / (reference.of.name + ".csv"), c);
    }
    if (n > 0)
        fmt::print("| mean of {} cases (largest {:.2f}) | {:.2f} | {:.2f} | seen {:.2f} |\n", n, worst, sum / n,
                   sum_with / n, sum_seen / n);
    for (const bool seen : {true, false})
        if (sets[seen].cases > 0)
            fmt::print("| mean of the {} {} | {:.2f} |\n", sets[seen].cases, seen ? "looked at while tuning" : "unseen",
                       sets[seen].sum / sets[seen].cases);
}

void homogeneous(const Arguments& a) {
    const HomogeneousErrors e = compare_mixtures(a.transport, a.steps);
    fmt::print(
        "{} mixtures, slabs of 1.08 mm over black, 12 sweeps: mean {:.3f}, 95 % {:.3f}, max {:.3f} ({}); largest error "
        "of appearance "
        "R {:.4f} G {:.4f} B {:.4f}\n\n",
        e.mixtures, e.mean, e.percentile_95, e.max, e.worst, e.largest[0], e.largest[1], e.largest[2]);
    fmt::print(
        "| body | colour | between orientations, largest | cells from the mean, mean | 95 % | L* of tilts or "
        "directions |\n|---|---|---|---|---|---|\n");
    for (const Spread& s : one_colour_bodies(a.transport))
        fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", s.body, s.colour, s.between, s.cells_mean,
                   s.cells_95, fmt::join(s.lightness, " "));
}

void speed(const Arguments& a) {
    fmt::print(
        "| cells | cm2 | voxels | core s | us/cell | s/cm2 | bytes/cell | grid | diffusion | sweeps "
        "|\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (double cells = 1e5; cells <= a.largest; cells *= 10) {
        const Cost c = price_of_slab(a.transport, cells);
        fmt::print("| {:.3g} | {:.3f} | {:.3g} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.2f} | {:.2f} | {:.2f} |\n",
                   static_cast<double>(c.optical_cells), c.area_mm2 / 100, static_cast<double>(c.voxels),
                   c.core_seconds, 1e6 * c.core_seconds / static_cast<double>(c.optical_cells),
                   100 * c.core_seconds / c.area_mm2, c.bytes_per_cell, c.summary.grid_s, c.summary.diffusion_s,
                   c.summary.sweep_s);
        std::fflush(stdout);
    }
}

struct Dial {
    std::string cut;  ///< in words
    optics::Refinement refinement;
    double least_contrast;
    int sweeps;
};

/// From cells of the eye everywhere to cells of voxels everywhere, and from one sweep to five.
std::vector<Dial> dials(const optics::TransportOptions& usual) {
    using optics::Refinement;
    std::vector<Dial> all{{"no block", Refinement::none, 0, usual.sweeps}};
    for (const double least : {40, 30, 25, 20, 15, 10, 8, 5, 0})
        all.push_back({least > 0 ? fmt::format("contrast of {} and more", least) : "wherever resins meet",
                       Refinement::contrast, least, usual.sweeps});
    all.push_back({"every block", Refinement::all, 0, usual.sweeps});
    for (const int sweeps : {1, 2, 4, 5}) all.push_back({"as it is", usual.refinement, usual.least_contrast, sweeps});
    return all;
}

void dial(const Arguments& a) {
    fmt::print(
        "| cut into voxels | sweeps | mean without noise | looked at, unseen | largest case | us/cell | s/cm2 "
        "|\n|---|---|---|---|---|---|---|\n");
    std::vector<Reference> all;
    for (const fs::path& file : references(a)) all.push_back(read_reference(file));
    for (const Dial& set : dials(a.transport)) {
        optics::TransportOptions options = a.transport;
        options.refinement = set.refinement;
        options.least_contrast = set.least_contrast;
        options.sweeps = set.sweeps;
        options.first_change = 0;              // so many and no more
        std::array<double, 2> sum{}, cases{};  // unseen, looked at while tuning
        double worst = 0, seconds = 0, cells = 0, area = 0;
        for (const Reference& reference : all) {
            const Comparison c = compare(reference, options);
            sum[reference.of.tuning] += c.mean_without_noise;
            ++cases[reference.of.tuning];
            worst = std::max(worst, c.mean_without_noise);
            seconds += c.core_seconds;
            cells += static_cast<double>(c.optical_cells);
            area += c.area_mm2;
        }
        fmt::print("| {} | {} | {:.3f} | {:.3f}, {:.3f} | {:.2f} | {:.2f} | {:.2f} |\n", set.cut, set.sweeps,
                   (sum[0] + sum[1]) / static_cast<double>(all.size()), sum[1] / cases[1], sum[0] / cases[0], worst,
                   1e6 * seconds / cells, 100 * seconds / area);
        std::fflush(stdout);
    }
}

void picture(const Arguments& a) {
    const Reference reference = read_reference(a.folder / (a.only + ".ref"));
    const Comparison c = compare(reference, a.transport);
    write_side_by_side(a.file, reference, c, photo_target(a.models, a.only, c.surface));
}

}  // namespace

int main(int argc, char** argv) {
    Arguments a;
    CLI::App app("How far the fast predictor is from Monte Carlo, and what it costs");
    app.require_subcommand(1);
    app.add_option("--threads", a.threads, "0: one per core")->capture_default_str();
    app.add_option("--sweeps", a.transport.sweeps)->capture_default_str();
    app.add_option("--fine", a.fine,
                   "cells of voxels: 0 nowhere, and no sweep more than --sweeps, as the loop; 1 where resins meet; 2 "
                   "everywhere")
        ->check(CLI::Range(0, 2))
        ->capture_default_str();
    app.add_option("--contrast", a.transport.least_contrast, "L*; blocks of less are not cut, with --fine 1")
        ->capture_default_str();
    app.add_option("--colour", a.transport.colour_mm, "mm; how deep below the surface there are cells in any case")
        ->capture_default_str();
    app.add_flag("--nodes", a.transport.deep_colour_in_nodes,
                 "deeper colour is in nodes of diffusion, as in the loop on large bodies");
    app.add_option("--cell", a.transport.cell_mm, "mm")->capture_default_str();
    app.add_option("--models", a.models, "folder of the photographs")->capture_default_str();
    auto* report_command = app.add_subcommand("report", "all tables");
    auto* make_command = app.add_subcommand("make", "trace the references");
    make_command->add_option("--seed", a.seed)->capture_default_str();
    make_command->add_option("--effort", a.effort, "multiplies the paths")->capture_default_str();
    make_command->add_flag("--again", a.again, "also those that are there");
    auto* compare_command = app.add_subcommand("compare", "a row per case");
    compare_command->add_option("--refine", a.refine, "cut voxels into so many parts along x, y, z");
    compare_command->add_option("--cells", a.cells, "folder for the colours of every cell, CSV");
    auto* dial_command = app.add_subcommand("dial", "refinement and sweeps: error and price");
    auto* homogeneous_command = app.add_subcommand("homogeneous", "bodies of one colour");
    auto* speed_command = app.add_subcommand("speed", "cost");
    for (CLI::App* command : {report_command, make_command, compare_command, dial_command}) {
        command->add_option("folder", a.folder, "of the references")->capture_default_str();
        command->add_option("--only", a.only, "cases whose name has this in it");
    }
    for (CLI::App* command : {report_command, homogeneous_command})
        command->add_option("--steps", a.steps, "of the lattice of mixtures")->capture_default_str();
    for (CLI::App* command : {report_command, speed_command})
        command->add_option("--largest", a.largest, "cells of the largest slab")->capture_default_str();
    auto* picture_command = app.add_subcommand("picture", "side by side");
    picture_command->add_option("case", a.only)->required();
    picture_command->add_option("file", a.file)->required();
    picture_command->add_option("--references", a.folder)->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    a.transport.refinement = static_cast<optics::Refinement>(a.fine);
    if (a.fine == 0) a.transport.first_change = 0;
    const ThreadLimit limit(a.threads);
    try {
        if (*make_command) make(a);
        if (*compare_command || *report_command) compare_all(a);
        if (*homogeneous_command || *report_command) homogeneous(a);
        if (*speed_command || *report_command) speed(a);
        if (*dial_command || *report_command) dial(a);
        if (*picture_command) picture(a);
    } catch (const std::exception& e) {
        std::cerr << e.what() << '\n';
        return 1;
    }
    return 0;
}
