// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/transport.h"

#include <algorithm>
#include <string>

#include "base/contracts.h"
#include "base/error.h"
#include "base/step_part.h"
#include "optics/transport/viewing_sequence.h"

namespace voxtone::optics {
TransportPredictor::TransportPredictor(const TransportOptions& options) : options_(options) {
    if (options.sweeps < 1)
        throw UsageError("the predictor needs at least 1 sweep, not " + std::to_string(options.sweeps));
    if (!(options.cell_mm > 0)) throw UsageError("the predictor's cells must be larger than 0 mm");
    VOXTONE_EXPECT(options.tile_cells >= 1 && options.tile_halo >= 1);
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    TransportSummary summary;
    return predict(scene, surface, summary, progress);
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, TransportSummary& summary,
                                       const Progress* progress) const {
    VOXTONE_EXPECT(scene.volume && scene.resins);
    ViewingSequence sequence(scene, surface, options_, progress);
    Appearance seen = sequence.only(*scene.volume, progress);
    summary = sequence.summary();
    return seen;
}

TwinAppearances TransportPredictor::predict_with_twin(const Scene& scene, const Surface& surface,
                                                      const ResinVolume& twin, const Progress* progress) const {
    VOXTONE_EXPECT(scene.volume && scene.resins);
    ViewingSequence sequence(scene, surface, options_, progress);
    const auto half = [&](const ResinVolume& volume, double from) {
        const PartRange range(progress, from, from + 0.5);
        return sequence.only(volume, progress);
    };
    Appearance body = half(*scene.volume, 0);
    return {std::move(body), half(twin, 0.5)};
}

std::size_t TransportPredictor::least_bytes(double solid_mm3, const std::array<double, 3>& pitch_mm) const {
    constexpr double of_a_block = 64 * 100;  // moments and equations
    constexpr double least_blocks = 32;      // of a tile and the halo around it, where the body has as many
    const std::array<int, 3> view = cell_voxels(pitch_mm, options_.cell_mm);
    double block_mm3 = 1;
    for (std::size_t a = 0; a < 3; ++a) block_mm3 *= 4 * view[a] * pitch_mm[a];
    return static_cast<std::size_t>(of_a_block * std::min(solid_mm3 / block_mm3, least_blocks));
}

std::unique_ptr<AppearanceSequence> TransportPredictor::sequence(const Scene& scene, const Surface& surface,
                                                                 const Progress* progress) const {
    return ViewingSequence::within_memory(scene, surface, options_, progress);
}

}  // namespace voxtone::optics
