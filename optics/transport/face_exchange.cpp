// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/face_exchange.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "optics/numerics/lanes.h"
#include "optics/numerics/prefetch.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t pools_per_task = 32;

/// Fluxes of a region's light that passes corners become its radiance for the room that there is: of the same direction
/// first, the surplus everywhere.
void share_out(const float* leaves, const float* room, float* pool) {
    std::array<float, 64> per_width;
    Four surpluses{}, lacks{};
    for (std::size_t k = 0; k < 64; k += 4) {
        const Four out = four(leaves + k), in = four(room + k), free = in - out, width = out > in ? out : in;
        const Four share = 1 / (width > 0 ? width : Four{} + 1);
        surpluses += above_zero(-free) * share * four(pool + k);
        lacks += above_zero(free);
        put(share, per_width.data() + k);
    }
    const float surplus = (surpluses[0] + surpluses[1]) + (surpluses[2] + surpluses[3]),
                lack = (lacks[0] + lacks[1]) + (lacks[2] + lacks[3]), everywhere = lack > 1e-12f ? surplus / lack : 0;
    for (std::size_t k = 0; k < 64; k += 4) {
        const Four free = above_zero(four(room + k) - four(leaves + k));
        put((four(pool + k) + free * everywhere) * four(per_width.data() + k), pool + k);
    }
}

}  // namespace

std::size_t FaceExchange::Workspace::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(in) + of(out) + of(flux) + of(flux_change);
}

FaceExchange::FaceExchange(const TransportParameters& parameters, Workspace room)
    : parameters_(parameters), grid_(parameters.grid), light_(std::move(room)) {
    light_.in.resize(4 * grid_.open_faces.size());
    light_.out.resize(4 * grid_.open_faces.size());
    light_.flux.resize(grid_.faces.size());
    light_.flux_change.resize(grid_.faces.size());
    core_in_.resize(grid_.core_faces.size());
    core_out_.resize(4 * grid_.core_faces.size());
}

template <class Body>
void FaceExchange::each_lit(Body&& body) const {
    for (const std::uint32_t f : grid_.open_faces)
        if (grid_.faces[f].kind == FaceKind::light) body(f);
}

template <class Body>
void FaceExchange::each_pool(Body&& body) const {
    parallel_for(0, grid_.transport_blocks.size(), pools_per_task, [&](std::size_t t) {
        const GridBlock& block = grid_.transport_block(t);
        prefetch_laws(t + 1);
        Pool passing;
        pool(block, passing);
        body(block, passing);
    });
}

std::vector<float> FaceExchange::light_from_everywhere() const {
    std::vector<float> light(grid_.open_faces.size(), 0.0f);
    each_lit([&](std::uint32_t f) { light[grid_.place_of_face[f]] = 1; });
    return light;
}

void FaceExchange::begin(std::vector<float> incoming) {
    incoming_ = std::move(incoming);
    std::ranges::fill(light_.flux, 0.0f);
    std::ranges::fill(light_.flux_change, 0.0f);
}

void FaceExchange::load(std::span<const ViewingField::FaceCode> from) {
    parallel_ranges(0, from.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < 32; ++k) light_.out[4 * i + k / 8].v[k % 8] = phi_step * code_of(from[i], k);
    });
}

void FaceExchange::store(std::vector<ViewingField::FaceCode>& to) const {
    to.resize(grid_.open_faces.size());
    parallel_ranges(0, to.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) to[i] = face_code(&light_.out[4 * i]);
    });
}

void FaceExchange::prefetch_laws(std::size_t t) const {
    if (t >= grid_.transport_blocks.size()) return;
    const GridBlock& block = grid_.transport_block(t);
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) prefetch(grid_.law_of(f));
}

