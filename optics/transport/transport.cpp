// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/transport.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/optics/transport/coarse/viewing_sequence.h"
#include "voxtone/optics/transport/diffusion.h"
#include "voxtone/optics/transport/transport_channel.h"

namespace voxtone::optics {
namespace {

std::vector<double> fractions(const ResinSet& resins, const PaletteEntry& entry) {
    std::vector<double> fractions(resins.resins.size());
    for (const auto& [material, share] : entry.shares) fractions[material - 1u] = static_cast<double>(share);
    return fractions;
}

/// The medium of a cell or block that holds voxels in these shares.
Medium mixed(const ResinSet& resins, const EffectiveMedium& halftone, const PaletteEntry& entry, std::size_t channel) {
    if (entry.shares.size() == 1) return resins.resins[entry.shares[0].first - 1u].medium(channel);
    return halftone(fractions(resins, entry), channel);
}

}  // namespace

TransportPredictor::TransportPredictor(const TransportOptions& options) : options_(options) {
    if (options.sweeps < 1)
        throw UsageError("the predictor needs at least 1 sweep, not " + std::to_string(options.sweeps));
    if (!(options.cell_mm > 0)) throw UsageError("the predictor's cells must be larger than 0 mm");
    if (options.margin_blocks < 0 || options.margin_blocks > 64)
        throw UsageError("the predictor's margin must be 0 to 64 blocks");
    VOXTONE_EXPECT(options.tile_cells >= 1 && options.tile_halo >= 1);
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    TransportSummary summary;
    return predict(scene, surface, summary, progress);
}

namespace {

GridOptions grid_options(const TransportOptions& options, const std::array<double, 3>& pitch_mm) {
    GridOptions grid;
    grid.view_voxels = cell_voxels(pitch_mm, options.cell_mm);
    grid.skin_voxels = options.voxel_skin ? std::array<int, 3>{1, 1, 1} : grid.view_voxels;
    grid.margin_blocks = options.margin_blocks;
    return grid;
}

/// What voxels are to light where a cell holds several. `scene` as it was given: with the voxels of the print.
EffectiveMedium halftone_of(const Scene& scene, const Surface& surface) {
    return {*scene.resins, scene.volume->pitch_mm(), seen_from(surface)};
}

/// Into how many pieces a voxel is cut along each axis: cells that are no thicker than light can be followed in.
std::array<int, 3> voxel_pieces(const TransportOptions& options, const std::array<double, 3>& pitch_mm) {
    std::array<int, 3> split{1, 1, 1};
    for (std::size_t a = 0; options.finest_mm > 0 && options.voxel_skin && a < 3; ++a)
        split[a] = std::clamp(static_cast<int>(std::ceil(pitch_mm[a] / options.finest_mm - 0.1)), 1, 4);
    return split;
}

/// The same body and surface with every voxel cut into equal pieces.
struct CutScene {
    std::array<int, 3> split;
    ResinVolume volume;
    Scene scene;
    Surface surface;
    const Surface* seen = nullptr;

    CutScene(const Scene& whole, const Surface& whole_surface, const TransportOptions& options,
             const Progress* progress)
        : split(voxel_pieces(options, whole.volume->pitch_mm())), scene(whole), seen(&whole_surface) {
        if (split == std::array{1, 1, 1}) return;
        cut_volume(*whole.volume, progress);
        cut_surface(whole_surface);
        scene.volume = &volume;
        seen = &surface;
    }
    CutScene(const CutScene&) = delete;
    CutScene& operator=(const CutScene&) = delete;

private:
    void cut_volume(const ResinVolume& from, const Progress* progress) {
        const auto& n = from.size();
        std::array<int, 3> size{};
        std::array<double, 3> pitch{};
        for (std::size_t a = 0; a < 3; ++a) {
            size[a] = n[a] * split[a];
            pitch[a] = from.pitch_mm()[a] / split[a];
        }
        ResinVolumeBuilder builder(size, pitch);
        std::vector<Material> coarse(static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1])),
            fine(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
        for (int z = 0; z < n[2]; ++z) {
            if (progress) progress->check_cancelled();
            from.copy_box({0, 0, z}, {n[0], n[1], 1}, coarse);
            std::size_t i = 0;
            for (int y = 0; y < size[1]; ++y) {
                const Material* const row = coarse.data() + static_cast<std::ptrdiff_t>(y / split[1]) * n[0];
                for (int x = 0; x < n[0]; ++x)
                    for (int k = 0; k < split[0]; ++k) fine[i++] = row[x];
            }
            for (int k = 0; k < split[2]; ++k) builder.add_layer(fine);
        }
        volume = builder.finish();
    }

