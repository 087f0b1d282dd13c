// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/transport_options.h"

#include <cmath>

#include "base/warning.h"

namespace voxtone::optics {

std::vector<std::string> remarks_of(const TransportSummary& s) {
    constexpr double much_clipped = 1e-3, much_change = 0.02;
    const auto percent = [](double share) {
        return std::to_string(std::lround(1000 * share) / 10) + "." + std::to_string(std::lround(1000 * share) % 10) +
               " %";
    };
    std::vector<std::string> remarks;
    if (s.kept_values > 0) {
        const double share = static_cast<double>(s.clipped_values) / static_cast<double>(s.kept_values);
        if (share > much_clipped)
            remarks.push_back(named_warning(
                "prediction-doubt",
                "the prediction kept " + percent(share) +
                    " of its light clipped to what 16 bits hold (from 0 to 2 times the light around the body): "
                    "dark or very bright places may be wrong there; compare with --predict monte-carlo"));
    }
    if (s.open_solves > 0)
        remarks.push_back(named_warning(
            "prediction-doubt",
            std::to_string(s.open_solves) +
                " diffusion solves of the prediction ended before they reached their tolerance: light may "
                "not have spread through the whole body; predict with more --sweeps"));
    if (s.mean_change > much_change)
        remarks.push_back(
            named_warning("prediction-doubt", "the last sweep of the prediction still changed what is seen by " +
                                                  percent(s.mean_change) +
                                                  " on average: predict with more --sweeps (6 to 8 for clear resin)"));
    return remarks;
}

}  // namespace voxtone::optics
