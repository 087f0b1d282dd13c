// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/warning.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double chart_off = 0.03, chart_refused = 0.05;     // residual of the checker in linear sRGB
constexpr double uneven_said = 0.01, uneven_refused = 0.05;  // of the light over the region
constexpr double rough_paper = 0.01;                         // residual of the smooth light: more means shadows, dirt
constexpr double least_level = 0.04;                         // of full scale, of white

// Places of one colour, given in pixels.
std::vector<LitSample> lit_samples(const io::Photograph& photo, const Rectification& place,
                                   const std::vector<Area>& areas, const Vector3d& clip) {
    std::vector<LitSample> lit;
    for (const Area& area : areas) {
        const AreaSample sample = sample_area(photo, place, area, clip);
        if (sample.complete && sample.clipped.maxCoeff() > clipped_share)
            throw InputError(
                fmt::format("{}: white is overexposed: a channel is clipped there; take all photographs "
                            "again with a shorter exposure",
                            photo.name));
        if (sample.complete && sample.rejected <= dirty_share)
            lit.push_back({sample.middle_px, sample.mean, Vector3d::Zero()});
    }
    return lit;
}

std::vector<LitSample> paper_samples(const io::Photograph& paper, const Vector3d& clip) {
    constexpr int columns = 14, rows = 10;
    constexpr double margin = 0.03;
    const Vector2d size(paper.width_px, paper.height_px),
        step = (1 - 2 * margin) * size.cwiseQuotient(Vector2d(columns, rows));
    std::vector<Area> areas;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const Vector2d low = margin * size + step.cwiseProduct(Vector2d(column, row));
            areas.push_back({low + 0.15 * step, low + 0.85 * step});
        }
    return lit_samples(paper, Rectification(Eigen::Matrix3d::Identity()), areas, clip);
}

// The inner parts of the sheet's white squares.
std::vector<LitSample> sheet_samples(const io::Photograph& sheet, const BoardView& board, double square_mm,
                                     const Vector3d& clip) {
    std::vector<Area> areas;
    constexpr int reach = 8;
    for (int row = -reach; row <= reach; ++row)
        for (int column = -reach; column <= reach; ++column) {
            if ((row + column) & 1) continue;  // the square right of the edge, (0, 0), is white
            const Vector2d middle(square_mm * (column + 0.5), square_mm * row);
            for (const Vector2d& off :
                 {Vector2d(-0.22, -0.22), Vector2d(0.22, -0.22), Vector2d(-0.22, 0.22), Vector2d(0.22, 0.22)}) {
                const Vector2d at = middle + square_mm * off, half = Vector2d::Constant(0.15 * square_mm);
                areas.push_back({at - half, at + half});
            }
        }
    return lit_samples(sheet, board.place, areas, clip);
}

void check_sizes(const BenchLightPhotos& photos) {
    const auto check = [&](const io::Photograph& other) {
        if (other.width_px != photos.sheet.width_px || other.height_px != photos.sheet.height_px)
            throw InputError(
                fmt::format("{}: {} x {} pixels, but {} has {} x {}; all photographs must be taken by the same camera "
                            "in the same place, and not be cropped",
                            other.name, other.width_px, other.height_px, photos.sheet.name, photos.sheet.width_px,
                            photos.sheet.height_px));
    };
    check(photos.checker);
    if (photos.paper) check(*photos.paper);
}

