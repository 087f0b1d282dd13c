// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/model_choice.h"

#include <algorithm>

#include "base/machine_memory.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/profiles/layered_profile_model.h"
#include "optics/scene/light_from_behind.h"
#include "optics/transport/transport.h"

namespace voxtone::slicer {

namespace {

optics::TransportPredictor transport_predictor(const ModelOptions& options) {
    optics::TransportOptions transport;
    transport.sweeps = options.sweeps;
    transport.cell_mm = options.cell_mm;
    transport.refinement = options.viewing_cells ? optics::Refinement::none : optics::Refinement::contrast;
    transport.colour_mm = options.colour_mm;
    transport.deep_colour_in_nodes = options.deep_colour_in_nodes;
    transport.memory_bytes = static_cast<std::size_t>(options.memory_bytes);
    transport.scratch = options.scratch;
    return optics::TransportPredictor(transport);
}

std::unique_ptr<const optics::AppearanceModel> make_monte_carlo(const ModelOptions& options) {
    optics::MonteCarloOptions tracing;
    tracing.paths = options.paths;
    tracing.error = options.error;
    tracing.boundary = options.boundary;
    tracing.follow_outside = options.follow_outside;
    tracing.seed = options.seed;
    return std::make_unique<optics::MonteCarlo>(tracing);
}

}  // namespace

void set_depth_of_cells(ModelOptions& options, optics::Backing backing) {
    if (backing != optics::Backing::none) return;
    constexpr double cells_mm = 0.4;
    options.colour_mm = std::min(options.colour_mm, cells_mm);
    options.deep_colour_in_nodes = true;
}

std::unique_ptr<const optics::AppearanceModel> make_model(PredictionModel model, const ModelOptions& options) {
    if (options.from_behind) {
        ModelOptions each = options;  // there are two
        each.from_behind = false, each.memory_bytes /= 2;
        return std::make_unique<optics::LightFromBehind>(make_model(model, each));
    }
    switch (model) {
        case PredictionModel::monte_carlo:
            return make_monte_carlo(options);
        case PredictionModel::layered_profile:
            return std::make_unique<optics::LayeredProfileModel>();
        case PredictionModel::transport:
            break;
    }
    return std::make_unique<optics::TransportPredictor>(transport_predictor(options));
}

std::uint64_t least_model_bytes(PredictionModel model, const ModelOptions& options, double solid_mm3,
                                const std::array<double, 3>& pitch_mm) {
    return model == PredictionModel::transport ? transport_predictor(options).least_bytes(solid_mm3, pitch_mm) : 0;
}

std::uint64_t memory_budget(double gib) {
    if (gib > 0) return static_cast<std::uint64_t>(gib * double(1 << 30));
    return machine_memory_bytes() / 2;
}

}  // namespace voxtone::slicer
