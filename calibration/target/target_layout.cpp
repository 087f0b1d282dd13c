// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/random.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/marker_pattern.h"

namespace voxtone::calibration {

namespace {

void demand(bool holds, const std::string& message) {
    if (!holds) throw InputError(message);
}

void check_range(const char* name, double value, double least, double most) {
    demand(std::isfinite(value) && value >= least && value <= most,
           fmt::format("target: {} is {} mm; it must be from {} to {} mm", name, value, least, most));
}

void check(const TargetOptions& o) {
    const std::set<std::string> roles(o.roles.begin(), o.roles.end());
    demand(!o.roles.empty() && (o.roles.size() >= 2 || !o.surfaces.empty()),
           "target: at least two resins are needed, a light and a dark one: --resins W,K");
    demand(roles.size() == o.roles.size(),
           fmt::format("target: a resin is named twice in --resins {}", fmt::join(o.roles, ",")));
    for (const std::string& role : o.roles)
        demand(
            !role.empty() && role.find_first_of(":+,\" \t\r\n#") == std::string::npos,
            fmt::format("target: \"{}\" cannot be the role of a resin in a patch table; use letters and digits", role));
    for (std::size_t s = 0; s < o.surfaces.size(); ++s) {
        const std::string& name = o.surfaces[s]->name;
        demand(!roles.contains(name), fmt::format("target: --surface {}: a resin has this name; take another", name));
        for (std::size_t t = 0; t < s; ++t)
            demand(o.surfaces[t]->name != name, fmt::format("target: --surface {} is there twice", name));
        demand(name == o.light || name == o.dark,
               fmt::format("target: --surface {} would be ignored: name it with --light or with --dark", name));
    }
    if (!o.surfaces.empty()) {
        demand(o.surfaces.size() == 2,
               fmt::format("target: {} is a surface, and {} is a resin, whose half would stand higher: give --surface "
                           "for both --light and --dark, or for none",
                           o.surfaces.front()->name, o.surfaces.front()->name == o.light ? o.dark : o.light));
        demand(o.layout != TargetLayout::chart, "target: a chart of thick mixtures lies on no surface that is seen");
        demand(o.strips.empty(), "target: --strips want a base of resin; leave --surface or --strips out");
    }
    for (const auto& [option, role] : {std::pair{"--light", o.light}, std::pair{"--dark", o.dark}})
        demand(
            !o.surfaces.empty() || roles.contains(role),
            fmt::format("target: {} {}: this resin is not among --resins {}; the base of the target is half of a light "
                        "and half of a dark resin, name those that you have",
                        option, role, fmt::join(o.roles, ",")));
    demand(o.light != o.dark, "target: the light and the dark resin must be different");
    for (const double pitch : o.pitch_um) demand(pitch > 0 && pitch < 1e4, "target: the printer's pitch is not known");
    check_range("square", o.square_mm, 1, 100);
    check_range("top", o.top_mm, 1e-3, 10);
    if (o.surfaces.empty()) check_range("base", o.base_mm, 1e-3, 100);
    check_range("gap", o.gap_mm, 0, 50);
    check_range("marker", o.marker_mm, 2, 50);
    check_range("quiet", o.quiet_mm, o.marker_mm / marker_cells, 50);
}

/// A share of the first resin in the second, in percent.
PatchMixture in_light(const std::string& role, int percent, const std::string& light) {
    PatchMixture mixture{{role, percent / 100.0}, {light, (100 - percent) / 100.0}};
    if (light < role) std::swap(mixture[0], mixture[1]);  // as patch tables order them
    return mixture;
}

constexpr std::size_t most_mixed = 6;  // resins of layout E: 63 squares on each half

/// Of every choice of resins as much of each; the pure ones first.
std::vector<PatchMixture> equal_mixtures(std::vector<std::string> roles) {
    demand(roles.size() <= most_mixed,
           fmt::format("target: {} resins have {} equal mixtures, too many squares for a chart; name at most {}",
                       roles.size(), (std::size_t{1} << std::min<std::size_t>(roles.size(), 40)) - 1, most_mixed));
    std::ranges::sort(roles);  // as patch tables order them
    std::vector<PatchMixture> all;
    for (std::size_t chosen = 1; chosen < std::size_t{1} << roles.size(); ++chosen) {
        PatchMixture& mixture = all.emplace_back();
        for (std::size_t r = 0; r < roles.size(); ++r)
            if (chosen >> r & 1) mixture.push_back({roles[r], 1.0 / std::popcount(chosen)});
    }
    std::ranges::stable_sort(all, {}, [](const PatchMixture& mixture) { return mixture.size(); });
    return all;
}

/// Resins that dilute others: those of the halves, else white and black where they are there.
std::string diluent(const TargetOptions& o, const std::string& of_half, const char* usual) {
    if (o.surfaces.empty()) return of_half;
    return std::ranges::find(o.roles, usual) != o.roles.end() ? usual : "";
}

std::vector<PatchMixture> mixtures(const TargetOptions& o) {
    const std::string light = diluent(o, o.light, "W"), dark = diluent(o, o.dark, "K");
    if (o.layout == TargetLayout::chart || o.layout == TargetLayout::mixtures) return o.chart;
    if (o.layout == TargetLayout::e) return equal_mixtures(o.roles);
    std::vector<PatchMixture> all;
    for (const std::string& role : o.roles) all.push_back({{role, 1.0}});
    if (o.layout == TargetLayout::a || light.empty()) return all;
    const std::vector<int> shares =
        o.layout == TargetLayout::b ? std::vector<int>{10} : std::vector<int>{5, 10, 25, 50};
    if (!dark.empty()) {
        for (const int percent : shares) all.push_back(in_light(dark, percent, light));
        all.push_back(in_light(dark, 90, light));
    }
    for (const std::string& role : o.roles)
        if (role != light && role != dark)
            for (const int percent : shares) all.push_back(in_light(role, percent, light));
    return all;
}

constexpr double thin_shares[] = {0.08, 0.2, 0.6};  // of a target's top, on a surface without white resin
constexpr const char* clear_role = "T";
constexpr double clear_mm[] = {5, 10};
constexpr double edge_by_depth = 2.7;  // a deep square's edge by its depth
constexpr double least_floor_mm = 3;   // of light resin under the deepest
constexpr double from_halves_mm = 5;   // light of the halves hardly goes farther in white resin

bool has_deep_squares(const TargetOptions& o) {
    return o.surfaces.empty() && o.layout <= TargetLayout::c && std::ranges::find(o.roles, clear_role) != o.roles.end();
}

struct Checker {
    PatchMixture top;
    std::array<int, 2> cell;
};

/// Cells that grow along one axis and along the other; the other side is long enough to hide little, and short enough
/// that a whole number of cells is nearly seen. Several of a width, of other lengths so that tables tell them apart:
/// readings are noisy, and the finest, a mixture already, say what resins do to all.
std::vector<Checker> checkers_of(const TargetOptions& o) {
    // Columns, rows; 16 columns or 8 rows are 0.68 mm of a J750.
    constexpr std::array<std::array<int, 2>, 27> cells{{{1, 8},  {1, 9},  {1, 10}, {1, 11}, {1, 12}, {2, 8},  {2, 10},
                                                        {2, 12}, {3, 8},  {3, 10}, {3, 12}, {4, 8},  {4, 10}, {6, 8},
                                                        {8, 8},  {16, 8}, {16, 1}, {18, 1}, {20, 1}, {22, 1}, {16, 2},
                                                        {18, 2}, {20, 2}, {16, 3}, {16, 4}, {18, 4}, {16, 16}}};
    std::vector<Checker> all;
    for (const auto& [one, other] : o.strips)
        for (const auto& cell : cells) {
            Checker& checker = all.emplace_back(Checker{{{one, 0.5}, {other, 0.5}}, cell});
            std::ranges::sort(checker.top, {}, &ResinShare::role);
        }
    return all;
}

/// Columns of each part, so that the whole is nearest to 3 x 2, as pictures are.
int columns_of_part(int squares, int parts, double pitch_mm, double frame_mm) {
    int best = 1;
    double best_ratio = 1e9;
    for (int columns = 1; columns <= squares; ++columns) {
        const int rows = (squares + columns - 1) / columns;
        const double width = parts * columns * pitch_mm + frame_mm, height = rows * pitch_mm + frame_mm;
        const double ratio = std::abs(std::log(width / height / 1.5));
        if (ratio < best_ratio) {
            best_ratio = ratio;
            best = columns;
        }
    }
    return best;
}

/// Numbers of the four markers, a fingerprint of what the target holds (FNV-1a, mixed): 250 for each, so that two
/// targets share a number now and then but hardly ever three.
std::array<int, 4> marker_numbers(const Target& target) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](const std::string& text) {
        for (const unsigned char c : text) hash = (hash ^ c) * 0x100000001b3u;
    };
    for (const TargetSquare& square : target.squares)
        add(fmt::format("{} on {} at {:.2f},{:.2f};{}", mixture_text(square.top), square.backing,
                        square.area.min_mm.x(), square.area.min_mm.y(),
                        square.is_checker() ? fmt::format(" {}x{};", square.cell[0], square.cell[1]) : ""));
    add(fmt::format("{:.4f} {:.4f}", target.top_mm, target.base_mm));  // which tells deep squares too
    const std::array<std::uint32_t, 4> mixed =
        philox4x32({static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32), 0, 0}, {0, 0});
    constexpr int each = marker_count / 4;
    std::array<int, 4> numbers{};
    for (int m = 0; m < 4; ++m) numbers[std::size_t(m)] = each * m + static_cast<int>(mixed[std::size_t(m)] % each);
    return numbers;
}

