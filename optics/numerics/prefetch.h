// SPDX-License-Identifier: GPL-3.0-or-later
//
// Asks for memory before it is needed, where a processor cannot foresee what is read next: values are looked up by
// index, or every other one is taken. It changes no result.
#pragma once

#include <cstddef>
#include <span>

namespace voxtone::optics {

inline void prefetch(const void* from, std::size_t bytes) {
    constexpr std::size_t line = 64;
    for (std::size_t at = 0; at < bytes; at += line) __builtin_prefetch(static_cast<const char*>(from) + at);
}
template <class Value>
void prefetch(const Value& value) {
    prefetch(&value, sizeof value);
}

}  // namespace voxtone::optics
