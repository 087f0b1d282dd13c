// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light in a viewing grid, channel after channel: the iteration of transport.h where cells and nodes of diffusion are
// one.
//
// Keeps nothing of a channel but what the caller holds for it, a field: phi and J of each cell, phi of the core nodes
// and what leaves through each face (viewing_field.h). A field of other resins is as good a start as the resins
// are alike.
//
// Memory besides the grid and the fields: 64 bytes a cell (moments before and after a sweep, of light that runs up and
// down; the equations of the corrections), 256 a face to the light, and that of ViewingDiffusion.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/transport/sweep_scratch.h"
#include "optics/transport/transport_medium.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_diffusion.h"
#include "optics/transport/viewing_field.h"
#include "optics/transport/viewing_grid.h"

namespace voxtone::optics {

/// Weight of the differences (transport_sweep.h): on cells as thick as these an edge would show ripples with 1; of 1,
/// 0.85 and 0.7 this one is nearest to Monte Carlo on kodim23 (`predictor_accuracy --fine 0 compare`).
inline constexpr double viewing_theta = 0.85;

/// And on parts of them, thin enough to follow an edge.
inline constexpr double fine_theta = 1;

class ViewingTransport {
public:
    /// The memory that a tile after another works in, so that it need not be asked for and cleared again each time:
    /// what it holds does not matter.
    struct Room {
        std::vector<Moments> moments;
        SweepScratch scratch;
        std::vector<Octet> in, out;
        std::vector<float> flux, flux_change;
        [[nodiscard]] std::size_t memory_bytes() const;
    };
    ViewingTransport(const ViewingGrid& grid, const TransportOptions& options, Room room = {});
    /// For the next one; this one is of no use then.
    [[nodiscard]] Room take_room();
    /// A fine cell: its light three times, what it holds twice while blocks are filled.
    static constexpr std::size_t bytes_of_part = 3 * sizeof(Moments) + 10;
    /// What it will take about, with fields of so many channels, besides fine cells.
    [[nodiscard]] static std::size_t bytes_for(const ViewingGrid& grid, std::size_t channels);

