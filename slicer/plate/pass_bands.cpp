// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/pass_bands.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace voxtone::slicer {

namespace {

using Places = std::vector<std::optional<NestPlace>>;

/// x and y exchanged.
Outline exchanged(const Outline& outline) {
    Outline other(outline.height(), outline.width());
    for (int x = 0; x < outline.width(); ++x)
        for (int y = 0; y < outline.height(); ++y)
            if (outline.at(x, y)) other.set(y, x);
    return other;
}

/// Of the cells across the heads' way that are taken: [first, end); none: [0, 0).
std::pair<int, int> rows_taken(const std::optional<Outline>& taken) {
    int first = std::numeric_limits<int>::max(), end = 0;
    if (taken)
        for (int x = 0; x < taken->width(); ++x)
            for (int y = 0; y < taken->height(); ++y)
                if (taken->at(x, y)) first = std::min(first, y), end = std::max(end, y + 1);
    return end == 0 ? std::pair(0, 0) : std::pair(first, end);
}

/// No band is narrower in which all could lie: neither than the widest, nor than all areas side by side.
int least_rows(const std::vector<NestItem>& items, const std::array<int, 2>& plate) {
    double area = 0;
    int widest = 1;
    for (const NestItem& item : items) {
        int narrow = std::numeric_limits<int>::max();
        for (const Outline& outline : item.turns) narrow = std::min(narrow, outline.height());
        widest = std::max(widest, narrow);
        area += static_cast<double>(item.turns[0].area());
    }
    return std::max(widest, static_cast<int>(area / plate[0]));
}

bool all_placed(const Places& places) {
    return std::ranges::all_of(places, [](const auto& place) { return place.has_value(); });
}

/// With what lies beyond the rows [first, end) taken, too.
Outline closed_beyond(const std::optional<Outline>& taken, const std::array<int, 2>& plate, int first, int end) {
    Outline closed = taken ? *taken : Outline(plate[0], plate[1]);
    for (int x = 0; x < plate[0]; ++x)
        for (int y = 0; y < plate[1]; ++y)
            if (y < first || y >= end) closed.set(x, y);
    return closed;
}

/// A gap is left between parts, and none at the band's edge: the part next door is beyond it by itself.
Places nest_in_band(const std::vector<NestItem>& items, const std::array<int, 2>& plate, int gap_cells,
                    const std::optional<Outline>& taken, int first, int end) {
    if (!taken) {
        Places places = nest(items, {plate[0], end - first}, gap_cells);
        for (auto& place : places)
            if (place) place->y += first;
        return places;
    }
    return nest(items, plate, gap_cells, closed_beyond(taken, plate, first - gap_cells, end + gap_cells));
}

Places nest_along_x(const std::vector<NestItem>& items, const std::array<int, 2>& plate, int gap_cells,
                    const std::optional<Outline>& taken, int strip) {
    const auto [first_taken, end_taken] = rows_taken(taken);
    const int least = std::max(least_rows(items, plate), end_taken - first_taken);
    for (int rows = (least + strip - 1) / strip * strip; rows < plate[1]; rows += strip) {
        const int first = std::max(0, std::min(first_taken, plate[1] - rows));
        Places places = nest_in_band(items, plate, gap_cells, taken, first, first + rows);
        if (all_placed(places)) return places;
    }
    return nest(items, plate, gap_cells, taken);
}

}  // namespace

Places nest_in_passes(const std::vector<NestItem>& items, const std::array<int, 2>& plate, int gap_cells,
                      const std::optional<Outline>& taken, const PassBands& bands) {
    if (items.empty() || bands.width_cells == 0) return nest(items, plate, gap_cells, taken);
    if (bands.along == 0) return nest_along_x(items, plate, gap_cells, taken, bands.width_cells);
    std::vector<NestItem> across = items;
    for (NestItem& item : across)
        for (Outline& outline : item.turns) outline = exchanged(outline);
    const std::optional<Outline> taken_across = taken ? std::optional(exchanged(*taken)) : std::nullopt;
    Places places = nest_along_x(across, {plate[1], plate[0]}, gap_cells, taken_across, bands.width_cells);
    for (auto& place : places)
        if (place) std::swap(place->x, place->y);
    return places;
}

}  // namespace voxtone::slicer
