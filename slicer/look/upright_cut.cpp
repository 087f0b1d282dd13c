// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/upright_cut.h"

#include <algorithm>

#include "base/contracts.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::slicer {

UprightCut::UprightCut(const VoxelGrid& grid, int first_layer, int last_layer, int j)
    : grid_(grid), first_(first_layer), last_(last_layer), row_(grid.size[1] - 1 - j) {  // rows run along -y
    VOXTONE_EXPECT(0 <= j && j < grid.size[1] && first_layer <= last_layer);
    material_.assign(std::size_t(last_ - first_ + 1) * std::size_t(grid.size[0]), io::background);
}

void UprightCut::add(int k, const io::LayerRuns& layer) {
    VOXTONE_EXPECT(first_ <= k && k <= last_);
    io::Material* at = material_.data() + std::size_t(k - first_) * std::size_t(grid_.size[0]);
    for (const io::Run run : layer.row(std::uint32_t(row_)))
        at = std::fill_n(at, run.length, io::Material(run.material));
}

io::ReportPicture UprightCut::picture(const std::vector<io::Rgb>& palette, std::string caption,
                                      double longest_px) const {
    const double pitch_x = grid_.pitch_mm.x(), pitch_z = grid_.pitch_mm.z();
    const int width = grid_.size[0], height = last_ - first_ + 1;
    const double px_per_mm = longest_px / std::max(width * pitch_x, height * pitch_z);
    io::Picture8 codes;
    codes.width_px = std::max(1u, std::uint32_t(width * pitch_x * px_per_mm));
    codes.height_px = std::max(1u, std::uint32_t(height * pitch_z * px_per_mm));
    codes.channels = 4;
    codes.codes.reserve(std::size_t{codes.width_px} * codes.height_px * 4);
    for (std::uint32_t row = 0; row < codes.height_px; ++row)
        for (std::uint32_t column = 0; column < codes.width_px; ++column) {
            const int i = std::min(width - 1, int((column + 0.5) / px_per_mm / pitch_x));
            const int k = std::max(0, height - 1 - int((row + 0.5) / px_per_mm / pitch_z));
            const io::Material material = material_[std::size_t(k) * std::size_t(width) + std::size_t(i)];
            const io::Rgb rgb = palette[material];
            codes.codes.insert(codes.codes.end(),
                               {rgb[0], rgb[1], rgb[2], std::uint8_t(material == io::background ? 0 : 255)});
        }
    return {std::move(caption), io::png_bytes(codes), codes.width_px, codes.height_px, px_per_mm};
}

}  // namespace voxtone::slicer
