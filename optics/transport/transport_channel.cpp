// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/transport_channel.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/base/stopwatch.h"

namespace voxtone::optics {
namespace {

constexpr double least_transport_sigma = 0.2;  // mm^-1; keeps diffusion finite in clear resin, where it is only a guess

float sum8(const Octet& a, const Octet& b) {
    float s = 0;
    for (std::size_t d = 0; d < 8; ++d) s += a.v[d] * b.v[d];
    return s;
}

}  // namespace

TransportChannel::TransportChannel(const OpticalGrid& grid, const DiffusionPlan& plan, MediaByKind media,
                                   const TransportOptions& options, const Progress* progress)
    : grid_(grid), plan_(plan), media_(std::move(media)), options_(options), progress_(progress) {
    for (const BlockKind kind : {BlockKind::skin, BlockKind::margin})
        VOXTONE_EXPECT(media_[static_cast<std::size_t>(kind)].size() == grid.palette.size());
    VOXTONE_EXPECT(media_[static_cast<std::size_t>(BlockKind::core)].size() == grid.palette.size());
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t d = 0; d < 8; ++d)
            flux_weight_[a].v[d] = grid.directions.weight.v[d] * grid.directions.cosine[a].v[d];
    make_diffusion();
}

TransportChannel::FaceSums TransportChannel::face_sums(std::size_t face) const {
    const Octet& w = flux_weight_[static_cast<std::size_t>(grid_.faces[face].facing) / 2];
    FaceSums sums;
    for (const Octet& t : grid_.law_of(face).through) {
        for (std::size_t d = 0; d < 8; ++d) {
            sums.weight += w.v[d];
            sums.through += w.v[d] * t.v[d];
        }
    }
    return sums;
}

double TransportChannel::furnace_flux(std::size_t face) const {
    return face_sums(face).through * grid_.faces[face].area_mm2;
}

/// What the cells of one kind of block have in common.
struct TransportChannel::CellGeometry {
    std::array<int, 3> cells{}, per_node{};
    std::array<float, 3> edge{};
    float volume = 0;
    /// From the node's centre to the cell's, along an axis.
    [[nodiscard]] float offset(std::size_t axis, int at) const {
        return edge[axis] *
               (static_cast<float>(at % per_node[axis]) + 0.5f - 0.5f * static_cast<float>(per_node[axis]));
    }
};

TransportChannel::CellGeometry TransportChannel::geometry(BlockKind kind) const {
    CellGeometry g;
    g.cells = grid_.cells_in(kind);
    const auto edge = grid_.edge_mm(kind);
    for (std::size_t a = 0; a < 3; ++a) {
        g.per_node[a] = g.cells[a] / 4;
        g.edge[a] = static_cast<float>(edge[a]);
    }
    g.volume = g.edge[0] * g.edge[1] * g.edge[2];
    return g;
}

/// Calls body(block, geometry, cell, x, y, z, node) for every solid transport cell.
template <class Body>
void TransportChannel::for_each_cell(Body&& body) const {
    const std::array<CellGeometry, 2> kinds{geometry(BlockKind::skin), geometry(BlockKind::margin)};
    const auto blocks = [&](std::size_t first, std::size_t last) {
        std::array<std::uint32_t, 64> node_of{};
        for (std::size_t i = first; i < last; ++i) {
            const GridBlock& block = grid_.blocks[grid_.transport_blocks[i]];
            const CellGeometry& g = kinds[static_cast<std::size_t>(block.kind)];
            std::uint32_t next = block.first_node;
            for (std::size_t place = 0; place < 64; ++place)
                if (block.node_mask >> place & 1) node_of[place] = next++;
            std::size_t cell = block.first_cell;
            for (int z = 0; z < g.cells[2]; ++z)
                for (int y = 0; y < g.cells[1]; ++y) {
                    const auto row = static_cast<std::size_t>(z / g.per_node[2] * 16 + y / g.per_node[1] * 4);
                    for (int x = 0, px = 0, k = 0; x < g.cells[0]; ++x, ++cell) {
                        if (grid_.medium[cell] != 0)
                            body(block, g, cell, std::array<int, 3>{x, y, z},
                                 node_of[row + static_cast<std::size_t>(px)]);
                        if (++k == g.per_node[0]) {
                            k = 0;
                            ++px;
                        }
                    }
                }
        }
    };
    parallel_ranges(0, grid_.transport_blocks.size(), 16, blocks, progress_);
}

