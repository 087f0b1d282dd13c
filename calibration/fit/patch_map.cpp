// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/patch_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/target/target_file.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;

/// `paint` is called with each pixel whose middle lies in the area.
template <class Paint>
void rasterize(const PatchMap& map, const Area& area, Paint&& paint) {
    const auto range = [&](double from_mm, double to_mm, std::uint32_t count) {
        const auto first = [&](double mm) {
            return std::uint32_t(std::clamp(std::ceil(mm * map.px_per_mm - 0.5), 0.0, double(count)));
        };
        return std::pair{first(from_mm), first(to_mm)};
    };
    const double height_mm = map.size_mm().y();
    const auto [left, right] = range(area.min_mm.x(), area.max_mm.x(), map.width_px);
    const auto [top, bottom] = range(height_mm - area.max_mm.y(), height_mm - area.min_mm.y(), map.height_px);
    for (std::uint32_t row = top; row < bottom; ++row)
        for (std::uint32_t column = left; column < right; ++column) paint(std::size_t{row} * map.width_px + column);
}

PatchMap empty_map(const Vector2d& size_mm, double px_per_mm, std::size_t patches) {
    PatchMap map;
    map.px_per_mm = px_per_mm;
    map.width_px = std::uint32_t(std::max(1.0, std::round(size_mm.x() * px_per_mm)));
    map.height_px = std::uint32_t(std::max(1.0, std::round(size_mm.y() * px_per_mm)));
    map.patch_of.assign(std::size_t{map.width_px} * map.height_px, 0);
    map.middles_mm.assign(patches, size_mm / 2);
    return map;
}

/// A share for each of the target's resins.
std::vector<double> fractions_of(const Target& target, const PatchMixture& mixture) {
    std::vector<double> fractions(target.roles.size(), 0.0);
    for (const ResinShare& share : mixture) {
        const auto role = std::ranges::find(target.roles, share.role);
        if (role == target.roles.end()) return {};
        fractions[std::size_t(role - target.roles.begin())] = share.fraction;
    }
    return fractions;
}

bool alike(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr double rounding = 1e-4;  // of percentages as tables write them
    return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) < rounding; });
}

/// What lies under a square: shares of resins, or a surface.
struct Below {
    std::vector<double> fractions;
    std::string surface;
};

/// The patch of a mixture upon another, from 1, of several that of the nearest thickness; 0: there is none.
std::uint16_t patch_with(const PatchTable& table, const Target& target, const std::vector<double>& top,
                         const Below& below, double thickness_mm) {
    std::size_t found = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        const Patch& patch = table.patches[p];
        const double off = std::abs(patch.thickness_mm - thickness_mm);
        if (!patch.lit && off < nearest && alike(fractions_of(target, patch.top), top) &&
            (patch.on ? patch.backing == below.surface
                      : alike(fractions_of(target, {{patch.backing, 1.0}}), below.fractions)))
            found = p + 1, nearest = off;
    }
    return std::uint16_t(found);
}

/// What lies on top of each pixel and under it, as numbers of boxes.
void mark_patches(PatchMap& map, const PatchTable& table, const Target& target) {
    if (!target.surfaces.empty()) {
        const std::vector<std::size_t> patches = patches_of_squares(table, target);
        for (std::size_t s = 0; s < patches.size(); ++s)
            rasterize(map, target.squares[s].area,
                      [&](std::size_t pixel) { map.patch_of[pixel] = std::uint16_t(patches[s]); });
        return;
    }
    const std::vector<TargetBox> boxes = target_boxes(target);
    std::vector<std::pair<std::size_t, std::size_t>> of(map.patch_of.size());
    for (std::size_t b = 0; b < boxes.size(); ++b)
        rasterize(map, {boxes[b].min_mm.head<2>(), boxes[b].max_mm.head<2>()}, [&](std::size_t pixel) {
            of[pixel].first = b;
            if (boxes[b].min_mm.z() <= 0) of[pixel].second = b;
        });
    std::map<std::pair<std::size_t, std::size_t>, std::uint16_t> known;
    for (std::size_t pixel = 0; pixel < of.size(); ++pixel) {
        const auto [found, is_new] = known.try_emplace(of[pixel], std::uint16_t{0});
        const TargetBox &top = boxes[of[pixel].first], &below = boxes[of[pixel].second];
        if (is_new)
            found->second = top.cell[0] > 0 ? std::uint16_t{0}
                                            : patch_with(table, target, top.fractions, {below.fractions, {}},
                                                         top.max_mm.z() - top.min_mm.z());
        map.patch_of[pixel] = found->second;
    }
}

void mark_middles(PatchMap& map, const PatchTable& table, const Target& target) {
    const std::vector<std::size_t> patches = patches_of_squares(table, target);
    for (std::size_t s = 0; s < patches.size(); ++s)
        if (patches[s] > 0) map.middles_mm[patches[s] - 1] = target.squares[s].area.center();
    if (std::ranges::all_of(patches, [](std::size_t patch) { return patch == 0; }))
        throw InputError(
            fmt::format("{}: none of its patches is a square of the target, whose resins are {}; is --target that of "
                        "another print?",
                        table.source, fmt::join(target.roles, ", ")));
}

