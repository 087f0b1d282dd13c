// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/huffman_code.h"

#include <algorithm>
#include <array>

#include "base/contracts.h"

namespace voxtone::io {

std::vector<std::uint8_t> huffman_lengths(std::span<const std::uint64_t> counts, int limit) {
    std::vector<std::uint8_t> lengths(counts.size(), 0);
    std::vector<std::uint32_t> symbols;
    for (std::uint32_t s = 0; s < counts.size(); ++s)
        if (counts[s]) symbols.push_back(s);
    const std::size_t n = symbols.size();
    VOXTONE_EXPECT(limit >= 1 && limit < 32 && n <= (std::size_t{1} << limit));
    if (n == 0) return lengths;
    if (n == 1) {
        lengths[symbols[0]] = 1;
        return lengths;
    }
    std::stable_sort(symbols.begin(), symbols.end(), [&](auto a, auto b) { return counts[a] < counts[b]; });

    // Level by level, from the longest words: the packages of a level are the pairs of the level before. Only whether
    // an item is a leaf has to be kept, since leaves enter in sorted order.
    std::vector<std::vector<bool>> is_leaf(static_cast<std::size_t>(limit));
    std::vector<std::uint64_t> previous, weights;
    for (auto& flags : is_leaf) {
        weights.clear();
        std::size_t leaf = 0, pair = 0;
        const std::size_t pairs = previous.size() / 2;
        while (leaf < n || pair < pairs) {
            const std::uint64_t package = pair < pairs ? previous[2 * pair] + previous[2 * pair + 1] : 0;
            const bool take_leaf = leaf < n && (pair == pairs || counts[symbols[leaf]] <= package);
            weights.push_back(take_leaf ? counts[symbols[leaf++]] : package);
            if (!take_leaf) ++pair;
            flags.push_back(take_leaf);
        }
        previous.swap(weights);
    }
    // The first 2n - 2 items of the last level are chosen; each chosen package opens two items of the level below.
    std::size_t chosen = 2 * n - 2;
    for (auto level = is_leaf.rbegin(); level != is_leaf.rend(); ++level) {
        std::size_t leaves = 0;
        for (std::size_t i = 0; i < chosen; ++i) leaves += (*level)[i];
        for (std::size_t i = 0; i < leaves; ++i) ++lengths[symbols[i]];
        chosen = 2 * (chosen - leaves);
    }
    return lengths;
}

std::vector<CodeWord> canonical_code(std::span<const std::uint8_t> lengths) {
    std::array<std::uint32_t, 16> count{}, next{};
    for (const auto length : lengths) {
        VOXTONE_EXPECT(length <= 15);
        ++count[length];
    }
    count[0] = 0;
    for (std::size_t bits = 1; bits < next.size(); ++bits) next[bits] = (next[bits - 1] + count[bits - 1]) << 1;
    std::vector<CodeWord> words(lengths.size());
    for (std::size_t s = 0; s < lengths.size(); ++s) {
        const std::uint32_t length = lengths[s];
        if (length == 0) continue;
        std::uint32_t code = next[length]++, reversed = 0;
        for (std::uint32_t i = 0; i < length; ++i, code >>= 1) reversed = (reversed << 1) | (code & 1);
        words[s] = {reversed, length};
    }
    return words;
}

void put_dynamic_header(BitWriter& out, bool last_block, std::span<const std::uint8_t> literal_lengths,
                        std::span<const std::uint8_t> distance_lengths) {
    auto used = [](std::span<const std::uint8_t> lengths, std::size_t least) {
        std::size_t n = lengths.size();
        while (n > least && lengths[n - 1] == 0) --n;
        return n;
    };
    const std::size_t literals = used(literal_lengths, 257), distances = used(distance_lengths, 1);
    VOXTONE_EXPECT(literals <= 286 && distances <= 30 && literal_lengths.size() >= 257 && !distance_lengths.empty());

    std::vector<std::uint8_t> all(literal_lengths.begin(),
                                  literal_lengths.begin() + static_cast<std::ptrdiff_t>(literals));
    all.insert(all.end(), distance_lengths.begin(), distance_lengths.begin() + static_cast<std::ptrdiff_t>(distances));

    struct Item {
        std::uint8_t symbol, extra, extra_bits;
    };
    std::vector<Item> items;
    for (std::size_t i = 0; i < all.size();) {
        std::size_t run = 1;
        while (i + run < all.size() && all[i + run] == all[i]) ++run;
        std::size_t left = run;
        auto repeat = [&](std::size_t least, std::size_t most, std::uint8_t symbol, std::uint8_t bits) {
            while (left >= least) {
                const std::size_t n = std::min(left, most);
                items.push_back({symbol, static_cast<std::uint8_t>(n - least), bits});
                left -= n;
            }
        };
        if (all[i] == 0) {
            repeat(11, 138, 18, 7);
            repeat(3, 10, 17, 3);
        } else {
            items.push_back({all[i], 0, 0});
            --left;
            repeat(3, 6, 16, 2);
        }
        for (; left > 0; --left) items.push_back({all[i], 0, 0});
        i += run;
    }
    std::array<std::uint64_t, 19> counts{};
    for (const auto& item : items) ++counts[item.symbol];
    auto lengths = huffman_lengths(counts, 7);
    // A decoder rejects an incomplete code of code lengths, so a lonely symbol gets a partner.
    if (std::count_if(lengths.begin(), lengths.end(), [](auto l) { return l > 0; }) == 1)
        lengths[lengths[0] ? 1 : 0] = 1;
    const auto words = canonical_code(lengths);

    static constexpr std::array<std::uint8_t, 19> order = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                           11, 4,  12, 3, 13, 2, 14, 1, 15};
    std::size_t code_lengths = order.size();
    while (code_lengths > 4 && lengths[order[code_lengths - 1]] == 0) --code_lengths;
    out.put(last_block ? 1 : 0, 1);
    out.put(2, 2);
    out.put(literals - 257, 5);
    out.put(distances - 1, 5);
    out.put(code_lengths - 4, 4);
    for (std::size_t i = 0; i < code_lengths; ++i) out.put(lengths[order[i]], 3);
    for (const auto& item : items) {
        out.put(words[item.symbol]);
        out.put(item.extra, item.extra_bits);
    }
}

}  // namespace voxtone::io
