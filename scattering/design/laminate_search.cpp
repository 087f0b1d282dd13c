// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "scattering/design/laminate_bounds.h"
#include "scattering/design/laminate_descent.h"
#include "scattering/design/sub_laminates.h"

namespace voxtone::scattering {
namespace {

constexpr double most_table_bytes = 1e9;

/// The longest sub-laminates of which there are not too many.
std::uint32_t choose_table_blocks(const LaminateBlocks& blocks, const LaminateSearchOptions& options,
                                  const std::vector<double>& counts) {
    // A larger table costs its making and saves time with each target.
    const double wanted = options.table_laminates;
    const double held = most_table_bytes / (8.0 * static_cast<double>(blocks.coefficients()));
    std::uint32_t table_blocks = 1;
    while (table_blocks < std::min(options.max_blocks, most_table_blocks) &&
           counts[table_blocks + 1] <= std::min(wanted, held))
        ++table_blocks;
    return table_blocks;
}

double mean(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double spread_of(std::span<const double> R) { return R[0] > 0 ? mean(R) / R[0] : 0; }

}  // namespace

struct LaminateSearch::Tables {
    Tables(std::span<const LaminateMaterial> m, const LaminateSearchOptions& o)
        : materials(m.begin(), m.end()),
          options(o),
          blocks(m, o),
          counts(blocks.count_laminates(o.max_blocks)),
          table_blocks(choose_table_blocks(blocks, o, counts)),
          bounds(blocks, o.max_blocks) {
        SubLaminateRows rows = backing_rows(blocks);
        for (std::uint32_t e = 1; e <= table_blocks; ++e) {
            rows = cover_all(blocks, rows);
            trees.emplace_back(blocks, rows);
        }
    }

    std::vector<LaminateMaterial> materials;
    LaminateSearchOptions options;
    LaminateBlocks blocks;
    std::vector<double> counts;
    std::uint32_t table_blocks;
    LaminateBounds bounds;
    std::vector<SubLaminateTree> trees;  ///< of 1, 2, ... blocks
};

LaminateSearch::LaminateSearch(std::span<const LaminateMaterial> materials, const LaminateSearchOptions& options)
    : tables_(std::make_unique<const Tables>(materials, options)) {}
LaminateSearch::~LaminateSearch() = default;
LaminateSearch::LaminateSearch(LaminateSearch&&) noexcept = default;
LaminateSearch& LaminateSearch::operator=(LaminateSearch&&) noexcept = default;

FoundLaminate LaminateSearch::find(const ChannelProfiles& target) const {
    const Tables& t = *tables_;
    const std::vector<double> row = t.blocks.to_row(target, "the target");
    const DescentResult best = descend({t.blocks, t.bounds, t.trees, t.options.max_blocks, t.options.tolerance}, row);

    FoundLaminate found;
    found.count = best.count;
    const double step_mm = t.options.thickness_mm / t.options.steps;
    std::uint32_t units = 0;
    for (std::size_t k = 0; k < best.blocks.size(); ++k) {
        const LaminateBlock& block = t.blocks[best.blocks[k]];
        units += block.units;
        if (k + 1 < best.blocks.size() && t.blocks[best.blocks[k + 1]].material == block.material) continue;
        found.layers.push_back({block.material, units * step_mm});
        units = 0;
    }
    found.distance = std::sqrt(best.squares / t.blocks.weight_sum());

    double outside = 0;
    const std::span<const float> least = t.bounds.least(), most = t.bounds.most(), root_weight = t.blocks.root_weight();
    for (std::size_t i = 0; i < row.size(); ++i) {
        const double missing =
            std::max({0.0, least[i] - residual_error - row[i], row[i] - most[i] - residual_error}) * root_weight[i];
        outside += missing * missing;
    }
    found.outside = std::min(found.distance, std::sqrt(outside / t.blocks.weight_sum()));

    const ChannelProfiles R = laminate_reflection(t.materials, found.layers, t.options.backing);
    const ChannelProfiles low = t.blocks.to_channels(least), high = t.blocks.to_channels(most);
    for (std::size_t c = 0; c < target.size(); ++c)
        found.channels.push_back({target[c][0], R[c][0], low[c][0], high[c][0], spread_of(target[c]), spread_of(R[c])});
    return found;
}

std::vector<FoundLaminate> LaminateSearch::find_all(std::span<const ChannelProfiles> targets,
                                                    const Progress* progress) const {
    std::vector<FoundLaminate> found(targets.size());
    parallel_for(
        0, targets.size(), 1, [&](std::size_t i) { found[i] = find(targets[i]); }, progress);
    return found;
}

double LaminateSearch::laminates() const {
    return std::accumulate(tables_->counts.begin(), tables_->counts.end(), 0.0);
}
std::uint32_t LaminateSearch::table_blocks() const { return tables_->table_blocks; }

ChannelProfiles laminate_reflection(std::span<const LaminateMaterial> materials, std::span<const LaminateLayer> layers,
                                    const ChannelProfiles& backing) {
    VOXTONE_EXPECT(!materials.empty());
    ChannelProfiles R(materials[0].size());
    VOXTONE_EXPECT(backing.empty() || backing.size() == R.size());
    for (std::size_t c = 0; c < R.size(); ++c) {
        const std::size_t n = materials[0][c].K().size();
        optics::LayerProfile below = optics::no_layer(n);
        below.T.assign(n, 0.0);
        if (!backing.empty()) below.R_top = backing[c];
        for (std::size_t k = layers.size(); k-- > 0;)
            below = optics::laminate(materials[layers[k].material][c].of_thickness(layers[k].thickness_mm), below);
        R[c] = below.R_top;
    }
    return R;
}

double profile_distance(const ChannelProfiles& reflection, const ChannelProfiles& target,
                        const ProfileWeights& weights) {
    VOXTONE_EXPECT(reflection.size() == target.size());
    double sum = 0, all = 0;
    for (std::size_t c = 0; c < target.size(); ++c) {
        VOXTONE_EXPECT(reflection[c].size() == target[c].size());
        for (std::size_t i = 0; i < target[c].size(); ++i) {
            const double w = weights.of(i), e = reflection[c][i] - target[c][i];
            sum += w * e * e;
            all += w;
        }
    }
    return std::sqrt(sum / all);
}

}  // namespace voxtone::scattering
