// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/monte_carlo/path_packets.h"

#include <algorithm>
#include <cmath>

#include "voxtone/optics/monte_carlo/plain_paths.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxtone/optics/monte_carlo/path_packets.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include "voxtone/optics/monte_carlo/path_lanes-inl.h"
// clang-format on

#ifndef VOXTONE_PATH_PACKETS_ONCE
#define VOXTONE_PATH_PACKETS_ONCE
namespace voxtone::optics {
namespace {

constexpr std::size_t most_lanes = 64;
constexpr std::int32_t boundary_is_near = PathVolume::boundary_is_near;

/// The paths of a packet. Whole numbers below 2^24 are kept as floats.
struct Lanes {
    template <class T>
    using Row = std::array<T, most_lanes>;
    alignas(64) std::array<Row<float>, 3> at{}, direction{};
    alignas(64) std::array<Row<float>, 3> low{}, high{};  ///< the box
    alignas(64) Row<float> depth{}, weight{}, majorant{};
    alignas(64) Row<std::int32_t> base{}, alive{};
    alignas(64) Row<std::int32_t> meetings{}, meetings_allowed{};
    alignas(64) Row<std::int32_t> near{};  ///< the boundary may pass through the box
    alignas(64) std::array<Row<std::uint32_t>, 4> random{};
    Row<std::uint32_t> tag{};
};

}  // namespace
}  // namespace voxtone::optics
#endif

HWY_BEFORE_NAMESPACE();
namespace voxtone::optics::HWY_NAMESPACE {
/// `bounded`: the scene has a boundary of its own.
template <bool bounded>
class Packet {
public:
    Packet(const PacketScene& scene, PathSource& source)
        : scene_(scene), source_(source), few_materials_(scene.materials <= hn::Lanes(Tag())) {}

    void run() {
        const std::size_t n = hn::Lanes(Tag()), rows = 2;
        std::size_t alive = 0;
        for (std::size_t lane = 0; lane < n * rows; ++lane) alive += refill(lane);
        while (alive > 0)
            for (std::size_t row = 0; row < n * rows; row += n) alive -= step(row);
    }

private:
    /// A property of a material: where all fit, from one register.
    HWY_INLINE Float of_material(const float* table, Int material) const {
        const Tag d;
        if (few_materials_) return hn::TableLookupLanes(hn::LoadU(d, table), hn::IndicesFromVec(d, material));
        return gather(table, material);
    }

