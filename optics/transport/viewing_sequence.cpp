// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "optics/transport/refinement.h"
#include "optics/transport/seen_medium.h"
#include "optics/transport/viewing_gradient.h"
#include "optics/transport/viewing_grid_builder.h"
#include "optics/transport/viewing_palette.h"

namespace voxtone::optics {
namespace {

/// Of diffusion alone, before light is swept; of a twin, all of white, for which a cut that is a mirror is a good
/// guess.
constexpr int first_rounds = 2, twin_rounds = 1;
constexpr std::uint32_t nowhere = 0xffffffffu;

/// Plain values and lists of them as bytes.
struct StateWriter {
    const AppearanceSequence::StateSink& sink;
    template <class Value>
    void value(const Value& of) const {
        sink(std::as_bytes(std::span(&of, 1)));
    }
    template <class Value>
    void list(const std::vector<Value>& values) const {
        value(std::uint64_t{values.size()});
        sink(std::as_bytes(std::span(values)));
    }
};

/// And back; `good` while the bytes suffice.
struct StateReader {
    std::span<const std::byte> bytes;
    bool good = true;
    void raw(void* to, std::size_t size) {
        good = good && size <= bytes.size();
        if (!good) return;
        if (size > 0) std::memcpy(to, bytes.data(), size);
        bytes = bytes.subspan(size);
    }
    template <class Value>
    void value(Value& of) {
        static_assert(std::is_trivially_copyable_v<Value>);
        raw(&of, sizeof of);
    }
    template <class Value>
    void list(std::vector<Value>& values) {
        std::uint64_t count = 0;
        value(count);
        good = good && count <= bytes.size() / sizeof(Value);
        if (!good) return;
        values.resize(count);
        raw(values.data(), count * sizeof(Value));
    }
};

}  // namespace

ViewingSequence::ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options,
                                 const Progress* progress)
    : scene_(scene),
      surface_(surface),
      options_(options),
      tile_cells_(options.tile_cells),
      view_voxels_(cell_voxels(scene.volume->pitch_mm(), options.cell_mm)),
      split_(parts_of_cell(view_voxels_, scene.volume->pitch_mm(), options.finest_mm)),
      lattice_(scene.volume->size(), view_voxels_),
      halftone_(*scene.resins, scene.volume->pitch_mm(), seen_from(surface)) {
    cut();
    make_live(0, progress);
}

std::unique_ptr<ViewingSequence> ViewingSequence::within_memory(const Scene& scene, const Surface& surface,
                                                                const TransportOptions& options,
                                                                const Progress* progress) {
    constexpr std::size_t least_cells = 4000;  // smaller ones are all halo
    constexpr double slack = 1.3;              // tiles are not alike, and colour gets deeper
    const auto allowed = static_cast<double>(options.memory_bytes);
    TransportOptions cut = options;
    cut.tile_cells = std::min(options.tile_cells, std::max(surface.cells.size(), least_cells));
    for (;; cut.tile_cells /= 2) {
        try {
            auto sequence = std::make_unique<ViewingSequence>(scene, surface, cut, progress);
            const double light = slack * sequence->expected_light();
            if (allowed == 0 || light + slack * static_cast<double>(sequence->tiles_[0].bytes) <= allowed) {
                sequence->summary_.cut_for_memory = cut.tile_cells < std::min(options.tile_cells, surface.cells.size());
                return sequence;
            }
            if (light > allowed) return nullptr;
        } catch (const ResourceError&) {
            // Of one tile alone.
        }
        if (cut.tile_cells / 2 < least_cells) return nullptr;
    }
}

void ViewingSequence::cut() {
    tiles_.clear();
    for (ViewingTile& tile : viewing_tiles(surface_, scene_.volume->size(), scene_.volume->pitch_mm(), view_voxels_,
                                           tile_cells_, options_.tile_halo)) {
        tiles_.emplace_back();
        static_cast<ViewingTile&>(tiles_.back()) = std::move(tile);
        tiles_.back().light.resize(channels());
        tiles_.back().adjoint.resize(channels());
    }
    summary_.pieces = tiles_.size();
    list_ghosts();
}

