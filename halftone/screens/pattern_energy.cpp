// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/screens/pattern_energy.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "halftone/screens/pattern_energy.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::halftone::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<std::int32_t, 16>;
constexpr int mask = field_size - 1;
constexpr std::size_t edge = field_size;
constexpr int group = 8;

template <int sign>
HWY_INLINE void add_near(PatternEnergy::Data& data, int x, int y, int z) {
    const Tag d;
    for (const KernelRow& k : data.near) {
        const std::size_t row =
            static_cast<std::size_t>((y + k.dy) & mask) + edge * static_cast<std::size_t>((z + k.dz) & mask);
        std::int32_t* energy = &data.energy[row * edge];
        const std::int32_t* kernel = k.value.data() + (field_size - x);
        for (std::size_t i = 0; i < edge; i += hn::Lanes(d)) {
            const auto old = hn::LoadU(d, energy + i);
            const auto change = hn::LoadU(d, kernel + i);
            hn::StoreU(sign > 0 ? hn::Add(old, change) : hn::Sub(old, change), d, energy + i);
        }
    }
}

/// Adds the far term to 8 rows, for a vector's width of x, and renews their extremes.
template <bool highs>
HWY_INLINE void add_far(PatternEnergy::Data& data, std::size_t first_row, std::size_t x,
                        const std::int32_t* factor_of_row, const std::int32_t* along_x) {
    const Tag d;
    const auto factor_x = hn::LoadU(d, along_x + x);
    auto smallest = hn::Set(d, INT32_MAX);
    auto largest = hn::Set(d, INT32_MIN);
    for (std::size_t row = 0; row < group; ++row) {
        std::int32_t* energy = &data.energy[(first_row + row) * edge + x];
        auto value = hn::LoadU(d, energy);
        if (factor_of_row[row] != 0) {
            value = hn::Add(value, hn::Mul(hn::Set(d, factor_of_row[row]), factor_x));
            hn::StoreU(value, d, energy);
        }
        smallest = hn::Min(smallest, value);
        if constexpr (highs) largest = hn::Max(largest, value);
    }
    hn::StoreU(smallest, d, &data.group_low[first_row / group * edge + x]);
    if constexpr (highs) hn::StoreU(largest, d, &data.group_high[first_row / group * edge + x]);
}

template <bool highs>
HWY_INLINE void update_plane(PatternEnergy::Data& data, std::size_t z, std::size_t x) {
    const Tag d;
    constexpr std::size_t groups = edge / group;
    auto smallest = hn::Set(d, INT32_MAX);
    auto largest = hn::Set(d, INT32_MIN);
    for (std::size_t g = z * groups; g < (z + 1) * groups; ++g) {
        smallest = hn::Min(smallest, hn::LoadU(d, &data.group_low[g * edge + x]));
        if constexpr (highs) largest = hn::Max(largest, hn::LoadU(d, &data.group_high[g * edge + x]));
    }
    hn::StoreU(smallest, d, &data.plane_low[z * edge + x]);
    if constexpr (highs) hn::StoreU(largest, d, &data.plane_high[z * edge + x]);
}

HWY_INLINE int overlap_along_axis(int distance) {
    const int folded = std::min(distance & mask, -distance & mask);
    return std::max(0, overlap_box - folded);
}

/// Whether any of the `count` columns from `first` on lies within `reach` of x on the torus.
HWY_INLINE bool reaches(int x, int reach, int first, int count) {
    return ((first - x + reach) & mask) <= 2 * reach || ((x - reach - first) & mask) < count;
}

template <int sign, bool highs>
HWY_INLINE void change_field(PatternEnergy::Data& data, int x, int y, int z) {
    const Tag d;
    add_near<sign>(data, x, y, z);
    std::array<std::int32_t, edge> along_x, along_y;
    for (int i = 0; i < field_size; ++i) {
        along_x[static_cast<std::size_t>(i)] = sign * data.far_weight * overlap_along_axis(i - x);
        along_y[static_cast<std::size_t>(i)] = overlap_along_axis(i - y);
    }
    // Columns out of reach keep their extremes.
    std::array<std::size_t, edge> columns;
    std::size_t column_count = 0;
    for (std::size_t i = 0; i < edge; i += hn::Lanes(d))
        if (reaches(x, data.reach_x, static_cast<int>(i), static_cast<int>(hn::Lanes(d)))) columns[column_count++] = i;
    for (int dz = -data.reach_z; dz <= data.reach_z; ++dz) {
        const auto plane = static_cast<std::size_t>((z + dz) & mask);
        const int factor_z = overlap_along_axis(dz);
        const int first_group = (y + field_size - data.reach_y) / group,
                  last_group = (y + field_size + data.reach_y) / group;
        for (int g = first_group; g <= std::min(last_group, first_group + field_size / group - 1); ++g) {
            const auto first_y = static_cast<std::size_t>((g * group) & mask);
            std::array<std::int32_t, group> factor;
            for (std::size_t row = 0; row < group; ++row) factor[row] = factor_z * along_y[first_y + row];
            for (std::size_t c = 0; c < column_count; ++c)
                add_far<highs>(data, plane * edge + first_y, columns[c], factor.data(), along_x.data());
        }
        for (std::size_t c = 0; c < column_count; ++c) update_plane<highs>(data, plane, columns[c]);
    }
}

