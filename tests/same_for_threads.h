// SPDX-License-Identifier: GPL-3.0-or-later
//
// Results that may not depend on how many threads work on them.
#pragma once

#include <cstddef>
#include <initializer_list>

#include <catch2/catch.hpp>

#include "base/parallel.h"

namespace voxtone::test {

/// What `make` gives with one thread, after a look whether it gives the same, by ==, with each of these numbers. One
/// limit is over before the next begins: of two that live at once the lower one holds, and nothing would be compared.
template <class Make>
auto same_for_threads(Make&& make, std::initializer_list<std::size_t> numbers = {2, 5}) {
    const auto with = [&](std::size_t threads) {
        const ThreadLimit limit(threads);
        return make();
    };
    const auto one = with(1);
    for (const std::size_t threads : numbers) {
        INFO(threads << " threads");
        const bool same = with(threads) == one;
        CHECK(same);
    }
    return one;
}

}  // namespace voxtone::test
