// SPDX-License-Identifier: GPL-3.0-or-later
#include "tile_seams.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/progress.h"
#include "optics/colour/colour.h"
#include "optics/colour/observed_colour.h"
#include "optics/transport/viewing_sequence.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::loop_benchmark {

namespace {

/// Cells within 1 mm of a plane in which a tile was cut off from another.
std::vector<char> near_cuts(const optics::Surface& surface, const std::vector<optics::ViewingTile>& tiles,
                            const std::array<double, 3>& pitch) {
    std::vector<char> near(surface.cells.size(), 0);
    for (const optics::ViewingTile& tile : tiles)
        for (const std::uint32_t i : tile.cells)
            for (std::size_t a = 0; a < 3; ++a) {
                const auto at = static_cast<double>(surface.cells[i].centre_mm[a]);
                near[i] |= tile.window.cut[2 * a] && at - tile.voxels.begin[a] * pitch[a] < 1;
                near[i] |= tile.window.cut[2 * a + 1] && tile.voxels.end[a] * pitch[a] - at < 1;
            }
    return near;
}

struct Far {
    double mean = 0, percentile_95 = 0, most = 0;
};
Far summary(std::vector<double> d) {
    if (d.empty()) return {};
    std::sort(d.begin(), d.end());
    Far far;
    for (const double v : d) far.mean += v / static_cast<double>(d.size());
    far.percentile_95 = d[d.size() * 95 / 100];
    far.most = d.back();
    return far;
}

}  // namespace

std::string tile_seams(const std::filesystem::path& folder, std::size_t tile_cells) {
    Progress progress;
    const slicer::StackVolume stack = slicer::read_stack_volume({.stack = folder}, progress);
    VOXTONE_EXPECT(stack.white >= 0);
    const optics::ObservedColour<float> observed(stack.resins.channels);
    const std::size_t channels = observed.channels();
    const optics::ResinVolume white = optics::all_of(stack.volume, static_cast<optics::Material>(stack.white + 1));
    const optics::Scene scene{
        .volume = &white, .resins = &stack.resins, .backing = stack.backing.value_or(optics::Backing::none).kind};
    optics::TransportOptions options;
    options.refinement = optics::Refinement::none;
    const auto cell = optics::cell_voxels(white.pitch_mm(), options.cell_mm);
    const optics::Surface surface =
        optics::find_surface(scene, cell, stack.of_picture ? optics::SurfacePart::top : optics::SurfacePart::all);
    options.tile_cells = surface.cells.size();
    optics::ViewingSequence whole(scene, surface, options);
    options.tile_cells = tile_cells;
    optics::ViewingSequence parts(scene, surface, options);
    const auto tiles =
        optics::viewing_tiles(surface, white.size(), white.pitch_mm(), cell, tile_cells, options.tile_halo);
    const std::vector<char> near = near_cuts(surface, tiles, white.pitch_mm());

    std::string text = fmt::format(
        "{} surface cells in {} tiles; {:.1f} % within 1 mm of a cut\n\n"
        "| prediction | all: mean | 95 % | most | near a cut: mean | 95 % | most | s, whole | s, tiles "
        "|\n|---|---|---|---|---|---|---|---|---|\n",
        surface.cells.size(), tiles.size(),
        100.0 * static_cast<double>(std::count(near.begin(), near.end(), 1)) / static_cast<double>(near.size()));
    struct Row {
        const char* name;
        optics::Appearance whole, parts;
        double seconds_whole = 0, seconds_parts = 0;
    };
    std::vector<Row> rows;
    double seconds_whole = 0, seconds_parts = 0;
    for (const char* const name : {"the print", "again", "again", "all white", "again", "again"}) {
        const optics::ResinVolume& volume = rows.size() < 3 ? stack.volume : white;
        Row row{name, whole.next(volume), parts.next(volume), -seconds_whole, -seconds_parts};
        row.seconds_whole += seconds_whole = whole.summary().total_s;
        row.seconds_parts += seconds_parts = parts.summary().total_s;
        rows.push_back(std::move(row));
    }
    const optics::Appearance& paper = rows.back().whole;
    for (const Row& row : rows) {
        std::vector<double> all, at_cuts;
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            const auto lab = [&](const optics::Appearance& seen) {
                const Eigen::Vector3f rgb =
                    observed.relative(seen.value.data() + i * channels, paper.value.data() + i * channels);
                return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
            };
            all.push_back(optics::ciede2000(lab(row.whole), lab(row.parts)));
            if (near[i]) at_cuts.push_back(all.back());
        }
        const Far everywhere = summary(all), here = summary(at_cuts);
        text += fmt::format("| {} | {:.3f} | {:.3f} | {:.2f} | {:.3f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} |\n",
                            row.name, everywhere.mean, everywhere.percentile_95, everywhere.most, here.mean,
                            here.percentile_95, here.most, row.seconds_whole, row.seconds_parts);
    }
    return text + fmt::format("\nMemory of the predictor: {:.0f} MB as a whole, {:.0f} MB in tiles.\n",
                              1e-6 * static_cast<double>(whole.summary().memory_bytes),
                              1e-6 * static_cast<double>(parts.summary().memory_bytes));
}

}  // namespace voxtone::loop_benchmark
