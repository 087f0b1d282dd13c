// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/bench_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "calibration/edge/edge_sheet.h"
#include "calibration/target/marker_pattern.h"
#include "optics/edge/edge_scene_paths.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Sheet = EdgeSheetLayout;

constexpr double paper_reflectance = 0.88, table_reflectance = 0.03;
constexpr double slab_edge_mm = 40, rim_mm = 0.4, rim_share = 0.6;
constexpr double chart_cell_mm = 12, chart_rim_mm = 4;
constexpr double scratch_mm = 0.06, scratch_light = 0.9, scratch_cover = 0.5, scratch_reach_mm = 5.5;
constexpr std::uint32_t scratch_stream = 12;

// Alternating squares along one axis: what the edge nearest to t makes of it, -1 far on its black side, 1 far on its
// white one. `edge(d)`: for a distance d towards white. Edges at 0, +-20, ...; white lies right of that at 0.
template <class Edge>
double alternating(double t, const Edge& edge) {
    const double k = std::round(t / Sheet::square), d = t - k * Sheet::square;
    return (std::lround(k) & 1) ? edge(-d) : edge(d);
}

// What a row of pixels sees of a slab across its edge, at any distance.
class SlabLook {
public:
    SlabLook(const RenderedSlab& slab, double pixel_mm) : reach_(slab.reach_mm) {
        EdgeSetup sharp;
        sharp.pitch_mm = pixel_mm;
        sharp.blur_mm = 0;  // the camera's comes later
        std::vector<double> x;
        for (double at = -reach_ + pixel_mm; at <= reach_ - pixel_mm; at += step) x.push_back(at);
        for (std::size_t c = 0; c < 3; ++c) {
            seen_[c] = seen_by_camera(slab, c, x, sharp);
            const auto ends = std::ptrdiff_t(0.5 / step);
            for (auto k = std::ptrdiff_t(0); k < ends; ++k) {
                black_[c] += seen_[c][std::size_t(k)] / double(ends);
                white_[c] += seen_[c][seen_[c].size() - 1 - std::size_t(k)] / double(ends);
            }
        }
        first_ = x.front();
    }

    // At a place about the middle of the edge.
    [[nodiscard]] double at(std::size_t c, double x, double y) const {
        const double middle = (white_[c] + black_[c]) / 2, half = (white_[c] - black_[c]) / 2;
        if (std::abs(half) < 1e-9) return middle;
        const auto edge = [&](double d) { return (value(c, d) - middle) / half; };
        // Edges along x lie 10 mm above and below.
        return middle + half * alternating(x, edge) * alternating(y + Sheet::square / 2, edge);
    }

private:
    static constexpr double step = 0.01;
    [[nodiscard]] double value(std::size_t c, double d) const {
        const double t = (d - first_) / step;
        if (t <= 0) return black_[c];
        const auto k = std::size_t(t);
        if (k + 1 >= seen_[c].size()) return white_[c];
        return seen_[c][k] + (t - double(k)) * (seen_[c][k + 1] - seen_[c][k]);
    }
    double reach_, first_ = 0;
    std::array<std::vector<double>, 3> seen_;
    std::array<double, 3> black_{}, white_{};
};

std::vector<Stroke> scratches_of(const BenchCameraOptions& o, std::uint64_t shot) {
    std::vector<Stroke> list;
    for (int k = 0; k < o.scratches; ++k) {
        RandomStream random(o.seed, shot * 1000 + std::uint64_t(k), scratch_stream);
        const double x = random.uniform(), y = random.uniform(),
                     angle = std::numbers::pi * (random.uniform() - 0.5) / 2;
        const Vector2d from = scratch_reach_mm * Vector2d(2 * x - 1, 2 * y - 1);
        const double length = 2 + 6 * random.uniform();
        list.push_back({from, from + length * Vector2d(std::cos(angle), std::sin(angle)), scratch_mm});
    }
    return list;
}

bool in_fiducial(const Vector2d& page) {
    constexpr double margin = Sheet::fiducial_margin, edge = Sheet::fiducial;
    const bool right = page.x() > Sheet::width / 2, below = page.y() > Sheet::height / 2;
    const double x = page.x() - (right ? Sheet::width - margin - edge : margin),
                 y = page.y() - (below ? Sheet::height - margin - edge : margin);
    if (x < 0 || y < 0 || x >= edge || y >= edge) return false;
    const std::size_t id = below ? (right ? 2 : 3) : (right ? 1 : 0);
    const std::vector<bool> cells = marker_pattern(int(id));
    return cells[std::size_t(y / edge * marker_cells) * marker_cells + std::size_t(x / edge * marker_cells)];
}

}  // namespace

void BenchCameraOptions::validate() const {
    Sensor::validate();
    expect_within("--field", width_mm, 70, 400);
    expect_within("--field", height_mm, 60, 400);
    expect_within("--turn", turn_deg, -45, 45);
    expect_within("--uneven", uneven, 0, 0.2);
    expect_within("--scratches", scratches, 0, 1000);
}

BareSheet render_bare_sheet(const EdgeSetup& setup, std::uint64_t seed) {
    BareSheet bare;
    for (std::size_t c = 0; c < 3; ++c) {
        optics::EdgeScene scene;
        scene.assembly = setup.assembly;
        scene.assembly.gel = scene.assembly.glass = false;
        scene.assembly.slab_index = 1;  // a slab of air
        scene.assembly.slab_roughness = 0;
        scene.slab_mm = 1e-3;
        scene.sigma_t = 1e-9;
        scene.sheet = setup.sheet(c);
        scene.paths = 1u << 21;
        scene.seed = seed + 77 + c;
        const std::vector<double> F = optics::render_edge(scene, 1, 0.5);
        bare.black[c] = F.front();
        bare.white[c] = F.back();
    }
    return bare;
}

