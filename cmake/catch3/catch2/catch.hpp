// SPDX-License-Identifier: GPL-3.0-or-later
//
// Catch2 3 under the names of Catch2 2, which the tests use: this folder is looked in where that is what is installed.
#pragma once

#include <concepts>
#include <string>
#include <utility>

#include <catch2/catch_all.hpp>

namespace Catch {
namespace Matchers {

/// In version 3 the name is for elements of ranges.
template <class Text>
requires std::convertible_to<Text, std::string>
auto Contains(Text&& part) {
    return ContainsSubstring(std::forward<Text>(part));
}

}  // namespace Matchers

using Matchers::Contains;
using Matchers::EndsWith;
using Matchers::StartsWith;

}  // namespace Catch

using Catch::Approx;