double ViewingSequence::expected_light() const {
    const Tile& tile = tiles_[0];
    const std::size_t bytes =
        channels() * ((tile.cells_of_grid + tile.fine_cells) * sizeof(ViewingField::Code) + 64 * tile.open_faces);
    std::size_t near = 0;
    for (const Tile& t : tiles_) near += t.near.size();
    return static_cast<double>(bytes) * static_cast<double>(near) / static_cast<double>(tile.near.size());
}

/// All places on the rims of windows, whether the body is there or not.
void ViewingSequence::list_ghosts() {
    ghost_places_.clear();
    for (const Tile& tile : tiles_) {
        const auto &low = tile.window.begin, &high = tile.window.end;
        for (std::size_t f = 0; f < 6; ++f) {
            if (!tile.window.cut[f]) continue;
            std::array<int, 3> first = low, last = high;
            first[f / 2] = f % 2 ? high[f / 2] - 1 : low[f / 2];
            last[f / 2] = first[f / 2] + 1;
            for (int z = first[2]; z < last[2]; ++z)
                for (int y = first[1]; y < last[1]; ++y)
                    for (int x = first[0]; x < last[0]; ++x) ghost_places_.push_back(lattice_.index({x, y, z}));
        }
    }
    std::sort(ghost_places_.begin(), ghost_places_.end());
    ghost_places_.erase(std::unique(ghost_places_.begin(), ghost_places_.end()), ghost_places_.end());
    ghost_places_.shrink_to_fit();
}

std::size_t ViewingSequence::Shape::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return grid->memory_bytes() + of(seen.first) + of(seen.face) + of(seen.share) + of(seen.cell) + of(hears) +
           of(tells);
}

std::unique_ptr<ViewingSequence::Shape> ViewingSequence::shape_of(const Tile& tile, const Progress* progress) const {
    auto shape = std::make_unique<Shape>();
    shape->grid = std::make_unique<ViewingGrid>(make_viewing_grid(scene_, view_voxels_,
                                                                  {options_.colour_mm, options_.deep_colour_in_nodes},
                                                                  tile.also, tile.window, &surface_, progress));
    ViewingGrid& grid = *shape->grid;
    grid.shrink();
    shape->seen = see(grid, tiles_.size() == 1 ? surface_ : part_of(surface_, tile.near), progress);
    const auto place_of = [&](std::uint32_t block) {
        std::array<int, 3> at = grid.blocks[block].at;
        for (std::size_t a = 0; a < 3; ++a) at[a] += tile.window.begin[a];
        return at;
    };
    const auto ghost_at = [&](const std::array<int, 3>& at) {
        const auto found = std::lower_bound(ghost_places_.begin(), ghost_places_.end(), lattice_.index(at));
        return found != ghost_places_.end() && *found == lattice_.index(at)
                   ? static_cast<std::uint32_t>(found - ghost_places_.begin())
                   : nowhere;
    };
    for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) {
        const std::array<int, 3> at = place_of(b);
        if (!VoxelBox{tile.begin, tile.end}.holds(at)) continue;
        if (const std::uint32_t ghost = ghost_at(at); ghost != nowhere) shape->tells.emplace_back(b, ghost);
    }
    for (const std::uint32_t ghost : grid.ghosts) shape->hears.push_back(ghost_at(place_of(grid.core_block[ghost])));
    return shape;
}

void ViewingSequence::make_live(std::size_t index, const Progress* progress) {
    const Stopwatch watch;
    ViewingTransport::Room room = transport_ ? transport_->take_room() : ViewingTransport::Room{};
    transport_.reset();
    live_ = index;
    Tile& tile = tiles_[index];
    if (!tile.shape) {
        make_room(tile.bytes + field_bytes() + room.memory_bytes());
        tile.shape = shape_of(tile, progress);
        measure(tile);
    }
    const ViewingGrid& grid = *tile.shape->grid;
    const std::size_t kept = keeps_light_ ? channels() : 1;
    const std::size_t own = tile.light[0].cells.empty()
                                ? kept * ((grid.cells() + tile.fine_cells) * sizeof(ViewingField::Code) +
                                          64 * grid.open_faces.size())
                                : 0,
                      needed = tile.bytes + own + field_bytes();
    if (options_.memory_bytes > 0 && needed > options_.memory_bytes)
        throw ResourceError("a sequence of predictions of " + std::to_string(grid.cells()) +
                            " viewing cells at once needs " + std::to_string((needed >> 20) + 1) +
                            " MiB of memory and " + std::to_string(options_.memory_bytes >> 20) +
                            " are allowed: allow more, expect colour less deep, or take larger cells");
    if (options_.memory_bytes > 0 && needed + room.memory_bytes() > options_.memory_bytes) room = {};
    make_room(needed);
    if (progress) progress->check_cancelled();
    transport_ = std::make_unique<ViewingTransport>(grid, options_, std::move(room));
    summary_.grid_s += watch.total();
}

