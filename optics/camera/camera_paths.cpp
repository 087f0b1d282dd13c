// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/camera/camera_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/camera/lit_scene.h"
#include "voxtone/optics/monte_carlo/adaptive_sampling.h"
#include "voxtone/optics/monte_carlo/rough_boundary.h"
#include "voxtone/optics/monte_carlo/scalar_paths.h"

namespace voxtone::optics {
namespace {

/// A part of a path between bodies.
struct AirRay {
    Point from{}, way{};
    double weight = 1;
    double density = 0;        ///< of its direction, per steradian, where the sky was asked besides; else 0
    std::uint32_t sample = 0;  ///< of the tile
    int order = 0;             ///< surfaces met before
};

// Stand-ins for a cell's third coordinate: what a random number of a sample is for.
enum Purpose : std::int32_t { of_place = 0, of_path = 1, of_mirrored = 2 };

/// Surfaces that a path may meet in air before Russian roulette by order (probability 1/2, twice the weight): unbiased.
constexpr int patient_orders = 32;

/// Facets drawn at the first surface where it is rough, so that its highlights are not left to chance.
constexpr int facets_at_first = 8;

/// The paths of some pixels in one channel.
class TilePaths : public PathSource {
public:
    TilePaths(const LitScene& scene, std::uint64_t seed, std::size_t channel)
        : scene_(scene), seed_(seed), channel_(channel), waiting_(scene.prints()) {}

    /// Sample s begins at pixel (x, y) as number `number` of that pixel.
    struct Sample {
        int x = 0, y = 0;
        std::uint32_t number = 0;
    };
    /// What comes back along the paths of each sample.
    const std::vector<std::uint64_t>& trace(std::span<const Sample> samples) {
        radiance_.assign(samples.size(), 0);
        for (std::uint32_t s = 0; s < samples.size(); ++s) {
            sample_ = samples[s];
            PathRandom place(seed_, {{sample_.x, sample_.y, of_place}, ~0u, sample_.number});
            const double dx = place.uniform(), dy = place.uniform();
            AirRay ray;
            ray.from = scene_.camera().position();
            ray.way = scene_.camera().direction(sample_.x + dx, sample_.y + dy);
            ray.sample = s;
            first_surface(ray);
        }
        for (bool more = true; more;) {
            more = false;
            for (print_ = 0; print_ < waiting_.size(); ++print_) {
                if (waiting_[print_].empty()) continue;
                more = true;
                trace_print();
            }
        }
        return radiance_;
    }

    bool next(PathStart& start) override {
        if (next_ == inside_.size()) return false;
        start = inside_[next_].start;
        start.tag = static_cast<std::uint32_t>(next_++);
        return true;
    }
    void finished(std::uint32_t, float, const std::array<float, 3>&) override {}
    void left(std::uint32_t tag, float weight, const PathExit& exit) override { gone_.push_back({tag, weight, exit}); }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>&) override { return {0, 0, 1}; }

private:
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

    void trace_print() {
        inside_ = std::move(waiting_[print_]);
        waiting_[print_].clear();
        next_ = 0;
        gone_.clear();
        trace_packets(scene_.packets(print_, channel_), *this);
        // The order in which paths end is that of the machine's lanes; what they do then is not to depend on it.
        for (const Gone& gone : gone_) {
            const Inside& before = inside_[gone.tag];
            AirRay ray;
            for (std::size_t a = 0; a < 3; ++a) ray.from[a] = gone.exit.at[a] + scene_.print(print_).corner_mm[a];
            ray.way = gone.exit.way;
            ray.weight = before.weight * static_cast<double>(gone.weight);
            ray.sample = before.sample;
            ray.order = before.order + 1;
            PathRandom random(gone.exit.random);
            follow(ray, random);
        }
    }

    void count(const AirRay& ray, double light) { radiance_[ray.sample] += in_units(ray.weight * light); }
    [[nodiscard]] double sky(const Point& way) const { return scene_.in_channel(scene_.sky(way), channel_); }

