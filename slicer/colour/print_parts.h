// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the layers of a job are made of, made once: solid, surface shell, target colours, screen. Layers come out of it
// as often as they are asked for: to be written, or as the volume that a model looks at.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "base/progress.h"
#include "halftone/screens/blue_noise_screen.h"
#include "optics/media/resin_volume.h"
#include "slicer/layers/layer_maker.h"
#include "slicer/layers/skin_voxels.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/thin_features.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::slicer {

class PrintParts {
public:
    /// The shell by colour. Keeps references to all but the options.
    PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, const JobColour& colour,
               const Progress& progress);
    /// The shell of what shows no colours.
    PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, const ShellFill& fill);
    PrintParts(const PrintParts&) = delete;
    PrintParts& operator=(const PrintParts&) = delete;

    [[nodiscard]] const SurfaceColour& surface_colour() const { return surface_colour_; }
    /// `skin`: null: the separation's mixtures. Means nothing where the shell shows none.
    [[nodiscard]] LayerSources sources(const SkinSource* skin) const;
    /// Bare of its coat, by what light does that goes straight through it: what a person sees below a coat lies where
    /// the colours are, while flux through its outer face (optics/scene/appearance_model.h) is blurred as wide as the
    /// coat is thick.
    [[nodiscard]] optics::ResinVolume without_coat(optics::ResinVolume volume, std::uint64_t memory_bytes,
                                                   const Progress& progress) const;
    /// All layers as a volume, bare. Throws ResourceError where it takes more than `memory_bytes`.
    [[nodiscard]] optics::ResinVolume volume(const SkinSource* skin, std::uint64_t memory_bytes,
                                             const Progress& progress) const;
    /// The same voxels, all of one material but for clear resin under the colours: a third of the work.
    [[nodiscard]] optics::ResinVolume shape(optics::Material material, std::uint64_t memory_bytes,
                                            const Progress& progress) const;
    /// What of the print is clear by the job's options.
    [[nodiscard]] const DepthZones& zones() const { return zones_; }
    /// What thins the resins where alpha does; null: nothing.
    [[nodiscard]] const halftone::Translucency* translucency() const {
        return translucency_ ? &*translucency_ : nullptr;
    }
    /// Colours on the lower face; null: none.
    [[nodiscard]] const NightSide* night() const { return night_ ? &*night_ : nullptr; }
    /// What `volume` looks up again for every print by a skin, kept: nothing where it takes more than `memory_bytes`,
    /// or where not every voxel is screened by itself from the loop's mixtures.
    [[nodiscard]] std::optional<SkinVoxels> skin_voxels(const SkinMap& map, std::uint64_t memory_bytes,
                                                        const Progress& progress) const;
    /// As `volume` by a skin of these mixtures. `body`: its shape.
    [[nodiscard]] optics::ResinVolume volume(const SkinVoxels& skin, const halftone::SkinMixtures& mixtures,
                                             const optics::ResinVolume& body, std::uint64_t memory_bytes,
                                             const Progress& progress) const;
    /// Visits the blocks that touch a box of voxels and have shell voxels, from several threads at once.
    void for_each_block(const optics::VoxelBox& box, const std::function<void(const ShellBlock&)>& visit,
                        const Progress& progress) const;

private:
    [[nodiscard]] optics::ResinVolume volume_of(const LayerSources& sources, std::uint64_t memory_bytes,
                                                const Progress& progress) const;
    PrintParts(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, double shell_mm);
    [[nodiscard]] TranslucentBody translucent_body() const;
    /// Whether numbers of mixtures and of what is kept of them fit into one.
    [[nodiscard]] bool can_keep_thinned(const SkinMap& map) const;
    /// As SkinVoxels::print has it; core is the last mixture.
    [[nodiscard]] std::uint32_t thinned_number(const SkinMap& map, const ShellBlock& block, int at) const;

    const JobBody& body_;
    const LoadedResins& resins_;
    const JobColour* colour_ = nullptr;  ///< this
    const ShellFill* fill_ = nullptr;    ///< or that
    std::uint64_t seed_;
    Solid solid_;
    SurfaceShell shell_;
    SurfaceColour surface_colour_;
    std::optional<ThinFeatures> thin_;
    DepthZones zones_;
    std::optional<halftone::BlueNoiseScreen> screen_;
    std::optional<halftone::Translucency> translucency_;  ///< where alpha asks for it
    std::optional<NightSide> night_;
};

}  // namespace voxtone::slicer