/// What the grid of a tile takes and holds, after it was made.
void ViewingSequence::measure(Tile& tile) {
    const ViewingGrid& grid = *tile.shape->grid;
    tile.fine_cells = 64 * std::size_t(split_[0] * split_[1] * split_[2]) *
                      blocks_to_refine(grid, *scene_.volume, options_.refinement).size();
    tile.bytes = tile.shape->memory_bytes() + ViewingTransport::bytes_for(grid, 0) +
                 tile.fine_cells * ViewingTransport::bytes_of_part;
    tile.cells_of_grid = grid.cells();
    tile.core_nodes = grid.core_block.size();
    tile.open_faces = grid.open_faces.size();
    summary_.cells = summary_.nodes = 0;
    for (const Tile& t : tiles_) {
        summary_.cells += t.cells_of_grid;
        summary_.nodes += t.cells_of_grid + t.core_nodes;
    }
}

/// Those of all tiles at once, for making one keeps little more than one thread busy; not where they might have to be
/// dropped before they are used.
void ViewingSequence::make_shapes(const Progress* progress) {
    constexpr double slack = 1.3;  // tiles are not alike
    const Stopwatch watch;
    std::vector<std::size_t> missing;
    for (std::size_t t = 0; t < tiles_.size(); ++t)
        if (!tiles_[t].shape) missing.push_back(t);
    if (missing.size() < 2) return;
    const double one = static_cast<double>(tiles_[0].bytes),
                 all = one * static_cast<double>(tiles_.size()) + expected_light();
    if (options_.memory_bytes > 0 && !(slack * all < static_cast<double>(options_.memory_bytes))) return;
    parallel_for(0, missing.size(), 1, [&](std::size_t i) {
        Tile& tile = tiles_[missing[i]];
        tile.shape = shape_of(tile, progress);
    });
    for (const std::size_t t : missing) measure(tiles_[t]);
    summary_.grid_s += watch.total();
}

std::size_t ViewingSequence::shape_bytes() const {
    std::size_t sum = 0;
    for (const Tile& tile : tiles_) sum += tile.shape ? tile.shape->memory_bytes() : 0;
    return sum;
}

void ViewingSequence::make_room(std::size_t bytes) {
    if (options_.memory_bytes == 0) return;
    std::size_t others = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
        if (t == live_ || !tiles_[t].shape) continue;
        others += tiles_[t].shape->memory_bytes();
        // The next ones are dropped too: they would not fit either, and the first ones come first again.
        if (bytes + others > options_.memory_bytes) tiles_[t].shape.reset();
    }
}

void ViewingSequence::look_at(std::size_t index, const Progress* progress) {
    Tile& tile = tiles_[index];
    if (live_ != index || !transport_) make_live(index, progress);
    if (tile.shape->filled == volume_) return;
    const Stopwatch watch;
    std::vector<std::uint8_t> wanted;
    if (!fill(*tile.shape->grid, *volume_, wanted, progress)) {
        tile.also.resize(wanted.size(), 0);
        for (std::size_t i = 0; i < wanted.size(); ++i) tile.also[i] |= wanted[i];
        make_anew(index, progress);
    } else if (!tile.trimmed && !tile.also.empty()) {
        if (std::vector<std::uint8_t> still = still_coloured(tile); !still.empty()) {
            tile.trimmed = true;
            tile.also = std::move(still);
            make_anew(index, progress);
        }
    }
    refine_tile(tile, progress);
    tile.shape->filled = volume_;
    summary_.grid_s += watch.total();
}

