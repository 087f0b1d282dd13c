// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_transport.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/step_part.h"
#include "base/stopwatch.h"
#include "optics/grid/lattice.h"
#include "optics/transport/viewing_derivatives.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t blocks_per_task = 32;

/// body(cell) of all.
template <class Body>
void each_cell(std::size_t cells, Body&& body) {
    parallel_ranges(0, cells, 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) body(cell);
    });
}

}  // namespace

/// One channel's light on its way to being right: what a solve is given, and the steps that it is made of.
class ViewingTransport::Solve {
public:
    /// `ghost_phi`: empty where cuts are mirrors.
    Solve(ViewingTransport& of, const GridMedia& media, std::vector<float> incoming, std::span<const float> ghost_phi,
          TransportSummary& summary, const Progress* progress)
        : t_(of),
          grid_(of.grid_),
          parameters_(of.parameters_),
          channel_(of.channel_.emplace(of.parameters_, media)),
          ghost_phi_(ghost_phi),
          summary_(summary),
          progress_(progress),
          x_{of.scratch_.vector(0), of.core_x_},
          right_{of.scratch_.vector(1), of.core_right_},
          p_{of.scratch_.vector(2), of.core_p_},
          z_{of.scratch_.vector(3), of.core_z_} {
        VOXTONE_EXPECT(media.cells.size() == grid_.mixtures.size());
        of.parts_.clear();
        of.faces_.begin(std::move(incoming));
        check();
    }

    /// Light by diffusion alone, from a guess of phi: the steps that it took.
    int start(float guess, double tolerance, int most_steps);
    void reflect() { t_.faces_.reflect(channel_, {t_.moments_, t_.core_phi_}); }
    void equations(bool widened);
    void iterate(Sweeps sweeps);

private:
    void check() const {
        if (progress_) progress_->check_cancelled();
    }
    void hold_ghosts();
    int diffuse(double tolerance, int most_steps);
    void enter(bool start);
    void sweep(bool in_parts);
    void take_sweep(bool in_parts);
    void find_core_sources();
    void correct(bool in_parts);

    ViewingTransport& t_;
    const ViewingGrid& grid_;
    const TransportParameters& parameters_;
    const ChannelMedia& channel_;
    const std::span<const float> ghost_phi_;
    TransportSummary& summary_;
    const Progress* const progress_;
    const ViewingDiffusion::Vector x_, right_, p_, z_;  ///< of the diffusion solves, over the light that runs down
};

/// What is lost: absorbed, and out through the surface. Works in x_.
void ViewingTransport::Solve::equations(bool widened) {
    const std::vector<float>&D = widened ? channel_.widened : channel_.D,
          &core_D = widened ? channel_.core_widened : channel_.core_D;
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell) {
            const TransportMedium& m = channel_.media.cells[grid_.medium[cell]];
            x_.cells[cell] = parameters_.volume * (m.sigma_t - m.sigma_s);
        }
        const GridBlock& block = grid_.transport_block(t);
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
            if (grid_.faces[f].kind != FaceKind::core) x_.cells[grid_.faces[f].cell] += channel_.exchange[f].loss;
    });
    std::ranges::copy(channel_.core_loss, x_.core.begin());
    if (!ghost_phi_.empty()) {
        // A loss so large that nothing moves them; their equations have no right side.
        const float widest = *std::ranges::max_element(core_D);
        const auto contact = [&](std::size_t axis) { return t_.diffusion_.core_contact(axis, widest, widest); };
        const float held = 1e4f * (contact(0) + contact(1) + contact(2));
        for (const std::uint32_t ghost : grid_.ghosts) x_.core[ghost] = held;
    }
    check();
    t_.diffusion_.prepare(D, core_D, x_.cells, x_.core, t_.scratch_.equations(), progress_);
}

int ViewingTransport::Solve::diffuse(double tolerance, int most_steps) {
    const int steps = t_.diffusion_.solve(x_, right_, p_, z_, tolerance, most_steps, progress_);
    summary_.diffusion_steps += steps;
    return steps;
}

/// No residual where the light is given.
void ViewingTransport::Solve::hold_ghosts() {
    if (ghost_phi_.empty()) return;
    for (const std::uint32_t ghost : grid_.ghosts) right_.core[ghost] = 0;
}

