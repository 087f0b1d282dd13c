// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/evenness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "base/parallel.h"
#include "halftone/loop/eye_filter.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

Eigen::Vector3d lab_of(const Eigen::Vector3f& rgb) {
    return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
}

/// Places in a region's cells of those of it that touch each one, itself too.
std::vector<std::vector<std::uint32_t>> touching(const halftone::ColourRegion& region,
                                                 const halftone::CellNeighbours& cells) {
    const std::vector<std::uint32_t>& own = region.cells;
    std::vector<std::vector<std::uint32_t>> near(own.size());
    parallel_for(0, own.size(), 1024, [&](std::size_t n) {
        cells.visit_around(own[n], [&](std::size_t other) {
            const auto at = std::ranges::lower_bound(own, static_cast<std::uint32_t>(other));
            if (at != own.end() && *at == other) near[n].push_back(static_cast<std::uint32_t>(at - own.begin()));
        });
    });
    return near;
}

/// Values less their means over some 0.2 mm.
template <class Value>
std::vector<Value> fast_part(const std::vector<std::vector<std::uint32_t>>& near, std::vector<Value> values) {
    constexpr int rounds = 8;
    std::vector<Value> slow = values, means(values.size());
    for (int round = 0; round < rounds; ++round, std::swap(slow, means))
        parallel_for(0, values.size(), 1024, [&](std::size_t n) {
            Value sum = Value::Zero();
            for (const std::uint32_t other : near[n]) sum += slow[other];
            means[n] = sum / double(near[n].size());
        });
    for (std::size_t n = 0; n < values.size(); ++n) values[n] -= slow[n];
    return values;
}

std::vector<Eigen::Vector3f> blurred(const optics::Surface& surface, std::span<const Eigen::Vector3f> values,
                                     double spread_mm) {
    constexpr double degrees = 0.0283;  // the narrowest Gaussian's spread (eye_filter.h)
    return halftone::EyeFilter(surface, spread_mm / std::tan(degrees * std::numbers::pi / 180),
                               halftone::EyeSurround::none, halftone::OpponentSpace::cielab,
                               halftone::EyeParts::narrowest)
        .smoothed(values);
}

}  // namespace

std::vector<EdgeTerms> edge_terms(const optics::Surface& surface, std::span<const Eigen::Vector3f> asked,
                                  std::span<const Eigen::Vector3f> seen) {
    constexpr double narrow_mm = 0.25, wide_mm = 0.5;
    std::vector<Eigen::Vector3f> place, normal;
    for (const optics::SurfaceCell& cell : surface.cells) {
        place.emplace_back(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]);
        normal.emplace_back(cell.normal[0], cell.normal[1], cell.normal[2]);
    }
    const auto narrow = blurred(surface, asked, narrow_mm), wide = blurred(surface, asked, wide_mm),
               places = blurred(surface, place, wide_mm), normals = blurred(surface, normal, wide_mm);
    std::vector<EdgeTerms> terms(asked.size());
    parallel_for(0, terms.size(), 1024, [&](std::size_t i) {
        const Eigen::Vector3d own = lab_of(seen[i]);
        terms[i] << lab_of(narrow[i]) - own, lab_of(wide[i]) - own, double(normal[i].dot(places[i] - place[i])),
            1 - double(normals[i].norm());
    });
    return terms;
}

double unevenness_of(const halftone::ColourRegion& region, const halftone::CellNeighbours& cells,
                     std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print,
                     std::span<const EdgeTerms> edges) {
    constexpr int terms = EdgeTerms::RowsAtCompileTime;
    const optics::Surface& surface = cells.surface();
    std::vector<Eigen::Vector3d> off(region.cells.size());
    parallel_for(0, off.size(), 1024,
                 [&](std::size_t n) { off[n] = lab_of(print[region.cells[n]]) - lab_of(target[region.cells[n]]); });
    std::vector<EdgeTerms> edge;
    for (const std::uint32_t i : region.cells) edge.push_back(edges[i]);
    const auto near = touching(region, cells);
    off = fast_part(near, std::move(off)), edge = fast_part(near, std::move(edge));
    std::vector<std::size_t> inside;  // places in the region's cells
    for (const std::uint32_t i : region.interior)
        inside.push_back(std::size_t(std::ranges::lower_bound(region.cells, i) - region.cells.begin()));
    Eigen::Vector3d printed = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, terms, terms> square = Eigen::Matrix<double, terms, terms>::Zero();
    Eigen::Matrix<double, terms, 3> product = Eigen::Matrix<double, terms, 3>::Zero();
    double area = 0, squares = 0;
    for (const std::size_t n : inside) {
        const double a = surface.cells[region.cells[n]].area_mm2;
        area += a, printed += a * lab_of(print[region.cells[n]]);
        square += a * edge[n] * edge[n].transpose(), product += a * edge[n] * off[n].transpose();
    }
    if (!(area > 0)) return 0;
    printed /= area;
    // Terms that do not differ within the region, as shape on a page, say nothing.
    constexpr double least = 1e-9;
    square.diagonal().array() += least;
    const Eigen::Matrix<double, terms, 3> of_edges = square.ldlt().solve(product);
    for (const std::size_t n : inside) {
        const double a = surface.cells[region.cells[n]].area_mm2;
        const double d = optics::ciede2000(printed, printed + off[n] - of_edges.transpose() * edge[n]);
        squares += a * d * d;
    }
    return std::sqrt(squares / area);
}

}  // namespace voxtone::slicer