/// Fine light is kept where the same blocks are fine as before.
void ViewingSequence::refine_tile(Tile& tile, const Progress* progress) {
    if (options_.refinement == Refinement::none) return;
    ViewingGrid& grid = *tile.shape->grid;
    std::vector<std::uint32_t> blocks = blocks_to_refine(grid, *volume_, options_.refinement);
    if (options_.refinement == Refinement::contrast)
        blocks = blocks_of_contrast(grid, *scene_.resins, std::move(blocks), options_.least_contrast);
    refine(grid, *volume_, blocks, split_, progress);
    if (grid.fine.first == tile.fine_blocks) return;
    tile.fine_blocks = grid.fine.first;
    for (Fields* const fields : {&tile.light, &tile.adjoint})
        for (ViewingField& field : *fields) field.parts.clear();
}

void ViewingSequence::make_anew(std::size_t index, const Progress* progress) {
    Tile& tile = tiles_[index];
    transport_.reset();
    const std::unique_ptr<Shape> was = std::move(tile.shape);
    make_live(index, progress);
    carry_over(*was->grid, tile.light);
    tile.adjoint.assign(channels(), {});
    std::vector<std::uint8_t> wanted;
    const bool filled = fill(*tile.shape->grid, *volume_, wanted, progress);
    VOXTONE_ENSURE(filled);
}

std::vector<std::uint8_t> ViewingSequence::still_coloured(const Tile& tile) const {
    std::vector<std::uint8_t> still = tile.also;
    std::size_t all = 0, left = 0;
    std::size_t place = 0;
    for (int z = tile.window.begin[2]; z < tile.window.end[2]; ++z)
        for (int y = tile.window.begin[1]; y < tile.window.end[1]; ++y)
            for (int x = tile.window.begin[0]; x < tile.window.end[0]; ++x, ++place) {
                if (!still[place]) continue;
                const std::array<int, 3> at{x, y, z};
                std::array<int, 3> corner{};
                for (std::size_t a = 0; a < 3; ++a)
                    corner[a] = at[a] * lattice_.block_voxels[a] - lattice_.shift_voxels[a];
                still[place] = volume_->uniform_material(corner, lattice_.block_voxels) < 0;
                ++all;
                left += still[place];
            }
    // A new grid costs about as much as half of its cells cost in a prediction.
    constexpr std::size_t worth = 16;
    if (worth * (all - left) < live_grid().transport_blocks.size()) still.clear();
    return still;
}

/// Light of the cells that both grids have; where the new one has cells in what was core, the core's.
void ViewingSequence::carry_over(const ViewingGrid& was, Fields& fields) const {
    const ViewingGrid& is = live_grid();
    for (ViewingField& field : fields) {
        if (field.cells.empty()) continue;
        ViewingField next;
        next.cells.resize(is.cells());
        next.core.resize(is.core_block.size());
        for (std::size_t place = 0; place < is.block_at.size(); ++place) {
            if (is.block_at[place] < 0) continue;
            const GridBlock &to = is.blocks[static_cast<std::size_t>(is.block_at[place])],
                            &of = was.blocks[static_cast<std::size_t>(was.block_at[place])];
            if (of.kind != BlockKind::core && to.kind != BlockKind::core) {
                std::copy_n(field.cells.begin() + of.first_cell, 64, next.cells.begin() + to.first_cell);
            } else if (of.kind == BlockKind::core && to.kind == BlockKind::core) {
                next.core[to.core_node] = field.core[of.core_node];
            } else if (to.kind != BlockKind::core) {
                ViewingField::Code code;
                code.phi = phi_code(field.core[of.core_node]);
                std::fill_n(next.cells.begin() + to.first_cell, 64, code);
            } else {
                double sum = 0;
                for (std::size_t k = 0; k < 64; ++k) sum += phi_of(field.cells[of.first_cell + k]);
                next.core[to.core_node] = static_cast<float>(sum / 64);
            }
        }
        // Blocks with open faces are the same in both, and so is their order.
        VOXTONE_ENSURE(was.open_faces.size() == is.open_faces.size());
        next.out = std::move(field.out);
        field = std::move(next);
    }
}

/// By GridBlock::medium.
std::vector<TransportMedium> ViewingSequence::core_media(std::size_t channel) const {
    const ViewingGrid& grid = live_grid();
    const std::size_t resins = grid.resins, mixed = grid.core_shares.size() / resins;
    std::vector<TransportMedium> media(1 + resins + mixed);
    for (std::size_t r = 0; r < resins; ++r)
        media[1 + r] = similar_medium(grid.directions, scene_.resins->resins[r].medium(channel));
    parallel_for(0, mixed, 1 << 8, [&](std::size_t i) {
        const std::span<const float> shares = std::span(grid.core_shares).subspan(i * resins, resins);
        const std::vector<double> fractions(shares.begin(), shares.end());
        media[1 + resins + i] = similar_medium(grid.directions, halftone_(fractions, channel));
    });
    return media;
}

