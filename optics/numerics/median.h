// SPDX-License-Identifier: GPL-3.0-or-later
//
// The middle value; of an even number of values the upper of both. None: 0.
#pragma once

#include <algorithm>
#include <vector>

namespace voxtone::optics {

[[nodiscard]] inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace voxtone::optics
