// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/nesting.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/random.h"

namespace voxtone::slicer {

namespace {

constexpr int word_bits = 64;

/// A run of cells of an outline's column: [first, end).
struct ColumnRun {
    int x, first, end;
};

/// What looks for room, as runs; grown by the gap.
struct Shape {
    int width, height;
    std::vector<ColumnRun> runs;
};

Shape shape_of(const Outline& outline) {
    Shape shape{outline.width(), outline.height(), {}};
    for (int x = 0; x < outline.width(); ++x)
        for (int y = 0; y < outline.height(); ++y) {
            if (!outline.at(x, y)) continue;
            const int first = y;
            while (y < outline.height() && outline.at(x, y)) ++y;
            shape.runs.push_back({x, first, y});
        }
    // The longest rule most places out.
    std::ranges::stable_sort(shape.runs, std::greater<>(), [](const ColumnRun& run) { return run.end - run.first; });
    return shape;
}

/// What is taken of the plate.
class Plate {
public:
    explicit Plate(const std::array<int, 2>& size) : taken_(size[0], size[1]) {}

    /// The first free place in column `x`.
    [[nodiscard]] std::optional<int> free_row(const Shape& shape, int x) {
        blocked_.assign(std::size_t(taken_.words()), 0);
        for (const ColumnRun& run : shape.runs) {
            block(taken_.column(x + run.x), run);
            if (const auto row = first_free(shape); !row) return std::nullopt;
        }
        return first_free(shape);
    }
    void take(const Outline& outline, int x, int y) {
        for (int i = 0; i < outline.width(); ++i)
            for (int j = 0; j < outline.height(); ++j)
                if (outline.at(i, j)) taken_.set(x + i, y + j);
    }

private:
    /// Rows at which a run of cells would meet one that is taken: bit y is set where one of [y + first, y + end) is.
    void block(const std::uint64_t* column, const ColumnRun& run) {
        const std::size_t words = blocked_.size();
        meets_.assign(column, column + words);
        // Each round doubles how many cells upward a bit speaks for.
        int length = 1;
        for (const int wanted = run.end - run.first; length < wanted;) {
            const int more = std::min(length, wanted - length);
            or_shifted(meets_, meets_, more);
            length += more;
        }
        or_shifted(blocked_, meets_, run.first);
    }
    /// into |= from >> cells, in place too: words are read before they are written from the front on.
    static void or_shifted(std::vector<std::uint64_t>& into, const std::vector<std::uint64_t>& from, int cells) {
        const std::size_t skip = std::size_t(cells / word_bits), words = into.size();
        const int shift = cells % word_bits;
        for (std::size_t w = 0; w + skip < words; ++w) {
            std::uint64_t bits = from[w + skip] >> shift;
            if (shift > 0 && w + skip + 1 < words) bits |= from[w + skip + 1] << (word_bits - shift);
            into[w] |= bits;
        }
    }
    [[nodiscard]] std::optional<int> first_free(const Shape& shape) const {
        for (std::size_t w = 0; w < blocked_.size(); ++w) {
            if (blocked_[w] == ~std::uint64_t{0}) continue;
            const int row = int(w) * word_bits + std::countr_one(blocked_[w]);
            if (row + shape.height > taken_.height()) return std::nullopt;
            return row;
        }
        return std::nullopt;
    }
    Outline taken_;
    std::vector<std::uint64_t> blocked_, meets_;
};

/// An item as it is laid out.
struct Candidate {
    std::vector<Shape> grown;  ///< by turn
    const NestItem* item;
};

struct Nest {
    std::vector<std::optional<NestPlace>> places;
    std::size_t placed = 0;
    int columns = 0;             ///< that are taken
    std::uint64_t right_ends{};  ///< all added

    [[nodiscard]] bool better_than(const Nest& other) const {
        return std::tuple(other.placed, columns, right_ends) < std::tuple(placed, other.columns, other.right_ends);
    }
};

class Nester {
public:
    Nester(const std::vector<NestItem>& items, const std::array<int, 2>& plate, int gap_cells,
           const std::optional<Outline>& taken)
        : items_(items), gap_(gap_cells), size_{plate[0] + 2 * gap_cells, plate[1] + 2 * gap_cells}, empty_(size_) {
        // The plate has a margin of the gap all around, where grown outlines may reach into.
        if (taken) empty_.take(*taken, gap_, gap_);
        for (const NestItem& item : items) {
            Candidate candidate{{}, &item};
            // What is taken is as it is; what looks for room is grown: between two lies the gap, once.
            for (const Outline& outline : item.turns) candidate.grown.push_back(shape_of(outline.grown(gap_)));
            candidates_.push_back(std::move(candidate));
        }
    }

