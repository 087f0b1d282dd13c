// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/shell_kernel.h"

#include <Eigen/Geometry>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slicer/surface/shell_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace voxtone::slicer::shell_kernel {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, row_voxels>;
using V = hn::Vec<D>;

struct Parts {
    V height2, outside2[3];
    hn::Mask<D> inside;
};

// The functions of LocalTriangle for given values of the seven linear ones.
HWY_INLINE Parts parts_of(const LocalTriangle& t, V h, const V s[3], const V along[3]) {
    const D d;
    const V zero = hn::Zero(d);
    Parts p;
    p.height2 = hn::Mul(h, h);
    V overshoot0 = zero;
    for (int e = 0; e < 3; ++e) {
        const V before = hn::Sub(hn::Set(d, t.before[e]), along[e]);
        const V after = hn::Add(hn::Set(d, t.after[e]), along[e]);
        const V overshoot = hn::Max(hn::Max(before, after), zero);
        if (e == 0) overshoot0 = overshoot;
        p.outside2[e] = hn::Add(hn::Mul(s[e], s[e]), hn::Mul(overshoot, overshoot));
    }
    const V least = hn::Min(hn::Min(s[0], s[1]), s[2]);
    p.inside = hn::And(hn::Ge(least, zero), hn::Le(overshoot0, zero));
    return p;
}

HWY_INLINE V distance2_of(const Parts& p) {
    const D d;
    const V outside2 = hn::Min(hn::Min(p.outside2[0], p.outside2[1]), p.outside2[2]);
    return hn::Add(p.height2, hn::IfThenElse(p.inside, hn::Zero(d), outside2));
}

void Distances2(const LocalTriangle& t, const float* x, const float* y, const float* z, float* out) {
    const D d;
    for (std::size_t l = 0; l < row_voxels; l += hn::Lanes(d)) {
        const V px = hn::LoadU(d, x + l), py = hn::LoadU(d, y + l), pz = hn::LoadU(d, z + l);
        const auto linear = [&](int f) {
            const V yz = hn::Add(hn::Add(hn::Set(d, t.constant[f]), hn::Mul(hn::Set(d, t.y[f]), py)),
                                 hn::Mul(hn::Set(d, t.z[f]), pz));
            return hn::Add(yz, hn::Mul(hn::Set(d, t.x[f]), px));
        };
        const V s[3] = {linear(1), linear(2), linear(3)}, along[3] = {linear(4), linear(5), linear(6)};
        hn::StoreU(distance2_of(parts_of(t, linear(0), s, along)), d, out + l);
    }
}

// The parts of the linear functions that are the same along a row.
HWY_INLINE void row_constants(const LocalTriangle& t, float y, float z, float* HWY_RESTRICT out) {
    const D d;
    for (std::size_t f = 0; f < 8; f += hn::Lanes(d)) {
        const V yz =
            hn::Add(hn::Add(hn::LoadU(d, t.constant.data() + f), hn::Mul(hn::LoadU(d, t.y.data() + f), hn::Set(d, y))),
                    hn::Mul(hn::LoadU(d, t.z.data() + f), hn::Set(d, z)));
        hn::StoreU(yz, d, out + f);
    }
}

bool Nearest(const LocalTriangle* const* triangles, std::size_t count, const BlockPoints& points, float limit2,
             std::uint8_t* bits, BlockResult& result) {
    const D d;
    const hn::RebindToSigned<D> di;
    const V slack = hn::Set(d, 1 - 4e-6f), offset = hn::Set(d, 1e-8f);
    const V far = hn::Set(d, 1e30f);
    for (int row = 0; row < points.rows; ++row) {
        if (!bits[row]) continue;
        for (std::size_t l = 0; l < row_voxels; l += hn::Lanes(d)) {
            const std::size_t at = std::size_t(row) * row_voxels + l;
            hn::Store(far, d, result.distance2.data() + at);
            hn::Store(far, d, result.chosen2.data() + at);
            hn::Store(hn::Zero(di), di, result.slot.data() + at);
        }
    }
    for (std::size_t n = 0; n < count; ++n) {
        const LocalTriangle& t = *triangles[n];
        const auto index = hn::Set(di, static_cast<std::int32_t>(n));
        for (std::size_t l = 0; l < row_voxels; l += hn::Lanes(d)) {
            const V px = hn::Load(d, points.x.data() + l);
            V x[7];
            for (int f = 0; f < 7; ++f) x[f] = hn::Mul(hn::Set(d, t.x[f]), px);
            for (int row = 0; row < points.rows; ++row) {
                if (!bits[row]) continue;
                alignas(32) float constants[8];
                row_constants(t, points.y[row], points.z[row], constants);
                const auto linear = [&](int f) { return hn::Add(hn::Set(d, constants[f]), x[f]); };
                const V s[3] = {linear(1), linear(2), linear(3)}, along[3] = {linear(4), linear(5), linear(6)};
                const V distance2 = distance2_of(parts_of(t, linear(0), s, along));

                const std::size_t at = std::size_t(row) * row_voxels + l;
                const V chosen2 = hn::Load(d, result.chosen2.data() + at);
                const auto better = hn::Lt(distance2, hn::Sub(hn::Mul(chosen2, slack), offset));
                hn::Store(hn::IfThenElse(better, distance2, chosen2), d, result.chosen2.data() + at);
                hn::Store(hn::IfThenElse(hn::RebindMask(di, better), index, hn::Load(di, result.slot.data() + at)), di,
                          result.slot.data() + at);
                hn::Store(hn::Min(distance2, hn::Load(d, result.distance2.data() + at)), d,
                          result.distance2.data() + at);
            }
        }
    }
    const V limit = hn::Set(d, limit2);
    bool any = false;
    for (int row = 0; row < points.rows; ++row) {
        if (!bits[row]) continue;
        unsigned within = 0;
        for (std::size_t l = 0; l < row_voxels; l += hn::Lanes(d)) {
            std::uint8_t mask[8] = {};
            hn::StoreMaskBits(
                d, hn::Le(hn::Load(d, result.distance2.data() + std::size_t(row) * row_voxels + l), limit), mask);
            within |= unsigned(mask[0]) << l;
        }
        bits[row] = std::uint8_t(bits[row] & within);
        any = any || bits[row];
    }
    return any;
}