int ViewingTransport::Solve::start(float guess, double tolerance, int most_steps) {
    std::ranges::fill(t_.moments_, Moments{});
    std::ranges::fill(t_.core_phi_, 0.0f);
    t_.faces_.clear();
    std::ranges::fill(x_.cells, guess);
    std::ranges::fill(x_.core, guess);
    for (std::size_t i = 0; i < ghost_phi_.size(); ++i) x_.core[grid_.ghosts[i]] = ghost_phi_[i];
    std::ranges::fill(right_.cells, 0.0f);
    std::ranges::fill(right_.core, 0.0f);
    for (const std::uint32_t f : grid_.open_faces)
        if (grid_.faces[f].kind == FaceKind::light)
            right_.cells[grid_.faces[f].cell] +=
                channel_.exchange[f].gain * parameters_.sums[grid_.law[f]].through * t_.faces_.incoming(f);
    check();
    if (guess != 0) {
        t_.diffusion_.apply(x_, z_);
        each_cell(grid_.cells(), [&](std::size_t cell) { right_.cells[cell] -= z_.cells[cell]; });
        for (std::size_t i = 0; i < x_.core.size(); ++i) right_.core[i] -= z_.core[i];
    }
    hold_ghosts();
    const int steps = diffuse(tolerance, most_steps);
    each_cell(grid_.cells(), [&](std::size_t cell) { x_.cells[cell] = grid_.medium[cell] == 0 ? 0 : x_.cells[cell]; });
    check();
    enter(true);
    check();
    reflect();
    return steps;
}

// J of a cell is half of what flows through the faces on either side, from x_ and, at the start, the light that comes
// in. Adds phi and J, spread linearly over the cell, to the moments of cells and to what leaves through faces.
void ViewingTransport::Solve::enter(bool start) {
    std::array<float, 3> area{};
    for (std::size_t a = 0; a < 3; ++a) area[a] = parameters_.volume / parameters_.edge[a];
    parallel_for(0, grid_.transport_blocks.size(), blocks_per_task, [&](std::size_t t) {
        const GridBlock& block = grid_.transport_block(t);
        t_.faces_.prefetch_laws(t + 1);
        ViewingDiffusion::Flows J = t_.diffusion_.flows(t, channel_.D, channel_.core_D, x_);
        const std::size_t first = 64 * t;
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid_.faces[f];
            if (face.kind == FaceKind::core) continue;
            const ChannelMedia::Exchange at = channel_.exchange[f];
            const float flow = at.loss * x_.cells[face.cell] -
                               (start && face.kind == FaceKind::light
                                    ? at.gain * parameters_.sums[grid_.law[f]].through * t_.faces_.incoming(f)
                                    : 0);
            J[parameters_.axis_of(f)][face.cell - first] += static_cast<int>(face.facing) % 2 ? flow : -flow;
        }
        for (std::size_t place = 0; place < 64; ++place) {
            const std::size_t cell = first + place;
            if (grid_.medium[cell] == 0) continue;
            for (std::size_t a = 0; a < 3; ++a) J[a][place] *= 0.5f / area[a];
            t_.moments_[cell] += {x_.cells[cell], J[0][place], J[1][place], J[2][place]};
        }
        if (t_.parts_.has(t)) t_.parts_.correct(t, channel_, x_.cells, J);
        t_.faces_.correct(t, channel_, x_.cells, J);
    });
    for (std::size_t i = 0; i < x_.core.size(); ++i) t_.core_phi_[i] += x_.core[i];
}

void ViewingTransport::Solve::sweep(bool in_parts) {
    parallel_for(0, 2, 1, [&](std::size_t half) {
        const bool down = half == 1;
        const SweepJob job{.grid = grid_,
                           .cells = {.media = channel_.cell_ways,
                                     .light = t_.moments_,
                                     .sum = down ? t_.scratch_.down() : t_.scratch_.up(),
                                     .theta = static_cast<float>(viewing_theta)},
                           .parts = in_parts ? t_.parts_.cells(channel_, down) : SweepCells{},
                           .in = t_.faces_.in(),
                           .out = t_.faces_.out(),
                           .core_in = t_.faces_.core_in(),
                           .core_out = t_.faces_.core_out(),
                           .rows = parameters_.rows[half],
                           .progress = progress_};
        sweep_half(job, down);
    });
}

/// What the sweep changed, as sources in right_; moments become the sweep's. `right_` lies over `down`
/// (sweep_scratch.h): sources stay in the phi of `up` until all of both has been read.
void ViewingTransport::Solve::take_sweep(bool in_parts) {
    const std::span<Moments> up = t_.scratch_.up(), down = t_.scratch_.down();
    const auto each_block_in_parts = [&](auto&& body) {
        parallel_for(0, grid_.fine.first.size(), blocks_per_task, [&](std::size_t t) {
            if (t_.parts_.has(t)) body(t);
        });
    };
    if (!in_parts) each_block_in_parts([&](std::size_t t) { t_.parts_.take_sweep_of_cells(t, up, down, t_.moments_); });
    each_cell(grid_.cells(), [&](std::size_t cell) {
        const Moments now = up[cell] + down[cell];
        const float sigma_s = channel_.media.cells[grid_.medium[cell]].sigma_s;
        up[cell].phi = parameters_.volume * sigma_s * (now.phi - t_.moments_[cell].phi);
        t_.moments_[cell] = now;
    });
    if (in_parts) each_block_in_parts([&](std::size_t t) { t_.parts_.take_sweep(t, channel_.media, t_.moments_, up); });
    each_cell(grid_.cells(), [&](std::size_t cell) { right_.cells[cell] = up[cell].phi; });
}