    void first_surface(const AirRay& ray) {
        PathRandom random(seed_,
                          {{sample_.x, sample_.y, of_path}, static_cast<std::uint32_t>(channel_), sample_.number});
        const MetInAir met = scene_.met(ray.from, ray.way);
        if (met.what != MetInAir::What::print) return follow(ray, random);
        const ResinBody& print = scene_.print(met.print);
        const Point at = along(ray.from, ray.way, met.distance);
        const double roughness = roughness_at(print, at, met);
        if (roughness > 0) return first_rough(ray, met, at, roughness, random);
        const MetFromOutside parts = meet_from_outside(met.normals, print.scene->resins->eta, ray.way);
        mirror(ray, at, parts.reflected, parts.reflectance, 0);
        enter(ray, met, at, parts.refracted, 1 - parts.reflectance, random);
    }
    /// Many facets: those that mirror are all followed, of those that let in one.
    void first_rough(const AirRay& ray, const MetInAir& met, const Point& at, double roughness, PathRandom& random) {
        const double eta = scene_.print(met.print).scene->resins->eta;
        Point kept{};
        int through = 0;
        for (int k = 0; k < facets_at_first; ++k) {
            Point way = ray.way;
            if (!cross_boundary(met.normals, eta, roughness, false, way, random))
                mirror(ray, at, way, 1.0 / facets_at_first, k);
            else if (random.uniform() * ++through < 1)
                kept = way;
        }
        if (through > 0) enter(ray, met, at, kept, double(through) / facets_at_first, random);
    }
    void mirror(const AirRay& ray, const Point& at, const Point& way, double share, int which) {
        AirRay mirrored = ray;
        mirrored.from = at;
        mirrored.way = way;
        mirrored.weight *= share;
        mirrored.order = 1;
        PathRandom random(
            seed_, {{sample_.x, sample_.y, of_mirrored + which}, static_cast<std::uint32_t>(channel_), sample_.number});
        follow(mirrored, random);
    }

    [[nodiscard]] static double roughness_at(const ResinBody& print, const Point& at, const MetInAir& met) {
        if (!print.finish) return 0;
        return print.finish->roughness(along(at, print.corner_mm, -1), met.normals.geometric);
    }

    /// Until the path is in a print or over.
    void follow(AirRay ray, PathRandom& random) {
        for (;; ++ray.order) {
            // What the first surface mirrors is worth its while however little it is: highlights would be grainy.
            if (ray.order > 2 && !survives_roulette_by_weight(ray.weight, default_roulette_weight, random)) return;
            if (ray.order >= patient_orders) {
                if (random.uniform() < 0.5) return;
                ray.weight *= 2;
            }
            const MetInAir met = scene_.met(ray.from, ray.way);
            if (met.what == MetInAir::What::sky) {
                const double asked = ray.density > 0 ? scene_.sky_density(ray.way) : 0.0;
                return count(ray, sky(ray.way) * (ray.density > 0 ? ray.density / (ray.density + asked) : 1.0));
            }
            const Point at = along(ray.from, ray.way, met.distance);
            if (met.what != MetInAir::What::print) {
                if (!diffuse(ray, met, at, random)) return;
                continue;
            }
            if (!mirrored_again(ray, met, at, random)) return;
        }
    }

    /// Light that a diffuser takes from the sky counts at once; the path goes on by the cosine law about the shading
    /// normal. False where that would lead into the body.
    bool diffuse(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random) {
        const Point& n = met.normals.shading;
        const Point& true_normal = met.normals.geometric;
        ray.weight *= scene_.in_channel(met.reflectance, channel_);
        ray.from = at;
        const double pixel = random.uniform(), u = random.uniform(), v = random.uniform();
        const Point up = scene_.draw_sky(pixel, u, v);
        const double cosine = dot(up, n);
        if (cosine > 0 && dot(up, true_normal) > 0 && scene_.sees_sky(at, up)) {
            const double drawn = scene_.sky_density(up), law = cosine / std::numbers::pi;
            count(ray, law * sky(up) / (drawn + law));
        }
        const double r = std::sqrt(random.uniform()), phi = 2 * std::numbers::pi * random.uniform();
        const double height = std::sqrt(std::max(0.0, 1 - r * r));
        ray.way = entering_direction({n, n}, {-height, r * std::cos(phi), r * std::sin(phi)});
        ray.density = std::max(dot(ray.way, n) / std::numbers::pi, 1e-12);
        return dot(ray.way, true_normal) > 0;
    }

    /// At a print that is not the first surface chance decides; false where the path went in.
    bool mirrored_again(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random) {
        const ResinBody& print = scene_.print(met.print);
        const double eta = print.scene->resins->eta, roughness = roughness_at(print, at, met);
        Point way = ray.way;
        bool through = false;
        if (roughness > 0) {
            through = cross_boundary(met.normals, eta, roughness, false, way, random);
        } else {
            const MetFromOutside parts = meet_from_outside(met.normals, eta, ray.way);
            through = random.uniform() >= parts.reflectance;
            way = through ? parts.refracted : parts.reflected;
        }
        if (through) {
            enter(ray, met, at, way, 1, random);
            return false;
        }
        ray.from = at;
        ray.way = way;
        ray.density = 0;
        return true;
    }

