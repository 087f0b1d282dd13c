// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where parts lie on the plate, by their outlines from above: all on the plate, for a jetting printer's time goes by
// height, then as few columns as can be, for it goes by passes too. Each outline at the first place from the left, then
// from the front, where it, grown by the gap, meets no other (bottom-left fill on bitmaps, as Burke et al. 2006, "A new
// bottom-left-fill heuristic algorithm for the two-dimensional irregular packing problem", Oper. Res. 54:587, do it on
// polygons); in several orders, of which the best is kept. Outlines are not turned.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace voxtone::slicer {

/// A bitmap of cells, true where the part stands over the plate or near enough to one that does.
class Outline {
public:
    Outline(int width, int height);
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] int words() const { return words_; }
    void set(int x, int y) { row(y)[x / 64] |= std::uint64_t{1} << (x % 64); }
    [[nodiscard]] bool at(int x, int y) const { return row(y)[x / 64] >> (x % 64) & 1; }
    [[nodiscard]] std::size_t area() const;
    /// By so many cells in all eight directions, which it grows by on each side.
    [[nodiscard]] Outline grown(int cells) const;
    [[nodiscard]] const std::uint64_t* row(int y) const { return bits_.data() + std::size_t(y) * std::size_t(words_); }

private:
    [[nodiscard]] std::uint64_t* row(int y) { return bits_.data() + std::size_t(y) * std::size_t(words_); }
    int width_, height_, words_;
    std::vector<std::uint64_t> bits_;
};

/// Lower left corner of each outline on a plate of so many cells, in the order in which they were given; nothing for
/// what found no room. `gap_cells` of free cells lie between any two. `taken`: of the plate already; as large as it.
[[nodiscard]] std::vector<std::optional<std::array<int, 2>>> nest(const std::vector<Outline>& outlines,
                                                                  const std::array<int, 2>& plate, int gap_cells,
                                                                  const std::optional<Outline>& taken = std::nullopt);

}  // namespace voxtone::slicer
