// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of a lit point on a slab that was never printed: to rehearse the measurement of scattering profiles, and
// to test it against a truth that is known.
//
// The slab: one resin, traced (optics/profiles/resin_profile.h). Light: an even disc (projected pixel, pinhole) of
// white light, and stray light, from a projector's black, that falls off evenly across the picture. Camera: a Gaussian
// blur, square pixels, shot and read noise, black level, saturation, quantisation.
//
// Simpler than the world: light enters the slab diffusely, its surface neither mirrors nor refracts, the camera is
// straight above and sees light that left to all sides, nothing wanders with time, and every pixel sees all three
// colours.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/spot/exposure_series.h"
#include "optics/media/resins.h"
#include "optics/numerics/hankel.h"
#include "optics/profiles/measured_profile.h"

namespace voxtone::calibration {

struct SpotCamera {
    std::vector<double> seconds{1.0 / 15, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1, 2, 4, 8, 15, 30};  ///< rising
    std::uint32_t size_px = 400;  ///< edge of the square picture, 64 to 4000
    double mm_per_px = 0.04;
    Eigen::Vector2d offset_px{3.3, -2.6};  ///< of the spot from the picture's middle
    double spot_mm = 0.06;                 ///< radius of the disc that is lit
    double stretch = 1;                    ///< width of what is seen over its height: 1 for a camera straight above
    double blur_mm = 0.05;                 ///< standard deviation of the camera's blur
    double stray = 1e-4;                   ///< stray light, part of the light in the middle of the spot
    double peak = 0.7;                     ///< the brightest pixel at the shortest exposure, part of full scale
    double full_well = 20000;              ///< electrons at full scale: shot noise; 0: no noise at all
    double read_noise = 2e-4;              ///< standard deviation, part of full scale
    double black = 0.01;                   ///< what the camera writes without light, part of full scale
    int bits = 14;                         ///< of a sample, 8 to 16
    std::uint64_t seed = 1;

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
    /// As far as any pixel lies from the spot, and somewhat further; as many coefficients as the blur needs.
    [[nodiscard]] optics::HankelGrid grid() const;
};

/// Hankel coefficients of a slab, [channel]; the first are its albedos.
struct SlabProfiles {
    std::array<std::vector<double>, 3> R, T;
};

/// `set` is RGB. Throws InputError.
[[nodiscard]] SlabProfiles slab_profiles(const optics::ResinSet& set, const std::string& role, double thickness_mm,
                                         const optics::HankelGrid& grid, std::uint32_t paths, std::uint64_t seed,
                                         const Progress* progress = nullptr);

/// Photographs in even light, 2 % brighter at the left border than at the right
/// (calibration/spot/albedo_photographs.h).
struct EvenPhotographs {
    Exposure card, card_dark;  ///< slab in the left half, card in the right one
    Exposure slab, screen, lcd_dark;
};
[[nodiscard]] EvenPhotographs even_photographs(const SlabProfiles& slab, double card_albedo, const SpotCamera& camera);

/// One side of a slab before the camera.
class SpotScene {
public:
    /// Coefficients of one side of a slab on `camera.grid()`.
    SpotScene(const std::array<std::vector<double>, 3>& side, const SpotCamera& camera);

    /// The same bits for any number of threads. `lit` false: the dark frame.
    [[nodiscard]] Exposure photograph(std::size_t exposure, bool lit) const;
    /// What there is to be measured: light per mm^2 of one unit that entered, seen through spot, blur and pixel.
    [[nodiscard]] double light(std::size_t channel, double r_mm) const;
    [[nodiscard]] optics::RadialSamples truth(std::size_t channel, double spacing_mm, std::size_t samples) const;
    [[nodiscard]] Eigen::Vector2d centre_px() const;

private:
    SpotCamera camera_;
    double step_mm_;                                   ///< of the tables
    std::array<std::vector<double>, 3> sharp_, seen_;  ///< through spot and blur; through the pixel too
    std::array<double, 3> total_;
    double gain_;  ///< full scale per second of light per mm^2
};

}  // namespace voxtone::calibration
