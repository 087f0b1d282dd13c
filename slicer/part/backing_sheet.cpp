// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/backing_sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <Eigen/LU>

#include "base/error.h"
#include "io/pictures/picture.h"

namespace voxtone::slicer {
namespace {

void add_cell(const std::array<double, 3>& linear_rgb, const optics::Channels& channels, optics::Sheet& to) {
    for (const double r : reflectance_of(linear_rgb, channels)) to.reflectance.push_back(static_cast<float>(r));
}

/// Squares from the corner on; the first is black.
void lay_checker(double edge_mm, const std::array<double, 2>& size_mm, const optics::Channels& channels,
                 optics::Sheet& to) {
    for (std::size_t a = 0; a < 2; ++a) {
        to.cell_mm[a] = edge_mm;
        to.cells[a] = std::max(1, static_cast<int>(std::ceil(size_mm[a] / edge_mm)));
    }
    for (int y = 0; y < to.cells[1]; ++y)
        for (int x = 0; x < to.cells[0]; ++x) {
            const double white = (x + y) % 2;
            add_cell({white, white, white}, channels, to);
        }
}

/// As large as the slab, in cells of about 0.1 mm: no slab shows more of what lies behind it.
void lay_picture(const std::string& file, const std::array<double, 2>& size_mm, const optics::Channels& channels,
                 optics::Sheet& to) {
    constexpr double cell_mm = 0.1, most_off = 0.02;
    const io::Picture picture = io::read_picture(file);
    const double shape = picture.width_px / (picture.height_px * picture.pixel_aspect), slab = size_mm[0] / size_mm[1];
    if (std::abs(shape / slab - 1) > most_off)
        throw InputError(
            fmt::format("--backing {}: {} x {} px are {:.3f} times as wide as high, but the slab is {:.3f} times: cut "
                        "the picture to the slab's shape",
                        file, picture.width_px, picture.height_px, shape, slab));
    for (std::size_t a = 0; a < 2; ++a) {
        to.cells[a] = std::max(1, static_cast<int>(std::ceil(size_mm[a] / cell_mm)));
        to.cell_mm[a] = size_mm[a] / to.cells[a];
    }
    const float lod = std::log2(static_cast<float>(picture.width_px) / static_cast<float>(to.cells[0]));
    for (int y = 0; y < to.cells[1]; ++y)
        for (int x = 0; x < to.cells[0]; ++x) {
            const Eigen::Vector3f rgb =
                picture.texture->sample((static_cast<float>(x) + 0.5f) / static_cast<float>(to.cells[0]),
                                        (static_cast<float>(y) + 0.5f) / static_cast<float>(to.cells[1]), lod);
            add_cell({double(rgb.x()), double(rgb.y()), double(rgb.z())}, channels, to);
        }
}

}  // namespace

std::vector<double> reflectance_of(const std::array<double, 3>& linear_rgb, const optics::Channels& channels) {
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(channels);
    const Eigen::Vector3d wanted(linear_rgb[0], linear_rgb[1], linear_rgb[2]);
    // Of all that look so, the least departure from the grey of their mean; white is (1, 1, 1) of ones.
    const Eigen::VectorXd grey = Eigen::VectorXd::Constant(weights.cols(), wanted.mean());
    const Eigen::Matrix3d square = weights * weights.transpose();
    const Eigen::VectorXd found = grey + weights.transpose() * square.fullPivLu().solve(wanted - weights * grey);
    std::vector<double> reflectance;
    for (const double r : found) reflectance.push_back(std::clamp(r, 0.0, 1.0));
    return reflectance;
}

std::shared_ptr<const optics::Sheet> sheet_under(const BackingChoice& backing, const std::array<double, 2>& size_mm,
                                                 const optics::Channels& channels) {
    if (backing.kind != optics::Backing::sheet) return nullptr;
    auto sheet = std::make_shared<optics::Sheet>();
    sheet->channels = channels.size();
    if (!backing.picture.empty())
        lay_picture(backing.picture, size_mm, channels, *sheet);
    else if (backing.checker_mm > 0)
        lay_checker(backing.checker_mm, size_mm, channels, *sheet);
    else
        add_cell(backing.linear_rgb, channels, *sheet);
    return sheet;
}

}  // namespace voxtone::slicer
