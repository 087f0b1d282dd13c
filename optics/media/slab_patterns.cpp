// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/slab_patterns.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"

namespace voxtone::optics {
namespace {

using Place = std::array<double, 3>;  ///< mm; x right, y down the picture, z depth

/// Random numbers of a point of a lattice.
RandomStream at_lattice(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t stream) {
    constexpr std::uint64_t mask = (std::uint64_t{1} << 21) - 1;
    const auto part = [&](std::int64_t i) { return static_cast<std::uint64_t>(i) & mask; };
    return {seed, part(x) | part(y) << 21 | part(z) << 42, stream};
}

/// Random values at whole coordinates, smooth between: in [0, 1).
double lattice_noise(std::uint64_t seed, const Place& p, std::uint32_t stream) {
    std::array<std::int64_t, 3> i{};
    std::array<double, 3> t{};
    for (std::size_t a = 0; a < 3; ++a) {
        i[a] = static_cast<std::int64_t>(std::floor(p[a]));
        const double u = p[a] - static_cast<double>(i[a]);
        t[a] = u * u * u * (u * (6 * u - 15) + 10);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double share = 1;
        std::array<std::int64_t, 3> at = i;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool far = (corner >> a & 1) != 0;
            at[a] += far;
            share *= far ? t[a] : 1 - t[a];
        }
        sum += share * at_lattice(seed, at[0], at[1], at[2], stream).uniform();
    }
    return sum;
}

/// Four octaves of noise, each half as strong and twice as fine: in [-1, 1).
double turbulence(std::uint64_t seed, Place p) {
    double sum = 0, strength = 0.5;
    for (std::uint32_t octave = 0; octave < 4; ++octave) {
        sum += strength * (2 * lattice_noise(seed, p, octave) - 1);
        for (double& x : p) x *= 2;
        strength /= 2;
    }
    return sum;
}

/// A number for the grain that holds the place: that of the nearest of the points strewn one into each cell of the
/// lattice.
std::uint64_t grain_at(std::uint64_t seed, const Place& p) {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(p[a]));
    double nearest = std::numeric_limits<double>::infinity();
    std::uint64_t grain = 0;
    for (std::int64_t z = cell[2] - 2; z <= cell[2] + 2; ++z)
        for (std::int64_t y = cell[1] - 2; y <= cell[1] + 2; ++y)
            for (std::int64_t x = cell[0] - 2; x <= cell[0] + 2; ++x) {
                RandomStream random = at_lattice(seed, x, y, z, 16);
                const double dx = static_cast<double>(x) + random.uniform() - p[0],
                             dy = static_cast<double>(y) + random.uniform() - p[1],
                             dz = static_cast<double>(z) + random.uniform() - p[2];
                const double distance = dx * dx + dy * dy + dz * dz;
                const std::uint64_t name = random.bits();
                if (distance < nearest) {
                    nearest = distance;
                    grain = name;
                }
            }
    return grain;
}

/// Mixes roles of a set; a tint that the set lacks is left out, and clear resin makes up for what is missing to 1.
class Mixer {
public:
    explicit Mixer(const ResinSet& set) : set_(set), clear_(role("T")) {
        (void)role("W"), (void)role("K");
        mixtures_ = set;
        mixtures_.resins.clear();
    }
    void add(std::initializer_list<std::pair<const char*, double>> parts) {
        std::vector<double> fractions(set_.resins.size());
        double sum = 0;
        for (const auto& [name, fraction] : parts)
            if (const int r = set_.find(name); r >= 0) {
                fractions[static_cast<std::size_t>(r)] += fraction;
                sum += fraction;
            }
        fractions[clear_] += 1 - sum;
        Resin mixture;
        mixture.name = mixture.role = fmt::format("mixture-{}", mixtures_.resins.size());
        for (std::size_t c = 0; c < set_.channels.size(); ++c) {
            const Medium medium = set_.mix(fractions, c);
            mixture.sigma_t_per_mm.push_back(medium.sigma_t());
            mixture.albedo.push_back(medium.albedo());
        }
        if (set_.has_own_eta()) {
            mixture.eta = 0;
            for (std::size_t r = 0; r < fractions.size(); ++r)
                *mixture.eta += fractions[r] * set_.eta_of(set_.resins[r]);
        }
        mixtures_.resins.push_back(std::move(mixture));
    }
    [[nodiscard]] ResinSet finish() && { return std::move(mixtures_); }

private:
    [[nodiscard]] std::size_t role(const char* name) const {
        const int found = set_.find(name);
        if (found < 0)
            throw InputError(
                fmt::format("The resin set \"{}\" has no resin of role {}, which the patterns are made of (W, K and T, "
                            "clear); use vero-opaque-clear or a set that has them.",
                            set_.name, name));
        return static_cast<std::size_t>(found);
    }
    const ResinSet& set_;
    std::size_t clear_;
    ResinSet mixtures_;
};