/// Mean radiance of the light that passes corners of the staircase, per region and direction (transport_directions.h).
void FaceExchange::pool(const GridBlock& block, Pool& pool) const {
    if (!block.slanting) return;
    std::array<float, 512> leaves{}, room{};
    unsigned regions = 0;  // that have faces
    pool.fill(0);
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
        const FaceLaw& law = grid_.law_of(f);
        if (law.flat) continue;
        const OuterFace& face = grid_.faces[f];
        const Octet& w = parameters_.flux_weight[static_cast<std::size_t>(face.facing) / 2];
        const std::size_t region = std::size_t{face.region_in_block} * 64;
        regions |= 1u << face.region_in_block;
        for (std::size_t slot = 0; slot < 4; ++slot) {
            const std::size_t out = region +
                                    static_cast<std::size_t>(leaving_octant(face.facing, static_cast<int>(slot))) * 8,
                              in = region +
                                   static_cast<std::size_t>(entering_octant(face.facing, static_cast<int>(slot))) * 8;
            const Octet& leaving = light_.out[4 * std::size_t{grid_.place_of_face[f]} + slot];
            for (std::size_t d = 0; d < 8; d += 4) {
                const Four flux = four(&w.v[d]) * face.area_mm2, mirror = four(&law.mirror[slot].v[d]);
                const Four passes = flux * above_zero(1 - four(&law.through[slot].v[d]) - mirror);
                put(four(&leaves[out + d]) + passes, &leaves[out + d]);
                put(four(&room[in + d]) + flux * above_zero(1 - four(&law.through[slot ^ 3].v[d]) - mirror),
                    &room[in + d]);
                put(four(&pool[out + d]) + passes * four(&leaving.v[d]), &pool[out + d]);
            }
        }
    }
    for (std::size_t region = 0; region < 512; region += 64)
        if (regions >> region / 64 & 1) share_out(&leaves[region], &room[region], &pool[region]);
}

/// Diffuse light: phi and J at the face, from the cell on this side and the node beyond, by what conducts between.
std::array<float, 2> FaceExchange::from_core(std::size_t face, const ChannelMedia& media,
                                             const InnerLight& light) const {
    const OuterFace& outer = grid_.faces[face];
    const float edge = parameters_.edge[parameters_.axis_of(face)];
    const std::uint16_t medium = grid_.medium[outer.cell];
    const float here = 2 * media.D[medium] / edge;
    const float there = media.core_D[grid_.core_medium[outer.beyond]] / (2 * edge);
    const float phi_here = light.cells[outer.cell].phi, phi_there = light.core[outer.beyond];
    return {(here * phi_here + there * phi_there) / (here + there),
            here * there / (here + there) * (phi_here - phi_there)};
}

/// Radiance that comes in through an open face, given what goes out.
Octet FaceExchange::returned(const Pool& pool, std::size_t face, std::size_t slot, const ChannelMedia& media) const {
    const OuterFace& outer = grid_.faces[face];
    const auto axis = static_cast<std::size_t>(outer.facing) / 2;
    const Octet* const leaves = light_.out.data() + 4 * std::size_t{grid_.place_of_face[face]};
    Octet in;
    const FaceLaw& law = grid_.law_of(face);
    float radiance = incoming(face);
    if (outer.kind == FaceKind::white_sheet) {
        float leaving = 0, through = 0;
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t d = 0; d < 8; ++d) {
                leaving += parameters_.flux_weight[axis].v[d] * law.through[k].v[d] * leaves[k].v[d];
                through += parameters_.flux_weight[axis].v[d] * law.through[k].v[d];
            }
        radiance = media.sent_back(face) * (leaving / through);
    }
    const Octet &back = law.through[slot ^ 3], &mirror = law.mirror[slot], &out = leaves[slot];
    for (std::size_t d = 0; d < 8; d += 4)
        put(four(&mirror.v[d]) * four(&out.v[d]) + four(&back.v[d]) * radiance, &in.v[d]);
    if (law.flat) return in;
    const std::size_t from = std::size_t{outer.region_in_block} * 64 +
                             static_cast<std::size_t>(entering_octant(outer.facing, static_cast<int>(slot))) * 8;
    for (std::size_t d = 0; d < 8; d += 4) {
        const Four room = above_zero(1 - four(&back.v[d]) - four(&mirror.v[d]));
        put(four(&in.v[d]) + room * four(&pool[from + d]), &in.v[d]);
    }
    return in;
}