    void cut_surface(const Surface& from) {
        surface.cells = from.cells;
        for (std::size_t a = 0; a < 3; ++a) surface.cell_voxels[a] = from.cell_voxels[a] * split[a];
        for (SurfaceCell& cell : surface.cells) {
            const std::size_t first = cell.first_face, last = first + cell.faces;
            cell.first_face = static_cast<std::uint32_t>(surface.faces.size());
            for (std::size_t f = first; f < last; ++f) {
                const SurfaceFace& face = from.faces[f];
                const auto axis = static_cast<std::size_t>(face.facing) / 2;
                const bool plus = static_cast<int>(face.facing) % 2 == 1;
                std::array<int, 3> begin{}, end = split;
                if (plus)
                    begin[axis] = split[axis] - 1;
                else
                    end[axis] = 1;
                for (int z = begin[2]; z < end[2]; ++z)
                    for (int y = begin[1]; y < end[1]; ++y)
                        for (int x = begin[0]; x < end[0]; ++x) {
                            surface.faces.push_back({{face.voxel[0] * split[0] + x, face.voxel[1] * split[1] + y,
                                                      face.voxel[2] * split[2] + z},
                                                     face.facing});
                            surface.face_normal.push_back(from.face_normal[f]);
                        }
            }
            cell.faces = static_cast<std::uint32_t>(surface.faces.size()) - cell.first_face;
        }
    }
};

}  // namespace

std::size_t TransportPredictor::least_bytes(double solid_mm3, const std::array<double, 3>& pitch_mm) const {
    constexpr double of_a_block = 64 * 100;  // moments and equations
    constexpr double least_blocks = 32;      // of a tile and the halo around it, where the body has as many
    const std::array<int, 3> view = cell_voxels(pitch_mm, options_.cell_mm);
    double block_mm3 = 1;
    for (std::size_t a = 0; a < 3; ++a) block_mm3 *= 4 * view[a] * pitch_mm[a];
    return static_cast<std::size_t>(of_a_block * std::min(solid_mm3 / block_mm3, least_blocks));
}

/// About, for cells of one voxel everywhere.
std::size_t TransportPredictor::bytes_of_voxels(const Scene& scene, const Progress* progress) const {
    const std::array<int, 3> split = voxel_pieces(options_, scene.volume->pitch_mm());
    GridOptions grid = grid_options(options_, scene.volume->pitch_mm());
    return GridCensus(scene, grid, progress).bytes(static_cast<std::size_t>(split[0] * split[1] * split[2]));
}

namespace {

/// On cells of the eye, once; in one tile, or in as few as memory allows.
Appearance in_tiles(const Scene& scene, const Surface& surface, TransportOptions options, TransportSummary& summary,
                    const Progress* progress) {
    constexpr std::size_t least_cells = 500;
    options.tile_cells = std::min(options.tile_cells, std::max(surface.cells.size(), least_cells));
    for (;; options.tile_cells /= 2) try {
            ViewingSequence sequence(scene, surface, options, progress);
            Appearance seen = sequence.only(*scene.volume, progress);
            summary = sequence.summary();
            return seen;
        } catch (const ResourceError&) {
            if (options.tile_cells / 2 < least_cells) throw;
        }
}

/// None where viewing cells are not asked for, or a body takes more memory with them than is allowed: then it is
/// predicted in pieces, on voxels.
std::unique_ptr<ViewingSequence> viewing_sequence(const Scene& scene, const Surface& surface,
                                                  const TransportOptions& options, const Progress* progress) {
    if (!options.viewing_cells) return nullptr;
    try {
        return std::make_unique<ViewingSequence>(scene, surface, options, progress);
    } catch (const ResourceError&) {
        return nullptr;
    }
}

}  // namespace

Appearance TransportPredictor::predict(const Scene& given, const Surface& given_surface, TransportSummary& summary,
                                       const Progress* progress) const {
    VOXTONE_EXPECT(given.volume && given.resins);
    if (options_.viewing_cells) return in_tiles(given, given_surface, options_, summary, progress);
    if (options_.memory_bytes > 0 && bytes_of_voxels(given, progress) > options_.memory_bytes) {
        TransportOptions tiled = options_;
        tiled.viewing_cells = true;
        tiled.refinement = Refinement::contrast;
        return in_tiles(given, given_surface, tiled, summary, progress);
    }
    const CutScene cut(given, given_surface, options_, progress);
    summary.pieces = 1;
    Appearance seen =
        solve(cut.scene, *cut.seen, halftone_of(given, given_surface), nullptr, nullptr, summary, progress);
    seen.remarks = remarks_of(summary);
    return seen;
}

