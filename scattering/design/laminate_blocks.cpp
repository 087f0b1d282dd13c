// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::scattering {
namespace {

void check_options(std::size_t materials, const LaminateSearchOptions& o) {
    if (!(o.thickness_mm > 0) || !std::isfinite(o.thickness_mm))
        throw InputError(
            fmt::format("laminate search: a thickness of {} mm holds no layer; it must be above 0", o.thickness_mm));
    if (o.steps < 1 || o.steps > 4096)
        throw InputError(fmt::format("laminate search: {} steps of thickness; 1 to 4096 are possible", o.steps));
    if (o.max_blocks < 1 || o.max_blocks > 16)
        throw InputError(fmt::format("laminate search: {} blocks at most; 1 to 16 are possible", o.max_blocks));
    if (!(o.dc_weight > 0) || !std::isfinite(o.dc_weight))
        throw InputError(
            fmt::format("laminate search: a weight of {} on the first coefficient; it must be above 0", o.dc_weight));
    if (!(o.tolerance >= 0))
        throw InputError(fmt::format("laminate search: a tolerance of {}; it must be 0 or above", o.tolerance));
    if (!o.clear_top_mm.empty() && o.clear_top_mm.size() != materials)
        throw InputError(fmt::format(
            "laminate search: distances from the top for {} materials, but there are {}; give one for each, 0 for none",
            o.clear_top_mm.size(), materials));
    for (const double mm : o.clear_top_mm)
        if (!(mm >= 0)) throw InputError(fmt::format("laminate search: {} mm from the top; it must be 0 or above", mm));
}

void check_materials(std::span<const LaminateMaterial> materials) {
    if (materials.empty()) throw InputError("laminate search: no material; give at least one");
    if (materials.size() > 64)
        throw InputError(fmt::format("laminate search: {} materials; 64 at most", materials.size()));
    if (materials[0].empty() || materials[0][0].K().empty())
        throw InputError("laminate search: material 1 has no coefficients; measure or make its profile first");
    for (std::size_t m = 0; m < materials.size(); ++m) {
        if (materials[m].size() != materials[0].size())
            throw InputError(
                fmt::format("laminate search: material {} has {} channels, material 1 has {}; profiles of the same "
                            "channels are needed",
                            m + 1, materials[m].size(), materials[0].size()));
        for (const optics::HomogeneousLayer& layer : materials[m])
            if (layer.K().size() != materials[0][0].K().size())
                throw InputError(
                    fmt::format("laminate search: a profile of material {} has {} coefficients, material 1 has {}; "
                                "bring all to one "
                                "spacing and length",
                                m + 1, layer.K().size(), materials[0][0].K().size()));
    }
}

}  // namespace

LaminateBlocks::LaminateBlocks(std::span<const LaminateMaterial> materials, const LaminateSearchOptions& options)
    : units_(options.steps) {
    check_materials(materials);
    check_options(materials.size(), options);
    channels_ = materials[0].size();
    length_ = materials[0][0].K().size();
    const double step_mm = options.thickness_mm / options.steps;
    for (std::uint32_t units = std::bit_floor(units_); units > 0; units /= 2)
        for (std::uint32_t m = 0; m < materials.size(); ++m) blocks_.push_back({m, units});
    clear_units_.assign(materials.size(), 0);
    for (std::size_t m = 0; m < options.clear_top_mm.size(); ++m)  // a hair of rounding makes no further step
        clear_units_[m] = static_cast<std::uint32_t>(
            std::min(std::ceil(options.clear_top_mm[m] / step_mm - 1e-9), static_cast<double>(units_) + 1));

    const std::size_t n = channels_ * length_;
    std::vector<double> R(blocks_.size() * n), T(blocks_.size() * n), least(n, 1.0), most(n, 0.0);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (std::size_t c = 0; c < channels_; ++c) {
            const optics::LayerProfile layer =
                materials[blocks_[b].material][c].of_thickness(blocks_[b].units * step_mm);
            for (std::size_t i = 0; i < length_; ++i) {
                const std::size_t at = c * length_ + i;
                R[b * n + at] = layer.R_top[i];
                T[b * n + at] = layer.T[i];
                least[at] = std::min(least[at], layer.R_top[i]);
                most[at] = std::max(most[at], layer.R_top[i]);
            }
        }
    std::vector<double> weight(n), spread(n);
    for (std::size_t at = 0; at < n; ++at) weight[at] = options.weights().of(at % length_);
    for (std::size_t at = 0; at < n; ++at) spread[at] = weight[at] * (most[at] - least[at]) * (most[at] - least[at]);
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return spread[a] > spread[b]; });

    R_.resize(R.size());
    T_.resize(T.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (std::size_t i = 0; i < n; ++i) {
            R_[b * n + i] = R[b * n + order_[i]];
            T_[b * n + i] = T[b * n + order_[i]];
        }
    R_single_.assign(R_.begin(), R_.end());
    T_single_.assign(T_.begin(), T_.end());
    for (const std::size_t at : order_) weight_.push_back(weight[at]);
    for (const double w : weight_) root_weight_.push_back(static_cast<float>(std::sqrt(w)));
    weight_sum_ = std::accumulate(weight.begin(), weight.end(), 0.0);
    backing_ = options.backing.empty() ? std::vector<double>(n, 0.0) : to_row(options.backing, "the backing");
    for (const double x : backing_)
        if (x < 0 || x > 1)
            throw InputError(
                fmt::format("laminate search: the backing reflects {}; coefficients from 0 to 1 are possible", x));
}