ViewingTransport::Media ViewingSequence::media(std::size_t channel) const {
    const ViewingGrid& grid = live_grid();
    const ResinSet& resins = *scene_.resins;
    const auto media_of = shared_media(grid.directions, grid.edge_mm(), viewing_theta);
    const SeenMedium seen{halftone_, resins, grid.pitch_mm};
    ViewingTransport::Media media;
    media.cells.resize(live_grid().mixtures.size());
    media.core = core_media(channel);
    parallel_for(1, live_grid().mixtures.size(), 1 << 8,
                 [&](std::size_t m) { media.cells[m] = (*media_of)(seen(live_grid().mixtures[m], channel)); });
    const ViewingGrid::Fine& fine = live_grid().fine;
    if (!fine.any()) return media;
    std::array<double, 3> edge = grid.edge_mm();
    for (std::size_t a = 0; a < 3; ++a) edge[a] /= fine.split[a];
    const auto part_of = shared_media(grid.directions, edge, fine_theta);
    media.parts.resize(fine.contents.size());
    parallel_for(1, fine.contents.size(), 1 << 8,
                 [&](std::size_t m) { media.parts[m] = (*part_of)(seen(fine.contents[m], channel)); });
    return media;
}

template <class Done>
void ViewingSequence::solve(Fields Tile::*fields, GhostLight& ghosts, bool hear, Effort effort,
                            std::span<const float> adjoint_seed, const Progress* progress, Done&& done) {
    std::vector<float> around, light;
    for (std::size_t c = 0; c < channels(); ++c) {
        if (progress) progress->check_cancelled();
        const ViewingTransport::Media in = media(c);
        if (!adjoint_seed.empty()) light = light_of(adjoint_seed, c);
        around.clear();
        if (hear)
            for (const std::uint32_t place : live().hears) around.push_back(ghosts[c][place]);
        transport_->solve(in, (tiles_[live_].*fields)[c], effort.sweeps, summary_, progress, light, around,
                          effort.enough);
        for (const auto& [block, place] : live().tells)
            ghosts[c][place] = transport_->mean_phi(live_grid().blocks[block]);
        done(c);
        if (!keeps_light_) (tiles_[live_].*fields)[c] = {};
    }
}

void ViewingSequence::begin(Fields Tile::*fields, GhostLight& ghosts, std::span<const float> adjoint_seed, int rounds,
                            const Progress* progress) {
    const bool known = !ghosts.empty();  // of a twin
    if (!known) ghosts.assign(channels(), std::vector<float>(ghost_places_.size()));
    if (tiles_.size() == 1) return;
    for (int round = known ? 1 : 0; round < rounds; ++round)
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            look_at(t, progress);
            (tiles_[t].*fields).assign(channels(), {});
            solve(fields, ghosts, round > 0, {}, adjoint_seed, progress, [](std::size_t) {});
        }
}

Appearance ViewingSequence::only(const ResinVolume& volume, const Progress* progress) {
    keeps_light_ = false;
    return predict(volume, {options_.sweeps, 0, first_rounds}, progress);
}

Appearance ViewingSequence::twin(const ResinVolume& volume, const Progress* progress) {
    Appearance appearance = predict(volume, {options_.sweeps, options_.first_change, twin_rounds}, progress);
    for (Tile& tile : tiles_) tile.light.assign(channels(), {});
    return appearance;
}

Appearance ViewingSequence::next(const ResinVolume& volume, const Progress* progress) {
    const bool first = tiles_[0].light[0].cells.empty();
    return predict(volume,
                   first ? Effort{options_.sweeps, options_.first_change, first_rounds}
                         : Effort{options_.next_sweeps, options_.next_change, 0},
                   progress);
}

