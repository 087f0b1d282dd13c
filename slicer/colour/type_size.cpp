// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/type_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "optics/colour/colour.h"
#include "slicer/colour/type_rows.h"

namespace voxtone::slicer {

namespace {

constexpr double readable_contrast = 0.5, readable_part = 0.6;
/// Reading acuity of normal eyes, logMAR, by the part of the paper's light that a letter lacks (Fujita et al. 2008).
constexpr std::array<std::pair<double, double>, 4> reading_acuity{{{0.1, 0.26}, {0.2, 0.13}, {0.4, 0.03}, {1, -0.08}}};
constexpr double capitals = 0.72, x_height = 0.5;  // of a face
constexpr std::size_t least_letters = 4;
constexpr double ground_within_mm = 0.5;
constexpr double mm_per_pt = 25.4 / 72;

struct Glyph {
    double size_mm = 0;  // of its face
    double area_mm2 = 0;
    double contrast = 0, contrast_asked = 0;
    bool is_read = true, is_pale = false;
    Eigen::AlignedBox2d box;  // of slabs, in parts of the page
    std::uint32_t cell = 0;   // of its ink, of the print
    Eigen::Vector3f asked = Eigen::Vector3f::Zero();
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

double lightness(const Eigen::Vector3f& rgb) {
    return optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0))[0];
}

double contrast_of(double a, double b) { return a + b > 0 ? std::abs(a - b) / (a + b) : 0; }

/// What lies around each letter, nearer to it than to any other.
std::vector<std::vector<std::uint32_t>> grounds_of(const JobPrediction& p, const std::vector<Letter>& letters) {
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
    for (int step = std::max(1, int(std::lround(ground_within_mm / edge_mm))); step > 0;
         --step, std::swap(last, next)) {
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

/// How far cells of a picture are in lightness, of target and print, from what lies in a square around them.
class LocalDetail {
public:
    LocalDetail(const JobPrediction& p, double times) : p_(p) {
        const auto& cells = p.predicted.surface.cells;
        for (std::size_t a = 0; a < 2; ++a) {
            const auto [low, high] =
                std::ranges::minmax(cells, {}, [&](const optics::SurfaceCell& cell) { return cell.cell[a]; });
            low_[a] = low.cell[a], size_[a] = high.cell[a] - low.cell[a] + 1;
            half_[a] = std::max(1, int(std::lround(times * ground_within_mm * 1e3 / p.cell_um[a])));
        }
        sums_.assign(std::size_t(size_[0] + 1) * std::size_t(size_[1] + 1), Eigen::Vector3d::Zero());
        light_.reserve(cells.size());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            light_.push_back({lightness(p.target[i]), lightness(p.predicted.rgb[i]), 1});
            sum(cells[i].cell[0] - low_[0] + 1, cells[i].cell[1] - low_[1] + 1) += light_.back();
        }
        for (int y = 1; y <= size_[1]; ++y)
            for (int x = 1; x <= size_[0]; ++x) sum(x, y) += sum(x - 1, y) + sum(x, y - 1) - sum(x - 1, y - 1);
    }
    [[nodiscard]] Eigen::Vector2d at(std::size_t i) const {
        std::array<int, 2> from{}, to{};
        for (std::size_t a = 0; a < 2; ++a) {
            const int here = p_.predicted.surface.cells[i].cell[a] - low_[a];
            from[a] = std::max(0, here - half_[a]), to[a] = std::min(size_[a], here + half_[a] + 1);
        }
        const Eigen::Vector3d around =
            sum(to[0], to[1]) - sum(from[0], to[1]) - sum(to[0], from[1]) + sum(from[0], from[1]);
        return (light_[i] - around / around[2]).head<2>();
    }

private:
    [[nodiscard]] const Eigen::Vector3d& sum(int x, int y) const {
        return sums_[std::size_t(y) * std::size_t(size_[0] + 1) + std::size_t(x)];
    }
    [[nodiscard]] Eigen::Vector3d& sum(int x, int y) {
        return sums_[std::size_t(y) * std::size_t(size_[0] + 1) + std::size_t(x)];
    }
    const JobPrediction& p_;
    std::array<int, 2> low_{}, size_{}, half_{};
    std::vector<Eigen::Vector3d> light_, sums_;  // target, print, how many cells
};

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

/// 1 where twenty times as large is not enough: then size is no cure. The palest tenth is left out: it is read at no
/// size that anybody prints.
double times_to_be_read(std::span<const Glyph* const> letters, double viewing_distance_mm) {
    double times = 1;
    const auto palest = std::ptrdiff_t(letters.size() / 10);
    // Of a map's names in prints of 20, 30 and 40 mm 0.027, 0.053 and 0.075 was seen, of a label's of 16 mm 0.015 and
    // of 32 mm, of the smaller half of them alone, 0.045 (open loop).
    constexpr double growth = 1.5;
    const auto is_lost = [&](const Glyph* letter) {
        return legibility_of(std::min(letter->contrast_asked, std::pow(times, growth) * letter->contrast),
                             letter->contrast_asked, times * letter->size_mm, viewing_distance_mm) == Legibility::lost;
    };
    while (times < 20 && std::ranges::count_if(letters, is_lost) > palest) times *= 1.05;
    return times < 20 ? times : 1;
}

/// The cell that differs most from its ground: the rim of a letter is half its ground.
std::uint32_t most_ink(const JobPrediction& p, const std::vector<std::uint32_t>& cells, double ground) {
    return *std::ranges::max_element(
        cells, {}, [&](std::uint32_t cell) { return std::abs(luminance_of(p, p.target, {cell}) - ground); });
}

/// `times`: how much larger the page is than the print; `slab`: where letters lie on it, nullptr: nobody asks.
std::vector<Glyph> glyphs_of(const JobPrediction& p, double viewing_distance_mm, double times, const SlabCells* slab) {
    const std::vector<Letter> found = find_type(p).letters;
    const std::vector<std::vector<std::uint32_t>> grounds = grounds_of(p, found);
    std::vector<Glyph> letters(found.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
        Glyph& letter = letters[n];
        const Letter& of = found[n];
        letter.size_mm = of.line_mm / capitals / times, letter.area_mm2 = of.area_mm2 / (times * times);
        const auto contrast = [&](const std::vector<Eigen::Vector3f>& rgb) {
            return contrast_of(luminance_of(p, rgb, of.cells), luminance_of(p, rgb, grounds[n]));
        };
        letter.contrast_asked = contrast(p.target), letter.contrast = contrast(p.predicted.rgb);
        const Legibility legibility =
            legibility_of(letter.contrast, letter.contrast_asked, letter.size_mm, viewing_distance_mm);
        letter.is_read = legibility != Legibility::lost, letter.is_pale = legibility == Legibility::pale;
        letter.cell = most_ink(p, of.cells, luminance_of(p, p.target, grounds[n]));
        letter.asked = p.target[letter.cell];
        if (slab)
            for (const std::uint32_t cell : of.cells) letter.box.extend(slab->place(p.predicted.surface.cells[cell]));
    }
    return letters;
}

/// Letters that touch are one in a coarser page.
bool is_known(std::span<const Glyph> letters, const Glyph& letter) {
    return std::ranges::any_of(letters, [&](const Glyph& other) {
        return other.box.contains(letter.box.center()) || letter.box.contains(other.box.center());
    });
}

std::optional<LostLines> lost_on(const JobPrediction& p, double times) {
    constexpr double enough = 0.6, stands_out = 0.5, least_lost_mm2 = 1, least_gone_mm2 = 0.1;
    constexpr double faint = 0.03;  // lightness, Oklab: what differs by less is ground in type_rows.cpp, too
    const LocalDetail detail(p, times);
    LostLines lost;
    double asked_of_all = 0, kept_of_all = 0, least_kept = enough;
    std::vector<Letter> patterns;
    for (std::vector<std::uint32_t>& cells : find_type(p).others) {
        double area_mm2 = 0;
        for (const std::uint32_t cell : cells) area_mm2 += p.predicted.surface.cells[cell].area_mm2;
        patterns.push_back({std::move(cells), area_mm2, 0});
    }
    const std::vector<std::vector<std::uint32_t>> grounds = grounds_of(p, patterns);
    for (std::size_t n = 0; n < patterns.size(); ++n) {
        const std::vector<std::uint32_t>& pattern = patterns[n].cells;
        const auto contrast = [&](const std::vector<Eigen::Vector3f>& rgb) {
            return contrast_of(luminance_of(p, rgb, pattern), luminance_of(p, rgb, grounds[n]));
        };
        if (contrast(p.predicted.rgb) >= stands_out * contrast(p.target)) continue;
        const double area_mm2 = patterns[n].area_mm2 / (times * times);
        double asked = 0, kept = 0;
        for (const std::uint32_t cell : pattern) {
            const double area = p.predicted.surface.cells[cell].area_mm2 / (times * times);
            const Eigen::Vector2d from = detail.at(cell);
            asked += area * from[0] * from[0], kept += area * from[0] * from[1];
        }
        if (kept >= enough * asked || asked < faint * faint * area_mm2) continue;
        if (kept < least_kept * asked)
            least_kept = kept / asked, lost.worst = most_ink(p, pattern, luminance_of(p, p.target, grounds[n]));
        lost.cells.insert(lost.cells.end(), pattern.begin(), pattern.end());
        lost.area_mm2 += area_mm2, asked_of_all += asked, kept_of_all += kept;
    }
    lost.kept = asked_of_all > 0 ? std::max(0.0, kept_of_all / asked_of_all) : 1;
    if (lost.area_mm2 < (lost.kept < gone_contrast ? least_gone_mm2 : least_lost_mm2)) return std::nullopt;
    lost.asked = p.target[lost.worst];
    return lost;
}

}  // namespace

Legibility legibility_of(double contrast, double contrast_asked, double size_mm, double viewing_distance_mm) {
    constexpr double minutes = 5 * std::numbers::pi / 180 / 60;
    const double lacks = 2 * contrast / (1 + contrast);
    if (lacks < reading_acuity.front().first) return Legibility::lost;
    const auto* above = std::ranges::lower_bound(reading_acuity, lacks, {}, &std::pair<double, double>::first);
    above = std::clamp(above, reading_acuity.begin() + 1, reading_acuity.end() - 1);
    const auto [low, of_low] = above[-1];
    const auto [high, of_high] = above[0];
    const double log_mar = std::lerp(of_low, of_high, std::log(lacks / low) / std::log(high / low));
    if (x_height * size_mm < viewing_distance_mm * minutes * std::pow(10, log_mar)) return Legibility::lost;
    const double enough = contrast_asked < readable_contrast ? readable_part * contrast_asked : readable_contrast;
    return contrast >= enough ? Legibility::well : Legibility::pale;
}

std::optional<TypeSize> unreadable_type(const JobPrediction& p, double viewing_distance_mm,
                                        std::span<const PicturePage> pages) {
    std::vector<Glyph> letters;
    const std::optional<SlabCells> print = pages.empty() ? std::nullopt : std::optional<SlabCells>(p.predicted.surface);
    const auto add = [&](std::vector<Glyph> found) {
        const std::size_t before = letters.size();
        for (Glyph& letter : found)
            if (!is_known(std::span(letters).first(before), letter)) letters.push_back(letter);
    };
    for (const PicturePage& fine : pages) {
        const SlabCells slab(fine.page.predicted.surface);
        std::vector<Glyph> found = glyphs_of(fine.page, viewing_distance_mm, fine.times, &slab);
        for (Glyph& letter : found)
            letter.cell = std::uint32_t(std::max<std::int64_t>(0, print->at(letter.box.center())));
        add(std::move(found));
    }
    add(glyphs_of(p, viewing_distance_mm, 1, print ? &*print : nullptr));
    if (letters.empty()) return std::nullopt;
    std::ranges::stable_sort(letters, {}, &Glyph::size_mm);
    TypeSize type;
    type.below_mm = dividing_size(letters);
    type.letters = letters.size();
    std::vector<const Glyph*> unread, pale;
    for (const Glyph& letter : letters) {
        if (!letter.is_read && letter.size_mm <= type.below_mm) unread.push_back(&letter);
        if (letter.is_pale) pale.push_back(&letter);
    }
    if (unread.size() < least_letters) unread.clear(), type.below_mm = 0;
    if (pale.size() < least_letters) pale.clear();
    type.smallest_mm = letters.front().size_mm, type.largest_mm = letters.back().size_mm;
    type.unread = unread.size(), type.pale = pale.size();
    type.times = times_to_be_read(unread, viewing_distance_mm);
    if (print)
        for (const Glyph& letter : letters)
            if (letter.is_read || !unread.empty()) type.letters_at.push_back(letter.box);
    for (const Glyph* letter : pale) type.pale_contrast += letter->contrast / double(pale.size());
    const std::vector<const Glyph*>& told = unread.empty() ? pale : unread;
    if (told.empty()) return type;
    for (const Glyph* letter : told) {
        type.told_mm2 += letter->area_mm2;
        type.contrast += letter->contrast / double(told.size());
        type.contrast_asked += letter->contrast_asked / double(told.size());
    }
    const Glyph& middle = *told[told.size() / 2];
    type.cell = middle.cell, type.asked = middle.asked;
    return type;
}

std::optional<LostLines> lost_lines(const JobPrediction& p, std::span<const PicturePage> pages) {
    if (p.target.empty()) return std::nullopt;
    if (auto lost = lost_on(p, 1)) return lost;
    for (const PicturePage& fine : pages) {
        auto lost = lost_on(fine.page, fine.times);
        if (!lost) continue;
        const SlabCells slab(fine.page.predicted.surface), print(p.predicted.surface);
        const auto of_print = [&](std::uint32_t cell) {
            return std::uint32_t(
                std::max<std::int64_t>(0, print.at(slab.place(fine.page.predicted.surface.cells[cell]))));
        };
        std::ranges::transform(lost->cells, lost->cells.begin(), of_print);
        std::ranges::sort(lost->cells);
        lost->cells.erase(std::ranges::unique(lost->cells).begin(), lost->cells.end());
        lost->worst = of_print(lost->worst);
        return lost;
    }
    return std::nullopt;
}

std::string type_size_text(double mm) {
    const double pt = mm / mm_per_pt;
    return fmt::format("{:.1f} mm ({:g} pt)", mm, pt < 4 ? std::round(2 * pt) / 2 : std::round(pt));
}

}  // namespace voxtone::slicer
