// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/block_contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "optics/grid/viewing_grid.h"

namespace voxtone::optics {

bool voxels_are_apart(const ResinSet& resins) { return resins.dot_spread <= 0.5; }

namespace {

bool is_lit(const ViewingGrid& grid, const GridBlock& block) {
    const auto first = grid.faces.begin() + block.first_face;
    return std::any_of(first, first + block.faces, [](const OuterFace& face) { return face.kind == FaceKind::light; });
}

}  // namespace

std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& grid, const ResinVolume& volume, Refinement which) {
    std::vector<std::uint32_t> chosen;
    if (which == Refinement::none) return chosen;
    std::vector<std::int16_t> only(grid.blocks.size());
    parallel_ranges(0, only.size(), 64, [&](std::size_t first, std::size_t last) {
        std::vector<Material> box;
        for (std::size_t b = first; b < last; ++b) only[b] = grid.content_of(grid.blocks[b], volume, box).resin;
    });
    for (std::size_t t = 0; t < grid.transport_blocks.size(); ++t) {
        const std::uint32_t b = grid.transport_blocks[t];
        if (which == Refinement::contrast && !is_lit(grid, grid.blocks[b])) continue;
        bool wanted = only[b] < 0 || which == Refinement::all;
        for (const std::int32_t other : grid.blocks[b].neighbour) {
            const int beside = other < 0 ? only[b] : only[static_cast<std::size_t>(other)];
            wanted |= beside > air && beside != only[b];
        }
        if (wanted) chosen.push_back(static_cast<std::uint32_t>(t));
    }
    return chosen;
}

namespace {

/// Sums of volume, and of L and its square by channel.
class ToneSums {
public:
    ToneSums(std::size_t count, std::size_t channels) : channels_(channels), sum_(count * (1 + 2 * channels)) {}
    void add(std::size_t to, double volume, const float* lightness) {
        double* const sum = at(to);
        sum[0] += volume;
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto l = static_cast<double>(lightness[c]);
            sum[1 + 2 * c] += volume * l;
            sum[2 + 2 * c] += volume * l * l;
        }
    }
    void add(std::size_t to, const ToneSums& from, std::size_t which) {
        const double* const more = from.at(which);
        double* const sum = at(to);
        for (std::size_t i = 0; i < 1 + 2 * channels_; ++i) sum[i] += more[i];
    }
    [[nodiscard]] bool empty(std::size_t i) const { return !(at(i)[0] > 0); }
    [[nodiscard]] double mean(std::size_t i, std::size_t channel) const { return at(i)[1 + 2 * channel] / at(i)[0]; }
    [[nodiscard]] double variance(std::size_t i, std::size_t channel) const {
        const double m = mean(i, channel);
        return std::max(at(i)[2 + 2 * channel] / at(i)[0] - m * m, 0.0);
    }

private:
    [[nodiscard]] double* at(std::size_t i) { return sum_.data() + i * (1 + 2 * channels_); }
    [[nodiscard]] const double* at(std::size_t i) const { return sum_.data() + i * (1 + 2 * channels_); }
    std::size_t channels_;
    std::vector<double> sum_;
};

ToneSums tones_of_mixtures(const ViewingGrid& grid, const ResinSet& resins) {
    const std::size_t channels = resins.channels.size();
    const std::vector<float> lightness = lightness_of_resins(resins);
    ToneSums of(grid.mixtures.size(), channels);
    for (std::size_t m = 0; m < grid.mixtures.size(); ++m)
        for (const auto& hold : grid.mixtures[m].holds)
            of.add(m, static_cast<double>(hold.share), lightness.data() + (hold.material - 1u) * channels);
    return of;
}

}  // namespace

std::vector<float> lightness_of_resins(const ResinSet& resins) {
    std::vector<float> lightness;
    for (const Resin& resin : resins.resins)
        for (std::size_t c = 0; c < resins.channels.size(); ++c) {
            const double albedo = resin.medium(c).albedo();
            const double s = std::sqrt((1 - albedo) / (1 - resins.g * albedo));
            const double reflected = (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
            lightness.push_back(static_cast<float>(std::max(116 * std::cbrt(reflected) - 16, 0.0)));
        }
    return lightness;
}

std::vector<float> contrast_of_blocks(const ViewingGrid& grid, const ResinSet& resins) {
    const std::size_t channels = resins.channels.size(), count = grid.blocks.size();
    const ToneSums of_mixtures = tones_of_mixtures(grid, resins);
    ToneSums of_blocks(count, channels);
    parallel_for(0, grid.transport_blocks.size(), 64, [&](std::size_t t) {
        for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell)
            of_blocks.add(grid.transport_blocks[t], of_mixtures, grid.medium[cell]);
    });
    std::vector<float> contrast(grid.transport_blocks.size());
    parallel_for(0, contrast.size(), 64, [&](std::size_t t) {
        const std::uint32_t b = grid.transport_blocks[t];
        if (of_blocks.empty(b)) return;
        double most = 0;
        for (std::size_t c = 0; c < channels; ++c) most += of_blocks.variance(b, c);
        for (const std::int32_t other : grid.blocks[b].neighbour) {
            if (other < 0 || of_blocks.empty(static_cast<std::size_t>(other))) continue;
            double sum = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                const double apart = of_blocks.mean(b, c) - of_blocks.mean(static_cast<std::size_t>(other), c);
                sum += 0.25 * apart * apart;
            }
            most = std::max(most, sum);
        }
        contrast[t] = static_cast<float>(std::sqrt(most / static_cast<double>(channels)));
    });
    return contrast;
}

std::vector<std::uint32_t> blocks_of_contrast(const ViewingGrid& grid, const ResinSet& resins,
                                              std::vector<std::uint32_t> blocks, double least) {
    if (least <= 0 || blocks.empty()) return blocks;
    const std::vector<float> contrast = contrast_of_blocks(grid, resins);
    std::erase_if(blocks, [&](std::uint32_t t) { return static_cast<double>(contrast[t]) < least; });
    return blocks;
}

}  // namespace voxtone::optics
