// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_sequence.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/step_part.h"
#include "base/stopwatch.h"
#include "optics/grid/refinement.h"
#include "optics/media/droplet_spread.h"
#include "optics/transport/seen_medium.h"
#include "optics/transport/viewing_gradient.h"

namespace voxtone::optics {
namespace {

/// What voxels are to each other where resin runs sideways: less apart (lateral_spread.h).
ResinSet as_printed(const Scene& scene) {
    ResinSet resins = *scene.resins;
    const LateralSpread spread(scene.spread_mm, scene.volume->pitch_mm());
    if (spread.any()) resins.dot_spread = 1 - (1 - resins.dot_spread) * spread.kept_variance();
    return resins;
}

/// A prediction that stands alone sees how far droplets of such a set run (droplet_spread.h: even within a box), within
/// layers, as a Gaussian as wide. Without, `compare` told light paths of the same print to be blurred by 0.03 mm or
/// more. A loop chooses without: with them at each step its print of a photograph is as far off by light paths.
Scene with_droplets(const Scene& scene) {
    Scene seen = scene;
    if (voxels_are_apart(*scene.resins)) return seen;
    const DropletSpread droplets(scene.resins->dot_spread, scene.volume->pitch_mm());
    for (std::size_t a = 0; a < seen.spread_mm.size(); ++a) {
        const double box = 2 * droplets.reach[a] + 1, pitch_mm = scene.volume->pitch_mm()[a];
        const double droplets_mm = pitch_mm * std::sqrt(droplets.chance * (box * box - 1) / 12);
        seen.spread_mm[a] = std::min(widest_spread_mm, std::hypot(scene.spread_mm[a], droplets_mm));
    }
    return seen;
}

TransportOptions suited_to(const ResinSet& resins, TransportOptions options) {
    if (options.refinement == Refinement::contrast && !voxels_are_apart(resins)) options.refinement = Refinement::none;
    return options;
}

/// Of diffusion alone, before light is swept; of a twin, all of white, for which a cut that is a mirror is a good
/// guess.
constexpr int first_rounds = 2, twin_rounds = 1;

void require_memory(const std::string& what, std::size_t needed, std::size_t allowed, const std::string& remedy) {
    if (allowed > 0 && needed > allowed)
        throw ResourceError(what + std::to_string((needed >> 20) + 1) + " MiB of memory and " +
                            std::to_string(allowed >> 20) + " are allowed: allow more, " + remedy);
}

}  // namespace

ViewingSequence::ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options,
                                 const Progress* progress)
    : scene_(options.refinement == Refinement::contrast ? with_droplets(scene) : scene),
      surface_(surface),
      options_(suited_to(*scene.resins, options)),
      halftone_(as_printed(scene), scene.volume->pitch_mm(), seen_from(surface)),
      grids_(scene_, surface, options_) {
    make_live(0, progress);
}

std::unique_ptr<ViewingSequence> ViewingSequence::within_memory(const Scene& scene, const Surface& surface,
                                                                const TransportOptions& options,
                                                                const Progress* progress) {
    constexpr double slack = 1.3;  // tiles are not alike, and colour gets deeper
    TransportOptions whole_cells = options;
    whole_cells.refinement = Refinement::none;
    auto sequence = std::make_unique<ViewingSequence>(scene, surface, whole_cells, progress);
    TileGrids& grids = sequence->grids_;
    const auto bytes_with = [&](double light) { return slack * (light + static_cast<double>(sequence->live().bytes)); };
    const auto allowed = static_cast<double>(options.memory_bytes);
    double needed = bytes_with(grids.expected_light());
    if (options.scratch && options.memory_bytes > 0 && grids.tiles().size() > 1 &&
        needed + grids.expected_shapes() > allowed) {
        grids.open_store();
        needed = bytes_with(static_cast<double>(sequence->live().field_bytes()));
    }
    require_memory(
        "predictions of " + std::to_string(surface.cells.size()) + " surface cells, one after the other, need ",
        static_cast<std::size_t>(needed), options.memory_bytes, "expect colour less deep, or take larger cells");
    return sequence;
}

