// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/edge/edge_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/monte_carlo/rough_interface.h"
#include "optics/monte_carlo/voxel_walk.h"

namespace voxtone::optics {
namespace {

using Direction = std::array<double, 3>;

constexpr std::uint32_t orders_kept = 24;
constexpr double order_growth = 1.08, distance_growth = 1.1, first_distance_mm = 0.002, last_distance_mm = 30;

enum class PathEnd { air, base, lost };

// Where a path is, and where it goes: +z down.
struct EdgePath {
    Direction d{};
    double x = 0;
    std::size_t layer = 0;
    bool at_top = true;  ///< of the layer, else at its bottom
    std::uint32_t scatterings = 0;
};

Direction direction(double cosine, double down, PathRandom& random) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), phi = 2 * std::numbers::pi * random.uniform();
    return {sine * std::cos(phi), sine * std::sin(phi), down * cosine};
}

class EdgeTracer {
public:
    explicit EdgeTracer(const EdgeRun& run)
        : run_(run), layers_(edge_layers(run.assembly, run.slab_mm)), last_(layers_.size() - 1) {}

    // False where it was mirrored at the first surface.
    bool enter(EdgePath& path, const DirectionWindow& w, PathRandom& random) const {
        const double cosine2 = w.least * w.least + (w.most * w.most - w.least * w.least) * random.uniform();
        path.d = direction(std::sqrt(cosine2), 1, random);
        return cross_interface(path.d, 1, layers_[0].index, layers_[0].roughness_above, random);
    }

    void start_on_base(EdgePath& path, PathRandom& random) const {
        path.layer = last_;
        path.at_top = false;
        path.d = direction(std::sqrt(1 - random.uniform()), -1, random);
    }

    PathEnd follow(EdgePath& path, PathRandom& random) const {
        while (true) {
            const EdgeLayer& layer = layers_[path.layer];
            if (layer.slab) {
                if (!through_slab(path, random)) return PathEnd::lost;
            } else {
                path.x += layer.thickness_mm * path.d[0] / std::max(std::abs(path.d[2]), 1e-12);
                path.at_top = path.d[2] < 0;
            }
            if (!path.at_top) {
                if (path.layer == last_) return PathEnd::base;
                const EdgeLayer& below = layers_[path.layer + 1];
                if (cross_interface(path.d, layer.index, below.index, below.roughness_above, random))
                    ++path.layer, path.at_top = true;
            } else {
                const double index_above = path.layer == 0 ? 1.0 : layers_[path.layer - 1].index;
                if (!cross_interface(path.d, layer.index, index_above, layer.roughness_above, random)) continue;
                if (path.layer == 0) return PathEnd::air;
                --path.layer, path.at_top = false;
            }
        }
    }

private:
    // To the upper or lower side of the slab; false where the cap was met.
    bool through_slab(EdgePath& path, PathRandom& random) const {
        double z = path.at_top ? 0 : run_.slab_mm;
        while (true) {
            const double step = -std::log(1 - random.uniform()) / run_.sigma_t;
            const double to_side = (path.d[2] > 0 ? run_.slab_mm - z : z) / std::max(std::abs(path.d[2]), 1e-12);
            path.x += std::min(step, to_side) * path.d[0];
            if (step >= to_side) {
                path.at_top = path.d[2] < 0;
                return true;
            }
            z += step * path.d[2];
            if (++path.scatterings >= OrderBins::most_scatterings) return false;
            turn_henyey_greenstein(path.d, run_.g, random);
        }
    }

    const EdgeRun& run_;
    std::vector<EdgeLayer> layers_;
    std::size_t last_;
};

enum class Origin : std::uint32_t { camera, base, light };

std::uint32_t paths_from(Origin origin, std::uint32_t paths) { return origin == Origin::camera ? paths : paths / 2; }

class BatchCounter {
public:
    BatchCounter(const EdgeRun& run, Origin origin, PathCounts& counts)
        : run_(run), tracer_(run), origin_(origin), counts_(counts) {
        counts.to_light.assign(orders_.size(), 0);
        counts.elsewhere.assign(orders_.size(), 0);
        counts.to_base.assign(orders_.size() * distances_.size(), 0);
    }

