// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/mixture_fill.h"

#include <cstdint>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

/// The resin that every threshold selects; -1: there are several.
int only_resin(const halftone::CumulativeMixture& mixture, int resins) {
    constexpr std::uint16_t least = 0, most = 65534;
    const int first = halftone::select_resin(mixture, least, resins);
    return first == halftone::select_resin(mixture, most, resins) ? first : -1;
}

}  // namespace

MixtureFill::MixtureFill(const halftone::CumulativeMixture& mixture, int resins, halftone::BlueNoiseScreen screen)
    : mixture_(mixture), resins_(resins), pure_(only_resin(mixture, resins)), screen_(std::move(screen)) {
    VOXTONE_EXPECT(resins >= 1 && resins <= halftone::max_resins);
}

void MixtureFill::push(int begin, int end, int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const {
    if (pure_ >= 0) {
        out.push(static_cast<std::uint32_t>(end - begin), static_cast<io::Material>(1 + pure_));
        return;
    }
    const std::uint16_t* const thresholds = screen_.row(j + at[1], k + at[2]);
    for (int i = begin; i < end; ++i)
        out.push(1, static_cast<io::Material>(
                        1 + halftone::select_resin(mixture_, thresholds[(i + at[0]) & halftone::BlueNoiseScreen::mask],
                                                   resins_)));
}

}  // namespace voxtone::slicer
