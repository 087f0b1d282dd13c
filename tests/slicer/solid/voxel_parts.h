// SPDX-License-Identifier: GPL-3.0-or-later
//
// Voxels one by one, and how many parts they make.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "slicer/solid/span_slab.h"

namespace voxtone::slicer {

using Voxels = std::set<std::array<int, 3>>;

inline Voxels voxels_of(const SpanSlab& slab) {
    Voxels voxels;
    for (int k = slab.k_begin(); k < slab.k_end(); ++k)
        for (int j = 0; j < slab.rows(); ++j)
            for (const Span& s : slab.row(j, k))
                for (int i = s.begin; i < s.end; ++i) voxels.insert({i, j, k});
    return voxels;
}

/// Parts joined through faces, edges or corners of voxels.
inline int parts(Voxels left) {
    int count = 0;
    while (!left.empty()) {
        ++count;
        std::vector<std::array<int, 3>> queue{*left.begin()};
        left.erase(left.begin());
        while (!queue.empty()) {
            const auto v = queue.back();
            queue.pop_back();
            for (int n = 0; n < 27; ++n) {
                const auto it = left.find({v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1});
                if (it == left.end()) continue;
                queue.push_back(*it);
                left.erase(it);
            }
        }
    }
    return count;
}

}  // namespace voxtone::slicer
