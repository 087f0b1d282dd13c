// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/thin_features.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "slicer/mesh/exact_predicates.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/solid/line_crossings.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

constexpr int bucket_layers = FixedMesh::bucket_layers;

using Voxel = std::array<int, 3>;

bool in_memory_order(const Voxel& a, const Voxel& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); }

// The body of some layers as bits; nothing outside of them.
class LayerBits {
public:
    LayerBits(const SpanSlab& slab, int width)
        : width_(width), k_begin_(slab.k_begin()), k_end_(slab.k_end()), rows_(slab.rows()) {
        words_ = std::size_t(width + 63) / 64;
        bits_.assign(words_ * std::size_t(rows_) * std::size_t(k_end_ - k_begin_), 0);
        for (int k = k_begin_; k < k_end_; ++k)
            for (int j = 0; j < rows_; ++j)
                for (const Span& s : slab.row(j, k)) fill(s, j, k);
    }
    [[nodiscard]] bool get(std::int64_t i, std::int64_t j, std::int64_t k) const {
        if (i < 0 || i >= width_ || j < 0 || j >= rows_ || k < k_begin_ || k >= k_end_) return false;
        return bits_[word(j, k) + std::size_t(i) / 64] >> (i % 64) & 1;
    }
    void set(const Voxel& v) { bits_[word(v[1], v[2]) + std::size_t(v[0]) / 64] |= std::uint64_t{1} << (v[0] % 64); }
    /// Voxels i .. i + 3 of a row as bits.
    [[nodiscard]] unsigned four(int i, int j, int k) const {
        if (j < 0 || j >= rows_ || k < k_begin_ || k >= k_end_) return 0;
        if (i >= 0 && i / 64 == (i + 3) / 64 && i + 3 < width_)
            return unsigned(bits_[word(j, k) + std::size_t(i) / 64] >> (i % 64)) & 15u;
        unsigned bits = 0;
        for (int n = 0; n < 4; ++n) bits |= unsigned(get(i + n, j, k)) << n;
        return bits;
    }

private:
    [[nodiscard]] std::size_t word(std::int64_t j, std::int64_t k) const {
        return (std::size_t(k - k_begin_) * std::size_t(rows_) + std::size_t(j)) * words_;
    }
    void fill(Span s, int j, int k) {
        std::uint64_t* const line = bits_.data() + word(j, k);
        const auto first = std::size_t(s.begin) / 64, last = std::size_t(s.end - 1) / 64;
        const std::uint64_t from = ~std::uint64_t{0} << (s.begin % 64),
                            to = ~std::uint64_t{0} >> (63 - (s.end - 1) % 64);
        if (first == last) {
            line[first] |= from & to;
            return;
        }
        line[first] |= from;
        std::fill(line + first + 1, line + last, ~std::uint64_t{0});
        line[last] |= to;
    }

    int width_, k_begin_, k_end_, rows_;
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

// What the voxels around two neighbouring (or equal) ones hold.
struct Surroundings {
    bool first_empty, second_empty, connected;
};

Surroundings look_around(const LayerBits& body, const Voxel& v, const Voxel& w) {
    // Both neighbourhoods fit a box of 4 x 4 x 4 voxels: bit x + 4 y + 16 z.
    Voxel low, v_at, w_at;
    for (int a = 0; a < 3; ++a) {
        low[a] = std::min(v[a], w[a]) - 1;
        v_at[a] = v[a] - 1 - low[a];  // where its 3 x 3 x 3 voxels start
        w_at[a] = w[a] - 1 - low[a];
    }
    constexpr std::uint64_t cube = 0x0000077707770777;  // 3 x 3 x 3 voxels from the box's corner
    const auto around = [&](const Voxel& at) { return cube << (at[0] + 4 * at[1] + 16 * at[2]); };
    const std::uint64_t around_v = around(v_at), around_w = around(w_at);
    std::uint64_t all = 0;
    for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 4; ++y) all |= std::uint64_t(body.four(low[0], low[1] + y, low[2] + z)) << (4 * y + 16 * z);
    all &= around_v | around_w;