    void enter(const AirRay& ray, const MetInAir& met, const Point& at, const Point& way, double share,
               PathRandom& random) {
        const ResinBody& print = scene_.print(met.print);
        const PathVolume& volume = scene_.volume(met.print);
        const auto& pitch = print.scene->volume->pitch_mm();
        Inside in;
        for (std::size_t a = 0; a < 3; ++a) {
            const double inward = at[a] - print.corner_mm[a] - inside_boundary_mm * met.normals.geometric[a];
            in.start.at[a] = std::clamp(static_cast<float>(inward / pitch[a] + volume.offset()), 0.0f,
                                        static_cast<float>(volume.size()[a]));
            in.start.voxel[a] = std::min(static_cast<int>(in.start.at[a]), volume.size()[a] - 1);
            in.start.direction[a] = safe_component(way[a]);
        }
        in.start.depth = static_cast<float>(-std::log1p(-random.uniform()));
        in.start.random = random.state();
        in.weight = ray.weight * share;
        in.sample = ray.sample;
        in.order = ray.order;
        waiting_[met.print].push_back(in);
    }

    const LitScene& scene_;
    std::uint64_t seed_;
    std::size_t channel_;
    Sample sample_;
    std::vector<std::uint64_t> radiance_;       ///< per sample, whole numbers: sums in any order
    std::vector<std::vector<Inside>> waiting_;  ///< per print
    std::size_t print_ = 0, next_ = 0;
    std::vector<Inside> inside_;
    std::vector<Gone> gone_;
};

/// Sums over the samples drawn so far.
class Exposure {
public:
    Exposure(const LitScene& scene, const CameraOptions& options, CameraPicture& picture)
        : scene_(scene), options_(options), picture_(picture) {
        const auto pixels = static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px);
        sum_.resize(pixels * picture.channels);
        squares_.resize(pixels * picture.channels);
        picture.samples.resize(pixels);
        const auto in_tiles = [](int px) { return (px + CameraPicture::tile_px - 1) / CameraPicture::tile_px; };
        across_ = in_tiles(picture.width_px);
        wanted_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>(in_tiles(picture.height_px)),
                       options.samples);
    }

    /// Draws until every tile has what it wants: what is sure first, then by what the spread so far says.
    void draw(Progress& progress) {
        while (const std::uint64_t steps = steps_left()) {
            progress.begin_stage("draw", steps, "samples of a square");
            const std::uint32_t most = *std::max_element(wanted_.begin(), wanted_.end());
            for (std::uint32_t level = std::min(first_round, most);; level = next_level(level)) {
                parallel_for(
                    0, wanted_.size(), 1,
                    [&](std::size_t tile) { raise(tile, std::min(level, wanted_[tile]), progress); }, &progress);
                if (level >= most) break;
            }
            progress.end_stage();
            if (options_.error > 0) plan();
            if (steps_left() > 0) progress.note(what_is_wanted());
        }
    }

    [[nodiscard]] std::string what_is_wanted() const {
        return fmt::format("for an error of {:g} up to {} samples a pixel are wanted, {:.0f} on average",
                           options_.error, *std::max_element(wanted_.begin(), wanted_.end()),
                           std::accumulate(wanted_.begin(), wanted_.end(), 0.0) / double(wanted_.size()));
    }

    void finish() {
        const std::size_t channels = picture_.channels;
        picture_.value.assign(sum_.size(), 0);
        picture_.standard_error.assign(sum_.size(), 0);
        double squares = 0;
        std::size_t seen = 0;
        for (std::size_t p = 0; p < picture_.samples.size(); ++p) {
            const double n = picture_.samples[p];
            if (n < 1) continue;
            for (std::size_t c = 0; c < channels; ++c) {
                picture_.value[p * channels + c] = static_cast<float>(sum_[p * channels + c] / n);
                picture_.standard_error[p * channels + c] = static_cast<float>(std::sqrt(variance(p, c)));
            }
            picture_.paths += static_cast<std::uint64_t>(n) * channels;
            if (picture_.sees[p] < 2) continue;
            squares += luminance_variance(p);
            ++seen;
        }
        picture_.rms_error = seen > 0 ? std::sqrt(squares / double(seen)) : 0;
    }

