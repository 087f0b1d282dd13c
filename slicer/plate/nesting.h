// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where parts lie on the plate, by their outlines from above: as few columns as can be (in as few passes of the heads:
// pass_bands.h). Each outline at the first place from the left, then from the front, where it, grown by the gap, meets
// no other (bottom-left fill on bitmaps, as Burke et al. 2006, "A new bottom-left-fill heuristic algorithm for the
// two-dimensional irregular packing problem", Oper. Res. 54:587, do it on polygons); in several orders, of which the
// best is kept. Of an outline that may be turned that turn is taken whose right end is leftmost.
//
// A column of the plate is a row of bits: whether an outline is free at all places of a column is asked at once.
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
    /// Of a column, 64 cells each, from the front.
    [[nodiscard]] int words() const { return words_; }
    void set(int x, int y) { column(x)[y / 64] |= std::uint64_t{1} << (y % 64); }
    [[nodiscard]] bool at(int x, int y) const { return column(x)[y / 64] >> (y % 64) & 1; }
    [[nodiscard]] std::size_t area() const;
    /// By so many cells in all eight directions, which it grows by on each side.
    [[nodiscard]] Outline grown(int cells) const;
    /// By so many right angles, counter-clockwise from above.
    [[nodiscard]] Outline turned(int right_angles) const;
    [[nodiscard]] const std::uint64_t* column(int x) const {
        return bits_.data() + std::size_t(x) * std::size_t(words_);
    }
    [[nodiscard]] std::uint64_t* column(int x) { return bits_.data() + std::size_t(x) * std::size_t(words_); }

private:
    int width_, height_, words_;
    std::vector<std::uint64_t> bits_;
};

/// What looks for a place.
struct NestItem {
    std::vector<Outline> turns;  ///< by none, one, two and three right angles, or by none alone
    std::size_t group = 0;       ///< those of one are turned alike
};

struct NestPlace {
    int x = 0, y = 0;  ///< lower left corner of the outline, turned
    int turn = 0;      ///< right angles
};

/// A place for each on a plate of so many cells, in the order in which they were given; nothing for what found no room.
/// `gap_cells` of free cells lie between any two. `taken`: of the plate already; as large as it.
[[nodiscard]] std::vector<std::optional<NestPlace>> nest(const std::vector<NestItem>& items,
                                                         const std::array<int, 2>& plate, int gap_cells,
                                                         const std::optional<Outline>& taken = std::nullopt);

}  // namespace voxtone::slicer
