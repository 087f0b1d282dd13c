// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/type_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

constexpr double readable_contrast = 0.5, readable_part = 0.6;
constexpr double capitals = 0.72, x_height = 0.5;  // of a face
constexpr double most_height_mm = 6;               // of a face of 24 pt
constexpr std::size_t least_mates = 3;
constexpr double mm_per_pt = 25.4 / 72;

struct Glyph {
    std::vector<std::uint32_t> cells;
    double width_mm = 0, height_mm = 0, area_mm2 = 0, size_mm = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double contrast = 0, contrast_asked = 0;
    bool is_read = true;
};

/// What the cells of a surface are to type: ground, or what may stand on it.
class TypeFinder {
public:
    explicit TypeFinder(const JobPrediction& p) : p_(p), cells_(p.predicted.surface), ground_(p.target.size(), none) {
        for (std::size_t r = 0; r < p.seen.regions.size(); ++r)
            if (p.seen.regions[r].kind != halftone::RegionKind::strokes)
                for (const std::uint32_t cell : p.seen.regions[r].cells) ground_[cell] = static_cast<int>(r);
    }

    /// Besides, what hangs together on a ground and is no letter, as fine lines side by side are.
    std::vector<std::vector<std::uint32_t>> patterns;

    [[nodiscard]] std::vector<Glyph> letters() {
        std::vector<Glyph> found;
        std::vector<char> taken(ground_.size());
        for (std::uint32_t first = 0; first < ground_.size(); ++first) {
            if (taken[first] || ground_[first] != none) continue;
            Glyph letter;
            int on = none;
            if (!collect(first, taken, letter.cells, on)) continue;
            if (measure(letter, on))
                found.push_back(std::move(letter));
            else
                patterns.push_back(std::move(letter.cells));
        }
        keep_type(found, patterns);
        return found;
    }

private:
    static constexpr int none = -1;

    /// All that hangs together with a cell and is no ground. False where it lies between different grounds, or on none.
    bool collect(std::uint32_t first, std::vector<char>& taken, std::vector<std::uint32_t>& piece, int& on) const {
        bool between = false;
        piece.push_back(first), taken[first] = 1;
        for (std::size_t next = 0; next < piece.size(); ++next)
            cells_.visit_around(piece[next], [&](std::size_t other) {
                if (ground_[other] != none) {
                    between = between || (on != none && ground_[other] != on);
                    on = ground_[other];
                } else if (!taken[other]) {
                    taken[other] = 1;
                    piece.push_back(static_cast<std::uint32_t>(other));
                }
            });
        return on != none && !between;
    }

    [[nodiscard]] Eigen::Vector3d centre(std::uint32_t cell) const {
        const auto& [x, y, z] = p_.predicted.surface.cells[cell].centre_mm;
        return Eigen::Vector3f(x, y, z).cast<double>();
    }

