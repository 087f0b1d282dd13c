// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/rectify.h"

#include <cmath>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "base/contracts.h"

namespace voxtone::calibration {

Rectification Rectification::fit(std::span<const Eigen::Vector2d> plane, std::span<const Eigen::Vector2d> px,
                                 double* residual_px) {
    VOXTONE_EXPECT(plane.size() == px.size() && plane.size() >= 4);
    std::vector<cv::Point2d> from, to;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        from.emplace_back(plane[i].x(), plane[i].y());
        to.emplace_back(px[i].x(), px[i].y());
    }
    const cv::Mat found = cv::findHomography(from, to, 0);
    Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
    if (found.rows == 3)
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) H(row, column) = found.at<double>(row, column);
    const Rectification result(H);
    if (residual_px) {
        double sum = 0;
        for (std::size_t i = 0; i < plane.size(); ++i) sum += (result.to_px(plane[i]) - px[i]).squaredNorm();
        *residual_px = found.rows == 3 ? std::sqrt(sum / double(plane.size())) : INFINITY;
    }
    return result;
}

double Rectification::area_change(const Eigen::Vector2d& p) const {
    constexpr double step = 1e-3;
    const Eigen::Vector2d x = (to_px(p + Eigen::Vector2d(step, 0)) - to_px(p)) / step,
                          y = (to_px(p + Eigen::Vector2d(0, step)) - to_px(p)) / step;
    return x.x() * y.y() - x.y() * y.x();
}

double Rectification::px_per_unit(const Eigen::Vector2d& p) const { return std::sqrt(std::abs(area_change(p))); }

bool Rectification::seen_from_back(const Eigen::Vector2d& p) const { return area_change(p) > 0; }

}  // namespace voxtone::calibration
