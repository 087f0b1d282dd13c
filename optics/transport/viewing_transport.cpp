// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_transport.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/step_part.h"
#include "base/stopwatch.h"
#include "optics/numerics/portable_math.h"
#include "optics/numerics/prefetch.h"
#include "optics/transport/lattice.h"
#include "optics/transport/transport_medium.h"
#include "optics/transport/viewing_derivatives.h"

namespace voxtone::optics {
namespace {

constexpr float least_transport_sigma = 0.2f;  // mm^-1; keeps diffusion finite in clear resin, where it is only a guess
constexpr std::size_t blocks_per_task = 32;

// Keep the corrections stable on cells as thick as a free path, where diffusion overshoots and the iteration would
// grow: artificial diffusion, in edges of a cell added to D per optical depth of one, and at most (the form is that of
// Zhu et al. 2016, "An optimally diffusive coarse mesh finite difference method to accelerate neutron transport
// calculations", Ann. Nucl. Energy 95:116). The figures are this iteration's own, not values of their polynomial: with
// them it converges at 0.29 to 0.39 a sweep (convergence_test.cpp).
constexpr float widening = 0.55f, most_widening = 0.75f;

// A vector type of the compiler: left to itself it takes these floats one by one.
using Four __attribute__((vector_size(16))) = float;

Four four(const float* from) {
    Four v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
void put(const Four& v, float* to) { std::memcpy(to, &v, sizeof v); }
Four above_zero(const Four& v) { return v > 0 ? v : Four{}; }

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

ViewingTransport::ViewingTransport(const ViewingGrid& grid, const TransportOptions& options, Room room)
    : grid_(grid),
      options_(options),
      diffusion_(grid),
      moments_(std::move(room.moments)),
      scratch_(std::move(room.scratch)),
      in_(std::move(room.in)),
      out_(std::move(room.out)),
      flux_(std::move(room.flux)),
      flux_change_(std::move(room.flux_change)) {
    scratch_.resize(grid.cells());
    // Both ways along z keep two threads busy; more of them cross several planes of each at once.
    const std::size_t threads = thread_count(), fronts = threads > 2 ? threads / 2 + 2 : 1;
    for (std::size_t half = 0; half < 2; ++half) rows_[half] = sweep_rows(grid, half == 1, fronts);
    const auto edge = grid_.edge_mm();
    for (std::size_t a = 0; a < 3; ++a) {
        edge_[a] = static_cast<float>(edge[a]);
        for (std::size_t d = 0; d < 8; ++d)
            flux_weight_[a].v[d] = grid_.directions.weight.v[d] * grid_.directions.cosine[a].v[d];
    }
    volume_ = edge_[0] * edge_[1] * edge_[2];
    sheet_way_ = static_cast<float>(way_into_sheet(grid_.directions));
    sheet_T_inverse_ = static_cast<float>(1 / let_out_of_diffuse(grid_.directions));
    const std::size_t cells = grid.cells(), faces = grid_.faces.size();
    moments_.resize(cells);
    x_ = scratch_.vector(0);
    right_ = scratch_.vector(1);
    p_ = scratch_.vector(2);
    z_ = scratch_.vector(3);
    for (auto* const values : {&core_phi_, &core_x_, &core_right_, &core_p_, &core_z_})
        values->resize(grid.core_block.size());
    in_.resize(4 * grid.open_faces.size());
    out_.resize(4 * grid.open_faces.size());
    core_in_.resize(grid.core_faces.size());
    core_out_.resize(4 * grid.core_faces.size());
    flux_.resize(faces);
    flux_change_.resize(faces);
    std::vector<std::uint8_t> axis_of(grid_.laws.size(), 0);
    for (std::size_t f = 0; f < faces; ++f)
        axis_of[grid_.law[f]] = static_cast<std::uint8_t>(grid_.faces[f].facing) / 2;
    sums_.resize(grid_.laws.size());
    for (std::size_t l = 1; l < sums_.size(); ++l)
        for (const Octet& t : grid_.laws[l].through)
            for (std::size_t d = 0; d < 8; ++d) {
                sums_[l].weight += flux_weight_[axis_of[l]].v[d];
                sums_[l].through += flux_weight_[axis_of[l]].v[d] * t.v[d];
            }
}

std::size_t ViewingTransport::Room::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(moments) + scratch.memory_bytes() + of(in) + of(out) + of(flux) + of(flux_change);
}

ViewingTransport::Room ViewingTransport::take_room() {
    return {std::move(moments_), std::move(scratch_), std::move(in_),
            std::move(out_),     std::move(flux_),    std::move(flux_change_)};
}

std::size_t ViewingTransport::bytes_for(const ViewingGrid& grid, std::size_t channels) {
    return grid.cells() * (4 * sizeof(Moments) + 8) + grid.cells() / 64 * channels * sizeof(ViewingField::BlockCode) +
           grid.open_faces.size() * (8 * sizeof(Octet) + sizeof(ViewingField::FaceCode) * channels + 8) +
           grid.core_faces.size() * 32 + grid.cells() / 64 * 440 + grid.core_block.size() * 200;
}

float ViewingTransport::furnace_flux(std::size_t face) const {
    return sums_[grid_.law[face]].through * grid_.faces[face].area_mm2;
}

float ViewingTransport::phi(std::size_t cell) const { return moments_[cell].phi; }

float ViewingTransport::mean_phi(const GridBlock& block) const {
    if (block.kind == BlockKind::core) return core_phi_[block.core_node];
    double sum = 0;
    int solid = 0;
    for (std::size_t cell = block.first_cell; cell < block.first_cell + 64u; ++cell)
        if (grid_.medium[cell] != 0) {
            sum += static_cast<double>(phi(cell));
            ++solid;
        }
    return solid == 0 ? 0 : static_cast<float>(sum / solid);
}

void ViewingTransport::prepare() {
    const auto linear = static_cast<float>(grid_.directions.linear);
    const float widest = *std::max_element(edge_.begin(), edge_.end());
    const auto fill = [&](const std::vector<TransportMedium>& media, std::vector<float>& D, std::vector<float>& widened,
                          float edge) {
        D.assign(media.size(), 0.0f);
        widened.assign(media.size(), 0.0f);
        for (std::size_t m = 1; m < media.size(); ++m) {
            D[m] = 1 / (3 * std::max(media[m].sigma_t - linear * media[m].sigma_s, least_transport_sigma));
            widened[m] = D[m] + edge * std::min(most_widening, widening * edge / (3 * D[m]));
        }
    };
    fill(media_->cells, D_, widened_, widest);
    fill(media_->core, core_D_, core_widened_, widest);
    fit_core(widest);
    core_loss_.resize(core_x_.size());
    for (std::size_t i = 0; i < core_loss_.size(); ++i) core_loss_[i] = loss_of_core(i);
    std::array<double, 3> edge_mm = grid_.edge_mm();
    cell_ways_ = sweep_media(grid_.directions, edge_mm, static_cast<float>(viewing_theta), media_->cells);
    if (grid_.fine.any())
        for (std::size_t a = 0; a < 3; ++a) edge_mm[a] /= grid_.fine.split[a];
    part_ways_ = sweep_media(grid_.directions, edge_mm, static_cast<float>(fine_theta), media_->parts);
    exchange_.resize(grid_.faces.size());
    parallel_ranges(0, exchange_.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
            if (grid_.faces[f].kind != FaceKind::core) exchange_[f] = exchange_at(f);
    });
}

/// Light decays across a block of one node, by e^-2x: with D x / tanh x and sigma_a sinh 2x / 2x nodes in a row have
/// the values of e^-2xn in their middles, and the first of them takes up what a half-space does, phi D / (diffusion
/// length) (exponential fitting, as for cells in transport_sweep.h). Exact along the axes.
void ViewingTransport::fit_core(float widest) {
    constexpr float exact = 1e-3f, dark = 4;  // beyond, no light comes back
    core_sigma_a_.resize(core_D_.size());
    for (std::size_t m = 0; m < core_D_.size(); ++m) {
        core_sigma_a_[m] = media_->core[m].sigma_t - media_->core[m].sigma_s;
        if (!(core_D_[m] > 0 && core_sigma_a_[m] > 0)) continue;
        const float x = std::min(2 * widest * std::sqrt(core_sigma_a_[m] / core_D_[m]), dark);
        if (x < exact) continue;
        const float wider = core_D_[m] * (x / portable::tanh(x) - 1);
        core_D_[m] += wider;
        core_widened_[m] += wider;
        core_sigma_a_[m] *= portable::sinh(2 * x) / (2 * x);
    }
}

/// J = (T phi / 4 - S) / (1 - T / 2 + T h / (4 D)), S the current that comes in (Marshak's condition).
ViewingTransport::Exchange ViewingTransport::exchange_at(std::size_t f) const {
    const OuterFace& face = grid_.faces[f];
    const FaceSums& sums = sums_[grid_.law[f]];
    if (face.kind == FaceKind::mirror) return {0, face.area_mm2};
    const float T = (face.kind == FaceKind::white_sheet ? 1 - sent_back(f) : 1.0f) * (sums.through / sums.weight);
    const float below =
        1 - T / 2 + T * 0.5f * edge_[static_cast<std::size_t>(face.facing) / 2] / (4 * D_[grid_.medium[face.cell]]);
    return {face.area_mm2 * T / 4 / below, face.area_mm2 / below};
}

/// The equations for these diffusion constants; what is lost: absorbed, and out through the surface. Works in x_.
void ViewingTransport::make_equations(const std::vector<float>& D, const std::vector<float>& core_D) {
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell) {
            const TransportMedium& m = media_->cells[grid_.medium[cell]];
            x_[cell] = volume_ * (m.sigma_t - m.sigma_s);
        }
        const GridBlock& block = grid_.transport_block(t);
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
            if (grid_.faces[f].kind != FaceKind::core) x_[grid_.faces[f].cell] += exchange_[f].loss;
    });
    for (std::size_t i = 0; i < core_x_.size(); ++i) core_x_[i] = core_loss_[i];
    if (!ghost_phi_.empty()) {
        // A loss so large that nothing moves them; their equations have no right side.
        const float widest = *std::max_element(core_D.begin(), core_D.end());
        const float held =
            1e4f * (diffusion_.core_contact(0, widest, widest) + diffusion_.core_contact(1, widest, widest) +
                    diffusion_.core_contact(2, widest, widest));
        for (const std::uint32_t ghost : grid_.ghosts) core_x_[ghost] = held;
    }
    check();
    diffusion_.prepare(D, core_D, x_, core_x_, scratch_.equations(), progress_);
}

