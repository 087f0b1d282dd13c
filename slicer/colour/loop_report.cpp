// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/loop_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/counted.h"
#include "io/pictures/picture_writer.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

/// A slab's cells as a grid.
struct CellGrid {
    explicit CellGrid(const optics::Surface& surface) {
        for (const optics::SurfaceCell& cell : surface.cells) {
            nx = std::max(nx, cell.cell[0] + 1);
            ny = std::max(ny, cell.cell[1] + 1);
        }
        at.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), -1);
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            at[static_cast<std::size_t>(surface.cells[i].cell[1] * nx + surface.cells[i].cell[0])] =
                static_cast<std::int32_t>(i);
    }
    int nx = 0, ny = 0;
    std::vector<std::int32_t> at;
};

struct Square {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Where the differences of the open loop minus those of the result add up to most.
Square most_changed(const CellGrid& grid, const std::vector<double>& before, const std::vector<double>& after,
                    int edge) {
    Square best{0, 0, std::min(edge, grid.nx), std::min(edge, grid.ny)};
    double most = -1e300;
    const int step = std::max(1, edge / 4);
    for (int y = 0; y + best.height <= grid.ny; y += step)
        for (int x = 0; x + best.width <= grid.nx; x += step) {
            double sum = 0;
            for (int j = y; j < y + best.height; ++j)
                for (int i = x; i < x + best.width; ++i)
                    if (const std::int32_t c = grid.at[static_cast<std::size_t>(j * grid.nx + i)]; c >= 0)
                        sum += before[static_cast<std::size_t>(c)] - after[static_cast<std::size_t>(c)];
            if (sum > most) most = sum, best.x = x, best.y = y;
        }
    return best;
}

io::ReportPicture magnified(const CellGrid& grid, const Square& square, const std::vector<Eigen::Vector3f>& rgb,
                            const char* caption, double cell_mm) {
    constexpr int times = 8;
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(square.width * times);
    picture.height_px = static_cast<std::uint32_t>(square.height * times);
    picture.pixels.reserve(std::size_t{picture.width_px} * picture.height_px);
    for (int row = 0; row < square.height * times; ++row)
        for (int column = 0; column < square.width * times; ++column) {
            const int x = square.x + column / times, y = square.y + square.height - 1 - row / times;
            const std::int32_t c = grid.at[static_cast<std::size_t>(y * grid.nx + x)];
            Eigen::Vector4f pixel = Eigen::Vector4f::Zero();
            if (c >= 0) pixel << rgb[static_cast<std::size_t>(c)], 1;
            picture.pixels.push_back(pixel);
        }
    const io::Picture8 codes = io::encode_transparent(picture);
    return {caption, io::png_bytes(codes), codes.width_px, codes.height_px, times / cell_mm};
}

/// Upright cut along x at this y and around this x, from the surface down; +z is up.
io::ReportPicture cut(const optics::ResinVolume& volume, int x_middle, int y, double width_mm, double height_mm,
                      int top, const std::vector<io::Rgb>& palette) {
    const auto& pitch = volume.pitch_mm();
    const auto& size = volume.size();
    constexpr double px_per_mm = 200;
    const int width = std::min(size[0], voxels_in(width_mm, pitch[0])), height = voxels_in(height_mm, pitch[2]);
    const int x_first = std::clamp(x_middle - width / 2, 0, size[0] - width);
    io::Picture8 codes;
    codes.width_px = static_cast<std::uint32_t>(std::lround(width * pitch[0] * px_per_mm));
    codes.height_px = static_cast<std::uint32_t>(std::lround(height * pitch[2] * px_per_mm));
    codes.channels = 4;
    codes.codes.reserve(std::size_t{codes.width_px} * codes.height_px * 4);
    for (std::uint32_t row = 0; row < codes.height_px; ++row)
        for (std::uint32_t column = 0; column < codes.width_px; ++column) {
            const int x = x_first + std::min(width - 1, static_cast<int>((column + 0.5) / px_per_mm / pitch[0]));
            const int z = top - static_cast<int>((row + 0.5) / px_per_mm / pitch[2]);
            const optics::Material material = z >= 0 ? volume.at(x, y, z) : optics::air;
            const io::Rgb rgb = palette[material];
            codes.codes.insert(codes.codes.end(),
                               {rgb[0], rgb[1], rgb[2], static_cast<std::uint8_t>(material == optics::air ? 0 : 255)});
        }
    return {"resins, as the bitmaps colour them", io::png_bytes(codes), codes.width_px, codes.height_px, px_per_mm};
}

int top_of_column(const optics::ResinVolume& volume, int x, int y) {
    int z = volume.size()[2] - 1;
    while (z > 0 && volume.at(x, y, z) == optics::air) --z;
    return z;
}

}  // namespace

