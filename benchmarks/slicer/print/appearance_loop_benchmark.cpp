// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much truer prints become in the appearance loop: every target printed open loop and with the loop, both judged by
// Monte Carlo of the finished stacks.
//
//   appearance_loop_benchmark slabs     photographs (benchmarks/sets.json: fitting and held-out), text, star, colour
//   checker, gratings: 20 mm wide, 4 mm thick, J750
//                                       High Mix, --resins, on black
//   appearance_loop_benchmark bodies    meshes, in windows (judge_body.h)
//   appearance_loop_benchmark graphics   solids, type, a logo (graphics_pages.h), judged region by region, adapted to
//   the print's paper
//   appearance_loop_benchmark figurines   figures in flat colours, in windows in their solids
//   appearance_loop_benchmark flat      slabs of one colour each, 8 mm: the mean of the middle 4 mm
//   appearance_loop_benchmark seams     what cutting a body into tiles does to its predictions, for a stack that slice
//   made appearance_loop_benchmark report    slabs and bodies appearance_loop_benchmark targets   only writes the
//   pictures
//
// Pictures and stacks lie in --work; what was traced is kept there and not traced again. The table goes to standard
// output and to --work/slabs.md and bodies.md; strips (target | open loop | loop) are --work/NAME.strip.png.
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "body_tables.h"
#include "body_targets.h"
#include "flat_slabs.h"
#include "graphics_pages.h"
#include "graphics_scores.h"
#include "gratings.h"
#include "io/files/whole_file.h"
#include "judge_body.h"
#include "judge_slab.h"
#include "scores.h"
#include "strips.h"
#include "tables.h"
#include "targets.h"
#include "tests/places.h"
#include "tile_seams.h"
#include "variants.h"