std::array<double, 3> TransportChannel::view_mm() const {
    std::array<double, 3> view{};
    for (std::size_t a = 0; a < 3; ++a) view[a] = grid_.pitch_mm[a] * grid_.options.view_voxels[a];
    return view;
}

void TransportChannel::make_diffusion() {
    find_node_media();
    check();
    find_face_exchange();
    check();
    find_conductances();
}

/// sigma_a_ and D_ of the nodes, and what they lose by absorption.
void TransportChannel::find_node_media() {
    const std::size_t n = grid_.nodes.size();
    const auto linear = static_cast<float>(grid_.directions.linear);
    std::vector<float> transport(n);
    sigma_a_.resize(n);
    D_.resize(n);
    loss_.resize(n);
    const auto of_block = [&](std::size_t b) {
        const GridBlock& block = grid_.blocks[b];
        if (block.kind == BlockKind::core) {
            const TransportMedium m = media_[static_cast<std::size_t>(BlockKind::core)][block.medium];
            for (int k = 0; k < std::popcount(block.node_mask); ++k) {
                sigma_a_[block.first_node + static_cast<std::size_t>(k)] = m.sigma_t - m.sigma_s;
                transport[block.first_node + static_cast<std::size_t>(k)] = m.sigma_t - linear * m.sigma_s;
            }
            return;
        }
        const auto cells = grid_.cells_in(block.kind);
        std::array<float, 64> count{}, absorbed{}, extinct{};
        std::size_t cell = block.first_cell;
        for (int z = 0; z < cells[2]; ++z)
            for (int y = 0; y < cells[1]; ++y)
                for (int x = 0; x < cells[0]; ++x, ++cell) {
                    if (grid_.medium[cell] == 0) continue;
                    const auto place =
                        static_cast<std::size_t>(((z * 4 / cells[2]) * 4 + y * 4 / cells[1]) * 4 + x * 4 / cells[0]);
                    const TransportMedium m = media_[static_cast<std::size_t>(block.kind)][grid_.medium[cell]];
                    count[place] += 1;
                    absorbed[place] += m.sigma_t - m.sigma_s;
                    extinct[place] += m.sigma_t - linear * m.sigma_s;
                }
        std::size_t node = block.first_node;
        for (std::size_t place = 0; place < 64; ++place) {
            if (!(block.node_mask >> place & 1)) continue;
            sigma_a_[node] = absorbed[place] / count[place];
            transport[node++] = extinct[place] / count[place];
        }
    };
    parallel_for(0, grid_.blocks.size(), 64, of_block, progress_);
    const auto view = view_mm();
    const double view_volume = view[0] * view[1] * view[2];
    for (std::size_t i = 0; i < n; ++i) {
        D_[i] = static_cast<float>(1 / (3 * std::max<double>(transport[i], least_transport_sigma)));
        const double edge = grid_.nodes[i].edge_cells;
        loss_[i] = static_cast<float>(sigma_a_[i] * view_volume * edge * edge * edge * grid_.nodes[i].solid_share);
    }
}

/// Outer faces: J = (T phi / 4 - S) / (1 - T / 2 + T h / (4 D)), S the current that comes in (Marshak's condition,
/// 1947, at a face that lets the share T of diffuse light through).
void TransportChannel::find_face_exchange() {
    const auto view = view_mm();
    face_loss_.resize(grid_.faces.size());
    face_gain_.resize(grid_.faces.size());
    for (std::size_t f = 0; f < grid_.faces.size(); ++f) {
        const OuterFace& face = grid_.faces[f];
        if (face.kind == FaceKind::core) continue;
        const FaceSums sums = face_sums(f);
        const double T = face.kind == FaceKind::white_sheet ? 0 : sums.through / sums.weight;
        const double h = 0.5 * view[static_cast<std::size_t>(face.facing) / 2] * grid_.nodes[face.node].solid_share;
        const double below = 1 - T / 2 + T * h / (4 * D_[face.node]);
        face_loss_[f] = static_cast<float>(face.area_mm2 * T / 4 / below);
        face_gain_[f] = static_cast<float>(face.area_mm2 / below);
        loss_[face.node] += face_loss_[f];
    }
}