void ViewingSequence::make_live(std::size_t index, const Progress* progress) {
    const Stopwatch watch;
    ViewingTransport::Workspace room = transport_ ? transport_->take_workspace() : ViewingTransport::Workspace{};
    transport_.reset();
    live_ = index;
    Tile& tile = live();
    grids_.make(tile, grids_.field_bytes() + room.memory_bytes(), progress);
    grids_.count(summary_);
    const std::size_t kept = keeps_light_ && !grids_.stores() ? channels() : 1,
                      own = tile.light[0].blocks.empty() ? kept * tile.field_bytes() : 0,
                      needed = tile.bytes + own + grids_.field_bytes();
    require_memory(
        "a sequence of predictions of " + std::to_string(tile.cells_of_grid) + " viewing cells at once needs ", needed,
        options_.memory_bytes, "expect colour less deep, or take larger cells");
    if (options_.memory_bytes > 0 && needed + room.memory_bytes() > options_.memory_bytes) room = {};
    grids_.make_room(needed, tile);
    if (progress) progress->check_cancelled();
    transport_ = std::make_unique<ViewingTransport>(live_grid(), options_.start_tolerance, std::move(room));
    summary_.grid_s += watch.total();
}

void ViewingSequence::prepare(std::size_t index, const Progress* progress) {
    if (live_ != index || !transport_) make_live(index, progress);
    if (live().shape->filled == volume_) return;
    const Stopwatch watch;
    if (!grids_.fill(live(), *volume_, progress)) remake_live(progress);
    live().shape->filled = volume_;
    summary_.grid_s += watch.total();
}

void ViewingSequence::remake_live(const Progress* progress) {
    transport_.reset();
    Tile& tile = live();
    const std::unique_ptr<Tile::Shape> was = std::move(tile.shape);
    make_live(live_, progress);
    for (std::size_t c = 0; c < channels(); ++c) {
        ViewingField& field = grids_.bring(tile, c);
        field = carried_over(field, was->grid, live_grid());
        grids_.put_away(tile, c);
    }
    const bool filled = grids_.fill(tile, *volume_, progress);
    VOXTONE_ENSURE(filled);
}

void ViewingSequence::refine_live(const Progress* progress) {
    if (keeps_light_ || options_.refinement == Refinement::none) return;
    const Stopwatch watch;
    ViewingGrid& grid = live().shape->grid;
    std::vector<std::uint32_t> blocks = blocks_to_refine(grid, *volume_, options_.refinement);
    if (options_.refinement == Refinement::contrast)
        blocks = blocks_of_contrast(grid, *scene_.resins, std::move(blocks), options_.least_contrast);
    refine(grid, *volume_, blocks, parts_of_cell(grid.view_voxels, grid.pitch_mm), progress);
    summary_.grid_s += watch.total();
}

GridMedia ViewingSequence::media_of_live(std::size_t channel) const {
    return media_of_grid(live_grid(), halftone_, *scene_.resins, channel);
}

/// Of as many as are to come.
PartRange ViewingSequence::next_solve(const Progress* progress) {
    const double of_one = (1 - solves_from_) / double(std::max<std::size_t>(1, solves_)),
                 low = solves_from_ + double(solved_++) * of_one;
    return {progress, low, low + of_one};
}

/// A last sweep that changed so much of what is seen has not come nearer: where light goes straight through deep clear
/// resin, corrections from print to print swing up (a photograph of 10 mm over a night, in 4 mm: a loop of 5.7, 3.6,
/// 10, 54, 120). Then the light begins anew, as that of the first print.
constexpr double runs_away = 0.1;

template <class Done>
void ViewingSequence::solve(bool receives, Effort effort, const Progress* progress, Done&& done) {
    std::vector<float> at_ghosts;
    for (std::size_t c = 0; c < channels(); ++c) {
        if (progress) progress->check_cancelled();
        const GridMedia media = media_of_live(c);
        at_ghosts.clear();
        if (receives)
            for (const std::uint32_t place : live().shape->received) at_ghosts.push_back(ghosts_[c][place]);
        ViewingField& field = grids_.bring(live(), c);
        const PartRange part = next_solve(progress);
        const bool goes_on = !field.blocks.empty() && effort.sweeps.most > 0;
        transport_->solve(media, field, effort.sweeps, summary_, progress, at_ghosts);
        if (goes_on && transport_->relative_change() > runs_away) {
            field = {};
            transport_->solve(media, field, {1, options_.sweeps, options_.first_change}, summary_, progress, at_ghosts);
        }
        for (const auto& [block, place] : live().shape->sent)
            ghosts_[c][place] = transport_->mean_phi(live_grid().blocks[block]);
        done(c);
        if (!keeps_light_) field = {};
        grids_.put_away(live(), c);
    }
}