    /// One event of each path of a row. How many lanes found no other path when theirs ended.
    HWY_INLINE std::size_t step(std::size_t row) {
        const Tag d;
        const IntTag di;
        const BitTag db;
        const Float zero = hn::Zero(d), one = constant(1);
        const Mask none = hn::Lt(zero, zero);
        const Mask alive = hn::RebindMask(d, hn::Ne(hn::Load(di, lanes_.alive.data() + row), hn::Zero(di)));
        Random random{hn::Load(db, lanes_.random[0].data() + row), hn::Load(db, lanes_.random[1].data() + row),
                      hn::Load(db, lanes_.random[2].data() + row), hn::Load(db, lanes_.random[3].data() + row)};
        const Bits bits_a = random.next(), bits_b = random.next(), bits_c = random.next(), bits_d = random.next();
        hn::Store(random.s0, db, lanes_.random[0].data() + row);
        hn::Store(random.s1, db, lanes_.random[1].data() + row);
        hn::Store(random.s2, db, lanes_.random[2].data() + row);
        hn::Store(random.s3, db, lanes_.random[3].data() + row);
        const Float u = unit(bits_b);

        // To the particle or the side of the box, what comes first.
        Float at[3], dir[3], low[3], high[3], bound[3], t[3];
        Mask forward[3];
        for (std::size_t a = 0; a < 3; ++a) {
            at[a] = hn::Load(d, lanes_.at[a].data() + row);
            dir[a] = hn::Load(d, lanes_.direction[a].data() + row);
            low[a] = hn::Load(d, lanes_.low[a].data() + row);
            high[a] = hn::Load(d, lanes_.high[a].data() + row);
            forward[a] = hn::Gt(dir[a], zero);
            bound[a] = hn::IfThenElse(forward[a], high[a], low[a]);
            t[a] = hn::Div(hn::Mul(hn::Sub(bound[a], at[a]), constant(scene_.pitch_mm[a])), dir[a]);
        }
        const Float depth = hn::Load(d, lanes_.depth.data() + row);
        const Float majorant = hn::Load(d, lanes_.majorant.data() + row);
        const Float to_side = hn::Max(hn::Min(hn::Min(t[0], t[1]), t[2]), zero);
        const Float depth_to_side = hn::Mul(majorant, to_side);
        Mask collides = hn::Lt(depth, depth_to_side), crosses = hn::Not(collides), met = none;
        Float way = hn::IfThenElse(collides, hn::Div(depth, majorant), to_side);
        if constexpr (bounded) {
            const Mask near =
                hn::And(alive, hn::RebindMask(d, hn::Ne(hn::Load(di, lanes_.near.data() + row), hn::Zero(di))));
            if (!hn::AllFalse(d, near)) {
                met = meet_boundary(row, near, way);
                collides = hn::AndNot(met, collides);
                crosses = hn::AndNot(met, crosses);
            }
        }
        Mask axis[3];
        axis[0] = hn::And(crosses, hn::And(hn::Le(t[0], t[1]), hn::Le(t[0], t[2])));
        axis[1] = hn::And(hn::AndNot(axis[0], crosses), hn::Le(t[1], t[2]));
        axis[2] = hn::AndNot(axis[1], hn::AndNot(axis[0], crosses));

        // The voxel of interest: where the path is, or the one beyond the side.
        Float voxel[3];
        Mask outside = none, beyond_side = none;
        for (std::size_t a = 0; a < 3; ++a) {
            const Float moved = hn::Add(at[a], hn::Mul(hn::Mul(dir[a], way), constant(1 / scene_.pitch_mm[a])));
            at[a] = hn::IfThenElse(axis[a], bound[a], hn::Min(hn::Max(moved, low[a]), high[a]));
            hn::Store(at[a], d, lanes_.at[a].data() + row);
            voxel[a] = hn::Min(hn::Floor(at[a]), hn::Sub(high[a], one));
            voxel[a] =
                hn::IfThenElse(axis[a], hn::Sub(bound[a], hn::IfThenElseZero(hn::Not(forward[a]), one)), voxel[a]);
            const Mask out = hn::And(axis[a], hn::Or(hn::Lt(voxel[a], zero),
                                                     hn::Ge(voxel[a], constant(static_cast<float>(scene_.size[a])))));
            outside = hn::Or(outside, out);
            if (a < 2) beyond_side = hn::Or(beyond_side, out);
        }
        Mask mirrored = none;
        if (scene_.sides == Sides::mirrored) mirrored = beyond_side;

        Int i[3], block[3];
        for (std::size_t a = 0; a < 3; ++a) {
            i[a] = hn::ConvertTo(di, voxel[a]);
            block[a] = hn::ShiftRight<4>(i[a]);
        }
        Int base = hn::Load(di, lanes_.base.data() + row), block_index = hn::Zero(di);
        const bool any_crosses = !hn::AllFalse(d, crosses);
        if (any_crosses) {
            block_index = hn::Add(hn::Mul(hn::Add(hn::Mul(block[2], hn::Set(di, scene_.blocks[1])), block[1]),
                                          hn::Set(di, scene_.blocks[0])),
                                  block[0]);
            block_index = hn::IfThenZeroElse(hn::RebindMask(di, outside), block_index);
            const Int there = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(scene_.base), block_index);
            base = hn::IfThenElse(hn::RebindMask(di, crosses), there, base);
        }
        // What is outside is as the first entry says: air. A block of one material needs no look.
        Int content = hn::IfThenZeroElse(hn::RebindMask(di, outside), base);
        const auto several = hn::Gt(content, hn::Set(di, 255));
        if (hn::AllFalse(di, several)) {
            content = hn::Or(content, hn::Set(di, 4 << 8));
        } else {
            const Int fifteen = hn::Set(di, 15);
            const Int local = hn::Add(hn::ShiftLeft<8>(hn::And(i[2], fifteen)),
                                      hn::Add(hn::ShiftLeft<4>(hn::And(i[1], fifteen)), hn::And(i[0], fifteen)));
            const Int entry = hn::Add(content, hn::IfThenElseZero(several, local));
            content =
                hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(scene_.voxels), hn::ShiftLeft<1>(entry));
        }
        const Int material = hn::And(content, hn::Set(di, 255));

        Float weight = hn::Load(d, lanes_.weight.data() + row);
        Mask ends = none, leaves = none;
        Float next_depth = hn::Max(hn::Sub(depth, hn::Mul(majorant, way)), zero);