/// A contact of area A lies half a node's thickness V / A from its centre, half an edge at most. Those of the
/// corrections are eased: diffusion on cells as thick as a free path overshoots and the iteration would grow; D is
/// widened by the optical depth.
void TransportChannel::find_conductances() {
    const auto view = view_mm();
    const double view_volume = view[0] * view[1] * view[2];
    const double widest = *std::max_element(view.begin(), view.end());
    conductance_.resize(grid_.contacts.size());
    eased_.resize(grid_.contacts.size());
    for (std::size_t i = 0; i < conductance_.size(); ++i) {
        const NodeContact& c = grid_.contacts[i];
        const auto half = [&](std::uint32_t node) {
            const double edge = grid_.nodes[node].edge_cells;
            return 0.5 * std::min(view[c.axis] * edge,
                                  view_volume * edge * edge * edge * grid_.nodes[node].solid_share / c.area_mm2);
        };
        const double a = half(c.a), b = half(c.b);
        const auto more = [&](std::uint32_t node) {
            return widest * std::min(0.75, options_.ease * widest / (3 * D_[node]));
        };
        conductance_[i] = static_cast<float>(c.area_mm2 / (a / D_[c.a] + b / D_[c.b]));
        eased_[i] = static_cast<float>(c.area_mm2 / (a / (D_[c.a] + more(c.a)) + b / (D_[c.b] + more(c.b))));
    }
}

/// J of every node: half of what flows through the faces on either side. `incoming`: current that comes in per area
/// (start); empty: none does (correction).
void TransportChannel::currents(std::span<const float> phi, std::span<const float> incoming,
                                std::vector<Moments>& out) const {
    out.assign(grid_.nodes.size(), {});
    std::array<float, 3> area{};
    for (std::size_t a = 0; a < 3; ++a)
        area[a] = static_cast<float>(grid_.pitch_mm[(a + 1) % 3] * grid_.options.view_voxels[(a + 1) % 3] *
                                     grid_.pitch_mm[(a + 2) % 3] * grid_.options.view_voxels[(a + 2) % 3]);
    const auto add = [&](std::size_t node, std::size_t axis, float flow) {
        const float edge = grid_.nodes[node].edge_cells;
        const float J = 0.5f * flow / (area[axis] * edge * edge);
        Moments& m = out[node];
        (axis == 0 ? m.x : axis == 1 ? m.y : m.z) += J;
    };
    for (std::size_t i = 0; i < conductance_.size(); ++i) {
        const NodeContact& c = grid_.contacts[i];
        const float flow = conductance_[i] * (phi[c.a] - phi[c.b]);
        add(c.a, c.axis, flow);
        add(c.b, c.axis, flow);
    }
    for (std::size_t f = 0; f < grid_.faces.size(); ++f) {
        const OuterFace& face = grid_.faces[f];
        if (face.kind == FaceKind::core) continue;
        const float flow = face_loss_[f] * phi[face.node] - (incoming.empty() ? 0.0f : face_gain_[f] * incoming[f]);
        add(face.node, static_cast<std::size_t>(face.facing) / 2, static_cast<int>(face.facing) % 2 ? flow : -flow);
    }
    for (std::size_t i = 0; i < out.size(); ++i) out[i].phi = phi[i];
}

void TransportChannel::solve_diffusion(std::span<const float> right, std::span<float> x, double tolerance,
                                       int most_steps) {
    const int steps = diffusion_->solve(right, x, tolerance, most_steps, progress_);
    steps_ += steps;
    open_solves_ += steps == most_steps;
}