private:
    static constexpr std::uint32_t first_round = 4, in_one_go = 8;
    static std::uint32_t next_level(std::uint32_t level) { return level + std::clamp(level, 4u, 64u); }

    /// Of a pixel's mean.
    [[nodiscard]] double variance(std::size_t pixel, std::size_t channel) const {
        const double n = picture_.samples[pixel];
        if (n < 2) return 0;
        const std::size_t i = pixel * picture_.channels + channel;
        const double mean = sum_[i] / n;
        return std::max(0.0, squares_[i] / n - mean * mean) / (n - 1);
    }
    [[nodiscard]] double luminance_variance(std::size_t pixel) const {
        double sum = 0;
        for (std::size_t c = 0; c < picture_.channels; ++c) {
            const double w = scene_.luminance_weights()[c];
            sum += w * w * variance(pixel, c);
        }
        return sum;
    }

    template <class Visit>
    void each_pixel(std::size_t tile, Visit&& visit) const {
        const int edge = CameraPicture::tile_px;
        const int x0 = static_cast<int>(tile % static_cast<std::size_t>(across_)) * edge,
                  y0 = static_cast<int>(tile / static_cast<std::size_t>(across_)) * edge;
        for (int y = y0; y < std::min(y0 + edge, picture_.height_px); ++y)
            for (int x = x0; x < std::min(x0 + edge, picture_.width_px); ++x)
                visit(x, y,
                      static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width_px) +
                          static_cast<std::size_t>(x));
    }

    [[nodiscard]] std::uint32_t drawn(std::size_t tile) const {
        std::uint32_t samples = 0;
        each_pixel(tile, [&](int, int, std::size_t pixel) { samples = picture_.samples[pixel]; });
        return samples;
    }
    [[nodiscard]] std::uint64_t steps_left() const {
        std::uint64_t steps = 0;
        for (std::size_t tile = 0; tile < wanted_.size(); ++tile) steps += wanted_[tile] - drawn(tile);
        return steps;
    }

    /// A tile's samples up to so many.
    void raise(std::size_t tile, std::uint32_t level, Progress& progress) {
        for (std::uint32_t from = drawn(tile); from < level;) {
            progress.check_cancelled();
            const std::uint32_t count = std::min(in_one_go, level - from);
            add(tile, from, count);
            from += count;
            progress.advance(count);
        }
    }

    void add(std::size_t tile, std::uint32_t from, std::uint32_t count) {
        std::vector<TilePaths::Sample> samples;
        each_pixel(tile, [&](int x, int y, std::size_t) {
            for (std::uint32_t s = 0; s < count; ++s) samples.push_back({x, y, from + s});
        });
        for (std::size_t c = 0; c < picture_.channels; ++c) {
            TilePaths paths(scene_, options_.seed, c);
            const std::vector<std::uint64_t>& radiance = paths.trace(samples);
            std::size_t next = 0;
            each_pixel(tile, [&](int, int, std::size_t pixel) {
                for (std::uint32_t s = 0; s < count; ++s) {
                    const double x = static_cast<double>(radiance[next++]) * path_weight_unit;
                    sum_[pixel * picture_.channels + c] += x;
                    squares_[pixel * picture_.channels + c] += x * x;
                }
            });
        }
        each_pixel(tile, [&](int, int, std::size_t pixel) { picture_.samples[pixel] += count; });
    }

    /// Samples that tiles want for their error, from the spread so far.
    void plan() {
        for (std::size_t tile = 0; tile < wanted_.size(); ++tile) {
            double squares = 0;
            std::size_t pixels = 0;
            each_pixel(tile, [&](int, int, std::size_t pixel) {
                squares += luminance_variance(pixel);
                ++pixels;
            });
            const double error = std::sqrt(squares / double(pixels)), ratio = error / options_.error;
            if (ratio <= 1) continue;
            constexpr double spare = 1.05;  // the spread is an estimate, too
            const double more = std::ceil(spare * double(wanted_[tile]) * ratio * ratio);
            wanted_[tile] = static_cast<std::uint32_t>(std::min(more, double(options_.max_samples)));
        }
    }

    const LitScene& scene_;
    const CameraOptions& options_;
    CameraPicture& picture_;
    int across_ = 0;
    std::vector<double> sum_, squares_;
    std::vector<std::uint32_t> wanted_;  ///< per tile
};

std::vector<std::uint8_t> what_is_seen(const LitScene& scene, const Progress& progress) {
    const auto width = static_cast<std::size_t>(scene.camera().width_px());
    std::vector<std::uint8_t> sees(width * static_cast<std::size_t>(scene.camera().height_px()));
    parallel_for(
        0, sees.size(), 4096,
        [&](std::size_t p) {
            const Point way = scene.camera().direction(double(p % width) + 0.5, double(p / width) + 0.5);
            sees[p] = static_cast<std::uint8_t>(scene.met(scene.camera().position(), way).what);
        },
        &progress);
    return sees;
}

}  // namespace

CameraPicture take_picture(const CameraScene& scene, const CameraOptions& options, Progress& progress) {
    VOXTONE_EXPECT(options.samples >= 2 && options.max_samples >= options.samples && options.error >= 0);
    const LitScene lit(scene);
    CameraPicture picture;
    picture.width_px = scene.view.width_px;
    picture.height_px = scene.view.height_px;
    picture.channels = lit.channels();
    picture.sees = what_is_seen(lit, progress);
    Exposure exposure(lit, options, picture);
    try {
        exposure.draw(progress);
    } catch (const Cancelled&) {
        if (std::find(picture.samples.begin(), picture.samples.end(), 0u) != picture.samples.end()) throw;
        picture.complete = false;
    }
    exposure.finish();
    return picture;
}

}  // namespace voxtone::optics
