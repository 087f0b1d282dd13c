// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/colour_checker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/mcc.hpp>

#include "base/error.h"
#include "calibration/photo/finder_picture.h"
#include "optics/numerics/dense.h"

namespace voxtone::calibration {

namespace {

using Corners = std::array<Eigen::Vector2d, 4>;

constexpr double patch_dark_share = 0.1;  // of a patch's pixels at 0: more, and it is left out
constexpr double worst_residual = 0.12;   // of white: beyond this the colours are not those of the chart

std::optional<Corners> detect(const io::Photograph& photo, const Corners& hidden) {
    std::vector<std::uint8_t> codes = finder_bgr(photo);
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_8UC3, codes.data());
    std::vector<cv::Point> polygon;
    for (const Eigen::Vector2d& p : hidden) polygon.emplace_back(int(p.x()), int(p.y()));
    cv::fillConvexPoly(whole, polygon, cv::Scalar(40, 40, 40));
    constexpr double finder_px = 1800;
    const double scale = std::min(1.0, finder_px / std::max(whole.cols, whole.rows));
    cv::Mat small = whole;
    if (scale < 1) cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    const auto detector = cv::mcc::CCheckerDetector::create();
    if (!detector->process(small, cv::mcc::MCC24, 1)) return std::nullopt;
    const auto found = detector->getBestColorChecker();
    if (!found) return std::nullopt;
    const std::vector<cv::Point2f> box = found->getBox();
    if (box.size() != 4) return std::nullopt;
    Corners corners;
    for (std::size_t c = 0; c < 4; ++c) corners[c] = Eigen::Vector2d(box[c].x + 0.5, box[c].y + 0.5) / scale;
    return corners;
}

/// Root mean square of reference - A sample over patches that are not clipped.
double residual_of_matrix(const CheckerChart& chart, const std::vector<AreaSample>& samples) {
    Eigen::MatrixXd from(samples.size(), 3), to(samples.size(), 3);
    Eigen::Index used = 0;
    for (std::size_t p = 0; p < samples.size(); ++p) {
        if (!samples[p].complete || samples[p].clipped.maxCoeff() > 0.005 ||
            samples[p].at_zero.maxCoeff() > patch_dark_share)
            continue;
        from.row(used) = samples[p].mean.transpose();
        to.row(used++) = chart.linear_srgb[p].transpose();
    }
    if (used < 8) return std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd A = optics::least_squares(Eigen::MatrixXd(from.topRows(used)), to.topRows(used));
    return std::sqrt((from.topRows(used) * A - to.topRows(used)).squaredNorm() / (3.0 * double(used)));
}

CheckerView view_with(const io::Photograph& photo, const CheckerChart& chart, const Eigen::Vector3d& clip,
                      const Corners& px) {
    const Corners own{Eigen::Vector2d(0, 0), Eigen::Vector2d(chart.columns, 0),
                      Eigen::Vector2d(chart.columns, chart.rows), Eigen::Vector2d(0, chart.rows)};
    CheckerView view;
    view.place = Rectification::fit(own, px);
    for (int row = 0; row < chart.rows; ++row)
        for (int column = 0; column < chart.columns; ++column)
            view.patches.push_back(sample_area(photo, view.place, checker_area(column, row), clip));
    view.residual = residual_of_matrix(chart, view.patches);
    return view;
}

}  // namespace

Area checker_area(int column, int row) {
    constexpr double share = 0.44;
    const Eigen::Vector2d middle(column + 0.5, row + 0.5);
    return {middle - Eigen::Vector2d::Constant(share / 2), middle + Eigen::Vector2d::Constant(share / 2)};
}

CheckerView find_checker_in(const io::Photograph& photo, const CheckerChart& chart, const Eigen::Vector3d& clip,
                            const Corners& hidden, const std::optional<Corners>& corners) {
    std::optional<Corners> px = corners;
    if (!px) px = detect(photo, hidden);
    if (!px)
        throw InputError(
            fmt::format("{}: no colour checker found. It must be in the picture as a whole, flat, "
                        "sharp and without glare; or give the corners "
                        "of its patches by hand with --checker-corners",
                        photo.name));
    CheckerView best;
    best.residual = std::numeric_limits<double>::infinity();
    bool mirrored = false;
    for (std::size_t turn = 0; turn < 4; ++turn)
        for (const bool backwards : {false, true}) {
            Corners order;
            for (std::size_t c = 0; c < 4; ++c) order[c] = (*px)[(backwards ? 4 + turn - c : c + turn) % 4];
            CheckerView view = view_with(photo, chart, clip, order);
            if (!(view.residual < best.residual)) continue;
            best = std::move(view);
            // The chart's y runs down like the picture's: its front has a positive change of area.
            mirrored = !best.place.seen_from_back({chart.columns / 2.0, chart.rows / 2.0});
        }
    if (!(best.residual < worst_residual))
        throw InputError(
            fmt::format("{}: what was taken for the colour checker has not its colours (they miss them by {:.3f} of "
                        "white on average, in the best of all orders). Wrong "
                        "corners, another chart, patches that clip, or samples that are not linear light (a tone "
                        "curve): develop the photograph linearly",
                        photo.name, best.residual));
    if (mirrored)
        throw InputError(fmt::format(
            "{}: the colour checker is mirrored, so the whole picture is; give it as it was taken", photo.name));
    return best;
}

std::vector<LitSample> usable_patches(const CheckerView& view, const CheckerChart& chart) {
    std::vector<LitSample> lit;
    for (std::size_t p = 0; p < view.patches.size(); ++p) {
        const AreaSample& sample = view.patches[p];
        if (sample.complete && sample.clipped.maxCoeff() <= clipped_share &&
            sample.at_zero.maxCoeff() <= patch_dark_share && sample.rejected <= dirty_share)
            lit.push_back({sample.middle_px, sample.mean, chart.linear_srgb[p]});
    }
    return lit;
}

}  // namespace voxtone::calibration