    /// Of the grid's mixtures and of core blocks, by material; index 0 is air.
    struct Media {
        std::vector<TransportMedium> cells, core;
        std::vector<TransportMedium> parts;  ///< of the fine cells, as ViewingGrid::Fine numbers them
        /// Share of the light that leaves towards a sheet which comes in again: per open face, and per core node.
        /// Empty: all of it from white sheets.
        std::vector<float> sheet, core_sheet;
    };
    struct Sweeps {
        int least = 0, most = 0;
        double enough = 0;  ///< no more after one that changed less of what leaves, once `least` are made
    };
    /// Light 1 comes in through each outer face to the light. Starts from `field`, or with a diffusion solve where it
    /// is empty; leaves the new field there. `ghost_phi`: phi of the grid's ghosts; nothing given: they take that of
    /// their neighbours, as if the cut were a mirror. Unless `least` is 1 the first sweep crosses whole cells, of which
    /// there are fewer than parts (docs/decisions/022). Throws Cancelled: `progress` is asked many times a second.
    void solve(const Media& media, ViewingField& field, Sweeps sweeps, TransportSummary& summary,
               const Progress* progress, std::span<const float> ghost_phi = {});
    /// `light`: radiance that comes in through each outer face to the light, of any sign: a function's d F / d flux.
    /// Starts with a step of a diffusion solve; a cut is a mirror. Contract: whole cells.
    void solve_adjoint(const Media& media, std::span<const float> light, int sweeps, TransportSummary& summary,
                       const Progress* progress);
    /// After `solve_adjoint`: d F / d sigma_t and d F / d sigma_s of each cell's TransportMedium, from `forward`, the
    /// field of light 1 in the same media (viewing_gradient.h). Holds that light afterwards.
    void derivatives(const ViewingField& forward, std::span<float> by_sigma_t, std::span<float> by_sigma_s,
                     const Progress* progress = nullptr);
    /// What leaves through each outer face, in units in which a furnace gives `furnace_flux`.
    [[nodiscard]] std::span<const float> flux() const { return flux_; }
    [[nodiscard]] float furnace_flux(std::size_t face) const;
    /// phi of a cell, after `solve`.
    [[nodiscard]] float phi(std::size_t cell) const;
    /// Mean phi of a block's solid cells, or of its node, after `solve`.
    [[nodiscard]] float mean_phi(const GridBlock& block) const;
    /// Largest change of a face's appearance by the last correction.
    [[nodiscard]] double last_change() const { return last_change_; }
    /// Sum of what the last sweep and correction changed in the flux through each face to the light / of the fluxes.
    [[nodiscard]] double relative_change() const;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct FaceSums {
        float weight = 0, through = 0;  ///< sum w |Omega . e| (t): of the four octants
    };
    /// What a cell loses through an outer face per phi, and gets per unit of current that comes in.
    struct Exchange {
        float loss = 0, gain = 0;
    };
    [[nodiscard]] Exchange exchange_at(std::size_t face) const;
    /// Radiance that comes in from outside.
    [[nodiscard]] float light(std::size_t face) const {
        if (!light_.empty()) return light_[grid_.place_of_face[face]];
        return grid_.faces[face].kind == FaceKind::light ? 1.0f : 0.0f;
    }
    /// What a sheet that is not black sends back.
    [[nodiscard]] float sent_back(std::size_t face) const {
        return media_->sheet.empty() ? 1.0f : media_->sheet[grid_.place_of_face[face]];
    }
    [[nodiscard]] float loss_of_core(std::size_t core) const;
    /// The steps it took.
    int solve_diffusion(double tolerance, int most_steps);
    void check() const {
        if (progress_) progress_->check_cancelled();
    }
    void make_equations(const std::vector<float>& D, const std::vector<float>& core_D);
    void prepare();
    void fit_core(float widest);
    void begin(const Media& media, const Progress* progress);
    void hold_ghosts();
    int start(float guess, double tolerance, int most_steps);
    void iterate(Sweeps sweeps, TransportSummary& summary);
    void end(TransportSummary& summary);
    void load(const ViewingField& field);
    void store(ViewingField& field, TransportSummary& summary) const;
    void enter(bool start);
    void enter_faces(std::size_t t, const ViewingDiffusion::Flows& J);
    void enter_parts(std::size_t t, const ViewingDiffusion::Flows& J);
    void gather_parts(std::size_t t);
    void take_into_parts(std::size_t t);
    void reflect();
    void sweep(bool in_parts);
    void take_sweep(bool in_parts);
    void add_sources_at_faces();
    void find_core_sources();
    void correct(bool in_parts);
    /// Light that passes the corners of a block's staircase (corner leakage), given back region by region:
    /// [region][octant][direction].
    using Pool = std::array<float, 512>;
    void pool(const GridBlock& block, Pool& pool) const;
    void prefetch_laws(std::size_t t) const;
    [[nodiscard]] std::array<float, 2> from_core(std::size_t face) const;
    [[nodiscard]] Octet returned(const Pool& pool, std::size_t face, std::size_t slot) const;

    const ViewingGrid& grid_;
    TransportOptions options_;
    ViewingDiffusion diffusion_;
    const Media* media_ = nullptr;
    const Progress* progress_ = nullptr;  ///< of the solve that runs

    std::array<float, 3> edge_{};
    float volume_ = 0;
    std::array<Octet, 3> flux_weight_{};                                     ///< w |Omega_a|
    std::vector<FaceSums> sums_;                                             ///< per law
    std::vector<Exchange> exchange_;                                         ///< per face that is not the core's
    std::vector<float> D_, core_D_, core_sigma_a_, widened_, core_widened_;  ///< per medium
    float sheet_way_ = 0, sheet_T_inverse_ = 0;                              ///< phi / J into a black sheet; 1 / T
    std::vector<float> core_loss_;                                           ///< per core node
    std::array<SweepRows, 2> rows_;                                          ///< of light that runs up, and down
    std::vector<SweepMedium> cell_ways_, part_ways_;                         ///< per medium, of the solve that runs
    std::vector<Moments> moments_;                        ///< per cell: phi and J; the mean of its parts
    std::vector<Moments> parts_, parts_up_, parts_down_;  ///< per fine cell
    SweepScratch scratch_;
    std::span<float> x_, right_, p_, z_;  ///< per cell, of the diffusion solve: in scratch_
    std::vector<float> core_phi_, core_x_, core_right_, core_p_, core_z_;
    int steps_ = 0;                              ///< of the diffusion solves
    std::vector<Octet> in_, out_;                ///< [open face * 4 + tangential signs]
    std::vector<std::array<float, 2>> core_in_;  ///< per core face (transport_sweep.h)
    std::vector<float> core_out_;
    std::vector<float> flux_, flux_change_;  ///< per face
    std::vector<float> light_;               ///< per open face; empty: 1
    std::vector<float> ghost_phi_;           ///< empty: not known
    double last_change_ = 0;
};

}  // namespace voxtone::optics