io::ReportLoop loop_report(const JobLoop& loop, const JobBody& body, const optics::ResinVolume* volume,
                           const std::vector<io::Rgb>& palette) {
    const halftone::LoopState& state = loop.result.state;
    io::ReportLoop report;
    for (const halftone::LoopStep& step : state.steps)
        report.iterations.push_back({step.iteration, step.seen.mean, step.seen.median, step.seen.percentile_95,
                                     step.cells.mean, step.saturated_share, step.seconds});
    report.best = state.steps[state.best].iteration;
    report.seconds = loop.seconds;
    const auto in = std::count(loop.result.in_gamut.begin(), loop.result.in_gamut.end(), 1);
    report.note = fmt::format(
        "The resins were rearranged {} and the print predicted after each by the model {} in cells of {:.1f} x {:.1f} "
        "x "
        "{:.1f} um; {}. Errors are CIEDE2000 relative to white resin over all cells; {:.1f} % have a target that the "
        "resins can show on a thick body; as seen: after the eye filter (Gaussians of S-CIELAB without their negative "
        "surround), the print's own paper taken for white. At limits: cells that their neighbours, or what lies behind "
        "them, keep from their target; they are "
        "asked for the nearest colour that is left.",
        counted(state.steps.size() - 1, "time"), loop.model, loop.cells->seen.cell_um[0], loop.cells->seen.cell_um[1],
        loop.cells->seen.cell_um[2], loop.result.why_stopped,
        100.0 * double(in) / double(std::max<std::size_t>(1, loop.result.in_gamut.size())));
    constexpr double crop_mm = 4;
    int x = 0, y = 0;
    if (body.is_picture) {
        const CellGrid grid(loop.cells->seen.surface);
        const double cell_mm = loop.cells->seen.cell_um[0] * 1e-3;
        const Square square =
            most_changed(grid, colour_differences(loop.cells->seen.target, state.open),
                         colour_differences(loop.cells->seen.target, state.shown), static_cast<int>(crop_mm / cell_mm));
        report.crops = {magnified(grid, square, loop.cells->seen.target, "target", cell_mm),
                        magnified(grid, square, state.open, "open loop", cell_mm),
                        magnified(grid, square, state.shown, "result", cell_mm)};
        x = (square.x + square.width / 2) * loop.cells->seen.surface.cell_voxels[0];
        y = (square.y + square.height / 2) * loop.cells->seen.surface.cell_voxels[1];
    } else if (volume) {
        x = volume->size()[0] / 2;
        y = volume->size()[1] / 2;
    }
    if (volume) {
        x = std::min(x, volume->size()[0] - 1);
        y = std::min(y, volume->size()[1] - 1);
        constexpr double depth_mm = 1.2;
        report.sections.push_back(cut(*volume, x, y, crop_mm, depth_mm, top_of_column(*volume, x, y), palette));
        report.sections_note =
            fmt::format("Upright cut at y = {:.2f} mm, {:g} mm wide around x = {:.2f} mm, the topmost {:g} mm there.",
                        (y + 0.5) * volume->pitch_mm()[1], crop_mm, (x + 0.5) * volume->pitch_mm()[0], depth_mm);
    }
    return report;
}

}  // namespace voxtone::slicer
