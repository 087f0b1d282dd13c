// SPDX-License-Identifier: GPL-3.0-or-later
//
// From measured patches to a set of resins: every channel by the Principles and a joint least-squares refinement
// (channel_fit.h), in parallel; then what is known of every value, and what is not.
//
// Errors. Standard errors are those of the coordinates v and ln sigma_t (resin_coordinates.h), in which they are near
// to normal: `low` and `high` are the ends of one standard error there (bounded_interval.h where an albedo is near 0 or
// 1, so that truths lie between them in 68 % of cases there too); `standard_error` is the same to first order in albedo
// and mm^-1. They follow from the noise of the patches: their own errors, or one constant. Where the residuals of a
// channel are larger than the noise can explain (chi2 beyond its 99.9 % point), errors are scaled up by the root of
// chi2 per degree of freedom, and the channel is listed in `misfit`.
//
// What is known before (resin_prior.h: edge profiles) counts like patches do; where a value and its prior are farther
// apart than once in a thousand times by chance, a warning names it. A resin of the prior that has no patch is taken as
// it is there.
//
// What it cannot see: g and eta (by similarity a wrong g is mostly a wrong extinction: sigma_a and sigma_s (1 - g)
// stay); errors that all patches share, such as a wrong white reference.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_model.h"
#include "calibration/patches/patch_table.h"
#include "calibration/resins/resin_prior.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct FitOptions {
    PatchModelOptions model;
    double noise = 0.005;               ///< standard error of a reflectance where the table gives none; above 0
    std::vector<std::string> expected;  ///< resins that must have been measured; may be empty
    std::string name = "calibrated";    ///< of the set
    ResinPrior prior;                   ///< may be empty; its g and eta are those of `model`
    bool fit_dot_spread = false;  ///< of `model` with a pitch: by dot_spread_fit.h; where nothing tells it, it stays
};

/// Throws InputError that names the option, its value and the rule.
void validate(const FitOptions& options);

/// Why a value is not to be relied on.
enum class Doubt {
    assumed,  ///< clear resin: it scatters nothing, nor does it absorb where no deep square tells
    dark,     ///< albedo: reflects too little to tell it from 0; `high` is what is known
    opaque,   ///< extinction: its squares hide the base; the value is a lower limit
    thin,     ///< its squares are so clear that albedo and extinction cannot be told apart
    bound,    ///< at the end of the searched range
    second,   ///< other values explain the patches nearly as well
    unsure,   ///< error larger than 0.1 in v or 0.35 in ln sigma_t, for none of these reasons
};
[[nodiscard]] std::string_view doubt_name(Doubt doubt);
/// One line for the user.
[[nodiscard]] std::string_view doubt_meaning(Doubt doubt);

struct FittedValue {
    double value = 0, standard_error = 0;
    double low = 0, high = 0;
    std::vector<Doubt> doubts;
};

struct FittedResin {
    std::string role;
    std::vector<FittedValue> albedo, sigma_t;  ///< per channel
    std::vector<FittedValue> reduced;          ///< sigma_a + sigma_s (1 - g), mm^-1 (Sec. 6.7); no doubts of its own
};

struct ResinFit {
    optics::ResinSet set;
    std::vector<FittedResin> resins;  ///< in the order of the set
    /// By channel: of v and ln sigma_t of each fitted resin in turn, the first ones of the set.
    std::vector<Eigen::MatrixXd> covariance;
    PatchCheck patches;                 ///< predicted against measured
    std::vector<double> chi2;           ///< per channel
    int freedom = 0;                    ///< patches less fitted values, per channel
    double dot_spread_error = 0;        ///< standard error of the set's; 0: it was not fitted
    std::vector<std::size_t> misfit;    ///< channels whose residuals the noise does not explain
    std::vector<std::string> warnings;  ///< where patches and prior disagree, or do not tell the dot spread
    double seconds = 0;
};

/// Throws InputError where a calibration is not possible (principles.h), naming patch or resin.
[[nodiscard]] ResinFit fit_resins(const PatchTable& table, const FitOptions& options,
                                  const Progress* progress = nullptr);

}  // namespace voxtone::calibration
