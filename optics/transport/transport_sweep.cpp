// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/transport_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "optics/numerics/prefetch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/transport/transport_sweep.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

// Functions that return vectors wider than a target's are called in this file alone.
#pragma GCC diagnostic ignored "-Wpsabi"

HWY_BEFORE_NAMESPACE();
namespace voxtone::optics::HWY_NAMESPACE {

// Highway picks the instruction set; the arithmetic is plain vector types of the compiler.
using V8 = float __attribute__((vector_size(32), may_alias));
using V4 = float __attribute__((vector_size(16)));
using I8 = std::int32_t __attribute__((vector_size(32)));

struct Ways {
    int nx, ny, nz;    ///< cells of a block
    V8 ax, ay, az, a;  ///< (1 + theta) |Omega| / h, and their sum
    V8 theta;
    V8 weights[4];  ///< {w, w Omega} / (1 + theta) of directions k and k + 4
};

/// Cells and faces of the two kinds of blocks.
struct CellKind {
    std::array<int, 3> n;     ///< cells of a block
    std::array<double, 3> h;  ///< their edges, mm
    float theta;
};

struct Octant {
    Ways ways[2];          ///< fine cells, coarse ones
    V8 sx, sy, sz;         ///< 3 Omega
    V8 along[3], flux[3];  ///< |Omega|, w |Omega|
    bool back[3];
    unsigned in_bit[3], out_bit[3];
    int signs[3];

