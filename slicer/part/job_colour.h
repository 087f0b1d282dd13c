// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour half of a job: which resins are loaded, what a mixture of them looks like on this body, and which mixture
// makes a colour.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "halftone/loop/minimal_depth_separation.h"
#include "halftone/separation/separation.h"
#include "io/layers/layer_runs.h"
#include "io/layers/manifest.h"
#include "optics/layered/shell_appearance.h"
#include "optics/media/resins.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

struct LoadedResins {
    optics::ResinSet set;                 ///< only what is loaded; resin r is material r + 1
    std::vector<io::StackResin> entries;  ///< names and colours for the manifest, same order
    int core = 0;                         ///< index of the core resin, or of the base below laminates
    std::array<double, 2> spread_mm{};    ///< how far the printer lets them run, along the model's x and y
    [[nodiscard]] io::Material core_material() const { return static_cast<io::Material>(core + 1); }
};

/// Whether a job that shows colours has parts of clear resin, role T: a core, a coat, what encloses a picture or lets
/// light through it.
[[nodiscard]] bool wants_clear(const ResolvedJob& job);

/// The printer's set; one of the same cartridges with clear resin where the job wants that.
[[nodiscard]] std::string usual_resins(const ResolvedJob& job, const PrinterProfile& printer);

/// What the printer carries at once, as far as a separation can mix it.
[[nodiscard]] int most_resins(const PrinterProfile& printer);

/// All resins of the job's set, the printer's where it names none, as they look under its lamp. Throws InputError.
[[nodiscard]] optics::ResinSet all_resins(const ResolvedJob& job, const PrinterProfile& printer);

/// These of a set's resins. Throws InputError: unknown role, more than the printer carries, the core resin not among
/// them.
[[nodiscard]] LoadedResins load_roles(const ResolvedJob& job, const PrinterProfile& printer,
                                      const optics::ResinSet& all, std::vector<std::string> roles);
/// The resins of `job.resins` that `job.load` names (or the printer's default, of those the set has, and T where that
/// is wanted and a slot is free). Throws the same, and for an unknown set.
[[nodiscard]] LoadedResins load_resins(const ResolvedJob& job, const PrinterProfile& printer);

/// Stays where it was made: the separation refers to the appearance.
struct JobColour {
    JobColour(const optics::ResinSet& resins, const optics::ShellGeometry& geometry)
        : appearance(resins, geometry), separation(appearance, separation_options(resins)) {}
    JobColour(const JobColour&) = delete;
    JobColour& operator=(const JobColour&) = delete;

    const optics::ShellAppearance appearance;
    const halftone::Separation separation;

private:
    static halftone::SeparationOptions separation_options(const optics::ResinSet& resins) {
        halftone::SeparationOptions options;
        options.channels = resins.channels;
        return options;
    }
};

/// A slab of a picture, over a sheet.
struct SlabUnderColour {
    double thickness_mm = 0;  ///< without clear resin over and under it
    BackingChoice backing;
    bool from_behind = false;
    std::array<double, 2> size_mm{};  ///< along x and y
};

/// Nothing for a body.
[[nodiscard]] std::optional<SlabUnderColour> slab_under_colour(const ResolvedJob& job, const JobBody& body);

/// How far below the surface what a voxel is made of is a matter of its depth, mm; where alpha thins the body, which
/// it does to its middle, all of it: no voxel is further from the surface.
[[nodiscard]] double looked_through_mm(const ResolvedJob& job);
[[nodiscard]] double looked_through_mm(const ResolvedJob& job, const JobBody& body);

/// The shell that colours are separated for.
[[nodiscard]] optics::ShellGeometry shell_geometry(const ColourOptions& options, const LoadedResins& resins,
                                                   const Eigen::Vector3d& pitch_mm,
                                                   const std::optional<SlabUnderColour>& slab);

/// `slab`: nothing: a body taken to be thick. `pitch_mm`: of the print's voxels.
[[nodiscard]] std::unique_ptr<const JobColour> prepare_colour(const ColourOptions& options, const LoadedResins& resins,
                                                              const Eigen::Vector3d& pitch_mm,
                                                              const std::optional<SlabUnderColour>& slab,
                                                              Progress& progress);

/// The same colours surface first, as the appearance loop mixes them in these layers, which are as deep as the shell of
/// `appearance`.
[[nodiscard]] std::unique_ptr<const halftone::MinimalDepthSeparation> prepare_recipes(
    const optics::ShellAppearance& appearance, const halftone::SkinLayers& layers);

}  // namespace voxtone::slicer
