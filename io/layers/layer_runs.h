// SPDX-License-Identifier: GPL-3.0-or-later
//
// One printed layer as runs of equal material: the form in which layers are made, counted, drawn and encoded, so that
// uniform stretches (air, core) cost next to nothing.
//
// Material 0 is the background (nothing is printed); material m >= 1 is resin m - 1 of the stack's list.
// Runs are in bitmap order: rows from the top (largest y), columns along +x; a row's lengths add up to `width_px`, and
// no two neighbouring runs of a row are of the same material.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace voxtone::io {

using Material = std::uint8_t;
inline constexpr Material background = 0;
/// More resins than any printer carries; 0 is the background.
inline constexpr int max_materials = 16;

struct Run {
    std::uint16_t length;  ///< px, >= 1
    std::uint16_t material;
    friend bool operator==(const Run&, const Run&) = default;
};

class LayerRuns {
public:
    /// An empty layer; rows are appended from the top. Sizes in [1, 65535] px.
    LayerRuns(std::uint32_t width_px, std::uint32_t height_px);

    [[nodiscard]] std::uint32_t width_px() const { return width_px_; }
    [[nodiscard]] std::uint32_t height_px() const { return height_px_; }
    [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(row_begin_.size() - 1); }
    [[nodiscard]] std::span<const Run> row(std::uint32_t y) const {
        return {runs_.data() + row_begin_[y], runs_.data() + row_begin_[y + 1]};
    }

    /// Appends pixels to the row under construction; merges with the last run where the material is the same.
    void push(std::uint32_t length, Material material) {
        if (length == 0) return;
        if (runs_.size() > row_begin_.back() && runs_.back().material == material)
            runs_.back().length = static_cast<std::uint16_t>(runs_.back().length + length);
        else
            runs_.push_back({static_cast<std::uint16_t>(length), material});
    }
    /// Closes the row; its lengths must add up to the width.
    void end_row();
    void clear();

private:
    std::uint32_t width_px_, height_px_;
    std::vector<Run> runs_;
    std::vector<std::size_t> row_begin_{0};
};

}  // namespace voxtone::io
