// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums over the samples of a picture, and how many more each part of it wants.
//
// A picture is drawn in tiles. A sample counts in its own pixel and those around it as the filter says; what a tile
// gives to pixels of its neighbours it keeps until the end, so that tiles are drawn side by side. A tile's pixels all
// have as many samples.
//
// Errors: four samples of a pixel make a bundle, in which every channel was sent at least once. Bundles are alike and
// independent: the spread of their means is the error of a channel, of the luminance and of linear sRGB, whatever is
// common to channels. Through the filter the errors of pixels add up, and what the filter's own weights scatter where
// neighbours are unlike.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "optics/camera/camera_picture.h"
#include "optics/camera/lit_scene.h"
#include "optics/camera/pixel_filter.h"
#include "optics/camera/tile_paths.h"

namespace voxtone::optics {

class Exposure {
public:
    Exposure(const LitScene& scene, const CameraOptions& options, CameraPicture& picture);

    /// Until every tile has what it wants: first what is sure, then by what the spread so far says.
    void draw(Progress& progress);
    /// Whether every pixel has something.
    [[nodiscard]] bool shows_all() const;
    /// Fills in the picture.
    void finish();

private:
    /// What a tile's samples give to its pixels and a margin of one around them.
    struct Tile {
        std::uint32_t drawn = 0, wanted = 0;
        std::vector<double> light, share;  ///< per pixel with margin, and channel
    };
    static constexpr int margin_px = 1, edge_px = CameraPicture::tile_px, with_margin = edge_px + 2 * margin_px;

    [[nodiscard]] std::uint64_t steps_left() const;
    [[nodiscard]] std::string what_is_wanted() const;
    void raise(std::size_t tile, std::uint32_t level, Progress& progress);
    void add(std::size_t tile, std::uint32_t count);
    void add_to_bundles(const TilePaths& paths, std::size_t first, std::uint32_t count, std::size_t pixel);
    void gather(const TilePaths& paths, std::size_t sample, int x, int y, Tile& tile) const;
    void plan();
    [[nodiscard]] double filtered_variance(int x, int y, std::size_t quantity) const;
    [[nodiscard]] double variance_of_mean(std::size_t pixel, std::size_t quantity) const;
    [[nodiscard]] double mean(std::size_t pixel, std::size_t quantity) const;
    void finish_pixel(int x, int y, std::size_t pixel);
    template <class Visit>
    void each_pixel(std::size_t tile, Visit&& visit) const;

    const LitScene& scene_;
    const CameraOptions& options_;
    CameraPicture& picture_;
    PixelFilter filter_;
    std::vector<std::uint32_t> periods_;
    // Of a pixel the bundles tell of: its channels; of sets of wavelengths linear sRGB besides; luminance.
    std::size_t channels_, quantities_;
    int across_ = 0;
    std::vector<double> sum_, squares_;  ///< per pixel and quantity, over bundles
    std::vector<Tile> tiles_;
};

}  // namespace voxtone::optics
