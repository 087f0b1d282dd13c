// SPDX-License-Identifier: GPL-3.0-or-later
//
// A predicted body before a pinhole camera: where its places lie in a picture, and which triangle each pixel sees.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/predicted_body.h"
#include "optics/camera/camera.h"

namespace voxtone::calibration {

/// Pixels: the middle of the first is at (0.5, 0.5), y down.
class BodyCamera {
public:
    BodyCamera() = default;
    explicit BodyCamera(const optics::CameraView& view);

    /// Right, down and ahead of the camera, mm.
    [[nodiscard]] Eigen::Vector3d before(const Eigen::Vector3d& p) const { return turn_ * (p - position_); }
    [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector3d& before) const {
        return middle_px_ + focal_px_ * before.head<2>() / before.z();
    }
    /// Of a window of the picture, from `corner_px`, in pixels of which `scale` are one of this picture's.
    [[nodiscard]] BodyCamera window(const Eigen::Vector2d& corner_px, double scale) const;

    static constexpr int numbers = 7;
    using Step = Eigen::Matrix<double, numbers, 1>;
    /// The body turned about `pivot` by a vector in radians and shifted in mm, both as the camera sees them, and ln of
    /// the focal length.
    void move(const Step& step, const Eigen::Vector3d& pivot);
    /// How far a place moves in the picture by a step.
    [[nodiscard]] Eigen::Matrix<double, 2, numbers> by_step(const Eigen::Vector3d& before,
                                                            const Eigen::Vector3d& pivot) const;

    [[nodiscard]] Eigen::Vector3d up() const { return -turn_.row(1); }
    [[nodiscard]] Eigen::Vector3d ahead() const { return turn_.row(2); }
    [[nodiscard]] const Eigen::Vector3d& position() const { return position_; }
    [[nodiscard]] double focal_px() const { return focal_px_; }
    [[nodiscard]] double px_per_mm(const Eigen::Vector3d& p) const { return focal_px_ / before(p).z(); }

private:
    Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();  ///< rows: right, down, ahead
    Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
    double focal_px_ = 1;
    Eigen::Vector2d middle_px_ = Eigen::Vector2d::Zero();
};

struct BodyPicture {
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    int columns = 0, rows = 0;
    std::vector<std::uint32_t> triangle;  ///< seen by each pixel's middle; none: nothing
    std::vector<Eigen::Vector3f> weight;  ///< of its corners
    std::vector<float> depth;             ///< mm ahead

    [[nodiscard]] std::size_t index(int x, int y) const {
        return std::size_t(y) * std::size_t(columns) + std::size_t(x);
    }
    [[nodiscard]] bool sees(std::size_t pixel) const { return triangle[pixel] != none; }
    /// Between the values of a triangle's corners.
    [[nodiscard]] Eigen::Vector3f of(const PredictedBody& body, const std::vector<Eigen::Vector3f>& values,
                                     std::size_t pixel) const {
        const auto& corner = body.triangles[triangle[pixel]];
        return weight[pixel][0] * values[corner[0]] + weight[pixel][1] * values[corner[1]] +
               weight[pixel][2] * values[corner[2]];
    }
};

/// By a depth buffer; triangles that look away are left out. The same bits for any number of threads.
[[nodiscard]] BodyPicture picture_of(const PredictedBody& body, const BodyCamera& camera, int columns, int rows);

}  // namespace voxtone::calibration