using MaterialAt = std::function<Material(const Place&)>;

MaterialAt chess(const SlabOptions& options, Mixer& mixer) {
    mixer.add({{"W", 1.0}});
    mixer.add({{"K", 1.0}});
    mixer.add({{"W", 0.2}, {"Y", 0.02}, {"M", 0.004}});
    constexpr double white_mm = 0.6;
    return [options](const Place& p) -> Material {
        const auto square =
            static_cast<std::int64_t>(std::floor(p[0] / options.feature_mm) + std::floor(p[1] / options.feature_mm));
        if (square % 2 != 0) return 3;
        return p[2] < white_mm ? 1 : 2;
    };
}

MaterialAt marble(const SlabOptions& options, Mixer& mixer) {
    constexpr int levels = 32;  // between the body and the middle of a vein
    for (int i = 0; i < levels; ++i) {
        const double vein = i / (levels - 1.0);
        mixer.add({{"W", 0.8 * (1 - vein) + 0.25 * vein},
                   {"K", 0.03 * vein * vein},
                   {"M", 0.006 * vein},
                   {"Y", 0.01 * vein}});
    }
    return [options](const Place& p) -> Material {
        const double f = options.feature_mm;
        const double along = (p[0] + 0.6 * p[1] + 0.8 * p[2]) / f +
                             1.8 * turbulence(options.seed, {p[0] / f / 2, p[1] / f / 2, p[2] / f / 2});
        const double vein = std::pow(1 - std::abs(std::sin(3.14159265358979 * along)), 2.5);
        return static_cast<Material>(1 + std::clamp(static_cast<int>(levels * vein), 0, levels - 1));
    };
}

MaterialAt stone(const SlabOptions& options, Mixer& mixer) {
    constexpr int kinds = 48;
    for (int i = 0; i < kinds; ++i) {
        RandomStream random(options.seed, static_cast<std::uint64_t>(i), 17);
        const double white = 0.15 * std::pow(6.0, random.uniform());  // 0.15 to 0.9
        const double dark = 0.03 * std::pow(random.uniform(), 2), warm = 0.03 * random.uniform();
        mixer.add({{"W", white},
                   {"K", dark},
                   {"Y", warm},
                   {"M", 0.3 * warm * random.uniform()},
                   {"C", 0.004 * random.uniform()}});
    }
    return [options](const Place& p) -> Material {
        const double f = options.feature_mm;
        return static_cast<Material>(1 + grain_at(options.seed, {p[0] / f, p[1] / f, p[2] / f}) % kinds);
    };
}

void check_range(const char* name, double value, double least, double most, const char* unit) {
    if (!(value >= least && value <= most))
        throw InputError(fmt::format("{} is {}{}, expected {} to {}{}.", name, value, unit, least, most, unit));
}

}  // namespace

void SlabOptions::validate() const {
    check_range("The number of columns across", width, 1, 4096, "");
    check_range("The number of columns along", height, 1, 4096, "");
    check_range("The margin", margin, 0, 256, " columns");
    check_range("The pitch", pitch_mm, 1e-3, 100, " mm");
    check_range("The thickness of the slab", thickness_mm, 1e-3, 1000, " mm");
    check_range("The depth of a voxel", layer_mm, 1e-4, 100, " mm");
    check_range("The size of the pattern", feature_mm, 1e-2, 1e4, " mm");
    check_range("The number of layers", std::round(thickness_mm / layer_mm), 1, 2048, "");
}

MixtureSlab make_slab(const ResinSet& resins, const SlabOptions& options) {
    options.validate();
    resins.validate();
    Mixer mixer(resins);
    MaterialAt material_at;
    switch (options.pattern) {
        case SlabPattern::chess:
            material_at = chess(options, mixer);
            break;
        case SlabPattern::marble:
            material_at = marble(options, mixer);
            break;
        case SlabPattern::stone:
            material_at = stone(options, mixer);
            break;
    }
    const int layers = static_cast<int>(std::lround(options.thickness_mm / options.layer_mm));
    const auto margin = static_cast<int>(options.margin), height = static_cast<int>(options.height);
    const std::array<int, 3> size{static_cast<int>(options.width) + 2 * margin, height + 2 * margin, layers};
    const auto middle = [&](int column) { return (column + 0.5) * options.pitch_mm; };
    MixtureSlab slab;
    slab.volume =
        make_resin_volume(size, {options.pitch_mm, options.pitch_mm, options.layer_mm}, [&](int x, int y, int z) {
            return material_at(
                {middle(x - margin), middle(height - 1 - (y - margin)), (layers - z - 0.5) * options.layer_mm});
        });
    slab.mixtures = std::move(mixer).finish();
    return slab;
}

}  // namespace voxtone::optics