int ViewingTransport::solve_diffusion(double tolerance, int most_steps) {
    const int steps = diffusion_.solve({x_, core_x_}, {right_, core_right_}, {p_, core_p_}, {z_, core_z_}, tolerance,
                                       most_steps, progress_);
    steps_ += steps;
    return steps;
}

/// What a node loses for its phi: what it absorbs, and what a sheet takes (transport_medium.h). Where the share R of
/// what leaves comes in again, J = (1 - R) (T phi / 4 + U J / 2), and phi / J is 4 R / ((1 - R) T) more.
float ViewingTransport::loss_of_core(std::size_t core) const {
    constexpr float least_way = 0.5f;  // of a thin block, whose middle lies below the sheet
    const GridBlock& block = grid_.blocks[grid_.core_block[core]];
    const float absorbed = 64 * volume_ * core_sigma_a_[block.medium];
    if (!grid_.is_on_sheet(block.at)) return absorbed;
    const float height = 4 * edge_[2],
                depth = height + static_cast<float>(grid_.corner_of(block.at)[2] * grid_.pitch_mm[2]);
    const float returned = grid_.backing == Backing::black ? 0
                           : media_->core_sheet.empty()    ? 1
                                                           : media_->core_sheet[core];
    if (returned >= 1) return absorbed * depth / height;
    const float way =
        sheet_way_ + sheet_T_inverse_ * 4 * returned / (1 - returned) + (depth - height / 2) / core_D_[block.medium];
    return absorbed * depth / height + 16 * edge_[0] * edge_[1] / std::max(way, least_way);
}

