// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is known of resins before their patches are looked at: values of v and ln sigma_t (resin_coordinates.h) with the
// inverse of their covariance, which a fit adds to its squares. From edge profiles (NAME.edge.json of `calibrate edge
// fit`), which see g and each resin by itself; patches see dark channels and what resins share.
//
// A value that edges doubt counts as not known: of an opaque channel its albedo alone is taken. Values that a chart
// completed are read as the edges had them, so that no patch counts twice.
//
// What it leaves out: that errors of different resins have a part in common (the factor mu of the edges' bench).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {

/// Of one resin in one channel.
struct PriorValue {
    ResinPoint at;
    Eigen::Matrix2d precision = Eigen::Matrix2d::Zero();  ///< of v and ln sigma_t; 0: nothing is known
    /// How many of the two are known.
    [[nodiscard]] int known() const { return (precision(0, 0) > 0) + (precision(1, 1) > 0); }
};

/// The inverse of a covariance where both are known; of one of them, that of its own variance.
[[nodiscard]] Eigen::Matrix2d prior_precision(const Eigen::Matrix2d& covariance, bool v_known, bool ln_sigma_t_known);

struct ResinPrior {
    struct Resin {
        std::string role;
        std::array<PriorValue, 3> channel;  ///< R, G, B
    };
    std::string source;
    double g = 0.4, eta = 1.5;  ///< at which the values hold
    std::vector<Resin> resins;  ///< none: there is no prior
    [[nodiscard]] const Resin* find(std::string_view role) const;
};

/// Throws InputError that names file, key and rule.
[[nodiscard]] ResinPrior parse_resin_prior(std::string_view text, const std::string& source);
/// Throws FileError, InputError.
[[nodiscard]] ResinPrior read_resin_prior(const std::filesystem::path& file);

}  // namespace voxtone::calibration
