// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/exposure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "base/parallel.h"

namespace voxtone::optics {
namespace {

constexpr std::uint32_t first_round = 2 * bundle_samples, in_one_go = 4 * bundle_samples;

std::uint32_t next_level(std::uint32_t level) { return level + std::clamp(level, first_round, 64u); }

std::uint32_t in_bundles(double samples) {
    return bundle_samples * static_cast<std::uint32_t>(std::ceil(samples / bundle_samples));
}

constexpr double square(double x) { return x * x; }

}  // namespace

Exposure::Exposure(const LitScene& scene, const CameraOptions& options, CameraPicture& picture)
    : scene_(scene),
      options_(options),
      picture_(picture),
      filter_(options.filter_px),
      periods_(channel_periods(scene.luminance_weights())),
      channels_(scene.channels()),
      quantities_(channels_ + scene.derived().size()) {
    const auto pixels = static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px);
    sum_.resize(pixels * quantities_);
    squares_.resize(pixels * quantities_);
    picture.samples.resize(pixels);
    const auto in_tiles = [](int px) { return (px + edge_px - 1) / edge_px; };
    across_ = in_tiles(picture.width_px);
    tiles_.resize(static_cast<std::size_t>(across_) * static_cast<std::size_t>(in_tiles(picture.height_px)));
    for (Tile& tile : tiles_) tile.wanted = std::max(in_bundles(options.samples), first_round);
}

void Exposure::draw(Progress& progress) {
    while (const std::uint64_t steps = steps_left()) {
        progress.begin_stage("draw", steps, "samples of a square");
        std::uint32_t most = 0;
        for (const Tile& tile : tiles_) most = std::max(most, tile.wanted);
        for (std::uint32_t level = std::min(first_round, most);; level = next_level(level)) {
            parallel_for(
                0, tiles_.size(), 1, [&](std::size_t t) { raise(t, std::min(level, tiles_[t].wanted), progress); },
                &progress);
            if (level >= most) break;
        }
        progress.end_stage();
        if (options_.error > 0) plan();
        if (steps_left() > 0) progress.note(what_is_wanted());
    }
}

bool Exposure::shows_all() const {
    return std::all_of(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return tile.drawn > 0; });
}

std::string Exposure::what_is_wanted() const {
    std::uint32_t most = 0;
    double all = 0;
    for (const Tile& tile : tiles_) most = std::max(most, tile.wanted), all += tile.wanted;
    return fmt::format("for an error of {:g} up to {} samples a pixel are wanted, {:.0f} on average", options_.error,
                       most, all / double(tiles_.size()));
}

std::uint64_t Exposure::steps_left() const {
    std::uint64_t steps = 0;
    for (const Tile& tile : tiles_) steps += tile.wanted - tile.drawn;
    return steps;
}

template <class Visit>
void Exposure::each_pixel(std::size_t tile, Visit&& visit) const {
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(across_)) * edge_px,
              y0 = static_cast<int>(tile / static_cast<std::size_t>(across_)) * edge_px;
    for (int y = y0; y < std::min(y0 + edge_px, picture_.height_px); ++y)
        for (int x = x0; x < std::min(x0 + edge_px, picture_.width_px); ++x)
            visit(x, y,
                  static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width_px) +
                      static_cast<std::size_t>(x));
}

/// A tile's samples up to so many.
void Exposure::raise(std::size_t tile, std::uint32_t level, Progress& progress) {
    while (tiles_[tile].drawn < level) {
        progress.check_cancelled();
        const std::uint32_t count = std::min(in_one_go, level - tiles_[tile].drawn);
        add(tile, count);
        progress.advance(count);
    }
}

void Exposure::add(std::size_t tile_index, std::uint32_t count) {
    Tile& tile = tiles_[tile_index];
    std::vector<TilePaths::Sample> samples;
    each_pixel(tile_index, [&](int x, int y, std::size_t) {
        for (std::uint32_t s = 0; s < count; ++s) samples.push_back({x, y, tile.drawn + s});
    });
    TilePaths paths(scene_, periods_, options_.seed);
    paths.trace(samples);
    tile.light.resize(std::size_t(with_margin) * with_margin * channels_);
    tile.share.resize(tile.light.size());
    std::size_t next = 0;
    each_pixel(tile_index, [&](int x, int y, std::size_t pixel) {
        add_to_bundles(paths, next, count, pixel);
        for (std::uint32_t s = 0; s < count; ++s) gather(paths, next++, x % edge_px, y % edge_px, tile);
        picture_.samples[pixel] += count;
    });
    tile.drawn += count;
}

void Exposure::add_to_bundles(const TilePaths& paths, std::size_t first, std::uint32_t count, std::size_t pixel) {
    std::vector<double> means(quantities_);
    for (std::size_t s = first; s < first + count; s += bundle_samples) {
        std::fill(means.begin(), means.end(), 0.0);
        for (std::size_t k = 0; k < bundle_samples; ++k)
            for (std::size_t c = 0; c < channels_; ++c) means[c] += paths.radiance(s + k, c) / bundle_samples;
        for (std::size_t d = channels_; d < quantities_; ++d)
            means[d] = std::inner_product(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(channels_),
                                          scene_.derived()[d - channels_].begin(), 0.0);
        for (std::size_t q = 0; q < quantities_; ++q) {
            sum_[pixel * quantities_ + q] += means[q];
            squares_[pixel * quantities_ + q] += square(means[q]);
        }
    }
}