bool overlap(const Area& a, const Area& b) {
    constexpr double touch_mm = 1e-9;
    return (a.min_mm.array() < b.max_mm.array() - touch_mm).all() &&
           (b.min_mm.array() < a.max_mm.array() - touch_mm).all();
}

/// The square is as near as can be to what was asked for, the base at least that.
double nearest_layers(double mm, double pitch_um) {
    return std::max(1.0, std::round(mm * 1000 / pitch_um)) * pitch_um / 1000;
}
double enough_layers(double mm, double pitch_um) { return std::ceil(mm * 1000 / pitch_um - 1e-6) * pitch_um / 1000; }

/// Side by side from the left, with their upper edges at `top_mm`.
std::vector<TargetSquare> deep_squares(const TargetOptions& o, double left_mm, double top_mm) {
    std::vector<TargetSquare> squares;
    for (const double depth : clear_mm) {
        const Eigen::Vector2d low(left_mm, top_mm - edge_by_depth * depth);
        squares.push_back({{{clear_role, 1.0}},
                           o.light,
                           {low, low + Eigen::Vector2d::Constant(edge_by_depth * depth)},
                           nearest_layers(depth, o.pitch_um[2])});
        left_mm += edge_by_depth * depth + std::max(o.gap_mm, from_halves_mm);
    }
    return squares;
}

}  // namespace