void ViewingSequence::begin(int rounds, const Progress* progress) {
    const bool known = !ghosts_.empty();  // of a twin
    if (!known) ghosts_.assign(channels(), std::vector<float>(grids_.ghosts()));
    const std::size_t tiles = grids_.tiles().size();
    if (tiles == 1) return;
    for (int round = known ? 1 : 0; round < rounds; ++round)
        for (std::size_t t = 0; t < tiles; ++t) {
            prepare(t, progress);
            live().light.assign(channels(), {});
            solve(round > 0, {}, progress, [](std::size_t) {});
        }
}

Appearance ViewingSequence::only(const ResinVolume& volume, const Progress* progress) {
    keeps_light_ = false;
    ghosts_.clear();
    summary_.open_solves = 0;  // of another prediction's light
    // A tile's light is not kept from the last round: it is found once more, with what its neighbours told, and swept.
    const int least = options_.sweeps, most = options_.first_change > 0 ? 2 * least : least;
    return predict(volume, {{least, most, options_.first_change}, first_rounds - 1}, progress);
}

Appearance ViewingSequence::twin(const ResinVolume& volume, const Progress* progress) {
    Appearance appearance = predict(volume, {{1, options_.sweeps, options_.first_change}, twin_rounds}, progress);
    for (Tile& tile : grids_.tiles()) tile.light.assign(channels(), {});
    return appearance;
}

Appearance ViewingSequence::next(const ResinVolume& volume, const Progress* progress) {
    const bool first = grids_.tiles()[0].light[0].empty();
    return predict(volume,
                   first ? Effort{{1, options_.sweeps, options_.first_change}, first_rounds}
                         : Effort{{1, options_.next_sweeps, options_.next_change}, 0},
                   progress);
}

Appearance ViewingSequence::last(const ResinVolume& volume, const Progress* progress) {
    scene_ = with_droplets(scene_);
    for (Tile& tile : grids_.tiles())
        if (tile.shape) tile.shape->grid.spread = LateralSpread(scene_.spread_mm, scene_.volume->pitch_mm());
    const bool first = grids_.tiles()[0].light[0].empty();
    return predict(volume, {{2, options_.next_sweeps, options_.first_change}, first ? first_rounds : 0}, progress);
}

Appearance ViewingSequence::predict(const ResinVolume& volume, Effort effort, const Progress* progress) {
    const Stopwatch watch;
    VOXTONE_EXPECT(volume.size() == scene_.volume->size());
    Scene scene = scene_;
    scene.volume = &volume;
    require_resins(scene);
    volume_ = &volume;
    std::vector<Tile>& tiles = grids_.tiles();
    for (Tile& tile : tiles)
        if (tile.shape) tile.shape->filled = nullptr;
    if (keeps_light_) {
        const Stopwatch making;
        constexpr double share_of_grids = 0.3;  // about, of the first prediction
        const bool are_made = std::ranges::all_of(tiles, [](const Tile& tile) { return tile.shape != nullptr; });
        solves_from_ = are_made ? 0 : share_of_grids;
        const PartRange part(progress, 0, solves_from_);
        grids_.make_all(progress);
        summary_.grid_s += making.total();
    }
    const bool goes_round = tiles.size() > 1 && tiles[0].light[0].empty();
    const int rounds = goes_round ? std::max(0, effort.rounds - (ghosts_.empty() ? 0 : 1)) : 0;
    solves_ = static_cast<std::size_t>(rounds + 1) * tiles.size() * channels();
    solved_ = 0;
    if (tiles[0].light[0].empty()) begin(effort.rounds, progress);
    Appearance appearance;
    appearance.channels = channels();
    appearance.value.assign(surface_.cells.size() * channels(), 0.0f);
    summary_.last_change.assign(channels(), 0.0);
    summary_.mean_change = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        prepare(t, progress);
        refine_live(progress);
        solve(true, effort, progress, [&](std::size_t c) {
            summary_.last_change[c] = std::max(summary_.last_change[c], transport_->last_change());
            summary_.mean_change = std::max(summary_.mean_change, transport_->relative_change());
            read_appearance(c, appearance);
        });
        count_memory(0);
        live().shape->grid.fine = {};
    }
    // Another tile comes next: what this one worked in is not held while the next print is made.
    if (tiles.size() > 1) transport_.reset();
    grids_.count(summary_);
    summary_.total_s += watch.total();
    if (!keeps_light_) summary_.clipped_values = 0;  // of light that nobody will use
    appearance.remarks = remarks_of(summary_);
    return appearance;
}

