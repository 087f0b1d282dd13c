// SPDX-License-Identifier: GPL-3.0-or-later
//
// Predictions on cells of the eye, one after the other: shape, laws and the light of the last one are kept.
//
// The first prediction is a diffusion solve and `sweeps` rounds of sweep and correction (transport.h); each later one
// starts from the light of the one before and takes one, or up to `next_sweeps` where that changed much
// (`next_change`). What changes in between enters with the first sweep, through sources and extinctions. A block that
// gets colour deeper than `colour_mm` makes a new grid; the light is carried over. So does, once, a print that leaves
// many of those blocks without colour again. Where deep colour is in nodes (TransportOptions) grids stay as they are.
//
// A twin comes before the first prediction: it leaves grids and what shines across cuts to begin with, and is swept
// until that changes little (`first_change`). The print's light begins with a diffusion solve of its own, not with the
// twin's: three sweeps from a white body's light left the open loop of `spot` at 30 mm with a mean error as seen
// of 4.57, three from such a solve with 4.94, and eight from the former with 4.85.
//
// Large bodies are predicted tile by tile (viewing_tiles.h), in a fixed order: equations are made for one tile at a
// time, its light is kept in 16-bit steps; its grid too where memory allows, which saves time and changes no bit. What
// shines across a cut is the light that the neighbour had when it was last looked at, so that light travels from tile
// to tile as the predictions go on (Schwarz's alternating method). The first prediction goes over the tiles
// `first_rounds` times with diffusion alone before it sweeps; a twin once, and a print after it once, for a print of
// dark resins is not lit by its white twin.
//
// Media are those of the halftone (effective_medium.h) of each cell's voxels, seen from above where the surface looks
// up and from all sides else; where in a cell a resin lies is seen too (seen_medium.h).
//
// Memory: grid and equations of one tile, 24 bytes a viewing cell for its light, as much again for the adjoint; about
// 30 bytes a cell for the grids that are kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "optics/media/effective_medium.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/viewing_faces.h"
#include "optics/transport/viewing_tiles.h"
#include "optics/transport/viewing_transport.h"

namespace voxtone::optics {

class ViewingSequence final : public AppearanceSequence {
public:
    /// Throws ResourceError where it would need more memory than `options` allow. As all that follows it throws
    /// Cancelled too, and is of no use then but to be thrown away.
    ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options,
                    const Progress* progress = nullptr);
    /// With tiles as large as `options` have them, or so much smaller that all of it fits into the memory they allow;
    /// none where it would not with small ones either. Smaller tiles take longer and, as long as light has not come
    /// around, say a little else.
    [[nodiscard]] static std::unique_ptr<ViewingSequence> within_memory(const Scene& scene, const Surface& surface,
                                                                        const TransportOptions& options,
                                                                        const Progress* progress = nullptr);
    [[nodiscard]] Appearance next(const ResinVolume& volume, const Progress* progress = nullptr) override;
    [[nodiscard]] Appearance twin(const ResinVolume& volume, const Progress* progress = nullptr) override;
    /// The first prediction and no other: the light of a tile is dropped when the next one's turn comes.
    [[nodiscard]] Appearance only(const ResinVolume& volume, const Progress* progress = nullptr);
    /// Of viewing_gradient.h, box by box of the tiles. The adjoint light of each channel is kept for the next one:
    /// `sweeps` the first time, then `next_sweeps`. Contract: there was a prediction.
    [[nodiscard]] bool gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                                const Progress* progress = nullptr) override;
    /// The light of all tiles and what is between them, how they were cut, and where their grids have become deeper:
    /// some 50 bytes a viewing cell.
    void write_state(const StateSink& sink) const override;
    /// Takes over the cut of the tiles too.
    [[nodiscard]] bool read_state(std::span<const std::byte> state) override;
    /// Of the predictions so far; times of all, cells of the grids now.
    [[nodiscard]] const TransportSummary& summary() const { return summary_; }