        if (!hn::AllFalse(d, collides)) {
            const Mask real = hn::And(
                collides, hn::Lt(hn::Mul(unit(bits_d), majorant), of_material(scene_.sigma_t.data(), material)));
            next_depth = hn::IfThenElse(collides, exponential(bits_a), next_depth);
            weight = hn::IfThenElse(real, hn::Mul(weight, of_material(scene_.albedo.data(), material)), weight);
            const Mask faint = hn::And(real, hn::Lt(weight, constant(scene_.roulette_weight)));
            const Float chance =
                hn::Mul(hn::ConvertTo(d, hn::And(hn::BitCast(di, bits_c), hn::Set(di, 0xffff))), constant(0x1p-16f));
            const Mask survives =
                hn::Lt(hn::Mul(hn::Add(chance, constant(0x1p-17f)), constant(scene_.roulette_weight)), weight);
            ends = hn::And(hn::AndNot(survives, faint), alive);
            weight = hn::IfThenElse(ends, zero, hn::IfThenElse(faint, constant(scene_.roulette_weight), weight));
            scatter(u, hn::ShiftRight<16>(bits_c), real, dir);
        }
        if (any_crosses) {
            const Mask surface =
                hn::And(hn::AndNot(mirrored, crosses), hn::RebindMask(d, hn::Eq(material, hn::Zero(di))));
            const Mask enters = hn::AndNot(surface, hn::AndNot(mirrored, crosses));
            const Int side = hn::Shl(hn::Set(di, 1), hn::And(hn::ShiftRight<8>(content), hn::Set(di, 15)));
            for (std::size_t a = 0; a < 3; ++a) {
                const Int first = hn::AndNot(hn::Sub(side, hn::Set(di, 1)), i[a]);
                const Int last = hn::Min(hn::Add(first, side), hn::Set(di, scene_.size[a]));
                hn::Store(hn::IfThenElse(enters, hn::ConvertTo(d, first), low[a]), d, lanes_.low[a].data() + row);
                hn::Store(hn::IfThenElse(enters, hn::ConvertTo(d, last), high[a]), d, lanes_.high[a].data() + row);
            }
            const Int old_base = hn::Load(di, lanes_.base.data() + row);
            hn::Store(hn::IfThenElse(hn::RebindMask(di, enters), base, old_base), di, lanes_.base.data() + row);
            hn::Store(hn::IfThenElse(enters, gather(scene_.majorant, block_index), majorant), d,
                      lanes_.majorant.data() + row);

            if constexpr (bounded) {
                const Int near = hn::And(content, hn::Set(di, boundary_is_near));
                const Int old_near = hn::Load(di, lanes_.near.data() + row);
                hn::Store(hn::IfThenElse(hn::RebindMask(di, enters), near, old_near), di, lanes_.near.data() + row);
            }

            Mask turns = mirrored;
            if (!hn::AllFalse(d, surface)) {
                const Float cosine = hn::Abs(hn::IfThenElse(axis[0], dir[0], hn::IfThenElse(axis[1], dir[1], dir[2])));
                const Mask reflected = hn::And(surface, hn::Lt(u, internal_reflectance(cosine, scene_.eta)));
                turns = hn::Or(turns, reflected);
                leaves = hn::And(hn::AndNot(reflected, surface), alive);
            }
            const Mask meets = hn::Or(surface, mirrored);
            const Int meetings = hn::Add(hn::Load(di, lanes_.meetings.data() + row),
                                         hn::IfThenElseZero(hn::RebindMask(di, meets), hn::Set(di, 1)));
            hn::Store(meetings, di, lanes_.meetings.data() + row);
            const Int allowed = hn::Load(di, lanes_.meetings_allowed.data() + row);
            const auto spent = hn::And(hn::Eq(meetings, allowed), hn::RebindMask(di, meets));
            const Mask many = hn::RebindMask(d, spent);
            hn::Store(hn::IfThenElse(spent, hn::Add(allowed, hn::ShiftRight<1>(allowed)), allowed), di,
                      lanes_.meetings_allowed.data() + row);
            const Mask stops = hn::And(many, hn::Lt(unit(bits_d), constant(0.5f)));
            weight = hn::IfThenElse(many, hn::IfThenElse(stops, zero, hn::Add(weight, weight)), weight);
            ends = hn::Or(ends, hn::And(stops, alive));
            for (std::size_t a = 0; a < 3; ++a)
                dir[a] = hn::IfThenElse(hn::And(turns, axis[a]), hn::Neg(dir[a]), dir[a]);
        }
        hn::Store(next_depth, d, lanes_.depth.data() + row);
        hn::Store(weight, d, lanes_.weight.data() + row);
        for (std::size_t a = 0; a < 3; ++a) hn::Store(dir[a], d, lanes_.direction[a].data() + row);