void TransportChannel::start() {
    std::vector<float> incoming(grid_.faces.size(), 0.0f), right(grid_.nodes.size(), 0.0f);
    for (std::size_t f = 0; f < grid_.faces.size(); ++f) {
        const OuterFace& face = grid_.faces[f];
        if (face.kind == FaceKind::light) incoming[f] = static_cast<float>(face_sums(f).through) * light_[f];
        if (face.kind != FaceKind::core) right[face.node] += face_gain_[f] * incoming[f];
    }
    check();
    diffusion_ = std::make_unique<Diffusion>(plan_, conductance_, loss_);
    phi_.assign(grid_.nodes.size(), lit_evenly_ ? 1.0f : 0.0f);  // 1 is exact where nothing is absorbed
    solve_diffusion(right, phi_, options_.start_tolerance, 60);
    // The equations of the start make room for those of the corrections.
    diffusion_ = std::make_unique<Diffusion>(plan_, eased_, loss_);
    check();
    currents(phi_, incoming, delta_moments_);
    check();
    moments_.assign(grid_.medium.size(), {});
    sum_.assign(grid_.medium.size(), {});
    other_sum_.assign(grid_.medium.size(), {});
    in_.assign(grid_.faces.size() * 4, {});
    out_.assign(grid_.faces.size() * 4, {});
    pooled_.assign(grid_.regions * 64, 0.0f);
}

/// Adds delta_moments_, spread linearly over each node, to the moments of the cells and to what leaves through the
/// faces. Then the faces send back what they reflect.
void TransportChannel::enter() {
    const auto linear_change = [&](const Moments& m, float D, const std::array<float, 3>& offset) {
        return m.phi - (m.x * offset[0] + m.y * offset[1] + m.z * offset[2]) / D;
    };
    const auto& set = grid_.directions;
    for_each_cell([&](const GridBlock& block, const CellGeometry& g, std::size_t cell, const std::array<int, 3>& at,
                      std::uint32_t node) {
        const Moments& m = delta_moments_[node];
        const std::array<float, 3> offset{g.offset(0, at[0]), g.offset(1, at[1]), g.offset(2, at[2])};
        Moments& here = moments_[cell];
        here.phi += linear_change(m, D_[node], offset);
        here.x += m.x;
        here.y += m.y;
        here.z += m.z;
        if (grid_.outer[cell] == 0) return;
        auto f = static_cast<std::size_t>(
            grid_.face_of_cell[static_cast<std::size_t>(block.first_link) + (cell - block.first_cell)]);
        for (std::size_t bit = 0; bit < 6; ++bit) {
            if (!(grid_.outer[cell] >> bit & 1)) continue;
            const std::size_t face = f++, axis = bit / 2;
            const OuterFace& outer = grid_.faces[face];
            const bool plus = bit % 2 == 1;
            const std::size_t tangent[2] = {axis == 0 ? 1u : 0u, axis == 2 ? 1u : 2u};
            const FaceLaw& law = grid_.law_of(face);
            const Octet& w = flux_weight_[axis];
            std::array<float, 3> at_face = offset;
            at_face[axis] += plus ? 0.5f * g.edge[axis] : -0.5f * g.edge[axis];
            const float phi = linear_change(m, D_[node], at_face);
            const std::array<float, 3> J{m.x, m.y, m.z};
            double leaving = 0, before = 0;
            for (std::size_t slot = 0; slot < 4; ++slot) {
                Octet& out = out_[face * 4 + slot];
                for (std::size_t d = 0; d < 8; ++d) {
                    const float normal = set.cosine[axis].v[d] * J[axis];
                    before += w.v[d] * law.through[slot].v[d] * out.v[d];
                    out.v[d] += phi + 3 * ((plus ? normal : -normal) +
                                           (slot & 1 ? -1.0f : 1.0f) * set.cosine[tangent[0]].v[d] * J[tangent[0]] +
                                           (slot & 2 ? -1.0f : 1.0f) * set.cosine[tangent[1]].v[d] * J[tangent[1]]);
                    leaving += w.v[d] * law.through[slot].v[d] * out.v[d];
                }
            }
            flux_[face] = static_cast<float>(leaving * outer.area_mm2);
            flux_change_[face] = static_cast<float>((leaving - before) * outer.area_mm2);
        }
    });
    const auto send_back = [&](std::size_t i) {
        const GridBlock& block = grid_.blocks[grid_.transport_blocks[i]];
        pool(block);
        for (std::size_t face = block.first_face; face < block.first_face + block.faces; ++face)
            for (std::size_t slot = 0; slot < 4; ++slot) in_[face * 4 + slot] = returned(block, face, slot);
    };
    parallel_for(0, grid_.transport_blocks.size(), 64, send_back, progress_);
}