/// Light by diffusion alone, from a guess of phi: the steps that it took.
int ViewingTransport::start(float guess, double tolerance, int most_steps) {
    std::fill(moments_.begin(), moments_.end(), Moments{});
    std::fill(parts_.begin(), parts_.end(), Moments{});
    std::fill(out_.begin(), out_.end(), Octet{});
    std::fill(core_phi_.begin(), core_phi_.end(), 0.0f);
    std::fill(x_.begin(), x_.end(), guess);
    std::fill(core_x_.begin(), core_x_.end(), guess);
    for (std::size_t i = 0; i < ghost_phi_.size(); ++i) core_x_[grid_.ghosts[i]] = ghost_phi_[i];
    std::fill(right_.begin(), right_.end(), 0.0f);
    std::fill(core_right_.begin(), core_right_.end(), 0.0f);
    for (const std::uint32_t f : grid_.open_faces) {
        const OuterFace& face = grid_.faces[f];
        if (face.kind == FaceKind::light)
            right_[face.cell] += exchange_[f].gain * sums_[grid_.law[f]].through * light(f);
    }
    check();
    const auto each_cell = [&](auto&& body) {
        parallel_ranges(0, x_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
            for (std::size_t cell = begin; cell < end; ++cell) body(cell);
        });
    };
    if (guess != 0) {
        diffusion_.apply({x_, core_x_}, {z_, core_z_});
        each_cell([&](std::size_t cell) { right_[cell] -= z_[cell]; });
        for (std::size_t i = 0; i < core_x_.size(); ++i) core_right_[i] -= core_z_[i];
    }
    hold_ghosts();
    const int steps = solve_diffusion(tolerance, most_steps);
    each_cell([&](std::size_t cell) { x_[cell] = grid_.medium[cell] == 0 ? 0 : x_[cell]; });
    check();
    enter(true);
    check();
    reflect();
    return steps;
}