    /// Of the four that go one way along z: sums begin with what it sees.
    [[nodiscard]] bool is_first() const { return !(back[0] || back[1]); }
};

/// a b + c, rounded once: said outright, so that all instruction sets give the same bits. Processors of before 2013
/// have no instruction for it and ask libm, lane by lane.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
HWY_INLINE V8 fused(const V8& a, const V8& b, const V8& c) { return _mm256_fmadd_ps(a, b, c); }
#else
HWY_NOINLINE V8 fused(const V8& a, const V8& b, const V8& c) {
    V8 sum;
    for (int d = 0; d < 8; ++d) sum[d] = __builtin_fmaf(a[d], b[d], c[d]);
    return sum;
}
#endif
HWY_INLINE V8 all(float x) { return V8{x, x, x, x, x, x, x, x}; }

HWY_INLINE void load(V8& v, const void* from) { std::memcpy(&v, from, sizeof v); }
HWY_INLINE void store(const V8& v, void* to) { std::memcpy(to, &v, sizeof v); }
HWY_INLINE void add_to(Moments& sum, const V4& v) {
    V4 all;
    std::memcpy(&all, &sum, sizeof all);
    all += v;
    std::memcpy(static_cast<void*>(&sum), &all, sizeof all);
}

/// Fine and coarse.
std::array<CellKind, 2> cell_kinds(const SweepJob& job) {
    const CellKind coarse{{4, 4, 4}, job.grid.edge_mm(), job.cells.theta};
    CellKind fine = coarse;
    if (job.parts.light.empty()) return {fine, coarse};
    for (std::size_t a = 0; a < 3; ++a) {
        fine.n[a] *= job.grid.fine.split[a];
        fine.h[a] /= job.grid.fine.split[a];
    }
    fine.theta = job.parts.theta;
    return {fine, coarse};
}

Octant make_octant(const ViewingGrid& grid, int octant, const std::array<CellKind, 2>& kinds) {
    Octant o{};
    const DirectionSet& set = grid.directions;
    V8 cosine[3];
    V8 w;
    load(w, set.weight.v.data());
    for (std::size_t a = 0; a < 3; ++a) {
        load(cosine[a], set.cosine[a].v.data());
        o.back[a] = octant >> a & 1;
        o.in_bit[a] = static_cast<unsigned>(2 * a + (o.back[a] ? 1 : 0));
        o.out_bit[a] = static_cast<unsigned>(2 * a + (o.back[a] ? 0 : 1));
        o.signs[a] = tangential_signs(octant, static_cast<int>(a));
    }
    for (std::size_t kind = 0; kind < 2; ++kind) {
        const auto& [n, h, theta] = kinds[kind];
        Ways& ways = o.ways[kind];
        ways.theta += theta;
        ways.nx = n[0];
        ways.ny = n[1];
        ways.nz = n[2];
        ways.ax = cosine[0] * static_cast<float>((1 + static_cast<double>(theta)) / h[0]);
        ways.ay = cosine[1] * static_cast<float>((1 + static_cast<double>(theta)) / h[1]);
        ways.az = cosine[2] * static_cast<float>((1 + static_cast<double>(theta)) / h[2]);
        ways.a = ways.ax + ways.ay + ways.az;
    }
    for (int a = 0; a < 3; ++a) {
        o.along[a] = cosine[a];
        o.flux[a] = w * cosine[a];
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (o.back[a]) cosine[a] = -cosine[a];
    o.sx = 3 * cosine[0];
    o.sy = 3 * cosine[1];
    o.sz = 3 * cosine[2];
    for (Ways& ways : o.ways)
        for (int d = 0; d < 8; ++d) {
            V8& pair = ways.weights[d % 4];
            const int at = d / 4 * 4;
            const float weight = w[d] / (1 + ways.theta[0]);
            pair[at] = weight;
            pair[at + 1] = weight * cosine[0][d];
            pair[at + 2] = weight * cosine[1][d];
            pair[at + 3] = weight * cosine[2][d];
        }
    return o;
}

/// Faces between blocks of different kinds: n1 x n2 fine cells, r1 x r2 of them to a coarse one.
void to_coarse(V8* face, int n1, int n2, int r1, int r2) {
    const float share = 1.0f / static_cast<float>(r1 * r2);
    for (int j = 0; j < n2 / r2; ++j)
        for (int i = 0; i < n1 / r1; ++i) {
            V8 sum{};
            for (int b = 0; b < r2; ++b)
                for (int a = 0; a < r1; ++a) sum += face[(j * r2 + b) * n1 + i * r1 + a];
            face[j * (n1 / r1) + i] = sum * share;
        }
}
void to_fine(V8* face, int n1, int n2, int r1, int r2) {
    for (int j = n2; j-- > 0;)
        for (int i = n1; i-- > 0;) face[j * n1 + i] = face[(j / r2) * (n1 / r1) + i / r1];
}

HWY_INLINE V8* as_vectors(Octet* octets) { return reinterpret_cast<V8*>(octets); }
HWY_INLINE const V8& as_vector(const Octet& octet) { return reinterpret_cast<const V8&>(octet); }

struct BlockFaces {
    V8 *x, *y, *z;
};

// A cell is crossed in three steps, each made for many cells before the next one: what is scattered there, the way of
// the light, and the sum of what the cell sees. One after the other for each cell they are a chain of a hundred cycles,
// and a processor does not look far enough ahead to begin the next cell meanwhile.

/// fit q of a cell.
HWY_INLINE void find_source(const Octant& o, const SweepMedium& medium, const Moments& light, V8& fitted) {
    const V8 flow = fused(all(light.x), o.sx, fused(all(light.y), o.sy, light.z * o.sz));
    fitted = as_vector(medium.fit) * (medium.sigma_s * fused(all(medium.linear), flow, all(light.phi)));
}

/// `seen`: what the cell sees; px, py, pz come in and go out. Written so that the way along x, where each cell waits
/// for the one before, is one multiplication and one addition long: px_out = gain (fit q + ay py + az pz) + (gain ax -
/// theta) px = (1 + theta) psi - theta px.
HWY_INLINE void cross_cell(const Ways& ways, const SweepMedium& medium, const V8& fitted, V8& seen, V8& px, V8& py,
                           V8& pz) {
    const V8& gain = as_vector(medium.gain);
    const V8 beside = gain * fused(ways.ay, py, fused(ways.az, pz, fitted));
    const V8 out = fused(fused(gain, ways.ax, -ways.theta), px, beside);
    const V8 both = fused(ways.theta, px, out);
    px = out;
    py = fused(-ways.theta, py, both);
    pz = fused(-ways.theta, pz, both);
    seen = fused(as_vector(medium.fit), both, as_vector(medium.rest) * fitted);
}

/// Directions k and k + 4 together: so no value leaves its half of a register, which few processors do as fast.
template <bool first>
HWY_INLINE void add_moments(const Ways& ways, const V8& seen, Moments& sum) {
    V8 moment = __builtin_shuffle(seen, I8{0, 0, 0, 0, 4, 4, 4, 4}) * ways.weights[0];
    V8 other = __builtin_shuffle(seen, I8{1, 1, 1, 1, 5, 5, 5, 5}) * ways.weights[1];
    moment = fused(__builtin_shuffle(seen, I8{2, 2, 2, 2, 6, 6, 6, 6}), ways.weights[2], moment);
    other = fused(__builtin_shuffle(seen, I8{3, 3, 3, 3, 7, 7, 7, 7}), ways.weights[3], other);
    moment += other;
    V4 low, high;
    std::memcpy(&low, &moment, sizeof low);
    std::memcpy(&high, reinterpret_cast<const char*>(&moment) + sizeof low, sizeof high);
    low += high;
    if (first)
        std::memcpy(static_cast<void*>(&sum), &low, sizeof low);
    else
        add_to(sum, low);
}

/// Of cells that are crossed together.
struct CellLight {
    V8 *fitted, *seen;
};

/// What comes in and goes out through outer faces, by where they keep their light: among the core's with `into_core`
/// set.
struct Outside {
    const SweepJob& job;
    const Octant& o;

    [[nodiscard]] std::size_t slot(std::size_t place, int axis) const {
        return 4 * (place & ~std::size_t{into_core}) + static_cast<unsigned>(o.signs[axis]);
    }
    void take(int axis, std::size_t at, V8& p) const {
        if (at & into_core) {
            const auto& [phi, J] = job.core_in[at & ~std::size_t{into_core}];
            p = phi - (3 * J) * o.along[axis];
        } else {
            load(p, &job.in[slot(at, axis)]);
        }
    }
    void give(int axis, std::size_t at, const V8& p) const {
        if (at & into_core)
            job.core_out[slot(at, axis)] = flux(axis, p);
        else
            store(p, &job.out[slot(at, axis)]);
    }
    /// A part of a face, which was cleared before.
    void give_part(int axis, std::size_t at, const V8& p, float share) const {
        if (at & into_core) {
            job.core_out[slot(at, axis)] += share * flux(axis, p);
        } else {
            V8 sum;
            load(sum, &job.out[slot(at, axis)]);
            sum += share * p;
            store(sum, &job.out[slot(at, axis)]);
        }
    }
    void clear(int axis, std::size_t at) const {
        if (at & into_core)
            job.core_out[slot(at, axis)] = 0;
        else
            job.out[slot(at, axis)] = {};
    }

private:
    [[nodiscard]] float flux(int axis, const V8& p) const {
        const V8 flux = o.flux[axis] * p;
        float sum = 0;
        for (int d = 0; d < 8; ++d) sum += flux[d];
        return sum;
    }
};

/// A whole block of solid cells: its outer faces are faces of the block. Light runs against x and y where `back_x` and
/// `back_y` say so: known to the compiler, for to find places was half of the instructions.
template <bool back_x, bool back_y>
void sweep_solid_block(const SweepJob& job, const Octant& o, const SweepMedium* media, const GridBlock& block,
                       const BlockFaces& faces) {
    const Ways ways = o.ways[1];
    const std::uint16_t* const medium = job.grid.medium.data() + block.first_cell;
    const Moments* const light = job.cells.light.data() + block.first_cell;
    Moments* const sum = job.cells.sum.data() + block.first_cell;
    const Outside outside{job, o};
    const auto each_face = [&](int axis, unsigned bit, auto&& body) {
        for (unsigned f = block.first_facing[bit]; f < block.first_facing[bit + 1]; ++f) {
            const auto& [place, cell] = job.grid.by_facing[block.first_face + f];
            body(place, axis == 0   ? faces.x[cell / 4]
                        : axis == 1 ? faces.y[cell / 16 * 4 + cell % 4]
                                    : faces.z[cell % 16]);
        }
    };
    for (int a = 0; a < 3; ++a) each_face(a, o.in_bit[a], [&](std::size_t place, V8& p) { outside.take(a, place, p); });
    V8 fitted[64], seen[64];
    for (int c = 0; c < 64; ++c) find_source(o, media[medium[c]], light[c], fitted[c]);
    for (int kz = 0; kz < 4; ++kz) {
        const int z = o.back[2] ? 3 - kz : kz;
        V8 *const on_x = faces.x + z * 4, *const on_z = faces.z;
        const V8* const source = fitted + z * 16;
        const std::uint16_t* const medium_at = medium + z * 16;
        V8* const seen_at = seen + z * 16;
        V8 py[4];
        for (int x = 0; x < 4; ++x) py[x] = faces.y[z * 4 + x];
#pragma GCC unroll 4
        for (int ky = 0; ky < 4; ++ky) {
            const int y = back_y ? 3 - ky : ky;
            V8 px = on_x[y];
#pragma GCC unroll 4
            for (int kx = 0; kx < 4; ++kx) {
                const int x = back_x ? 3 - kx : kx, c = y * 4 + x;
                cross_cell(ways, media[medium_at[c]], source[c], seen_at[c], px, py[x], on_z[c]);
            }
            on_x[y] = px;
        }
        for (int x = 0; x < 4; ++x) faces.y[z * 4 + x] = py[x];
    }
    for (int c = 0; c < 64; ++c) add_moments<!(back_x || back_y)>(ways, seen[c], sum[c]);
    for (int a = 0; a < 3; ++a)
        each_face(a, o.out_bit[a], [&](std::size_t place, const V8& p) { outside.give(a, place, p); });
}

/// Radiance on all faces of a block's cells across each axis, five planes of them; those across x of a row one after
/// the other.
struct CellFaces {
    V8 x[80], y[80], z[80];
};
/// The lower faces of a cell: the upper ones are 1, 4 and 16 further.
constexpr unsigned x_face(unsigned cell) { return cell + (cell >> 2); }
constexpr unsigned y_face(unsigned cell) { return cell + (cell >> 4 << 2); }

/// In which order a half of the bits of a word is exchanged with the other one.
HWY_INLINE std::uint64_t exchange(std::uint64_t bits, int step, std::uint64_t low) {
    return (bits & low) << step | (bits >> step & low);
}

/// As light meets them.
template <class Body>
HWY_INLINE void each_solid_cell(const Octant& o, std::uint64_t solid, Body&& body) {
    if (o.back[0]) solid = exchange(exchange(solid, 1, 0x5555555555555555), 2, 0x3333333333333333);
    if (o.back[1]) solid = exchange(exchange(solid, 4, 0x0f0f0f0f0f0f0f0f), 8, 0x00ff00ff00ff00ff);
    if (o.back[2]) solid = exchange(exchange(solid, 16, 0x0000ffff0000ffff), 32, 0x00000000ffffffff);
    const unsigned flip = (o.back[0] ? 3u : 0u) | (o.back[1] ? 12u : 0u) | (o.back[2] ? 48u : 0u);
    for (; solid != 0; solid &= solid - 1) body(static_cast<unsigned>(__builtin_ctzll(solid)) ^ flip);
}

/// A whole block at the surface. Which cells are solid and which of their faces lie outside is as
/// good as random, and a branch for each would be guessed wrongly: light that enters is put on its faces first, then
/// the solid cells are crossed, then what leaves is taken from there.
void sweep_surface_block(const SweepJob& job, const Octant& o, const SweepMedium* media, const GridBlock& block,
                         const BlockFaces& faces, CellFaces& on) {
    const Ways ways = o.ways[1];
    const std::uint16_t* const medium = job.grid.medium.data() + block.first_cell;
    const Moments* const light = job.cells.light.data() + block.first_cell;
    Moments* const sum = job.cells.sum.data() + block.first_cell;
    const FacingFace* const by_facing = job.grid.by_facing.data() + block.first_face;
    const Outside outside{job, o};
    const unsigned in[3] = {o.back[0] ? 1u : 0u, o.back[1] ? 4u : 0u, o.back[2] ? 16u : 0u},
                   out[3] = {1 - in[0], 4 - in[1], 16 - in[2]};
    for (unsigned j = 0; j < 16; ++j) {
        on.x[5 * j + 4 * in[0]] = faces.x[j];
        on.y[j / 4 * 20 + 4 * in[1] + j % 4] = faces.y[j];
        on.z[4 * in[2] + j] = faces.z[j];
    }
    const auto each_face = [&](int axis, unsigned bit, auto&& body) {
        for (unsigned f = block.first_facing[bit]; f < block.first_facing[bit + 1]; ++f) {
            const unsigned cell = by_facing[f].cell_in_block;
            const bool upper = bit % 2;
            if (axis == 0)
                body(by_facing[f].place, on.x[x_face(cell) + (upper ? 1 : 0)]);
            else if (axis == 1)
                body(by_facing[f].place, on.y[y_face(cell) + (upper ? 4 : 0)]);
            else
                body(by_facing[f].place, on.z[cell + (upper ? 16 : 0)]);
        }
    };
    for (int a = 0; a < 3; ++a) each_face(a, o.in_bit[a], [&](std::size_t place, V8& p) { outside.take(a, place, p); });
    unsigned cells = 0;
    std::uint8_t cell_at[64];
    each_solid_cell(o, block.solid, [&](unsigned cell) { cell_at[cells++] = static_cast<std::uint8_t>(cell); });
    V8 fitted[64], seen[64];
    for (unsigned k = 0; k < cells; ++k) find_source(o, media[medium[cell_at[k]]], light[cell_at[k]], fitted[k]);
    for (unsigned k = 0; k < cells; ++k) {
        const unsigned cell = cell_at[k];
        V8 *const x = on.x + x_face(cell), *const y = on.y + y_face(cell), *const z = on.z + cell;
        V8 px = x[in[0]], py = y[in[1]], pz = z[in[2]];
        cross_cell(ways, media[medium[cell]], fitted[k], seen[k], px, py, pz);
        x[out[0]] = px;
        y[out[1]] = py;
        z[out[2]] = pz;
    }
    if (o.is_first()) std::fill_n(sum, 64, Moments{});
    for (unsigned k = 0; k < cells; ++k) add_moments<false>(ways, seen[k], sum[cell_at[k]]);
    for (int a = 0; a < 3; ++a)
        each_face(a, o.out_bit[a], [&](std::size_t place, const V8& p) { outside.give(a, place, p); });
    for (unsigned j = 0; j < 16; ++j) {
        faces.x[j] = on.x[5 * j + 4 * out[0]];
        faces.y[j] = on.y[j / 4 * 20 + 4 * out[1] + j % 4];
        faces.z[j] = on.z[4 * out[2] + j];
    }
}

/// Where a part lies from the first one of its cell: among the block's parts, and on the faces across x, y and z.
struct PartPlace {
    int part, face[3];
};

/// The parts of a cell as light meets them.
std::vector<PartPlace> parts_in_order(const Octant& o, const std::array<int, 3>& split) {
    const Ways& ways = o.ways[0];
    std::vector<PartPlace> parts;
    for (int kz = 0; kz < split[2]; ++kz)
        for (int ky = 0; ky < split[1]; ++ky)
            for (int kx = 0; kx < split[0]; ++kx) {
                const int x = o.back[0] ? split[0] - 1 - kx : kx, y = o.back[1] ? split[1] - 1 - ky : ky,
                          z = o.back[2] ? split[2] - 1 - kz : kz;
                parts.push_back({(z * ways.ny + y) * ways.nx + x, {z * ways.ny + y, z * ways.nx + x, y * ways.nx + x}});
            }
    return parts;
}

/// The parts of a block's cells, cell by cell. Outer faces are those of whole cells: all parts get the light that
/// enters there, and what leaves is their mean. `parts`: of a cell; `work`: room for as many; `next`: the block whose
/// parts are crossed afterwards.
void sweep_parts(const SweepJob& job, const Octant& o, const SweepMedium* media, std::size_t t, std::size_t next,
                 const GridBlock& block, const BlockFaces& faces, std::span<const PartPlace> parts, CellLight work) {
    const ViewingGrid& grid = job.grid;
    const Ways ways = o.ways[0];
    const std::array<int, 3> split = grid.fine.split;
    const std::size_t first_part = grid.fine.first[t], first_later = grid.fine.first[next];
    const Outside outside{job, o};
    V8* const on[3] = {faces.x, faces.y, faces.z};
    std::uint64_t entered[3]{}, left[3]{};       // cells with such outer faces
    std::uint32_t enters[3][64], leaves[3][64];  // where these are
    for (int a = 0; a < 3; ++a) {
        for (unsigned f = block.first_facing[o.in_bit[a]]; f < block.first_facing[o.in_bit[a] + 1]; ++f) {
            const auto& [place, cell] = grid.by_facing[block.first_face + f];
            entered[a] |= std::uint64_t{1} << cell;
            enters[a][cell] = place;
        }
        for (unsigned f = block.first_facing[o.out_bit[a]]; f < block.first_facing[o.out_bit[a] + 1]; ++f) {
            const auto& [place, cell] = grid.by_facing[block.first_face + f];
            left[a] |= std::uint64_t{1} << cell;
            leaves[a][cell] = place;
            outside.clear(a, place);
        }
    }
    const std::uint64_t any_entered = entered[0] | entered[1] | entered[2], any_left = left[0] | left[1] | left[2];
    const std::size_t count = parts.size();
    // The parts behind a cell's face, one of each row of parts across it.
    const auto each_on_face = [&](int axis, auto&& body) {
        const int step = axis == 0 ? split[0] : axis == 1 ? split[0] * split[1] : split[0] * split[1] * split[2];
        const int within = axis == 0 ? 1 : axis == 1 ? split[0] : split[0] * split[1];
        for (int from = 0; from < static_cast<int>(count); from += step)
            for (int k = from; k < from + within; ++k) body(parts[static_cast<std::size_t>(k)].face[axis]);
    };
    each_solid_cell(o, block.solid, [&](unsigned cell) {
        const int x = static_cast<int>(cell & 3) * split[0], y = static_cast<int>(cell >> 2 & 3) * split[1],
                  z = static_cast<int>(cell >> 4) * split[2];
        V8* const at[3] = {on[0] + z * ways.ny + y, on[1] + z * ways.nx + x, on[2] + y * ways.nx + x};
        if (any_entered >> cell & 1)
            for (int a = 0; a < 3; ++a)
                if (entered[a] >> cell & 1) {
                    V8 p;
                    outside.take(a, enters[a][cell], p);
                    each_on_face(a, [&](int face) { at[a][face] = p; });
                }
        const std::size_t first = first_part + static_cast<std::size_t>((z * ways.ny + y) * ways.nx + x);
        const std::uint16_t* const medium = grid.fine.medium.data() + first;
        const Moments* const light = job.parts.light.data() + first;
        Moments* const sum = job.parts.sum.data() + first;
        const std::size_t later = first_later + count * cell;
        prefetch(&job.parts.light[later], count * sizeof(Moments));
        prefetch(&job.parts.sum[later], count * sizeof(Moments));
        for (std::size_t k = 0; k < count; ++k)
            find_source(o, media[medium[parts[k].part]], light[parts[k].part], work.fitted[k]);
        for (std::size_t k = 0; k < count; ++k)
            cross_cell(ways, media[medium[parts[k].part]], work.fitted[k], work.seen[k], at[0][parts[k].face[0]],
                       at[1][parts[k].face[1]], at[2][parts[k].face[2]]);
        for (std::size_t k = 0; k < count; ++k) add_moments<false>(ways, work.seen[k], sum[parts[k].part]);
        if (any_left >> cell & 1)
            for (int a = 0; a < 3; ++a)
                if (left[a] >> cell & 1) {
                    const float share = 1.0f / static_cast<float>(split[(a + 1) % 3] * split[(a + 2) % 3]);
                    each_on_face(a, [&](int face) { outside.give_part(a, leaves[a][cell], at[a][face], share); });
                }
    });
}

/// What an octant takes from a block's faces and puts there is fetched from memory while the block before is crossed:
/// its cells ask for it one by one, and each would wait.
void prefetch_light(const SweepJob& job, const Octant& o, const GridBlock& block) {
    const FacingFace* const by_facing = job.grid.by_facing.data() + block.first_face;
    const auto each_face = [&](unsigned bit, int signs, const Octet* light) {
        for (unsigned f = block.first_facing[bit]; f < block.first_facing[bit + 1]; ++f)
            if (const std::size_t place = by_facing[f].place; !(place & into_core))
                prefetch(light[4 * place + static_cast<unsigned>(signs)]);
    };
    for (int a = 0; a < 3; ++a) {
        each_face(o.in_bit[a], o.signs[a], job.in.data());
        each_face(o.out_bit[a], o.signs[a], job.out.data());
    }
}

/// The radiance on the faces between blocks along one octant's way.
struct Front {
    std::vector<Octet> y, z;  // not V8: containers forget its alignment; y for each plane that is being crossed
    std::vector<std::uint8_t> y_fine, z_fine;
};

/// The light of one half on its way: what there is on the faces between blocks, octant by octant.
class HalfSweep {
public:
    HalfSweep(const SweepJob& job, int half) : job_(job), grid_(job.grid), any_fine_(!job.parts.light.empty()) {
        const std::array<CellKind, 2> kinds = cell_kinds(job);
        fine_ = kinds[0].n;
        for (std::size_t a = 0; a < 3; ++a) ratio_[a] = fine_[a] / kinds[1].n[a];
        const std::size_t across = product({grid_.lattice[0], 1, 1}),
                          plane = product({grid_.lattice[0], grid_.lattice[1], 1});
        for (std::size_t k = 0; k < 4; ++k) {
            octants_[k] = make_octant(grid_, static_cast<int>(k) + 4 * half, kinds);
            if (any_fine_) parts_[k] = parts_in_order(octants_[k], grid_.fine.split);
            Front& front = fronts_[k];
            front.y.resize(cells_across(1) * across * job.rows.fronts);
            front.z.resize(cells_across(2) * plane);
            front.y_fine.assign(across * job.rows.fronts, 0);
            front.z_fine.assign(plane, 0);
        }
    }

    /// A row of blocks, by octant k of the half.
    void cross(std::size_t row, std::size_t k) {
        const Octant& o = octants_[k];
        Front& front = fronts_[k];
        RowWork work(any_fine_ ? cells_across(0) : 0, parts_[k].size());
        std::uint8_t x_fine = 0;
        const std::size_t begin = grid_.transport_rows[row], end = grid_.transport_rows[row + 1];
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t t = o.back[0] ? end - 1 - (i - begin) : i;
            const GridBlock& block = grid_.transport_block(t);
            const std::size_t next = i + 1 == end ? t : o.back[0] ? t - 1 : t + 1;
            if (next != t) prefetch_block(o, grid_.transport_block(next));
            const bool in_parts = any_fine_ && grid_.fine.first[t] != not_fine;
            const std::size_t along_y = at3({block.at[0], static_cast<int>(job_.rows.front[row]), 0}, grid_.lattice),
                              along_z = at3({block.at[0], block.at[1], 0}, grid_.lattice);
            const BlockFaces faces{as_vectors(work.front()), as_vectors(front.y.data() + cells_across(1) * along_y),
                                   as_vectors(front.z.data() + cells_across(2) * along_z)};
            fit(faces.x, x_fine, in_parts, 1, 2);
            fit(faces.y, front.y_fine[along_y], in_parts, 0, 2);
            fit(faces.z, front.z_fine[along_z], in_parts, 0, 1);
            if (in_parts && o.is_first()) {
                std::fill_n(&job_.cells.sum[block.first_cell], 64, Moments{});
                std::fill_n(&job_.parts.sum[grid_.fine.first[t]], 64 * parts_[k].size(), Moments{});
            }
            if (in_parts)
                sweep_parts(job_, o, job_.parts.media.data(), t, grid_.fine.first[next] != not_fine ? next : t, block,
                            faces, parts_[k], work.cells());
            else if (block.solid == ~std::uint64_t{0})
                solid_block[k](job_, o, job_.cells.media.data(), block, faces);
            else
                sweep_surface_block(job_, o, job_.cells.media.data(), block, faces, work.on);
        }
    }

private:
    static constexpr std::array solid_block{&sweep_solid_block<false, false>, &sweep_solid_block<true, false>,
                                            &sweep_solid_block<false, true>, &sweep_solid_block<true, true>};

    /// Where a row is worked at: on the stack where no cell is cut, for whole rows come and go too fast for the heap.
    struct RowWork {
        RowWork(std::size_t fine_across, std::size_t parts) : of_parts(fine_across), fitted(parts), seen(parts) {}
        [[nodiscard]] Octet* front() { return of_parts.empty() ? of_whole_cells.data() : of_parts.data(); }
        [[nodiscard]] CellLight cells() { return {as_vectors(fitted.data()), as_vectors(seen.data())}; }
        CellFaces on{};
        std::array<Octet, 16> of_whole_cells{};
        std::vector<Octet> of_parts, fitted, seen;
    };

    /// Fine cells on a block's face across an axis.
    [[nodiscard]] std::size_t cells_across(std::size_t axis) const {
        return static_cast<std::size_t>(fine_[(axis + 1) % 3] * fine_[(axis + 2) % 3]);
    }

    void prefetch_block(const Octant& o, const GridBlock& later) const {
        prefetch_light(job_, o, later);
        prefetch(&job_.cells.light[later.first_cell], 64 * sizeof(Moments));
        prefetch(&job_.cells.sum[later.first_cell], 64 * sizeof(Moments));
    }

    /// Light on a face of cells across a and b, as the block that it comes to has them.
    void fit(V8* face, std::uint8_t& is_fine, bool wanted, std::size_t a, std::size_t b) const {
        if (static_cast<bool>(is_fine) == wanted) return;
        (wanted ? to_fine : to_coarse)(face, fine_[a], fine_[b], ratio_[a], ratio_[b]);
        is_fine = wanted;
    }

    const SweepJob& job_;
    const ViewingGrid& grid_;
    const bool any_fine_;
    std::array<int, 3> fine_{}, ratio_{};  ///< fine cells of a block along each axis, and of a cell
    std::array<Octant, 4> octants_;
    std::array<std::vector<PartPlace>, 4> parts_;
    std::array<Front, 4> fronts_;
};

void sweep(const SweepJob& job, int half) {
    HalfSweep light(job, half);
    // All four octants of one way along z cross a plane of blocks before the next one, and both ways along x a row,
    // while its cells are in the cache.
    cross_rows(job.rows, [&](std::size_t row, std::size_t back) {
        if (job.progress) job.progress->check_cancelled();
        light.cross(row, 2 * back);
        light.cross(row, 2 * back + 1);
    });
}

}  // namespace voxtone::optics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::optics {

