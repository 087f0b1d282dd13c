// SPDX-License-Identifier: GPL-3.0-or-later
//
// Predictions on cells of the eye, one after the other: shape, laws and the light of the last one are kept.
//
// The first prediction is a diffusion solve and `sweeps` rounds of sweep and correction (transport.h); each later one
// starts from the light of the one before and takes one, or up to `next_sweeps` where that changed much
// (`next_change`). What changes in between enters with the first sweep, through sources and extinctions. Where its last
// sweep still changes a tenth of what is seen it begins anew.
//
// A twin comes before the first prediction: it leaves grids and what shines across cuts to begin with, and is swept
// until that changes little (`first_change`). The print's light begins with a diffusion solve of its own: on `spot`
// at 30 mm three sweeps from there are nearer to eight than three from a white body's light (docs/decisions/007).
//
// Large bodies are predicted tile by tile (tile_grids.h), in a fixed order: equations are made for one tile at a time,
// its light is kept in small steps (viewing_field.h). What shines across a cut is the light that the neighbour had
// when it was last solved, so that light travels from tile to tile as the predictions go on (Schwarz's alternating
// method). The first prediction goes over the tiles `first_rounds` times with diffusion alone before it sweeps; a twin
// once, and a print after it once, for a print of dark resins is not lit by its white twin.
//
// Cells that are cut finer (refinement.h) are for predictions that stand alone: a sequence keeps the light of whole
// cells. Iteration error: the mean CIEDE2000 of one open loop is 4.57 to 4.94 by where three sweeps start, 4.85 after
// eight (docs/decisions/007): of a difference of a few tenths between two prints it says nothing.
//
// Memory: grid and equations of one tile, for the light of a channel 5 bytes a viewing cell and 36 an open
// face, and the grids that are kept (tile_grids.h); where that is not allowed tiles wait elsewhere
// (TileGrids::open_store). An adjoint is of one print alone and kept by nobody: the one before is as far from the next
// as no light.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/step_part.h"
#include "optics/media/effective_medium.h"
#include "optics/transport/sequence_state.h"
#include "optics/transport/tile_grids.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/viewing_transport.h"

namespace voxtone::optics {

class ViewingSequence final : public AppearanceSequence {
public:
    /// Throws ResourceError where it would need more memory than `options` allow. As all that follows it throws
    /// Cancelled too, and is of no use then but to be thrown away.
    ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options,
                    const Progress* progress = nullptr);
    ViewingSequence(const ViewingSequence&) = delete;
    ViewingSequence& operator=(const ViewingSequence&) = delete;
    /// The same, and throws where light and the equations of a tile would not fit before the first prediction is made.
    /// Tiles are as `options` have them, whatever memory there is: smaller ones say a little else as long as light has
    /// not come around, and a print must not depend on the machine.
    [[nodiscard]] static std::unique_ptr<ViewingSequence> within_memory(const Scene& scene, const Surface& surface,
                                                                        const TransportOptions& options,
                                                                        const Progress* progress = nullptr);
    [[nodiscard]] Appearance next(const ResinVolume& volume, const Progress* progress = nullptr) override;
    [[nodiscard]] Appearance twin(const ResinVolume& volume, const Progress* progress = nullptr) override;
    /// With droplets that run as in `only`, from the light of the print before: two sweeps at the least.
    [[nodiscard]] Appearance last(const ResinVolume& volume, const Progress* progress = nullptr) override;
    /// A prediction that stands alone, on cells that are cut where `options` say so: the light of a tile is dropped
    /// when the next one's turn comes. Another may follow on the same grids; no other kind may.
    [[nodiscard]] Appearance only(const ResinVolume& volume, const Progress* progress = nullptr);
    /// Of viewing_gradient.h, box by box of the tiles, each as if its cuts were mirrors: in tiles of 2 mm, a twentieth
    /// of those of large bodies, it has a cosine of 0.996 with that of the whole body and 1.04 times its scale.
    /// Contract: there was a prediction.
    [[nodiscard]] bool gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                                const Progress* progress = nullptr) override;
    void write_state(const StateSink& sink) const override;
    /// Takes over the cut of the tiles too.
    [[nodiscard]] bool read_state(std::span<const std::byte> state) override;
    /// Of the predictions so far; times of all, cells of the grids now.
    [[nodiscard]] const TransportSummary& summary() const { return summary_; }

private:
    struct Effort {
        ViewingTransport::Sweeps sweeps{};
        int rounds = 0;  ///< how often diffusion goes over the tiles before the first one
    };
    [[nodiscard]] std::size_t channels() const { return scene_.resins->channels.size(); }
    [[nodiscard]] Tile& live() { return grids_.tiles()[live_]; }
    [[nodiscard]] const Tile& live() const { return grids_.tiles()[live_]; }
    [[nodiscard]] const ViewingGrid& live_grid() const { return live().shape->grid; }
    /// Makes a tile live: the one that there are equations for.
    void make_live(std::size_t tile, const Progress* progress);
    /// Makes it live, with the resins of the last volume.
    void prepare(std::size_t tile, const Progress* progress);
    /// The live tile has other blocks with cells now: its grid is made anew, and the light goes over.
    void remake_live(const Progress* progress);
    void refine_live(const Progress* progress);
    [[nodiscard]] Appearance predict(const ResinVolume& volume, Effort effort, const Progress* progress);
    [[nodiscard]] GridMedia media_of_live(std::size_t channel) const;
    /// Solves all channels of the live tile, given the light at its ghosts where it `receives` that, and sends its own;
    /// `done` is called after each channel.
    template <class Done>
    void solve(bool receives, Effort effort, const Progress* progress, Done&& done);
    /// For the first time: diffusion alone, until light has come around.
    void begin(int rounds, const Progress* progress);
    [[nodiscard]] PartRange next_solve(const Progress* progress);
    /// Light that stands for d F / d value.
    [[nodiscard]] std::vector<float> light_of(std::span<const float> adjoint_seed, std::size_t channel) const;
    void read_appearance(std::size_t channel, Appearance& to) const;
    /// Bytes of the gradient's solve, with the light of all tiles.
    [[nodiscard]] std::size_t gradient_bytes() const;
    void count_memory(std::size_t besides);

    Scene scene_;
    const Surface& surface_;
    const TransportOptions options_;
    const EffectiveMedium halftone_;
    TileGrids grids_;
    GhostLight ghosts_;  ///< between tiles
    bool keeps_light_ = true;
    std::size_t live_ = 0;
    std::unique_ptr<ViewingTransport> transport_;  ///< of the live tile
    const ResinVolume* volume_ = nullptr;          ///< of the last prediction
    std::size_t solves_ = 0, solved_ = 0;          ///< of the prediction or gradient that runs
    double solves_from_ = 0;                       ///< the share of it that is over before them
    TransportSummary summary_;
};

}  // namespace voxtone::optics