/// What the core got and gave, and what it absorbs.
void ViewingTransport::Solve::find_core_sources() {
    const std::vector<float>& phi = t_.core_phi_;
    for (std::size_t i = 0; i < right_.core.size(); ++i) right_.core[i] = -channel_.core_loss[i] * phi[i];
    std::array<float, 3> by_phi{}, by_J{};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t d = 0; d < 8; ++d) {
            by_phi[a] += 4 * parameters_.flux_weight[a].v[d];
            by_J[a] += 12 * parameters_.flux_weight[a].v[d] * grid_.directions.cosine[a].v[d];
        }
    const auto in = t_.faces_.core_in();
    const std::span<const float> leaves = t_.faces_.core_out();
    for (std::size_t c = 0; c < in.size(); ++c) {
        const OuterFace& face = grid_.faces[grid_.core_faces[c]];
        const std::size_t a = parameters_.axis_of(grid_.core_faces[c]);
        const float out = leaves[4 * c] + leaves[4 * c + 1] + leaves[4 * c + 2] + leaves[4 * c + 3];
        right_.core[face.beyond] += face.area_mm2 * (out - by_phi[a] * in[c][0] + by_J[a] * in[c][1]);
    }
    for (const ViewingDiffusion::CoreContact& c : t_.diffusion_.core_contacts()) {
        const auto D = [&](std::uint32_t core) { return channel_.core_D[grid_.core_medium[core]]; };
        const float flow = t_.diffusion_.core_contact(c.axis, D(c.a), D(c.b)) * (phi[c.a] - phi[c.b]);
        right_.core[c.a] -= flow;
        right_.core[c.b] += flow;
    }
}

/// The diffusion correction, into x_, from what the sweep changed; moments become the sweep's.
void ViewingTransport::Solve::correct(bool in_parts) {
    take_sweep(in_parts);
    check();
    t_.faces_.add_sources(channel_, right_.cells);
    find_core_sources();
    hold_ghosts();
    check();
    std::ranges::fill(x_.cells, 0.0f);
    std::ranges::fill(x_.core, 0.0f);
    // One step leaves a tenth to a third of the residual; the next sweep makes more of the time that another would
    // take.
    diffuse(0, 1);
}

void ViewingTransport::Solve::iterate(Sweeps sweeps) {
    Stopwatch watch;
    for (int k = 0; k < sweeps.most; ++k) {
        check();
        const bool in_parts = grid_.fine.any() && (k > 0 || sweeps.least == 1);
        sweep(in_parts);
        summary_.sweep_s += watch.lap();
        check();
        correct(in_parts);
        check();
        enter(false);
        check();
        const int made = k + 1;
        tell_part(progress_, double(1 + made) / (1 + sweeps.most));
        const bool more = made < sweeps.most && (made < sweeps.least || !(t_.relative_change() < sweeps.enough));
        if (more) reflect();
        summary_.diffusion_s += watch.lap();
        if (!more) break;
    }
}

ViewingTransport::ViewingTransport(const ViewingGrid& grid, double start_tolerance, Workspace room)
    : grid_(grid),
      parameters_(grid),
      start_tolerance_(start_tolerance),
      diffusion_(grid),
      faces_(parameters_, std::move(room.faces)),
      parts_(parameters_),
      moments_(std::move(room.moments)),
      scratch_(std::move(room.scratch)) {
    scratch_.resize(grid.cells());
    moments_.resize(grid.cells());
    for (auto* const values : {&core_phi_, &core_x_, &core_right_, &core_p_, &core_z_})
        values->resize(grid.core_block.size());
}

std::size_t ViewingTransport::Workspace::memory_bytes() const {
    return moments.capacity() * sizeof(Moments) + scratch.memory_bytes() + faces.memory_bytes();
}

ViewingTransport::Workspace ViewingTransport::take_workspace() {
    return {std::move(moments_), std::move(scratch_), faces_.take_workspace()};
}