void change(PatternEnergy::Data& data, int sign, int voxel, bool highs) {
    const int x = voxel & mask, y = (voxel / field_size) & mask, z = voxel / (field_size * field_size);
    if (sign > 0 && highs) change_field<1, true>(data, x, y, z);
    if (sign > 0 && !highs) change_field<1, false>(data, x, y, z);
    if (sign < 0) change_field<-1, true>(data, x, y, z);
}

/// The first place of the smallest or largest value.
template <bool most>
HWY_INLINE std::size_t place_of_extreme(const std::vector<std::int32_t>& values) {
    const Tag d;
    auto extreme = hn::Set(d, values[0]);
    for (std::size_t i = 0; i < values.size(); i += hn::Lanes(d))
        extreme = most ? hn::Max(extreme, hn::LoadU(d, &values[i])) : hn::Min(extreme, hn::LoadU(d, &values[i]));
    std::array<std::int32_t, 16> lanes;
    hn::StoreU(extreme, d, lanes.data());
    std::int32_t found = lanes[0];
    for (std::size_t i = 1; i < hn::Lanes(d); ++i) found = most ? std::max(found, lanes[i]) : std::min(found, lanes[i]);
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), found) - values.begin());
}

std::size_t smallest(const std::vector<std::int32_t>& values) { return place_of_extreme<false>(values); }
std::size_t largest(const std::vector<std::int32_t>& values) { return place_of_extreme<true>(values); }

}  // namespace voxtone::halftone::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::halftone {

HWY_EXPORT(change);
HWY_EXPORT(smallest);
HWY_EXPORT(largest);

namespace {

constexpr std::size_t groups_per_plane = 8;

/// From the plane to the group to the voxel that holds the plane's extreme.
int find_voxel(const std::vector<std::int32_t>& energy, const std::vector<std::int32_t>& of_group, std::size_t in_plane,
               std::int32_t extreme) {
    constexpr std::size_t edge = field_size;
    const std::size_t x = in_plane % edge, z = in_plane / edge;
    std::size_t group = z * groups_per_plane;
    while (of_group[group * edge + x] != extreme) ++group;
    std::size_t row = group * (edge / groups_per_plane);
    while (energy[row * edge + x] != extreme) ++row;
    return static_cast<int>(row * edge + x);
}

}  // namespace

PatternEnergy::PatternEnergy(std::vector<KernelRow> near, std::int32_t far_weight, std::int32_t marked_offset)
    : marked_offset_(marked_offset) {
    constexpr std::size_t edge = field_size;
    data_.reach_x = data_.reach_y = data_.reach_z = far_weight > 0 ? overlap_box - 1 : 0;
    for (const KernelRow& row : near) {
        data_.reach_y = std::max(data_.reach_y, std::abs(row.dy));
        data_.reach_z = std::max(data_.reach_z, std::abs(row.dz));
        for (int dx = data_.reach_x + 1; dx < field_size / 2; ++dx)
            if (row.value[static_cast<std::size_t>(dx)] != 0) data_.reach_x = dx;
    }
    data_.near = std::move(near);
    data_.far_weight = far_weight;
    data_.energy.assign(edge * edge * edge, 0);
    data_.group_low.assign(edge * edge * groups_per_plane, 0);
    data_.plane_low.assign(edge * edge, 0);
    data_.group_high = data_.group_low;
    data_.plane_high = data_.plane_low;
}

void PatternEnergy::change(int sign, int voxel, bool keep_highest) {
    data_.energy[static_cast<std::size_t>(voxel)] += sign * marked_offset_;
    HWY_DYNAMIC_DISPATCH(change)(data_, sign, voxel, keep_highest);
}

int PatternEnergy::lowest() const {
    const std::size_t found = HWY_DYNAMIC_DISPATCH(smallest)(data_.plane_low);
    return find_voxel(data_.energy, data_.group_low, found, data_.plane_low[found]);
}

int PatternEnergy::highest() const {
    const std::size_t found = HWY_DYNAMIC_DISPATCH(largest)(data_.plane_high);
    return find_voxel(data_.energy, data_.group_high, found, data_.plane_high[found]);
}

}  // namespace voxtone::halftone
#endif