    void trace(std::uint32_t p) {
        PathRandom random(run_.seed, {{0, 0, 0}, static_cast<std::uint32_t>(origin_), p});
        EdgePath path;
        ++counts_.paths;
        if (origin_ == Origin::base)
            tracer_.start_on_base(path, random);
        else if (!tracer_.enter(path, origin_ == Origin::camera ? run_.camera : run_.light, random)) {
            ++counts_.elsewhere[0];  // mirrored, and never into the light that stands elsewhere
            return;
        }
        count(tracer_.follow(path, random), path);
    }

private:
    void count(PathEnd end, const EdgePath& path) {
        const std::size_t order = orders_.of(path.scatterings);
        if (end == PathEnd::base)
            ++counts_.to_base[order * distances_.size() + distances_.of(std::abs(path.x))];
        else if (end == PathEnd::lost)
            ++counts_.lost;
        else if (-path.d[2] >= run_.light.least && -path.d[2] <= run_.light.most)
            ++counts_.to_light[order];
        else
            ++counts_.elsewhere[order];
    }

    const EdgeRun& run_;
    EdgeTracer tracer_;
    Origin origin_;
    PathCounts& counts_;
    const OrderBins& orders_ = order_bins();
    const DistanceBins& distances_ = distance_bins();
};

void trace_batch(const EdgeRun& run, Origin origin, std::size_t batch, PathCounts& counts) {
    const std::uint64_t paths = paths_from(origin, run.paths);
    BatchCounter counter(run, origin, counts);
    for (std::uint64_t p = paths * batch / edge_batches; p < paths * (batch + 1) / edge_batches; ++p)
        counter.trace(static_cast<std::uint32_t>(p));
}

}  // namespace

OrderBins::OrderBins() {
    for (std::uint32_t n = 0; n <= orders_kept; ++n) first_.push_back(n);
    while (first_.back() < most_scatterings)
        first_.push_back(static_cast<std::uint32_t>(std::ceil(first_.back() * order_growth)) + 1);
}

std::size_t OrderBins::of(std::uint32_t n) const {
    if (n < orders_kept) return n;
    return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), n) - first_.begin()) - 1;
}

double OrderBins::mean_power(std::size_t bin, double alpha) const {
    const std::uint32_t from = first_[bin], count = first_[bin + 1] - from;
    if (alpha >= 1) return 1;
    const double power = std::pow(alpha, from);
    if (count == 1) return power;
    return power * -std::expm1(count * std::log(std::max(alpha, 1e-300))) / ((1 - alpha) * count);
}

DistanceBins::DistanceBins() {
    edges_ = {0, first_distance_mm};
    while (edges_.back() < last_distance_mm) edges_.push_back(edges_.back() * distance_growth);
}

std::size_t DistanceBins::of(double distance_mm) const {
    if (!(distance_mm >= first_distance_mm)) return 0;
    static const double per_log = 1 / std::log(distance_growth);
    const auto bin = static_cast<std::size_t>(1 + std::log(distance_mm / first_distance_mm) * per_log);
    return std::min(bin, size() - 1);
}

const OrderBins& order_bins() {
    static const OrderBins bins;
    return bins;
}

const DistanceBins& distance_bins() {
    static const DistanceBins bins;
    return bins;
}

EdgeCounts trace_edge_paths(const EdgeRun& run, const Progress* progress) {
    VOXTONE_EXPECT(run.sigma_t > 0 && run.slab_mm > 0 && run.g > -1 && run.g < 1 && run.light.share() > 0);
    EdgeCounts counts;
    parallel_for(
        0, 3 * edge_batches, 1,
        [&](std::size_t k) {
            PathBatch& batch = counts[k / 3];
            const auto origin = static_cast<Origin>(k % 3);
            trace_batch(run, origin, k / 3,
                        origin == Origin::camera ? batch.camera
                        : origin == Origin::base ? batch.base
                                                 : batch.light);
        },
        progress);
    return counts;
}

}  // namespace voxtone::optics