namespace {

using namespace voxtone;
using namespace voxtone::loop_benchmark;
namespace fs = std::filesystem;

struct Arguments {
    fs::path models = fs::path(test::source_dir()) / "../shared/models", work = "build/loop-benchmark";
    std::string only, crop, resins;
    std::vector<std::string> set;
    std::uint32_t paths = 256, body_paths = 64;
    std::size_t windows = 40;
    double viewing_distance_mm = 300, scale = 1;
    std::size_t threads = 0, tile_cells = 250'000;
    std::string stack;
    bool reuse = false;
};

Crop parse_crop(const std::string& text) {
    Crop crop;
    if (text.empty()) return crop;
    if (std::sscanf(text.c_str(), "%lfx%lf", &crop.width_mm, &crop.height_mm) != 2 || !(crop.width_mm > 0) ||
        !(crop.height_mm > 0))
        throw UsageError(fmt::format("--crop {}: give WIDTHxHEIGHT in mm, 6x4", text));
    return crop;
}

std::vector<Target> targets(const Arguments& a) {
    std::vector<std::string> missing;
    std::vector<Target> found = make_targets(a.models, a.work, a.only, parse_crop(a.crop), missing);
    for (const std::string& name : missing) fmt::print("{}: not in {}; left out\n", name, a.models.string());
    return found;
}

/// The way `v` of printing a picture.
Print print_slab(const Arguments& a, const fs::path& picture, const std::string& name, double width_mm,
                 const Variant& way, std::size_t v) {
    slicer::SliceOptions options;
    options.resins = a.resins;
    options.model = picture.string();
    options.out = (a.work / fmt::format("{}.{}", name, v)).string();
    options.width_mm = width_mm;
    options.threads = static_cast<int>(a.threads);
    set_options(way.set, options);
    return make_print(options, a.reuse);
}

SlabRow judge_target(const Arguments& a, const Target& target, const std::vector<Variant>& ways) {
    SlabRow row;
    row.name = target.name;
    row.gratings = target.gratings;
    row.held_out = target.held_out;
    std::array<Judgement, 2> judged;
    std::optional<Eye> eye;
    for (std::size_t v = 0; v < 2; ++v) {
        row.print[v] = print_slab(a, target.picture, target.name, target.width_mm, ways[v], v);
        judged[v] = judge_slab(row.print[v].options, {.paths = a.paths, .cache = a.work / "traced"});
        if (!eye) eye.emplace(judged[v].surface, a.viewing_distance_mm);
        row.scores[v] = score(judged[v], *eye);
        row.share_in_gamut =
            static_cast<double>(row.scores[v].cells_in_gamut.cells) / static_cast<double>(judged[v].target.size());
        if (target.gratings)
            row.modulation[v] = modulation_by_frequency(target.width_mm, target.height_mm, judged[v].surface,
                                                        judged[v].target, judged[v].print());
        fmt::print(stderr, "{} {}: {:.1f} s printed, {:.1f} s traced, mean {:.2f}, as seen {:.2f}\n", target.name,
                   ways[v].name, row.print[v].seconds, judged[v].trace_seconds, row.scores[v].cells_in_gamut.mean,
                   row.scores[v].eye_in_gamut.mean);
    }
    write_strip(a.work / (target.name + ".strip.png"), {&judged[0], &judged[1]});
    return row;
}

void run_slabs(const Arguments& a) {
    const ThreadLimit limit(a.threads);
    const std::vector<Variant> ways = variants(parse_set(a.set));
    std::vector<SlabRow> rows;
    for (const Target& target : targets(a)) rows.push_back(judge_target(a, target, ways));
    const std::string text = slab_tables(rows, {ways[0].name, ways[1].name});
    io::write_whole_file(a.work / "slabs.md", text);
    fmt::print("{}", text);
}

void run_graphics(const Arguments& a) {
    const ThreadLimit limit(a.threads);
    const std::vector<Variant> ways = variants(parse_set(a.set));
    std::vector<std::string> missing;
    const std::vector<Target> found = make_graphics(a.models, a.work, a.only, missing);
    for (const std::string& name : missing) fmt::print("{}: not in {}; left out\n", name, a.models.string());
    std::vector<GraphicRow> rows;
    for (const Target& target : found) {
        GraphicRow row{target.name, target.held_out, {}};
        std::array<Judgement, 2> judged;
        for (std::size_t v = 0; v < 2; ++v) {
            const Print print = print_slab(a, target.picture, target.name, target.width_mm, ways[v], v);
            judged[v] = judge_slab(print.options, {.paths = a.paths, .cache = a.work / "traced"});
            row.scores[v] = graphic_scores(judged[v], a.viewing_distance_mm);
            if (target.name == "codes") score_codes(judged[v], row.scores[v]);
            fmt::print(stderr, "{} {}: {:.1f} s printed, {:.1f} s traced, as seen {:.2f}\n", target.name, ways[v].name,
                       print.seconds, judged[v].trace_seconds, row.scores[v].seen);
        }
        write_strip(a.work / (target.name + ".strip.png"), {&judged[0], &judged[1]});
        rows.push_back(row);
    }
    const std::string text = graphics_table(rows);
    io::write_whole_file(a.work / "graphics.md", text);
    fmt::print("{}", text);
}

void run_flat(const Arguments& a) {
    const ThreadLimit limit(a.threads);
    const std::vector<Variant> ways = variants(parse_set(a.set));
    std::vector<FlatRow> rows;
    for (const FlatTarget& target : flat_targets(a.work)) {
        FlatRow row{target.rgb, {}, 0};
        for (std::size_t v = 0; v < 2; ++v) {
            const Print print = print_slab(a, target.picture, target.picture.stem().string(), flat_mm, ways[v], v);
            judge_flat(judge_slab(print.options, {.paths = a.paths, .cache = a.work / "traced"}), v, row);
        }
        rows.push_back(row);
    }
    const std::string text = flat_table(rows);
    io::write_whole_file(a.work / "flat.md", text);
    fmt::print("{}", text);
}

/// The way `v` of printing a body.
Print print_body(const Arguments& a, const BodyTarget& target, const Variant& way, std::size_t v) {
    slicer::SliceOptions options;
    options.resins = a.resins;
    options.model = target.model.string();
    options.out = (a.work / fmt::format("{}.{}", target.name, v)).string();
    options.size_mm = target.size_mm * a.scale;
    options.threads = static_cast<int>(a.threads);
    set_options(way.set, options);
    return make_print(options, a.reuse);
}

void run_figurines(const Arguments& a) {
    constexpr std::string_view figurines[] = {"kaykit_mage", "exploding_barrel", "ycb_banana"};
    const ThreadLimit limit(a.threads);
    const std::vector<Variant> ways = variants(parse_set(a.set));
    std::vector<std::string> missing;
    const std::vector<BodyTarget> found = body_targets(a.models, a.work, a.only, missing);
    for (const std::string& name : missing) fmt::print("{}: not in {}; left out\n", name, a.models.string());
    std::vector<FigurineRow> rows;
    for (const BodyTarget& target : found) {
        if (std::ranges::find(figurines, target.name) == std::end(figurines)) continue;
        FigurineRow row{target.held_out ? target.name + " (held out)" : target.name, {}, {}};
        for (std::size_t v = 0; v < 2; ++v) {
            const Print print = print_body(a, target, ways[v], v);
            const BodyJudgement judged = judge_body(print.options, {.paths = a.body_paths, .cache = a.work / "traced"},
                                                    {.windows = a.windows, .solids = 8});
            row.solids = judged.solids;
            if (row.solids.empty()) break;
            row.difference[v] = solid_differences(judged, a.viewing_distance_mm);
            fmt::print(stderr, "{} {}: {:.1f} s printed, {:.1f} s traced\n", target.name, ways[v].name, print.seconds,
                       judged.cells.trace_seconds);
        }
        rows.push_back(row);
    }
    const std::string text = figurine_table(rows);
    io::write_whole_file(a.work / "figurines.md", text);
    fmt::print("{}", text);
}

void run_bodies(const Arguments& a) {
    const ThreadLimit limit(a.threads);
    const std::vector<Variant> ways = variants(parse_set(a.set));
    std::vector<std::string> missing;
    const std::vector<BodyTarget> found = body_targets(a.models, a.work, a.only, missing);
    for (const std::string& name : missing) fmt::print("{}: not in {}; left out\n", name, a.models.string());
    std::vector<BodyRow> rows;
    for (const BodyTarget& target : found) {
        BodyRow row;
        row.name = target.held_out ? target.name + " (held out)" : target.name;
        for (std::size_t v = 0; v < 2; ++v) {
            row.print[v] = print_body(a, target, ways[v], v);
            const BodyJudgement judged = judge_body(
                row.print[v].options, {.paths = a.body_paths, .cache = a.work / "traced"}, {.windows = a.windows});
            const std::array<BodyFigures, 2> figures = body_figures(judged, a.viewing_distance_mm);
            row.thick[v] = figures[0];
            row.thin[v] = figures[1];
            row.windows = judged.windows;
            row.thin_share = judged.thin_share;
            fmt::print(
                stderr,
                "{} {}: {:.1f} s printed, {:.1f} s traced {} of {:.0f} cells, as seen {:.2f}, thin parts {:.2f}\n",
                target.name, ways[v].name, row.print[v].seconds, judged.cells.trace_seconds, judged.inner.size(),
                judged.surface_cells, figures[0].seen.mean, figures[1].seen.mean);
        }
        rows.push_back(row);
    }
    const std::string text = body_table(rows, {ways[0].name, ways[1].name});
    io::write_whole_file(a.work / "bodies.md", text);
    fmt::print("{}", text);
}

}  // namespace

