// SPDX-License-Identifier: GPL-3.0-or-later
//
// Floats side by side, as vector types of the compiler: left to itself it takes loops over them one by one. Arithmetic
// is the operators'; the same bits on every instruction set as long as nothing is fused. Lanes of what is wider than
// the target's registers may not cross from file to file (optics/transport/transport_sweep.cpp has its own functions
// for each instruction set).
#pragma once

#include <cstdint>
#include <cstring>

namespace voxtone::optics {

template <int n>
using FloatLanes __attribute__((vector_size(4 * n))) = float;
template <int n>
using IntLanes __attribute__((vector_size(4 * n))) = std::int32_t;
using Four = FloatLanes<4>;

template <int n>
inline FloatLanes<n> load_lanes(const float* from) {
    FloatLanes<n> v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline Four four(const float* from) { return load_lanes<4>(from); }
template <class V>
void put(const V& v, float* to) {
    std::memcpy(to, &v, sizeof v);
}
template <class V>
V above_zero(const V& v) {
    return v > 0 ? v : V{};
}

}  // namespace voxtone::optics