/// Mean radiance of the light that passes corners of the staircase, per region and direction.
void TransportChannel::pool(const GridBlock& block) {
    if (block.first_region < 0) return;
    const auto first = static_cast<std::size_t>(block.first_region) * 64;
    std::fill_n(pooled_.begin() + static_cast<std::ptrdiff_t>(first), 8 * 64, 0.0f);
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
        const FaceLaw& law = grid_.law_of(f);
        if (law.flat) continue;
        const OuterFace& face = grid_.faces[f];
        const Octet& w = flux_weight_[static_cast<std::size_t>(face.facing) / 2];
        float* const to = pooled_.data() + first + std::size_t{face.region_in_block} * 64;
        for (std::size_t slot = 0; slot < 4; ++slot)
            for (std::size_t d = 0; d < 8; ++d)
                to[static_cast<std::size_t>(leaving_octant(face.facing, static_cast<int>(slot))) * 8 + d] +=
                    w.v[d] * face.area_mm2 * law.left_over(slot, d) * out_[f * 4 + slot].v[d];
    }
    // From fluxes to radiances for the room that there is: of the same direction first, the surplus everywhere.
    for (std::size_t region = first; region < first + 8 * 64; region += 64) {
        float surplus = 0, lack = 0;
        for (std::size_t k = region; k < region + 64; ++k) {
            const float out = grid_.pool_out[k], in = grid_.pool_in[k];
            if (out > in)
                surplus += (1 - in / out) * pooled_[k];
            else
                lack += in - out;
        }
        const float everywhere = lack > 1e-12f ? surplus / lack : 0;
        for (std::size_t k = region; k < region + 64; ++k) {
            const float out = grid_.pool_out[k], in = grid_.pool_in[k];
            if (out > in)
                pooled_[k] /= out;
            else if (in > 0)
                pooled_[k] = (pooled_[k] + (in - out) * everywhere) / in;
        }
    }
}

/// Radiance that comes in through a face, given what goes out.
Octet TransportChannel::returned(const GridBlock& block, std::size_t face, std::size_t slot) const {
    const OuterFace& outer = grid_.faces[face];
    const auto axis = static_cast<std::size_t>(outer.facing) / 2;
    Octet in;
    if (outer.kind == FaceKind::core) {
        // Diffuse light: phi and J at the face, from the cell on this side and the node beyond, by what conducts
        // between.
        const double view = grid_.pitch_mm[axis] * grid_.options.view_voxels[axis];
        const double cell_edge = grid_.edge_mm(block.kind)[axis];
        const auto here = static_cast<float>(2 * D_[outer.node] / cell_edge);
        const auto there = static_cast<float>(2 * D_[outer.beyond] / (view * grid_.nodes[outer.beyond].edge_cells));
        const float phi_here = moments_[outer.cell].phi;
        const float phi = (here * phi_here + there * phi_[outer.beyond]) / (here + there);
        const float J = here * there / (here + there) * (phi_here - phi_[outer.beyond]);
        for (std::size_t d = 0; d < 8; ++d) in.v[d] = phi - 3 * grid_.directions.cosine[axis].v[d] * J;
        return in;
    }
    const FaceLaw& law = grid_.law_of(face);
    float radiance = light_[face];
    if (outer.kind == FaceKind::white_sheet) {
        float leaving = 0, through = 0;
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t d = 0; d < 8; ++d) {
                leaving += flux_weight_[axis].v[d] * law.through[k].v[d] * out_[face * 4 + k].v[d];
                through += flux_weight_[axis].v[d] * law.through[k].v[d];
            }
        radiance = leaving / through;
    }
    const Octet &back = law.through[slot ^ 3], &mirror = law.mirror[slot], &out = out_[face * 4 + slot];
    for (std::size_t d = 0; d < 8; ++d) in.v[d] = mirror.v[d] * out.v[d] + back.v[d] * radiance;
    if (law.flat) return in;
    const std::size_t from = (static_cast<std::size_t>(block.first_region) + outer.region_in_block) * 64 +
                             static_cast<std::size_t>(entering_octant(outer.facing, static_cast<int>(slot))) * 8;
    for (std::size_t d = 0; d < 8; ++d) in.v[d] += law.room(slot, d) * pooled_[from + d];
    return in;
}

