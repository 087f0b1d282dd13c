// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/path_packets.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "optics/monte_carlo/rough_boundary.h"
#include "optics/monte_carlo/scalar_paths.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/monte_carlo/path_packets.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include "optics/monte_carlo/path_lanes-inl.h"
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

    /// One event of the paths of a row. Inlined, its parts are registers: no address of one may leave `step`.
    struct Event {
        Mask alive;
        Bits draws[4];  ///< free path; angle, or what the surface does; azimuth and roulette; kind of meeting
        Float u;        ///< the second draw
        Float at[3], dir[3], low[3], high[3], depth, majorant, weight;
        Float way, bound[3], voxel[3];  ///< voxel: where the path is, or the one beyond the side
        Mask forward[3], axis[3];       ///< axis: of the side that is crossed
        Mask collides, crosses, met;    ///< at its end: a particle, the side of the box, the boundary
        Mask outside, mirrored;         ///< beyond the side: no volume; its image
        Mask ends, leaves;              ///< absorbed; gone through the surface
        Mask even;                      ///< scattered evenly in the resin of the spheres
        bool any_crosses;
        Int place[3], base, block_index, content, material;
    };

    /// One event of each path of a row. How many lanes found no other path when theirs ended.
    HWY_INLINE std::size_t step(std::size_t row) {
        const Tag d;
        Event e;
        load(row, e);
        walk(row, e);
        advance(row, e);
        look_up(row, e);
        Float next_depth = hn::Max(hn::Sub(e.depth, hn::Mul(e.majorant, e.way)), hn::Zero(d));
        if (!hn::AllFalse(d, e.collides)) collide(e, next_depth);
        if (e.any_crosses) cross(row, e);
        hn::Store(next_depth, d, lanes_.depth.data() + row);
        hn::Store(e.weight, d, lanes_.weight.data() + row);
        for (std::size_t a = 0; a < 3; ++a) hn::Store(e.dir[a], d, lanes_.direction[a].data() + row);

        std::size_t lost = 0;
        if constexpr (bounded) {
            if (!hn::AllFalse(d, e.even)) cross_sphere(row, e.even);
            if (!hn::AllFalse(d, e.met)) lost += leave_or_turn(row, e.met, e.u);
        }
        const Mask over = hn::Or(e.ends, e.leaves);
        if (HWY_LIKELY(hn::AllFalse(d, over))) return lost;
        const Mask down = hn::And(e.leaves, hn::And(e.axis[2], hn::Lt(e.voxel[2], hn::Zero(d))));
        return lost + settle(row, e.ends, over, down);
    }

    HWY_INLINE void load(std::size_t row, Event& e) {
        const Tag d;
        const IntTag di;
        const BitTag db;
        e.alive = hn::RebindMask(d, hn::Ne(hn::Load(di, lanes_.alive.data() + row), hn::Zero(di)));
        Random random{hn::Load(db, lanes_.random[0].data() + row), hn::Load(db, lanes_.random[1].data() + row),
                      hn::Load(db, lanes_.random[2].data() + row), hn::Load(db, lanes_.random[3].data() + row)};
        for (Bits& draw : e.draws) draw = random.next();
        hn::Store(random.s0, db, lanes_.random[0].data() + row);
        hn::Store(random.s1, db, lanes_.random[1].data() + row);
        hn::Store(random.s2, db, lanes_.random[2].data() + row);
        hn::Store(random.s3, db, lanes_.random[3].data() + row);
        e.u = unit(e.draws[1]);
        for (std::size_t a = 0; a < 3; ++a) {
            e.at[a] = hn::Load(d, lanes_.at[a].data() + row);
            e.dir[a] = hn::Load(d, lanes_.direction[a].data() + row);
            e.low[a] = hn::Load(d, lanes_.low[a].data() + row);
            e.high[a] = hn::Load(d, lanes_.high[a].data() + row);
        }
        e.depth = hn::Load(d, lanes_.depth.data() + row);
        e.majorant = hn::Load(d, lanes_.majorant.data() + row);
        e.weight = hn::Load(d, lanes_.weight.data() + row);
        e.ends = e.leaves = e.met = e.even = hn::Lt(e.u, hn::Zero(d));  // none
    }

    /// To the particle, the side of the box or the boundary, what comes first.
    HWY_INLINE void walk(std::size_t row, Event& e) {
        const Tag d;
        const Float zero = hn::Zero(d);
        Float t[3];
        for (std::size_t a = 0; a < 3; ++a) {
            e.forward[a] = hn::Gt(e.dir[a], zero);
            e.bound[a] = hn::IfThenElse(e.forward[a], e.high[a], e.low[a]);
            t[a] = hn::Div(hn::Mul(hn::Sub(e.bound[a], e.at[a]), constant(scene_.pitch_mm[a])), e.dir[a]);
        }
        const Float to_side = hn::Max(hn::Min(hn::Min(t[0], t[1]), t[2]), zero);
        e.collides = hn::Lt(e.depth, hn::Mul(e.majorant, to_side));
        e.crosses = hn::Not(e.collides);
        e.way = hn::IfThenElse(e.collides, hn::Div(e.depth, e.majorant), to_side);
        if constexpr (bounded) {
            const IntTag di;
            const Mask near =
                hn::And(e.alive, hn::RebindMask(d, hn::Ne(hn::Load(di, lanes_.near.data() + row), hn::Zero(di))));
            if (!hn::AllFalse(d, near)) {
                Float way = e.way;
                e.met = meet_boundary(row, near, way);
                e.way = way;
                e.collides = hn::AndNot(e.met, e.collides);
                e.crosses = hn::AndNot(e.met, e.crosses);
            }
        }
        e.any_crosses = !hn::AllFalse(d, e.crosses);
        e.axis[0] = hn::And(e.crosses, hn::And(hn::Le(t[0], t[1]), hn::Le(t[0], t[2])));
        e.axis[1] = hn::And(hn::AndNot(e.axis[0], e.crosses), hn::Le(t[1], t[2]));
        e.axis[2] = hn::AndNot(e.axis[1], hn::AndNot(e.axis[0], e.crosses));
    }

    /// The paths move; which voxel they are in or about to enter.
    HWY_INLINE void advance(std::size_t row, Event& e) {
        const Tag d;
        const Float zero = hn::Zero(d), one = constant(1);
        const Mask none = hn::Lt(zero, zero);
        Mask beyond_side = none;
        e.outside = none;
        for (std::size_t a = 0; a < 3; ++a) {
            const Float moved = hn::Add(e.at[a], hn::Mul(hn::Mul(e.dir[a], e.way), constant(1 / scene_.pitch_mm[a])));
            e.at[a] = hn::IfThenElse(e.axis[a], e.bound[a], hn::Min(hn::Max(moved, e.low[a]), e.high[a]));
            hn::Store(e.at[a], d, lanes_.at[a].data() + row);
            const Float inside = hn::Min(hn::Floor(e.at[a]), hn::Sub(e.high[a], one));
            const Float beyond = hn::Sub(e.bound[a], hn::IfThenElseZero(hn::Not(e.forward[a]), one));
            e.voxel[a] = hn::IfThenElse(e.axis[a], beyond, inside);
            const Float size = constant(static_cast<float>(scene_.size[a]));
            const Mask out = hn::And(e.axis[a], hn::Or(hn::Lt(e.voxel[a], zero), hn::Ge(e.voxel[a], size)));
            e.outside = hn::Or(e.outside, out);
            if (a < 2) beyond_side = hn::Or(beyond_side, out);
        }
        e.mirrored = none;
        if (scene_.sides == Sides::mirrored) e.mirrored = beyond_side;
    }

    /// What that voxel holds (path_volume.h).
    HWY_INLINE void look_up(std::size_t row, Event& e) {
        const IntTag di;
        Int block[3];
        for (std::size_t a = 0; a < 3; ++a) {
            e.place[a] = hn::ConvertTo(di, e.voxel[a]);
            block[a] = hn::ShiftRight<4>(e.place[a]);
        }
        e.base = hn::Load(di, lanes_.base.data() + row);
        e.block_index = hn::Zero(di);
        if (e.any_crosses) {
            const Int index = hn::Add(hn::Mul(hn::Add(hn::Mul(block[2], hn::Set(di, scene_.blocks[1])), block[1]),
                                              hn::Set(di, scene_.blocks[0])),
                                      block[0]);
            e.block_index = hn::IfThenZeroElse(hn::RebindMask(di, e.outside), index);
            const Int there = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(scene_.base), e.block_index);
            e.base = hn::IfThenElse(hn::RebindMask(di, e.crosses), there, e.base);
        }
        // What is outside is as the first entry says: air. A block of one material needs no look.
        e.content = hn::IfThenZeroElse(hn::RebindMask(di, e.outside), e.base);
        const auto several = hn::Gt(e.content, hn::Set(di, 255));
        if (hn::AllFalse(di, several)) {
            e.content = hn::Or(e.content, hn::Set(di, 4 << 8));
        } else {
            const Int fifteen = hn::Set(di, 15);
            const Int local =
                hn::Add(hn::ShiftLeft<8>(hn::And(e.place[2], fifteen)),
                        hn::Add(hn::ShiftLeft<4>(hn::And(e.place[1], fifteen)), hn::And(e.place[0], fifteen)));
            const Int entry = hn::Add(e.content, hn::IfThenElseZero(several, local));
            e.content =
                hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(scene_.voxels), hn::ShiftLeft<1>(entry));
        }
        e.material = hn::And(e.content, hn::Set(di, 255));
        if (scene_.spread.any()) {
            if (!hn::AllFalse(Tag(), e.collides)) {
                const Int found = spread_material(row, e.collides, e.at[0], e.at[1], e.place[2]);
                e.material = hn::IfThenElse(hn::Gt(found, hn::Zero(di)), found, e.material);
            }
        } else if (scene_.droplets.chance > 0) {
            const Mask met = hn::And(e.collides, hn::RebindMask(Tag(), several));
            if (!hn::AllFalse(Tag(), met)) {
                const Int found = droplet_material(row, met, e.base, e.place[0], e.place[1], e.place[2]);
                e.material = hn::IfThenElse(hn::Gt(found, hn::Zero(di)), found, e.material);
            }
        }
    }

    /// What particles that were met belong to (droplet_spread.h); air: to the voxel that they were met in.
    HWY_NOINLINE Int droplet_material(std::size_t row, Mask met, Int base, Int x, Int y, Int z) {
        const IntTag di;
        const BitTag db;
        Bits draws[3];
        draw_again(row, met, draws);
        const auto folded = [&](Int place, Bits draw, int reach) {
            const Bits step = hn::ShiftRight<16>(hn::Mul(draw, hn::Set(db, static_cast<std::uint32_t>(2 * reach + 1))));
            Int p = hn::And(place, hn::Set(di, 15));
            p = hn::Add(p, hn::Sub(hn::BitCast(di, step), hn::Set(di, reach)));
            p = hn::IfThenElse(hn::Lt(p, hn::Zero(di)), hn::Sub(hn::Set(di, -1), p), p);
            return hn::IfThenElse(hn::Gt(p, hn::Set(di, 15)), hn::Sub(hn::Set(di, 31), p), p);
        };
        const std::array<int, 3>& reach = scene_.droplets.reach;
        const Bits half = hn::Set(db, 0xffff);
        const Int local = hn::Add(hn::ShiftLeft<8>(folded(z, hn::And(draws[1], half), reach[2])),
                                  hn::Add(hn::ShiftLeft<4>(folded(y, hn::ShiftRight<16>(draws[0]), reach[1])),
                                          folded(x, hn::And(draws[0], half), reach[0])));
        const Int entry = hn::IfThenElseZero(hn::RebindMask(di, met), hn::Add(base, local));
        const Int found =
            hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(scene_.voxels), hn::ShiftLeft<1>(entry));
        const Mask elsewhere =
            hn::And(met, hn::Lt(unit(draws[2]), constant(static_cast<float>(scene_.droplets.chance))));
        return hn::IfThenElseZero(hn::RebindMask(di, elsewhere), hn::And(found, hn::Set(di, 255)));
    }

    /// The same where resin runs sideways (lateral_spread.h), from block to block; air: what would run out stays.
    HWY_NOINLINE Int spread_material(std::size_t row, Mask met, Float x, Float y, Int z) {
        const Tag d;
        const IntTag di;
        const BitTag db;
        Bits draws[3];
        draw_again(row, met, draws);
        const Bits half = hn::Set(db, 0xffff);
        const auto moved = [&](Float from, Bits a, Bits b, Bits c, float wide) {
            const Float sum = hn::ConvertTo(d, hn::BitCast(di, hn::Add(hn::Add(a, b), c)));
            const Float step = hn::Sub(hn::Mul(hn::Add(sum, constant(1.5f)), constant(0x1p-16f)), constant(1.5f));
            return hn::ConvertTo(di, hn::Floor(hn::Add(from, hn::Mul(step, constant(wide)))));
        };
        const std::array<float, 2>& wide = scene_.spread.draw_voxels();
        Int place[3] = {
            moved(x, hn::And(draws[0], half), hn::ShiftRight<16>(draws[0]), hn::And(draws[1], half), wide[0]),
            moved(y, hn::ShiftRight<16>(draws[1]), hn::And(draws[2], half), hn::ShiftRight<16>(draws[2]), wide[1]), z};
        if (scene_.droplets.chance > 0) add_droplet_steps(row, met, place);
        auto inside = hn::RebindMask(di, met);
        for (std::size_t a = 0; a < 3; ++a) {
            const Int size = hn::Set(di, scene_.size[a]);
            if (a < 2 && scene_.sides == Sides::mirrored) {
                const Int before = hn::Sub(hn::Set(di, -1), place[a]),
                          beyond = hn::Sub(hn::Sub(hn::Add(size, size), hn::Set(di, 1)), place[a]);
                place[a] = hn::IfThenElse(hn::Lt(place[a], hn::Zero(di)), before, place[a]);
                place[a] = hn::IfThenElse(hn::Lt(place[a], size), place[a], beyond);
            }
            inside = hn::And(inside, hn::And(hn::Gt(place[a], hn::Set(di, -1)), hn::Lt(place[a], size)));
        }
        for (Int& p : place) p = hn::IfThenElseZero(inside, p);
        const Int block = hn::Add(hn::Mul(hn::Add(hn::Mul(hn::ShiftRight<4>(place[2]), hn::Set(di, scene_.blocks[1])),
                                                  hn::ShiftRight<4>(place[1])),
                                          hn::Set(di, scene_.blocks[0])),
                                  hn::ShiftRight<4>(place[0]));
        const Int base = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(scene_.base), block);
        const Int fifteen = hn::Set(di, 15);
        const Int local = hn::Add(hn::ShiftLeft<8>(hn::And(place[2], fifteen)),
                                  hn::Add(hn::ShiftLeft<4>(hn::And(place[1], fifteen)), hn::And(place[0], fifteen)));
        const Int entry = hn::Add(base, hn::IfThenElseZero(hn::Gt(base, hn::Set(di, 255)), local));
        const Int found =
            hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(scene_.voxels), hn::ShiftLeft<1>(entry));
        return hn::IfThenElseZero(inside, hn::And(found, hn::Set(di, 255)));
    }

    /// On to the voxels that particles' droplets came from, evenly from the box around (droplet_spread.h).
    HWY_INLINE void add_droplet_steps(std::size_t row, Mask met, Int (&place)[3]) {
        const IntTag di;
        const BitTag db;
        Bits draws[3];
        draw_again(row, met, draws);
        const Bits half = hn::Set(db, 0xffff);
        const Bits steps[3] = {hn::And(draws[0], half), hn::ShiftRight<16>(draws[0]), hn::And(draws[1], half)};
        const auto elsewhere =
            hn::RebindMask(di, hn::Lt(unit(draws[2]), constant(static_cast<float>(scene_.droplets.chance))));
        for (std::size_t a = 0; a < 3; ++a) {
            const int reach = scene_.droplets.reach[a];
            const Bits step =
                hn::ShiftRight<16>(hn::Mul(steps[a], hn::Set(db, static_cast<std::uint32_t>(2 * reach + 1))));
            place[a] =
                hn::Add(place[a], hn::IfThenElseZero(elsewhere, hn::Sub(hn::BitCast(di, step), hn::Set(di, reach))));
        }
    }

    /// Particles: real ones absorb and scatter, the majorant's others do nothing. Russian roulette by weight.
    HWY_INLINE void collide(Event& e, Float& next_depth) const {
        const Tag d;
        const IntTag di;
        const Float sigma_t = of_material(scene_.sigma_t.data(), e.material);
        const Mask real = hn::And(e.collides, hn::Lt(hn::Mul(unit(e.draws[3]), e.majorant), sigma_t));
        next_depth = hn::IfThenElse(e.collides, exponential(e.draws[0]), next_depth);
        e.weight = hn::IfThenElse(real, hn::Mul(e.weight, of_material(scene_.albedo.data(), e.material)), e.weight);
        const Float least = constant(scene_.roulette_weight);
        const Mask faint = hn::And(real, hn::Lt(e.weight, least));
        const Float chance =
            hn::Mul(hn::ConvertTo(d, hn::And(hn::BitCast(di, e.draws[2]), hn::Set(di, 0xffff))), constant(0x1p-16f));
        const Mask survives = hn::Lt(hn::Mul(hn::Add(chance, constant(0x1p-17f)), least), e.weight);
        e.ends = hn::And(hn::AndNot(survives, faint), e.alive);
        e.weight = hn::IfThenElse(e.ends, hn::Zero(d), hn::IfThenElse(faint, least, e.weight));
        scatter(e.u, hn::ShiftRight<16>(e.draws[2]), real, e.material, e.dir);
        if constexpr (bounded) {
            if (scene_.spheres.fitting) find_even(e, hn::AndNot(e.ends, real));
        }
    }

    /// Which real scatterings in the resin of the spheres were even: a share even_share / (2 p(c)) of those by an angle
    /// of cosine c, by the draw that found them real. Of Henyey and Greenstein's 1 / (2 p(c)) is (1 - g^2)^2 / D^3.
    HWY_INLINE void find_even(Event& e, Mask real) const {
        const auto material = static_cast<std::size_t>(scene_.spheres.material);
        const float its_g = scene_.g_of[material];
        const Float D = hn::Add(hn::Mul(e.u, constant(2 * its_g)), constant(1 - its_g));
        const auto sigma_t = static_cast<double>(scene_.sigma_t[material]);
        const auto g = static_cast<double>(its_g);
        const Float share = constant(static_cast<float>(sigma_t * even_share(g) * (1 - g * g) * (1 - g * g)));
        const Mask chosen = hn::Lt(hn::Mul(hn::Mul(unit(e.draws[3]), e.majorant), hn::Mul(D, hn::Mul(D, D))), share);
        const Mask there = hn::RebindMask(Tag(), hn::Eq(e.material, hn::Set(IntTag(), scene_.spheres.material)));
        e.even = hn::And(hn::And(real, chosen), there);
    }

    /// From where light was scattered evenly to the skin of the largest sphere that has room there.
    HWY_NOINLINE void cross_sphere(std::size_t row, Mask even) {
        const Tag d;
        const IntTag di;
        const PacketSpheres& spheres = scene_.spheres;
        Float at[3];
        Int cell[3];
        for (std::size_t a = 0; a < 3; ++a) {
            at[a] = hn::Load(d, lanes_.at[a].data() + row);
            cell[a] = hn::Min(hn::ShiftRight<3>(hn::ConvertTo(di, at[a])), hn::Set(di, spheres.cells[a] - 1));
        }
        const Int index = hn::Add(
            hn::Mul(hn::Add(hn::Mul(cell[2], hn::Set(di, spheres.cells[1])), cell[1]), hn::Set(di, spheres.cells[0])),
            cell[0]);
        const Int read = hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(spheres.fitting),
                                          hn::IfThenElseZero(hn::RebindMask(di, even), index));
        const Int fitting = hn::And(read, hn::Set(di, 255)),
                  sphere = hn::Max(hn::Sub(fitting, hn::Set(di, 1)), hn::Zero(di));
        const Float kept = gather(spheres.weights, sphere);
        const Mask room = hn::RebindMask(d, hn::Gt(fitting, hn::Zero(di)));
        const Mask crosses = hn::And(hn::And(even, room), hn::Gt(kept, hn::Zero(d)));
        if (hn::AllFalse(d, crosses)) return;

        Bits draws[3];
        draw_again(row, crosses, draws);
        Float normal[3];
        even_direction(draws[0], draws[1], normal);
        const Float radius = gather(spheres.radius_mm.data(), fitting);
        for (std::size_t a = 0; a < 3; ++a) {
            const Float moved = hn::Add(at[a], hn::Mul(hn::Mul(radius, normal[a]), constant(1 / scene_.pitch_mm[a])));
            at[a] = hn::IfThenElse(crosses, moved, at[a]);
            hn::Store(at[a], d, lanes_.at[a].data() + row);
        }
        turn(leaving_cosine(sphere, draws[2]), draws[1], normal);
        for (std::size_t a = 0; a < 3; ++a) {
            const Float old = hn::Load(d, lanes_.direction[a].data() + row);
            hn::Store(hn::IfThenElse(crosses, normal[a], old), d, lanes_.direction[a].data() + row);
        }
        const Float weight = hn::Load(d, lanes_.weight.data() + row);
        hn::Store(hn::IfThenElse(crosses, hn::Mul(weight, kept), weight), d, lanes_.weight.data() + row);
        arrive(row, crosses);
    }

    /// More random numbers for some paths; the others' generators stay as they are.
    HWY_INLINE void draw_again(std::size_t row, Mask who, Bits (&draws)[3]) {
        const BitTag db;
        Random random{hn::Load(db, lanes_.random[0].data() + row), hn::Load(db, lanes_.random[1].data() + row),
                      hn::Load(db, lanes_.random[2].data() + row), hn::Load(db, lanes_.random[3].data() + row)};
        const Bits before[4] = {random.s0, random.s1, random.s2, random.s3};
        for (Bits& draw : draws) draw = random.next();
        const Bits after[4] = {random.s0, random.s1, random.s2, random.s3};
        for (std::size_t k = 0; k < 4; ++k)
            hn::Store(hn::IfThenElse(hn::RebindMask(db, who), after[k], before[k]), db, lanes_.random[k].data() + row);
    }

    HWY_INLINE void even_direction(Bits height, Bits turn_bits, Float* direction) const {
        const Float one = constant(1), z = hn::Sub(hn::Mul(unit(height), constant(2)), constant(1 - 0x1p-23f));
        const Float sine = hn::Sqrt(hn::Max(hn::Mul(hn::Sub(one, z), hn::Add(one, z)), hn::Zero(Tag())));
        azimuth(hn::ShiftRight<16>(turn_bits), direction[0], direction[1]);
        direction[0] = hn::Mul(direction[0], sine);
        direction[1] = hn::Mul(direction[1], sine);
        direction[2] = z;
    }

    /// Of a path that leaves a sphere, to its normal.
    HWY_INLINE Float leaving_cosine(Int sphere, Bits draw) const {
        const Tag d;
        const IntTag di;
        constexpr int intervals = static_cast<int>(FirstPassage::intervals);
        const Float place = hn::Mul(unit(draw), constant(static_cast<float>(intervals)));
        const Int whole = hn::ConvertTo(di, place);
        const Int entry = hn::Add(hn::Mul(sphere, hn::Set(di, intervals + 1)), whole);
        const Float low = gather(scene_.spheres.cosines, entry),
                    high = gather(scene_.spheres.cosines, hn::Add(entry, hn::Set(di, 1)));
        return hn::Add(low, hn::Mul(hn::Sub(high, low), hn::Sub(place, hn::ConvertTo(d, whole))));
    }

    /// Paths that stand somewhere new: the boxes around them.
    HWY_INLINE void arrive(std::size_t row, Mask who) {
        const Tag d;
        Event e;
        for (std::size_t a = 0; a < 3; ++a) {
            e.voxel[a] = hn::Floor(hn::Load(d, lanes_.at[a].data() + row));
            e.low[a] = hn::Load(d, lanes_.low[a].data() + row);
            e.high[a] = hn::Load(d, lanes_.high[a].data() + row);
        }
        e.majorant = hn::Load(d, lanes_.majorant.data() + row);
        e.collides = hn::Xor(who, who);  // none
        e.crosses = who;
        e.any_crosses = true;
        e.outside = hn::Not(who);
        look_up(row, e);
        enter_box(row, e, who);
    }

    /// The side of the box: another box, the surface, or a mirror.
    HWY_INLINE void cross(std::size_t row, Event& e) {
        const Tag d;
        const IntTag di;
        const Mask goes_on = hn::AndNot(e.mirrored, e.crosses);
        const Mask surface = hn::And(goes_on, hn::RebindMask(d, hn::Eq(e.material, hn::Zero(di))));
        enter_box(row, e, hn::AndNot(surface, goes_on));
        Mask turns = e.mirrored;
        if (!hn::AllFalse(d, surface)) {
            const Float cosine =
                hn::Abs(hn::IfThenElse(e.axis[0], e.dir[0], hn::IfThenElse(e.axis[1], e.dir[1], e.dir[2])));
            const Float eta = scene_.own_eta ? eta_at_side(row, surface, e) : constant(scene_.eta);
            const Mask reflected = hn::And(surface, hn::Lt(e.u, internal_reflectance(cosine, eta)));
            turns = hn::Or(turns, reflected);
            e.leaves = hn::And(hn::AndNot(reflected, surface), e.alive);
        }
        count_meetings(row, e, hn::Or(surface, e.mirrored));
        for (std::size_t a = 0; a < 3; ++a)
            e.dir[a] = hn::IfThenElse(hn::And(turns, e.axis[a]), hn::Neg(e.dir[a]), e.dir[a]);
    }

    /// Of the voxels that these paths are about to leave.
    HWY_NOINLINE Float eta_at_side(std::size_t row, Mask surface, const Event& e) const {
        const IntTag di;
        const Int base = hn::Load(di, lanes_.base.data() + row), fifteen = hn::Set(di, 15);
        Int local = hn::Zero(di);
        for (std::size_t a = 3; a-- > 0;) {
            const Float back = hn::IfThenElse(e.forward[a], constant(-1), constant(1));
            const Float inside = hn::Add(e.voxel[a], hn::IfThenElseZero(e.axis[a], back));
            local = hn::Add(hn::ShiftLeft<4>(local), hn::And(hn::ConvertTo(di, inside), fifteen));
        }
        const Int entry = hn::Add(base, hn::IfThenElseZero(hn::Gt(base, hn::Set(di, 255)), local));
        const Int found = hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(scene_.voxels),
                                           hn::ShiftLeft<1>(hn::IfThenElseZero(hn::RebindMask(di, surface), entry)));
        return gather(scene_.eta_of.data(), hn::And(found, hn::Set(di, 255)));
    }

    HWY_INLINE void enter_box(std::size_t row, Event& e, Mask enters) {
        const Tag d;
        const IntTag di;
        const Int side = hn::Shl(hn::Set(di, 1), hn::And(hn::ShiftRight<8>(e.content), hn::Set(di, 15)));
        for (std::size_t a = 0; a < 3; ++a) {
            const Int first = hn::AndNot(hn::Sub(side, hn::Set(di, 1)), e.place[a]);
            const Int last = hn::Min(hn::Add(first, side), hn::Set(di, scene_.size[a]));
            hn::Store(hn::IfThenElse(enters, hn::ConvertTo(d, first), e.low[a]), d, lanes_.low[a].data() + row);
            hn::Store(hn::IfThenElse(enters, hn::ConvertTo(d, last), e.high[a]), d, lanes_.high[a].data() + row);
        }
        const Int old_base = hn::Load(di, lanes_.base.data() + row);
        hn::Store(hn::IfThenElse(hn::RebindMask(di, enters), e.base, old_base), di, lanes_.base.data() + row);
        hn::Store(hn::IfThenElse(enters, gather(scene_.majorant, e.block_index), e.majorant), d,
                  lanes_.majorant.data() + row);
        if constexpr (bounded) {
            const Int near = hn::And(e.content, hn::Set(di, boundary_is_near));
            const Int old_near = hn::Load(di, lanes_.near.data() + row);
            hn::Store(hn::IfThenElse(hn::RebindMask(di, enters), near, old_near), di, lanes_.near.data() + row);
        }
    }

    /// Russian roulette by order: RouletteByOrder, in vector code.
    HWY_INLINE void count_meetings(std::size_t row, Event& e, Mask meets) {
        const Tag d;
        const IntTag di;
        const Int meetings = hn::Add(hn::Load(di, lanes_.meetings.data() + row),
                                     hn::IfThenElseZero(hn::RebindMask(di, meets), hn::Set(di, 1)));
        hn::Store(meetings, di, lanes_.meetings.data() + row);
        const Int allowed = hn::Load(di, lanes_.meetings_allowed.data() + row);
        const auto spent = hn::And(hn::Eq(meetings, allowed), hn::RebindMask(di, meets));
        const Mask many = hn::RebindMask(d, spent);
        hn::Store(hn::IfThenElse(spent, hn::Add(allowed, hn::ShiftRight<1>(allowed)), allowed), di,
                  lanes_.meetings_allowed.data() + row);
        const Mask stops = hn::And(many, hn::Lt(unit(e.draws[3]), constant(0.5f)));
        const Float played = hn::IfThenElse(stops, hn::Zero(d), hn::Add(e.weight, e.weight));
        e.weight = hn::IfThenElse(many, played, e.weight);
        e.ends = hn::Or(e.ends, hn::And(stops, e.alive));
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
            // A face of the body on a side of the box lies as far off as that, but for rounding: a path that passed it
            // would be in air, and lost.
            const double reach = static_cast<double>(ways[k]) + 0.5 * inside_boundary_mm;
            if (!scene_.boundary->leaves(place_mm(lane), direction(lane), reach, distance, normals_[lane])) continue;
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
            const double roughness = scene_.finish ? scene_.finish->roughness(at, normals_[lane].geometric) : 0.0;
            const bool leaves = roughness > 0
                                    ? crosses_rough(lane, roughness, way)
                                    : static_cast<double>(u[k]) >= turn_at_boundary(normals_[lane], eta(lane), way);
            const bool again = leaves && !on_sheet && scene_.follow_outside && meets_again(lane, at);
            if (leaves && on_sheet && scene_.sheet) lanes_.weight[lane] *= sent_back_at(lane);
            if (leaves && !again && (!on_sheet || scene_.backing == Backing::black || lanes_.weight[lane] <= 0)) {
                if (scene_.tells_exits && !on_sheet)
                    tell_exit(lane, at,
                              roughness > 0 ? way : leaving_direction(normals_[lane], eta(lane), direction(lane)));
                else
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
            if (again) continue;
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

    /// What a sheet lets in again of light that left there.
    [[nodiscard]] float sent_back_at(std::size_t lane) const {
        const Point at = place_mm(lane);
        return static_cast<float>(share_sent_back(static_cast<double>(scene_.sheet->at(at[0], at[1], scene_.channel)),
                                                  scene_.surface_in_air));
    }
    /// At the surface that the path stands at.
    [[nodiscard]] double eta(std::size_t lane) const {
        if (!scene_.own_eta) return static_cast<double>(scene_.eta);
        std::array<int, 3> voxel{};
        for (std::size_t a = 0; a < 3; ++a)
            voxel[a] = static_cast<int>(
                std::clamp(std::floor(lanes_.at[a][lane]), lanes_.low[a][lane], lanes_.high[a][lane] - 1));
        return eta_in(voxel);
    }
    /// Voxels that no resin is near have the set's.
    [[nodiscard]] double eta_in(const std::array<int, 3>& voxel) const {
        return static_cast<double>(scene_.eta_of[static_cast<std::size_t>(content_of(voxel) & 255)]);
    }
    [[nodiscard]] double eta_near(const Point& at, const BoundaryNormals& normals) const {
        return scene_.own_eta ? eta_in(voxel_within(at, normals)) : static_cast<double>(scene_.eta);
    }
    /// Of a point of the surface, the voxel just within.
    [[nodiscard]] std::array<int, 3> voxel_within(const Point& at, const BoundaryNormals& normals) const {
        std::array<int, 3> voxel{};
        for (std::size_t a = 0; a < 3; ++a)
            voxel[a] = std::clamp(static_cast<int>(std::floor(place_within(at, normals, a))), 0, scene_.size[a] - 1);
        return voxel;
    }
    [[nodiscard]] float place_within(const Point& at, const BoundaryNormals& normals, std::size_t axis) const {
        const double inward = at[axis] - inside_boundary_mm * normals.geometric[axis];
        return static_cast<float>(inward / static_cast<double>(scene_.pitch_mm[axis]) + scene_.offset);
    }
    void tell_exit(std::size_t lane, const Point& at, const Point& way) {
        source_.left(lanes_.tag[lane], lanes_.weight[lane], {at, way, random_state(lane)});
    }
    /// Turns `way` at a rough surface; true where it goes through.
    bool crosses_rough(std::size_t lane, double roughness, Point& way) {
        PathRandom random(random_state(lane));
        const bool through = cross_boundary(normals_[lane], eta(lane), roughness, true, way, random);
        set_random_state(lane, random.state());
        return through;
    }

    /// Light that left at `at` and meets the body once more goes on inside where the surface lets it in: an ear, a
    /// fold, the inside of a cup. False, with the lane as it was, where it gets away.
    bool meets_again(std::size_t lane, Point at) {
        constexpr int most_reflections = 32;
        Point way = leaving_direction(normals_[lane], eta(lane), direction(lane));
        PathRandom random(random_state(lane));
        for (int k = 0; k < most_reflections; ++k) {
            double distance = 0;
            BoundaryNormals normals;
            if (!scene_.boundary->meets(at, way, distance, normals)) break;
            for (std::size_t a = 0; a < 3; ++a) at[a] += distance * way[a];
            const MetFromOutside met = meet_from_outside(normals, eta_near(at, normals), way);
            if (random.uniform() >= met.reflectance) {
                set_random_state(lane, random.state());
                enter_at(lane, at, normals, met.refracted);
                return true;
            }
            way = met.reflected;
        }
        set_random_state(lane, random.state());
        return false;
    }

    /// Sets a lane on its way inside from a point of the surface.
    void enter_at(std::size_t lane, const Point& at, const BoundaryNormals& normals, const Point& way) {
        for (std::size_t a = 0; a < 3; ++a) {
            lanes_.at[a][lane] = place_within(at, normals, a);
            lanes_.direction[a][lane] = safe_component(way[a]);
        }
        stand_in(lane, voxel_within(at, normals));
        for (std::size_t a = 0; a < 3; ++a)
            lanes_.at[a][lane] = std::clamp(lanes_.at[a][lane], lanes_.low[a][lane], lanes_.high[a][lane]);
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
    HWY_INLINE void scatter(Float u, Bits turn_bits, Mask real, Int material, Float* dir) const {
        const Tag d;
        const Float one = constant(1);
        const Float g = scene_.own_g ? of_material(scene_.g_of.data(), material) : constant(scene_.g);
        const Float rest = hn::Sub(one, g), twice = constant(2);
        const Float D = hn::Add(hn::Mul(u, hn::Mul(twice, g)), rest);
        const Float m =
            hn::Div(hn::Mul(hn::Mul(hn::Sub(one, u), hn::Mul(hn::Mul(twice, rest), rest)), hn::Add(one, hn::Mul(u, g))),
                    hn::Mul(D, D));
        Float to[3] = {dir[0], dir[1], dir[2]};
        turn(hn::Sub(one, m), hn::Sqrt(hn::Max(hn::Mul(m, hn::Sub(constant(2), m)), hn::Zero(d))), turn_bits, to);
        for (std::size_t c = 0; c < 3; ++c) dir[c] = hn::IfThenElse(real, to[c], dir[c]);
    }

    HWY_INLINE void turn(Float cosine, Bits turn_bits, Float* dir) const {
        const Float one = constant(1);
        const Float square = hn::Mul(hn::Sub(one, cosine), hn::Add(one, cosine));
        turn(cosine, hn::Sqrt(hn::Max(square, hn::Zero(Tag()))), turn_bits, dir);
    }

    /// dir by an angle, the azimuth by chance.
    HWY_INLINE void turn(Float cosine, Float sine, Bits turn_bits, Float* dir) const {
        const Float one = constant(1);
        Float a, b;
        azimuth(turn_bits, a, b);
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
        for (std::size_t c = 0; c < 3; ++c) dir[c] = not_parallel(hn::Mul(to[c], scale));
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
                if (scene_.sheet) lanes_.weight[lane] *= sent_back_at(lane);
                if (scene_.backing == Backing::white || (scene_.sheet && lanes_.weight[lane] > 0)) {
                    send_back_up(lane);
                    continue;
                }
                if (scene_.sheet) weight = 0;
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
        for (std::size_t a = 0; a < 3; ++a) {
            lanes_.at[a][lane] = start.at[a];
            lanes_.direction[a][lane] = start.direction[a];
        }
        stand_in(lane, start.voxel);
        lanes_.weight[lane] = 1;
        lanes_.meetings[lane] = 0;
        lanes_.meetings_allowed[lane] = static_cast<std::int32_t>(RouletteByOrder().allowed);
        lanes_.tag[lane] = start.tag;
        lanes_.depth[lane] = start.depth;
        for (std::size_t k = 0; k < 4; ++k) lanes_.random[k][lane] = start.random[k];
        return true;
    }

    /// The box around a voxel, and what it holds.
    void stand_in(std::size_t lane, const std::array<int, 3>& voxel) {
        const std::size_t b = block_of(voxel);
        const int content = content_of(voxel);
        const int level = content >> 8 & 15;
        lanes_.near[lane] = content & boundary_is_near;
        for (std::size_t a = 0; a < 3; ++a) {
            const int first = voxel[a] >> level << level;
            lanes_.low[a][lane] = static_cast<float>(first);
            lanes_.high[a][lane] = static_cast<float>(std::min(first + (1 << level), scene_.size[a]));
        }
        lanes_.base[lane] = static_cast<std::int32_t>(scene_.base[b]);
        lanes_.majorant[lane] = scene_.majorant[b];
    }

    [[nodiscard]] std::size_t block_of(const std::array<int, 3>& voxel) const {
        return static_cast<std::size_t>((voxel[2] / 16 * scene_.blocks[1] + voxel[1] / 16) * scene_.blocks[0] +
                                        voxel[0] / 16);
    }
    /// As path_volume.h has it.
    [[nodiscard]] int content_of(const std::array<int, 3>& voxel) const {
        const std::uint32_t base = scene_.base[block_of(voxel)];
        const int local = ((voxel[2] % 16) * 16 + voxel[1] % 16) * 16 + voxel[0] % 16;
        return scene_.voxels[base < 256 ? base : base + static_cast<std::uint32_t>(local)];
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
    packet.g_of.fill(static_cast<float>(scene.resins->g)), packet.eta_of.fill(static_cast<float>(scene.resins->eta));
    packet.own_g = scene.resins->has_own_g(), packet.own_eta = scene.resins->has_own_eta();
    for (std::size_t r = 0; r < scene.resins->resins.size() && r < 255; ++r) {
        const Resin& resin = scene.resins->resins[r];
        const Medium medium = resin.own_medium(channel);
        packet.g_of[r + 1] = static_cast<float>(scene.resins->g_of(resin));
        packet.eta_of[r + 1] = static_cast<float>(scene.resins->eta_of(resin));
        packet.sigma_t[r + 1] = static_cast<float>(medium.sigma_t());
        packet.albedo[r + 1] = static_cast<float>(medium.albedo());
    }
    packet.droplets = DropletSpread(scene.resins->dot_spread, scene.volume->pitch_mm());
    packet.materials = scene.resins->resins.size() + 1;
    packet.g = static_cast<float>(scene.resins->g);
    packet.eta = static_cast<float>(scene.resins->eta);
    packet.roulette_weight = static_cast<float>(roulette_weight);
    packet.spread = LateralSpread(scene.spread_mm, scene.volume->pitch_mm());
    packet.backing = scene.backing;
    packet.channel = channel;
    if (scene.backing == Backing::sheet) {
        packet.sheet = scene.sheet;
        packet.surface_in_air = reflectance_in_air(scene.resins->eta);
    }
    packet.sides = scene.sides;
    return packet;
}

PacketSpheres packet_spheres(const ClearSpheres& spheres, std::size_t channel) {
    PacketSpheres packet;
    if (spheres.material() == air) return packet;
    VOXTONE_EXPECT(spheres.radii_mm().size() < packet.radius_mm.size());
    packet.material = spheres.material();
    packet.fitting = spheres.fitting().data();
    packet.cells = spheres.cells();
    std::transform(spheres.radii_mm().begin(), spheres.radii_mm().end(), packet.radius_mm.begin() + 1,
                   [](double r) { return static_cast<float>(r); });
    packet.weights = spheres.weights(channel).data();
    packet.cosines = spheres.cosines(channel).data();
    return packet;
}

}  // namespace voxtone::optics
#endif
