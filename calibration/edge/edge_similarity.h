// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well similarity theory holds for fitted resins, and what the anisotropy g is worth (Elek et al. 2017, supplement,
// Sec. 6.1, Fig. 9): for every g of the dictionary the map of the distance (Eq. 1) over extinction and albedo, where it
// is least, and the medium that is similar to the fitted one,
//
//   sigma_a' = sigma_a    sigma_s' = sigma_s (1 - g) / (1 - g')                                        (Eqs. 4 to 6)
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "calibration/edge/edge_fit.h"

namespace voxtone::calibration {

/// One resin in one channel at one g.
struct EdgeMap {
    double g = 0;
    EdgeMedium fitted, similar;            ///< where the distance is least; what is similar to the fit of the resin
    double at_fitted = 0, at_similar = 0;  ///< distances
    Eigen::MatrixXd distance;              ///< rows: extinctions, columns: albedos of EdgeSimilarity
};

struct EdgeSimilarity {
    std::vector<double> sigma_t, co_albedo;  ///< of the maps; ascending, even in their logarithms
    /// Per resin and channel, one map for every g; none where no slab could be used.
    std::vector<std::array<std::vector<EdgeMap>, 3>> maps;
    /// Root mean square of ln(sigma_t fitted / similar), and of the difference in v, over all g at which the similar
    /// medium lies within the dictionary.
    struct Agreement {
        double ln_sigma_t = 0, v = 0;
    };
    [[nodiscard]] Agreement agreement(std::size_t resin, std::size_t channel) const;
};

/// Over all g of the table's grid, which it prepares. Fills `by_g` and `similar` of the fit's resins where they are
/// empty and there is more than one g.
[[nodiscard]] EdgeSimilarity edge_similarity(EdgeFit& fit, const std::vector<EdgeProfile>& profiles,
                                             EdgeProfileTable& table, const EdgeFitOptions& options,
                                             const Progress* progress = nullptr);

}  // namespace voxtone::calibration
