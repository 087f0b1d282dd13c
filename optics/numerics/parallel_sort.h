// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#ifdef __SANITIZE_THREAD__
#include <algorithm>
#else
#include <oneapi/tbb/parallel_sort.h>
#endif

namespace voxtone::optics {

/// Sorts with `<`, which must order all values: then the result is the same for any number of threads
/// (base/parallel.h).
template <class Value>
void parallel_sort(std::span<Value> values) {
#ifdef __SANITIZE_THREAD__
    std::sort(values.begin(), values.end());
#else
    tbb::parallel_sort(values.begin(), values.end());
#endif
}

}  // namespace voxtone::optics
