// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/stacks/named_stack.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "halftone/stacks/stack_materials.h"
#include "optics/profiles/resin_profile.h"

namespace voxtone::slicer {
namespace {

using optics::StackLight;

constexpr double blur = 0.75;  // of reach / n

StackSetting setting_of(const NamedStackOptions& given, const io::LayerSequence& sequence) {
    StackSettingOptions options;
    for (const io::SequenceLayer& layer : sequence.layers)
        if (std::find(options.materials.begin(), options.materials.end(), layer.material) == options.materials.end())
            options.materials.push_back(layer.material);
    options.resins = sequence.resins;
    options.surface = sequence.surface;
    options.backing = sequence.backing;
    options.reach_mm = given.reach_mm;
    options.coefficients = given.coefficients;
    return StackSetting(options);
}

std::vector<halftone::StackLayer> layers_of(const io::LayerSequence& sequence, const StackSetting& setting) {
    std::vector<halftone::StackLayer> layers;
    for (const io::SequenceLayer& layer : sequence.layers) {
        const auto material = std::find(setting.names().begin(), setting.names().end(), layer.material);
        layers.push_back({static_cast<std::size_t>(material - setting.names().begin()), layer.mm});
    }
    return layers;
}

// Of measured profiles, or on a measured backing: the surface is a layer of its own.
StackLight profiles_of(const StackSetting& setting, std::span<const halftone::StackLayer> layers,
                       const std::vector<halftone::StackMaterial>& materials) {
    StackLight light;
    const std::size_t n = setting.grid().size();
    for (std::size_t c = 0; c < setting.channels().size(); ++c) {
        optics::LayerProfile all = optics::smooth_surface(setting.ends().eta_top, n);
        for (const halftone::StackLayer& layer : layers)
            all = optics::stack(all, materials[layer.material][c].of_thickness(layer.thickness_mm));
        if (setting.ends().eta_bottom > 1) {
            all = optics::stack(all, optics::turned_over(optics::smooth_surface(setting.ends().eta_bottom, n)));
        } else if (!setting.backing_reflection().empty()) {
            const std::vector<double>& R = setting.backing_reflection()[c];
            all = optics::stack(all, {std::vector<double>(n, 1.0), R, R});
        }
        light.R.push_back(all.R_top);
        light.T.push_back(all.T);
    }
    light.R_error.assign(light.R.size(), 0.0);
    light.T_error = light.R_error;
    return light;
}

}  // namespace

io::LayerSequence read_named_sequence(const std::string& stack, const NamedStackOptions& options) {
    io::LayerSequence sequence;
    if (std::filesystem::path(stack).extension() == ".json" && stack.find_first_of(" ,") == std::string::npos) {
        sequence = io::read_layer_sequence(stack);
    } else {
        sequence.name = stack;
        sequence.layers = io::parse_layers(stack);
        sequence.resins = "vero-opaque";
        sequence.surface = "auto";
    }
    if (!options.resins.empty()) sequence.resins = options.resins;
    if (!options.surface.empty()) sequence.surface = options.surface;
    if (!options.backing.empty()) sequence.backing = options.backing;
    if (sequence.layers.empty())
        throw InputError(fmt::format("{}: has no layer; there is nothing to predict or print", stack));
    return sequence;
}

NamedStack read_named_stack(const std::string& stack, const NamedStackOptions& options) {
    io::LayerSequence sequence = read_named_sequence(stack, options);
    StackSetting setting = setting_of(options, sequence);
    std::vector<halftone::StackLayer> layers = layers_of(sequence, setting);
    return {std::move(sequence), std::move(setting), std::move(layers)};
}

StackLight layered_light(const NamedStack& stack, const optics::LayerPathOptions& tracing, Progress& progress) {
    const StackSetting& setting = stack.setting;
    if (setting.traceable())
        return optics::layered_light(*setting.resins(), setting.resin_layers(stack.layers), setting.ends(),
                                     setting.grid(), tracing, &progress);
    double mm = 0;
    for (const halftone::StackLayer& layer : stack.layers) mm += layer.thickness_mm;
    return profiles_of(setting, stack.layers, setting.materials(0, mm, tracing, progress));
}

StackLight traced_light(const NamedStack& stack, const optics::LayerPathOptions& tracing, Progress& progress) {
    const StackSetting& setting = stack.setting;
    VOXTONE_EXPECT(setting.traceable());
    return optics::traced_light(*setting.resins(), setting.resin_layers(stack.layers), setting.ends(), setting.grid(),
                                tracing, &progress);
}

// Half as wide a blur as pictures have: it takes the ripples of a series that ends down to 6 %, and of what coarser
// grids can see next to nothing.
optics::RadialSamples profile_samples(const optics::HankelGrid& grid, const std::vector<double>& coefficients) {
    const std::size_t n = 2 * grid.size();
    const std::vector<double> soft =
        grid.blurred(coefficients, blur * grid.reach_mm() / static_cast<double>(grid.size()));
    optics::RadialSamples samples;
    samples.spacing_mm = grid.reach_mm() / static_cast<double>(n);
    for (std::size_t i = 0; i <= n; ++i)
        samples.light.push_back(
            grid.profile(soft, std::min(grid.reach_mm(), static_cast<double>(i) * samples.spacing_mm)));
    samples.total = std::clamp(coefficients[0], 0.0, 1.0);
    return samples;
}

}  // namespace voxtone::slicer
