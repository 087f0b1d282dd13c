// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction whose every figure is laid down by hand: the upper side of a block of 8 x 6 x 2 mm in cells of 0.1 mm,
// on which regions are put where a test wants them. What a verdict says of it can be worked out on paper.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "optics/colour/colour.h"
#include "slicer/colour/region_verdict.h"
#include "slicer/colour/verdict.h"

namespace voxtone::test {

/// Linear, of sRGB's codes.
inline Eigen::Vector3f of_codes(int red, int green, int blue) {
    const auto linear = [](int code) { return float(optics::srgb_decode(code / 255.0)); };
    return {linear(red), linear(green), linear(blue)};
}

inline Eigen::Vector3d lab_of(const Eigen::Vector3f& rgb) { return optics::lab_from_linear_srgb(rgb.cast<double>()); }

/// Of cells: the last ones are not in it.
struct CellBox {
    int left, low, right, high;
    [[nodiscard]] bool holds(int x, int y) const { return x >= left && x < right && y >= low && y < high; }
    [[nodiscard]] CellBox within(int by) const { return {left + by, low + by, right - by, high - by}; }
};

/// Vero Opaque's five.
inline const slicer::JobColour& five_resins() {
    static const optics::ResinSet set = optics::vero_opaque();
    static const slicer::JobColour colour(set, [] {
        optics::ShellGeometry geometry;
        geometry.core_resin = geometry.white_resin = set.find("W");
        return geometry;
    }());
    return colour;
}

class JudgedSheet {
public:
    static constexpr int columns = 80, rows = 60;
    static constexpr float cell_mm = 0.1f, height_mm = 2;

    /// Nothing is flat, and all is grey as it was asked for.
    JudgedSheet() {
        p.predicted.surface.cell_voxels = {1, 1, 1};
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x) {
                optics::SurfaceCell& cell = p.predicted.surface.cells.emplace_back();
                cell.cell = {x, y, 19};
                cell.centre_mm = {(float(x) + 0.5f) * cell_mm, (float(y) + 0.5f) * cell_mm, height_mm};
                cell.normal = {0, 0, 1}, cell.area_mm2 = cell_mm * cell_mm;
            }
        const std::size_t n = p.predicted.surface.cells.size();
        p.cell_um = {100, 100, 100};
        p.target.assign(n, of_codes(150, 150, 150));
        p.predicted.rgb = p.seen.target = p.seen.print = p.target;
        p.seen.difference.assign(n, 0), p.difference.assign(n, 0);
        p.seen.fine.resize(n), p.seen.texture.resize(n);
        body.is_picture = true;
        body.grid.size = {columns, rows, 20};
        body.grid.pitch_mm = {0.1, 0.1, 0.1};
        body.placement.extent_mm = {8, 6, 2};
        stand_on(body);
        p.volume = optics::make_resin_volume({columns, rows, 20}, {0.1, 0.1, 0.1},
                                             [](int, int, int) { return optics::Material{1}; });
        p.channels = optics::vero_opaque().channels;
        job.printer.tray_mm = {490, 390, 200};
        job.resins.set = optics::vero_opaque();
        job.resins.entries.resize(halftone::max_resins);  // no slot is free, so that no other resin is tried
        stays_picture();
    }

    void stays_picture() { body.is_picture = true, look_from_outside(); }
    /// The same, as the upper side of a body.
    void becomes_body() { body.is_picture = false, look_from_outside(); }
    void look_from_outside() {
        p.sides = slicer::SidesSeen(body, p.predicted.surface, Progress());
        seen = slicer::seen_areas(p.predicted.surface, p.sides);
    }

    [[nodiscard]] static std::uint32_t at(int x, int y) { return std::uint32_t(y * columns + x); }
    [[nodiscard]] static std::vector<std::uint32_t> cells_of(const CellBox& box) {
        std::vector<std::uint32_t> cells;
        for (int y = box.low; y < box.high; ++y)
            for (int x = box.left; x < box.right; ++x) cells.push_back(at(x, y));
        return cells;
    }
    /// What is asked for there and what is printed, before the eye and behind it; differences are put down by
    /// themselves.
    void paint(const CellBox& box, const Eigen::Vector3f& asked, const Eigen::Vector3f& printed) {
        for (const std::uint32_t i : cells_of(box)) {
            p.target[i] = p.seen.target[i] = asked;
            p.predicted.rgb[i] = p.seen.print[i] = printed;
        }
    }
    /// A region whose interior lies `rim` cells within it; `off`: what its row is told to differ by.
    void add(halftone::RegionKind kind, const CellBox& box, const Eigen::Vector3f& asked,
             const Eigen::Vector3f& printed, double off, int rim = 2) {
        paint(box, asked, printed);
        halftone::ColourRegion& region = p.seen.regions.emplace_back();
        region.kind = kind, region.target = asked;
        region.cells = cells_of(box), region.interior = cells_of(box.within(rim));
        if (region.interior.empty()) region.interior = region.cells;
        region.area_mm2 = 0.01 * double(region.cells.size());
        p.seen.looks.push_back({lab_of(printed), lab_of(asked), off, 0});
        p.seen.rims.push_back(0);
    }
    void add(halftone::RegionKind kind, const CellBox& box, const Eigen::Vector3f& asked, double off = 0) {
        add(kind, box, asked, asked, off);
    }

    [[nodiscard]] slicer::JudgedRegions judge() const {
        const slicer::PlaceWords places(body);
        return slicer::judge_regions({p, five_resins(), p.sides, places, seen, limits, body.is_picture, distance_mm},
                                     walls);
    }
    /// Of all of it.
    [[nodiscard]] io::ReportVerdict verdict() const {
        const std::optional<slicer::JobPrediction> prediction(p);
        return slicer::judge({job, body, five_resins(), prediction, "", {}, loop});
    }
    /// The row whose `asked` begins so, or whose kind that is; fails where there is none.
    [[nodiscard]] static io::ReportRegion row(const slicer::JudgedRegions& judged, const std::string& what) {
        for (const io::ReportRegion& region : judged.rows)
            if (region.asked.starts_with(what) || region.kind == what) return region;
        FAIL("no row of " << what);
        return {};
    }
    [[nodiscard]] io::ReportRegion row(const std::string& what) const { return row(judge(), what); }
    [[nodiscard]] bool has(const std::string& what) const {
        for (const io::ReportRegion& region : judge().rows)
            if (region.asked.starts_with(what) || region.kind == what) return true;
        return false;
    }

    slicer::JobPrediction p;
    slicer::JobBody body;
    slicer::OpenedJob job;
    std::optional<slicer::JobLoop> loop;
    std::vector<double> seen;
    slicer::VerdictLimits limits;
    slicer::ThinWalls walls;
    double distance_mm = 300;

private:
    static void stand_on(slicer::JobBody& body) {
        slicer::VisibleSurface block;
        for (int c = 0; c < 8; ++c)
            block.positions_mm.emplace_back(c & 1 ? 8 : 0, c & 2 ? 6 : 0, c & 4 ? double(height_mm) : 0);
        block.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                           {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {4, 5, 7}, {4, 7, 6}};
        block.source_triangle.assign(12, 0), block.source_uv.resize(12);
        body.surface = slicer::SurfaceIndex(std::move(block));
    }
};

}  // namespace voxtone::test