void ViewingTransport::load(const ViewingField& field) {
    parallel_ranges(0, field.blocks.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = 64 * begin; i < 64 * end; ++i) moments_[i] = field.blocks[i / 64].moments(i % 64);
    });
    std::copy(field.core.begin(), field.core.end(), core_phi_.begin());
    for (std::size_t i = 0; i < ghost_phi_.size(); ++i) core_phi_[grid_.ghosts[i]] = ghost_phi_[i];
    parallel_ranges(0, grid_.open_faces.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < 32; ++k) out_[4 * i + k / 8].v[k % 8] = phi_step * code_of(field.out[i], k);
    });
    reflect();
}

void ViewingTransport::store(ViewingField& field, TransportSummary& summary) const {
    std::atomic<std::size_t> kept{0}, clipped{0};
    field.blocks.resize(grid_.transport_blocks.size());
    parallel_ranges(0, field.blocks.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
        std::size_t solid = 0, out_of_range = 0;
        for (std::size_t t = begin; t < end; ++t) {
            std::uint64_t holds = 0;
            for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell) {
                if (grid_.medium[cell] == 0) continue;
                holds |= std::uint64_t{1} << cell % 64;
                ++solid;
                out_of_range += !phi_code.fits(moments_[cell].phi);
            }
            field.blocks[t] = block_code(&moments_[64 * t], holds);
        }
        kept += solid;
        clipped += out_of_range;
    });
    field.core = core_phi_;
    field.out.resize(grid_.open_faces.size());
    parallel_ranges(0, grid_.open_faces.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) field.out[i] = face_code(&out_[4 * i]);
    });
    summary.kept_values += kept;
    summary.clipped_values += clipped;
}

// J of a cell is half of what flows through the faces on either side, from x_ and, at the start, the light that comes
// in. Adds phi and J, spread linearly over the cell, to the moments of cells and to what leaves through faces.
void ViewingTransport::enter(bool start) {
    std::array<float, 3> area{};
    for (std::size_t a = 0; a < 3; ++a) area[a] = volume_ / edge_[a];
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        const GridBlock& block = grid_.transport_block(t);
        prefetch_laws(t + 1);
        ViewingDiffusion::Flows J = diffusion_.flows(t, D_, core_D_, {x_, core_x_});
        const std::size_t first = 64 * t;
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid_.faces[f];
            if (face.kind == FaceKind::core) continue;
            const std::size_t a = static_cast<std::size_t>(face.facing) / 2;
            const Exchange at = exchange_[f];
            const float flow =
                at.loss * x_[face.cell] -
                (start && face.kind == FaceKind::light ? at.gain * sums_[grid_.law[f]].through * light(f) : 0);
            J[a][face.cell - first] += static_cast<int>(face.facing) % 2 ? flow : -flow;
        }
        for (std::size_t place = 0; place < 64; ++place) {
            const std::size_t cell = first + place;
            if (grid_.medium[cell] == 0) continue;
            for (std::size_t a = 0; a < 3; ++a) J[a][place] *= 0.5f / area[a];
            moments_[cell] += {x_[cell], J[0][place], J[1][place], J[2][place]};
        }
        if (grid_.fine.any() && grid_.fine.first[t] != not_fine) enter_parts(t, J);
        enter_faces(t, J);
    });
    for (std::size_t i = 0; i < core_phi_.size(); ++i) core_phi_[i] += core_x_[i];
}

