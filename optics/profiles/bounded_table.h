// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers under a smooth surface (bounded_totals, resin_profile.h) for many mixtures: a table over optical depth and
// albedo.
//
// Axes sqrt(tau) and sqrt(1 - albedo): along them reflection grows without kinks (for deep layers it is 1 - c sqrt(1 -
// albedo)). 33 x 33 samples by 16 directions; error up to tau = 10 below 1e-3 (tested). What adds up to 1 without
// absorption does so here.
#pragma once

#include "base/progress.h"
#include "optics/numerics/bicubic_table.h"
#include "optics/profiles/resin_profile.h"

namespace voxtone::optics {

class BoundedTable {
public:
    /// For optical depths up to most_tau > 0.
    BoundedTable(double g, double eta, double most_tau, const Progress* progress = nullptr);
    /// Of a layer that absorbs and scatters this much on the way straight through: sigma_a h and sigma_s h.
    [[nodiscard]] BoundedTotals at(double absorption, double scattering) const;

private:
    double turned_back_;
    BicubicTable R_top_, lost_down_,
        R_bottom_;  // lost_down: share of what is not sent back at the top that is absorbed
};

}  // namespace voxtone::optics
