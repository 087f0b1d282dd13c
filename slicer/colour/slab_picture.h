// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture of a slab as it was given, where it has more pixels than the slab has cells, beside its print. In a print
// that is so small that letters or a code are a smear, the target is one, too: what was asked for is known from the
// picture alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "io/models/mesh.h"
#include "io/pictures/codes_in_picture.h"
#include "slicer/colour/job_prediction.h"

namespace voxtone::slicer {

/// Which cell lies at each place of the slab's upper side, rows from the top; -1: none.
class SlabCells {
public:
    using Frame = std::array<int, 4>;  ///< left, top, right, bottom, cells; the last ones are not in it

    explicit SlabCells(const optics::Surface& surface);
    [[nodiscard]] Frame all() const { return {0, 0, columns_, rows_}; }
    [[nodiscard]] std::int64_t at(int column, int row) const {
        return at_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
    }
    /// Where a cell's middle lies: x from the left, y from the lower edge, in [0, 1].
    [[nodiscard]] Eigen::Vector2d place(const optics::SurfaceCell& cell) const {
        return {(cell.cell[0] - first_[0] + 0.5) / columns_, (cell.cell[1] - first_[1] + 0.5) / rows_};
    }
    [[nodiscard]] std::int64_t at(const Eigen::Vector2d& place) const {
        return at(std::clamp(int(place.x() * columns_), 0, columns_ - 1),
                  std::clamp(int((1 - place.y()) * rows_), 0, rows_ - 1));
    }
    /// Linear in between; x, y of the upper side, from its lower left corner, in [0, 1].
    [[nodiscard]] Eigen::Vector3f colour_at(std::span<const Eigen::Vector3f> rgb, double x, double y) const;
    [[nodiscard]] io::LuminanceRaster raster(std::span<const Eigen::Vector3f> rgb, const Frame& box) const;

private:
    int columns_ = 0, rows_ = 0;
    std::array<int, 2> first_{};
    std::vector<std::int64_t> at_;
};

/// Linear sRGB in [0, 1] to a grey level of sRGB.
[[nodiscard]] std::uint8_t grey_of(const Eigen::Vector3f& rgb);

/// The picture of a slab that covers it upright, u along x and v along y; nullptr where none does.
[[nodiscard]] const io::Texture* upright_picture(const io::TexturedMesh* mesh);

/// Pixel by pixel, as a page whose cells are as large as the print's: `target` is the picture, `predicted.rgb` the
/// print there, `seen.regions` what is flat. `times`: by how much it is larger than the print.
struct PicturePage {
    JobPrediction page;
    double times = 1;
};
/// The same picture by a million pixels at the most, by half of them, and so on down to two thousand, the finest first:
/// letters of any size are in one of them as high as type_rows.h can tell. Empty where the print's cells are as fine as
/// the picture, and of photographs: less than three tenths are flat.
[[nodiscard]] std::vector<PicturePage> picture_pages(const JobPrediction& print, const io::TexturedMesh* picture);

/// Whether three tenths of a surface are flat: graphics and no photograph.
[[nodiscard]] bool is_graphics(const JobPrediction& print);

}  // namespace voxtone::slicer