    /// False where it cannot be a letter.
    bool measure(Glyph& letter, int on) const {
        constexpr std::size_t least_cells = 3;
        constexpr float differs = 0.12f;  // Oklab's lightness: the faintest type that anybody sets
        constexpr double line_mm = 0.3, line_aspect = 12;
        if (letter.cells.size() < least_cells) return false;
        const auto lightness = [](const Eigen::Vector3f& rgb) {
            return float(optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0))[0]);
        };
        const float ground = lightness(p_.seen.regions[std::size_t(on)].target);
        std::vector<float> apart;
        for (const std::uint32_t cell : letter.cells) {
            apart.push_back(std::abs(lightness(p_.target[cell]) - ground));
            letter.middle += centre(cell) / double(letter.cells.size());
            letter.area_mm2 += double(p_.predicted.surface.cells[cell].area_mm2);
        }
        const float most = std::ranges::max(apart);
        // Cells that its edge only touches make it no higher.
        Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (std::size_t n = 0; n < apart.size(); ++n) {
            if (apart[n] < most / 2) continue;
            const Eigen::Vector2d at = centre(letter.cells[n]).head<2>();
            low = low.cwiseMin(at), high = high.cwiseMax(at);
        }
        const double cell_mm = std::sqrt(letter.area_mm2 / double(letter.cells.size()));
        letter.width_mm = high.x() - low.x() + cell_mm, letter.height_mm = high.y() - low.y() + cell_mm;
        const double narrow = std::min(letter.width_mm, letter.height_mm),
                     wide = std::max(letter.width_mm, letter.height_mm);
        return most >= differs && letter.height_mm <= most_height_mm &&
               !(narrow < line_mm && wide > line_aspect * narrow);
    }

    /// Those that stand among others of their size, with the size of their face.
    static void keep_type(std::vector<Glyph>& letters, std::vector<std::vector<std::uint32_t>>& others) {
        constexpr double alike = 1.8, reach = 4, percentile = 0.8;
        std::ranges::stable_sort(letters, {}, [](const Glyph& letter) { return letter.middle.x(); });
        const double widest = letters.empty() ? 0 : std::ranges::max_element(letters, {}, &Glyph::width_mm)->width_mm;
        for (Glyph& letter : letters) {
            std::vector<double> heights;
            const double farthest = reach * alike * letter.height_mm + widest;
            const auto begin = std::ranges::lower_bound(letters, letter.middle.x() - farthest, {},
                                                        [](const Glyph& other) { return other.middle.x(); });
            for (auto other = begin; other != letters.end() && other->middle.x() <= letter.middle.x() + farthest;
                 ++other) {
                const double ratio = other->height_mm / letter.height_mm;
                const double apart = (other->middle - letter.middle).norm();
                if (ratio <= alike && ratio * alike >= 1 &&
                    apart <= reach * letter.height_mm + (letter.width_mm + other->width_mm) / 2)
                    heights.push_back(other->height_mm);
            }
            if (heights.size() <= least_mates) continue;
            const auto at = heights.begin() + std::ptrdiff_t(percentile * double(heights.size() - 1));
            std::nth_element(heights.begin(), at, heights.end());
            letter.size_mm = *at / capitals;
        }
        for (const Glyph& letter : letters)
            if (letter.size_mm == 0) others.push_back(letter.cells);
        std::erase_if(letters, [](const Glyph& letter) { return letter.size_mm == 0; });
    }

    const JobPrediction& p_;
    halftone::CellNeighbours cells_;
    std::vector<int> ground_;  ///< number of a flat region
};

double luminance_of(const JobPrediction& p, const std::vector<Eigen::Vector3f>& rgb,
                    const std::vector<std::uint32_t>& cells) {
    double sum = 0, area = 0;
    for (const std::uint32_t i : cells) {
        const double a = p.predicted.surface.cells[i].area_mm2;
        sum += a * double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb[i].cwiseMax(0)));
        area += a;
    }
    return area > 0 ? sum / area : 0;
}

double contrast_of(double a, double b) { return a + b > 0 ? std::abs(a - b) / (a + b) : 0; }

/// What lies around each letter, nearer to it than to any other.
std::vector<std::vector<std::uint32_t>> grounds_of(const JobPrediction& p, const std::vector<Glyph>& letters) {
    constexpr double around_mm = 0.5;
    const halftone::CellNeighbours cells(p.predicted.surface);
    const double edge_mm = letters.empty() ? 1 : std::sqrt(letters[0].area_mm2 / double(letters[0].cells.size()));
    std::vector<std::vector<std::uint32_t>> grounds(letters.size());
    std::vector<char> taken(p.target.size());
    std::vector<std::pair<std::uint32_t, std::size_t>> last, next;  // a cell, and whose
    for (std::size_t n = 0; n < letters.size(); ++n)
        for (const std::uint32_t cell : letters[n].cells) {
            taken[cell] = 1;
            last.emplace_back(cell, n);
        }
    for (int step = std::max(1, int(std::lround(around_mm / edge_mm))); step > 0; --step, std::swap(last, next)) {
        next.clear();
        for (const auto& [cell, owner] : last)
            cells.visit_around(cell, [&, whose = owner](std::size_t other) {
                if (taken[other]) return;
                taken[other] = 1;
                next.emplace_back(static_cast<std::uint32_t>(other), whose);
                grounds[whose].push_back(static_cast<std::uint32_t>(other));
            });
    }
    return grounds;
}

/// Between sizes, the fewest letters on the wrong side.
double dividing_size(std::span<const Glyph> by_size) {
    std::size_t wrong = 0;  // with nothing said to be unreadable
    for (const Glyph& letter : by_size) wrong += !letter.is_read;
    std::size_t best = wrong, at = 0;
    for (std::size_t n = 0; n < by_size.size(); ++n) {
        wrong = by_size[n].is_read ? wrong + 1 : wrong - 1;
        if (wrong < best) best = wrong, at = n + 1;
    }
    if (at == 0) return 0;
    if (at == by_size.size()) return by_size.back().size_mm;
    return (by_size[at - 1].size_mm + by_size[at].size_mm) / 2;
}

}  // namespace

