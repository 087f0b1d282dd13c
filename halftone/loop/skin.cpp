// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/skin.h"

#include <cmath>

#include "base/parallel.h"

namespace voxtone::halftone {

std::vector<CumulativeMixture> cumulative_mixtures(const SkinMixtures& skin) {
    const std::size_t resins = skin.resins(), n = skin.cells() * skin.layers();
    std::vector<CumulativeMixture> out(n);
    parallel_for(0, n, 4096, [&](std::size_t i) {
        const float* const fraction = skin.all().data() + i * resins;
        float sum = 0, below = 0;
        for (std::size_t r = 0; r < resins; ++r) sum += std::max(fraction[r], 0.0f);
        out[i].bound.fill(65535);
        if (!(sum > 0)) return;
        for (std::size_t r = 0; r + 1 < resins; ++r) {
            below += std::max(fraction[r], 0.0f);
            out[i].bound[r] = static_cast<std::uint16_t>(std::min(65535.0f, std::round(65536 * below / sum)));
        }
    });
    return out;
}

}  // namespace voxtone::halftone
