// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/photo_simulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace voxtone::calibration {

namespace {

using std::numbers::pi;
constexpr double gap_mm = 8, chart_rim_mm = 4;
enum Stream : std::uint32_t { dust_stream = 1, scratch_stream = 2, chart_stream = 4 };

double radians(double degrees) { return degrees * pi / 180; }

/// What covers so much of the target under it.
struct Dirt : Stroke {
    double cover;
    Eigen::Vector3d colour;
};

/// Everything that lies on the table, in the target's coordinates.
class Table {
public:
    Table(const FlatThing& thing, const CheckerChart& chart, const PhotoOptions& o)
        : thing_(thing), chart_(chart), options_(o) {
        const bool turned = o.checker_turns % 2 != 0;
        const Eigen::Vector2d chart_size = o.checker_cell_mm * Eigen::Vector2d(turned ? chart.rows : chart.columns,
                                                                               turned ? chart.columns : chart.rows);
        const Eigen::Vector2d middle(thing.size_mm.x() + gap_mm + chart_rim_mm + chart_size.x() / 2,
                                     thing.size_mm.y() / 2);
        chart_area_ = {middle - chart_size / 2, middle + chart_size / 2};
        chart_middle_ = middle;
        to_chart_ = Eigen::Rotation2Dd(pi / 2 * o.checker_turns).toRotationMatrix();
        for (std::size_t p = 0; p < chart.linear_srgb.size(); ++p) {
            RandomStream random(o.seed, p, chart_stream);
            chart_colours_.push_back(chart.linear_srgb[p]);
            for (double& value : chart_colours_.back()) value *= 1 + o.checker_error * normal_number(random);
        }
        all_.max_mm = thing.size_mm;
        if (o.checker) {
            const Area rim = chart_area_.shrunk(-chart_rim_mm);
            all_.min_mm = all_.min_mm.cwiseMin(rim.min_mm);
            all_.max_mm = all_.max_mm.cwiseMax(rim.max_mm);
        }
        spread_dirt();
    }

    [[nodiscard]] const Area& all() const { return all_; }

    /// A corner of the chart: columns and rows of cells from its own upper left.
    [[nodiscard]] Eigen::Vector2d chart_point(double column, double row) const {
        const Eigen::Vector2d own(column - chart_.columns / 2.0, chart_.rows / 2.0 - row);
        return chart_middle_ + options_.checker_cell_mm * (Eigen::Rotation2Dd(-pi / 2 * options_.checker_turns) * own);
    }

    [[nodiscard]] Eigen::Vector3d at(const Eigen::Vector2d& p) const {
        if (p.x() >= 0 && p.y() >= 0 && p.x() <= thing_.size_mm.x() && p.y() <= thing_.size_mm.y())
            return dirty(p, thing_.at(p));
        if (options_.checker && chart_area_.shrunk(-chart_rim_mm).contains(p)) {
            const Eigen::Vector2d own = to_chart_ * ((p - chart_middle_) / options_.checker_cell_mm);
            return chart_colour(chart_, chart_colours_, {own.x() + chart_.columns / 2.0, chart_.rows / 2.0 - own.y()});
        }
        return Eigen::Vector3d::Constant(options_.sheet);
    }

private:
    static constexpr double bucket_mm = 2;

    /// Of a point on the target, or the nearest on it.
    [[nodiscard]] Eigen::Vector2i bucket(const Eigen::Vector2d& p) const {
        return (p / bucket_mm).cast<int>().cwiseMax(0).cwiseMin(last_bucket_);
    }
    [[nodiscard]] std::size_t index(int x, int y) const { return std::size_t(y * (last_bucket_.x() + 1) + x); }

