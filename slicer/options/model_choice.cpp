// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/options/model_choice.h"

#include <unistd.h>

#include <array>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "voxtone/base/error.h"
#include "voxtone/optics/monte_carlo/monte_carlo.h"
#include "voxtone/optics/profiles/layered_profile_model.h"
#include "voxtone/optics/transport/transport.h"

namespace voxtone::slicer {

std::span<const std::string> model_names() {
    static const std::array<std::string, 3> names{"transport", "monte-carlo", "layered-profile"};
    return names;
}

std::unique_ptr<const optics::AppearanceModel> make_model(const std::string& name, const ModelOptions& options) {
    if (name == "transport") {
        optics::TransportOptions transport;
        transport.sweeps = options.sweeps;
        transport.cell_mm = options.cell_mm;
        transport.viewing_cells = options.viewing_cells;
        transport.colour_mm = options.colour_mm;
        transport.memory_bytes = static_cast<std::size_t>(options.memory_bytes);
        return std::make_unique<optics::TransportPredictor>(transport);
    }
    if (name == "monte-carlo") {
        optics::MonteCarloOptions tracing;
        tracing.paths = options.paths;
        tracing.error = options.error;
        tracing.seed = options.seed;
        return std::make_unique<optics::MonteCarlo>(tracing);
    }
    if (name == "layered-profile") return std::make_unique<optics::LayeredProfileModel>();
    throw UsageError(fmt::format("--model: '{}' is none of {}", name, fmt::join(model_names(), ", ")));
}

std::uint64_t memory_budget(double gib) {
    if (gib > 0) return static_cast<std::uint64_t>(gib * double(1 << 30));
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE)) / 2;
}

}  // namespace voxtone::slicer