std::unique_ptr<AppearanceSequence> TransportPredictor::sequence(const Scene& scene, const Surface& surface,
                                                                 const Progress* progress) const {
    if (auto sequence = viewing_sequence(scene, surface, options_, progress)) return sequence;
    return AppearanceModel::sequence(scene, surface, progress);
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, const Derivative& derivative,
                                       TransportGradient& gradient, TransportSummary& summary,
                                       const Progress* progress) const {
    if (options_.viewing_cells)
        throw UsageError("derivatives are of cells of one voxel: ask a predictor without viewing cells");
    const CutScene cut(scene, surface, options_, progress);
    gradient.split = cut.split;
    summary.pieces = 1;
    return solve(cut.scene, *cut.seen, halftone_of(scene, surface), &derivative, &gradient, summary, progress);
}

float TransportGradient::at(const std::array<int, 3>& voxel, std::size_t resin) const {
    float sum = 0;
    for (int z = 0; z < split[2]; ++z)
        for (int y = 0; y < split[1]; ++y)
            for (int x = 0; x < split[0]; ++x) {
                const std::int64_t cell =
                    grid->cell_at({voxel[0] * split[0] + x, voxel[1] * split[1] + y, voxel[2] * split[2] + z});
                if (cell >= 0) sum += by_fraction[static_cast<std::size_t>(cell) * resins + resin];
            }
    return sum;
}

namespace {

/// Which outer faces make up each surface cell.
struct SeenFaces {
    const Surface& surface;
    std::vector<std::int64_t> face;

    SeenFaces(const OpticalGrid& grid, const Surface& seen) : surface(seen), face(seen.faces.size()) {
        for (std::size_t i = 0; i < face.size(); ++i) face[i] = grid.face_at(seen.faces[i]);
    }
    /// What a furnace sends out of a cell.
    [[nodiscard]] double furnace(const TransportChannel& channel, const SurfaceCell& cell) const {
        double sum = 0;
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f)
            if (face[f] >= 0) sum += channel.furnace_flux(static_cast<std::size_t>(face[f]));
        return sum;
    }
    void appearance(const TransportChannel& channel, std::size_t c, Appearance& out) const {
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            const SurfaceCell& cell = surface.cells[i];
            double leaving = 0;
            for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f)
                if (face[f] >= 0) leaving += channel.flux()[static_cast<std::size_t>(face[f])];
            const double entering = furnace(channel, cell);
            out.value[i * out.channels + c] = static_cast<float>(entering > 0 ? leaving / entering : 0);
        }
    }
    /// d F / d flux of every face from d F / d value.
    [[nodiscard]] std::vector<float> light(const TransportChannel& channel, std::size_t faces, std::size_t c,
                                           std::size_t channels, std::span<const float> adjoint_seed) const {
        std::vector<float> light(faces, 0.0f);
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            const SurfaceCell& cell = surface.cells[i];
            const double entering = furnace(channel, cell);
            if (!(entering > 0)) continue;
            // A face of coarse cells holds several faces of voxels and counts once for each.
            for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f)
                if (face[f] >= 0)
                    light[static_cast<std::size_t>(face[f])] +=
                        static_cast<float>(adjoint_seed[i * channels + c] / entering);
        }
        return light;
    }
};

/// d (sigma_t, sigma_s of the transport medium) / d fraction of each resin, by central differences of a smooth
/// function. `halftone`: of voxels in a cell; that of ideal mixtures where a cell is one voxel.
std::vector<std::array<double, 2>> medium_derivatives(const TransportMedia& media_of, const ResinSet& resins,
                                                      const EffectiveMedium& halftone,
                                                      const std::vector<PaletteEntry>& palette, std::size_t channel) {
    const std::size_t n = resins.resins.size();
    std::vector<std::array<double, 2>> out(palette.size() * n);
    std::vector<double> by_absorption(n), by_scattering(n);
    for (std::size_t m = 1; m < palette.size(); ++m) {
        const EffectiveMedium::Point point = halftone.at(fractions(resins, palette[m]), channel);
        const Medium& middle = point.medium;
        halftone.gradient(point, channel, 1, 0, by_absorption);
        halftone.gradient(point, channel, 0, 1, by_scattering);
        for (std::size_t r = 0; r < n; ++r) {
            const Medium along{by_absorption[r], by_scattering[r]};
            const double step = 1e-3 * std::max(middle.sigma_t(), 1e-3) /
                                std::max(std::abs(along.sigma_a) + std::abs(along.sigma_s), 1e-9);
            const auto moved = [&](double s) {
                return media_of.exact({std::max(0.0, middle.sigma_a + s * along.sigma_a),
                                       std::max(0.0, middle.sigma_s + s * along.sigma_s)});
            };
            const auto ahead = moved(step), behind = moved(middle.sigma_t() > 0 ? -step : 0);
            const double width = middle.sigma_t() > 0 ? 2 * step : step;
            out[m * n + r] = {(ahead[0] - behind[0]) / width, (ahead[1] - behind[1]) / width};
        }
    }
    return out;
}

}  // namespace