void Finish(const LocalTriangle* const* triangles, const BlockPoints& points, const std::uint8_t* shell,
            BlockResult& result) {
    const D d;
    const hn::RebindToSigned<D> di;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const std::size_t lanes = hn::Lanes(d);
    for (int row = 0; row < points.rows; ++row) {
        for (std::size_t l = 0; l < row_voxels; l += lanes) {
            unsigned left = (shell[row] >> l) & ((1u << lanes) - 1);
            if (!left) continue;
            const std::size_t at = std::size_t(row) * row_voxels + l;
            hn::Store(hn::Sqrt(hn::Load(d, result.distance2.data() + at)), d, result.distance.data() + at);
            const V px = hn::Load(d, points.x.data() + l);
            const auto slots = hn::Load(di, result.slot.data() + at);
            while (left) {  // mostly one round: neighbours share their triangle
                const std::int32_t slot = result.slot[at + std::size_t(__builtin_ctz(left))];
                const LocalTriangle& t = *triangles[slot];
                const auto mine = hn::RebindMask(d, hn::Eq(slots, hn::Set(di, slot)));
                for (std::size_t i = 0; i < lanes; ++i)
                    if (result.slot[at + i] == slot) left &= ~(1u << i);

                alignas(32) float constants[8];
                row_constants(t, points.y[row], points.z[row], constants);
                const auto linear = [&](int f) {
                    return hn::Add(hn::Set(d, constants[f]), hn::Mul(hn::Set(d, t.x[f]), px));
                };
                const V s[3] = {linear(1), linear(2), linear(3)}, along[3] = {linear(4), linear(5), linear(6)};
                const Parts p = parts_of(t, linear(0), s, along);

                // Weights of the corners where edges 1 and 2 start; the corner where edge 0 starts has the rest.
                const auto on_edge = [&](int e) {
                    const V from_start = hn::Sub(along[e], hn::Set(d, t.before[e]));
                    const V clamped = hn::Min(hn::Max(from_start, zero), hn::Set(d, t.length[e]));
                    return hn::Min(hn::Mul(clamped, hn::Set(d, t.inverse_length[e])), one);
                };
                // Inside, the weight of a corner is the distance to the opposite edge over the height of the corner.
                V w1, w2;
                if (t.sliver) {
                    w1 = on_edge(0);
                    w2 = zero;
                } else {
                    w1 = hn::Min(hn::Mul(s[2], hn::Set(d, t.inverse_height[2])), one);
                    w2 = hn::Min(hn::Mul(s[0], hn::Set(d, t.inverse_height[0])), one);
                }
                if (!hn::AllTrue(d, hn::Or(p.inside, hn::Not(mine)))) {
                    const V t0 = on_edge(0), t1 = on_edge(1), t2 = on_edge(2);
                    V e1 = t0, e2 = zero;
                    const auto nearer1 = hn::Lt(p.outside2[1], p.outside2[0]);
                    e1 = hn::IfThenElse(nearer1, hn::Sub(one, t1), e1);
                    e2 = hn::IfThenElse(nearer1, t1, e2);
                    const auto nearer2 = hn::Lt(p.outside2[2], hn::Min(p.outside2[0], p.outside2[1]));
                    e1 = hn::IfThenElse(nearer2, zero, e1);
                    e2 = hn::IfThenElse(nearer2, hn::Sub(one, t2), e2);
                    w1 = hn::IfThenElse(p.inside, w1, e1);
                    w2 = hn::IfThenElse(p.inside, w2, e2);
                }
                w2 = hn::Min(w2, hn::Sub(one, w1));
                const auto interpolate = [&](int c) {
                    const V start = hn::Set(d, t.uv[0][c]);
                    return hn::Add(hn::Add(start, hn::Mul(w1, hn::Set(d, t.uv[1][c] - t.uv[0][c]))),
                                   hn::Mul(w2, hn::Set(d, t.uv[2][c] - t.uv[0][c])));
                };
                hn::Store(hn::IfThenElse(mine, interpolate(0), hn::Load(d, result.u.data() + at)), d,
                          result.u.data() + at);
                hn::Store(hn::IfThenElse(mine, interpolate(1), hn::Load(d, result.v.data() + at)), d,
                          result.v.data() + at);
            }
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace voxtone::slicer::shell_kernel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::slicer::shell_kernel {

using Eigen::Vector3d;

HWY_EXPORT(Distances2);
HWY_EXPORT(Nearest);
HWY_EXPORT(Finish);

LocalTriangle make_local(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const std::array<Eigen::Vector2f, 3>& uv, const Vector3d& centre) {
    const Vector3d* corner[3] = {&a, &b, &c};
    double length[3];
    for (int e = 0; e < 3; ++e) length[e] = (*corner[(e + 1) % 3] - *corner[e]).norm();
    const int first = length[0] >= length[1] && length[0] >= length[2] ? 0 : length[1] >= length[2] ? 1 : 2;
    const auto turned = [&](int e) { return (first + e) % 3; };

    Vector3d start[3], along[3], inward[3];
    for (int e = 0; e < 3; ++e) start[e] = *corner[turned(e)];
    const double longest = length[turned(0)];
    along[0] = longest > 0 ? Vector3d((start[1] - start[0]) / longest) : Vector3d::UnitX();
    const Vector3d area_vector = (start[1] - start[0]).cross(start[2] - start[0]);
    const double area2 = area_vector.norm();
    const double height = longest > 0 ? area2 / longest : 0;
    // Flatter than that the normal is noise; the third corner is then taken to lie on the longest edge's line.
    const bool flat = height < 1e-9 || height < 1e-7 * longest;
    const Vector3d normal = flat ? along[0].unitOrthogonal() : Vector3d(area_vector / area2);
    for (int e = 1; e < 3; ++e) {
        const Vector3d edge = start[(e + 1) % 3] - start[e];
        const double l = length[turned(e)];
        along[e] = !flat ? Vector3d(edge / l) : edge.dot(along[0]) < 0 ? Vector3d(-along[0]) : along[0];
    }
    for (int e = 0; e < 3; ++e) inward[e] = normal.cross(along[e]);

    LocalTriangle t{};
    const auto set = [&](int f, const Vector3d& direction, double constant) {
        t.x[f] = float(direction[0]);
        t.y[f] = float(direction[1]);
        t.z[f] = float(direction[2]);
        t.constant[f] = float(constant);
    };
    set(0, normal, normal.dot(centre - start[0]));
    for (int e = 0; e < 3; ++e) {
        const double l = length[turned(e)], from_start = along[e].dot(centre - start[e]);
        set(1 + e, inward[e], inward[e].dot(centre - start[e]));
        set(4 + e, along[e], 0);
        t.before[e] = float(-from_start);
        t.after[e] = float(from_start - l);
        t.length[e] = float(l);
        t.inverse_length[e] = l > 0 ? float(1 / l) : 0;
        t.inverse_height[e] = area2 > 0 ? float(l / area2) : 0;
        t.uv[e] = {uv[turned(e)][0], uv[turned(e)][1]};
    }
    t.sliver = flat || height < 1e-4;
    return t;
}

void distances2(const LocalTriangle& triangle, const float* x, const float* y, const float* z, float* out) {
    HWY_DYNAMIC_DISPATCH(Distances2)(triangle, x, y, z, out);
}

bool nearest(const LocalTriangle* const* triangles, std::size_t count, const BlockPoints& points, float limit2,
             std::uint8_t* bits, BlockResult& result) {
    return HWY_DYNAMIC_DISPATCH(Nearest)(triangles, count, points, limit2, bits, result);
}

void finish(const LocalTriangle* const* triangles, const BlockPoints& points, const std::uint8_t* shell,
            BlockResult& result) {
    HWY_DYNAMIC_DISPATCH(Finish)(triangles, points, shell, result);
}

int instruction_sets() {
    return __builtin_popcountll(std::uint64_t(hwy::SupportedTargets()) & std::uint64_t(HWY_TARGETS));
}

void choose_instruction_set(int index) {
    hwy::SetSupportedTargetsForTest(0);
    if (index >= 0) {
        std::uint64_t sets = std::uint64_t(hwy::SupportedTargets()) & std::uint64_t(HWY_TARGETS);
        for (; index > 0; --index) sets &= sets - 1;
        hwy::SetSupportedTargetsForTest(std::int64_t(sets & -sets));
    }
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace voxtone::slicer::shell_kernel
#endif