void add_photograph(PatchMap& map, const Target& target, const io::Photograph& photo) {
    const double is = double(photo.width_px) / photo.height_px, wanted = target.size_mm.x() / target.size_mm.y();
    if (std::abs(is / wanted - 1) > 0.02)
        throw InputError(fmt::format(
            "{}: {} x {} pixels, but the target is {:g} x {:g} mm; --picture wants the target alone, straightened, as "
            "`calibrate photo --picture` writes it",
            printable(photo.name), photo.width_px, photo.height_px, target.size_mm.x(), target.size_mm.y()));
    map.photograph.reserve(3 * photo.pixels.size());
    for (const Eigen::Vector3f& pixel : photo.pixels)
        for (const float linear : pixel) map.photograph.push_back(io::linear_to_srgb8(linear));
}

}  // namespace

PatchMap chart_of_patches(const PatchTable& table) {
    constexpr double square_mm = 10, step_mm = 12, px_per_mm = 4;
    const std::size_t most_columns =
        std::max<std::size_t>(16, std::size_t(std::ceil(std::sqrt(1.6 * double(table.patches.size())))));
    std::vector<std::string> backings;
    for (const Patch& patch : table.patches)
        if (std::ranges::find(backings, patch.backing) == backings.end()) backings.push_back(patch.backing);
    std::vector<std::pair<std::size_t, std::size_t>> places(table.patches.size());  // column, row
    std::size_t columns = 1, rows = 0;
    for (const std::string& backing : backings) {
        std::size_t column = 0;
        for (std::size_t p = 0; p < table.patches.size(); ++p) {
            if (table.patches[p].backing != backing) continue;
            if (column == most_columns) column = 0, ++rows;
            places[p] = {column++, rows};
            columns = std::max(columns, column);
        }
        ++rows;
    }
    const auto is_placed = [](const Patch& patch) { return patch.row > 0 && patch.column > 0; };
    if (std::ranges::all_of(table.patches, is_placed)) {
        columns = rows = 1;
        for (std::size_t p = 0; p < places.size(); ++p) {
            places[p] = {std::size_t(table.patches[p].column - 1), std::size_t(table.patches[p].row - 1)};
            columns = std::max(columns, places[p].first + 1), rows = std::max(rows, places[p].second + 1);
        }
    }
    PatchMap map = empty_map(Vector2d(columns, std::max<std::size_t>(rows, 1)) * step_mm, px_per_mm, places.size());
    for (std::size_t p = 0; p < places.size(); ++p) {
        const Vector2d middle((double(places[p].first) + 0.5) * step_mm,
                              map.size_mm().y() - (double(places[p].second) + 0.5) * step_mm);
        map.middles_mm[p] = middle;
        const Vector2d half = Vector2d::Constant(square_mm / 2);
        rasterize(map, {middle - half, middle + half},
                  [&](std::size_t pixel) { map.patch_of[pixel] = std::uint16_t(p + 1); });
    }
    return map;
}

std::vector<std::size_t> patches_of_squares(const PatchTable& table, const Target& target) {
    std::vector<std::size_t> patches;
    for (const TargetSquare& square : target.squares)
        patches.push_back(square.is_checker()
                              ? 0
                              : patch_with(table, target, fractions_of(target, square.top),
                                           {fractions_of(target, {{square.backing, 1.0}}), square.backing},
                                           target.depth_mm(square)));
    return patches;
}

PatchMap patches_on_target(const PatchTable& table, const Target& target, const io::Photograph* photograph) {
    constexpr double own_px_per_mm = 4;
    PatchMap map = empty_map(target.size_mm, photograph ? photograph->width_px / target.size_mm.x() : own_px_per_mm,
                             table.patches.size());
    if (photograph) {
        map.height_px = photograph->height_px;
        map.patch_of.assign(photograph->pixels.size(), 0);
        add_photograph(map, target, *photograph);
    }
    map.is_target = true;
    mark_patches(map, table, target);
    mark_middles(map, table, target);
    return map;
}

void PatchMapFiles::validate(const std::string& page) const {
    if (!picture.empty() && target.empty())
        throw UsageError("--picture shows a target: give its description with --target target.json too");
    if (!target.empty() && page.empty())
        throw UsageError(
            "--target says where squares lie on a page, and no page is asked for: add the page, or leave "
            "--target out");
}

void PatchMapFiles::validate_of_squares(const std::string& page) const {
    if (picture.empty()) return;
    validate(page);
}

PatchMap read_patch_map(const PatchTable& table, const PatchMapFiles& files, const Progress& progress) {
    if (files.target.empty()) return chart_of_patches(table);
    const Target target = read_target(files.target);
    if (files.picture.empty()) return patches_on_target(table, target, nullptr);
    io::Photograph photograph = io::read_photograph(files.picture, &progress);
    if (photograph.coding != io::SampleCoding::linear) io::make_linear(photograph);
    return patches_on_target(table, target, &photograph);
}

}  // namespace voxtone::calibration
