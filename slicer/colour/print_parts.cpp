// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/print_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "slicer/layers/layer_volume.h"

namespace voxtone::slicer {

namespace {

/// Nothing where all decals are of mixtures.
std::vector<int> resins_of_decals(const JobBody& body, const LoadedResins& resins) {
    std::vector<int> indices;
    bool any = false;
    for (const std::string& role : body.resin_of_decal) {
        indices.push_back(role.empty() ? -1 : resins.set.find(role));
        any = any || indices.back() >= 0;
    }
    return any ? indices : std::vector<int>{};
}

}  // namespace

PrintParts::PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, double shell_mm)
    : body_(body),
      resins_(resins),
      seed_(job.seed),
      solid_(*body.solid, body.grid, body.relief),
      shell_(body.surface, body.grid, shell_mm, &body.relief),
      // Voxels are sampled at their centres: texture details finer than a voxel's footprint would alias.
      surface_colour_(body.model.mesh, std::sqrt(body.grid.pitch_mm.x() * body.grid.pitch_mm.y()),
                      resins_of_decals(body, resins)) {
    if (job.keep_thin) thin_.emplace(body.solid, solid_);
}

PrintParts::PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, const JobColour& colour,
                       const Progress& progress)
    : PrintParts(job, body, resins, looked_through_mm(job, body)) {
    colour_ = &colour;
    if (surface_colour_.has_alpha()) translucency_.emplace(colour.appearance, colour.separation, resins.set.find("T"));
    if (job.picture.has_night()) {
        const Eigen::Vector3d& pitch_mm = body.grid.pitch_mm;
        night_.emplace(colour.appearance, colour.separation, surface_colour_, *body.surface, body.model.mesh,
                       read_night_picture(job, progress), body.placement.extent_mm.z(),
                       std::sqrt(pitch_mm.x() * pitch_mm.y()), resins.set.find("T"));
    }
    zones_ = zones_of(colour.appearance.geometry());
    if (job.colour.screen == ScreenKind::blue_noise)
        screen_.emplace(std::array{body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()}, &progress);
}

PrintParts::PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, const ShellFill& fill)
    : PrintParts(job, body, resins, fill.shell_mm()) {
    fill_ = &fill;
}

TranslucentBody PrintParts::translucent_body() const {
    if (!translucency_) return {};
    return {&*translucency_, static_cast<float>(colour_->appearance.geometry().shell_mm)};
}

LayerSources PrintParts::sources(const SkinSource* skin) const {
    LayerSources sources{.solid = solid_,
                         .thin = thin_ ? &*thin_ : nullptr,
                         .surface = *body_.surface,
                         .shell = shell_,
                         .core = resins_.core_material(),
                         .resins = fill_};
    if (colour_)
        sources.resins.emplace<MixtureSources>(surface_colour_, colour_->separation, screen_ ? &*screen_ : nullptr,
                                               seed_, skin, translucent_body(), night());
    sources.zones = zones_;
    return sources;
}

optics::ResinVolume PrintParts::volume(const SkinSource* skin, std::uint64_t memory_bytes,
                                       const Progress& progress) const {
    return without_coat(volume_of(sources(skin), memory_bytes, progress), memory_bytes, progress);
}

optics::ResinVolume PrintParts::without_coat(optics::ResinVolume volume, std::uint64_t memory_bytes,
                                             const Progress& progress) const {
    if (zones_.colour_from_mm == 0) return volume;
    /// The voxels of one volume where another has some.
    class Within final : public optics::BlockRemake {
    public:
        explicit Within(const optics::ResinVolume& volume) : volume_(volume) {}
        [[nodiscard]] bool touches(const std::array<int, 3>&) const override { return true; }
        void remake(const std::array<int, 3>& block, std::span<optics::Material> voxels) const override {
            constexpr int edge = optics::ResinVolume::block_edge;
            const std::array<int, 3> corner{block[0] * edge, block[1] * edge, block[2] * edge};
            std::array<optics::Material, std::size_t(edge) * edge * edge> printed;
            volume_.copy_box(corner, {edge, edge, edge}, printed);
            for (std::size_t i = 0; i < printed.size(); ++i)
                if (voxels[i] != optics::air) voxels[i] = printed[i];
        }

    private:
        const optics::ResinVolume& volume_;
    };
    const optics::ResinVolume bare = shape(resins_.core_material(), memory_bytes, progress);
    const Within within(volume);
    return optics::remade(bare, resins_.core_material(), &within, &progress);
}

optics::ResinVolume PrintParts::shape(optics::Material material, std::uint64_t memory_bytes,
                                      const Progress& progress) const {
    LayerSources all_core = sources(nullptr);
    all_core.core = static_cast<io::Material>(material);
    all_core.core_only = true;
    return volume_of(all_core, memory_bytes, progress);
}

optics::ResinVolume PrintParts::volume_of(const LayerSources& sources, std::uint64_t memory_bytes,
                                          const Progress& progress) const {
    const LayerMaker maker(sources);
    const VoxelGrid& grid = body_.grid;
    LayerVolume volume(LayerWindow{{}, grid.size}, {grid.pitch_mm.x(), grid.pitch_mm.y(), grid.pitch_mm.z()},
                       LayerVolume::same_materials(), memory_bytes);
    const int layers = grid.size[2];
    parallel_for(
        0, static_cast<std::size_t>((layers + maker.slab_layers() - 1) / maker.slab_layers()), 1,
        [&](std::size_t slab) {
            progress.check_cancelled();
            (void)maker.make(static_cast<int>(slab), 0, layers,
                             [&](int k, const io::LayerRuns& layer) { volume.add(k, layer); });
        },
        &progress);
    return volume.finish();
}

