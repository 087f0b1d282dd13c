// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/layer_thumbnail.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/contracts.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

/// Adds a stretch [low, high) of the line, in pixels of the picture, to the pixels that it covers: add(pixel, share).
template <class Add>
void cover(double low, double high, std::uint32_t pixels, Add add) {
    const auto first = std::min(static_cast<std::uint32_t>(low), pixels - 1);
    for (std::uint32_t p = first; p < pixels && p < high; ++p) {
        const double share = std::min<double>(high, p + 1) - std::max<double>(low, p);
        if (share > 0) add(p, static_cast<float>(share));
    }
}

/// Linear colour of each material and 1 for "printed"; nothing for the background.
std::vector<Eigen::Vector4f> printed_colours(std::span<const Rgb> palette) {
    std::vector<Eigen::Vector4f> colours{Eigen::Vector4f::Zero()};
    const auto& linear = srgb8_to_linear();
    for (const Rgb& rgb : palette.subspan(1))
        colours.emplace_back(linear[rgb[0]], linear[rgb[1]], linear[rgb[2]], 1.0f);
    return colours;
}

}  // namespace

LinearPicture layer_thumbnail(const LayerRuns& layer, std::span<const Rgb> palette,
                              const std::array<double, 2>& pitch_mm, std::uint32_t longest_px) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px() && !palette.empty() && longest_px >= 1);
    VOXTONE_EXPECT(pitch_mm[0] > 0 && pitch_mm[1] > 0);
    const double width_mm = layer.width_px() * pitch_mm[0], height_mm = layer.height_px() * pitch_mm[1];
    const double side_mm = std::max(width_mm, height_mm) / longest_px;
    const double columns = pitch_mm[0] / side_mm, rows = pitch_mm[1] / side_mm;  // per pixel of the layer
    // A hair less, so that rounding adds no empty row to what fits exactly.
    const auto pixels = [&](double mm) {
        return std::max(1u, static_cast<std::uint32_t>(std::ceil(mm / side_mm - 1e-9)));
    };
    LinearPicture picture{pixels(width_mm), pixels(height_mm), {}};
    picture.pixels.assign(std::size_t{picture.width_px} * picture.height_px, Eigen::Vector4f::Zero());

    const std::vector<Eigen::Vector4f> colours = printed_colours(palette);
    std::vector<Eigen::Vector4f> line(picture.width_px);
    for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
        std::fill(line.begin(), line.end(), Eigen::Vector4f::Zero());
        std::uint32_t x = 0;
        for (const Run& run : layer.row(y)) {
            VOXTONE_EXPECT(run.material < colours.size());
            if (run.material != background)
                cover(x * columns, (x + run.length) * columns, picture.width_px,
                      [&](std::uint32_t p, float share) { line[p] += share * colours[run.material]; });
            x += run.length;
        }
        cover(y * rows, (y + 1) * rows, picture.height_px, [&](std::uint32_t p, float share) {
            Eigen::Vector4f* to = &picture.pixels[std::size_t{p} * picture.width_px];
            for (std::uint32_t i = 0; i < picture.width_px; ++i) to[i] += share * line[i];
        });
    }
    for (Eigen::Vector4f& pixel : picture.pixels)
        if (const float covered = pixel[3]; covered > 0) {
            pixel /= covered;
            pixel[3] = std::min(1.0f, covered);
        }
    return picture;
}

}  // namespace voxtone::io
