// SPDX-License-Identifier: GPL-3.0-or-later
//
// The 10 x 10 mm about the edge, cut out of a photograph: straightened by bicubic interpolation (R. Keys, Cubic
// convolution interpolation for digital image processing, IEEE ASSP 29, 1981; a = -1/2), as reflectance, and averaged
// along the edge.
//
// Parts that differ from what lies above and below them on the same side of the edge (scratches, bubbles, dust) are
// left out: blocks of 0.25 mm whose mean is off by six robust deviations. The error of a sample is the standard error
// of the mean over ten pieces along the edge, its root mean square over nine neighbours. Cannot see: a scratch along
// the edge; the second photograph of the slab, shifted, does.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "calibration/bench/board_view.h"
#include "calibration/photo/light_field.h"

namespace voxtone::calibration {

struct StripOptions {
    Eigen::Vector2d middle_mm = Eigen::Vector2d::Zero();  ///< on the sheet
    double width_mm = 10, length_mm = 10;                 ///< across and along the edge
};

struct EdgeStrip {
    std::vector<double> x_mm;                      ///< of the columns, even steps of a pixel, symmetric about 0
    std::vector<double> y_mm;                      ///< of the rows
    std::vector<Eigen::Vector3d> rho;              ///< row by row
    std::vector<bool> left_out;                    ///< of each of them
    std::vector<Eigen::Vector3d> mean, error;      ///< of the columns
    double left_out_share = 0, left_out_most = 0;  ///< of all; of the column that has lost most
    double roughness = 0;  ///< how much blocks differ along the edge beyond noise: robust deviation of reflectance
};

/// Where each channel of the photograph clips, and how light becomes reflectance.
struct PhotoScale {
    const PhotoModel* model = nullptr;
    Eigen::Vector3d clip = Eigen::Vector3d::Ones();
};

/// Throws InputError that names the photograph: cut off by the picture's edge, or clipped.
[[nodiscard]] EdgeStrip cut_strip(const io::Photograph& photograph, const BoardView& board, const PhotoScale& scale,
                                  const StripOptions& options = {});

/// Mean of the columns whose |x| lies within the range, on the white side (positive) or the black one.
[[nodiscard]] Eigen::Vector3d side_mean(const EdgeStrip& strip, double from_mm, double to_mm);

/// A bare edge between two levels: how far it is from x = 0, and the standard deviation of its blur, least squares
/// over all channels together.
struct EdgeBlur {
    double blur_mm = 0, offset_mm = 0, contrast = 0;  ///< contrast: white - black, mean of the channels
};
[[nodiscard]] EdgeBlur fit_bare_edge(const EdgeStrip& strip);

/// Where the edge is seen in the strip, against where the board says: the centroid of the gradient within 2 mm, of the
/// channel with the largest step, in ten pieces along the edge, and a line through them. A scatter that is the same to
/// both sides does not move it; light that goes to and fro between slab and sheet does, by less than 0.1 mm.
struct SeenEdge {
    double step = 0;  ///< of the channel: white - black side
    double offset_mm = 0, turn_deg = 0, turn_error_deg = 0;
};
[[nodiscard]] SeenEdge seen_edge(const EdgeStrip& strip);

}  // namespace voxtone::calibration