/// The correction, linear over each cell of a block, in its parts.
void ViewingTransport::enter_parts(std::size_t t, const ViewingDiffusion::Flows& J) {
    const ViewingGrid::Fine& fine = grid_.fine;
    std::array<std::vector<float>, 3> falls;  // how much less phi is in a part, by its place along each axis
    for (std::size_t a = 0; a < 3; ++a) falls[a].resize(static_cast<std::size_t>(fine.split[a]));
    for_each({4, 4, 4}, [&](const Place& cell) {
        const std::size_t place = place_in_block(cell), at = 64 * t + place;
        if (grid_.medium[at] == 0) return;
        const float D = D_[grid_.medium[at]];
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t k = 0; k < falls[a].size(); ++k) {
                const float offset = (static_cast<float>(k) + 0.5f) / static_cast<float>(fine.split[a]) - 0.5f;
                falls[a][k] = offset * edge_[a] * J[a][place] / D;
            }
        const float phi = x_[at];
        Moments* const first = parts_.data() + fine.first[t] + fine.part(cell, {});
        for_each(fine.split, [&](const Place& part) {
            float here = phi;
            for (std::size_t a = 0; a < 3; ++a) here -= falls[a][static_cast<std::size_t>(part[a])];
            first[fine.part({}, part)] += {here, J[0][place], J[1][place], J[2][place]};
        });
    });
}

/// What the last sweep changed in a block's parts, as sources of its cells in scratch_.up().phi; the parts and their
/// means become the sweep's.
void ViewingTransport::gather_parts(std::size_t t) {
    const ViewingGrid::Fine& fine = grid_.fine;
    const float share = 1 / static_cast<float>(fine.parts()), volume = volume_ * share;
    for_each({4, 4, 4}, [&](const Place& cell) {
        const std::size_t at = 64 * t + place_in_block(cell);
        float source = 0;
        Moments mean;
        if (grid_.medium[at] != 0) {
            const std::size_t first = fine.first[t] + fine.part(cell, {});
            for_each(fine.split, [&](const Place& part) {
                const std::size_t i = first + fine.part({}, part);
                const Moments now = parts_up_[i] + parts_down_[i];
                source += volume * media_->parts[fine.medium[i]].sigma_s * (now.phi - parts_[i].phi);
                mean += share * now;
                parts_[i] = now;
            });
        }
        scratch_.up()[at].phi = source;
        moments_[at] = mean;
    });
}

/// What a sweep of whole cells changed, alike in all parts of a cell.
void ViewingTransport::take_into_parts(std::size_t t) {
    const ViewingGrid::Fine& fine = grid_.fine;
    for_each({4, 4, 4}, [&](const Place& cell) {
        const std::size_t at = 64 * t + place_in_block(cell);
        if (grid_.medium[at] == 0) return;
        const Moments more = scratch_.up()[at] + scratch_.down()[at] + -1.0f * moments_[at];
        Moments* const first = parts_.data() + fine.first[t] + fine.part(cell, {});
        for_each(fine.split, [&](const Place& part) { first[fine.part({}, part)] += more; });
    });
}

/// The correction in what leaves through the faces of a block, and in their fluxes.
void ViewingTransport::enter_faces(std::size_t t, const ViewingDiffusion::Flows& J) {
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
        const Octet& w = flux_weight_[axis];
        const std::size_t at = face.cell - first;
        const std::array<float, 3> j{J[0][at], J[1][at], J[2][at]};
        const float phi = x_[face.cell] - (plus ? 0.5f : -0.5f) * edge_[axis] * j[axis] / D_[grid_.medium[face.cell]];
        const float Jn = 3 * (plus ? j[axis] : -j[axis]), Ju = 3 * j[tangent[0]], Jv = 3 * j[tangent[1]];
        float leaving = 0, before = 0;
        for (std::size_t slot = 0; slot < 4; ++slot) {
            Octet& out = out_[4 * std::size_t{grid_.place_of_face[f]} + slot];
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
        flux_[f] = leaving * face.area_mm2;
        flux_change_[f] = (leaving - before) * face.area_mm2;
    }
}

/// The faces send back what they reflect.
void ViewingTransport::reflect() {
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        const GridBlock& block = grid_.transport_block(t);
        prefetch_laws(t + 1);
        Pool passing;
        pool(block, passing);
        for (std::size_t face = block.first_face; face < block.first_face + block.faces; ++face) {
            const std::uint32_t place = grid_.place_of_face[face];
            if (place & into_core)
                core_in_[place & ~into_core] = from_core(face);
            else
                for (std::size_t slot = 0; slot < 4; ++slot)
                    in_[4 * std::size_t{place} + slot] = returned(passing, face, slot);
        }
    });
}

/// From memory, while the block before is worked at: faces that lie side by side have laws that do not.
void ViewingTransport::prefetch_laws(std::size_t t) const {
    if (t >= grid_.transport_blocks.size()) return;
    const GridBlock& block = grid_.transport_block(t);
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) prefetch(grid_.law_of(f));
}