void FaceExchange::add_sources(const ChannelMedia& media, std::span<float> to) const {
    each_pool([&](const GridBlock& block, const Pool& passing) {
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid_.faces[f];
            if (face.kind == FaceKind::core) continue;
            const Octet& w = parameters_.flux_weight[parameters_.axis_of(f)];
            float sum = 0;
            for (std::size_t slot = 0; slot < 4; ++slot) {
                const Octet from = returned(passing, f, slot, media);
                const Octet& was = light_.in[4 * std::size_t{grid_.place_of_face[f]} + slot];
                for (std::size_t d = 0; d < 8; ++d) sum += w.v[d] * (from.v[d] - was.v[d]);
            }
            to[face.cell] += media.exchange[f].gain * sum;
        }
    });
}

void FaceExchange::reflect(const ChannelMedia& media, const InnerLight& light) {
    each_pool([&](const GridBlock& block, const Pool& passing) {
        for (std::size_t face = block.first_face; face < block.first_face + block.faces; ++face) {
            const std::uint32_t place = grid_.place_of_face[face];
            if (place & into_core)
                core_in_[place & ~into_core] = from_core(face, media, light);
            else
                for (std::size_t slot = 0; slot < 4; ++slot)
                    light_.in[4 * std::size_t{place} + slot] = returned(passing, face, slot, media);
        }
    });
}

void FaceExchange::correct(std::size_t t, const ChannelMedia& media, std::span<const float> phi_of_cell,
                           const ViewingDiffusion::Flows& J) {
    const auto& set = grid_.directions;
    const GridBlock& block = grid_.transport_block(t);
    const std::size_t first = 64 * t;
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
        const OuterFace& face = grid_.faces[f];
        if (face.kind == FaceKind::core) continue;
        const auto facing = static_cast<std::size_t>(face.facing), axis = facing / 2;
        const bool plus = facing % 2 == 1;
        const std::size_t tangent[2] = {axis == 0 ? 1u : 0u, axis == 2 ? 1u : 2u};
        const FaceLaw& law = grid_.law_of(f);
        const Octet& w = parameters_.flux_weight[axis];
        const std::size_t at = face.cell - first;
        const std::array<float, 3> j{J[0][at], J[1][at], J[2][at]};
        const float phi = phi_of_cell[face.cell] -
                          (plus ? 0.5f : -0.5f) * parameters_.edge[axis] * j[axis] / media.D[grid_.medium[face.cell]];
        const float Jn = 3 * (plus ? j[axis] : -j[axis]), Ju = 3 * j[tangent[0]], Jv = 3 * j[tangent[1]];
        float leaving = 0, before = 0;
        for (std::size_t slot = 0; slot < 4; ++slot) {
            Octet& out = light_.out[4 * std::size_t{grid_.place_of_face[f]} + slot];
            const float u = slot & 1 ? -Ju : Ju, v = slot & 2 ? -Jv : Jv;
            Octet was, is;  // of the flux; the sums keep their order
            for (std::size_t d = 0; d < 8; d += 4) {
                const Four weight = four(&w.v[d]) * four(&law.through[slot].v[d]);
                put(weight * four(&out.v[d]), &was.v[d]);
                put(four(&out.v[d]) + (phi + four(&set.cosine[axis].v[d]) * Jn +
                                       four(&set.cosine[tangent[0]].v[d]) * u + four(&set.cosine[tangent[1]].v[d]) * v),
                    &out.v[d]);
                put(weight * four(&out.v[d]), &is.v[d]);
            }
            for (std::size_t d = 0; d < 8; ++d) {
                before += was.v[d];
                leaving += is.v[d];
            }
        }
        light_.flux[f] = leaving * face.area_mm2;
        light_.flux_change[f] = (leaving - before) * face.area_mm2;
    }
}

double FaceExchange::last_change() const {
    double most = 0;
    each_lit([&](std::uint32_t f) {
        most = std::max(most, static_cast<double>(std::abs(light_.flux_change[f]) / parameters_.furnace_flux(f)));
    });
    return most;
}

double FaceExchange::relative_change() const {
    double change = 0, all = 0;
    each_lit([&](std::uint32_t f) {
        change += static_cast<double>(std::abs(light_.flux_change[f]));
        all += static_cast<double>(std::abs(light_.flux[f]));
    });
    return all > 0 ? change / all : 0;
}

std::size_t FaceExchange::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return light_.memory_bytes() + of(incoming_) + of(core_in_) + of(core_out_);
}

}  // namespace voxtone::optics
