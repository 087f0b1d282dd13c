// SPDX-License-Identifier: GPL-3.0-or-later
//
// Some layers of a body as spans of voxels: for each row (j, k) the voxels that belong to it, as sorted, disjoint,
// non-touching half-open ranges of i. Uniform stretches cost nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace voxtone::slicer {

struct Span {
    std::int32_t begin;
    std::int32_t end;  ///< past the last voxel
    friend bool operator==(const Span&, const Span&) = default;
};

class SpanSlab {
public:
    /// Starts an empty slab of the layers [k_begin, k_end) with `rows` rows each; rows are appended j first, then k.
    void reset(int k_begin, int k_end, int rows) {
        k_begin_ = k_begin;
        k_end_ = k_end;
        rows_ = rows;
        spans_.clear();
        row_begin_.assign(1, 0);
        row_begin_.reserve(std::size_t(k_end - k_begin) * std::size_t(rows) + 1);
    }
    /// Appends a span to the row under construction; begins at or after the end of the last one and merges with it
    /// where they touch. Empty spans are ignored.
    void push(std::int32_t begin, std::int32_t end) {
        if (begin >= end) return;
        if (spans_.size() > row_begin_.back() && spans_.back().end >= begin)
            spans_.back().end = end > spans_.back().end ? end : spans_.back().end;
        else
            spans_.push_back({begin, end});
    }
    void end_row() { row_begin_.push_back(spans_.size()); }

    [[nodiscard]] int k_begin() const { return k_begin_; }
    [[nodiscard]] int k_end() const { return k_end_; }
    [[nodiscard]] int rows() const { return rows_; }
    /// k in [k_begin, k_end).
    [[nodiscard]] std::span<const Span> row(int j, int k) const {
        const std::size_t r = std::size_t(k - k_begin_) * std::size_t(rows_) + std::size_t(j);
        return {spans_.data() + row_begin_[r], spans_.data() + row_begin_[r + 1]};
    }
    [[nodiscard]] bool contains(int i, int j, int k) const {
        for (const Span& s : row(j, k))
            if (i < s.end) return i >= s.begin;
        return false;
    }
    /// Voxels of one layer.
    [[nodiscard]] std::uint64_t voxels_of_layer(int k) const {
        std::uint64_t n = 0;
        for (int j = 0; j < rows_; ++j)
            for (const Span& s : row(j, k)) n += std::uint64_t(s.end - s.begin);
        return n;
    }
    friend bool operator==(const SpanSlab&, const SpanSlab&) = default;

private:
    int k_begin_ = 0, k_end_ = 0, rows_ = 0;
    std::vector<Span> spans_;
    std::vector<std::size_t> row_begin_{0};
};

}  // namespace voxtone::slicer