Target lay_out_target(const TargetOptions& o) {
    check(o);
    Target target;
    target.printer = o.printer;
    target.pitch_um = o.pitch_um;
    const bool chart = o.layout == TargetLayout::chart;
    target.layout = chart                                ? "chart"
                    : o.layout == TargetLayout::mixtures ? "mixtures"
                                                         : std::string(1, char('A' + static_cast<int>(o.layout)));
    target.roles = o.roles;
    target.light = o.light;
    target.dark = o.dark;
    target.surfaces = o.surfaces;
    target.top_mm = nearest_layers(o.top_mm, o.pitch_um[2]);
    const bool deep = has_deep_squares(o);
    constexpr double deepest_mm = clear_mm[1];
    target.base_mm = enough_layers(deep ? std::max(o.base_mm, deepest_mm + least_floor_mm - target.top_mm) : o.base_mm,
                                   o.pitch_um[2]);

    if (!o.surfaces.empty()) target.base_mm = 0;

    std::vector<PatchMixture> tops = mixtures(o);
    std::vector<double> depths(tops.size(), 0.0);
    if (!o.surfaces.empty() && o.layout <= TargetLayout::c && diluent(o, o.light, "W").empty()) {
        const std::vector<PatchMixture> pure = std::exchange(tops, {});
        depths.clear();
        for (const PatchMixture& top : pure)
            for (const double share : thin_shares) {
                tops.push_back(top);
                depths.push_back(nearest_layers(share * target.top_mm, o.pitch_um[2]));
            }
    }
    const double pitch = o.square_mm + o.gap_mm, frame = o.marker_mm + 2 * o.quiet_mm;
    const int parts = chart ? 1 : 2;
    const std::vector<Checker> strips = checkers_of(o);
    const int squares = static_cast<int>(tops.size() + strips.size());
    const int columns = columns_of_part(squares, parts, pitch, 2 * frame + parts * o.gap_mm);
    const int rows = (squares + columns - 1) / columns;
    const Eigen::Vector2d half(columns * pitch + o.gap_mm, rows * pitch + o.gap_mm);
    const double apart = std::max(o.gap_mm, from_halves_mm);
    const double strip = deep ? edge_by_depth * deepest_mm + apart : 0,
                 strip_width = edge_by_depth * (clear_mm[0] + clear_mm[1]) + apart;
    target.size_mm = {std::max(parts * half.x(), deep ? strip_width : 0) + 2 * frame, half.y() + strip + 2 * frame};
    const Eigen::Vector2d light_corner(frame, frame + strip), dark_corner(frame + half.x(), frame + strip);
    if (!chart) target.dark_half = {dark_corner, dark_corner + half};

    for (const bool on_light : chart ? std::vector{true} : std::vector{true, false})
        for (int s = 0; s < squares; ++s) {
            const int column = s % columns, row = s / columns;
            const Eigen::Vector2d corner =
                (on_light ? light_corner : dark_corner) +
                Eigen::Vector2d(o.gap_mm + column * pitch, o.gap_mm + (rows - 1 - row) * pitch);
            TargetSquare& square = target.squares.emplace_back();
            square.backing = on_light ? o.light : o.dark;
            square.area = {corner, corner + Eigen::Vector2d::Constant(o.square_mm)};
            if (const auto k = static_cast<std::size_t>(s); k < tops.size()) {
                square.top = tops[k], square.depth_mm = depths[k];
            } else {
                const Checker& checker = strips[k - tops.size()];
                square.top = checker.top, square.cell = checker.cell;
            }
        }
    if (deep)
        for (TargetSquare& square : deep_squares(o, frame, frame + edge_by_depth * deepest_mm))
            target.squares.push_back(std::move(square));
    const std::array<int, 4> numbers = marker_numbers(target);
    const Eigen::Vector2d near = Eigen::Vector2d::Constant(o.quiet_mm),
                          far = target.size_mm - Eigen::Vector2d::Constant(o.quiet_mm + o.marker_mm);
    const Eigen::Vector2d corners[] = {{near.x(), far.y()}, far, {far.x(), near.y()}, near};
    for (int m = 0; m < 4; ++m)
        target.markers.push_back(
            {numbers[std::size_t(m)], {corners[m], corners[m] + Eigen::Vector2d::Constant(o.marker_mm)}});
    target.validate("target");
    return target;
}