std::optional<SkinVoxels> PrintParts::skin_voxels(const SkinMap& map, std::uint64_t memory_bytes,
                                                  const Progress& progress) const {
    if (!screen_ || surface_colour_.sets_resins() || night_) return std::nullopt;
    if (translucency_ && !can_keep_thinned(map)) return std::nullopt;
    const int depth = shell_.block_size()[2];
    const auto& size = body_.grid.size;
    const auto visit_slab = [&](int slab, const auto& visit) {
        for_each_block({{0, 0, slab * depth}, {size[0], size[1], std::min((slab + 1) * depth, size[2])}}, visit,
                       progress);
    };
    const auto number_of = [&](const ShellBlock& block, int at) {
        if (translucency_) return thinned_number(map, block, at);
        const std::size_t unknown = map.at(block.triangle[at], block.u[at], block.v[at], block.distance_mm[at]);
        if (unknown == SkinMap::clear)  // a coat is not looked at
            return zones_.is_over(block.distance_mm[at]) ? SkinVoxels::core : SkinVoxels::clear;
        return unknown == SkinMap::core ? SkinVoxels::core : static_cast<std::uint32_t>(unknown);
    };
    return SkinVoxels::of(body_.grid, depth, visit_slab, number_of, memory_bytes);
}

bool PrintParts::can_keep_thinned(const SkinMap& map) const {
    return !zones_.any() && map.apart.empty() &&
           (map.cells.size() * map.layers.size() + 1) * halftone::Translucency::kept_steps < SkinVoxels::clear;
}

std::uint32_t PrintParts::thinned_number(const SkinMap& map, const ShellBlock& block, int at) const {
    constexpr std::uint32_t steps = halftone::Translucency::kept_steps;
    const std::uint32_t source = body_.surface->source_triangle[block.triangle[at]];
    const float u = block.u[at], v = block.v[at], alpha = surface_colour_.alpha_at(source, u, v);
    const std::uint32_t step =
        alpha < 1 ? translucency_->kept_step(surface_colour_.at(source, u, v), alpha) : steps - 1;
    float depth_mm = block.distance_mm[at];
    if (alpha < 1) depth_mm *= halftone::Translucency::kept_of(step);
    const std::size_t unknown =
        depth_mm > translucent_body().shell_mm ? SkinMap::core : map.at(block.triangle[at], u, v, depth_mm);
    if (unknown < SkinMap::clear) return std::uint32_t(unknown) * steps + step;
    return step == steps - 1 ? SkinVoxels::core : std::uint32_t(map.cells.size() * map.layers.size()) * steps + step;
}

optics::ResinVolume PrintParts::volume(const SkinVoxels& skin, const halftone::SkinMixtures& mixtures,
                                       const optics::ResinVolume& body, std::uint64_t memory_bytes,
                                       const Progress& progress) const {
    const std::size_t resins = mixtures.resins();
    std::vector<halftone::CumulativeMixture> mixture = halftone::cumulative_mixtures(mixtures);
    if (zones_.any()) {
        halftone::SkinMixtures clear(1, 1, resins);
        clear.cell(0)[static_cast<std::size_t>(zones_.clear)] = 1;
        mixture.push_back(halftone::cumulative_mixtures(clear)[0]);
    }
    if (translucency_) {
        halftone::SkinMixtures core(1, 1, resins);
        core.cell(0)[static_cast<std::size_t>(resins_.core)] = 1;
        mixture.push_back(halftone::cumulative_mixtures(core)[0]);
    }
    optics::ResinVolume print = skin.print(body, resins_.core_material(), mixture, static_cast<int>(resins), *screen_,
                                           progress, translucency_ ? &*translucency_ : nullptr);
    expect_volume_fits(print.size(), double(print.memory_bytes()), memory_bytes);
    return print;
}

void PrintParts::for_each_block(const optics::VoxelBox& box, const std::function<void(const ShellBlock&)>& visit,
                                const Progress& progress) const {
    const int depth = shell_.block_size()[2], across = shell_.block_size()[1], layers = body_.grid.size[2];
    const auto first_of = [](int voxel, int edge) { return std::max(voxel, 0) / edge; };
    const auto end_of = [](int voxel, int edge, int blocks) { return std::min((voxel + edge - 1) / edge, blocks); };
    const int end = end_of(box.end[2], depth, shell_.block_layers()),
              last_row = end_of(box.end[1], across, shell_.block_rows());
    parallel_for(
        static_cast<std::size_t>(first_of(box.begin[2], depth)), static_cast<std::size_t>(end), 1,
        [&](std::size_t slab) {
            progress.check_cancelled();
            const int first = static_cast<int>(slab) * depth, last = std::min(first + depth, layers);
            SpanSlab spans;
            if (thin_)
                (void)thin_->slab(first, last, spans);
            else
                solid_.slab(first, last, spans);
            for (int row = first_of(box.begin[1], across); row < last_row; ++row)
                shell_.for_each_block(row, static_cast<int>(slab), spans, visit, box.begin[0], box.end[0]);
        },
        &progress);
}

}  // namespace voxtone::slicer