BenchLight measure_linear_light(const BenchLightPhotos& photos, const CheckerChart& chart,
                                const BenchLightOptions& options, const BoardView& board, double square_mm) {
    BenchLight light;
    const Vector3d clip = clipping_level(photos.checker);
    std::array<Vector2d, 4> nowhere;
    nowhere.fill(Vector2d(-9, -9));
    light.checker = find_checker_in(photos.checker, chart, clip, nowhere, options.checker_corners);
    const std::vector<LitSample> white =
        photos.paper ? paper_samples(*photos.paper, clipping_level(*photos.paper))
                     : sheet_samples(photos.sheet, board, square_mm, clipping_level(photos.sheet));
    light.model = PhotoModel::fit(usable_patches(light.checker, chart), white, photos.sheet.width_px,
                                  photos.sheet.height_px, photos.checker.name);
    const Vector2d middle = board.place.to_px(Vector2d::Zero());
    double brightest = 0;
    Vector3d at_edge = Vector3d::Zero();
    double near = 1e30;
    for (const LitSample& sample : white) {
        brightest = std::max(brightest, sample.value.maxCoeff());
        if ((sample.px - middle).norm() < near) near = (sample.px - middle).norm(), at_edge = sample.value;
    }
    if (photos.sheet.bits < 32 && brightest < least_level)
        throw InputError(
            fmt::format("{}: underexposed: white reaches {:.1f} % of full scale, dark slabs vanish in the "
                        "noise; expose at least {:.0f} times longer",
                        photos.sheet.name, 100 * brightest, std::ceil(0.5 / std::max(brightest, 1e-3))));
    light.level_error = light.model.error(middle, at_edge)
                            .cwiseQuotient(light.model.reflectance(middle, at_edge).cwiseAbs().cwiseMax(1e-6));
    return light;
}

// Largest deviation of a map over the region from its mean, after the division by `divide`.
template <class Divide>
double deviation(const LightMap& map, const BoardView& board, double width_mm, Divide&& divide) {
    std::vector<double> inside;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Vector2d px = Vector2d(x + 0.5, y + 0.5) / map.scale, mm = board.place.from_px(px);
            if (mm.cwiseAbs().maxCoeff() <= width_mm / 2)
                inside.push_back(double(map.relative[std::size_t(y) * std::size_t(map.width) + std::size_t(x)]) /
                                 divide(px));
        }
    if (inside.empty()) return 0;
    double mean = 0, most = 0;
    for (const double v : inside) mean += v / double(inside.size());
    for (const double v : inside) most = std::max(most, std::abs(v / mean - 1));
    return most;
}

void judge(BenchLight& light, const BenchLightPhotos& photos, const BenchLightOptions& options,
           const BoardView& board) {
    const std::string& checker = photos.checker.name;
    const double off = light.model.chart_residual();
    if (off > chart_refused)
        throw InputError(fmt::format(
            "{}: after the correction of light and colours the checker's patches are still off by {:.3f} on "
            "average (linear, white is 1): another chart, glare on it, or samples that are not linear "
            "light (a tone curve): develop the photographs linearly",
            checker, off));
    if (off > chart_off)
        light.warnings.push_back(named_warning(
            "checker-off",
            fmt::format("{}: after the colour correction the checker's patches are still off by {:.3f} on average "
                        "(linear, white is 1); levels of profiles will be as much.",
                        checker, off)));
    if (light.guessed)
        light.warnings.push_back(named_warning(
            "coding-guessed",
            fmt::format("{}: the file does not say how its samples stand for light; the checker's greys say {} "
                        "(--coding sets it).",
                        checker, light.coding == io::SampleCoding::linear ? "linearly" : "as sRGB codes")));
    if (photos.checker.bits == 8)
        light.warnings.push_back(named_warning(
            "coarse-samples",
            fmt::format("{}: 8 bits per sample are coarse for dark slabs, and pictures of this kind were developed for "
                        "the eye; use the camera's RAW files or linear 16-bit TIFF.",
                        checker)));
    if (!photos.paper) {
        light.warnings.push_back(named_warning(
            "uneven-light",
            fmt::format("No photograph of white paper: whether the light is even within 1 % over the {:g} mm about the "
                        "edge is not "
                        "known, only its slow change, from the sheet's white squares. Add a line that shows \"paper\".",
                        options.width_mm)));
        return;
    }
    const std::string& paper = photos.paper->name;
    if (light.model.frame_residual() > rough_paper)
        throw InputError(
            fmt::format("{}: the light on the white paper varies by {:.1f} % in a way that is not smooth: a shadow, "
                        "dirt, or paper that does not fill the picture",
                        paper, 100 * light.model.frame_residual()));
    const LightMap map = light_map(*photos.paper, board, options.width_mm);
    light.unevenness = deviation(map, board, options.width_mm, [](const Vector2d&) { return 1.0; });
    light.left_over =
        deviation(map, board, options.width_mm, [&](const Vector2d& px) { return light.model.light(px); });
    if (*light.unevenness > uneven_refused)
        throw InputError(
            fmt::format("{}: the light varies by {:.1f} % over the {:g} mm about the edge; move the lamps until it is "
                        "within 1 %",
                        paper, 100 * *light.unevenness, options.width_mm));
    if (*light.unevenness > uneven_said)
        light.warnings.push_back(named_warning(
            "uneven-light",
            fmt::format("{}: the light varies by {:.1f} % over the {:g} mm about the edge; it was corrected (to {:.2f} "
                        "%), but within 1 % is better.",
                        paper, 100 * *light.unevenness, options.width_mm, 100 * light.left_over)));
}

}  // namespace