private:
    /// Most sweeps, the change that is small enough to stop, and how often diffusion goes over the tiles before the
    /// first one.
    struct Effort {
        int sweeps = 0;
        double enough = 0;
        int rounds = 0;
    };
    /// Light of all channels, or of all adjoints.
    using Fields = std::vector<ViewingField>;
    /// What does not change with the resins but for `fill`.
    struct Shape {
        const ResinVolume* filled = nullptr;  ///< whose resins the grid has
        std::unique_ptr<ViewingGrid> grid;
        ViewingFaces seen;
        std::vector<std::uint32_t> hears;                            ///< places of the grid's ghosts among all
        std::vector<std::pair<std::uint32_t, std::uint32_t>> tells;  ///< own blocks that are others' ghosts, and these
        [[nodiscard]] std::size_t memory_bytes() const;
    };
    struct Tile : ViewingTile {
        std::vector<std::uint8_t> also;          ///< blocks of the window that have had colour deep down
        bool trimmed = false;                    ///< of those where it came no more, once
        std::vector<std::uint32_t> fine_blocks;  ///< those of ViewingGrid::Fine that its light is of
        Fields light, adjoint;
        std::size_t bytes = 0, cells_of_grid = 0, fine_cells = 0, core_nodes = 0,
                    open_faces = 0;    ///< of its grid and equations
        std::unique_ptr<Shape> shape;  ///< none where it has to be made anew
    };
    /// phi at the ghosts of all tiles, [channel][ghost]; empty before the first prediction or gradient.
    using GhostLight = std::vector<std::vector<float>>;
    [[nodiscard]] std::size_t channels() const { return scene_.resins->channels.size(); }
    /// Every part of what is kept between predictions, in one order for reading and writing.
    template <class Stream, class Sequence>
    static void state_in(Stream& stream, Sequence& sequence);
    [[nodiscard]] bool fits(const Tile& tile) const;
    [[nodiscard]] bool fits(const GhostLight& ghosts) const;
    /// Into tiles, of no light.
    void cut();
    void list_ghosts();
    /// Bytes of the light of all tiles, as the first one's grid has it.
    [[nodiscard]] double expected_light() const;
    /// Makes it live, with the resins of the last volume.
    void look_at(std::size_t tile, const Progress* progress);
    void make_live(std::size_t tile, const Progress* progress);
    /// The live tile has other blocks with cells now: its grid is made anew, with the resins of the last volume.
    void make_anew(std::size_t tile, const Progress* progress);
    void refine_tile(Tile& tile, const Progress* progress);
    /// Blocks of `also` that have colour in the last volume; empty where most of them have.
    [[nodiscard]] std::vector<std::uint8_t> still_coloured(const Tile& tile) const;
    [[nodiscard]] std::unique_ptr<Shape> shape_of(const Tile& tile, const Progress* progress) const;
    void measure(Tile& tile);
    void make_shapes(const Progress* progress);
    [[nodiscard]] const Shape& live() const { return *tiles_[live_].shape; }
    [[nodiscard]] const ViewingGrid& live_grid() const { return *live().grid; }
    [[nodiscard]] std::size_t shape_bytes() const;
    /// Drops shapes of other tiles, the last ones first, until so many bytes more are allowed.
    void make_room(std::size_t bytes);
    void carry_over(const ViewingGrid& was, Fields& fields) const;
    [[nodiscard]] ViewingTransport::Media media(std::size_t channel) const;
    [[nodiscard]] std::vector<TransportMedium> core_media(std::size_t channel) const;
    [[nodiscard]] Appearance predict(const ResinVolume& volume, Effort effort, const Progress* progress);
    /// Solves all channels of the live tile, with the light of its neighbours where it is to `hear` it, and tells them
    /// its own; `done` is called after each channel.
    template <class Done>
    void solve(Fields Tile::*fields, GhostLight& ghosts, bool hear, Effort effort, std::span<const float> adjoint_seed,
               const Progress* progress, Done&& done);
    /// For the first time: diffusion alone, until light has come around.
    void begin(Fields Tile::*fields, GhostLight& ghosts, std::span<const float> adjoint_seed, int rounds,
               const Progress* progress);
    /// Light that stands for d F / d value.
    [[nodiscard]] std::vector<float> light_of(std::span<const float> adjoint_seed, std::size_t channel) const;
    void read_appearance(std::size_t channel, Appearance& to) const;
    [[nodiscard]] std::size_t field_bytes() const;
    void count_memory(std::size_t besides);

    Scene scene_;
    const Surface& surface_;
    TransportOptions options_;
    std::size_t tile_cells_;  ///< of the cut
    std::array<int, 3> view_voxels_;
    std::array<int, 3> split_;  ///< of cells that are cut finer
    bool keeps_light_ = true;
    BlockLattice lattice_;
    EffectiveMedium halftone_;
    std::vector<Tile> tiles_;
    std::vector<std::uint64_t> ghost_places_;  ///< in the lattice of the body, ascending
    GhostLight ghost_light_, ghost_adjoint_;
    std::size_t live_ = 0;                         ///< the tile that is being looked at
    std::unique_ptr<ViewingTransport> transport_;  ///< of it
    const ResinVolume* volume_ = nullptr;          ///< of the last prediction
    TransportSummary summary_;
};

}  // namespace voxtone::optics
