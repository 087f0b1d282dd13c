// SPDX-License-Identifier: GPL-3.0-or-later
//
// Appearance models by their names at the command line. Whoever adds a model adds it here and nowhere else.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "base/named_values.h"
#include "optics/scene/appearance_model.h"
#include "optics/scene/boundary.h"
#include "optics/transport/transport.h"

namespace voxtone::slicer {

/// The default first.
enum class PredictionModel { transport, monte_carlo, layered_profile };

struct ModelOptions {
    double cell_mm = 0.085;      ///< of the viewing grid
    bool viewing_cells = false;  ///< transport: on viewing cells throughout, none cut into voxels; a third of the time
    double colour_mm = 1;        ///< transport on viewing cells: how deep colour may lie
    bool deep_colour_in_nodes = false;  ///< as TransportOptions
    int sweeps =
        optics::TransportOptions{}.sweeps;  ///< transport: of discrete ordinates, >= 1; more are nearer and slower
    std::uint64_t memory_bytes = 0;         ///< transport: most to use; 0: no limit
    optics::MakeScratch scratch{};          ///< transport: as TransportOptions
    std::uint32_t paths = 64;               ///< Monte Carlo: per cell and channel, >= 2
    double error = 0;                       ///< Monte Carlo: wanted standard error of every value; 0: `paths` decides
    /// Monte Carlo: the body's true surface, which must outlive the model; nullptr: the faces of its voxels.
    const optics::BodyBoundary* boundary = nullptr;
    bool from_behind = false;     ///< only light counts that came in from below (optics/scene/light_from_behind.h)
    bool follow_outside = false;  ///< Monte Carlo, with a boundary: as MonteCarloOptions
    std::uint64_t seed = 1;
};

/// For a prediction that stands alone: the colour of a body that lies on nothing has cells as far down as light is not
/// diffuse, and nodes below; above a sheet thin slabs would look worse (docs/decisions/006).
void set_depth_of_cells(ModelOptions& options, optics::Backing backing);

[[nodiscard]] std::unique_ptr<const optics::AppearanceModel> make_model(PredictionModel model,
                                                                        const ModelOptions& options);

/// What a prediction of a body of so many mm^3, in voxels of this pitch, needs at the least: can be told before there
/// is a volume. 0 where the model does not know.
[[nodiscard]] std::uint64_t least_model_bytes(PredictionModel model, const ModelOptions& options, double solid_mm3,
                                              const std::array<double, 3>& pitch_mm);

/// What --memory may ask for: a petabyte is a slip of the keyboard.
inline constexpr double most_memory_gib = 1 << 20;

/// Bytes of `gib` GiB, at most most_memory_gib; 0: half of what there is for this process
/// (base/machine_memory.h).
[[nodiscard]] std::uint64_t memory_budget(double gib);

}  // namespace voxtone::slicer

template <>
struct voxtone::NamesOf<voxtone::slicer::PredictionModel> {
    using E = slicer::PredictionModel;
    static constexpr auto table = std::to_array<Named<E>>(
        {{E::transport, "transport"}, {E::monte_carlo, "monte-carlo"}, {E::layered_profile, "layered-profile"}});
};