    Surroundings s{(all & around_v) == 0, (all & around_w) == 0, true};
    std::uint64_t reached = all & -all;
    for (std::uint64_t before = 0; before != reached;) {
        before = reached;
        constexpr std::uint64_t not_first = 0xEEEEEEEEEEEEEEEE, not_last = 0x7777777777777777;
        std::uint64_t grown = reached | (reached << 1 & not_first) | (reached >> 1 & not_last);
        constexpr std::uint64_t not_first_row = 0xFFF0FFF0FFF0FFF0, not_last_row = 0x0FFF0FFF0FFF0FFF;
        grown |= (grown << 4 & not_first_row) | (grown >> 4 & not_last_row);
        grown |= grown << 16 | grown >> 16;
        reached = grown & all;
    }
    s.connected = reached == all;
    return s;
}

// A crossing of a grid line with the surface between two centres that are both outside.
struct Crossing {
    int axis;   // of the line
    Voxel gap;  // the voxel of the centre behind it
    double x;   // along the line, in voxels
    int step;
    std::uint32_t triangle;
    [[nodiscard]] auto key() const { return std::tie(axis, gap[2], gap[1], gap[0]); }
};

// The voxels that a segment passes, in turn: one axis steps at a time, at parameters that do not depend on where one
// starts.
class VoxelWalk {
public:
    VoxelWalk(const Vector3d& from, const Vector3d& to) : from_(from), way_(to - from) {
        for (int a = 0; a < 3; ++a) {
            first_[a] = int(std::floor(from[a]));
            steps_[a] = int(std::floor(to[a])) - first_[a];
            sign_[a] = steps_[a] < 0 ? -1 : 1;
            steps_[a] = std::abs(steps_[a]);
        }
    }
    /// Calls visit(voxel, next voxel, point) for each step between layers k_low and k_high; once with the same voxel
    /// twice if the segment stays in one.
    template <class Visit>
    void walk(int k_low, int k_high, Visit&& visit) const {
        if (steps_[0] + steps_[1] + steps_[2] == 0) {
            if (first_[2] >= k_low && first_[2] <= k_high) visit(first_, first_, from_ + 0.5 * way_);
            return;
        }
        // Steps along z that are done before the walk comes into the layers.
        std::array<int, 3> done{0, 0, 0};
        const int before = sign_[2] > 0 ? k_low - first_[2] : first_[2] - k_high;
        if (before > steps_[2]) return;
        if (before > 0) {
            done[2] = before;
            const double t = parameter(2, before);
            for (int a = 0; a < 2; ++a) {
                int n = std::clamp(int(std::floor(std::abs(t * way_[a]))), 0, steps_[a]);
                while (n > 0 && parameter(a, n) > t) --n;
                while (n < steps_[a] && parameter(a, n + 1) <= t) ++n;
                done[a] = n;
            }
        }
        Voxel here = at(done);
        while (here[2] >= k_low && here[2] <= k_high) {
            int axis = -1;
            double t = INFINITY;
            for (int a = 0; a < 3; ++a)
                if (done[a] < steps_[a] && parameter(a, done[a] + 1) < t) t = parameter(a, done[a] + 1), axis = a;
            if (axis < 0) return;
            ++done[axis];
            const Voxel next = at(done);
            visit(here, next, from_ + std::clamp(t, 0.0, 1.0) * way_);
            here = next;
        }
    }

private:
    [[nodiscard]] double parameter(int a, int step) const {
        const double border = sign_[a] > 0 ? first_[a] + step : first_[a] - step + 1;
        return (border - from_[a]) / way_[a];
    }
    [[nodiscard]] Voxel at(const std::array<int, 3>& done) const {
        return {first_[0] + sign_[0] * done[0], first_[1] + sign_[1] * done[1], first_[2] + sign_[2] * done[2]};
    }

    Vector3d from_, way_;
    Voxel first_;
    std::array<int, 3> steps_, sign_;
};

// Voxel coordinates with voxel (i, j, k) from i to i + 1 and so on.
Vector3d in_voxels(const FixedMesh& mesh, std::uint32_t vertex) {
    const auto& v = mesh.vertices[vertex];
    return Vector3d(v[0], v[1], v[2]) * std::ldexp(1.0, -mesh.fraction_bits) + Vector3d(0.5, 0.5, 0.5);
}

