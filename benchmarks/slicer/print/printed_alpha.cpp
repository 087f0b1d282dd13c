// SPDX-License-Identifier: GPL-3.0-or-later
//
// Translucency alpha of printed voxels below places of a body's surface, by light paths.
//   printed_alpha STACK [PATHS] < PLACES > READINGS
// PLACES: lines of x y z in mm from the low corner of the print's box and an outward normal. READINGS: for each line
// alpha, and how thick the body is there, mm.
//
// What is read below a place: shares of resins in layers of 0.027 mm along the normal, of voxels within 0.35 mm of it,
// down to the middle of the wall or 2 mm. The standard's slab of 4 mm has these layers from both sides, deeper ones as
// the last; its voxels are drawn at random by these shares (a screen's are more even), it stands among mirrors, and the
// alpha is that of the grey that reads the same on white and in transmission (optics/layered/translucency_alpha.h).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <vector>

#include <Eigen/Geometry>

#include "base/progress.h"
#include "base/random.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/translucency_alpha.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "slicer/predict/stack_volume.h"

using namespace voxtone;
using Eigen::Vector3d;

namespace {

constexpr double step_mm = 0.027, around_mm = 0.35, deepest_mm = 2;
constexpr std::array<int, 3> slab_voxels{64, 32, 148};

using Shares = std::vector<double>;

class Stack {
public:
    explicit Stack(const slicer::StackVolume& stack) : volume_(stack.volume), resins_(stack.resins) {}

    [[nodiscard]] optics::Material at(const Vector3d& mm) const {
        std::array<int, 3> voxel{};
        for (int a = 0; a < 3; ++a) {
            const auto axis = std::size_t(a);
            voxel[axis] = int(std::floor(mm[a] / volume_.pitch_mm()[axis]));
            if (voxel[axis] < 0 || voxel[axis] >= volume_.size()[axis]) return optics::air;
        }
        return volume_.at(voxel[0], voxel[1], voxel[2]);
    }
    [[nodiscard]] double thickness(const Vector3d& place, const Vector3d& inward) const {
        double depth = 0.1;  // the place may lie a little outside
        while (at(place + depth * inward) != optics::air) depth += step_mm / 2;
        return depth;
    }
    /// From the surface down.
    [[nodiscard]] std::vector<Shares> layers(const Vector3d& place, const Vector3d& inward, double down_mm) const {
        const Vector3d u = inward.unitOrthogonal(), v = inward.cross(u);
        std::vector<Shares> out;
        constexpr int half = 14;
        for (double depth = step_mm / 2; depth < std::max(down_mm, 2 * step_mm); depth += step_mm) {
            Shares shares(resins_.resins.size());
            double all = 0;
            for (int i = -half; i <= half; ++i)
                for (int j = -half; j <= half; ++j) {
                    if (i * i + j * j > half * half) continue;
                    const auto material =
                        at(place + depth * inward + around_mm / half * (double(i) * u + double(j) * v));
                    if (material == optics::air) continue;
                    shares[std::size_t(material - 1)] += 1, all += 1;
                }
            if (all == 0) continue;
            for (double& share : shares) share /= all;
            out.push_back(shares);
        }
        return out;
    }

private:
    const optics::ResinVolume& volume_;
    const optics::ResinSet& resins_;
};

double alpha_of(const std::vector<Shares>& layers, const optics::ResinSet& resins,
                const optics::TranslucencyScale& scale, std::uint32_t paths) {
    const int last = int(layers.size()) - 1;
    const auto drawn = [&](int i, int j, int k) {
        const Shares& shares = layers[std::size_t(std::min({k, slab_voxels[2] - 1 - k, last}))];
        double left = RandomStream(7, std::uint64_t((k * slab_voxels[1] + j) * slab_voxels[0] + i)).uniform();
        std::size_t resin = 0;
        while (resin + 1 < shares.size() && left >= shares[resin]) left -= shares[resin++];
        return optics::Material(resin + 1);
    };
    const optics::ResinVolume volume = optics::make_resin_volume(slab_voxels, {25.4 / 600, 25.4 / 300, step_mm}, drawn);
    const optics::MonteCarlo model({.paths = paths});
    const optics::ObservedColour<float> observed(resins.channels);
    const auto luminance = [&](optics::Backing backing) {
        const optics::Scene scene{&volume, &resins, backing, optics::Sides::mirrored};
        const auto top = optics::find_surface(scene, {slab_voxels[0], slab_voxels[1], 1}, optics::SurfacePart::top);
        const std::vector<float> value = model.predict(scene, top).value;
        return double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(observed.absolute(value.data())));
    };
    const double through = luminance(optics::Backing::none) - luminance(optics::Backing::black);
    return optics::translucency_alpha(scale.eta_per_cm({luminance(optics::Backing::white), std::max(through, 1e-9)}));
}

}  // namespace

int main(int count, char** words) {
    if (count < 2) return std::fprintf(stderr, "printed_alpha STACK [PATHS] < PLACES\n"), 2;
    const auto paths = count > 2 ? std::uint32_t(std::strtoul(words[2], nullptr, 10)) : 6000;
    Progress progress;
    const slicer::StackVolume read = slicer::read_stack_volume({.stack = words[1]}, progress);
    const Stack stack(read);
    const optics::TranslucencyScale scale(read.resins.eta);
    Vector3d place, normal;
    while (std::cin >> place.x() >> place.y() >> place.z() >> normal.x() >> normal.y() >> normal.z()) {
        const Vector3d inward = -normal.normalized();
        const double thick_mm = stack.thickness(place, inward);
        const auto layers = stack.layers(place, inward, std::min(thick_mm / 2, deepest_mm));
        std::printf("%.4f %.3f\n", layers.empty() ? -1.0 : alpha_of(layers, read.resins, scale, paths), thick_mm);
    }
    return 0;
}