Appearance TransportPredictor::solve(const Scene& scene, const Surface& surface, const EffectiveMedium& halftone,
                                     const Derivative* derivative, TransportGradient* gradient,
                                     TransportSummary& summary, const Progress* progress) const {
    VOXTONE_EXPECT(scene.volume && scene.resins);
    const Stopwatch watch;
    const auto held =
        std::make_shared<const OpticalGrid>(scene, grid_options(options_, scene.volume->pitch_mm()), progress);
    const OpticalGrid& grid = *held;
    const DiffusionPlan plan(grid, progress);
    for (const std::uint32_t b : grid.transport_blocks) {
        const auto n = grid.cells_in(grid.blocks[b].kind);
        (grid.blocks[b].kind == BlockKind::skin ? summary.skin_cells : summary.margin_cells) +=
            static_cast<std::size_t>(n[0] * n[1] * n[2]);
    }
    summary.nodes += grid.nodes.size();
    const SeenFaces seen(grid, surface);
    summary.grid_s += watch.total();

    const std::array media_of{shared_media(grid.directions, grid.edge_mm(BlockKind::skin)),
                              shared_media(grid.directions, grid.edge_mm(BlockKind::margin))};
    const std::size_t channels = scene.resins->channels.size();
    const auto channel_of = [&](std::size_t c) {
        TransportChannel::MediaByKind media;
        for (std::size_t kind = 0; kind < 2; ++kind) {
            media[kind].resize(grid.palette.size());
            for (std::size_t i = 1; i < grid.palette.size(); ++i)
                media[kind][i] = (*media_of[kind])(mixed(*scene.resins, halftone, grid.palette[i], c));
        }
        media[2].resize(grid.palette.size());
        for (std::size_t i = 1; i < grid.palette.size(); ++i)
            media[2][i] = similar_medium(grid.directions, mixed(*scene.resins, halftone, grid.palette[i], c));
        return TransportChannel(grid, plan, std::move(media), options_, progress);
    };
    Appearance appearance;
    appearance.channels = channels;
    appearance.value.assign(surface.cells.size() * channels, 0.0f);
    std::vector<TransportChannel::Field> fields(channels);
    for (std::size_t c = 0; c < channels; ++c) {
        TransportChannel channel = channel_of(c);
        channel.solve({}, summary);
        seen.appearance(channel, c, appearance);
        summary.last_change.resize(channels);
        summary.last_change[c] = std::max(summary.last_change[c], channel.last_change());
        summary.mean_change = std::max(summary.mean_change, channel.relative_change());
        summary.memory_bytes =
            std::max(summary.memory_bytes, grid.memory_bytes() + plan.memory_bytes() + channel.memory_bytes());
        if (derivative) fields[c] = channel.take_field();
    }
    if (derivative) {
        std::vector<float> adjoint_seed(appearance.value.size(), 0.0f), by_sigma_t, by_sigma_s;
        (*derivative)(appearance, adjoint_seed);
        const std::size_t resins = scene.resins->resins.size();
        gradient->grid = held;
        gradient->resins = resins;
        gradient->by_fraction.assign(grid.medium.size() * resins, 0.0f);
        for (std::size_t c = 0; c < channels; ++c) {
            TransportChannel channel = channel_of(c);
            channel.solve(seen.light(channel, grid.faces.size(), c, channels, adjoint_seed), summary);
            channel.derivatives(fields[c], channel.take_field(), by_sigma_t, by_sigma_s);
            fields[c] = {};
            const bool voxels = grid.voxels_in(BlockKind::skin) == std::array{1, 1, 1};
            const EffectiveMedium of_one(*scene.resins, {});
            const std::array by_fraction{
                medium_derivatives(*media_of[0], *scene.resins, voxels ? of_one : halftone, grid.palette, c),
                medium_derivatives(*media_of[1], *scene.resins, halftone, grid.palette, c)};
            for (const std::uint32_t b : grid.transport_blocks) {
                const GridBlock& block = grid.blocks[b];
                const auto& by = by_fraction[static_cast<std::size_t>(block.kind)];
                const auto cells = grid.cells_in(block.kind);
                const std::size_t end = block.first_cell + static_cast<std::size_t>(cells[0] * cells[1] * cells[2]);
                for (std::size_t cell = block.first_cell; cell < end; ++cell) {
                    const std::size_t m = grid.medium[cell];
                    if (m == 0) continue;
                    for (std::size_t r = 0; r < resins; ++r)
                        gradient->by_fraction[cell * resins + r] +=
                            static_cast<float>(static_cast<double>(by_sigma_t[cell]) * by[m * resins + r][0] +
                                               static_cast<double>(by_sigma_s[cell]) * by[m * resins + r][1]);
                }
            }
        }
    }
    summary.total_s += watch.total();
    return appearance;
}

}  // namespace voxtone::optics
