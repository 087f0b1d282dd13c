// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/resin_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "calibration/fit/bounded_interval.h"
#include "calibration/fit/channel_fit.h"
#include "calibration/fit/dot_spread_fit.h"
#include "calibration/patches/patch_file.h"

namespace voxtone::calibration {

namespace {

// chi2 that is exceeded once in a thousand times (Wilson, Hilferty 1931).
double chi2_limit(int freedom) {
    const double n = freedom, a = 2 / (9 * n), cube = 1 - a + 3.0902 * std::sqrt(a);
    return n * cube * cube * cube;
}

void doubt(FittedValue& value, Doubt reason) {
    if (std::ranges::find(value.doubts, reason) == value.doubts.end()) value.doubts.push_back(reason);
}

// Thickness of a resin's thickest pure square upon another one; 0 where it has none.
double square_mm(const PatchTable& table, const std::string& role) {
    double most = 0;
    for (const Patch& patch : table.patches)
        if (patch.top.size() == 1 && patch.top.front().role == role && patch.backing != role)
            most = std::max(most, patch.thickness_mm);
    return most;
}

// One standard error to either side. Near the ends of what an albedo can be, v has the interval of a bounded value, and
// ln sigma_t, which leans on v with slope b, takes from it b times v's way to either side and its own remaining error.
std::pair<ResinPoint, ResinPoint> interval(const ChannelFit& fit, std::size_t role, double scale,
                                           const ResinBounds& bounds) {
    const ResinPoint& at = fit.resins[role];
    const auto i = static_cast<Eigen::Index>(2 * role);
    const double v_error = scale * fit.errors[role].v, v_variance = std::max(fit.covariance(i, i), 1e-300);
    const double lean = fit.covariance(i, i + 1) / v_variance;
    const double own = scale * scale * std::max(fit.covariance(i + 1, i + 1) - lean * lean * v_variance, 0.0);
    double v_low = at.v - v_error, v_high = at.v + v_error;
    const double to_black = bounds.most_v - fit.beyond[role].v, to_white = fit.beyond[role].v - bounds.least_v;
    if (to_black < 2 * v_error && to_black <= to_white) {
        const Interval of = interval_above_zero(to_black / v_error);
        v_low = bounds.most_v - of.high * v_error, v_high = bounds.most_v - of.low * v_error;
    } else if (to_white < 2 * v_error) {
        const Interval of = interval_above_zero(to_white / v_error);
        v_low = bounds.least_v + of.low * v_error, v_high = bounds.least_v + of.high * v_error;
    }
    v_low = std::min(v_low, at.v), v_high = std::max(v_high, at.v);
    const double down = lean > 0 ? at.v - v_low : v_high - at.v, up = lean > 0 ? v_high - at.v : at.v - v_low;
    const auto reach = [&](double v) { return std::sqrt(own + lean * lean * v * v); };
    return {clamped({v_low, at.ln_sigma_t - reach(down)}, bounds),
            clamped({v_high, at.ln_sigma_t + reach(up)}, bounds)};
}

constexpr double disagreement[] = {0, 10.83, 13.82};  // chi2 of so many values, exceeded once in a thousand times

std::string disagreement_text(const std::string& role, const std::string& channel, double chi2,
                              const std::string& prior) {
    return fmt::format(
        "{} in {}: the patches want other values than {} has, by {:.1f} of its errors. Is it the same resin, are the "
        "thicknesses of squares and slabs right, and the white references of both measurements?",
        role, channel, prior, std::sqrt(chi2));
}

// sigma_a + sigma_s (1 - g) = sigma_t (1 - g alpha), of a value whose coordinates have this covariance.
FittedValue reduced_of(const ResinPoint& at, const Eigen::Matrix2d& covariance, double g) {
    const double share = 1 - g * albedo_of_v(at.v, g), value = std::exp(at.ln_sigma_t) * share;
    const Eigen::Vector2d slope(-g * albedo_by_v(at.v, g) / share, 1);  // of its logarithm
    const double spread = std::sqrt(std::max(slope.dot(covariance * slope), 0.0));
    return {value,
            std::min(value * spread, resin_bounds(g).most_sigma_t),
            value * std::exp(-spread),
            value * std::exp(spread),
            {}};
}

// A resin without patches.
FittedResin known_resin(const ResinPrior::Resin& known, double g, optics::ResinSet& set) {
    FittedResin fitted{known.role, {}, {}, {}};
    optics::Resin& resin = set.resins.emplace_back(optics::Resin{known.role, known.role, {}, {}});
    for (const PriorValue& value : known.channel) {
        const ResinPoint& at = value.at;
        // What is not known at all has a precision of 0, and no error is told.
        Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
        if (value.known() == 2)
            covariance = value.precision.inverse();
        else
            for (int k = 0; k < 2; ++k)
                if (value.precision(k, k) > 0) covariance(k, k) = 1 / value.precision(k, k);
        const Eigen::Vector2d errors = covariance.diagonal().cwiseSqrt();
        const double v = errors[0], ln = errors[1], albedo = albedo_of_v(at.v, g), sigma_t = std::exp(at.ln_sigma_t);
        fitted.albedo.push_back({albedo,
                                 std::abs(albedo_by_v(at.v, g)) * v,
                                 albedo_of_v(std::min(at.v + v, 1.0), g),
                                 albedo_of_v(std::max(at.v - v, 0.0), g),
                                 {}});
        fitted.sigma_t.push_back({sigma_t, sigma_t * ln, sigma_t * std::exp(-ln), sigma_t * std::exp(ln), {}});
        if (!(v > 0)) doubt(fitted.albedo.back(), Doubt::unsure);
        if (!(ln > 0)) doubt(fitted.sigma_t.back(), Doubt::unsure);
        fitted.reduced.push_back(reduced_of(at, covariance, g));
        resin.albedo.push_back(albedo);
        resin.sigma_t_per_mm.push_back(sigma_t);
    }
    return fitted;
}

// What is fitted where it is told; else `kept`, and a warning.
double told_spread(const DotSpreadFit& fit, bool mixed, double kept, ResinFit& result) {
    if (fit.error > 0) {
        result.dot_spread_error = fit.error;
        return fit.value;
    }
    const std::string why =
        mixed ? fmt::format(
                    "sharp voxels explain the patches nearly as well as ideal mixtures do (chi2 {:.1f} and "
                    "{:.1f} above the least)",
                    fit.sharp, fit.ideal)
              : "no square holds a mixture";
    result.warnings.push_back(named_warning(
        "assumed", fmt::format("how far droplets run together cannot be told: {}. Dot spread {:g} is taken; give "
                               "--dot-spread, or measure more mixtures",
                               why, kept)));
    return kept;
}

// Values, errors and doubts of one resin in one channel.
void describe(const ChannelFit& fit, std::size_t role, double scale, double thickness_mm, double g, FittedResin& resin,
              std::size_t channel) {
    const ResinBounds bounds = resin_bounds(g);
    const ResinPoint& at = fit.resins[role];
    const ResinPoint error{scale * fit.errors[role].v, scale * fit.errors[role].ln_sigma_t};
    const auto [low, high] = interval(fit, role, scale, bounds);
    FittedValue& albedo = resin.albedo[channel];
    albedo.value = albedo_of_v(at.v, g);
    albedo.low = albedo_of_v(high.v, g), albedo.high = albedo_of_v(low.v, g);
    albedo.standard_error = std::min(std::abs(albedo_by_v(at.v, g)) * error.v, 1.0);
    FittedValue& sigma_t = resin.sigma_t[channel];
    sigma_t.value = std::exp(at.ln_sigma_t);
    sigma_t.low = std::exp(low.ln_sigma_t), sigma_t.high = std::exp(high.ln_sigma_t);
    if (fit.opaque[role]) sigma_t.low = sigma_t.value, sigma_t.high = bounds.most_sigma_t;
    sigma_t.standard_error = std::min(sigma_t.value * error.ln_sigma_t, bounds.most_sigma_t);

    const auto i = static_cast<Eigen::Index>(2 * role);
    resin.reduced[channel] = reduced_of(at, scale * scale * fit.covariance.block<2, 2>(i, i), g);

    const bool weak_albedo = error.v > 0.1, weak_sigma_t = error.ln_sigma_t > 0.35;
    const bool dark = at.v + 2 * error.v >= bounds.most_v;
    const bool thin = thickness_mm > 0 && sigma_t.value * thickness_mm < 0.5;
    if (dark) doubt(albedo, Doubt::dark);
    if (fit.v_low[role]) doubt(albedo, Doubt::bound);
    if (fit.sigma_low[role] || (fit.sigma_high[role] && !fit.opaque[role])) doubt(sigma_t, Doubt::bound);
    if (fit.opaque[role]) doubt(sigma_t, Doubt::opaque);
    if (thin && (weak_albedo || weak_sigma_t || dark)) {
        doubt(albedo, Doubt::thin);
        doubt(sigma_t, Doubt::thin);
    }
    if (fit.second[role]) {
        doubt(albedo, Doubt::second);
        doubt(sigma_t, Doubt::second);
    }
    if (weak_albedo && albedo.doubts.empty()) doubt(albedo, Doubt::unsure);
    if (weak_sigma_t && sigma_t.doubts.empty()) doubt(sigma_t, Doubt::unsure);
}

// Clear resin, whose absorption is told.
void describe_clear(const ChannelFit& fit, std::size_t role, double scale, FittedResin& resin, std::size_t channel) {
    const double fitted = std::exp(fit.resins[role].ln_sigma_t);
    const double error = scale * fit.errors[role].ln_sigma_t * fitted;
    // To first order, below nothing too.
    const double beyond = fitted * (1 + fit.beyond[role].ln_sigma_t - fit.resins[role].ln_sigma_t);
    const Interval of = interval_above_zero(beyond / error);
    FittedValue& sigma_a = resin.sigma_t[channel];
    const bool none = fit.sigma_low[role];
    sigma_a = {none ? 0 : fitted, error, none ? 0 : of.low * error, of.high * error, {}};
    if (sigma_a.low <= 0) doubt(sigma_a, Doubt::thin);
    if (fit.sigma_high[role]) doubt(sigma_a, Doubt::bound);
    resin.reduced[channel] = sigma_a;
    resin.reduced[channel].doubts.clear();
    resin.albedo[channel] = {none ? 1.0 : 0.0, 0, 0, none ? 1.0 : 0.0, {Doubt::assumed}};
}

}  // namespace

std::string_view doubt_name(Doubt d) {
    switch (d) {
        case Doubt::assumed:
            return "assumed";
        case Doubt::dark:
            return "dark";
        case Doubt::opaque:
            return "opaque";
        case Doubt::thin:
            return "thin";
        case Doubt::bound:
            return "bound";
        case Doubt::second:
            return "second";
        case Doubt::unsure:
            return "unsure";
    }
    return {};
}

std::string_view doubt_meaning(Doubt d) {
    switch (d) {
        case Doubt::assumed:
            return "clear resin: taken as not scattering; nor as absorbing, where no square of it is 2 mm deep";
        case Doubt::dark:
            return "reflects too little to tell its albedo from 0; only the upper end is known";
        case Doubt::opaque:
            return "its squares hide the base: the extinction given is a lower limit; print it diluted with white";
        case Doubt::thin:
            return "its squares are so clear that albedo and extinction cannot be told apart; print thicker ones";
        case Doubt::bound:
            return "at the end of the searched range";
        case Doubt::second:
            return "other values explain its patches nearly as well; print it diluted in other shares";
        case Doubt::unsure:
            return "the patches say little of this value";
    }
    return {};
}

void validate(const FitOptions& options) {
    const auto fail = [](std::string_view what, double value, std::string_view rule) {
        throw InputError(fmt::format("{} is {}; {}.", what, value, rule));
    };
    if (!(std::abs(options.model.g) <= 0.95))
        fail("g", options.model.g, "the mean cosine of the scattering angle must lie between -0.95 and 0.95");
    if (!(options.model.eta >= 1 && options.model.eta <= 3))
        fail("eta", options.model.eta, "the refractive index must lie between 1 and 3 (resins have about 1.5)");
    if (!(options.noise > 0 && options.noise <= 1))
        fail("noise", options.noise,
             "the standard error of a reflectance must lie above 0 and at most at 1 (0.005 is usual)");
    const auto& pitch = options.model.pitch_mm;
    const bool none = pitch[0] == 0 && pitch[1] == 0 && pitch[2] == 0;
    for (const double p : pitch)
        if (!none && !(p > 0 && p <= 10))
            fail("pitch", p, "give the voxel's size along all axes, or none for ideal mixtures");
}

ResinFit fit_resins(const PatchTable& table, const FitOptions& options, const Progress* progress) {
    validate(options);
    const Stopwatch watch;
    const TargetRoles roles = find_target_roles(table, options.expected, options.noise);
    const ResinPrior& prior = options.prior;
    if (!prior.resins.empty() && !table.channels.is_rgb())
        throw InputError(fmt::format("{}: it has {}, the prior {} has R, G and B; measure the patches as R, G, B.",
                                     table.source, channels_text(table.channels), prior.source));
    VOXTONE_EXPECT(prior.resins.empty() || (prior.g == options.model.g && prior.eta == options.model.eta));
    ResinFit result;
    PatchModelOptions model = options.model;
    if (options.fit_dot_spread && !model.ideal_mixtures())
        model.dot_spread = told_spread(fit_dot_spread(table, roles, model, options.noise, prior, progress),
                                       has_mixtures(table), model.dot_spread, result);
    const ChannelFitter fitter(table, roles, model, options.noise, prior);
    const std::size_t channels = table.channels.size();
    std::vector<ChannelFit> fits(channels);
    parallel_for(
        0, channels, 1, [&](std::size_t c) { fits[c] = fitter.fit(c); }, progress);

    result.set.name = options.name;
    result.set.source = fmt::format("voxtone calibrate fit, {} patches of {}", table.patches.size(), table.source);
    if (!prior.resins.empty()) result.set.source += fmt::format(", and {}", prior.source);
    result.set.channels = table.channels;
    result.set.g = options.model.g, result.set.eta = options.model.eta;
    // Mixtures that were taken as ideal are to be sliced and predicted as such.
    result.set.dot_spread = model.ideal_mixtures() ? 1 : model.dot_spread;
    result.freedom = fits.front().freedom;
    std::vector<double> scale(channels, 1);
    for (std::size_t c = 0; c < channels; ++c) {
        result.chi2.push_back(fits[c].least_chi2);  // limits of opaque resins stand above it by what was agreed
        // With as many values as patches nothing is left to explain, but nonsense still does not fit.
        const int freedom = std::max(result.freedom, 1);
        if (!(fits[c].least_chi2 > chi2_limit(freedom))) continue;
        result.misfit.push_back(c);
        scale[c] = std::sqrt(fits[c].least_chi2 / freedom);
    }
    for (std::size_t c = 0; c < channels; ++c) result.covariance.emplace_back(scale[c] * scale[c] * fits[c].covariance);
    for (std::size_t r = 0; r < roles.roles.size(); ++r) {
        const std::string& role = roles.roles[r];
        FittedResin& fitted = result.resins.emplace_back();
        fitted.role = role;
        fitted.albedo.resize(channels), fitted.sigma_t.resize(channels), fitted.reduced.resize(channels);
        optics::Resin& resin = result.set.resins.emplace_back(optics::Resin{role, role, {}, {}});
        for (std::size_t c = 0; c < channels; ++c) {
            if (roles.is_clear(r) && clear_is_told(table, role)) {
                describe_clear(fits[c], r, scale[c], fitted, c);
            } else if (roles.is_clear(r)) {
                fitted.albedo[c] = {1, 0, 1, 1, {Doubt::assumed}};
                fitted.sigma_t[c] = {0, 0, 0, 0, {Doubt::assumed}};
            } else {
                describe(fits[c], r, scale[c], square_mm(table, role), options.model.g, fitted, c);
            }
            resin.albedo.push_back(fitted.albedo[c].value);
            resin.sigma_t_per_mm.push_back(fitted.sigma_t[c].value);
            const ResinPrior::Resin* known = prior.find(role);
            if (known && fits[c].prior_chi2[r] > disagreement[known->channel[c].known()])
                result.warnings.push_back(named_warning(
                    "misfit",
                    disagreement_text(role, channel_name(table.channels, c), fits[c].prior_chi2[r], prior.source)));
        }
    }
    for (const ResinPrior::Resin& known : prior.resins)
        if (std::ranges::find(roles.roles, known.role) == roles.roles.end())
            result.resins.push_back(known_resin(known, prior.g, result.set));
    std::vector<std::vector<double>> predicted(table.patches.size(), std::vector<double>(channels));
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t p = 0; p < predicted.size(); ++p) predicted[p][c] = fits[c].predicted[p];
    result.patches = compare_patches(table, predicted, table.channels);
    result.seconds = watch.total();
    return result;
}

}  // namespace voxtone::calibration
