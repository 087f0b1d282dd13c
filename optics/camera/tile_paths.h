// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light paths of some pixels: from the camera through the air and the prints to the light.
//
// In the air all channels go one way, and one path carries them; in a print each has its own extinctions, so that a
// path that enters becomes one of each channel. Where a print is what the camera sees first, channels that make little
// of the luminance are sent in with fewer samples: every second, every fourth, which then count twice, four times.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "optics/camera/lit_scene.h"

namespace voxtone::optics {

/// Numbers of samples repeat what they are for after as many.
inline constexpr std::uint32_t bundle_samples = 4;

/// Of each channel: one sample in how many enters prints for it, 1, 2 or 4. The largest for which its weight in
/// luminance, times that, is no more than the largest weight.
[[nodiscard]] std::vector<std::uint32_t> channel_periods(std::span<const double> luminance_weights);

class TilePaths : private PathSource {
public:
    TilePaths(const LitScene& scene, std::span<const std::uint32_t> periods, std::uint64_t seed);

    /// Begins in pixel (x, y) as number `number` of it.
    struct Sample {
        int x = 0, y = 0;
        std::uint32_t number = 0;
    };
    void trace(std::span<const Sample> samples);

    // Of the samples traced last:
    /// What comes back, times `share`.
    [[nodiscard]] double radiance(std::size_t sample, std::size_t channel) const;
    /// As how many samples it counts in a channel: 1 on average, 0 where it was not sent.
    [[nodiscard]] double share(std::size_t sample, std::size_t channel) const {
        return share_[sample * periods_.size() + channel];
    }
    /// Where in its pixel it began, [0, 1).
    [[nodiscard]] const std::array<double, 2>& place(std::size_t sample) const { return place_[sample]; }

private:
    /// A part of a path between bodies.
    struct AirRay {
        Point from{}, way{};
        double weight = 1;
        double density = 0;  ///< of its direction, per steradian, where the sky was asked besides; else 0
        std::uint32_t sample = 0;
        int order = 0;             ///< surfaces met before
        std::int32_t channel = 0;  ///< or all of them, by colour_
        std::int32_t purpose = 0;  ///< of its random numbers, where it carries all
    };
    /// A path about to go on within a print.
    struct Inside {
        PathStart start;
        double weight = 1;
        std::uint32_t sample = 0;
        int order = 0;
    };
    struct Gone {
        std::uint32_t tag;
        float weight;
        PathExit exit;
    };

    bool next(PathStart& start) override;
    void finished(std::uint32_t, float, const std::array<float, 3>&) override {}
    void left(std::uint32_t tag, float weight, const PathExit& exit) override { gone_.push_back({tag, weight, exit}); }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>&) override { return {0, 0, 1}; }

    /// The numbers of a ray of all channels; or of one of its channels within a print.
    [[nodiscard]] PathRandom random_of(const AirRay& ray, std::uint32_t channel = ~1u) const;
    void begin(std::uint32_t sample);
    void trace_print(std::size_t print, std::size_t channel);
    void first_surface(const AirRay& ray, const MetInAir& met);
    void first_rough(const AirRay& ray, const MetInAir& met, const Point& at, double roughness, PathRandom& random);
    void mirror(const AirRay& ray, const Point& at, const Point& way, double share, int which);
    void follow(AirRay ray, PathRandom& random);
    void follow(AirRay ray, MetInAir met, PathRandom& random);
    [[nodiscard]] bool goes_on(AirRay& ray, PathRandom& random) const;
    void first_coat(AirRay ray, const MetInAir& met, PathRandom& random);
    bool coated(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random);
    bool diffuse(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random);
    bool mirrored_again(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random);
    void enter(const AirRay& ray, const MetInAir& met, const Point& at, const Point& way, double share,
               PathRandom& random);
    void enter_in(std::size_t channel, const AirRay& ray, const MetInAir& met, const Point& at, const Point& way,
                  double weight, PathRandom& random);
    void count(const AirRay& ray, const Light& light, double factor);
    void colour_as_sent(const AirRay& ray);
    void colour_by(AirRay& ray, const Light& reflectance);

    const LitScene& scene_;
    std::vector<std::uint32_t> periods_;
    std::uint64_t seed_;
    std::vector<std::uint64_t> radiance_;  ///< per sample and channel, whole numbers: sums in any order
    std::vector<double> share_;
    std::vector<std::array<double, 2>> place_;
    std::span<const Sample> samples_;
    std::vector<double> colour_;                ///< per channel: of the ray of all channels that is under way
    std::vector<std::vector<Inside>> waiting_;  ///< per print and channel
    std::vector<Inside> inside_;
    std::size_t next_ = 0;
    std::vector<Gone> gone_;
};

}  // namespace voxtone::optics
