// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/nesting.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <numeric>
#include <utility>

#include "base/contracts.h"
#include "base/random.h"

namespace voxtone::slicer {

namespace {

constexpr int word_bits = 64;

/// What is taken of the plate.
class Plate {
public:
    Plate(int width, int height) : taken_(width, height) {}

    [[nodiscard]] bool is_free(const Outline& outline, int x, int y) const {
        for (int j = 0; j < outline.height(); ++j)
            for (int w = 0; w < outline.words(); ++w)
                if (outline.row(j)[w] & bits_from(y + j, x + w * word_bits)) return false;
        return true;
    }
    void take(const Outline& outline, int x, int y) {
        for (int j = 0; j < outline.height(); ++j)
            for (int i = 0; i < outline.width(); ++i)
                if (outline.at(i, j)) taken_.set(x + i, y + j);
    }

private:
    /// 64 cells of row `y` from column `x` on.
    [[nodiscard]] std::uint64_t bits_from(int y, int x) const {
        const int word = x / word_bits, shift = x % word_bits;
        const std::uint64_t* row = taken_.row(y);
        std::uint64_t bits = word < taken_.words() ? row[word] >> shift : 0;
        if (shift > 0 && word + 1 < taken_.words()) bits |= row[word + 1] << (word_bits - shift);
        return bits;
    }
    Outline taken_;
};

/// The first free place, column by column from the left.
std::optional<std::array<int, 2>> first_place(const Plate& plate, const Outline& outline,
                                              const std::array<int, 2>& size) {
    for (int x = 0; x + outline.width() <= size[0]; ++x)
        for (int y = 0; y + outline.height() <= size[1]; ++y)
            if (plate.is_free(outline, x, y)) return std::array{x, y};
    return std::nullopt;
}

struct Nest {
    std::vector<std::optional<std::array<int, 2>>> places;
    std::size_t placed = 0;
    int columns = 0;  ///< that are taken

    [[nodiscard]] bool better_than(const Nest& other) const {
        return placed != other.placed ? placed > other.placed : columns < other.columns;
    }
};

Nest nest_in_order(const std::vector<Outline>& outlines, const std::vector<std::size_t>& order,
                   const std::array<int, 2>& size, int gap_cells, const std::optional<Outline>& taken) {
    // The plate has a margin of the gap all around, where grown outlines may reach into.
    const std::array<int, 2> with_margin{size[0] + 2 * gap_cells, size[1] + 2 * gap_cells};
    Plate plate(with_margin[0], with_margin[1]);
    if (taken) plate.take(*taken, gap_cells, gap_cells);
    Nest nest;
    nest.places.resize(outlines.size());
    for (const std::size_t p : order) {
        // What is taken is as it is; what looks for room is grown: between two lies the gap, once.
        const Outline grown = outlines[p].grown(gap_cells);
        const auto found = first_place(plate, grown, with_margin);
        if (!found) continue;
        nest.places[p] = *found;  // of the grown outline with the margin, and so of the outline on the plate
        ++nest.placed;
        nest.columns = std::max(nest.columns, (*found)[0] + outlines[p].width());
        plate.take(outlines[p], (*found)[0] + gap_cells, (*found)[1] + gap_cells);
    }
    return nest;
}

/// Largest first, tallest first, as given; and, while that takes little, some by chance.
std::vector<std::vector<std::size_t>> orders_of(const std::vector<Outline>& outlines) {
    std::vector<std::size_t> given(outlines.size());
    std::iota(given.begin(), given.end(), std::size_t{0});
    std::vector<std::vector<std::size_t>> orders(3, given);
    std::ranges::stable_sort(orders[0], std::greater<>(), [&](std::size_t p) { return outlines[p].area(); });
    std::ranges::stable_sort(orders[1], std::greater<>(), [&](std::size_t p) { return outlines[p].height(); });
    constexpr std::size_t few = 60, by_chance = 12;
    if (outlines.size() > few) return orders;
    for (std::size_t n = 0; n < by_chance; ++n) {
        RandomStream random(1, n);
        std::vector<std::size_t> order = given;
        for (std::size_t i = order.size(); i > 1; --i)
            std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
        orders.push_back(std::move(order));
    }
    return orders;
}

}  // namespace

Outline::Outline(int width, int height)
    : width_(width),
      height_(height),
      words_((width + word_bits - 1) / word_bits),
      bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(height)) {
    VOXTONE_EXPECT(width > 0 && height > 0);
}

std::size_t Outline::area() const {
    return std::accumulate(bits_.begin(), bits_.end(), std::size_t{0},
                           [](std::size_t sum, std::uint64_t word) { return sum + std::size_t(std::popcount(word)); });
}

Outline Outline::grown(int cells) const {
    Outline grown(width_ + 2 * cells, height_ + 2 * cells);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            if (!at(x, y)) continue;
            for (int dy = 0; dy <= 2 * cells; ++dy)
                for (int dx = 0; dx <= 2 * cells; ++dx) grown.set(x + dx, y + dy);
        }
    return grown;
}

std::vector<std::optional<std::array<int, 2>>> nest(const std::vector<Outline>& outlines,
                                                    const std::array<int, 2>& size, int gap_cells,
                                                    const std::optional<Outline>& taken) {
    std::optional<Nest> best;
    for (const std::vector<std::size_t>& order : orders_of(outlines)) {
        Nest nest = nest_in_order(outlines, order, size, gap_cells, taken);
        if (!best || nest.better_than(*best)) best = std::move(nest);
    }
    return best->places;
}

}  // namespace voxtone::slicer