Appearance ViewingSequence::predict(const ResinVolume& volume, Effort effort, const Progress* progress) {
    const Stopwatch watch;
    VOXTONE_EXPECT(volume.size() == scene_.volume->size());
    Scene scene = scene_;
    scene.volume = &volume;
    require_resins(scene);
    volume_ = &volume;
    for (Tile& tile : tiles_)
        if (tile.shape) tile.shape->filled = nullptr;
    if (keeps_light_) make_shapes(progress);
    if (tiles_[0].light[0].cells.empty()) begin(&Tile::light, ghost_light_, {}, effort.rounds, progress);
    Appearance appearance;
    appearance.channels = channels();
    appearance.value.assign(surface_.cells.size() * channels(), 0.0f);
    summary_.last_change.assign(channels(), 0.0);
    summary_.mean_change = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
        look_at(t, progress);
        solve(&Tile::light, ghost_light_, true, effort, {}, progress, [&](std::size_t c) {
            summary_.last_change[c] = std::max(summary_.last_change[c], transport_->last_change());
            summary_.mean_change = std::max(summary_.mean_change, transport_->relative_change());
            read_appearance(c, appearance);
        });
    }
    count_memory(0);
    // Another tile comes next: what this one worked in is not held while the next print is made.
    if (tiles_.size() > 1) transport_.reset();
    summary_.total_s += watch.total();
    if (!keeps_light_) summary_.clipped_values = 0;  // of light that nobody will use
    appearance.remarks = remarks_of(summary_);
    return appearance;
}

void ViewingSequence::read_appearance(std::size_t channel, Appearance& to) const {
    const ViewingTransport& transport = *transport_;
    const ViewingFaces& seen = live().seen;
    const Tile& tile = tiles_[live_];
    const auto flux = transport.flux();
    const auto value_of = [&](std::size_t k) {
        float leaving = 0, furnace = 0;
        for (std::uint32_t e = seen.first[k]; e < seen.first[k + 1]; ++e) {
            leaving += seen.share[e] * flux[seen.face[e]];
            furnace += seen.share[e] * transport.furnace_flux(seen.face[e]);
        }
        // Inside a bubble smaller than a cell the light is that of the cell.
        return furnace > 0 ? leaving / furnace : seen.cell[k] != nowhere ? transport.phi(seen.cell[k]) : 0;
    };
    parallel_ranges(0, tile.near.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        auto own = std::lower_bound(tile.cells.begin(), tile.cells.end(), tile.near[begin]);
        for (std::size_t k = begin; k < end && own != tile.cells.end(); ++k) {
            if (tile.near[k] != *own) continue;
            to.value[*own++ * channels() + channel] = value_of(k);
        }
    });
}

std::vector<float> ViewingSequence::light_of(std::span<const float> adjoint_seed, std::size_t channel) const {
    const ViewingFaces& seen = live().seen;
    const Tile& tile = tiles_[live_];
    std::vector<float> light(live_grid().faces.size(), 0.0f);
    for (std::size_t k = 0; k < tile.near.size(); ++k) {
        float furnace = 0;
        for (std::uint32_t e = seen.first[k]; e < seen.first[k + 1]; ++e)
            furnace += seen.share[e] * transport_->furnace_flux(seen.face[e]);
        for (std::uint32_t e = seen.first[k]; furnace > 0 && e < seen.first[k + 1]; ++e)
            light[seen.face[e]] += adjoint_seed[tile.near[k] * channels() + channel] * seen.share[e] / furnace;
    }
    return light;
}

