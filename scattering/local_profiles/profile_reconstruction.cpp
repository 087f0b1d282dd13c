// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/profile_reconstruction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"

namespace voxtone::scattering {
namespace {

double between(double low, double high, double low_share) {
    // A profile may be 0 at a knot; between two it is the geometric mean.
    if (low_share == 1) return low;
    if (low_share == 0) return high;
    return std::pow(low, low_share) * std::pow(high, 1 - low_share);
}

/// By ring: sqrt(P) of all points.
std::vector<std::vector<double>> roots_by_ring(const LocalProfiles& profiles, std::size_t channel,
                                               std::span<const ProfileRing> rings) {
    const ProfileImages& P = profiles.channels.at(channel);
    const std::size_t points = profiles.grid.points();
    std::vector<std::vector<double>> roots(rings.size(), std::vector<double>(points));
    parallel_for(0, rings.size(), 1, [&](std::size_t r) {
        const std::size_t k = rings[r].knot;
        for (std::size_t i = 0; i < points; ++i)
            roots[r][i] = std::sqrt(between(P[k * points + i], P[(k + 1) * points + i], rings[r].low_share));
    });
    return roots;
}

/// Mean absolute deviation of a Poisson count of mean n: exact below 1, within 2 % above 2, 8 % between.
double mean_deviation(double n) { return n < 1 ? 2 * n * std::exp(-n) : std::sqrt(2 * n / std::numbers::pi); }

/// Sums over the pairs whose first point is in one row.
struct PairSums {
    double data = 0, model = 0, difference = 0, noise = 0, squares = 0, unexplained = 0;
};

/// Light and light times distance at a point.
struct Moments {
    double light = 0, way = 0;
    void add(double value, double distance) { light += value, way += value * distance; }
};

SpreadImages spread_from(std::span<const Moments> moments, double cell_mm2, double pitch_mm) {
    SpreadImages images;
    for (const Moments& m : moments) {
        images.albedo.push_back(m.light * cell_mm2);
        images.width_mm.push_back(m.light > 0 ? m.way / m.light * pitch_mm : 0);
    }
    return images;
}

/// Calls body(r, offset, other) for all of the window of a point that lies in the grid.
template <class Body>
void for_window(const PointGrid& grid, std::span<const ProfileRing> rings, std::size_t point, Body&& body) {
    const int width = static_cast<int>(grid.width), height = static_cast<int>(grid.height);
    const int x = static_cast<int>(point % grid.width), y = static_cast<int>(point / grid.width);
    for (std::size_t r = 0; r < rings.size(); ++r)
        for (const optics::PointOffset& d : rings[r].offsets)
            if (x + d.x >= 0 && x + d.x < width && y + d.y >= 0 && y + d.y < height)
                body(r, d, static_cast<std::size_t>((y + d.y) * width + x + d.x));
}

}  // namespace

ReconstructionError reconstruction_error(const optics::SampledBssrdf& responses, std::size_t channel,
                                         const LocalProfiles& profiles) {
    const auto rings = profile_rings(profiles.radius);
    const auto roots = roots_by_ring(profiles, channel, rings);
    const optics::ChannelResponses& data = responses.channels.at(channel);
    const auto offsets = optics::half_window(responses.radius);
    const std::size_t points = responses.points();
    const int width = static_cast<int>(responses.width), height = static_cast<int>(responses.height);
    const auto ring_of = rings_of_half_window(rings, responses.radius);
    std::vector<PairSums> rows(responses.height);
    parallel_for(0, responses.height, rows_per_task, [&](std::size_t row) {
        PairSums& sums = rows[row];
        const int y = static_cast<int>(row);
        for (std::size_t s = 0; s < offsets.size(); ++s) {
            if (y + offsets[s].y >= height) continue;
            const auto& root = roots[ring_of[s]];
            const double noise = s == 0 ? 2 * data.noise : data.noise,
                         share = s == 0 ? 1 : 2;  // a pair is light of both ends
            for (int x = std::max(0, -offsets[s].x); x < width && x + offsets[s].x < width; ++x) {
                const auto i = static_cast<std::size_t>(y * width + x),
                           o = static_cast<std::size_t>((y + offsets[s].y) * width + x + offsets[s].x);
                const double R = static_cast<double>(data.pairs[s * points + i]), model = root[i] * root[o],
                             error = R - model;
                sums.data += share * R;
                sums.model += share * model;
                sums.difference += share * std::abs(error);
                if (noise > 0) sums.noise += share * noise * mean_deviation(model / noise);
                sums.squares += share * R * R;
                sums.unexplained += share * (error * error - noise * model);
            }
        }
    });
    PairSums all;
    for (const PairSums& row : rows) {
        all.data += row.data;
        all.model += row.model;
        all.difference += row.difference;
        all.noise += row.noise;
        all.squares += row.squares;
        all.unexplained += row.unexplained;
    }
    ReconstructionError error;
    if (!(all.data > 0)) return error;
    error.light_error = all.difference / all.data;
    error.noise_error = all.noise / all.data;
    error.excess = std::sqrt(std::max(0.0, all.unexplained) / all.squares);
    error.light = all.model / all.data;
    const std::vector<double> of_data = spread_of(responses, channel).albedo,
                              of_model = spread_of(profiles, channel).albedo;
    double squares = 0;
    for (std::size_t i = 0; i < points; ++i) {
        const double difference = std::abs(of_data[i] - of_model[i]);
        squares += difference * difference;
        error.largest_albedo_error = std::max(error.largest_albedo_error, difference);
    }
    error.albedo_error = std::sqrt(squares / static_cast<double>(points));
    return error;
}

std::vector<double> response_at(const LocalProfiles& profiles, std::size_t channel, std::size_t point) {
    const auto rings = profile_rings(profiles.radius);
    const ProfileImages& P = profiles.channels.at(channel);
    const std::size_t points = profiles.grid.points(), side = 2 * std::size_t{profiles.radius} + 1;
    const int radius = static_cast<int>(profiles.radius);
    const auto at = [&](std::size_t r, std::size_t i) {
        return between(P[rings[r].knot * points + i], P[(rings[r].knot + 1) * points + i], rings[r].low_share);
    };
    std::vector<double> window(side * side);
    for_window(profiles.grid, rings, point, [&](std::size_t r, const optics::PointOffset& d, std::size_t other) {
        window[static_cast<std::size_t>(d.y + radius) * side + static_cast<std::size_t>(d.x + radius)] =
            std::sqrt(at(r, point) * at(r, other));
    });
    return window;
}

std::vector<double> response_at(const optics::SampledBssrdf& responses, std::size_t channel, std::size_t point) {
    const auto offsets = optics::half_window(responses.radius);
    const auto& pairs = responses.channels.at(channel).pairs;
    const std::size_t side = 2 * std::size_t{responses.radius} + 1;
    const int width = static_cast<int>(responses.width), height = static_cast<int>(responses.height),
              radius = static_cast<int>(responses.radius);
    const int x = static_cast<int>(point % responses.width), y = static_cast<int>(point / responses.width);
    std::vector<double> window(side * side);
    for (std::size_t s = 0; s < offsets.size(); ++s)
        for (const int sign : {1, -1}) {
            const int dx = sign * offsets[s].x, dy = sign * offsets[s].y;
            if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
            const std::size_t from = sign > 0 ? point : static_cast<std::size_t>((y + dy) * width + x + dx);
            window[static_cast<std::size_t>(dy + radius) * side + static_cast<std::size_t>(dx + radius)] =
                static_cast<double>(pairs[s * responses.points() + from]);
        }
    return window;
}

SpreadImages spread_of(const LocalProfiles& profiles, std::size_t channel) {
    const auto rings = profile_rings(profiles.radius);
    const auto roots = roots_by_ring(profiles, channel, rings);
    const PointGrid& grid = profiles.grid;
    std::vector<Moments> moments(grid.points());
    parallel_for(0, grid.height, rows_per_task, [&](std::size_t y) {
        std::vector<double> sum(grid.width);
        for (std::size_t r = 0; r < rings.size(); ++r) {
            sum_over_ring(grid, rings[r], roots[r], static_cast<std::uint32_t>(y), sum);
            for (std::size_t x = 0; x < grid.width; ++x) {
                const std::size_t i = y * grid.width + x;
                moments[i].add(roots[r][i] * sum[x], rings[r].radius);
            }
        }
    });
    return spread_from(moments, profiles.pitch_mm * profiles.pitch_mm, profiles.pitch_mm);
}

SpreadImages spread_of(const optics::SampledBssrdf& responses, std::size_t channel) {
    const auto offsets = optics::half_window(responses.radius);
    const auto& pairs = responses.channels.at(channel).pairs;
    const int width = static_cast<int>(responses.width), height = static_cast<int>(responses.height);
    std::vector<Moments> moments(responses.points());
    for (std::size_t s = 0; s < offsets.size(); ++s) {
        const double distance = std::hypot(offsets[s].x, offsets[s].y);
        for (int y = 0; y + offsets[s].y < height; ++y)
            for (int x = std::max(0, -offsets[s].x); x < width && x + offsets[s].x < width; ++x) {
                const auto i = static_cast<std::size_t>(y * width + x),
                           o = static_cast<std::size_t>((y + offsets[s].y) * width + x + offsets[s].x);
                const double R = static_cast<double>(pairs[s * responses.points() + i]);
                moments[i].add(R, distance);
                if (s > 0) moments[o].add(R, distance);
            }
    }
    return spread_from(moments, responses.cell_mm2(), responses.pitch_mm);
}

std::vector<double> light_by_ring(std::span<const double> P, std::span<const ProfileRing> rings, double pitch_mm) {
    std::vector<double> light;
    for (const ProfileRing& ring : rings)
        light.push_back(static_cast<double>(ring.offsets.size()) * pitch_mm * pitch_mm *
                        between(P[ring.knot], P[ring.knot + 1], ring.low_share));
    return light;
}

std::vector<double> light_by_knot(std::span<const double> P, std::span<const ProfileRing> rings, double pitch_mm) {
    std::vector<double> light(P.size());
    const std::vector<double> of_ring = light_by_ring(P, rings, pitch_mm);
    for (std::size_t i = 0; i < rings.size(); ++i) {
        const ProfileRing& ring = rings[i];
        light[ring.knot] += ring.low_share * of_ring[i];
        light[ring.knot + 1] += (1 - ring.low_share) * of_ring[i];
    }
    return light;
}

optics::RadialSamples radial_samples(std::span<const double> P, std::uint32_t radius, double pitch_mm) {
    const std::vector<double> by_knot = light_by_knot(P, profile_rings(radius), pitch_mm);
    const double total = std::accumulate(by_knot.begin(), by_knot.end(), 0.0);
    optics::RadialSamples samples{pitch_mm, std::vector<double>(P.begin(), P.end()), {}};
    // The light under straight lines: weight of each sample.
    const double unit = 2 * std::numbers::pi * pitch_mm * pitch_mm;
    double others = 0;
    for (std::size_t k = 1; k < P.size(); ++k) {
        const double place = static_cast<double>(k);
        others += unit * P[k] * (k + 1 < P.size() ? place : place / 2 - 1.0 / 6);
    }
    double& first = samples.light[0];
    first = std::max((total - others) / (unit / 6), samples.light[1]);
    const double sum = others + first * unit / 6;
    if (sum > 0)
        for (double& light : samples.light) light *= total / sum;
    return samples;
}

}  // namespace voxtone::scattering