std::size_t ViewingTransport::bytes_for(const ViewingGrid& grid, std::size_t channels) {
    return grid.cells() * (4 * sizeof(Moments) + 8) + grid.cells() / 64 * channels * sizeof(ViewingField::BlockCode) +
           grid.open_faces.size() * (8 * sizeof(Octet) + sizeof(ViewingField::FaceCode) * channels + 8) +
           grid.core_faces.size() * 32 + grid.cells() / 64 * 440 + grid.core_block.size() * 200;
}

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

void ViewingTransport::load(const ViewingField& field, std::span<const float> ghost_phi) {
    parallel_ranges(0, field.blocks.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = 64 * begin; i < 64 * end; ++i) moments_[i] = field.blocks[i / 64].moments(i % 64);
    });
    std::ranges::copy(field.core, core_phi_.begin());
    for (std::size_t i = 0; i < ghost_phi.size(); ++i) core_phi_[grid_.ghosts[i]] = ghost_phi[i];
    faces_.load(field.out);
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
    faces_.store(field.out);
    summary.kept_values += kept;
    summary.clipped_values += clipped;
}

void ViewingTransport::solve(const GridMedia& media, ViewingField& field, Sweeps sweeps, TransportSummary& summary,
                             const Progress* progress, std::span<const float> ghost_phi) {
    VOXTONE_EXPECT(field.blocks.empty() ||
                   (!grid_.fine.any() && field.blocks.size() == grid_.transport_blocks.size() &&
                    field.core.size() == grid_.core_block.size() && field.out.size() == grid_.open_faces.size()));
    VOXTONE_EXPECT(ghost_phi.empty() || ghost_phi.size() == grid_.ghosts.size());
    Stopwatch watch;
    Solve light(*this, media, faces_.light_from_everywhere(), ghost_phi, summary, progress);
    if (field.blocks.empty()) {
        constexpr int most_steps = 60;
        light.equations(false);
        // 1 is exact where nothing is absorbed.
        summary.open_solves += light.start(1, start_tolerance_, most_steps) == most_steps;
    } else {
        load(field, ghost_phi);
        light.reflect();
    }
    if (sweeps.most > 0) light.equations(true);
    summary.diffusion_s += watch.lap();
    tell_part(progress, 1.0 / (1 + sweeps.most));
    light.iterate(sweeps);
    TransportSummary first_guess;  // diffusion alone: what is clipped of it does not matter to the sweeps to come
    store(field, sweeps.most > 0 ? summary : first_guess);
}

void ViewingTransport::solve_adjoint(const GridMedia& media, std::span<const float> light, int sweeps,
                                     TransportSummary& summary, const Progress* progress) {
    VOXTONE_EXPECT(light.size() == grid_.faces.size() && !grid_.fine.any());
    Stopwatch watch;
    std::vector<float> incoming;
    for (const std::uint32_t f : grid_.open_faces)
        incoming.push_back(grid_.faces[f].kind == FaceKind::light ? light[f] : 0);
    Solve adjoint(*this, media, std::move(incoming), {}, summary, progress);
    // One step leaves less than a sweep mends.
    adjoint.equations(true);
    adjoint.start(0, 0, 1);
    summary.diffusion_s += watch.lap();
    adjoint.iterate({sweeps, sweeps, 0});
}

void ViewingTransport::derivatives(const ViewingField& forward, std::span<float> by_sigma_t,
                                   std::span<float> by_sigma_s, const Progress* progress) {
    VOXTONE_EXPECT(channel_ && forward.blocks.size() == grid_.transport_blocks.size());
    const DerivativeScene scene{grid_, channel_->media.cells, parameters_.volume};
    const auto check_cancelled = [progress] {
        if (progress) progress->check_cancelled();
    };
    const auto reflect = [&] { faces_.reflect(*channel_, {moments_, core_phi_}); };
    const auto copy = [](std::span<const Octet> light) { return std::vector<Octet>(light.begin(), light.end()); };
    derivatives_by_moments(scene, forward.blocks, moments_, by_sigma_t, by_sigma_s);
    check_cancelled();
    reflect();
    const std::vector<Octet> in = copy(faces_.in()), out = copy(faces_.out());
    faces_.begin(faces_.light_from_everywhere());
    check_cancelled();
    load(forward, {});
    reflect();
    check_cancelled();
    add_derivatives_at_faces(scene, {faces_.out(), faces_.in()}, {out, in}, by_sigma_t);
}

std::size_t ViewingTransport::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    const std::size_t of_channel =
        channel_ ? of(channel_->exchange) + of(channel_->core_loss) + of(channel_->cell_ways) + of(channel_->part_ways)
                 : 0;
    return of(moments_) + parts_.memory_bytes() + scratch_.memory_bytes() + of(core_phi_) + of(core_x_) +
           of(core_right_) + faces_.memory_bytes() + of_channel + diffusion_.memory_bytes();
}

}  // namespace voxtone::optics