std::optional<TypeSize> unreadable_type(const JobPrediction& p, double viewing_distance_mm) {
    constexpr double minutes = 5 * 3.14159265358979323846 / 180 / 60;
    std::vector<Glyph> letters = TypeFinder(p).letters();
    const std::vector<std::vector<std::uint32_t>> grounds = grounds_of(p, letters);
    for (std::size_t n = 0; n < letters.size(); ++n) {
        Glyph& letter = letters[n];
        const auto contrast = [&](const std::vector<Eigen::Vector3f>& rgb) {
            return contrast_of(luminance_of(p, rgb, letter.cells), luminance_of(p, rgb, grounds[n]));
        };
        letter.contrast_asked = contrast(p.target), letter.contrast = contrast(p.predicted.rgb);
        letter.is_read = letter.contrast >= std::min(readable_contrast, readable_part * letter.contrast_asked) &&
                         (letter.contrast_asked < readable_contrast || letter.contrast >= readable_contrast) &&
                         x_height * letter.size_mm >= viewing_distance_mm * minutes;
    }
    std::ranges::stable_sort(letters, {}, &Glyph::size_mm);
    TypeSize type;
    type.below_mm = dividing_size(letters);
    if (type.below_mm == 0) return std::nullopt;
    type.letters = letters.size();
    type.smallest_mm = letters.front().size_mm, type.largest_mm = letters.back().size_mm;
    std::vector<const Glyph*> unread;
    for (const Glyph& letter : letters)
        if (!letter.is_read && letter.size_mm <= type.below_mm) unread.push_back(&letter);
    if (unread.size() <= least_mates) return std::nullopt;
    type.unread = unread.size();
    for (const Glyph* letter : unread) {
        type.unread_mm2 += letter->area_mm2;
        type.contrast += letter->contrast / double(unread.size());
        type.contrast_asked += letter->contrast_asked / double(unread.size());
    }
    type.cell = unread[unread.size() / 2]->cells.front();
    return type;
}

std::optional<LostLines> lost_lines(const JobPrediction& p) {
    constexpr float differs = 0.1f;  // Oklab's lightness
    constexpr double enough = 0.6, least_mm2 = 1, all_fine = 0.25;
    TypeFinder finder(p);
    (void)finder.letters();
    const halftone::CellNeighbours cells(p.predicted.surface);
    const auto lightness = [](const Eigen::Vector3f& rgb) {
        return float(optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0))[0]);
    };
    LostLines lost;
    double asked_of_all = 0, kept_of_all = 0;
    for (const std::vector<std::uint32_t>& pattern : finder.patterns) {
        std::vector<std::uint32_t> fine;
        double area_mm2 = 0, asked = 0, kept = 0;
        for (const std::uint32_t cell : pattern) {
            float target = 0, print = 0;
            int around = 0;
            cells.visit_around(cell, [&](std::size_t other) {
                target += lightness(p.target[other]), print += lightness(p.predicted.rgb[other]);
                ++around;
            });
            if (around == 0) continue;
            target = lightness(p.target[cell]) - target / float(around);
            print = lightness(p.predicted.rgb[cell]) - print / float(around);
            if (std::abs(target) < differs) continue;
            const double area = double(p.predicted.surface.cells[cell].area_mm2);
            fine.push_back(cell);
            area_mm2 += area, asked += area * double(std::abs(target)),
                kept += area * double(target > 0 ? print : -print);
        }
        if (double(fine.size()) < all_fine * double(pattern.size()) || kept >= enough * asked) continue;
        lost.cells.insert(lost.cells.end(), fine.begin(), fine.end());
        lost.area_mm2 += area_mm2, asked_of_all += asked, kept_of_all += kept;
    }
    if (lost.area_mm2 < least_mm2) return std::nullopt;
    lost.kept = std::max(0.0, kept_of_all / asked_of_all);
    return lost;
}

std::string type_size_text(double mm) {
    const double pt = mm / mm_per_pt;
    return fmt::format("{:.1f} mm ({:g} pt)", mm, pt < 4 ? std::round(2 * pt) / 2 : std::round(pt));
}

}  // namespace voxtone::slicer