void Target::validate(const std::string& where) const {
    const auto rule = [&](bool holds, const std::string& what) { demand(holds, fmt::format("{}: {}", where, what)); };
    const auto known = [&](const std::string& role) {
        return std::find(roles.begin(), roles.end(), role) != roles.end();
    };
    rule(roles.size() >= (surfaces.empty() ? 2 : 1) && std::set(roles.begin(), roles.end()).size() == roles.size(),
         "\"roles\" must be two or more different ones");
    rule((surfaces.empty() ? known(light) && known(dark) : surface(light) && surface(dark)) && light != dark,
         "\"light\" and \"dark\" must be two different ones of \"roles\", or of \"surfaces\" where there are some");
    for (const auto& one : surfaces)
        rule(!known(one->name), fmt::format("surface \"{}\" has the name of a resin", one->name));
    rule(layout == "A" || layout == "B" || layout == "C" || layout == "E" || layout == "mixtures" || is_chart(),
         "\"layout\" must be A, B, C, E, chart or mixtures");
    rule(top_mm > 0 && (surfaces.empty() ? base_mm > 0 : base_mm == 0),
         "\"top_mm\" and \"base_mm\" must be positive; upon surfaces \"base_mm\" is 0");
    rule(surfaces.empty() || !is_chart(), "a chart lies on no surface");
    const Area slab{Eigen::Vector2d::Zero(), size_mm};
    rule((size_mm.array() > 0).all() && size_mm.allFinite(), "\"size_mm\" must be positive");
    const auto inside = [&](const Area& a) {
        return (a.size().array() > 0).all() && slab.contains(a.min_mm) && slab.contains(a.max_mm);
    };
    rule(is_chart() ? dark_half.size().isZero() : inside(dark_half),
         is_chart() ? "a chart has no dark half: \"dark_half_mm\" must be 0, 0, 0, 0"
                    : "\"dark_half_mm\" must lie on the target");
    rule(!squares.empty(), "there is no square");
    for (std::size_t s = 0; s < squares.size(); ++s) {
        const TargetSquare& square = squares[s];
        const std::string name = fmt::format("square {}", s + 1);
        rule(inside(square.area), name + " lies outside of the target or has no area");
        rule(square.backing == light || square.backing == dark,
             name + ": the backing must be the light or the dark resin");
        const bool on_dark = dark_half.contains(square.area.min_mm) && dark_half.contains(square.area.max_mm);
        rule(on_dark == (square.backing == dark) && (on_dark || !overlap(square.area, dark_half)),
             name + " lies on the half of the other backing");
        rule(square.depth_mm >= 0 && square.depth_mm < height_mm(), name + " is deeper than the target");
        double sum = 0;
        std::set<std::string> parts;
        for (const ResinShare& share : square.top) {
            rule(known(share.role), fmt::format("{}: \"{}\" is none of the target's resins ({})", name, share.role,
                                                fmt::join(roles, ", ")));
            rule(share.fraction > 0 && share.fraction <= 1, name + ": every share must be in (0, 100] %");
            rule(parts.insert(share.role).second, name + ": a resin is named twice");
            sum += share.fraction;
        }
        rule(std::abs(sum - 1) < 1e-6, name + ": the shares do not sum to 100 %");
        rule(square.cell == std::array<int, 2>{} ||
                 (square.cell[0] > 0 && square.cell[1] > 0 && square.top.size() == 2 &&
                  std::abs(square.top[0].fraction - 0.5) < 1e-6),
             name + ": a checker is half of one resin and half of another, in cells of one column and row or more");
        for (std::size_t t = 0; t < s; ++t)
            rule(!overlap(square.area, squares[t].area), fmt::format("squares {} and {} overlap", t + 1, s + 1));
    }
    rule(markers.size() == 4, "there must be four markers");
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const Area& area = markers[m].area;
        const std::string name = fmt::format("marker {}", m + 1);
        rule(markers[m].id >= 0 && markers[m].id < marker_count,
             fmt::format("{}: its number must be from 0 to {}", name, marker_count - 1));
        rule(inside(area) && std::abs(area.size().x() - area.size().y()) < 1e-6,
             name + " must be a square on the target");
        rule(!overlap(area, dark_half), name + " lies on the dark half");
        for (const TargetSquare& square : squares) rule(!overlap(area, square.area), name + " lies on a square");
        for (std::size_t n = 0; n < m; ++n)
            rule(markers[n].id != markers[m].id && !overlap(markers[n].area, area),
                 fmt::format("markers {} and {} are the same or overlap", n + 1, m + 1));
    }
    const auto middle = [&](int m) { return markers[std::size_t(m)].area.center(); };
    rule(middle(0).x() < middle(1).x() && middle(3).x() < middle(2).x() && middle(3).y() < middle(0).y() &&
             middle(2).y() < middle(1).y(),
         "the markers must be upper left, upper right, lower right, lower left");
}