        std::size_t lost = 0;
        if constexpr (bounded) {
            if (!hn::AllFalse(d, met)) lost += leave_or_turn(row, met, u);
        }
        const Mask over = hn::Or(ends, leaves);
        if (HWY_LIKELY(hn::AllFalse(d, over))) return lost;
        const Mask down = hn::And(leaves, hn::And(axis[2], hn::Lt(voxel[2], zero)));
        return lost + settle(row, ends, over, down);
    }

    [[nodiscard]] std::array<float, 3> place(std::size_t lane) const {
        return {lanes_.at[0][lane], lanes_.at[1][lane], lanes_.at[2][lane]};
    }
    [[nodiscard]] Point place_mm(std::size_t lane) const {
        Point p{};
        for (std::size_t a = 0; a < 3; ++a)
            p[a] = (lanes_.at[a][lane] - scene_.offset) * static_cast<double>(scene_.pitch_mm[a]);
        return p;
    }

    /// Where paths would pass the boundary before their event: shortens their ways, keeps the normals.
    HWY_NOINLINE Mask meet_boundary(std::size_t row, Mask near, Float& way) {
        const Tag d;
        alignas(64) std::array<float, 16> ask, ways, met{};
        hn::Store(hn::IfThenElseZero(near, constant(1)), d, ask.data());
        hn::Store(way, d, ways.data());
        for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
            if (ask[k] == 0) continue;
            const std::size_t lane = row + k;
            double distance = 0;
            if (!scene_.boundary->leaves(place_mm(lane), direction(lane), static_cast<double>(ways[k]), distance,
                                         normals_[lane]))
                continue;
            ways[k] = static_cast<float>(distance);
            met[k] = 1;
        }
        way = hn::Load(d, ways.data());
        return hn::Gt(hn::Load(d, met.data()), hn::Zero(d));
    }

    /// What the boundary does to the paths that met it.
    HWY_NOINLINE std::size_t leave_or_turn(std::size_t row, Mask met, Float chance) {
        const Tag d;
        alignas(64) std::array<float, 16> here, u;
        hn::Store(hn::IfThenElseZero(met, constant(1)), d, here.data());
        hn::Store(chance, d, u.data());
        std::size_t lost = 0;
        for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
            if (here[k] == 0) continue;
            const std::size_t lane = row + k;
            Point at = place_mm(lane), way = direction(lane);
            const bool on_sheet = scene_.backing != Backing::none && normals_[lane].geometric[2] < -0.999 &&
                                  at[2] < 0.5 * static_cast<double>(scene_.pitch_mm[2]);
            const bool leaves =
                static_cast<double>(u[k]) >= turn_at_boundary(normals_[lane], static_cast<double>(scene_.eta), way);
            if (leaves && (!on_sheet || scene_.backing == Backing::black)) {
                source_.finished(lanes_.tag[lane], on_sheet ? 0.0f : lanes_.weight[lane], place(lane));
                lost += !refill(lane);
                continue;
            }
            if (++lanes_.meetings[lane] == lanes_.meetings_allowed[lane]) {
                lanes_.meetings_allowed[lane] += lanes_.meetings_allowed[lane] / 2;
                PathRandom random(random_state(lane));
                const bool stops = random.uniform() < 0.5;
                set_random_state(lane, random.state());
                if (stops) {
                    source_.finished(lanes_.tag[lane], 0.0f, place(lane));
                    lost += !refill(lane);
                    continue;
                }
                lanes_.weight[lane] *= 2;
            }
            if (leaves) {
                send_back_up(lane);
            } else {
                for (std::size_t a = 0; a < 3; ++a) lanes_.direction[a][lane] = safe_component(way[a]);
            }
            for (std::size_t a = 0; a < 3; ++a) {  // a little inward, within the box
                const double inward = at[a] - inside_boundary_mm * normals_[lane].geometric[a];
                const auto moved = static_cast<float>(inward / static_cast<double>(scene_.pitch_mm[a]) + scene_.offset);
                lanes_.at[a][lane] = std::clamp(moved, lanes_.low[a][lane], lanes_.high[a][lane]);
            }
        }
        return lost;
    }

    [[nodiscard]] Point direction(std::size_t lane) const {
        return {lanes_.direction[0][lane], lanes_.direction[1][lane], lanes_.direction[2][lane]};
    }
    [[nodiscard]] std::array<std::uint32_t, 4> random_state(std::size_t lane) const {
        return {lanes_.random[0][lane], lanes_.random[1][lane], lanes_.random[2][lane], lanes_.random[3][lane]};
    }
    void set_random_state(std::size_t lane, const std::array<std::uint32_t, 4>& state) {
        for (std::size_t k = 0; k < 4; ++k) lanes_.random[k][lane] = state[k];
    }
    void send_back_up(std::size_t lane) {
        auto state = random_state(lane);
        const auto up = source_.entering_up(state);
        set_random_state(lane, state);
        for (std::size_t a = 0; a < 3; ++a) lanes_.direction[a][lane] = up[a];
    }

    /// dir, where `real`: turned by the angle of Henyey and Greenstein. With D = 1 - g + 2 g u, u uniform,
    ///   1 - cos = 2 (1 - g)^2 (1 - u) (1 + g u) / D^2,
    /// the inverse of its distribution, free of cancellation and of a special case for g = 0.
    HWY_INLINE void scatter(Float u, Bits turn, Mask real, Float* dir) const {
        const Tag d;
        const Float one = constant(1);
        const float g = scene_.g;
        const Float D = hn::Add(hn::Mul(u, constant(2 * g)), constant(1 - g));
        const Float m = hn::Div(
            hn::Mul(hn::Mul(hn::Sub(one, u), constant(2 * (1 - g) * (1 - g))), hn::Add(one, hn::Mul(u, constant(g)))),
            hn::Mul(D, D));
        const Float cosine = hn::Sub(one, m);
        const Float sine = hn::Sqrt(hn::Max(hn::Mul(m, hn::Sub(constant(2), m)), hn::Zero(d)));
        Float a, b;
        azimuth(turn, a, b);
        a = hn::Mul(a, sine);
        b = hn::Mul(b, sine);
        // Two directions across dir (Duff et al. 2017, "Building an orthonormal basis, revisited").
        const Float s = hn::CopySign(one, dir[2]), k = hn::Div(constant(-1), hn::Add(s, dir[2]));
        const Float xk = hn::Mul(dir[0], k), yk = hn::Mul(dir[1], k), xyk = hn::Mul(dir[0], yk);
        const Float e0 = hn::Add(one, hn::Mul(s, hn::Mul(dir[0], xk))), e1 = hn::Mul(s, xyk),
                    e2 = hn::Neg(hn::Mul(s, dir[0]));
        const Float f1 = hn::Add(s, hn::Mul(dir[1], yk)), f2 = hn::Neg(dir[1]);
        Float to[3];
        to[0] = hn::Add(hn::Mul(cosine, dir[0]), hn::Add(hn::Mul(a, e0), hn::Mul(b, xyk)));
        to[1] = hn::Add(hn::Mul(cosine, dir[1]), hn::Add(hn::Mul(a, e1), hn::Mul(b, f1)));
        to[2] = hn::Add(hn::Mul(cosine, dir[2]), hn::Add(hn::Mul(a, e2), hn::Mul(b, f2)));
        // One of Newton's steps keeps the length 1.
        const Float square = hn::Add(hn::Mul(to[0], to[0]), hn::Add(hn::Mul(to[1], to[1]), hn::Mul(to[2], to[2])));
        const Float scale = hn::Sub(constant(1.5f), hn::Mul(constant(0.5f), square));
        for (std::size_t c = 0; c < 3; ++c) dir[c] = hn::IfThenElse(real, not_parallel(hn::Mul(to[c], scale)), dir[c]);
    }

    /// Paths that are over: counted and replaced, but for those that a white sheet sends back.
    HWY_NOINLINE std::size_t settle(std::size_t row, Mask ends, Mask over, Mask down) {
        const Tag d;
        alignas(64) std::array<float, 16> ended, finished, below;
        hn::Store(hn::IfThenElseZero(ends, constant(1)), d, ended.data());
        hn::Store(hn::IfThenElseZero(over, constant(1)), d, finished.data());
        hn::Store(hn::IfThenElseZero(down, constant(1)), d, below.data());
        std::size_t lost = 0;
        for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
            if (finished[k] == 0) continue;
            const std::size_t lane = row + k;
            float weight = ended[k] != 0 ? 0.0f : lanes_.weight[lane];
            if (ended[k] == 0 && below[k] != 0) {
                if (scene_.backing == Backing::white) {
                    send_back_up(lane);
                    continue;
                }
                if (scene_.backing == Backing::black) weight = 0;
            }
            source_.finished(lanes_.tag[lane], weight, place(lane));
            if (!refill(lane)) ++lost;
        }
        return lost;
    }

    /// Puts the next path of the source into a lane.
    HWY_NOINLINE bool refill(std::size_t lane) {
        PathStart start;
        if (!source_.next(start)) {
            // Stands still for good at the outer side of an empty voxel.
            lanes_.alive[lane] = 0;
            lanes_.base[lane] = 0;
            lanes_.majorant[lane] = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                lanes_.at[a][lane] = lanes_.low[a][lane] = 0;
                lanes_.high[a][lane] = 1;
                lanes_.direction[a][lane] = -0.5f;
            }
            return false;
        }
        lanes_.alive[lane] = 1;
        std::array<int, 3> block{};
        for (std::size_t a = 0; a < 3; ++a) {
            lanes_.at[a][lane] = start.at[a];
            lanes_.direction[a][lane] = start.direction[a];
            block[a] = start.voxel[a] / 16;
        }
        const auto b = static_cast<std::size_t>((block[2] * scene_.blocks[1] + block[1]) * scene_.blocks[0] + block[0]);
        const std::uint32_t base = scene_.base[b];
        const int local = ((start.voxel[2] % 16) * 16 + start.voxel[1] % 16) * 16 + start.voxel[0] % 16;
        const int content = scene_.voxels[base < 256 ? base : base + static_cast<std::uint32_t>(local)];
        const int level = content >> 8 & 15;
        lanes_.near[lane] = content & boundary_is_near;
        for (std::size_t a = 0; a < 3; ++a) {
            const int first = start.voxel[a] >> level << level;
            lanes_.low[a][lane] = static_cast<float>(first);
            lanes_.high[a][lane] = static_cast<float>(std::min(first + (1 << level), scene_.size[a]));
        }
        lanes_.base[lane] = static_cast<std::int32_t>(base);
        lanes_.majorant[lane] = scene_.majorant[b];
        lanes_.weight[lane] = 1;
        lanes_.meetings[lane] = 0;
        lanes_.meetings_allowed[lane] = static_cast<std::int32_t>(Patience().allowed);
        lanes_.tag[lane] = start.tag;
        lanes_.depth[lane] = start.depth;
        for (std::size_t k = 0; k < 4; ++k) lanes_.random[k][lane] = start.random[k];
        return true;
    }

    const PacketScene& scene_;
    PathSource& source_;
    bool few_materials_;
    Lanes lanes_;
    std::array<BoundaryNormals, most_lanes> normals_{};
};

