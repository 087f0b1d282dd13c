// SPDX-License-Identifier: GPL-3.0-or-later
//
// Targets as a prediction has them: what is drawn, in cells of 0.085 mm, on a slab or a body.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>

#include <Eigen/Core>

#include "io/lettering/font_file.h"
#include "io/lettering/set_text.h"
#include "slicer/colour/job_prediction.h"

namespace voxtone::test {

/// Linear sRGB at x, y in mm, y up.
using Paint = std::function<Eigen::Vector3f(double x, double y)>;

inline constexpr double drawn_cell_mm = 0.085;

/// A line of text whose ink begins at x, y and runs in a direction, in degrees from +x.
struct SetLine {
    SetLine(const std::string& text, double pt, double x, double y, double degrees = 0,
            const std::string& font = io::default_font)
        : ink(io::set_text(text, io::find_font(font), pt * 25.4 / 72, 60)),
          from(x, y),
          along(std::cos(degrees * 3.14159265358979323846 / 180), std::sin(degrees * 3.14159265358979323846 / 180)) {}
    /// How much of a place is ink.
    [[nodiscard]] float at(double x, double y) const {
        const Eigen::Vector2d to = Eigen::Vector2d(x, y) - from;
        const double right = to.dot(along), up = along.x() * to.y() - along.y() * to.x();
        const int column = int(std::floor(right / ink.pixel_mm)),
                  row = ink.height_px - 1 - int(std::floor(up / ink.pixel_mm));
        if (column < 0 || row < 0 || column >= ink.width_px || row >= ink.height_px) return 0;
        return float(ink.at(column, row)) / 255;
    }
    io::Coverage ink;
    Eigen::Vector2d from, along;
};

/// Its target and regions; printed as it is asked for.
inline slicer::JobPrediction page_of(double width_mm, double height_mm, const Paint& paint) {
    constexpr int samples = 4;
    slicer::JobPrediction p;
    const std::array<int, 3> size{int(width_mm / drawn_cell_mm), int(height_mm / drawn_cell_mm), 2};
    p.volume = optics::make_resin_volume(size, {drawn_cell_mm, drawn_cell_mm, drawn_cell_mm},
                                         [](int, int, int) { return optics::Material{1}; });
    p.cell_um = {drawn_cell_mm * 1e3, drawn_cell_mm * 1e3, drawn_cell_mm * 1e3};
    p.predicted.surface = optics::find_surface({.volume = &p.volume}, {1, 1, 1}, optics::SurfacePart::top);
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int n = 0; n < samples * samples; ++n)
            sum += paint((cell.cell[0] + (n % samples + 0.5) / samples) * drawn_cell_mm,
                         (cell.cell[1] + (n / samples + 0.5) / samples) * drawn_cell_mm);
        p.target.push_back(sum / (samples * samples));
    }
    p.predicted.rgb = p.target;
    p.seen.regions = halftone::colour_regions(p.predicted.surface, p.target);
    return p;
}

/// A body in a box of this size, by what is solid and what colour is asked for at x, y, z.
template <class IsSolid, class PaintBody>
slicer::JobPrediction body_of(const Eigen::Vector3d& box_mm, const IsSolid& is_solid, const PaintBody& paint) {
    slicer::JobPrediction p;
    const auto voxels = [](double mm) { return int(mm / drawn_cell_mm); };
    p.volume = optics::make_resin_volume({voxels(box_mm.x()), voxels(box_mm.y()), voxels(box_mm.z())},
                                         {drawn_cell_mm, drawn_cell_mm, drawn_cell_mm}, [&](int x, int y, int z) {
                                             const auto mm = [](int i) { return (i + 0.5) * drawn_cell_mm; };
                                             return is_solid(mm(x), mm(y), mm(z)) ? optics::Material{1} : optics::air;
                                         });
    p.predicted.surface = optics::find_surface({.volume = &p.volume}, {1, 1, 1}, optics::SurfacePart::all);
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells)
        p.target.push_back(paint(double(cell.centre_mm[0]), double(cell.centre_mm[1]), double(cell.centre_mm[2])));
    p.predicted.rgb = p.target;
    p.seen.regions = halftone::colour_regions(p.predicted.surface, p.target);
    return p;
}

}  // namespace voxtone::test