    [[nodiscard]] Nest in_order(const std::vector<std::size_t>& order) const {
        Plate plate = empty_;
        Nest nest;
        nest.places.resize(items_.size());
        std::map<std::size_t, int> turn_of_group;
        std::map<std::pair<std::size_t, int>, int> begin;  // where the last of a group stood: before it is no room
        for (const std::size_t p : order) {
            const auto turned = turn_of_group.find(items_[p].group);
            const auto found = place(plate, candidates_[p], turned == turn_of_group.end() ? -1 : turned->second, begin);
            if (!found) continue;
            const Outline& outline = items_[p].turns[std::size_t(found->turn)];
            turn_of_group[items_[p].group] = found->turn;
            begin[{items_[p].group, found->turn}] = found->x;
            nest.places[p] = *found;  // of the grown outline with the margin, and so of the outline on the plate
            ++nest.placed;
            nest.columns = std::max(nest.columns, found->x + outline.width());
            nest.right_ends += std::uint64_t(found->x + outline.width());
            plate.take(outline, found->x + gap_, found->y + gap_);
        }
        return nest;
    }

private:
    [[nodiscard]] std::optional<NestPlace> place(Plate& plate, const Candidate& candidate, int only,
                                                 const std::map<std::pair<std::size_t, int>, int>& begin) const {
        std::optional<NestPlace> best;
        int best_end = size_[0] + 1;
        for (int turn = 0; turn < int(candidate.grown.size()); ++turn) {
            if (only >= 0 && turn != only) continue;
            const Shape& shape = candidate.grown[std::size_t(turn)];
            const auto before = begin.find({candidate.item->group, turn});
            for (int x = before == begin.end() ? 0 : before->second; x + shape.width < best_end; ++x) {
                const std::optional<int> y = plate.free_row(shape, x);
                if (!y) continue;
                best = NestPlace{x, *y, turn};
                best_end = x + shape.width;
                break;
            }
        }
        return best;
    }

    const std::vector<NestItem>& items_;
    int gap_;
    std::array<int, 2> size_;
    Plate empty_;
    std::vector<Candidate> candidates_;
};

using Order = std::vector<std::size_t>;

/// Largest first, tallest first, as given; and, while that takes little, some by chance.
std::vector<Order> orders_of(const std::vector<NestItem>& items) {
    Order given(items.size());
    std::iota(given.begin(), given.end(), std::size_t{0});
    std::vector<Order> orders(3, given);
    std::ranges::stable_sort(orders[0], std::greater<>(), [&](std::size_t p) { return items[p].turns[0].area(); });
    std::ranges::stable_sort(orders[1], std::greater<>(), [&](std::size_t p) { return items[p].turns[0].height(); });
    constexpr std::size_t few = 60, by_chance = 21;
    if (items.size() > few) return orders;
    for (std::size_t n = 0; n < by_chance; ++n) {
        // The largest first, but for some: what is far down seldom moves to the front.
        RandomStream random(1, n);
        std::vector<std::pair<double, std::size_t>> keys;
        for (std::size_t i = 0; i < given.size(); ++i)
            keys.emplace_back(double(i) + random.uniform() * double(given.size()) / 3, orders[0][i]);
        std::ranges::sort(keys);
        Order order;
        for (const auto& key : keys) order.push_back(key.second);
        orders.push_back(std::move(order));
    }
    return orders;
}

}  // namespace

Outline::Outline(int width, int height)
    : width_(width),
      height_(height),
      words_((height + word_bits - 1) / word_bits),
      bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(width)) {
    VOXTONE_EXPECT(width > 0 && height > 0);
}

std::size_t Outline::area() const {
    return std::accumulate(bits_.begin(), bits_.end(), std::size_t{0},
                           [](std::size_t sum, std::uint64_t word) { return sum + std::size_t(std::popcount(word)); });
}

Outline Outline::grown(int cells) const {
    // By columns, then by rows: each cell is looked at twice, however wide the gap is.
    Outline taller(width_, height_ + 2 * cells), grown(width_ + 2 * cells, height_ + 2 * cells);
    for (int x = 0; x < width_; ++x)
        for (int y = 0, left = 0; y < taller.height_; ++y, --left) {
            if (y < height_ && at(x, y)) left = 2 * cells + 1;
            if (left > 0) taller.set(x, y);
        }
    for (int y = 0; y < grown.height_; ++y)
        for (int x = 0, left = 0; x < grown.width_; ++x, --left) {
            if (x < width_ && taller.at(x, y)) left = 2 * cells + 1;
            if (left > 0) grown.set(x, y);
        }
    return grown;
}

Outline Outline::turned(int right_angles) const {
    Outline turned = *this;
    for (int n = 0; n < right_angles; ++n) {
        Outline next(turned.height_, turned.width_);
        for (int x = 0; x < turned.width_; ++x)
            for (int y = 0; y < turned.height_; ++y)
                if (turned.at(x, y)) next.set(turned.height_ - 1 - y, x);
        turned = std::move(next);
    }
    return turned;
}

std::vector<std::optional<NestPlace>> nest(const std::vector<NestItem>& items, const std::array<int, 2>& plate,
                                           int gap_cells, const std::optional<Outline>& taken) {
    if (items.empty()) return {};
    const Nester nester(items, plate, gap_cells, taken);
    const std::vector<Order> orders = orders_of(items);
    std::vector<Nest> nests(orders.size());
    parallel_for(0, orders.size(), 1, [&](std::size_t n) { nests[n] = nester.in_order(orders[n]); });
    std::size_t best = 0;
    for (std::size_t n = 1; n < nests.size(); ++n)
        if (nests[n].better_than(nests[best])) best = n;
    return nests[best].places;
}

}  // namespace voxtone::slicer