    void add(const Dirt& dirt) {
        dirt_.push_back(dirt);
        const Eigen::Vector2d rim = Eigen::Vector2d::Constant(dirt.radius_mm);
        const Eigen::Vector2i low = bucket(dirt.from.cwiseMin(dirt.to) - rim),
                              high = bucket(dirt.from.cwiseMax(dirt.to) + rim);
        for (int x = low.x(); x <= high.x(); ++x)
            for (int y = low.y(); y <= high.y(); ++y) buckets_[index(x, y)].push_back(dirt_.size() - 1);
    }

    void spread_dirt() {
        last_bucket_ = (thing_.size_mm / bucket_mm).cast<int>();
        buckets_.resize(index(last_bucket_.x(), last_bucket_.y()) + 1);
        const auto somewhere = [&](RandomStream& random) {
            const double x = random.uniform(), y = random.uniform();
            return Eigen::Vector2d(x * thing_.size_mm.x(), y * thing_.size_mm.y());
        };
        for (int i = 0; i < options_.dust; ++i) {
            RandomStream random(options_.seed, std::uint64_t(i), dust_stream);
            const Eigen::Vector2d p = somewhere(random);
            const double radius = 0.05 + 0.35 * random.uniform() * random.uniform(),
                         grey = random.uniform() < 0.7 ? 0.05 + 0.1 * random.uniform() : 0.8;
            add({{p, p, radius}, 0.9, Eigen::Vector3d::Constant(grey)});
        }
        for (int i = 0; i < options_.scratches; ++i) {
            RandomStream random(options_.seed, std::uint64_t(i), scratch_stream);
            const Eigen::Vector2d p = somewhere(random);
            const double length = 5 + 35 * random.uniform(), angle = pi * random.uniform(),
                         radius = 0.03 + 0.05 * random.uniform();
            add({{p, p + length * Eigen::Vector2d(std::cos(angle), std::sin(angle)), radius},
                 0.4,
                 Eigen::Vector3d::Constant(0.9)});
        }
    }

    [[nodiscard]] Eigen::Vector3d dirty(const Eigen::Vector2d& p, Eigen::Vector3d colour) const {
        const Eigen::Vector2i here = bucket(p);
        for (const std::size_t d : buckets_[index(here.x(), here.y())])
            if (dirt_[d].hits(p)) colour += dirt_[d].cover * (dirt_[d].colour - colour);
        return colour;
    }

