// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colours of thin squares upon a base as a function of the unknowns of a chart of thick mixtures (observer_model.h):
// what shines through a square of known thickness tells lengths, which thick mixtures do not.
//
//   XYZ_k / white_k = gain sum_c w_ck (surface + rho_c(S_c a, S_c s, thickness)) (calibration/patches/patch_model.h)
//
// Squares of the chart's own table were read by its instrument; those of another table are reflectances of a perfect
// diffuser, of which gain is 1 and surface 0. Laminates are such squares too; there are thousands of them, seen along
// eight directions. Units mm, mm^-1. What it cannot see: the sides of a square, layers that have run into each other.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "calibration/chart/chart_data.h"
#include "calibration/chart/observer_model.h"
#include "calibration/patches/patch_model.h"

namespace voxtone::calibration {

class SquareColours {
public:
    SquareColours(const ThinSquares& squares, std::vector<std::string> roles, const ObserverModel& model);

    [[nodiscard]] Eigen::Index squares() const { return squares_.roots.rows(); }
    /// To be called before colours of these parts are asked for.
    void prepare(const ObserverParts& parts, bool with_derivatives);
    /// XYZ / white of a square and, where they were prepared, its derivatives by the model's unknowns.
    [[nodiscard]] Eigen::Vector3d colour(Eigen::Index square, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const;
    /// CIELAB's roots of all.
    [[nodiscard]] Eigen::MatrixX3d roots(const ObserverParts& parts);

private:
    const ThinSquares& squares_;
    std::vector<std::string> roles_;
    const ObserverModel& model_;
    PatchModelOptions options_;
    std::shared_ptr<const optics::OrdinatePlan> plan_;
    ObserverParts parts_;
    Eigen::MatrixXd rho_;              ///< squares x channels
    std::vector<Eigen::MatrixXd> by_;  ///< of each channel, squares x (2 resins + 1): by ln sigma_a, ln sigma_s, chord
};

}  // namespace voxtone::calibration