HWY_EXPORT(sweep);

namespace {

/// Exponential fitting (transport_sweep.h).
SweepMedium sweep_medium(const Octet& a, const std::array<Octet, 3>& per_way, double theta,
                         const TransportMedium& medium) {
    const double sigma = std::max(static_cast<double>(medium.sigma_t), 1e-6);
    const double sigma_a = std::max(0.0, static_cast<double>(medium.sigma_t) - static_cast<double>(medium.sigma_s));
    SweepMedium made;
    made.sigma_s = medium.sigma_s;
    made.linear = medium.linear;
    for (std::size_t d = 0; d < 8; ++d) {
        const double way = (1 + theta) / static_cast<double>(a.v[d]), tau = sigma_a * way;
        const bool thin = tau < 0.02;  // there 1 - fit cancels; the series has two terms
        double fit = cell_fit(sigma_a, way, theta), lack = theta == 1 && thin ? tau * tau / 12 : 1 - fit;
        if (medium.apart > 0) {
            std::array<double, 3> ways{};
            for (std::size_t k = 0; k < 3; ++k) ways[k] = (1 + theta) / static_cast<double>(per_way[k].v[d]);
            fit = lump_fit(sigma_a, ways, theta, static_cast<double>(medium.apart));
            lack = 1 - fit;
        }
        const double gain = (1 + theta) / (static_cast<double>(a.v[d]) + fit * sigma);
        made.gain.v[d] = static_cast<float>(gain);
        made.fit.v[d] = static_cast<float>(fit);
        made.rest.v[d] = static_cast<float>((1 + theta) * lack / (sigma * fit));
    }
    return made;
}

}  // namespace

std::vector<SweepMedium> sweep_media(const DirectionSet& set, const std::array<double, 3>& edge_mm, float theta,
                                     std::span<const TransportMedium> media) {
    const auto weight = static_cast<double>(theta);
    std::array<Octet, 3> per_way;  // (1 + theta) |Omega| / h, as an octant has it
    Octet all;
    for (std::size_t d = 0; d < 8; ++d) {
        for (std::size_t a = 0; a < 3; ++a)
            per_way[a].v[d] = set.cosine[a].v[d] * static_cast<float>((1 + weight) / edge_mm[a]);
        all.v[d] = per_way[0].v[d] + per_way[1].v[d] + per_way[2].v[d];
    }
    std::vector<SweepMedium> made(media.size());
    parallel_ranges(0, media.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) made[m] = sweep_medium(all, per_way, weight, media[m]);
    });
    return made;
}

void sweep_half(const SweepJob& job, bool down) { HWY_DYNAMIC_DISPATCH(sweep)(job, down ? 1 : 0); }

}  // namespace voxtone::optics
#endif