    const FlatThing& thing_;
    const CheckerChart& chart_;
    const PhotoOptions& options_;
    Area chart_area_, all_;
    Eigen::Vector2d chart_middle_ = Eigen::Vector2d::Zero();
    Eigen::Matrix2d to_chart_;
    std::vector<Eigen::Vector3d> chart_colours_;
    std::vector<Dirt> dirt_;
    Eigen::Vector2i last_bucket_ = Eigen::Vector2i::Zero();
    std::vector<std::vector<std::size_t>> buckets_;  ///< of the dirt that may lie there, row by row
};

/// Points of the table, mm -> points of the picture, px (the middle of the first pixel is at (0.5, 0.5)).
Eigen::Matrix3d camera(const Area& all, const PhotoOptions& o) {
    const double width = all.size().maxCoeff();
    Eigen::Matrix3d to_middle = Eigen::Matrix3d::Identity();
    to_middle.topRightCorner<2, 1>() = -all.center();
    const Eigen::Matrix3d turned = (Eigen::AngleAxisd(radians(o.tilt_x_deg), Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(radians(o.tilt_y_deg), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(radians(o.turn_deg), Eigen::Vector3d::UnitZ()))
                                       .toRotationMatrix();
    Eigen::Matrix3d project;  // the table's plane, turned, in front of a pinhole; the picture's y runs down
    project.row(0) = Eigen::RowVector3d(turned(0, 0), turned(0, 1), 0) * (o.mirrored ? -1 : 1);
    project.row(1) = Eigen::RowVector3d(-turned(1, 0), -turned(1, 1), 0);
    project.row(2) = Eigen::RowVector3d(-turned(2, 0), -turned(2, 1), o.distance * width);
    const Eigen::Matrix3d view = project * to_middle;
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e30), high = -low;
    for (const double x : {all.min_mm.x(), all.max_mm.x()})
        for (const double y : {all.min_mm.y(), all.max_mm.y()}) {
            const Eigen::Vector2d p = (view * Eigen::Vector3d(x, y, 1)).hnormalized();
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    const Eigen::Vector2d room = Eigen::Vector2d(o.width_px, o.height_px) * (1 - 2 * o.margin);
    const double scale = std::min(room.x() / (high - low).x(), room.y() / (high - low).y());
    const Eigen::Vector2d shift = Eigen::Vector2d(o.width_px, o.height_px) / 2 - scale * (low + high) / 2;
    Eigen::Matrix3d fit = Eigen::Matrix3d::Identity();
    fit(0, 0) = fit(1, 1) = scale;
    fit.topRightCorner<2, 1>() = shift;
    return fit * view;
}

/// Light that falls upon a point, 1 in the middle of the scene.
class Lamp {
public:
    Lamp(const Area& all, const PhotoOptions& o) : distance_(o.lamp_mm) {
        const Eigen::Vector2d side =
            std::sqrt(0.5) * o.lamp_mm *
            Eigen::Vector2d(std::cos(radians(o.lamp_azimuth_deg)), std::sin(radians(o.lamp_azimuth_deg)));
        place_ = {all.center().x() + side.x(), all.center().y() + side.y(), std::sqrt(0.5) * o.lamp_mm};
    }
    [[nodiscard]] double at(double x, double y) const {
        if (distance_ <= 0) return 1;
        const double dx = place_.x() - x, dy = place_.y() - y, dz = place_.z();
        const double closer = distance_ / std::sqrt(dx * dx + dy * dy + dz * dz);
        return closer * closer * closer;  // 1/r^2, and the cosine has another 1/r
    }

private:
    double distance_;
    Eigen::Vector3d place_;
};

/// Moves places of the picture towards its middle by the cube of their distance, 1 being a corner's.
class Lens {
public:
    explicit Lens(const PhotoOptions& o) : middle_(o.width_px / 2.0, o.height_px / 2.0), bend_(o.lens) {}
    [[nodiscard]] Eigen::Vector2d bent(const Eigen::Vector2d& px) const {
        const Eigen::Vector2d off = px - middle_;
        return middle_ + off * (1 - bend_ * off.squaredNorm() / middle_.squaredNorm());
    }
    /// The inverse, by iteration.
    [[nodiscard]] Eigen::Vector2d straight(const Eigen::Vector2d& px) const {
        if (bend_ == 0) return px;
        Eigen::Vector2d off = px - middle_;
        constexpr int rounds = 12;
        for (int round = 0; round < rounds; ++round)
            off = (px - middle_) / (1 - bend_ * off.squaredNorm() / middle_.squaredNorm());
        return middle_ + off;
    }

private:
    Eigen::Vector2d middle_;
    double bend_;
};

}  // namespace

void PhotoOptions::validate() const {
    Sensor::validate();
    expect_within("--width", width_px, 64, 20000);
    expect_within("--height", height_px, 64, 20000);
    expect_within("rays", rays, 1, 16);
    expect_within("--tilt-x", tilt_x_deg, -50, 50);
    expect_within("--tilt-y", tilt_y_deg, -50, 50);
    expect_within("--turn", turn_deg, -360, 360);
    expect_within("--distance", distance, 1, 1e6);
    if (lamp_mm != 0) expect_within("--lamp", lamp_mm, 300, 1e9);
    expect_within("--lamp-azimuth", lamp_azimuth_deg, -360, 360);
    expect_within("--blur", blur_px, 0, 100);
    expect_within("--margin", margin, 0, 0.4);
    expect_within("the lens", lens, -0.2, 0.2);
    expect_within("--sheet", sheet, 0, 1);
    expect_within("--dust", dust, 0, 10000);
    expect_within("--scratches", scratches, 0, 1000);
    expect_within("--checker-turns", checker_turns, 0, 3);
    expect_within("--checker-error", checker_error, 0, 0.5);
    expect_within("the size of the chart's cells", checker_cell_mm, 1, 100);
}

SimulatedPhoto simulate_photo(const Target& target, const TargetColours& colours, const CheckerChart& chart,
                              const PhotoOptions& options) {
    const TargetScene scene(target, colours);
    return simulate_photo({target.size_mm, [&](const Eigen::Vector2d& p) { return scene.at(p); }}, chart, options);
}

SimulatedPhoto simulate_photo(const FlatThing& thing, const CheckerChart& chart, const PhotoOptions& o) {
    o.validate();
    const Table table(thing, chart, o);
    const Eigen::Matrix3d H = camera(table.all(), o), back = H.inverse();
    const Lens lens(o);
    const Lamp lamp(table.all(), o);

    SimulatedPhoto result{black_photograph(o.width_px, o.height_px), {}, {}, {}};
    io::Photograph& photo = result.photograph;
    // Rays of a row side by side, for vectors; of each pixel in their order.
    const std::size_t rays = std::size_t(o.rays), in_row = o.width_px * rays;
    std::vector<double> across(in_row);
    for (std::size_t i = 0; i < in_row; ++i) across[i] = double(i / rays) + (double(i % rays) + 0.5) / o.rays;
    parallel_for(0, o.height_px, 4, [&](std::size_t y) {
        std::vector<Eigen::Vector3d> sums(o.width_px, Eigen::Vector3d::Zero());
        std::vector<double> us = across, xs(in_row), ys(in_row), light(in_row);
        for (std::size_t r = 0; r < rays; ++r) {
            const double down = double(y) + (double(r) + 0.5) / o.rays;
            std::vector<double> vs(in_row, down);
            if (o.lens != 0)
                for (std::size_t i = 0; i < in_row; ++i) {
                    const Eigen::Vector2d straight = lens.straight({across[i], down});
                    us[i] = straight.x(), vs[i] = straight.y();
                }
            for (std::size_t i = 0; i < in_row; ++i) {
                const double far = back(2, 0) * us[i] + back(2, 1) * vs[i] + back(2, 2);
                xs[i] = (back(0, 0) * us[i] + back(0, 1) * vs[i] + back(0, 2)) / far;
                ys[i] = (back(1, 0) * us[i] + back(1, 1) * vs[i] + back(1, 2)) / far;
                light[i] = lamp.at(xs[i], ys[i]);
            }
            for (std::size_t i = 0; i < in_row; ++i) sums[i / rays] += light[i] * table.at({xs[i], ys[i]});
        }
        for (std::uint32_t x = 0; x < o.width_px; ++x)
            photo.pixels[photo.index(x, std::uint32_t(y))] = (sums[x] / (o.rays * o.rays)).cast<float>();
    });
    expose(photo, o, o.blur_px, o.seed);
    const auto pixel = [H, lens](const Eigen::Vector2d& p) { return lens.bent((H * p.homogeneous()).hnormalized()); };
    result.to_px = pixel;
    const Eigen::Vector2d& size = thing.size_mm;
    for (const Eigen::Vector2d& p :
         {Eigen::Vector2d(0, size.y()), Eigen::Vector2d(size), Eigen::Vector2d(size.x(), 0), Eigen::Vector2d(0, 0)})
        result.target_corners_px.push_back(pixel(p));
    if (o.checker)
        for (const auto& [column, row] : {std::pair{0, 0}, std::pair{chart.columns, 0},
                                          std::pair{chart.columns, chart.rows}, std::pair{0, chart.rows}})
            result.checker_corners_px.push_back(pixel(table.chart_point(column, row)));
    return result;
}

}  // namespace voxtone::calibration
