// SPDX-License-Identifier: GPL-3.0-or-later
//
// What stands between reflectance and the samples of a photograph, found in one fit:
//
//   sample(u) = L(u) M rho,      log L = a smooth polynomial of the place u in the picture
//
// L: uneven light and vignetting, the same in all channels: a full cubic and the fourth and sixth powers of the
// distance from the middle. M: 3 x 3, from linear sRGB to the camera's channels (white balance and exposure included).
// Known are the colours of the chart's patches; of the light frame it is only known that it has one colour everywhere,
// whichever. So the frame tells L over the target, the chart tells M and L over itself, and L being smooth ties the two
// together.
//
// Least squares (Ceres); relative errors of frame and chart are estimated from the residuals, weak priors keep what the
// samples do not tell small. Standard errors of reflectances follow from the fit's covariance.
// Cannot see: glare and stray light, light whose colour varies over the scene, edges of shadows.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

/// A sample at a place in the picture.
struct LitSample {
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< linear sRGB of a chart's patch; not used for the frame
};

class PhotoModel {
public:
    static constexpr int light_terms = 11, parameters = 9 + 3 + light_terms;

    /// Throws InputError (beginning with `name`) where there are too few samples or the fit fails.
    [[nodiscard]] static PhotoModel fit(std::span<const LitSample> chart, std::span<const LitSample> frame,
                                        double width_px, double height_px, const std::string& name);

    /// Light at a place, relative to the middle of the picture.
    [[nodiscard]] double light(const Eigen::Vector2d& px) const;
    [[nodiscard]] Eigen::Vector3d reflectance(const Eigen::Vector2d& px, const Eigen::Vector3d& value) const;
    /// Standard error of `reflectance` for a sample without noise of its own.
    [[nodiscard]] Eigen::Vector3d error(const Eigen::Vector2d& px, const Eigen::Vector3d& value) const;
    /// How noise of samples becomes noise of reflectances.
    [[nodiscard]] Eigen::Vector3d noise(const Eigen::Vector2d& px, const Eigen::Vector3d& value_error) const;

    /// Relative root mean square of the frame's samples, and root mean square of the chart's patches in linear sRGB.
    [[nodiscard]] double frame_residual() const { return frame_residual_; }
    [[nodiscard]] double chart_residual() const { return chart_residual_; }
    [[nodiscard]] Eigen::Matrix3d to_linear_srgb() const;
    /// Reflectance of the frame.
    [[nodiscard]] Eigen::Vector3d frame_reflectance() const;

private:
    using Parameters = Eigen::Matrix<double, parameters, 1>;
    [[nodiscard]] static Eigen::Vector3d reflectance_with(const Parameters& theta,
                                                          const Eigen::Matrix<double, light_terms, 1>& basis,
                                                          const Eigen::Vector3d& value);
    [[nodiscard]] Eigen::Matrix<double, light_terms, 1> basis(const Eigen::Vector2d& px) const;

    double width_px_ = 1, height_px_ = 1;
    Parameters theta_ = Parameters::Zero();  // M row by row, the frame's samples in the middle of the picture, light
    Eigen::Matrix<double, parameters, parameters> covariance_ = Eigen::Matrix<double, parameters, parameters>::Zero();
    double frame_residual_ = 0, chart_residual_ = 0;
};

}  // namespace voxtone::calibration