BenchCamera::BenchCamera(const EdgeSetup& setup, const BareSheet& sheet, const BenchCameraOptions& options)
    : setup_(setup),
      sheet_(sheet),
      options_(options),
      width_px_(std::uint32_t(std::lround(options.width_mm / setup.pitch_mm))),
      height_px_(std::uint32_t(std::lround(options.height_mm / setup.pitch_mm))) {
    options.validate();
    if (std::uint64_t{width_px_} * height_px_ > 60000000)
        throw InputError(fmt::format("--field {:g},{:g} at {:g} mm a pixel: {} x {} pixels, more than 60 million",
                                     options.width_mm, options.height_mm, setup.pitch_mm, width_px_, height_px_));
}

template <class Scene>
io::Photograph BenchCamera::take(const Scene& scene, double gain, std::uint64_t shot) const {
    io::Photograph photo = black_photograph(width_px_, height_px_);
    const Vector2d middle = Vector2d(width_px_, height_px_) / 2;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-options_.turn_deg * std::numbers::pi / 180).toRotationMatrix();
    parallel_for(0, height_px_, 8, [&](std::size_t row) {
        for (std::uint32_t column = 0; column < width_px_; ++column) {
            const Vector2d mm = (Vector2d(column + 0.5, double(row) + 0.5) - middle) * setup_.pitch_mm;
            const double light = gain * (1 + options_.uneven * (0.8 * mm.x() + 0.6 * mm.y()) / 10);
            photo.pixels[photo.index(column, std::uint32_t(row))] = (light * scene(turn * mm)).template cast<float>();
        }
    });
    expose(photo, options_, setup_.blur_mm / setup_.pitch_mm, options_.seed * 1000 + shot);
    return photo;
}

Vector3d BenchCamera::sheet_at(const Vector2d& page) const {
    Vector3d black(sheet_.black[0], sheet_.black[1], sheet_.black[2]),
        white(sheet_.white[0], sheet_.white[1], sheet_.white[2]);
    if (page.x() < 0 || page.y() < 0 || page.x() >= Sheet::width || page.y() >= Sheet::height)
        return Vector3d::Constant(table_reflectance);
    const double column = (page.x() - Sheet::left) / Sheet::square, row = (page.y() - Sheet::top) / Sheet::square;
    if (column < 0 || row < 0 || column >= Sheet::columns || row >= Sheet::rows) {
        const bool line = std::abs(page.y() - Sheet::scale_y) < 0.2 && page.x() > Sheet::scale_left &&
                          page.x() < Sheet::scale_left + Sheet::scale_length;
        return line || in_fiducial(page) ? black : white;
    }
    const auto edge = [&](double d) { return std::clamp(2 * d / setup_.pitch_mm, -1.0, 1.0); };
    const double side =
        alternating(page.x() - Sheet::edge_x, edge) * alternating(page.y() - Sheet::edge_y + Sheet::square / 2, edge);
    return (white + black) / 2 + side * (white - black) / 2;
}

io::Photograph BenchCamera::of_checker(const CheckerChart& chart, std::uint64_t shot) const {
    const Vector2d half = chart_cell_mm * Vector2d(chart.columns, chart.rows) / 2;
    return take(
        [&](const Vector2d& mm) -> Vector3d {
            if ((mm.cwiseAbs() - half).maxCoeff() > chart_rim_mm) return Vector3d::Constant(table_reflectance);
            return chart_colour(chart, chart.linear_srgb, (mm + half) / chart_cell_mm);
        },
        1, shot);
}

io::Photograph BenchCamera::of_paper(std::uint64_t shot) const {
    return take([](const Vector2d&) -> Vector3d { return Vector3d::Constant(paper_reflectance); }, 1, shot);
}

io::Photograph BenchCamera::of_sheet(std::uint64_t shot) const {
    return take([&](const Vector2d& mm) { return sheet_at(mm + Vector2d(Sheet::edge_x, Sheet::edge_y)); }, 1, shot);
}

io::Photograph BenchCamera::of_slab(const RenderedSlab& slab, double bias, const Vector2d& shift_mm,
                                    std::uint64_t shot) const {
    const SlabLook look(slab, setup_.pitch_mm);
    const std::vector<Stroke> scratches = scratches_of(options_, shot);
    return take(
        [&](const Vector2d& mm) -> Vector3d {
            const double inside = slab_edge_mm / 2 - (mm - shift_mm).cwiseAbs().maxCoeff();
            if (inside < 0) return sheet_at(mm + Vector2d(Sheet::edge_x, Sheet::edge_y));
            Vector3d seen;
            for (std::size_t c = 0; c < 3; ++c) seen[Eigen::Index(c)] = look.at(c, mm.x(), mm.y());
            if (inside < rim_mm) seen *= rim_share;
            for (const Stroke& scratch : scratches)
                if (scratch.hits(mm - shift_mm)) seen += scratch_cover * (Vector3d::Constant(scratch_light) - seen);
            return seen;
        },
        1 / bias, shot);
}

}  // namespace voxtone::calibration