/// Mean radiance of the light that passes corners of the staircase, per region and direction (transport_directions.h).
void ViewingTransport::pool(const GridBlock& block, Pool& pool) const {
    if (!block.slanting) return;
    std::array<float, 512> leaves{}, room{};
    unsigned regions = 0;  // that have faces
    pool.fill(0);
    for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
        const FaceLaw& law = grid_.law_of(f);
        if (law.flat) continue;
        const OuterFace& face = grid_.faces[f];
        const Octet& w = flux_weight_[static_cast<std::size_t>(face.facing) / 2];
        const std::size_t region = std::size_t{face.region_in_block} * 64;
        regions |= 1u << face.region_in_block;
        for (std::size_t slot = 0; slot < 4; ++slot) {
            const std::size_t out = region +
                                    static_cast<std::size_t>(leaving_octant(face.facing, static_cast<int>(slot))) * 8,
                              in = region +
                                   static_cast<std::size_t>(entering_octant(face.facing, static_cast<int>(slot))) * 8;
            const Octet& leaving = out_[4 * std::size_t{grid_.place_of_face[f]} + slot];
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
std::array<float, 2> ViewingTransport::from_core(std::size_t face) const {
    const OuterFace& outer = grid_.faces[face];
    const auto axis = static_cast<std::size_t>(outer.facing) / 2;
    const std::uint16_t medium = grid_.medium[outer.cell];
    const float here = 2 * D_[medium] / edge_[axis];
    const float there = core_D_[grid_.blocks[grid_.core_block[outer.beyond]].medium] / (2 * edge_[axis]);
    const float phi_here = moments_[outer.cell].phi, phi_there = core_phi_[outer.beyond];
    return {(here * phi_here + there * phi_there) / (here + there),
            here * there / (here + there) * (phi_here - phi_there)};
}

/// Radiance that comes in through an open face, given what goes out.
Octet ViewingTransport::returned(const Pool& pool, std::size_t face, std::size_t slot) const {
    const OuterFace& outer = grid_.faces[face];
    const auto axis = static_cast<std::size_t>(outer.facing) / 2;
    const Octet* const leaves = out_.data() + 4 * std::size_t{grid_.place_of_face[face]};
    Octet in;
    const FaceLaw& law = grid_.law_of(face);
    float radiance = light(face);
    if (outer.kind == FaceKind::white_sheet) {
        float leaving = 0, through = 0;
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t d = 0; d < 8; ++d) {
                leaving += flux_weight_[axis].v[d] * law.through[k].v[d] * leaves[k].v[d];
                through += flux_weight_[axis].v[d] * law.through[k].v[d];
            }
        radiance = sent_back(face) * (leaving / through);
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

/// What the surface will send back more than it did.
void ViewingTransport::add_sources_at_faces() {
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        const GridBlock& block = grid_.transport_block(t);
        prefetch_laws(t + 1);
        Pool passing;
        pool(block, passing);
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid_.faces[f];
            if (face.kind == FaceKind::core) continue;
            const Octet& w = flux_weight_[static_cast<std::size_t>(face.facing) / 2];
            float sum = 0;
            for (std::size_t slot = 0; slot < 4; ++slot) {
                const Octet from = returned(passing, f, slot);
                const Octet& was = in_[4 * std::size_t{grid_.place_of_face[f]} + slot];
                for (std::size_t d = 0; d < 8; ++d) sum += w.v[d] * (from.v[d] - was.v[d]);
            }
            right_[face.cell] += exchange_[f].gain * sum;
        }
    });
}

void ViewingTransport::sweep(bool in_parts) {
    parallel_for(0, 2, 1, [&](std::size_t half) {
        SweepJob job{.grid = grid_,
                     .cells = {.media = cell_ways_,
                               .light = moments_,
                               .sum = half == 0 ? scratch_.up() : scratch_.down(),
                               .theta = static_cast<float>(viewing_theta)},
                     .parts = {},
                     .in = in_,
                     .out = out_,
                     .core_in = core_in_,
                     .core_out = core_out_,
                     .rows = rows_[half],
                     .progress = progress_};
        if (in_parts)
            job.parts = {.media = part_ways_,
                         .light = parts_,
                         .sum = half == 0 ? parts_up_ : parts_down_,
                         .theta = static_cast<float>(fine_theta)};
        sweep_half(job, half == 1);
    });
}