void TransportChannel::sweep() {
    parallel_for(0, 2, 1, [&](std::size_t half) {
        SweepJob job{&grid_,   {media_[0], media_[1]},
                     moments_, half == 0 ? std::span<Moments>(sum_) : std::span<Moments>(other_sum_),
                     in_,      out_};
        job.progress = progress_;
        std::fill(job.sum.begin(), job.sum.end(), Moments{});
        sweep_half(job, half == 1);
    });
}

/// The diffusion correction: delta_ and delta_moments_ from what the sweep changed; moments_ become the sweep's.
void TransportChannel::correct() {
    const std::size_t n = grid_.nodes.size();
    std::vector<float> right(n, 0.0f);
    for_each_cell([&](const GridBlock& block, const CellGeometry& g, std::size_t cell, const std::array<int, 3>&,
                      std::uint32_t node) {
        const Moments &p = sum_[cell], &q = other_sum_[cell];
        const float sigma_s = media_[static_cast<std::size_t>(block.kind)][grid_.medium[cell]].sigma_s;
        const Moments now{p.phi + q.phi, p.x + q.x, p.y + q.y, p.z + q.z};
        right[node] += g.volume * sigma_s * (now.phi - moments_[cell].phi);
        moments_[cell] = now;
    });
    // What the surface will send back, and what the core got and gave.
    for (const std::uint32_t b : grid_.transport_blocks) {
        check();
        const GridBlock& block = grid_.blocks[b];
        pool(block);
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid_.faces[f];
            const Octet& w = flux_weight_[static_cast<std::size_t>(face.facing) / 2];
            float sum = 0;
            for (std::size_t slot = 0; slot < 4; ++slot)
                sum += sum8(w, face.kind == FaceKind::core ? out_[f * 4 + slot] : returned(block, f, slot)) -
                       sum8(w, in_[f * 4 + slot]);
            if (face.kind == FaceKind::core)
                right[face.beyond] += sum * face.area_mm2;
            else
                right[face.node] += face_gain_[f] * sum;
        }
    }
    const auto view = view_mm();
    const double view_volume = view[0] * view[1] * view[2];
    const auto in_core = [&](std::uint32_t node) {
        return grid_.blocks[grid_.node_block[node]].kind == BlockKind::core;
    };
    check();
    for (std::size_t i = 0; i < conductance_.size(); ++i) {
        const NodeContact& c = grid_.contacts[i];
        if (!in_core(c.a) || !in_core(c.b)) continue;
        const float flow = conductance_[i] * (phi_[c.a] - phi_[c.b]);
        right[c.a] -= flow;
        right[c.b] += flow;
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        if (!in_core(i)) continue;
        const double edge = grid_.nodes[i].edge_cells;
        right[i] -=
            static_cast<float>(sigma_a_[i] * view_volume * edge * edge * edge * grid_.nodes[i].solid_share * phi_[i]);
    }
    std::vector<float> delta(n, 0.0f);
    solve_diffusion(right, delta, options_.correction_tolerance, 30);
    currents(delta, {}, delta_moments_);
    check();
    for (std::size_t i = 0; i < n; ++i) phi_[i] += delta[i];
}

