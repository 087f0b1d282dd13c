// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/interaction_radius.h"

#include <algorithm>
#include <cmath>

#include "voxtone/base/contracts.h"
#include "voxtone/optics/transport/transport.h"

namespace voxtone::optics {

double interaction_radius(const ResinSet& resins, const std::array<double, 3>& pitch_mm, std::size_t core,
                          std::size_t changed, double tolerance) {
    VOXTONE_EXPECT(core < resins.resins.size() && changed < resins.resins.size() && tolerance > 0);
    constexpr double long_mm = 24, thick_mm = 3.2;
    TransportOptions options;
    options.sweeps = 6;
    options.start_tolerance = 1e-5;
    const std::array<int, 3> view = cell_voxels(pitch_mm, options.cell_mm);
    const std::array<int, 3> size{static_cast<int>(long_mm / (pitch_mm[0] * view[0])) * view[0], 4 * view[1],
                                  static_cast<int>(std::lround(thick_mm / pitch_mm[2]))};
    const auto run = [&](bool line) {
        const ResinVolume volume = make_resin_volume(size, pitch_mm, [&](int x, int, int z) {
            return 1 + (line && x < view[0] && z >= size[2] - view[2] ? changed : core);
        });
        const Scene scene{&volume, &resins, Backing::black, Sides::mirrored};
        return TransportPredictor(options).predict(scene, find_surface(scene, view, SurfacePart::top));
    };
    const Appearance before = run(false), after = run(true);
    const std::size_t columns = static_cast<std::size_t>(size[0] / view[0]), channels = before.channels;
    double radius = 0;
    for (std::size_t x = 0; x < columns; ++x)
        for (std::size_t c = 0; c < channels; ++c)
            if (std::abs(after.value[x * channels + c] - before.value[x * channels + c]) >
                static_cast<float>(tolerance))
                radius = (static_cast<double>(x) + 1) * pitch_mm[0] * view[0];
    return radius;
}

double interaction_radius(const ResinSet& resins, const std::array<double, 3>& pitch_mm, std::size_t core,
                          double tolerance) {
    double radius = 0;
    for (std::size_t r = 0; r < resins.resins.size(); ++r)
        if (r != core) radius = std::max(radius, interaction_radius(resins, pitch_mm, core, r, tolerance));
    return radius;
}

}  // namespace voxtone::optics