void ViewingSequence::read_appearance(std::size_t channel, Appearance& to) const {
    const ViewingTransport& transport = *transport_;
    const ViewingFaces& seen = live().shape->seen;
    const Tile& tile = live();
    const auto flux = transport.flux();
    const auto value_of = [&](std::size_t k) {
        float leaving = 0, furnace = 0;
        for (std::uint32_t e = seen.first[k]; e < seen.first[k + 1]; ++e) {
            leaving += seen.share[e] * flux[seen.face[e]];
            furnace += seen.share[e] * transport.furnace_flux(seen.face[e]);
        }
        // Inside a bubble smaller than a cell the light is that of the cell.
        return furnace > 0 ? leaving / furnace : seen.cell[k] != no_cell ? transport.phi(seen.cell[k]) : 0;
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
    const ViewingFaces& seen = live().shape->seen;
    const Tile& tile = live();
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

std::size_t ViewingSequence::gradient_bytes() const {
    // Fields, the derivatives, and copies of the light on the faces.
    std::size_t fields = 0, largest_field = 0, most = 0;
    for (const Tile& tile : grids_.tiles()) {
        fields += tile.field_bytes();
        largest_field = std::max(largest_field, tile.field_bytes());
        most = std::max(most,
                        tile.bytes + tile.cells_of_grid * (4 * channels() + 8) + tile.open_faces * 8 * sizeof(Octet));
    }
    return grids_.stores() ? most + largest_field : most + channels() * fields;
}

bool ViewingSequence::gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                               const Progress* progress) {
    const Stopwatch watch;
    VOXTONE_EXPECT(adjoint_seed.size() == surface_.cells.size() * channels());
    VOXTONE_EXPECT(volume_ != nullptr && keeps_light_);
    const std::size_t needed = gradient_bytes();
    require_memory("the gradient of a print needs ", needed, options_.memory_bytes, "or take larger cells");
    solves_ = grids_.tiles().size() * channels();
    solved_ = 0, solves_from_ = 0;
    // Backwards: the tile that was solved last is still at hand.
    for (std::size_t t = grids_.tiles().size(); t-- > 0;) {
        prepare(t, progress);
        Tile& tile = live();
        grids_.make_room(needed, tile);
        const ViewingGrid& grid = live_grid();
        const auto media_of = media_of_cells(grid);
        const SeenMedium seen{halftone_, *scene_.resins, grid.pitch_mm};
        ViewingGradient gradient(grid, seen, channels());
        std::vector<float> by_sigma_t(grid.cells()), by_sigma_s(grid.cells());
        for (std::size_t c = 0; c < channels(); ++c) {
            const GridMedia media = media_of_live(c);
            const PartRange part = next_solve(progress);
            transport_->solve_adjoint(media, light_of(adjoint_seed, c), options_.adjoint_sweeps, summary_, progress);
            transport_->derivatives(grids_.bring(tile, c), by_sigma_t, by_sigma_s, progress);
            grids_.put_away(tile, c);
            gradient.add(c, *media_of, seen, by_sigma_t, by_sigma_s);
        }
        visit(gradient, tile.voxels);
        count_memory(gradient.memory_bytes() + 4 * (grid.faces.size() + by_sigma_t.size() + by_sigma_s.size()));
    }
    summary_.total_s += watch.total();
    return true;
}

void ViewingSequence::write_state(const StateSink& sink) const { optics::write_state(grids_, ghosts_, sink); }

bool ViewingSequence::read_state(std::span<const std::byte> state) {
    transport_.reset();
    const bool read = optics::read_state(grids_, ghosts_, channels(), state);
    grids_.count(summary_);
    return read;
}

void ViewingSequence::count_memory(std::size_t besides) {
    summary_.memory_bytes = std::max(
        summary_.memory_bytes, grids_.shape_bytes() + transport_->memory_bytes() + grids_.field_bytes() + besides);
}

}  // namespace voxtone::optics