// Every crossing of grid lines with the surface in the layers [k_begin, k_end) (and the gaps next to them, along z)
// where the centres on both sides are outside.
std::vector<Crossing> crossings_between_outside(const FixedMesh& mesh, const VoxelGrid& grid, const LayerBits& body,
                                                int k_begin, int k_end) {
    std::vector<Crossing> found;
    mesh.for_each_triangle(k_begin, k_end, [&](std::uint32_t t, int first, int last) {
        const auto& corners = mesh.triangles[t];
        // The part of the triangle near these layers spans, in voxels:
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        const double z_low = first - 1, z_high = last;
        std::array<Vector3d, 3> p;
        for (int c = 0; c < 3; ++c) p[c] = in_voxels(mesh, corners[c]) - Vector3d(0.5, 0.5, 0.5);
        const auto add = [&](const Vector3d& q) {
            for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], q[a]), high[a] = std::max(high[a], q[a]);
        };
        for (int c = 0; c < 3; ++c) {
            const Vector3d &a = p[c], &b = p[(c + 1) % 3];
            if (a[2] >= z_low && a[2] <= z_high) add(a);
            for (const double z : {z_low, z_high})
                if ((a[2] < z) != (b[2] < z)) add(a + (b - a) * ((z - a[2]) / (b[2] - a[2])));
        }
        if (low[0] > high[0]) return;
        std::int64_t begin[2], end[2];
        for (int a = 0; a < 2; ++a) {
            begin[a] = std::int64_t(std::clamp(std::floor(low[a]) - 1, 0.0, double(grid.size[a])));
            end[a] = std::int64_t(std::clamp(std::ceil(high[a]) + 2, 0.0, double(grid.size[a])));
        }
        const auto turned = [&](int axis) {
            std::array<FixedMesh::Vertex, 3> v;
            for (int c = 0; c < 3; ++c)
                for (int a = 0; a < 3; ++a) v[c][a] = mesh.vertices[corners[c]][(axis + a) % 3];
            return v;
        };
        for_each_line_crossing(turned(0), mesh.fraction_bits, {begin[1], end[1], first, last},
                               [&](std::int64_t j, std::int64_t k, std::int64_t i, double x, std::int32_t step) {
                                   if (!body.get(i - 1, j, k) && !body.get(i, j, k))
                                       found.push_back({0, {int(i), int(j), int(k)}, x, step, t});
                               });
        for_each_line_crossing(turned(1), mesh.fraction_bits, {first, last, begin[0], end[0]},
                               [&](std::int64_t k, std::int64_t i, std::int64_t j, double x, std::int32_t step) {
                                   if (!body.get(i, j - 1, k) && !body.get(i, j, k))
                                       found.push_back({1, {int(i), int(j), int(k)}, x, step, t});
                               });
        for_each_line_crossing(turned(2), mesh.fraction_bits,
                               {begin[0], end[0], begin[1], end[1], double(first - 1), double(last)},
                               [&](std::int64_t i, std::int64_t j, std::int64_t k, double x, std::int32_t step) {
                                   // Pieces of layers share no gap: the last one has the gap above it too.
                                   if (k < first || k > last || (k == last && last != k_end)) return;
                                   if (!body.get(i, j, k - 1) && !body.get(i, j, k))
                                       found.push_back({2, {int(i), int(j), int(k)}, x, step, t});
                               });
    });
    return found;
}

// The voxels that plates need: of crossings along one grid line in one gap, sorted, those that leave the body again
// through faces that look away from each other.
std::vector<Voxel> find_plates(std::span<const Crossing> crossings, const VoxelGrid& grid,
                               const std::function<Vector3d(std::uint32_t)>& normal, int k_begin, int k_end) {
    std::vector<Voxel> plates;
    for (std::size_t n = 0; n < crossings.size();) {
        const Crossing& first = crossings[n];
        double low = first.x, high = first.x;
        int sum = 0;
        bool plate = false;  // or the ridge of a thick body, whose sides do not face away from each other
        std::size_t m = n;
        for (; m < crossings.size() && crossings[m].key() == first.key(); ++m) {
            low = std::min(low, crossings[m].x);
            high = std::max(high, crossings[m].x);
            sum += crossings[m].step;
            for (std::size_t before = n; before < m; ++before)
                plate = plate || normal(crossings[before].triangle).dot(normal(crossings[m].triangle)) < -0.5;
        }
        if (plate && sum == 0) {
            Voxel voxel = first.gap;
            int& along = voxel[first.axis];
            // A grid is rounded to its body (grid_around): what stands out by part of a voxel is of its last one.
            along = std::clamp(int(std::floor((low + high) / 2 + 0.5)), std::max(along - 1, 0),
                               std::min(along, grid.size[first.axis] - 1));
            if (voxel[2] >= k_begin && voxel[2] < k_end) plates.push_back(voxel);
        }
        n = m;
    }
    return plates;
}

