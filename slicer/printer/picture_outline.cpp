// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/picture_outline.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

/// Alpha at the middles of pixels, or of squares of them; nothing beyond.
class AlphaGrid {
public:
    AlphaGrid(std::span<const std::uint16_t> alpha, std::uint32_t width_px, std::uint32_t height_px,
              std::uint32_t step_px)
        : width((width_px + step_px - 1) / step_px), height((height_px + step_px - 1) / step_px), step(step_px) {
        value_.resize(std::size_t(width) * std::size_t(height));
        for (std::int64_t y = 0; y < height; ++y)
            for (std::int64_t x = 0; x < width; ++x) {
                std::uint64_t sum = 0;
                const auto in_x = std::min<std::uint64_t>(step, width_px - std::uint64_t(x) * step),
                           in_y = std::min<std::uint64_t>(step, height_px - std::uint64_t(y) * step);
                for (std::uint64_t j = 0; j < in_y; ++j)
                    for (std::uint64_t i = 0; i < in_x; ++i)
                        sum += alpha[(std::uint64_t(y) * step + j) * width_px + std::uint64_t(x) * step + i];
                value_[std::size_t(y * width + x)] = float(double(sum) / double(in_x * in_y) / 65535);
            }
    }
    /// (-1, -1) to (width, height).
    [[nodiscard]] float at(std::int64_t x, std::int64_t y) const {
        return x < 0 || y < 0 || x >= width || y >= height ? 0 : value_[std::size_t(y * width + x)];
    }

    std::int64_t width, height;
    std::uint32_t step;

private:
    std::vector<float> value_;
};

constexpr float half = 0.5f;

/// Crossings by the edge of the grid that they lie on, and which crossing comes after each.
class Crossings {
public:
    explicit Crossings(const AlphaGrid& grid) : grid_(grid) {
        for (std::int64_t y = -1; y < grid.height; ++y)
            for (std::int64_t x = -1; x < grid.width; ++x) add_cell(x, y);
    }

    [[nodiscard]] std::vector<Outline> outlines() const {
        std::vector<Outline> made;
        std::vector<bool> is_done(points_.size());
        for (std::uint32_t first = 0; first < points_.size(); ++first) {
            if (is_done[first]) continue;
            Outline outline;
            for (std::uint32_t p = first; !is_done[p]; p = next_[p]) {
                is_done[p] = true;
                outline.push_back(points_[p]);
            }
            made.push_back(without_straight(outline));
        }
        return made;
    }

private:
    /// Of a cell between four middles: edges 0 above, 1 right, 2 below, 3 left.
    std::uint32_t crossing(std::int64_t x, std::int64_t y, int edge) {
        const std::int64_t i = x + (edge == 1), j = y + (edge == 2);
        const bool upright = edge % 2 == 1;
        const auto key = std::uint64_t(2 * ((j + 1) * (grid_.width + 2) + i + 1) + (upright ? 1 : 0));
        const auto [entry, is_new] = of_edge_.try_emplace(key, std::uint32_t(points_.size()));
        if (is_new) {
            const float a = grid_.at(i, j), b = upright ? grid_.at(i, j + 1) : grid_.at(i + 1, j);
            constexpr double apart = 0.02;
            const double t = std::clamp(double(half - a) / double(b - a), apart, 1 - apart);
            points_.emplace_back((double(i) + 0.5 + (upright ? 0 : t)) * grid_.step,
                                 (double(j) + 0.5 + (upright ? t : 0)) * grid_.step);
            next_.push_back(0);
        }
        return entry->second;
    }

    /// What is opaque lies on one side of all ways from one crossing to the next.
    void add_cell(std::int64_t x, std::int64_t y) {
        const std::array<float, 4> alpha{grid_.at(x, y), grid_.at(x + 1, y), grid_.at(x + 1, y + 1),
                                         grid_.at(x, y + 1)};  // around the cell: corner k lies before edge k
        unsigned inside = 0;
        for (unsigned k = 0; k < 4; ++k) inside |= alpha[k] >= half ? 1u << k : 0u;
        if (inside == 0 || inside == 15) return;
        const auto is_in = [&](int k) { return (inside >> (k & 3) & 1u) != 0; };
        const bool is_one = (alpha[0] + alpha[1] + alpha[2] + alpha[3]) / 4 >= half;
        const bool is_saddle = inside == 5 || inside == 10;
        for (int edge = 0; edge < 4; ++edge) {
            if (!is_in(edge) || is_in(edge + 1)) continue;  // here one leaves what is opaque, going around
            int to = edge;
            if (is_saddle && !is_one)
                to = edge + 3;  // around the one corner
            else if (is_saddle)
                to = edge + 1;  // around the gap
            else
                while (is_in(to) == is_in(to + 1) || to == edge) ++to;
            const std::uint32_t from = crossing(x, y, edge), then = crossing(x, y, to & 3);
            next_[from] = then;
        }
    }

    static Outline without_straight(const Outline& outline) {
        Outline kept;
        const std::size_t n = outline.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Eigen::Vector2d before = outline[i] - outline[(i + n - 1) % n],
                                  after = outline[(i + 1) % n] - outline[i];
            if (before.x() * after.y() != before.y() * after.x()) kept.push_back(outline[i]);
        }
        return kept;
    }

    const AlphaGrid& grid_;
    std::vector<Eigen::Vector2d> points_;
    std::vector<std::uint32_t> next_;
    std::unordered_map<std::uint64_t, std::uint32_t> of_edge_;
};

}  // namespace

std::vector<Outline> picture_outlines(std::span<const std::uint16_t> alpha, std::uint32_t width_px,
                                      std::uint32_t height_px, std::uint32_t step_px) {
    VOXTONE_EXPECT(step_px > 0 && alpha.size() == std::size_t{width_px} * height_px);
    const AlphaGrid grid(alpha, width_px, height_px, step_px);
    return Crossings(grid).outlines();
}

}  // namespace voxtone::slicer