/// What the sweep changed, as sources in right_; moments_ become the sweep's. `right_` lies over `down`
/// (sweep_scratch.h): sources stay in the phi of `up` until all of both has been read.
void ViewingTransport::take_sweep(bool in_parts) {
    const std::span<Moments> up = scratch_.up(), down = scratch_.down();
    const auto each_fine_block = [&](auto&& body) {
        parallel_for(0, grid_.fine.first.size(), blocks_per_task, [&](std::size_t t) {
            if (grid_.fine.first[t] != not_fine) body(t);
        });
    };
    if (!in_parts) each_fine_block([&](std::size_t t) { take_into_parts(t); });
    parallel_ranges(0, moments_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            const Moments now = up[cell] + down[cell];
            const float sigma_s = media_->cells[grid_.medium[cell]].sigma_s;
            up[cell].phi = volume_ * sigma_s * (now.phi - moments_[cell].phi);
            moments_[cell] = now;
        }
    });
    if (in_parts) each_fine_block([&](std::size_t t) { gather_parts(t); });
    parallel_ranges(0, moments_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) right_[cell] = up[cell].phi;
    });
}

/// What the core got and gave, and what it absorbs.
void ViewingTransport::find_core_sources() {
    for (std::size_t i = 0; i < core_right_.size(); ++i) core_right_[i] = -core_loss_[i] * core_phi_[i];
    std::array<float, 3> by_phi{}, by_J{};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t d = 0; d < 8; ++d) {
            by_phi[a] += 4 * flux_weight_[a].v[d];
            by_J[a] += 12 * flux_weight_[a].v[d] * grid_.directions.cosine[a].v[d];
        }
    for (std::size_t c = 0; c < core_in_.size(); ++c) {
        const OuterFace& face = grid_.faces[grid_.core_faces[c]];
        const auto a = static_cast<std::size_t>(face.facing) / 2;
        const float out = core_out_[4 * c] + core_out_[4 * c + 1] + core_out_[4 * c + 2] + core_out_[4 * c + 3];
        core_right_[face.beyond] += face.area_mm2 * (out - by_phi[a] * core_in_[c][0] + by_J[a] * core_in_[c][1]);
    }
    for (const ViewingDiffusion::CoreContact& c : diffusion_.core_contacts()) {
        const auto D = [&](std::uint32_t core) { return core_D_[grid_.blocks[grid_.core_block[core]].medium]; };
        const float flow = diffusion_.core_contact(c.axis, D(c.a), D(c.b)) * (core_phi_[c.a] - core_phi_[c.b]);
        core_right_[c.a] -= flow;
        core_right_[c.b] += flow;
    }
}

/// The diffusion correction, into x_ and core_x_, from what the sweep changed; moments_ become the sweep's.
void ViewingTransport::correct(bool in_parts) {
    take_sweep(in_parts);
    check();
    add_sources_at_faces();
    find_core_sources();
    hold_ghosts();
    check();
    std::fill(x_.begin(), x_.end(), 0.0f);
    std::fill(core_x_.begin(), core_x_.end(), 0.0f);
    // One step leaves a tenth to a third of the residual; the next sweep makes more of the time that another would
    // take.
    solve_diffusion(0, 1);
}

/// No residual where the light is given.
void ViewingTransport::hold_ghosts() {
    if (ghost_phi_.empty()) return;
    for (const std::uint32_t ghost : grid_.ghosts) core_right_[ghost] = 0;
}

void ViewingTransport::begin(const Media& media, const Progress* progress) {
    VOXTONE_EXPECT(media.cells.size() == grid_.mixtures.size());
    media_ = &media;
    progress_ = progress;
    for (auto* const parts : {&parts_, &parts_up_, &parts_down_}) parts->resize(grid_.fine.medium.size());
    check();
    prepare();
    std::fill(flux_.begin(), flux_.end(), 0.0f);
    std::fill(flux_change_.begin(), flux_change_.end(), 0.0f);
}

void ViewingTransport::iterate(Sweeps sweeps, TransportSummary& summary) {
    Stopwatch watch;
    for (int k = 0; k < sweeps.most; ++k) {
        check();
        const bool in_parts = grid_.fine.any() && (k > 0 || sweeps.least == 1);
        sweep(in_parts);
        summary.sweep_s += watch.lap();
        check();
        correct(in_parts);
        check();
        enter(false);
        check();
        const int made = k + 1;
        tell_part(progress_, double(1 + made) / (1 + sweeps.most));
        const bool more = made < sweeps.most && (made < sweeps.least || !(relative_change() < sweeps.enough));
        if (more) reflect();
        summary.diffusion_s += watch.lap();
        if (!more) break;
    }
}