/// What a sample in pixel (x, y) of a tile gives to the pixels around it.
void Exposure::gather(const TilePaths& paths, std::size_t sample, int x, int y, Tile& tile) const {
    const auto& place = paths.place(sample);
    const int reach = filter_.reach();
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            const double weight = filter_.weight(place[0] - 0.5 - dx) * filter_.weight(place[1] - 0.5 - dy);
            const std::size_t to =
                static_cast<std::size_t>((y + dy + margin_px) * with_margin + x + dx + margin_px) * channels_;
            for (std::size_t c = 0; c < channels_; ++c) {
                tile.light[to + c] += weight * paths.radiance(sample, c);
                tile.share[to + c] += weight * paths.share(sample, c);
            }
        }
}

/// Samples that tiles want for their error, from the spread so far.
void Exposure::plan() {
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
        double squares = 0;
        std::size_t pixels = 0;
        each_pixel(t, [&](int x, int y, std::size_t) {
            squares += filtered_variance(x, y, quantities_ - 1);
            ++pixels;
        });
        const double ratio = std::sqrt(squares / double(pixels)) / options_.error;
        if (ratio <= 1) continue;
        constexpr double spare = 1.05;  // the spread is an estimate, too
        const double more = spare * double(tiles_[t].wanted) * square(ratio);
        tiles_[t].wanted = in_bundles(std::min(more, double(options_.max_samples)));
    }
}

double Exposure::mean(std::size_t pixel, std::size_t quantity) const {
    return sum_[pixel * quantities_ + quantity] / (picture_.samples[pixel] / bundle_samples);
}

/// Of the mean over a pixel's own square.
double Exposure::variance_of_mean(std::size_t pixel, std::size_t quantity) const {
    const double n = picture_.samples[pixel] / bundle_samples;
    return std::max(0.0, squares_[pixel * quantities_ + quantity] / n - square(mean(pixel, quantity))) / (n - 1);
}

/// Of a ratio: what samples differ from the filtered value by is weighed with weights that scatter.
double Exposure::filtered_variance(int x, int y, std::size_t quantity) const {
    const auto width = static_cast<std::size_t>(picture_.width_px);
    const int reach = filter_.reach();
    // The weights are those of this pixel, seen from its neighbours: the filter is even.
    const auto each_neighbour = [&](auto&& body) {
        for (int dy = -reach; dy <= reach; ++dy)
            for (int dx = -reach; dx <= reach; ++dx) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= picture_.width_px || y + dy >= picture_.height_px) continue;
                const std::size_t pixel = static_cast<std::size_t>(y + dy) * width + static_cast<std::size_t>(x + dx);
                if (picture_.samples[pixel] == 0) continue;
                const auto i = static_cast<std::size_t>(1 + dx), k = static_cast<std::size_t>(1 + dy);
                body(pixel, filter_.mean()[i] * filter_.mean()[k], filter_.mean_square()[i] * filter_.mean_square()[k]);
            }
    };
    double sum = 0, share = 0;
    each_neighbour([&](std::size_t pixel, double weight, double) {
        sum += weight * mean(pixel, quantity);
        share += weight;
    });
    double variance = 0;
    each_neighbour([&](std::size_t pixel, double weight, double weight_square) {
        variance +=
            weight_square * variance_of_mean(pixel, quantity) +
            (weight_square - square(weight)) * square(mean(pixel, quantity) - sum / share) / picture_.samples[pixel];
    });
    return variance / square(share);
}

void Exposure::finish() {
    const std::size_t pixels = picture_.samples.size();
    picture_.value.assign(pixels * channels_, 0);
    picture_.standard_error.assign(pixels * channels_, 0);
    picture_.colour_error.assign(pixels * 3, 0);
    double squares = 0;
    std::size_t seen = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t)
        each_pixel(t, [&](int x, int y, std::size_t pixel) {
            picture_.paths += picture_.samples[pixel];
            finish_pixel(x, y, pixel);
            if (picture_.samples[pixel] == 0 || picture_.sees[pixel] < 2) return;
            squares += filtered_variance(x, y, quantities_ - 1);
            ++seen;
        });
    picture_.rms_error = seen > 0 ? std::sqrt(squares / double(seen)) : 0;
}

void Exposure::finish_pixel(int x, int y, std::size_t pixel) {
    if (picture_.samples[pixel] == 0) return;
    std::vector<double> light(channels_), share(channels_);
    const int down = static_cast<int>(tiles_.size()) / across_;
    for (int ty = std::max(0, (y - margin_px) / edge_px); ty <= std::min(down - 1, (y + margin_px) / edge_px); ++ty)
        for (int tx = std::max(0, (x - margin_px) / edge_px); tx <= std::min(across_ - 1, (x + margin_px) / edge_px);
             ++tx) {
            const Tile& tile = tiles_[static_cast<std::size_t>(ty * across_ + tx)];
            if (tile.drawn == 0) continue;
            const int row = y - ty * edge_px + margin_px, column = x - tx * edge_px + margin_px;
            const std::size_t from = static_cast<std::size_t>(row * with_margin + column) * channels_;
            for (std::size_t c = 0; c < channels_; ++c) {
                light[c] += tile.light[from + c] / tile.drawn;
                share[c] += tile.share[from + c] / tile.drawn;
            }
        }
    for (std::size_t c = 0; c < channels_; ++c) {
        picture_.value[pixel * channels_ + c] = static_cast<float>(light[c] / share[c]);
        picture_.standard_error[pixel * channels_ + c] = static_cast<float>(std::sqrt(filtered_variance(x, y, c)));
    }
    // Linear sRGB and luminance are the last four.
    for (std::size_t c = 0; c < 3; ++c)
        picture_.colour_error[pixel * 3 + c] =
            static_cast<float>(std::sqrt(filtered_variance(x, y, quantities_ - 4 + c)));
}

}  // namespace voxtone::optics
