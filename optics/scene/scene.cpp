// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/scene.h"

#include <cstddef>
#include <string>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::optics {

void require_resins(const Scene& scene) {
    VOXTONE_EXPECT(scene.volume && scene.resins);
    const auto counts = scene.volume->count();
    for (std::size_t m = 1; m < counts.size(); ++m)
        if (counts[m] > 0 && m > scene.resins->resins.size())
            throw InputError(
                "the volume has " + std::to_string(counts[m]) + " voxels of material " + std::to_string(m) +
                ", but the resin set '" + scene.resins->name + "' ends at " +
                std::to_string(scene.resins->resins.size()) +
                ": without its absorption and scattering nothing can be predicted; name a set that has it");
}

}  // namespace voxtone::optics
