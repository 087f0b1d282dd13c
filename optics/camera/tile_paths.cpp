// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/tile_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optics/monte_carlo/adaptive_sampling.h"
#include "optics/monte_carlo/rough_boundary.h"
#include "optics/monte_carlo/scalar_paths.h"

namespace voxtone::optics {
namespace {

// Stand-ins for a cell's third coordinate: what a random number of a sample is for.
enum Purpose : std::int32_t { of_place = 0, of_path = 1, of_mirrored = 2 };

/// Stands for a channel where a ray carries all of them.
constexpr std::int32_t all_channels = -1;

/// Surfaces that a path may meet in air before Russian roulette by order (probability 1/2, twice the weight): unbiased.
constexpr int patient_orders = 32;

/// Facets drawn at the first surface where it is rough, so that its highlights are not left to chance.
constexpr int facets_at_first = 8;

double roughness_at(const ResinBody& print, const Point& at, const MetInAir& met) {
    if (!print.finish) return 0;
    return print.finish->roughness(along(at, print.corner_mm, -1), met.normals.geometric);
}

}  // namespace

std::vector<std::uint32_t> channel_periods(std::span<const double> luminance_weights) {
    double largest = 0;
    for (const double weight : luminance_weights) largest = std::max(largest, std::abs(weight));
    std::vector<std::uint32_t> periods;
    for (const double weight : luminance_weights) {
        std::uint32_t period = 1;
        while (period < bundle_samples && 2 * period * std::abs(weight) <= largest) period *= 2;
        periods.push_back(period);
    }
    return periods;
}

TilePaths::TilePaths(const LitScene& scene, std::span<const std::uint32_t> periods, std::uint64_t seed)
    : scene_(scene), periods_(periods.begin(), periods.end()), seed_(seed), colour_(periods.size()) {
    waiting_.resize(scene.prints() * periods_.size());
}

void TilePaths::trace(std::span<const Sample> samples) {
    samples_ = samples;
    radiance_.assign(samples.size() * periods_.size(), 0);
    share_.assign(samples.size() * periods_.size(), 1);
    place_.resize(samples.size());
    for (std::uint32_t s = 0; s < samples.size(); ++s) begin(s);
    for (bool more = true; more;) {
        more = false;
        for (std::size_t i = 0; i < waiting_.size(); ++i) {
            if (waiting_[i].empty()) continue;
            more = true;
            trace_print(i / periods_.size(), i % periods_.size());
        }
    }
}

double TilePaths::radiance(std::size_t sample, std::size_t channel) const {
    return static_cast<double>(radiance_[sample * periods_.size() + channel]) * path_weight_unit;
}

bool TilePaths::next(PathStart& start) {
    if (next_ == inside_.size()) return false;
    start = inside_[next_].start;
    start.tag = static_cast<std::uint32_t>(next_++);
    return true;
}

void TilePaths::begin(std::uint32_t s) {
    const Sample& sample = samples_[s];
    PathRandom place(seed_, {{sample.x, sample.y, of_place}, ~0u, sample.number});
    place_[s] = {place.uniform(), place.uniform()};
    AirRay ray{};
    ray.from = scene_.camera().position();
    ray.way = scene_.camera().direction(sample.x + place_[s][0], sample.y + place_[s][1]);
    ray.sample = s;
    ray.channel = all_channels;
    ray.purpose = of_path;
    const MetInAir met = scene_.met(ray.from, ray.way);
    if (met.what == MetInAir::What::print) return first_surface(ray, met);
    colour_as_sent(ray);
    PathRandom random = random_of(ray);
    if (met.coat.eta > 1) return first_coat(ray, met, random);
    follow(ray, met, random);
}

PathRandom TilePaths::random_of(const AirRay& ray, std::uint32_t channel) const {
    const Sample& sample = samples_[ray.sample];
    return {seed_, {{sample.x, sample.y, ray.purpose}, channel, sample.number}};
}

void TilePaths::trace_print(std::size_t print, std::size_t channel) {
    std::vector<Inside>& waiting = waiting_[print * periods_.size() + channel];
    inside_ = std::move(waiting);
    waiting.clear();
    next_ = 0;
    gone_.clear();
    trace_packets(scene_.packets(print, channel), *this);
    // The order in which paths end is that of the machine's lanes; what they do then is not to depend on it.
    for (const Gone& gone : gone_) {
        const Inside& before = inside_[gone.tag];
        AirRay ray{};
        ray.from = along(gone.exit.at, scene_.print(print).corner_mm, 1);
        ray.way = gone.exit.way;
        ray.weight = before.weight * static_cast<double>(gone.weight);
        ray.sample = before.sample;
        ray.order = before.order + 1;
        ray.channel = static_cast<std::int32_t>(channel);
        PathRandom random(gone.exit.random);
        follow(ray, random);
    }
}

void TilePaths::count(const AirRay& ray, const Light& light, double factor) {
    std::uint64_t* radiance = radiance_.data() + ray.sample * periods_.size();
    const auto add = [&](std::size_t c, double weight) {
        radiance[c] += in_units(weight * factor * scene_.in_channel(light, c));
    };
    if (ray.channel != all_channels) return add(static_cast<std::size_t>(ray.channel), ray.weight);
    for (std::size_t c = 0; c < colour_.size(); ++c)
        if (colour_[c] > 0) add(c, ray.weight * colour_[c]);
}

/// Every channel as many times as its sample counts.
void TilePaths::colour_as_sent(const AirRay& ray) {
    std::copy_n(share_.data() + ray.sample * periods_.size(), periods_.size(), colour_.begin());
}

/// Takes a diffuser's colour.
void TilePaths::colour_by(AirRay& ray, const Light& reflectance) {
    if (ray.channel != all_channels) {
        ray.weight *= std::min(1.0, scene_.in_channel(reflectance, static_cast<std::size_t>(ray.channel)));
        return;
    }
    // The weight is that of the brightest, so that roulette spares it.
    const double largest = std::max({reflectance[0], reflectance[1], reflectance[2]});
    ray.weight *= largest;
    if (largest > 0)
        for (std::size_t c = 0; c < colour_.size(); ++c)
            colour_[c] *= std::min(1.0, scene_.in_channel(reflectance, c)) / largest;
}

/// The mirrored part and the part that enters are both followed.
void TilePaths::first_surface(const AirRay& ray, const MetInAir& met) {
    const std::uint32_t number = samples_[ray.sample].number;
    for (std::size_t c = 0; c < periods_.size(); ++c)
        share_[ray.sample * periods_.size() + c] = number % periods_[c] == 0 ? periods_[c] : 0;
    colour_as_sent(ray);
    PathRandom random = random_of(ray);
    const ResinBody& print = scene_.print(met.print);
    const Point at = along(ray.from, ray.way, met.distance);
    const double roughness = roughness_at(print, at, met);
    if (roughness > 0) return first_rough(ray, met, at, roughness, random);
    const MetFromOutside parts = meet_from_outside(met.normals, met.eta, ray.way);
    enter(ray, met, at, parts.refracted, 1 - parts.reflectance, random);
    mirror(ray, at, parts.reflected, parts.reflectance, 0);
}

/// Many facets: those that mirror are all followed, of those that let in one.
void TilePaths::first_rough(const AirRay& ray, const MetInAir& met, const Point& at, double roughness,
                            PathRandom& random) {
    Point kept{};
    int through = 0;
    for (int k = 0; k < facets_at_first; ++k) {
        Point way = ray.way;
        if (!cross_boundary(met.normals, met.eta, roughness, false, way, random))
            mirror(ray, at, way, 1.0 / facets_at_first, k);
        else if (random.uniform() * ++through < 1)
            kept = way;
    }
    colour_as_sent(ray);
    if (through > 0) enter(ray, met, at, kept, double(through) / facets_at_first, random);
}

void TilePaths::mirror(const AirRay& ray, const Point& at, const Point& way, double share, int which) {
    AirRay mirrored = ray;
    mirrored.from = at;
    mirrored.way = way;
    mirrored.weight *= share;
    mirrored.order = 1;
    mirrored.purpose = of_mirrored + which;
    colour_as_sent(mirrored);
    PathRandom random = random_of(mirrored);
    follow(mirrored, random);
}

/// The mirrored part and what is seen of the diffuser are both followed.
void TilePaths::first_coat(AirRay ray, const MetInAir& met, PathRandom& random) {
    const Point at = along(ray.from, ray.way, met.distance);
    const Coat& coat = met.coat;
    double through = 0;
    if (coat.roughness > 0) {
        for (int k = 0; k < facets_at_first; ++k) {
            Point way = ray.way;
            if (cross_boundary(met.normals, coat.eta, coat.roughness, false, way, random))
                through += 1.0 / facets_at_first;
            else
                mirror(ray, at, way, 1.0 / facets_at_first, k);
        }
    } else {
        const MetFromOutside parts = meet_from_outside(met.normals, coat.eta, ray.way);
        through = 1 - parts.reflectance;
        mirror(ray, at, parts.reflected, parts.reflectance, 0);
    }
    colour_as_sent(ray);
    ray.weight *= through / (1 - coat.mean);
    const bool in_air = diffuse(ray, met, at, random);
    ++ray.order;
    if (in_air) follow(ray, random);
}

/// Until the path is in a print or over.
void TilePaths::follow(AirRay ray, PathRandom& random) {
    if (goes_on(ray, random)) follow(ray, scene_.met(ray.from, ray.way), random);
}

void TilePaths::follow(AirRay ray, MetInAir met, PathRandom& random) {
    for (;; met = scene_.met(ray.from, ray.way)) {
        if (met.what == MetInAir::What::sky) {
            const double asked = ray.density > 0 ? scene_.light_density(ray.way) : 0.0;
            return count(ray, scene_.light(ray.from, ray.way),
                         ray.density > 0 ? ray.density / (ray.density + asked) : 1.0);
        }
        const Point at = along(ray.from, ray.way, met.distance);
        const bool in_air = met.what == MetInAir::What::print ? mirrored_again(ray, met, at, random)
                            : met.coat.eta > 1                ? coated(ray, met, at, random)
                                                              : diffuse(ray, met, at, random);
        ++ray.order;
        if (!in_air || !goes_on(ray, random)) return;
    }
}

/// Russian roulette.
bool TilePaths::goes_on(AirRay& ray, PathRandom& random) const {
    // What the first surface mirrors is worth its while however little it is: highlights would be grainy.
    if (ray.order > 2 && !survives_roulette_by_weight(ray.weight, default_roulette_weight, random)) return false;
    if (ray.order < patient_orders) return ray.weight > 0;
    ray.weight *= 2;
    return random.uniform() >= 0.5;
}

/// Light that a diffuser takes from the sky counts at once; the path goes on by the cosine law about the shading
/// normal. False where that would lead into the body.
bool TilePaths::diffuse(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random) {
    const Point& n = met.normals.shading;
    const Point& true_normal = met.normals.geometric;
    colour_by(ray, met.reflectance);
    ray.from = at;
    const double pixel = random.uniform(), u = random.uniform(), v = random.uniform();
    const Point up = scene_.draw_light(pixel, u, v);
    const double cosine = dot(up, n);
    if (cosine > 0 && dot(up, true_normal) > 0 && scene_.sees_sky(at, up)) {
        const double drawn = scene_.light_density(up), law = cosine / std::numbers::pi;
        count(ray, scene_.light(at, up), law / (drawn + law));
    }
    const double r = std::sqrt(random.uniform()), phi = 2 * std::numbers::pi * random.uniform();
    const double height = std::sqrt(std::max(0.0, 1 - r * r));
    ray.way = entering_direction({n, n}, {-height, r * std::cos(phi), r * std::sin(phi)});
    ray.density = std::max(dot(ray.way, n) / std::numbers::pi, 1e-12);
    return dot(ray.way, true_normal) > 0;
}

/// At a coat that is not the first surface chance decides.
bool TilePaths::coated(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random) {
    const Coat& coat = met.coat;
    Point way = ray.way;
    bool through = false;
    if (coat.roughness > 0) {
        through = cross_boundary(met.normals, coat.eta, coat.roughness, false, way, random);
    } else {
        const MetFromOutside parts = meet_from_outside(met.normals, coat.eta, ray.way);
        through = random.uniform() >= parts.reflectance;
        way = parts.reflected;
    }
    if (through) {
        ray.weight /= 1 - coat.mean;
        return diffuse(ray, met, at, random);
    }
    ray.from = at;
    ray.way = way;
    ray.density = 0;
    return true;
}

/// At a print that is not the first surface chance decides; false where the path went in.
bool TilePaths::mirrored_again(AirRay& ray, const MetInAir& met, const Point& at, PathRandom& random) {
    const double roughness = roughness_at(scene_.print(met.print), at, met);
    Point way = ray.way;
    bool through = false;
    if (roughness > 0) {
        through = cross_boundary(met.normals, met.eta, roughness, false, way, random);
    } else {
        const MetFromOutside parts = meet_from_outside(met.normals, met.eta, ray.way);
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

void TilePaths::enter(const AirRay& ray, const MetInAir& met, const Point& at, const Point& way, double share,
                      PathRandom& random) {
    if (ray.channel != all_channels)
        return enter_in(static_cast<std::size_t>(ray.channel), ray, met, at, way, ray.weight * share, random);
    for (std::size_t c = 0; c < colour_.size(); ++c) {
        if (colour_[c] <= 0) continue;
        PathRandom own = random_of(ray, static_cast<std::uint32_t>(c));
        enter_in(c, ray, met, at, way, ray.weight * share * colour_[c], own);
    }
}

void TilePaths::enter_in(std::size_t channel, const AirRay& ray, const MetInAir& met, const Point& at, const Point& way,
                         double weight, PathRandom& random) {
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
    in.weight = weight;
    in.sample = ray.sample;
    in.order = ray.order;
    waiting_[met.print * periods_.size() + channel].push_back(in);
}

}  // namespace voxtone::optics