// The layers [k_begin, k_end) of the body with some voxels added, which are sorted and each there once.
void merge(const SpanSlab& body, std::span<const Voxel> added, int k_begin, int k_end, int width, SpanSlab& out) {
    out.reset(k_begin, k_end, body.rows());
    auto next = added.begin();
    for (int k = k_begin; k < k_end; ++k)
        for (int j = 0; j < body.rows(); ++j) {
            const auto push_until = [&](int i) {
                for (; next != added.end() && (*next)[2] == k && (*next)[1] == j && (*next)[0] < i; ++next)
                    out.push((*next)[0], (*next)[0] + 1);
            };
            for (const Span& s : body.row(j, k)) {
                push_until(s.begin);
                out.push(s.begin, s.end);
            }
            push_until(width);
            out.end_row();
        }
}

}  // namespace

Vector3d ThinFeatures::normal(std::uint32_t triangle) const {
    const auto [a, b, c] = tree_.corners(triangle);
    const Vector3d n = (b - a).cross(c - a);
    return n.norm() > 0 ? Vector3d(n.normalized()) : Vector3d(Vector3d::Zero());
}

ThinFeatures::ThinFeatures(const SolidIndex& mesh, const Solid& solid)
    : mesh_(*mesh), solid_(solid), tree_(mesh.tree()) {
    for_each_edge(edge_uses(mesh->triangles), [&](std::span<const EdgeUse> uses) {
        Vector3d inward = Vector3d::Zero();
        for (const EdgeUse& u : uses.first(std::min<std::size_t>(uses.size(), 2))) inward -= normal(u.triangle);
        const double length = inward.norm();
        edges_.push_back({{uses[0].low, uses[0].high},
                          length > 1e-3 ? Eigen::Vector3f((inward / length).cast<float>()) : Eigen::Vector3f::Zero()});
    });
    const FixedMesh& fixed = solid.fixed_mesh();
    const int layers = solid.grid().size[2], buckets = (layers + bucket_layers - 1) / bucket_layers;
    const auto buckets_of = [&](const Edge& e) {
        const auto layer_of = [&](std::uint32_t corner) {
            return std::clamp(int(std::floor(in_voxels(fixed, corner)[2])), 0, layers - 1);
        };
        const auto [k0, k1] = std::minmax({layer_of(e.corner[0]), layer_of(e.corner[1])});
        return std::pair{k0 / bucket_layers, k1 / bucket_layers + 1};
    };
    bucket_begin_.assign(std::size_t(buckets) + 1, 0);
    for (const Edge& e : edges_) {
        const auto [first, last] = buckets_of(e);
        for (int b = first; b < last; ++b) ++bucket_begin_[std::size_t(b) + 1];
    }
    for (int b = 0; b < buckets; ++b) bucket_begin_[std::size_t(b) + 1] += bucket_begin_[std::size_t(b)];
    bucket_edges_.resize(bucket_begin_.back());
    std::vector<std::size_t> next(bucket_begin_.begin(), bucket_begin_.end() - 1);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [first, last] = buckets_of(edges_[e]);
        for (int b = first; b < last; ++b) bucket_edges_[next[std::size_t(b)]++] = static_cast<std::uint32_t>(e);
    }
}