void trace(const PacketScene& scene, PathSource& source) {
    if (scene.boundary) {
        Packet<true>(scene, source).run();
    } else {
        Packet<false>(scene, source).run();
    }
}

}  // namespace voxtone::optics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::optics {

HWY_EXPORT(trace);
void trace_packets(const PacketScene& scene, PathSource& source) { HWY_DYNAMIC_DISPATCH(trace)(scene, source); }

PacketScene packet_scene(const Scene& scene, const PathVolume& volume, std::size_t channel, double roulette_weight) {
    PacketScene packet;
    packet.voxels = volume.voxels().data();
    packet.base = volume.base().data();
    packet.majorant = volume.majorant(channel).data();
    packet.blocks = volume.blocks();
    packet.size = volume.size();
    packet.boundary = volume.boundary();
    packet.offset = static_cast<float>(volume.offset());
    for (std::size_t a = 0; a < 3; ++a) packet.pitch_mm[a] = static_cast<float>(scene.volume->pitch_mm()[a]);
    for (std::size_t r = 0; r < scene.resins->resins.size() && r < 255; ++r) {
        const Medium medium = scene.resins->resins[r].medium(channel);
        packet.sigma_t[r + 1] = static_cast<float>(medium.sigma_t());
        packet.albedo[r + 1] = static_cast<float>(medium.albedo());
    }
    packet.materials = scene.resins->resins.size() + 1;
    packet.g = static_cast<float>(scene.resins->g);
    packet.eta = static_cast<float>(scene.resins->eta);
    packet.roulette_weight = static_cast<float>(roulette_weight);
    packet.backing = scene.backing;
    packet.sides = scene.sides;
    return packet;
}

}  // namespace voxtone::optics
#endif
