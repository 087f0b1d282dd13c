// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/composed_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::slicer {

namespace {

constexpr std::uint8_t side_grey = 200;

/// A surface while it is put together: places in mm.
struct Shape {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::uint32_t> triangles, clear;  ///< clear: those that are seen through
    std::vector<std::vector<std::uint8_t>> rgb;   ///< by look
    io::ViewerDifferences seen, single;
};

double decoded(std::uint16_t code, double low, double high) { return low + code / 65535.0 * (high - low); }

Shape shape_of_body(const io::ViewerSurface& s, const std::vector<const io::ViewerLook*>& looks) {
    Shape shape;
    for (std::size_t v = 0; v + 2 < s.positions.size(); v += 3)
        shape.positions.emplace_back(decoded(s.positions[v], s.low_mm[0], s.high_mm[0]),
                                     decoded(s.positions[v + 1], s.low_mm[1], s.high_mm[1]),
                                     decoded(s.positions[v + 2], s.low_mm[2], s.high_mm[2]));
    const auto clear = s.triangles.end() - std::ptrdiff_t(s.clear);
    shape.triangles.assign(s.triangles.begin(), clear);
    shape.clear.assign(clear, s.triangles.end());
    for (const io::ViewerLook* look : looks) shape.rgb.push_back(look->rgb);
    shape.seen = s.seen, shape.single = s.single;
    return shape;
}

/// Sides and bottom of the box below the picture.
void add_slab(const io::ViewerSurface& s, Shape& shape) {
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (int c = 0; c < 8; ++c) {
        const auto at = [&](std::size_t axis) { return c >> axis & 1 ? s.high_mm[axis] : s.low_mm[axis]; };
        shape.positions.emplace_back(at(0), at(1), c & 4 ? s.high_mm[2] : 0.0);
        for (auto& rgb : shape.rgb) rgb.insert(rgb.end(), 3, side_grey);
        if (!shape.seen.empty()) shape.seen.push_back(0);
        if (!shape.single.empty()) shape.single.push_back(0);
    }
    for (const std::uint32_t corner :
         {0, 2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
        shape.triangles.push_back(first + corner);
}

/// Below a picture that is cut to shape: its outline, pixel by pixel, down to a bottom of its shape.
void add_cut_slab(Shape& shape) {
    const auto face = static_cast<std::uint32_t>(shape.positions.size());
    const std::vector<std::uint32_t> top = shape.triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t t = 0; t < top.size(); ++t) edges.emplace_back(top[t], top[t % 3 == 2 ? t - 2 : t + 1]);
    std::ranges::sort(edges);
    for (const double part : {1.0, 0.0})  // the upper rim, which is grey too, and the bottom
        for (std::uint32_t p = 0; p < face; ++p) {
            const Eigen::Vector3d at = shape.positions[p];
            shape.positions.emplace_back(at.x(), at.y(), part * at.z());
            for (auto& rgb : shape.rgb) rgb.insert(rgb.end(), 3, side_grey);
            if (!shape.seen.empty()) shape.seen.push_back(0);
            if (!shape.single.empty()) shape.single.push_back(0);
        }
    for (const auto& [a, b] : edges)
        if (!std::ranges::binary_search(edges, std::pair{b, a}))
            for (const std::uint32_t corner : {b + face, a + face, a + 2 * face, b + face, a + 2 * face, b + 2 * face})
                shape.triangles.push_back(corner);
    for (std::size_t t = 0; t + 2 < top.size(); t += 3)
        for (const std::uint32_t corner : {top[t], top[t + 2], top[t + 1]})
            shape.triangles.push_back(corner + 2 * face);
}

/// A corner in the middle of each pixel that is covered.
Shape shape_of_picture(const io::ViewerSurface& s, const std::vector<const io::ViewerLook*>& looks) {
    constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();
    const std::uint32_t columns = s.size_px[0], rows = s.size_px[1];
    const double across = (s.high_mm[0] - s.low_mm[0]) / columns, down = (s.high_mm[1] - s.low_mm[1]) / rows;
    Shape shape;
    shape.rgb.resize(looks.size());
    std::vector<std::uint32_t> corner(std::size_t{columns} * rows, nothing);
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::size_t pixel = std::size_t{row} * columns + column;
            if (!s.covered[pixel]) continue;
            corner[pixel] = static_cast<std::uint32_t>(shape.positions.size());
            shape.positions.emplace_back(s.low_mm[0] + (column + 0.5) * across, s.high_mm[1] - (row + 0.5) * down,
                                         s.high_mm[2]);
            for (std::size_t l = 0; l < looks.size(); ++l)
                shape.rgb[l].insert(shape.rgb[l].end(), looks[l]->rgb.begin() + std::ptrdiff_t(3 * pixel),
                                    looks[l]->rgb.begin() + std::ptrdiff_t(3 * pixel + 3));
            if (!s.seen.empty()) shape.seen.push_back(s.seen[pixel]);
            if (!s.single.empty()) shape.single.push_back(s.single[pixel]);
        }
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (a != nothing && b != nothing && c != nothing) shape.triangles.insert(shape.triangles.end(), {a, b, c});
    };
    for (std::uint32_t row = 0; row + 1 < rows; ++row)
        for (std::uint32_t column = 0; column + 1 < columns; ++column) {
            const std::size_t pixel = std::size_t{row} * columns + column;
            triangle(corner[pixel], corner[pixel + columns], corner[pixel + 1]);
            triangle(corner[pixel + 1], corner[pixel + columns], corner[pixel + columns + 1]);
        }
    if (std::ranges::find(s.covered, 0) == s.covered.end())
        add_slab(s, shape);
    else
        add_cut_slab(shape);
    return shape;
}