void ViewingTransport::end(TransportSummary& summary) {
    summary.diffusion_steps += steps_;
    steps_ = 0;
    progress_ = nullptr;
}

void ViewingTransport::solve(const Media& media, ViewingField& field, Sweeps sweeps, TransportSummary& summary,
                             const Progress* progress, std::span<const float> ghost_phi) {
    VOXTONE_EXPECT(field.blocks.empty() ||
                   (!grid_.fine.any() && field.blocks.size() == grid_.transport_blocks.size() &&
                    field.core.size() == grid_.core_block.size() && field.out.size() == grid_.open_faces.size()));
    VOXTONE_EXPECT(ghost_phi.empty() || ghost_phi.size() == grid_.ghosts.size());
    Stopwatch watch;
    light_.clear();
    ghost_phi_.assign(ghost_phi.begin(), ghost_phi.end());
    begin(media, progress);
    if (field.blocks.empty()) {
        constexpr int most_steps = 60;
        make_equations(D_, core_D_);
        // 1 is exact where nothing is absorbed.
        summary.open_solves += start(1, options_.start_tolerance, most_steps) == most_steps;
    } else {
        load(field);
    }
    if (sweeps.most > 0) make_equations(widened_, core_widened_);
    summary.diffusion_s += watch.lap();
    tell_part(progress_, 1.0 / (1 + sweeps.most));
    iterate(sweeps, summary);
    end(summary);
    TransportSummary first_guess;  // diffusion alone: what is clipped of it does not matter to the sweeps to come
    store(field, sweeps.most > 0 ? summary : first_guess);
    last_change_ = 0;
    for (const std::uint32_t f : grid_.open_faces)
        if (grid_.faces[f].kind == FaceKind::light)
            last_change_ = std::max(last_change_, static_cast<double>(std::abs(flux_change_[f]) / furnace_flux(f)));
}

void ViewingTransport::solve_adjoint(const Media& media, std::span<const float> light, int sweeps,
                                     TransportSummary& summary, const Progress* progress) {
    VOXTONE_EXPECT(light.size() == grid_.faces.size() && !grid_.fine.any());
    Stopwatch watch;
    light_.clear();
    for (const std::uint32_t f : grid_.open_faces)
        light_.push_back(grid_.faces[f].kind == FaceKind::light ? light[f] : 0);
    ghost_phi_.clear();
    begin(media, progress);
    // One step leaves less than a sweep mends.
    make_equations(widened_, core_widened_);
    start(0, 0, 1);
    summary.diffusion_s += watch.lap();
    iterate({sweeps, sweeps, 0}, summary);
    end(summary);
}

void ViewingTransport::derivatives(const ViewingField& forward, std::span<float> by_sigma_t,
                                   std::span<float> by_sigma_s, const Progress* progress) {
    VOXTONE_EXPECT(light_.size() == grid_.open_faces.size() && forward.blocks.size() == grid_.transport_blocks.size());
    const DerivativeScene scene{grid_, media_->cells, volume_};
    const auto check_cancelled = [progress] {
        if (progress) progress->check_cancelled();
    };
    derivatives_by_moments(scene, forward.blocks, moments_, by_sigma_t, by_sigma_s);
    check_cancelled();
    reflect();
    const std::vector<Octet> in = in_, out = out_;
    light_.clear();
    check_cancelled();
    load(forward);
    check_cancelled();
    add_derivatives_at_faces(scene, {out_, in_}, {out, in}, by_sigma_t);
}

double ViewingTransport::relative_change() const {
    double change = 0, all = 0;
    for (const std::uint32_t f : grid_.open_faces)
        if (grid_.faces[f].kind == FaceKind::light) {
            change += static_cast<double>(std::abs(flux_change_[f]));
            all += static_cast<double>(std::abs(flux_[f]));
        }
    return all > 0 ? change / all : 0;
}

std::size_t ViewingTransport::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(moments_) + of(parts_) + of(parts_up_) + of(parts_down_) + scratch_.memory_bytes() + of(core_phi_) +
           of(core_x_) + of(core_right_) + of(in_) + of(out_) + of(core_in_) + of(core_out_) + of(light_) + of(flux_) +
           of(flux_change_) + of(exchange_) + of(core_loss_) + of(cell_ways_) + of(part_ways_) +
           diffusion_.memory_bytes();
}

}  // namespace voxtone::optics
