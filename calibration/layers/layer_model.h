// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colours of laminates as a function of what is fitted (layer_fit.h):
//
//   XYZ_k / white_k = gain sum_c (w_ck / sum_j w_jk) (surface + rho_c)
//
// rho_c of layers of absorption a_rc and scattering s_rc, mm^-1 (laminate_reflectance.h). Unknowns: ln a, ln s, ln w,
// and roots of surface and gain, as in calibration/chart/observer_model.h.
#pragma once

#include <Eigen/Core>

#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_model.h"
#include "calibration/layers/laminate_reflectance.h"
#include "calibration/layers/layer_chart.h"

namespace voxtone::calibration {

/// Bands of observer_start.h; absorption from the laminates that show most of a resin.
[[nodiscard]] ObserverParts layer_start(const LayerChart& chart, Eigen::Index channels);

class LayerModel : public ColourModel {
public:
    LayerModel(const LayerChart& chart, Eigen::Index channels, double g, double eta);

    [[nodiscard]] Eigen::Index unknowns() const override { return observer_.unknowns(); }
    void prepare(const Eigen::VectorXd& unknowns, bool with_derivatives) override;
    [[nodiscard]] Eigen::Vector3d colour(Eigen::Index row, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const override;

    [[nodiscard]] ObserverParts parts(const Eigen::VectorXd& unknowns) const { return observer_.parts(unknowns, {}); }
    [[nodiscard]] Eigen::VectorXd unknowns_of(const ObserverParts& parts) const { return observer_.unknowns_of(parts); }
    /// CIELAB's roots of all laminates.
    [[nodiscard]] Eigen::MatrixX3d roots(const ObserverParts& parts);

private:
    Eigen::Index resins_, channels_;
    ObserverModel observer_;
    LaminateReflectance laminates_;
    ObserverParts parts_;
    Eigen::MatrixXd rho_;                       ///< laminates x channels
    std::vector<Eigen::MatrixXd> by_a_, by_s_;  ///< of each channel, laminates x resins: by ln a, ln s
};

}  // namespace voxtone::calibration