std::vector<double> LaminateBlocks::count_laminates(std::uint32_t most_blocks) const {
    const std::size_t blocks = blocks_.size(), steps = units_ + 1;
    std::vector<double> counts{1.0}, ways(blocks * steps, 0.0);  // by last block and steps used
    for (std::size_t b = 0; b < blocks; ++b)
        if (clear_units(static_cast<BlockIndex>(b)) == 0) ways[b * steps + blocks_[b].units] = 1;
    for (std::uint32_t d = 1; d <= most_blocks; ++d) {
        counts.push_back(std::accumulate(ways.begin(), ways.end(), 0.0));
        std::vector<double> longer(ways.size(), 0.0);
        for (std::size_t last = 0; last < blocks; ++last)
            for (std::size_t b = 0; b < blocks; ++b) {
                if (!may_follow(static_cast<BlockIndex>(last), static_cast<BlockIndex>(b))) continue;
                const std::size_t units = blocks_[b].units;
                for (std::size_t u = clear_units(static_cast<BlockIndex>(b)); u + units < steps; ++u)
                    longer[b * steps + u + units] += ways[last * steps + u];
            }
        ways = std::move(longer);
    }
    return counts;
}

void LaminateBlocks::cover(BlockIndex b, std::span<const float> x, std::span<float> out) const {
    const std::span<const float> R = R_single(b), T = T_single(b);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = R[i] + T[i] * T[i] * x[i] / std::max(1 - R[i] * x[i], 1e-30F);
}

double LaminateBlocks::squares(std::span<const BlockIndex> laminate, std::span<const double> target) const {
    std::vector<double> x = backing_;
    for (std::size_t k = laminate.size(); k-- > 0;) {
        const std::span<const double> R_k = R(laminate[k]), T_k = T(laminate[k]);
        for (std::size_t i = 0; i < x.size(); ++i)
            x[i] = R_k[i] + T_k[i] * T_k[i] * x[i] / std::max(1 - R_k[i] * x[i], 1e-300);
    }
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += weight_[i] * (x[i] - target[i]) * (x[i] - target[i]);
    return sum;
}

std::vector<double> LaminateBlocks::to_row(const ChannelProfiles& profiles, const char* name) const {
    if (profiles.size() != channels_)
        throw InputError(fmt::format("laminate search: {} has {} channels, the materials have {}", name,
                                     profiles.size(), channels_));
    for (const std::vector<double>& channel : profiles) {
        if (channel.size() != length_)
            throw InputError(
                fmt::format("laminate search: {} has {} coefficients in a channel, the materials have {}; bring all to "
                            "one spacing and length",
                            name, channel.size(), length_));
        for (const double x : channel)
            if (!std::isfinite(x))
                throw InputError(
                    fmt::format("laminate search: {} has a coefficient that is not a finite number", name));
    }
    std::vector<double> row;
    row.reserve(order_.size());
    for (const std::size_t at : order_) row.push_back(profiles[at / length_][at % length_]);
    return row;
}

ChannelProfiles LaminateBlocks::to_channels(std::span<const float> row) const {
    ChannelProfiles profiles(channels_, std::vector<double>(length_));
    for (std::size_t i = 0; i < order_.size(); ++i) profiles[order_[i] / length_][order_[i] % length_] = row[i];
    return profiles;
}

}  // namespace voxtone::scattering
