// SPDX-License-Identifier: GPL-3.0-or-later
//
// One channel's light in an optical grid: the iteration of transport.h.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/transport/diffusion.h"
#include "voxtone/optics/transport/optical_grid.h"
#include "voxtone/optics/transport/transport_medium.h"
#include "voxtone/optics/transport/transport_options.h"
#include "voxtone/optics/transport/transport_sweep.h"

namespace voxtone::optics {

class TransportChannel {
public:
    /// Per kind of block, per palette entry: of cells for skin and margin, of core blocks for the core.
    using MediaByKind = std::array<std::vector<TransportMedium>, 3>;
    /// `progress` is asked for cancellation by all that follows, many times a second.
    TransportChannel(const OpticalGrid& grid, const DiffusionPlan& plan, MediaByKind media,
                     const TransportOptions& options, const Progress* progress = nullptr);

    /// Light of this radiance enters through each face to the light (nothing given: 1 everywhere). Fills `flux`: what
    /// leaves through each outer face, in units in which a furnace of radiance 1 gives `furnace_flux(face)`.
    void solve(std::span<const float> light, TransportSummary& summary);
    [[nodiscard]] std::span<const float> flux() const { return flux_; }

    /// The light of a solution, enough to sweep once more.
    struct Field {
        std::vector<Moments> moments;
        std::vector<Octet> in;
    };
    /// After `solve`: takes its field.
    [[nodiscard]] Field take_field();
    /// Derivative of a linear function of the fluxes: per cell by sigma_t and by sigma_s of its medium
    /// (TransportMedium), mm. `forward`: the field of light 1; `adjoint`: that lit through each face by d(function) /
    /// d(flux).
    void derivatives(const Field& forward, const Field& adjoint, std::vector<float>& by_sigma_t,
                     std::vector<float>& by_sigma_s) const;
    [[nodiscard]] double furnace_flux(std::size_t face) const;
    [[nodiscard]] double last_change() const { return last_change_; }
    /// Sum of the changes of the fluxes to the light by the last correction / of these fluxes.
    [[nodiscard]] double relative_change() const;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct FaceSums {
        double weight = 0, through = 0;  ///< sum w |Omega . e| (t): of the four octants
    };
    struct CellGeometry;
    [[nodiscard]] CellGeometry geometry(BlockKind kind) const;
    [[nodiscard]] FaceSums face_sums(std::size_t face) const;
    [[nodiscard]] std::array<double, 3> view_mm() const;  ///< edges of a viewing cell
    void check() const {
        if (progress_) progress_->check_cancelled();
    }
    void make_diffusion();
    void find_node_media();
    void find_face_exchange();
    void find_conductances();
    /// One solve of the diffusion equations; counts its steps, and it where it ends without its tolerance.
    void solve_diffusion(std::span<const float> right, std::span<float> x, double tolerance, int most_steps);
    void start();
    void enter();
    void sweep();
    void correct();
    void currents(std::span<const float> phi, std::span<const float> incoming, std::vector<Moments>& out) const;
    void pool(const GridBlock& block);
    [[nodiscard]] Octet returned(const GridBlock& block, std::size_t face, std::size_t slot) const;
    template <class Body>
    void for_each_cell(Body&& body) const;

    const OpticalGrid& grid_;
    const DiffusionPlan& plan_;
    MediaByKind media_;
    TransportOptions options_;
    const Progress* progress_;

    std::array<Octet, 3> flux_weight_;  ///< w |Omega_a|
    std::vector<float> sigma_a_, D_;    ///< per node
    std::vector<float> conductance_;    ///< per contact
    /// Per face: into the node's loss; right side per unit of incoming current.
    std::vector<float> face_loss_, face_gain_;
    std::vector<float> eased_, loss_;        ///< conductances of the corrections, losses of the nodes
    std::unique_ptr<Diffusion> diffusion_;   ///< of the start, then of the corrections
    std::vector<float> light_;               ///< per face: radiance that comes from outside
    std::vector<float> phi_;                 ///< per node; kept up to date in the core
    std::vector<Moments> delta_moments_;     ///< per node: phi and J of the last correction
    std::vector<Moments> moments_;           ///< per cell: phi and J
    std::vector<Moments> sum_, other_sum_;   ///< per cell: phi and J of light that runs up, and down
    std::vector<Octet> in_, out_;            ///< [face * 4 + tangential signs]
    std::vector<float> pooled_;              ///< [region * 64 + octant * 8 + direction]: radiance that passes corners
    std::vector<float> flux_, flux_change_;  ///< per face; change: by the last correction
    bool lit_evenly_ = true;
    double last_change_ = 0;
    int steps_ = 0, open_solves_ = 0;
};

}  // namespace voxtone::optics