std::vector<const io::ViewerLook*> looks_named(const io::ViewerSurface& s, const std::vector<std::string>& names) {
    std::vector<const io::ViewerLook*> looks;
    for (const std::string& name : names)
        for (const io::ViewerLook& look : s.looks)
            if (look.name == name) looks.push_back(&look);
    return looks;
}

std::vector<std::string> common_names(std::span<const PlacedSurface> surfaces) {
    std::vector<std::string> names;
    for (const io::ViewerLook& look : surfaces[0].surface->looks)
        if (std::ranges::all_of(
                surfaces, [&](const PlacedSurface& one) { return looks_named(*one.surface, {look.name}).size() == 1; }))
            names.push_back(look.name);
    return names;
}

void append(Shape& to, const Shape& from, const Eigen::Vector3d& at_mm) {
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    for (const Eigen::Vector3d& p : from.positions) to.positions.emplace_back(p + at_mm);
    for (const std::uint32_t corner : from.triangles) to.triangles.push_back(first + corner);
    for (const std::uint32_t corner : from.clear) to.clear.push_back(first + corner);
    for (std::size_t l = 0; l < to.rgb.size(); ++l)
        to.rgb[l].insert(to.rgb[l].end(), from.rgb[l].begin(), from.rgb[l].end());
    to.seen.insert(to.seen.end(), from.seen.begin(), from.seen.end());
    to.single.insert(to.single.end(), from.single.begin(), from.single.end());
}

io::ViewerSurface encoded(Shape&& shape, std::vector<std::pair<std::string, std::string>>&& looks) {
    io::ViewerSurface out;
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Eigen::Vector3d& p : shape.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        out.low_mm[axis] = low[Eigen::Index(axis)];
        out.high_mm[axis] = high[Eigen::Index(axis)];
    }
    for (const Eigen::Vector3d& p : shape.positions)
        for (Eigen::Index a = 0; a < 3; ++a)
            out.positions.push_back(
                static_cast<std::uint16_t>(std::lround(65535 * (p[a] - low[a]) / std::max(1e-6, high[a] - low[a]))));
    out.triangles = std::move(shape.triangles);
    out.triangles.insert(out.triangles.end(), shape.clear.begin(), shape.clear.end());
    out.clear = shape.clear.size();
    for (std::size_t l = 0; l < looks.size(); ++l)
        out.looks.push_back({std::move(looks[l].first), std::move(looks[l].second), std::move(shape.rgb[l])});
    if (shape.seen.size() == shape.positions.size()) out.seen = std::move(shape.seen);
    if (shape.single.size() == shape.positions.size()) out.single = std::move(shape.single);
    return out;
}

}  // namespace

io::ViewerSurface compose_surfaces(std::span<const PlacedSurface> surfaces) {
    VOXTONE_EXPECT(!surfaces.empty());
    const std::vector<std::string> names = common_names(surfaces);
    Shape whole;
    whole.rgb.resize(names.size());
    double place_mm = 0;
    for (const PlacedSurface& one : surfaces) {
        const io::ViewerSurface& s = *one.surface;
        const auto looks = looks_named(s, names);
        const Shape shape = s.is_picture() ? shape_of_picture(s, looks) : shape_of_body(s, looks);
        for (const Eigen::Vector3d& at_mm : one.at_mm) append(whole, shape, at_mm);
        place_mm = std::max(place_mm, s.place_mm);
    }
    VOXTONE_EXPECT(!whole.positions.empty());
    std::vector<std::pair<std::string, std::string>> looks;
    for (const io::ViewerLook* look : looks_named(*surfaces[0].surface, names))
        looks.emplace_back(look->name, look->caption);
    const std::size_t places = whole.positions.size();
    io::ViewerSurface out = encoded(std::move(whole), std::move(looks));
    out.asked = surfaces[0].surface->asked, out.expected = surfaces[0].surface->expected;
    out.place_mm = place_mm;
    out.note = fmt::format("{} places up to {:.2f} mm apart; each part's own page shows it finer.", places, place_mm);
    return out;
}

ColouredSurface coloured_surface(const io::ViewerSurface& body, const io::ViewerLook& look,
                                 std::vector<Eigen::Vector3d>& positions_mm,
                                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
    positions_mm = shape_of_body(body, {}).positions;
    triangles.clear();
    constexpr std::size_t one_of = 6;  // of what is clear: a lattice, through which one sees what it holds
    const std::size_t opaque = body.triangles.size() - body.clear;
    for (std::size_t t = 0; t + 2 < body.triangles.size(); t += t < opaque ? 3 : 3 * one_of)
        triangles.push_back({body.triangles[t], body.triangles[t + 1], body.triangles[t + 2]});
    return {positions_mm, triangles, [&look, &triangles](std::uint32_t t, float u, float v) -> Eigen::Vector3f {
                const auto at = [&](std::uint32_t corner) {
                    const std::uint8_t* codes = look.rgb.data() + std::size_t{3} * corner;
                    const std::array<float, 256>& linear = io::srgb8_to_linear();
                    return Eigen::Vector3f(linear[codes[0]], linear[codes[1]], linear[codes[2]]);
                };
                const auto& [a, b, c] = triangles[t];
                return (1 - u - v) * at(a) + u * at(b) + v * at(c);
            }};
}

}  // namespace voxtone::slicer
