// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

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

constexpr double white_share = 0.8, paper_reflectance = 0.88, table_reflectance = 0.03;
constexpr double slab_edge_mm = 40, rim_mm = 0.4, rim_share = 0.6;
constexpr double chart_cell_mm = 12, chart_rim_mm = 4, chart_patch = 0.84, chart_black = 0.04;
constexpr double scratch_mm = 0.06, scratch_light = 0.9, scratch_cover = 0.5, scratch_reach_mm = 5.5;
enum BenchStream : std::uint32_t { noise_stream = 11, scratch_stream = 12 };

double normal_number(RandomStream& random) {
    const double r = std::sqrt(-2 * std::log(1 - random.uniform()));
    return r * std::cos(2 * std::numbers::pi * random.uniform());
}

// Colours of the camera's channels from linear sRGB; of the size of a real camera's, rows sum to 1.
Eigen::Matrix3d camera_matrix(const BenchCameraOptions& o) {
    Eigen::Matrix3d mixing;
    mixing << 0.71, 0.25, 0.04, 0.16, 0.74, 0.10, 0.03, 0.21, 0.76;
    const Eigen::Matrix3d some = Eigen::Matrix3d::Identity() + o.matrix * (mixing - Eigen::Matrix3d::Identity());
    return o.white_balance.asDiagonal() * some * (o.exposure * white_share / o.white_balance.maxCoeff());
}

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

struct Scratch {
    Vector2d from, along;
    double length;
    [[nodiscard]] bool hits(const Vector2d& p) const {
        const double t = std::clamp((p - from).dot(along), 0.0, length);
        return (p - from - t * along).norm() < scratch_mm;
    }
};

std::vector<Scratch> scratches_of(const BenchCameraOptions& o, std::uint64_t shot) {
    std::vector<Scratch> list;
    for (int k = 0; k < o.scratches; ++k) {
        RandomStream random(o.seed, shot * 1000 + std::uint64_t(k), scratch_stream);
        const double x = random.uniform(), y = random.uniform(),
                     angle = std::numbers::pi * (random.uniform() - 0.5) / 2;
        list.push_back({scratch_reach_mm * Vector2d(2 * x - 1, 2 * y - 1),
                        {std::cos(angle), std::sin(angle)},
                        2 + 6 * random.uniform()});
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
    const auto range = [](const char* name, double value, double least, double most) {
        if (!(value >= least && value <= most))
            throw InputError(fmt::format("{}: {}; expected {} to {}", name, value, least, most));
    };
    range("--field", width_mm, 70, 400);
    range("--field", height_mm, 60, 400);
    range("--turn", turn_deg, -45, 45);
    range("--uneven", uneven, 0, 0.2);
    range("--vignetting", vignetting, 0, 0.9);
    range("--electrons", electrons, 0, 1e9);
    range("--read-noise", read_noise, 0, 1);
    range("--exposure", exposure, 1e-3, 100);
    range("--scratches", scratches, 0, 1000);
    range("--camera-colours", matrix, 0, 1.2);
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
    io::Photograph photo;
    photo.name = "simulated";
    photo.width_px = width_px_;
    photo.height_px = height_px_;
    photo.pixels.resize(std::size_t{width_px_} * height_px_);
    const Vector2d middle = Vector2d(width_px_, height_px_) / 2;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-options_.turn_deg * std::numbers::pi / 180).toRotationMatrix();
    parallel_for(0, height_px_, 8, [&](std::size_t row) {
        for (std::uint32_t column = 0; column < width_px_; ++column) {
            const Vector2d mm = turn * (Vector2d(column + 0.5, double(row) + 0.5) - middle) * setup_.pitch_mm;
            photo.pixels[photo.index(column, std::uint32_t(row))] = scene(mm).template cast<float>();
        }
    });
    const double blur_px = setup_.blur_mm / setup_.pitch_mm;
    cv::Mat picture(int(height_px_), int(width_px_), CV_32FC3, photo.pixels.data());
    if (blur_px > 0) {
        const int size = 2 * int(std::ceil(4 * blur_px)) + 1;
        cv::GaussianBlur(picture, picture, {size, size}, blur_px, blur_px, cv::BORDER_REPLICATE);
    }
    const Eigen::Matrix3d colours = gain * camera_matrix(options_);
    const double fall = 1 / std::sqrt(1 - options_.vignetting) - 1;
    parallel_for(0, height_px_, 8, [&](std::size_t row) {
        for (std::uint32_t column = 0; column < width_px_; ++column) {
            const std::size_t i = photo.index(column, std::uint32_t(row));
            const Vector2d off = Vector2d(column + 0.5, double(row) + 0.5) - middle, mm = off * setup_.pitch_mm;
            const double r2 = off.squaredNorm() / middle.squaredNorm();
            const double light =
                (1 + options_.uneven * (0.8 * mm.x() + 0.6 * mm.y()) / 10) / std::pow(1 + fall * r2, 2);
            Vector3d signal = light * (colours * photo.pixels[i].cast<double>());
            if (options_.electrons > 0) {
                RandomStream random(options_.seed * 1000 + shot, i, noise_stream);
                for (double& value : signal)
                    value += normal_number(random) * std::sqrt(std::max(value, 0.0) / options_.electrons +
                                                               options_.read_noise * options_.read_noise);
            }
            photo.pixels[i] = signal.cwiseMax(0).cwiseMin(1).cast<float>();
        }
    });
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
            const Vector2d cell = (mm + half) / chart_cell_mm;
            if ((mm.cwiseAbs() - half).maxCoeff() > chart_rim_mm) return Vector3d::Constant(table_reflectance);
            const double column = std::floor(cell.x()), row = std::floor(cell.y());
            const double off = (cell - Vector2d(column + 0.5, row + 0.5)).cwiseAbs().maxCoeff();
            if (column < 0 || row < 0 || column >= chart.columns || row >= chart.rows || off > chart_patch / 2)
                return Vector3d::Constant(chart_black);
            return chart.linear_srgb[std::size_t(int(row) * chart.columns + int(column))];
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
    const std::vector<Scratch> scratches = scratches_of(options_, shot);
    return take(
        [&](const Vector2d& mm) -> Vector3d {
            const double inside = slab_edge_mm / 2 - (mm - shift_mm).cwiseAbs().maxCoeff();
            if (inside < 0) return sheet_at(mm + Vector2d(Sheet::edge_x, Sheet::edge_y));
            Vector3d seen;
            for (std::size_t c = 0; c < 3; ++c) seen[Eigen::Index(c)] = look.at(c, mm.x(), mm.y());
            if (inside < rim_mm) seen *= rim_share;
            for (const Scratch& scratch : scratches)
                if (scratch.hits(mm - shift_mm)) seen += scratch_cover * (Vector3d::Constant(scratch_light) - seen);
            return seen;
        },
        1 / bias, shot);
}

}  // namespace voxtone::calibration
