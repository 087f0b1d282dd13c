// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/body_picture.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace voxtone::calibration {

namespace {

Eigen::Vector3d vector_of(const optics::Point& p) { return {p[0], p[1], p[2]}; }

/// A corner in the picture, and one over how far ahead it lies, which is linear there.
struct Corner {
    Eigen::Vector2f px;
    float inverse_depth;
};

float twice_area(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace

Eigen::Vector3d PredictedBody::middle() const {
    Eigen::Vector3f low = position.front(), high = low;
    for (const Eigen::Vector3f& p : position) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return (0.5f * (low + high)).cast<double>();
}

BodyCamera::BodyCamera(const optics::CameraView& view)
    : position_(vector_of(view.position)),
      focal_px_(view.focal_mm / optics::film_width_mm * view.width_px),
      middle_px_(0.5 * view.width_px, 0.5 * view.height_px) {
    const Eigen::Vector3d ahead = (vector_of(view.target) - position_).normalized(),
                          right = ahead.cross(vector_of(view.up)).normalized();
    turn_.row(0) = right, turn_.row(1) = ahead.cross(right), turn_.row(2) = ahead;
}

BodyCamera BodyCamera::window(const Eigen::Vector2d& corner_px, double scale) const {
    BodyCamera camera = *this;
    camera.focal_px_ *= scale;
    camera.middle_px_ = (middle_px_ - corner_px) * scale;
    return camera;
}

void BodyCamera::move(const Step& step, const Eigen::Vector3d& pivot) {
    const Eigen::Vector3d turned = step.head<3>(), shifted = step.segment<3>(3);
    const double angle = turned.norm();
    Eigen::Matrix3d by = Eigen::Matrix3d::Identity();
    if (angle > 0) by = Eigen::AngleAxisd(angle, turned / angle).toRotationMatrix();
    const Eigen::Vector3d pivot_before = before(pivot) + shifted;
    turn_ = by * turn_;
    position_ = pivot - turn_.transpose() * pivot_before;
    focal_px_ *= std::exp(step[6]);
}

Eigen::Matrix<double, 2, BodyCamera::numbers> BodyCamera::by_step(const Eigen::Vector3d& p,
                                                                  const Eigen::Vector3d& pivot) const {
    Eigen::Matrix<double, 2, 3> by_place;
    by_place << 1, 0, -p.x() / p.z(), 0, 1, -p.y() / p.z();
    by_place *= focal_px_ / p.z();
    const Eigen::Vector3d arm = p - before(pivot);
    Eigen::Matrix3d by_turn;  // d (w x arm) / d w
    by_turn << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    Eigen::Matrix<double, 2, numbers> by;
    by << by_place * by_turn, by_place, focal_px_ * p.head<2>() / p.z();
    return by;
}

BodyPicture picture_of(const PredictedBody& body, const BodyCamera& camera, int columns, int rows) {
    std::vector<Corner> corners(body.position.size());
    parallel_for(0, corners.size(), 4096, [&](std::size_t i) {
        const Eigen::Vector3d p = camera.before(body.position[i].cast<double>());
        corners[i] = {camera.to_px(p).cast<float>(), p.z() > 0 ? float(1 / p.z()) : 0.0f};
    });
    BodyPicture picture;
    picture.columns = columns, picture.rows = rows;
    const std::size_t pixels = std::size_t(columns) * std::size_t(rows);
    picture.triangle.assign(pixels, BodyPicture::none);
    picture.weight.resize(pixels);
    picture.depth.assign(pixels, 0.0f);
    std::vector<float> nearest(pixels, 0.0f);
    constexpr std::size_t band = 32;  // rows
    parallel_for(0, (std::size_t(rows) + band - 1) / band, 1, [&](std::size_t b) {
        const int first = int(b * band), last = std::min(rows, int((b + 1) * band));
        for (std::size_t t = 0; t < body.triangles.size(); ++t) {
            const auto& [i, j, k] = body.triangles[t];
            const Corner &p = corners[i], &q = corners[j], &r = corners[k];
            if (!(p.inverse_depth > 0 && q.inverse_depth > 0 && r.inverse_depth > 0)) continue;
            // Counter-clockwise from outside, with y down.
            const float area = -twice_area(p.px, q.px, r.px);
            if (!(area > 0)) continue;
            const Eigen::Vector2f low = p.px.cwiseMin(q.px).cwiseMin(r.px), high = p.px.cwiseMax(q.px).cwiseMax(r.px);
            const int y0 = std::max(first, int(std::ceil(low.y() - 0.5f))),
                      y1 = std::min(last - 1, int(std::floor(high.y() - 0.5f)));
            const int x0 = std::max(0, int(std::ceil(low.x() - 0.5f))),
                      x1 = std::min(columns - 1, int(std::floor(high.x() - 0.5f)));
            for (int y = y0; y <= y1; ++y)
                for (int x = x0; x <= x1; ++x) {
                    const Eigen::Vector2f at(float(x) + 0.5f, float(y) + 0.5f);
                    Eigen::Vector3f weight(-twice_area(at, q.px, r.px), -twice_area(p.px, at, r.px),
                                           -twice_area(p.px, q.px, at));
                    if (!(weight.minCoeff() >= 0)) continue;
                    weight =
                        weight.cwiseProduct(Eigen::Vector3f(p.inverse_depth, q.inverse_depth, r.inverse_depth)) / area;
                    const float inverse_depth = weight.sum();
                    const std::size_t pixel = picture.index(x, y);
                    if (!(inverse_depth > nearest[pixel])) continue;
                    nearest[pixel] = inverse_depth;
                    picture.triangle[pixel] = std::uint32_t(t);
                    picture.weight[pixel] = weight / inverse_depth;
                    picture.depth[pixel] = 1 / inverse_depth;
                }
        }
    });
    return picture;
}

}  // namespace voxtone::calibration