void TransportChannel::solve(std::span<const float> light, TransportSummary& summary) {
    light_.assign(grid_.faces.size(), 0.0f);
    lit_evenly_ = light.empty();
    steps_ = open_solves_ = 0;
    for (std::size_t f = 0; f < light_.size(); ++f)
        if (grid_.faces[f].kind == FaceKind::light) light_[f] = light.empty() ? 1.0f : light[f];
    flux_.assign(grid_.faces.size(), 0.0f);
    flux_change_.assign(grid_.faces.size(), 0.0f);
    Stopwatch watch;
    start();
    enter();
    summary.diffusion_s += watch.lap();
    for (int k = 0; k < options_.sweeps; ++k) {
        check();
        sweep();
        summary.sweep_s += watch.lap();
        correct();
        enter();
        summary.diffusion_s += watch.lap();
    }
    summary.diffusion_steps += steps_;
    summary.open_solves += open_solves_;
    last_change_ = 0;
    for (std::size_t f = 0; f < flux_.size(); ++f)
        if (grid_.faces[f].kind == FaceKind::light)
            last_change_ = std::max(last_change_, std::abs(flux_change_[f]) / furnace_flux(f));
}

double TransportChannel::relative_change() const {
    double change = 0, all = 0;
    for (std::size_t f = 0; f < flux_.size(); ++f)
        if (grid_.faces[f].kind == FaceKind::light) {
            change += static_cast<double>(std::abs(flux_change_[f]));
            all += static_cast<double>(std::abs(flux_[f]));
        }
    return all > 0 ? change / all : 0;
}

std::size_t TransportChannel::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(sigma_a_) + of(D_) + of(conductance_) + of(face_loss_) + of(face_gain_) + of(light_) + of(phi_) +
           of(delta_moments_) + of(moments_) + of(sum_) + of(other_sum_) + of(in_) + of(out_) + of(pooled_) +
           of(flux_) + of(flux_change_) + of(eased_) + of(loss_) + diffusion_->memory_bytes();
}

TransportChannel::Field TransportChannel::take_field() { return {std::move(moments_), std::move(in_)}; }

// psi solves L psi = S psi with psi coming in through the surface; the adjoint of L is L with all directions reversed,
// so
//   d F / d sigma_t = -V sum_d w_d psi_d psi*_-d,   d F / d sigma_s = V (phi phi* - 3 g' J . J*)
// in each cell: psi* is lit by dF / d flux. The sums over directions are those of the sweeps themselves, with the terms
// that exponential fitting adds: for  L psi + fit (sigma psi - q) = 0,  m = fit psi + (1 - fit) q / sigma  seen by the
// cell,
//   -V sum_d w_d [ d sigma (fit psi psi* + (1 - fit) q q* / sigma^2)
//                  + d fit (sigma psi psi* - psi q* - q psi* + q q* / sigma) ].
void TransportChannel::derivatives(const Field& forward, const Field& adjoint, std::vector<float>& by_sigma_t,
                                   std::vector<float>& by_sigma_s) const {
    const std::size_t n = grid_.medium.size();
    std::vector<Octet> record(2 * n), out(grid_.faces.size() * 4);
    by_sigma_t.assign(n, 0.0f);
    by_sigma_s.assign(n, 0.0f);
    std::vector<float> product(2 * n, 0.0f);
    for (int octant = 0; octant < 8; ++octant) {
        SweepJob job{&grid_, {media_[0], media_[1]}, forward.moments, {}, forward.in, out, record, {}};
        job.progress = progress_;
        record_octant(job, octant);
        SweepJob against{&grid_, {media_[0], media_[1]}, adjoint.moments, {}, adjoint.in, out, record, product};
        against.progress = progress_;
        multiply_octant(against, 7 - octant);
    }
    const auto g_linear = static_cast<float>(grid_.directions.linear);
    for_each_cell(
        [&](const GridBlock&, const CellGeometry& g, std::size_t cell, const std::array<int, 3>&, std::uint32_t) {
            const Moments &a = forward.moments[cell], &b = adjoint.moments[cell];
            by_sigma_t[cell] = -g.volume * (product[2 * cell] + product[2 * cell + 1]);
            by_sigma_s[cell] =
                g.volume * (product[2 * cell + 1] + a.phi * b.phi - 3 * g_linear * (a.x * b.x + a.y * b.y + a.z * b.z));
        });
}

}  // namespace voxtone::optics
