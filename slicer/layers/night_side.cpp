// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/night_side.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "halftone/separation/cube_root_lattice.h"
#include "optics/colour/observed_colour.h"
#include "slicer/surface/area_samples.h"

namespace voxtone::slicer {
namespace {

constexpr std::size_t night_edge = 9;  // even in the cube root of linear channels

optics::ShellGeometry night_geometry(const optics::ShellAppearance& day, double thickness_mm, int clear) {
    optics::ShellGeometry geometry = day.geometry();
    const double core_mm = thickness_mm - 2 * geometry.shell_mm;
    if (!(core_mm > 0))
        throw InputError(
            fmt::format("--view both: the slab is {:.3g} mm thick, and colours of day and night take {:.3g} mm each: "
                        "nothing is left between them; give a larger --thickness, or a smaller --depth",
                        thickness_mm, geometry.shell_mm));
    geometry.core_mm = core_mm;
    geometry.backing = optics::Backing::none;
    geometry.sheet.clear();
    geometry.from_behind = true;
    geometry.white_resin = clear;
    return geometry;
}

io::TexturedMesh slab_of_night(io::TexturedMesh slab, std::shared_ptr<const io::Texture> picture) {
    slab.materials.front().texture = std::move(picture);
    return slab;
}

halftone::SeparationOptions night_options(const optics::ShellAppearance& appearance) {
    halftone::SeparationOptions options;
    options.channels = appearance.set().channels;
    return options;
}

double lamp_luminance(const Eigen::Vector3f& rgb) {
    return 0.2126 * double(rgb.x()) + 0.7152 * double(rgb.y()) + 0.0722 * double(rgb.z());  // IEC 61966-2-1
}

/// Luminance of the night's picture, and what the day lets through of a lamp's.
struct Place {
    double asked, through;
};

/// The level at which lightness, about the cube root of luminance, is shown best: a high one leaves what is light out
/// of reach, a low one drowns what is dark in what the darkest night lets through.
double best_gain(const std::vector<Place>& places, double floor) {
    constexpr int steps = 60;
    constexpr double least = 1e-3;
    double best = 1, least_error = std::numeric_limits<double>::infinity();
    for (int step = 0; step <= steps; ++step) {
        const double gain = std::pow(least, double(step) / steps);
        double error = 0;
        for (const auto& [asked, through] : places) {
            const double shown = std::clamp(gain * asked / through, floor, 1.0) * through / gain;
            error += std::pow(std::cbrt(shown) - std::cbrt(asked), 2);
        }
        if (error < least_error) best = gain, least_error = error;
    }
    return best;
}

}  // namespace

NightSide::NightSide(const optics::ShellAppearance& day, const halftone::Separation& day_separation,
                     const SurfaceColour& day_colour, const VisibleSurface& surface, const io::TexturedMesh& slab,
                     std::shared_ptr<const io::Texture> picture, double thickness_mm, double spacing_mm, int clear)
    : day_mm_(static_cast<float>(day.geometry().shell_mm)),
      from_mm_(static_cast<float>(thickness_mm - day.geometry().shell_mm)),
      mesh_(slab_of_night(slab, std::move(picture))),
      appearance_(day.set(), night_geometry(day, thickness_mm, clear)),
      separation_(appearance_, night_options(appearance_)),
      colour_(mesh_, spacing_mm),
      lattice_(night_edge * night_edge * night_edge) {
    const optics::ObservedColour<double> observed(day.set().channels);
    const auto seen = [&](const std::vector<double>& fractions) {
        const std::vector<double> through = appearance_.appearance(fractions);
        return Eigen::Vector3f(observed.relative(through.data(), appearance_.white_appearance().data()).cast<float>());
    };
    std::vector<double> all_clear(day.resins(), 0.0);
    all_clear[static_cast<std::size_t>(clear)] = 1;
    brightest_ = seen(all_clear);
    const auto at = [](std::size_t n) { return float(std::pow(double(n) / (night_edge - 1), 3)); };
    parallel_for(0, lattice_.size(), 1, [&](std::size_t i) {
        const Eigen::Vector3f rgb(at(i / (night_edge * night_edge)), at(i / night_edge % night_edge),
                                  at(i % night_edge));
        lattice_[i] = seen(day_separation.fractions(rgb)).cwiseQuotient(brightest_).cwiseMax(1e-4f).cwiseMin(1.0f);
    });

    constexpr std::uint64_t samples = 4'000;
    const AreaSamples points(surface);
    std::vector<Place> places;
    for (std::uint64_t i = 0; i < samples; ++i) {
        const auto [t, u, v] = points.at(1, i);
        const Eigen::Vector2f uv = float(1 - u - v) * surface.source_uv[t][0] + float(u) * surface.source_uv[t][1] +
                                   float(v) * surface.source_uv[t][2];
        const std::uint32_t source = surface.source_triangle[t];
        places.push_back({lamp_luminance(asked(source, uv.x(), uv.y())),
                          lamp_luminance(let_through(day_colour.at(source, uv.x(), uv.y())))});
    }
    const Eigen::Vector3f darkest = separation_.predicted(Eigen::Vector3f::Zero()).cast<float>();
    const double floor = std::max(lamp_luminance(darkest), 0.0) / lamp_luminance(brightest_);
    gain_ = static_cast<float>(best_gain(places, floor));
    for (const Place& place : places) beyond_ += double(gain_) * place.asked > place.through;
    beyond_ /= double(places.size());
}

Eigen::Vector3f NightSide::let_through(const Eigen::Vector3f& day) const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    halftone::for_nodes_around(day, night_edge,
                               [&](std::size_t node, float weight) { sum += weight * lattice_[node]; });
    return sum;
}

Eigen::Vector3f NightSide::wanted(const Eigen::Vector3f& asked, const Eigen::Vector3f& day) const {
    return (gain_ * asked).cwiseQuotient(let_through(day)).cwiseMin(1.0f).cwiseProduct(brightest_);
}

}  // namespace voxtone::slicer