bool ThinFeatures::thin_at(const Edge& edge, const Vector3d& p_mm) const {
    if (edge.inward.isZero(0)) return true;
    const double reach = solid_.grid().pitch_mm.norm();
    const Vector3d inward = edge.inward.cast<double>();
    const Vector3d from = p_mm + 1e-4 * reach * inward, to = p_mm + reach * inward;
    std::vector<std::uint32_t> near;
    tree_.overlapping(from.cwiseMin(to), from.cwiseMax(to), near);
    return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
        const auto& corners = mesh_.triangles[t];
        const bool own = std::count(corners.begin(), corners.end(), edge.corner[0]) &&
                         std::count(corners.begin(), corners.end(), edge.corner[1]);
        return !own && normal(t).dot(inward) > 0.3 && segment_meets_triangle(from, to, tree_.corners(t));
    });
}

std::uint64_t ThinFeatures::slab(int k_begin, int k_end, SpanSlab& out) const {
    const VoxelGrid& grid = solid_.grid();
    VOXTONE_EXPECT(0 <= k_begin && k_begin <= k_end && k_end <= grid.size[2]);
    const auto below = [&](int layers) { return std::max(k_begin - layers, 0); };
    const auto above = [&](int layers) { return std::min(k_end + layers, grid.size[2]); };
    SpanSlab base;
    solid_.slab(below(3), above(3), base);
    LayerBits body(base, grid.size[0]);

    // Plates, two layers farther than asked for, since the wires look around.
    std::vector<Crossing> crossings = crossings_between_outside(solid_.fixed_mesh(), grid, body, below(2), above(2));
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.key() < b.key(); });
    std::vector<Voxel> added = find_plates(
        crossings, grid, [this](std::uint32_t t) { return normal(t); }, below(2), above(2));
    for (const Voxel& v : added) body.set(v);

    // Wires and tips. Judged by the body with its plates alone, so that the order of the edges does not matter.
    std::vector<Voxel> wires;
    const FixedMesh& fixed = solid_.fixed_mesh();
    std::vector<std::uint32_t> edges;
    for (int b = below(1) / bucket_layers; b <= (above(1) - 1) / bucket_layers && k_begin < k_end; ++b)
        edges.insert(edges.end(), bucket_edges_.begin() + std::ptrdiff_t(bucket_begin_[std::size_t(b)]),
                     bucket_edges_.begin() + std::ptrdiff_t(bucket_begin_[std::size_t(b) + 1]));
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    const auto inside = [&](const Voxel& v) {
        return v[0] >= 0 && v[0] < grid.size[0] && v[1] >= 0 && v[1] < grid.size[1] && v[2] >= k_begin && v[2] < k_end;
    };
    // The part of a voxel by which a body may stand out of its grid (grid_around) is of the last voxel.
    const Vector3d last = Vector3d(grid.size[0], grid.size[1], grid.size[2]).array() - 1e-6;
    const auto drawn_in = [&](const Vector3d& p) { return Vector3d(p.cwiseMax(0).cwiseMin(last)); };
    for (const std::uint32_t e : edges) {
        const Edge& edge = edges_[e];
        VoxelWalk(drawn_in(in_voxels(fixed, edge.corner[0])), drawn_in(in_voxels(fixed, edge.corner[1])))
            .walk(k_begin - 1, k_end, [&](const Voxel& v, const Voxel& w, const Vector3d& p) {
                if (!inside(v) && !inside(w)) return;
                const bool v_in = body.get(v[0], v[1], v[2]), w_in = body.get(w[0], w[1], w[2]);
                if (v_in && w_in) return;
                const Surroundings s = look_around(body, v, w);
                if (!s.first_empty && !s.second_empty) {
                    if (s.connected) return;
                    if (!thin_at(edge, grid.origin_mm + grid.pitch_mm.cwiseProduct(p))) return;
                }
                if (!v_in && inside(v)) wires.push_back(v);
                if (!w_in && inside(w)) wires.push_back(w);
            });
    }
    added.insert(added.end(), wires.begin(), wires.end());

    std::erase_if(added, [&](const Voxel& v) { return v[2] < k_begin || v[2] >= k_end; });
    std::sort(added.begin(), added.end(), in_memory_order);
    added.erase(std::unique(added.begin(), added.end()), added.end());
    merge(base, added, k_begin, k_end, grid.size[0], out);
    return added.size();
}

}  // namespace voxtone::slicer
