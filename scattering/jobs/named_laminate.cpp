// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/named_laminate.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "optics/profiles/resin_profile.h"
#include "optics/profiles/wave_laminates.h"
#include "scattering/design/laminate_materials.h"

namespace voxtone::scattering {
namespace {

using optics::LaminateLight;

constexpr double blur = 0.75;  // of reach / n

LaminateSetting setting_of(const NamedLaminateOptions& given, const io::LayerSequence& sequence) {
    LaminateSettingOptions options;
    for (const io::SequenceLayer& layer : sequence.layers)
        if (std::find(options.materials.begin(), options.materials.end(), layer.material) == options.materials.end())
            options.materials.push_back(layer.material);
    options.resins = sequence.resins;
    options.surface = sequence.surface;
    options.backing = sequence.backing;
    options.reach_mm = given.reach_mm;
    options.coefficients = given.coefficients;
    return LaminateSetting(options);
}

std::vector<LaminateLayer> layers_of(const io::LayerSequence& sequence, const LaminateSetting& setting) {
    std::vector<LaminateLayer> layers;
    for (const io::SequenceLayer& layer : sequence.layers) {
        const auto material = std::find(setting.names().begin(), setting.names().end(), layer.material);
        layers.push_back({static_cast<std::size_t>(material - setting.names().begin()), layer.mm});
    }
    return layers;
}

// Of measured profiles, or on a measured backing: the surface is a layer of its own.
LaminateLight profiles_of(const LaminateSetting& setting, std::span<const LaminateLayer> layers,
                          const std::vector<LaminateMaterial>& materials) {
    LaminateLight light;
    const std::size_t n = setting.grid().size();
    for (std::size_t c = 0; c < setting.channels().size(); ++c) {
        optics::LayerProfile all = optics::smooth_surface(setting.ends().eta_top, n);
        for (const LaminateLayer& layer : layers)
            all = optics::laminate(all, materials[layer.material][c].of_thickness(layer.thickness_mm));
        if (setting.ends().eta_bottom > 1) {
            all = optics::laminate(all, optics::turned_over(optics::smooth_surface(setting.ends().eta_bottom, n)));
        } else if (!setting.backing_reflection().empty()) {
            const std::vector<double>& R = setting.backing_reflection()[c];
            all = optics::laminate(all, {std::vector<double>(n, 1.0), R, R});
        }
        light.R.push_back(all.R_top);
        light.T.push_back(all.T);
    }
    light.R_error.assign(light.R.size(), 0.0);
    light.T_error = light.R_error;
    return light;
}

}  // namespace

io::LayerSequence read_named_sequence(const std::string& laminate, const NamedLaminateOptions& options) {
    io::LayerSequence sequence;
    if (std::filesystem::path(laminate).extension() == ".json" && laminate.find_first_of(" ,") == std::string::npos) {
        sequence = io::read_layer_sequence(laminate);
    } else {
        sequence.name = laminate;
        sequence.layers = io::parse_layers(laminate);
        sequence.resins = "vero-opaque";
        sequence.surface = "auto";
    }
    if (!options.resins.empty()) sequence.resins = options.resins;
    if (!options.surface.empty()) sequence.surface = options.surface;
    if (!options.backing.empty()) sequence.backing = options.backing;
    if (sequence.layers.empty())
        throw InputError(fmt::format("{}: has no layer; there is nothing to predict or print", laminate));
    return sequence;
}

NamedLaminate read_named_laminate(const std::string& laminate, const NamedLaminateOptions& options) {
    io::LayerSequence sequence = read_named_sequence(laminate, options);
    LaminateSetting setting = setting_of(options, sequence);
    std::vector<LaminateLayer> layers = layers_of(sequence, setting);
    return {std::move(sequence), std::move(setting), std::move(layers)};
}

LaminateLight layered_light(const NamedLaminate& laminate, const optics::LayerPathOptions& tracing,
                            Progress& progress) {
    const LaminateSetting& setting = laminate.setting;
    if (setting.traceable())
        return optics::layered_light(*setting.resins(), setting.resin_layers(laminate.layers), setting.ends(),
                                     setting.grid(), &progress);
    double mm = 0;
    for (const LaminateLayer& layer : laminate.layers) mm += layer.thickness_mm;
    return profiles_of(setting, laminate.layers, setting.materials(0, mm, tracing, progress));
}

LaminateLight traced_light(const NamedLaminate& laminate, const optics::LayerPathOptions& tracing, Progress& progress) {
    const LaminateSetting& setting = laminate.setting;
    VOXTONE_EXPECT(setting.traceable());
    return optics::traced_light(*setting.resins(), setting.resin_layers(laminate.layers), setting.ends(),
                                setting.grid(), tracing, &progress);
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

}  // namespace voxtone::scattering
