// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a ray in the air meets first, and what the light sends along it, for one channel at a time. Light is the sky, or
// a beam in its place.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "optics/camera/camera_scene.h"
#include "optics/monte_carlo/clear_spheres.h"
#include "optics/monte_carlo/path_packets.h"

namespace voxtone::optics {

struct MetInAir {
    enum class What { sky, ground, print, diffuser } what = What::sky;
    std::size_t print = 0;  ///< which
    double distance = 0;
    BoundaryNormals normals;
    double eta = 1;       ///< of a print
    Light reflectance{};  ///< of diffusers
    Coat coat{};          ///< over them
};

/// Share of even light from all sides that a smooth surface mirrors: 2 times the integral of mu F(mu) over (0, 1).
[[nodiscard]] double mean_reflectance(double eta);

/// A scene made ready for paths.
class LitScene {
public:
    /// Throws InputError where a material has no resin.
    explicit LitScene(const CameraScene& scene);

    [[nodiscard]] std::size_t channels() const { return light_.size(); }
    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] const Light& light(const Point& from, const Point& way) const {
        return scene_.beam ? scene_.beam->radiance(from, way) : scene_.sky->radiance(in_sky(way));
    }
    /// A direction drawn by the light's luminance, and the density of any.
    [[nodiscard]] Point draw_light(double pixel, double u, double v) const;
    [[nodiscard]] double light_density(const Point& way) const {
        return scene_.beam ? scene_.beam->density(way) : scene_.sky->density(in_sky(way));
    }
    [[nodiscard]] std::size_t prints() const { return volumes_.size(); }
    [[nodiscard]] const ResinBody& print(std::size_t i) const { return scene_.prints[i]; }
    [[nodiscard]] const PathVolume& volume(std::size_t i) const { return volumes_[i]; }
    [[nodiscard]] const PacketScene& packets(std::size_t i, std::size_t channel) const {
        return packets_[i * channels() + channel];
    }
    /// Share of each channel in luminance.
    [[nodiscard]] const std::vector<double>& luminance_weights() const { return derived_.back(); }
    /// What is made of the channels, each by weights of them: linear sRGB where they are something else, luminance.
    [[nodiscard]] const std::vector<std::vector<double>>& derived() const { return derived_; }

    [[nodiscard]] MetInAir met(const Point& from, const Point& way) const;
    [[nodiscard]] bool sees_sky(const Point& from, const Point& way) const;
    /// Of a light or a reflectance in linear sRGB: what a channel has of it, by weights that sum to 1, so that it is
    /// exact for what is grey. Channels of wavelengths take red from 580 nm, blue below 490 nm, green between; a
    /// printer's own are seen together as the colour that was asked for, unless it is so saturated that a channel
    /// would have less than nothing of it: 0 then.
    [[nodiscard]] double in_channel(const Light& light, std::size_t channel) const {
        const Light& share = light_[channel];
        return std::max(0.0, share[0] * light[0] + share[1] * light[1] + share[2] * light[2]);
    }

private:
    /// Of a print where it is met, its own coordinates: of the resin there.
    [[nodiscard]] double eta_at(std::size_t print, const Point& at, const BoundaryNormals& normals) const;
    [[nodiscard]] Point in_sky(const Point& way) const {
        const auto& axes = scene_.sky_axes;
        return {dot(way, axes[0]), dot(way, axes[1]), dot(way, axes[2])};
    }

    CameraScene scene_;
    Camera camera_;
    std::vector<Light> light_;  ///< shares of R, G and B in a channel's light
    std::vector<std::vector<double>> derived_;
    std::vector<PathVolume> volumes_;
    std::vector<ClearSpheres> spheres_;
    std::vector<PacketScene> packets_;
};

}  // namespace voxtone::optics
