// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "calibration/chart/chart_folds.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_fit.h"
#include "calibration/chart/residual_fit.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_mixture.h"

namespace voxtone::calibration {

namespace {

void expect_enough(const ChartData& data, const PatchTable& table, const ChartFitOptions& options) {
    const int least = std::max(options.channels, least_channels);
    if (data.mixtures() <= std::max<Eigen::Index>(least, data.resins()))
        throw InputError(fmt::format(
            "{}: {} different mixtures are too few for {} resins in {} channels; measure at least {} (30 or more are "
            "of use: calibrate chart).",
            table.source, data.mixtures(), data.resins(), least, std::max<Eigen::Index>(least, data.resins()) + 1));
    for (const std::string& role : options.expected)
        if (std::ranges::find(data.roles, role) == data.roles.end())
            throw InputError(fmt::format("{}: no patch holds the resin {}; it has {}.", table.source, role,
                                         fmt::join(data.roles, ", ")));
    if (data.resins() < 3) return;
    const Eigen::RowVector3d middle = data.lab.colwise().mean();
    const Eigen::Matrix3d spread = (data.lab.rowwise() - middle).transpose() * (data.lab.rowwise() - middle) /
                                   static_cast<double>(data.mixtures());
    // The smaller axis of the a, b cloud about white: patches of one hue lie on a line from it.
    const Eigen::Matrix2d ab =
        data.lab.rightCols<2>().transpose() * data.lab.rightCols<2>() / static_cast<double>(data.mixtures());
    const double half = ab.trace() / 2, narrow = half - std::sqrt(std::max(half * half - ab.determinant(), 0.0));
    if (narrow < 4 || spread.trace() < 4)
        throw InputError(
            fmt::format("{}: all patches are of one hue, from which {} resins cannot be told apart; measure mixtures "
                        "all around the "
                        "colours that the resins make (calibrate chart).",
                        table.source, data.resins()));
}

void expect_enough_laminates(const ChartData& data, const PatchTable& table, int channels) {
    const std::size_t least = data.roles.size() * static_cast<std::size_t>(channels);
    if (table.patches.size() >= least) return;
    throw InputError(
        fmt::format("{}: {} laminates are too few for {} resins in {} channels; measure at least {}, or ask for fewer "
                    "channels.",
                    table.source, table.patches.size(), data.roles.size(), channels, least));
}

std::string lengths_of(const ChartData& data, const ChartFitOptions& options) {
    std::vector<std::string> from;
    if (!data.squares.patches.empty()) from.push_back(fmt::format("{} thin squares", data.squares.patches.size()));
    if (!data.edges.empty())
        from.push_back(fmt::format("{} values of the edges {}", data.edges.size(), options.edges.source));
    return from.empty() ? "the white of " + options.lengths_from.name : fmt::format("{}", fmt::join(from, " and "));
}

optics::ResinSet set_of(const ChartData& data, const ObserverParts& parts, const PatchTable& table,
                        const ChartFitOptions& options) {
    optics::ResinSet set = set_of_parts(data.roles, parts, data.illuminant);
    set.name = options.name;
    set.g = options.g, set.eta = options.eta;
    set.measured.geometry = options.geometry;
    set.source = data.is_of_laminates()
                     ? fmt::format("voxtone calibrate fit, {} laminates of {}", table.patches.size(), table.source)
                     : fmt::format("voxtone calibrate fit, {} mixtures of {}; lengths from {}", data.mixtures(),
                                   table.source, lengths_of(data, options));
    return set;
}

void add_unrest(const ObserverFit& fit, ChartFit& result) {
    if (!fit.converged)
        result.warnings.emplace_back(
            named_warning("not-converged", "the least squares stopped before it came to rest"));
}

// Where a set must not be trusted: mixtures that hold more of a resin than any patch did.
void add_limits(const ChartData& data, ChartFit& fit) {
    for (Eigen::Index r = 0; r < data.resins(); ++r) {
        const double most = data.shares.col(r).maxCoeff();
        if (most < 0.95)
            fit.warnings.push_back(
                named_warning("few-patches", fmt::format("no patch holds more than {:.0f} % of {}: colours of mixtures "
                                                         "beyond that are the model's word alone",
                                                         100 * most, data.roles[static_cast<std::size_t>(r)])));
    }
}

// Whether a chart tells how far droplets run together: only where that explains it better than an ideal mixture, whose
// resins are fitted too. Said in a sentence.
bool tells_spread(const ChartData& data, const ChartFitOptions& options, const Progress* progress, ChartFit& fit) {
    if (options.pitch_mm[0] == 0) {
        fit.dot_spread_text = "Mixtures are taken as ideal (dot spread 1): no printer or pitch was named.";
        return false;
    }
    constexpr int of_channels = 4;
    // A J750's chart gains up to 3 %, by values that contradict each other (docs/decisions/012):
    // that much is no knowledge. Chosen on that chart.
    constexpr double clearly = 0.97;
    ChartFitOptions ideal = options;
    ideal.pitch_mm = {};
    const auto fitted = [&](const ChartFitOptions& law) {
        const ObserverChoice usual{law.channels > 0 ? law.channels : of_channels, false};
        const ObserverFit found =
            fit_observer(data, chart_model(data, usual, law), chart_start(data, usual, law), progress);
        return std::pair(mean_difference(found.roots, data), found.parts.dot_spread);
    };
    const auto [of_ideal, one] = fitted(ideal);
    const auto [of_spread, spread] = fitted(options);
    if (of_spread < clearly * of_ideal) return true;
    fit.dot_spread_text = fmt::format(
        "The chart does not tell the dot spread: by physics alone its mixtures are off by {:.2f} CIEDE2000 where they "
        "are ideal (1), by {:.2f} at {:.2f}; 1 is kept.",
        of_ideal, of_spread, spread);
    return false;
}

// Standard error of an estimate from those that left a fold out each (Efron 1982).
double jackknife_error(const std::vector<double>& left_out) {
    const auto folds = static_cast<double>(left_out.size());
    const double mean = std::reduce(left_out.begin(), left_out.end()) / folds;
    double sum = 0;
    for (const double value : left_out) sum += (value - mean) * (value - mean);
    return std::sqrt((folds - 1) / folds * sum);
}

void add_parameter_errors(const ChartData& data, const ObserverModel& model, const LeftOut& left, ChartFit& fit) {
    const auto error_of = [&](auto value) {
        std::vector<double> values;
        for (const ObserverParts& parts : left.parts) values.push_back(value(parts));
        return jackknife_error(values);
    };
    if (model.fits_spread()) fit.dot_spread_error = error_of([](const ObserverParts& p) { return p.dot_spread; });
    if (!model.options().lengths) return;
    for (Eigen::Index c = 0; c < model.channels(); ++c)
        fit.length_error.push_back(error_of([c](const ObserverParts& p) { return std::log(p.scattering[c]); }));
    if (!data.squares.patches.empty())
        fit.squares_held_out = optics::summarize(root_differences(left.squares, data.squares.roots));
}

void add_held_out(const ChartData& data, const LeftOut& left, ChartFit& fit) {
    const std::vector<double> differences = root_differences(left.corrected, data.roots);
    fit.held_out = optics::summarize(differences);
    fit.held_out_physics = optics::summarize(root_differences(left.physics, data.roots));
    fit.worst = largest_differences(differences, [&](std::size_t k) { return data.names[k]; });
    for (std::size_t i = 0; i < differences.size(); ++i)
        if (data.shares.row(static_cast<Eigen::Index>(i)).maxCoeff() > 0.999)
            fit.solids.push_back({data.names[i], differences[i]});
}

ChartFit fit_laminates(const PatchTable& table, ChartFitOptions options, const Progress* progress) {
    const Stopwatch watch;
    options.channels = options.channels > 0 ? options.channels : usual_laminate_channels;
    options.residual = false, options.pitch_mm = {};
    const ChartData data = chart_data(table);
    expect_enough_laminates(data, table, options.channels);
    const ObserverChoice choice{options.channels, false};
    ChartFit result;
    result.of_laminates = true;
    const ObserverFit fit = fit_observer(data, chart_model(data, choice, options), chart_start(data, choice, options),
                                         progress, steps_of_result);
    add_unrest(fit, result);
    result.set = set_of(data, fit.parts, table, options);
    std::vector<double> differences = root_differences(fit.square_roots, data.squares.roots);
    result.fitted = optics::summarize(differences);
    if (options.folds > 1) {
        const int folds = std::min(options.folds, most_laminate_folds);
        differences = root_differences(leave_out(data, folds, choice, options, nullptr, fit.parts, progress).squares,
                                       data.squares.roots);
        result.held_out = optics::summarize(differences);
    }
    result.worst = largest_differences(differences, [&](std::size_t k) { return patch_name(table.patches[k]); });
    result.seconds = watch.total();
    return result;
}

}  // namespace

std::vector<HeldOutPatch> largest_differences(const std::vector<double>& differences,
                                              const std::function<std::string(std::size_t)>& name) {
    constexpr std::size_t told = 8;
    std::vector<HeldOutPatch> worst;
    for (const std::size_t k : largest_first(differences))
        if (worst.size() < told) worst.push_back({name(k), differences[k]});
    return worst;
}

ChartFit fit_chart(const PatchTable& table, const ChartFitOptions& target, const Progress* progress) {
    if (target.channels != 0 && (target.channels < least_channels || target.channels > most_channels))
        throw InputError(
            fmt::format("{} channels: a fit takes {} to {}, or auto.", target.channels, least_channels, most_channels));
    if (table.is_of_laminates()) return fit_laminates(table, target, progress);
    VOXTONE_EXPECT(target.folds >= 2);
    const Stopwatch watch;
    const ChartData data = chart_data(table, target.squares, target.edges);
    expect_enough(data, table, target);
    ChartFit result;
    result.noise = data.noise;
    ChartFitOptions options = target;
    if (!tells_spread(data, target, progress, result)) options.pitch_mm = {};
    ChannelCurve curve = channel_curve(data, options, progress);
    result.curve = std::move(curve.choices);
    result.chosen_anew = curve.anew;
    const ObserverChoice choice = best_choice(result.curve, options);
    result.observer = choice;

    const ObserverModel model = chart_model(data, choice, options);
    ObserverFit fit = fit_observer(data, model, chart_start(data, choice, options), progress, steps_of_result);
    if (!model.options().lengths) fit.parts.scattering = chart_scattering(data, fit.parts, options);
    if (model.fits_spread() && !model.options().lengths) {
        fit = fit_observer(data, model, fit.parts, progress, steps_of_result);
        fit.parts.scattering = chart_scattering(data, fit.parts, options);
    }
    const Eigen::MatrixX3d left = data.roots - fit.roots;
    ResidualShape shape = usual_residual_shape(data.resins());
    ChartFitOptions chosen = options;
    if (options.residual) {
        const ChosenResidual residual = choose_residual_shape(data, left, progress);
        shape = residual.shape;
        chosen.residual = residual.helps;
    }
    result.set = set_of(data, fit.parts, table, options);
    Eigen::MatrixX3d fitted = fit.roots;
    if (chosen.residual) {
        result.set.residual = make_residual(data, left, shape);
        for (Eigen::Index i = 0; i < data.mixtures(); ++i) {
            const Eigen::VectorXd shares = data.shares.row(i).transpose();
            fitted.row(i) += result.set.residual({shares.data(), static_cast<std::size_t>(shares.size())}).transpose();
        }
        result.residual_size = optics::summarize(root_differences(fitted, fit.roots)).mean;
    }
    result.fitted = optics::summarize(root_differences(fitted, data.roots));

    const int folds = static_cast<int>(std::min<Eigen::Index>(options.folds, data.mixtures()));
    result.residual_anew = options.residual && is_fitted_anew(data);
    const LeftOut out = leave_out(data, folds, choice, result.residual_anew ? options : chosen,
                                  result.residual_anew ? nullptr : &shape, fit.parts, progress);
    add_held_out(data, out, result);
    add_limits(data, result);
    add_parameter_errors(data, model, out, result);
    for (const std::string& sentence :
         edge_disagreements(data.edges, edge_residuals(data.edges, model, fit.parts, data.illuminant), data.roles))
        result.warnings.push_back(named_warning("misfit", sentence));
    if (model.fits_spread())
        result.dot_spread_text = fmt::format("Dot spread {:.2f} +- {:.2f}: 0 are sharp voxels, 1 an ideal mixture.",
                                             result.set.dot_spread, result.dot_spread_error);
    add_unrest(fit, result);
    result.seconds = watch.total();
    return result;
}

}  // namespace voxtone::calibration
