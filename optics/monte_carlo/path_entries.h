// SPDX-License-Identifier: GPL-3.0-or-later
//
// How light enters, many paths at once, in vector code: the place on the surface, the direction of diffuse light that
// the refractive surface let in, and the first free path, each path by its address (path_random.h). The scalar
// reference is ScalarPaths (scalar_paths.h). Run-time dispatch; the same bits on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace voxtone::optics {

/// Paths about to enter: their addresses in, what chance decides at their start out. A place on a face is (u, v) along
/// the axes that follow the normal's, the direction likewise.
struct Entries {
    static constexpr std::size_t most = 64;
    template <class T>
    using Row = std::array<T, most>;
    alignas(64) std::array<Row<std::uint32_t>, 4> random{};  ///< in: path, channel, cell; out: the generators' states
    alignas(64) Row<float> face{};                           ///< which of the cell's faces, in [0, 1)
    alignas(64) Row<float> u{}, v{};                         ///< in [0, 1)
    alignas(64) Row<float> inward{}, along_u{}, along_v{};   ///< of diffuse light that the surface let in
    alignas(64) Row<float> depth{};                          ///< of the first free path
};

/// Fills all of `entries`.
void draw_entries(std::uint64_t seed, double eta, Entries& entries);

}  // namespace voxtone::optics