LightMap light_map(const io::Photograph& paper, const BoardView& board, double width_mm) {
    const cv::Mat whole(int(paper.height_px), int(paper.width_px), CV_32FC3,
                        const_cast<Eigen::Vector3f*>(paper.pixels.data()));
    LightMap map;
    constexpr double per_mm = 5;
    map.scale = std::min(1.0, per_mm / board.px_per_mm);
    cv::Mat small, grey;
    cv::resize(whole, small, {}, map.scale, map.scale, cv::INTER_AREA);
    cv::transform(small, grey, cv::Matx13f(1, 1, 1));
    cv::GaussianBlur(grey, grey, {}, board.px_per_mm * map.scale);
    map.width = grey.cols;
    map.height = grey.rows;
    double sum = 0, count = 0;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x) {
            map.relative.push_back(grey.at<float>(y, x));
            const Vector2d mm = board.place.from_px(Vector2d(x + 0.5, y + 0.5) / map.scale);
            if (mm.cwiseAbs().maxCoeff() <= width_mm / 2) sum += double(map.relative.back()), ++count;
        }
    for (float& v : map.relative) v = float(v * count / std::max(sum, 1e-12));
    return map;
}

BenchLight measure_bench_light(BenchLightPhotos& photos, const CheckerChart& chart, const BenchLightOptions& options,
                               BoardView& board, double square_mm) {
    check_sizes(photos);
    const auto all = [&](auto&& change) {
        change(photos.checker);
        change(photos.sheet);
        if (photos.paper) change(*photos.paper);
    };
    if (options.coding != io::SampleCoding::unknown) all([&](io::Photograph& p) { p.coding = options.coding; });
    const bool unknown = photos.checker.coding == io::SampleCoding::unknown;
    const auto as = [&](io::SampleCoding coding, const BenchLightPhotos& from) {
        BenchLightPhotos copy = from;
        for (io::Photograph* p : {&copy.checker, &copy.sheet, copy.paper ? &*copy.paper : nullptr})
            if (p) p->coding = coding, make_linear(*p);
        const BoardView view = find_board(copy.sheet, square_mm);
        BenchLight light = measure_linear_light(copy, chart, options, view, square_mm);
        light.coding = coding;
        light.guessed = unknown;
        photos = std::move(copy);
        board = view;
        return light;
    };
    BenchLight light;
    if (!unknown) {
        light = as(photos.checker.coding, photos);
    } else {
        // The file does not say; the checker does: its greys are 28 to 1 apart in light and 5 to 1 in codes.
        const BenchLightPhotos given = photos;
        std::optional<BenchLight> linear;
        std::optional<InputError> trouble;
        try {
            linear = as(io::SampleCoding::linear, given);
        } catch (const InputError& error) {
            trouble = error;
        }
        constexpr double good = 0.015;  // no need to try the other way
        if (linear && linear->model.chart_residual() < good) {
            light = std::move(*linear);
        } else {
            std::optional<BenchLight> coded;
            try {
                coded = as(io::SampleCoding::srgb, given);
            } catch (const InputError&) {
                if (!linear) throw *trouble;
            }
            const bool is_linear =
                linear && (!coded || linear->model.chart_residual() <= coded->model.chart_residual());
            light = is_linear ? as(io::SampleCoding::linear, given) : std::move(*coded);
        }
    }
    judge(light, photos, options, board);
    return light;
}

}  // namespace voxtone::calibration
