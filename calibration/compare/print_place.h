// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where each cell of a print lies in its photograph: a homography through the corners, and on it a shift of every place
// by cubic polynomials along x and y, which take up what corners are off by and a lens that distorts:
//
//   px = H(p + d(p)),    d: ten terms u^i v^j, i + j <= 3, along each axis, u and v in [-1, 1] across the print
//
// Found by correlation with the prediction: which of the eight ways the print lies (turned, mirrored) on a coarse grid,
// then Gauss-Newton from coarse to fine on the logarithms of red, green and blue less their surroundings, so that
// light, exposure and white balance do not count. Cells that stay off weigh little (Geman and McClure's weights).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/predicted_print.h"
#include "calibration/compare/print_finder.h"
#include "calibration/photo/rectify.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

class PrintPlace {
public:
    static constexpr int terms = 10;
    using Shift = Eigen::Matrix<double, terms, 2>;

    PrintPlace() = default;
    PrintPlace(const Rectification& flat, const Eigen::Vector2d& size) : flat_(flat), size_(size) {}

    /// Cells, from the upper left corner.
    [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& cell) const {
        return flat_.to_px(cell + shift_.transpose() * basis(cell));
    }
    [[nodiscard]] double px_per_cell() const { return flat_.px_per_unit(size_ / 2); }
    [[nodiscard]] const Eigen::Vector2d& size() const { return size_; }
    /// Powers up to 3, those of lower degree first.
    [[nodiscard]] Eigen::Matrix<double, terms, 1> basis(const Eigen::Vector2d& cell) const;
    void add(const Shift& shift) { shift_ += shift; }

private:
    Rectification flat_;
    Eigen::Vector2d size_ = Eigen::Vector2d::Ones();
    Shift shift_ = Shift::Zero();
};

struct FoundPrint {
    PrintPlace place;
    double correlation = 0;  ///< with the prediction, of what was registered by
    int turned_deg = 0;      ///< clockwise in the photograph: 0, 90, 180, 270
};

/// `may_be`: corners of what may be the print; what correlates best is. `photograph`: linear. Throws InputError:
/// another print, a mirrored one, other proportions, too few pixels.
[[nodiscard]] FoundPrint place_print(const io::Photograph& photograph, const std::vector<PrintCorners>& may_be,
                                     const PredictedPrint& print);

/// The photograph cell by cell: the mean over each cell's square.
struct CellSamples {
    std::vector<Eigen::Vector3f> value;
    std::vector<std::uint8_t> good;  ///< in the picture, and no sample clipped
};
/// `clip`: the level at which channels are clipped.
[[nodiscard]] CellSamples sample_cells(const io::Photograph& photograph, const PrintPlace& place, int columns, int rows,
                                       const Eigen::Vector3d& clip);

/// Of a photograph at a place between its pixels, linearly; the nearest pixel beyond the edge.
[[nodiscard]] Eigen::Vector3f sample_at(const io::Photograph& photograph, const Eigen::Vector2d& px);

}  // namespace voxtone::calibration