bool ViewingSequence::gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                               const Progress* progress) {
    const Stopwatch watch;
    VOXTONE_EXPECT(adjoint_seed.size() == surface_.cells.size() * channels());
    VOXTONE_EXPECT(volume_ != nullptr);
    // Fields of both lights, the derivatives, and copies of the light on the faces.
    std::size_t fields = 0, most = 0;
    for (const Tile& tile : tiles_) {
        fields += (tile.cells_of_grid + tile.fine_cells) * sizeof(ViewingField::Code) + 64 * tile.open_faces;
        most = std::max(most,
                        tile.bytes + tile.cells_of_grid * (4 * channels() + 8) + tile.open_faces * 8 * sizeof(Octet));
    }
    const std::size_t needed = most + 2 * channels() * fields;
    if (options_.memory_bytes > 0 && needed > options_.memory_bytes) return false;
    const bool first = ghost_adjoint_.empty();
    if (first) begin(&Tile::adjoint, ghost_adjoint_, adjoint_seed, first_rounds, progress);
    // Backwards: the tile that was looked at last is still at hand.
    for (std::size_t t = tiles_.size(); t-- > 0;) {
        look_at(t, progress);
        make_room(needed);
        Tile& tile = tiles_[t];
        const ViewingGrid& grid = live_grid();
        const auto media_of = shared_media(grid.directions, grid.edge_mm(), viewing_theta);
        const SeenMedium seen{halftone_, *scene_.resins, grid.pitch_mm};
        ViewingGradient gradient(live_grid(), seen, channels());
        std::vector<float> by_sigma_t(live_grid().cells()), by_sigma_s(live_grid().cells());
        const bool anew = first || tile.adjoint[0].cells.empty();
        solve(&Tile::adjoint, ghost_adjoint_, true,
              anew ? Effort{options_.sweeps, 0, 0} : Effort{options_.next_sweeps, 10 * options_.next_change, 0},
              adjoint_seed, progress, [&](std::size_t c) {
                  transport_->derivatives(tile.light[c], by_sigma_t, by_sigma_s, progress);
                  gradient.add(c, *media_of, seen, by_sigma_t, by_sigma_s);
              });
        visit(gradient, tile.voxels);
        count_memory(gradient.memory_bytes() + 4 * (grid.faces.size() + by_sigma_t.size() + by_sigma_s.size()));
    }
    summary_.total_s += watch.total();
    return true;
}

template <class Stream, class Sequence>
void ViewingSequence::state_in(Stream& stream, Sequence& sequence) {
    for (auto& tile : sequence.tiles_) {
        stream.list(tile.also);
        stream.list(tile.fine_blocks);
        stream.value(tile.trimmed);
        for (auto* const fields : {&tile.light, &tile.adjoint})
            for (auto& field : *fields) {
                stream.list(field.cells);
                stream.list(field.parts);
                stream.list(field.core);
                stream.list(field.out);
                stream.value(field.scale);
            }
    }
    for (auto* const ghosts : {&sequence.ghost_light_, &sequence.ghost_adjoint_}) {
        auto channels = static_cast<std::uint64_t>(ghosts->size());
        stream.value(channels);
        if constexpr (!std::is_const_v<Sequence>)
            if (channels == 0 || channels == sequence.channels()) ghosts->resize(channels);
        for (auto& light : *ghosts) stream.list(light);
    }
}

void ViewingSequence::write_state(const StateSink& sink) const {
    StateWriter writer{sink};
    writer.value(std::uint64_t{tile_cells_});
    state_in(writer, *this);
}

bool ViewingSequence::read_state(std::span<const std::byte> state) {
    StateReader reader{state};
    std::uint64_t tile_cells = 0;
    reader.value(tile_cells);
    if (tile_cells == 0) return false;
    transport_.reset();
    if (tile_cells != tile_cells_) {
        tile_cells_ = tile_cells;
        cut();
    }
    state_in(reader, *this);
    // Grids are made anew, with the blocks that these tiles have cells in.
    for (Tile& tile : tiles_) tile.shape.reset();
    return reader.good && reader.bytes.empty() && fits(ghost_light_) && fits(ghost_adjoint_) &&
           std::all_of(tiles_.begin(), tiles_.end(), [this](const Tile& tile) { return fits(tile); });
}

bool ViewingSequence::fits(const Tile& tile) const {
    std::size_t blocks = 1;
    for (std::size_t a = 0; a < 3; ++a) blocks *= static_cast<std::size_t>(tile.window.end[a] - tile.window.begin[a]);
    return tile.also.empty() || tile.also.size() == blocks;
}

bool ViewingSequence::fits(const GhostLight& ghosts) const {
    return std::all_of(ghosts.begin(), ghosts.end(),
                       [this](const auto& light) { return light.size() == ghost_places_.size(); });
}

std::size_t ViewingSequence::field_bytes() const {
    std::size_t sum = 0;
    for (const Tile& tile : tiles_)
        for (const Fields* const fields : {&tile.light, &tile.adjoint})
            for (const ViewingField& field : *fields) sum += field.memory_bytes();
    return sum;
}

void ViewingSequence::count_memory(std::size_t besides) {
    summary_.memory_bytes =
        std::max(summary_.memory_bytes, shape_bytes() + transport_->memory_bytes() + field_bytes() + besides);
}

}  // namespace voxtone::optics
