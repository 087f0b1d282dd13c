// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/widening_targets.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::scattering {

std::vector<ChannelProfiles> widening_targets(const ChannelProfiles& narrow, const ChannelProfiles& wide,
                                              std::size_t count) {
    VOXTONE_EXPECT(count >= 1 && narrow.size() == wide.size());
    std::vector<ChannelProfiles> targets(count, narrow);
    for (std::size_t c = 0; c < narrow.size(); ++c) {
        VOXTONE_EXPECT(narrow[c].size() == wide[c].size() && !narrow[c].empty() && narrow[c][0] > 0 && wide[c][0] > 0);
        const double total = std::min(narrow[c][0], wide[c][0]);
        for (std::size_t t = 0; t < count; ++t) {
            const double share = count > 1 ? static_cast<double>(t) / static_cast<double>(count - 1) : 0;
            for (std::size_t i = 0; i < narrow[c].size(); ++i)
                targets[t][c][i] =
                    share * wide[c][i] * (total / wide[c][0]) + (1 - share) * narrow[c][i] * (total / narrow[c][0]);
        }
    }
    return targets;
}

}  // namespace voxtone::scattering
