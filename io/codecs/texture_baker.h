// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers of pictures and colours over a triangle, made into one picture: where a file lays several textures over each
// other (3MF multiproperties), each with coordinates of its own, no single one can be kept. Each triangle gets a patch
// of an atlas, as fine as the finest of its pictures, with two texels around it for the filter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/decoded_image.h"
#include "io/pictures/texture.h"

namespace voxtone::io {

/// A colour over what lies below, both linear with alpha: by its alpha, or as a factor.
[[nodiscard]] Eigen::Vector4f lay_over(const Eigen::Vector4f& below, const Eigen::Vector4f& layer, bool multiply);

/// Over one triangle, by its corners.
struct BakedLayer {
    std::int32_t image = -1;  ///< index; -1: a colour
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    std::array<Eigen::Vector2f, 3> uv = {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(),
                                         Eigen::Vector2f::Zero()};  ///< of a picture
    std::array<Eigen::Vector4f, 3> rgba = {Eigen::Vector4f::Zero(), Eigen::Vector4f::Zero(),
                                           Eigen::Vector4f::Zero()};  ///< of a colour, linear
    bool multiply = false;
};

class TextureBaker {
public:
    struct Patch {
        std::size_t page = 0;
        std::array<Eigen::Vector2f, 3> uv;  ///< of the triangle's corners, in texels from the page's top left
    };

    /// Bakes layers, the lowest first, over white. Nothing where the atlas would have more than `max_texels`.
    [[nodiscard]] std::optional<Patch> bake(std::span<const BakedLayer> layers, std::span<const DecodedImage> images);

    /// Opaque pages; their heights are known now, so that texels can be made coordinates by `uv_of`.
    [[nodiscard]] std::vector<DecodedImage> take_pages();
    [[nodiscard]] std::size_t pages() const { return pages_.size(); }
    [[nodiscard]] std::array<Eigen::Vector2f, 3> uv_of(const Patch& patch) const;

private:
    /// Where patches of one size go next.
    struct Row {
        std::size_t page = 0;
        std::uint32_t x = page_width, y = 0;
    };
    static constexpr std::uint32_t page_width = 4096, page_height = 4096;
    static constexpr std::size_t max_texels = std::size_t{1} << 26;

    [[nodiscard]] bool make_room(std::uint32_t size, Row& row);

    std::vector<TexelImage> pages_;
    std::vector<Row> rows_;  ///< by size / size_step
    std::size_t texels_ = 0;
};

}  // namespace voxtone::io
