// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/block_mixtures.h"

#include "base/stopwatch.h"

namespace voxtone::slicer {

BlockMixtures::BlockMixtures(const LayerSources& sources)
    : surface_(sources.surface),
      colour_(std::get<MixtureSources>(sources.resins).colour),
      separation_(std::get<MixtureSources>(sources.resins).separation),
      skin_(std::get<MixtureSources>(sources.resins).skin),
      zones_(sources.zones),
      translucent_(std::get<MixtureSources>(sources.resins).translucent),
      night_(std::get<MixtureSources>(sources.resins).night),
      core_(sources.core - 1) {
    if (!colour_.sets_resins() && !zones_.any() && !translucent_.kept && !night_) return;
    const auto resins = static_cast<std::size_t>(separation_.resins());
    halftone::SkinMixtures each(resins, 1, resins);
    for (std::size_t r = 0; r < resins; ++r) each.cell(r)[r] = 1;
    pure_ = halftone::cumulative_mixtures(each);
}

std::size_t BlockMixtures::gather(const ShellBlock& block) {
    count_ = 0;
    marked_.clear();
    thinned_.clear();
    dark_.clear();
    apart_.clear();
    for_each_shell_voxel(block, [&](int row, int lane) {
        const int at = row * ShellBlock::width + lane;
        const std::uint32_t source = surface_.source_triangle[block.triangle[at]];
        float depth_mm = block.distance_mm[at];
        int resin = zones_.resin_at(depth_mm);
        if (translucent_.kept) {
            if (const float alpha = colour_.alpha_at(source, block.u[at], block.v[at]); alpha < 1) {
                const float kept = translucent_.kept->kept(colour_.at(source, block.u[at], block.v[at]), alpha);
                depth_mm *= kept;
                thinned_.emplace_back(count_, kept);
            }
            if (depth_mm > translucent_.shell_mm) resin = core_;
        }
        if (night_ && depth_mm > night_->from_mm())
            dark_.emplace_back(count_, night_->wanted(night_->asked(source, block.u[at], block.v[at]),
                                                      colour_.at(source, block.u[at], block.v[at])));
        else if (night_ && depth_mm > night_->day_mm())
            resin = core_;
        if (resin < 0 && colour_.sets_resins()) resin = colour_.resin_at(source, block.u[at], block.v[at]);
        if (resin >= 0) marked_.emplace_back(count_, resin);
        if (skin_ && skin_->knows(block.triangle[at])) {
            mixture_[count_++] = skin_->mixture(block.triangle[at], block.u[at], block.v[at], depth_mm);
            return;
        }
        const Eigen::Vector3f rgb = colour_.at(source, block.u[at], block.v[at]);
        if (skin_) apart_.emplace_back(count_, rgb);
        red_[count_] = rgb.x();
        green_[count_] = rgb.y();
        blue_[count_] = rgb.z();
        ++count_;
    });
    return count_;
}

const halftone::CumulativeMixture* BlockMixtures::separate() {
    if (!skin_) separation_.mixtures(red_.data(), green_.data(), blue_.data(), count_, mixture_.data());
    for (const auto& [voxel, rgb] : apart_) separation_.mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &mixture_[voxel]);
    for (const auto& [voxel, resin] : marked_) mixture_[voxel] = pure_[static_cast<std::size_t>(resin)];
    for (const auto& [voxel, rgb] : dark_)
        night_->separation().mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &mixture_[voxel]);
    for (const auto& [voxel, kept] : thinned_) mixture_[voxel] = translucent_.kept->diluted(mixture_[voxel], kept);
    return mixture_.data();
}

void BareCore::fill(const ShellBlock& block, io::Material* out, LayerCounts& /*counts*/) {
    for_each_shell_voxel(block, [&](int row, int lane) {
        const int at = row * ShellBlock::width + lane;
        const float depth_mm = block.distance_mm[at];
        if (zones_.is_over(depth_mm))
            out[at] = io::background;
        else
            out[at] = zones_.is_clear(depth_mm) ? static_cast<io::Material>(1 + zones_.clear) : core_;
    });
}

void ScreenedMixtures::fill(const ShellBlock& block, io::Material* out, LayerCounts& counts) {
    Stopwatch watch;
    counts.shell_voxels += mixtures_.gather(block);
    counts.colour_s += watch.lap();
    const halftone::CumulativeMixture* mixture = mixtures_.separate();
    int last_row = -1;
    const std::uint16_t* thresholds = nullptr;
    for_each_shell_voxel(block, [&](int row, int lane) {
        if (row != last_row) {
            thresholds = screen_.row(block.origin[1] + row % block.size[1], block.origin[2] + row / block.size[1]);
            last_row = row;
        }
        const std::uint16_t threshold = thresholds[(block.origin[0] + lane) & halftone::BlueNoiseScreen::mask];
        out[row * ShellBlock::width + lane] =
            static_cast<io::Material>(1 + halftone::select_resin(*mixture++, threshold, resins_));
    });
    counts.screen_s += watch.lap();
}

}  // namespace voxtone::slicer