std::shared_ptr<const PatchSurface> Target::surface(std::string_view name) const {
    const auto found = std::ranges::find(surfaces, name, [](const auto& one) { return std::string_view(one->name); });
    return found == surfaces.end() ? nullptr : *found;
}

PatchMixture Target::of_markers() const {
    if (surfaces.empty()) return {{dark, 1.0}};
    if (std::ranges::find(roles, "K") != roles.end()) return {{"K", 1.0}};
    std::vector<std::string> coloured;
    std::ranges::copy_if(roles, std::back_inserter(coloured),
                         [](const std::string& role) { return role != "W" && role != clear_role; });
    if (coloured.empty()) coloured = roles;
    PatchMixture mixture;
    for (const std::string& role : coloured) mixture.push_back({role, 1.0 / double(coloured.size())});
    std::ranges::sort(mixture, {}, &ResinShare::role);
    return mixture;
}

std::vector<TargetBox> target_boxes(const Target& target) {
    const auto shares = [&](const PatchMixture& mixture) {
        std::vector<double> fractions(target.roles.size(), 0.0);
        for (const ResinShare& share : mixture)
            fractions[std::size_t(std::find(target.roles.begin(), target.roles.end(), share.role) -
                                  target.roles.begin())] = share.fraction;
        return fractions;
    };
    const std::vector<double> dark = shares(target.of_markers());
    const double top = target.height_mm();
    const auto box = [](const Area& area, double z0, double z1, std::vector<double> fractions) {
        return TargetBox{
            {area.min_mm.x(), area.min_mm.y(), z0}, {area.max_mm.x(), area.max_mm.y(), z1}, std::move(fractions)};
    };
    std::vector<TargetBox> boxes;
    if (target.surfaces.empty()) {
        boxes.push_back(box({Eigen::Vector2d::Zero(), target.size_mm}, 0, top, shares({{target.light, 1.0}})));
        if (!target.is_chart()) boxes.push_back(box(target.dark_half, 0, top, dark));
    }
    for (const TargetSquare& square : target.squares) {
        const double under = target.under_mm(square);
        boxes.push_back(box(square.area, under, under + target.depth_mm(square), shares(square.top)));
        boxes.back().cell = square.cell;
    }
    for (const TargetMarker& marker : target.markers) {
        const std::vector<bool> cells = marker_pattern(marker.id);
        const double cell = marker.area.size().x() / marker_cells;
        for (int row = 0; row < marker_cells; ++row)
            for (int column = 0; column < marker_cells; ++column) {
                if (!cells[std::size_t(row * marker_cells + column)]) continue;
                const Eigen::Vector2d corner(marker.area.min_mm.x() + column * cell,
                                             marker.area.max_mm.y() - (row + 1) * cell);
                boxes.push_back(box({corner, corner + Eigen::Vector2d::Constant(cell)}, target.base_mm, top, dark));
            }
    }
    return boxes;
}

std::vector<std::array<int, 2>> square_places(const Target& target) {
    std::set<double> left, top;
    for (const TargetSquare& square : target.squares) {
        left.insert(square.area.min_mm.x());
        top.insert(-square.area.max_mm.y());
    }
    std::vector<std::array<int, 2>> places;
    for (const TargetSquare& square : target.squares)
        places.push_back({static_cast<int>(std::distance(top.begin(), top.find(-square.area.max_mm.y()))) + 1,
                          static_cast<int>(std::distance(left.begin(), left.find(square.area.min_mm.x()))) + 1});
    return places;
}

std::string square_name(const Target& target, std::size_t square) {
    const TargetSquare& s = target.squares.at(square);
    const std::string cells = s.is_checker() ? fmt::format(" in cells of {} x {}", s.cell[0], s.cell[1]) : "";
    return fmt::format("square {} ({}{} on {})", square + 1, mixture_text(s.top), cells, s.backing);
}

}  // namespace voxtone::calibration