int main(int argc, char** argv) {
    Arguments a;
    CLI::App app("The appearance loop against open-loop halftoning, judged by Monte Carlo of the printed voxels.");
    app.require_subcommand(1);
    app.add_option("--work", a.work, "folder for pictures, stacks and what was traced")->capture_default_str();
    app.add_option("--models", a.models, "folder of the models")->capture_default_str();
    app.add_option("--only", a.only, "only targets whose name contains this");
    app.add_option("--crop", a.crop, "only the middle of each target, WIDTHxHEIGHT in mm: 6x4");
    app.add_option("--resins", a.resins, "set or file, of both prints; the printer's default where none is named");
    app.add_option("--set", a.set, "KEY=VALUE: option of slice for the loop's prints; may be repeated");
    app.add_option("--paths", a.paths, "Monte Carlo paths per cell, channel and half")->capture_default_str();
    app.add_option("--viewing-distance", a.viewing_distance_mm, "mm")->capture_default_str();
    app.add_option("--body-paths", a.body_paths, "the same for bodies")->capture_default_str();
    app.add_option("--windows", a.windows, "bodies: windows that are judged")->capture_default_str();
    app.add_option("--scale", a.scale, "bodies: of their size")->capture_default_str();
    app.add_option("--threads", a.threads, "0: one per core");
    app.add_flag("--reuse", a.reuse, "take finished prints in --work that were made with the same options");
    app.fallthrough();
    app.add_subcommand("slabs", "photographs and pages")->callback([&] { run_slabs(a); });
    app.add_subcommand("graphics", "solids, type, a logo: region by region")->callback([&] { run_graphics(a); });
    app.add_subcommand("figurines", "bodies of flat colours, solid by solid")->callback([&] { run_figurines(a); });
    app.add_subcommand("flat", "slabs of one colour each")->callback([&] { run_flat(a); });
    CLI::App* seams = app.add_subcommand("seams", "tiles against the whole body");
    seams->add_option("stack", a.stack, "output folder of slice")->required();
    seams->add_option("--tile-cells", a.tile_cells, "most surface cells of a tile")->capture_default_str();
    seams->callback([&] {
        const ThreadLimit limit(a.threads);
        fmt::print("{}", tile_seams(a.stack, a.tile_cells));
    });
    app.add_subcommand("bodies", "meshes")->callback([&] { run_bodies(a); });
    app.add_subcommand("report", "both")->callback([&] {
        run_slabs(a);
        run_bodies(a);
    });
    app.add_subcommand("targets", "write the pictures")->callback([&] {
        for (const Target& t : targets(a))
            fmt::print("{} {:g} x {:g} mm\n", t.picture.string(), t.width_mm, t.height_mm);
    });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
