// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/painted_triangles.h"

#include <algorithm>
#include <map>
#include <utility>

#include "io/models/slicer_roles.h"

namespace voxtone::io {

namespace {

using Corners = std::array<std::uint32_t, 3>;

class PaintCutter {
public:
    explicit PaintCutter(std::span<const Eigen::Vector3d> vertices) {
        mesh_.vertices.assign(vertices.begin(), vertices.end());
        std::map<std::array<double, 3>, std::uint32_t> first;
        for (std::uint32_t v = 0; v < vertices.size(); ++v)
            at_place_.push_back(
                first.try_emplace({vertices[v].x(), vertices[v].y(), vertices[v].z()}, v).first->second);
    }

    PaintedMesh cut(std::span<const PaintInput> triangles) {
        std::vector<std::vector<PaintedTriangle>> pieces(triangles.size());
        for (std::size_t t = 0; t < triangles.size(); ++t) divide(triangles[t], pieces[t]);
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            mesh_.first.push_back(mesh_.pieces.size());
            for (const PaintedTriangle& piece : pieces[t]) add(piece, triangles[t].stays);
        }
        mesh_.first.push_back(mesh_.pieces.size());
        return std::move(mesh_);
    }

private:
    void divide(const PaintInput& input, std::vector<PaintedTriangle>& pieces) {
        const auto nodes = input.paint.empty() ? std::nullopt : paint_tree(input.paint);
        if (input.stays || !nodes) {
            pieces.push_back(input.triangle);
            return;
        }
        std::size_t next = 0;
        divide(*nodes, next, input.triangle.corners, pieces);
    }

    /// The node at `next`, which goes behind it.
    void divide(const std::vector<PaintNode>& nodes, std::size_t& next, const Corners& t,
                std::vector<PaintedTriangle>& pieces) {
        const PaintNode& node = nodes[next++];
        if (node.sides == 0) {
            pieces.push_back({t, node.extruder});
            return;
        }
        std::array<Corners, 4> children{};
        const std::uint32_t a = t[node.corner], b = t[(node.corner + 1u) % 3], c = t[(node.corner + 2u) % 3];
        if (node.sides == 1) {
            const std::uint32_t bc = middle(b, c);
            children = {{{a, b, bc}, {bc, c, a}}};
        } else if (node.sides == 2) {
            const std::uint32_t ab = middle(a, b), ca = middle(c, a);
            children = {{{a, ab, ca}, {ab, b, ca}, {b, c, ca}}};
        } else {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            children = {{{a, ab, ca}, {ab, b, bc}, {bc, c, ca}, {ab, bc, ca}}};
        }
        for (std::size_t child = node.sides + std::size_t{1}; child-- > 0;)
            divide(nodes, next, children[child], pieces);
    }

    std::pair<std::uint32_t, std::uint32_t> side(std::uint32_t a, std::uint32_t b) const {
        return std::minmax({at_place_[a], at_place_[b]});
    }

    std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
        const auto [known, is_new] =
            middles_.try_emplace(side(a, b), static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (is_new) {
            mesh_.vertices.push_back((mesh_.vertices[a] + mesh_.vertices[b]) / 2);
            at_place_.push_back(known->second);
        }
        return known->second;
    }

    /// Cut at every middle of its sides that somebody has.
    void add(const PaintedTriangle& piece, bool stays) {
        std::vector<Corners> open{piece.corners};
        while (!open.empty()) {
            const Corners t = open.back();
            open.pop_back();
            std::size_t e = 0;
            auto cut = middles_.end();
            for (; e < 3 && !stays; ++e)
                if ((cut = middles_.find(side(t[e], t[(e + 1) % 3]))) != middles_.end()) break;
            if (cut == middles_.end()) {
                mesh_.pieces.push_back({t, piece.extruder});
                continue;
            }
            const std::uint32_t a = t[e], b = t[(e + 1) % 3], c = t[(e + 2) % 3], ab = cut->second;
            open.push_back({ab, b, c});
            open.push_back({a, ab, c});
        }
    }

    PaintedMesh mesh_;
    std::vector<std::uint32_t> at_place_;  ///< of each vertex the first in its place
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

}  // namespace

PaintedMesh cut_by_paint(std::span<const Eigen::Vector3d> vertices, std::span<const PaintInput> triangles) {
    return PaintCutter(vertices).cut(triangles);
}

}  // namespace voxtone::io
