// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_folds.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "calibration/chart/chart_lengths.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_fit.h"
#include "calibration/chart/observer_start.h"
#include "calibration/chart/spectral_start.h"
#include "calibration/chart/square_colours.h"

namespace voxtone::calibration {

namespace {

constexpr int choice_folds = 5;
// Few mixtures are cut anew several times: one cut of thirty says little.
constexpr Eigen::Index cut_mixtures = 240;
constexpr Eigen::Index most_cuts = 8;
// Fewer channels are taken where they are as good within this: every one costs light transport its price.
constexpr double as_good = 1.01;

struct Rows {
    std::vector<Eigen::Index> kept, left;
};

Rows rows_of(const std::vector<int>& fold, int k) {
    Rows rows;
    for (std::size_t i = 0; i < fold.size(); ++i)
        (fold[i] == k ? rows.left : rows.kept).push_back(static_cast<Eigen::Index>(i));
    return rows;
}

// One fold as a fit of the others says it by physics, from the fit of all where it is given: in `out`. What the fit
// leaves of the others.
Eigen::MatrixX3d fit_without(const ChartData& data, const Rows& rows, int k, const ObserverChoice& choice,
                             const ChartFitOptions& options, const ObserverParts* whole, const Progress* progress,
                             LeftOut& out) {
    if (rows.left.empty() && !data.is_of_laminates()) return {};
    ChartData part = chart_rows(data, rows.kept);
    const int folds = static_cast<int>(out.parts.size());
    const Rows squares = rows_of(folds_of(data.squares.roots.rows(), folds), k);
    part.squares = square_rows(data.squares, squares.kept);
    const std::vector<int> edge_fold = folds_of(static_cast<Eigen::Index>(data.edges.size()), folds);
    part.edges.clear();
    for (std::size_t i = 0; i < data.edges.size(); ++i)
        if (edge_fold[i] != k) part.edges.push_back(data.edges[i]);
    const ObserverModel model = chart_model(data, choice, options);
    const ObserverFit fit =
        fit_observer(part, model, chart_start(part, choice, options), progress, steps_of_trial, whole);
    out.parts[static_cast<std::size_t>(k)] = fit.parts;
    const ThinSquares others = square_rows(data.squares, squares.left);
    out.squares(squares.left, Eigen::all) = SquareColours(others, data.roles, model).roots(fit.parts);
    out.physics(rows.left, Eigen::all) = predicted_roots(model, fit.parts, data.shares(rows.left, Eigen::all));
    return part.roots - fit.roots;
}

void correct(const ChartData& data, const std::vector<Eigen::Index>& left, const optics::ColourResidual& residual,
             LeftOut& out) {
    for (const Eigen::Index row : left) {
        const Eigen::VectorXd shares = data.shares.row(row).transpose();
        out.corrected.row(row) =
            out.physics.row(row) + residual({shares.data(), static_cast<std::size_t>(shares.size())}).transpose();
    }
}

LeftOut empty_prediction(const ChartData& data, int folds) {
    return {Eigen::MatrixX3d::Zero(data.mixtures(), 3), Eigen::MatrixX3d::Zero(data.mixtures(), 3),
            Eigen::MatrixX3d::Zero(data.squares.roots.rows(), 3),
            std::vector<ObserverParts>(static_cast<std::size_t>(folds))};
}

// The first, of the fewest channels, that is as good as the best.
std::size_t first_as_good(const std::vector<double>& errors) {
    const double least = *std::ranges::min_element(errors);
    return static_cast<std::size_t>(std::ranges::find_if(errors, [&](double e) { return e <= as_good * least; }) -
                                    errors.begin());
}

// Sums of CIEDE2000 by fold.
std::vector<double> fold_errors(const Eigen::MatrixX3d& predicted, const ChartData& data,
                                const std::vector<int>& fold) {
    std::vector<double> sums(choice_folds);
    const std::vector<double> differences = root_differences(predicted, data.roots);
    for (std::size_t i = 0; i < fold.size(); ++i) sums[static_cast<std::size_t>(fold[i])] += differences[i];
    return sums;
}

std::vector<ObserverChoice> candidates(const ChartData& data, const ChartFitOptions& options) {
    std::vector<ObserverChoice> tried;
    const std::vector<int> counts = options.channels > 0 ? std::vector{options.channels} : std::vector{3, 4, 5, 6, 8};
    for (const int channels : counts) {
        const ObserverChoice fitted{channels, false}, bands{channels, true};
        if (channels == counts.front() || chart_model(data, fitted, options).unknowns() < 3 * data.mixtures())
            tried.push_back(fitted);
        if (data.spectra.cols() >= channels) tried.push_back(bands);
    }
    return tried;
}

}  // namespace

ObserverModel chart_model(const ChartData& data, const ObserverChoice& choice, const ChartFitOptions& options) {
    return {data.resins(),
            data.is_of_laminates() ? data.resins() : white_resin(data),
            choice.channels,
            {.g = options.g,
             .eta = options.eta,
             .geometry = options.geometry,
             .pitch_mm = options.pitch_mm,
             .lengths = data.tells_lengths() && !data.is_of_laminates(),
             .known_observer = choice.of_spectra}};
}

Eigen::VectorXd chart_scattering(const ChartData& data, const ObserverParts& parts, const ChartFitOptions& options) {
    const std::vector<double> of =
        white_scattering(set_of_parts({}, parts, data.illuminant).channels, options.g, options.lengths_from);
    return Eigen::Map<const Eigen::VectorXd>(of.data(), static_cast<Eigen::Index>(of.size()));
}

ObserverParts chart_start(const ChartData& data, const ObserverChoice& choice, const ChartFitOptions& options) {
    if (data.is_of_laminates()) return laminate_start(data, choice.channels);
    ObserverParts start =
        choice.of_spectra
            ? spectral_start(data, choice.channels, {.g = options.g, .eta = options.eta, .geometry = options.geometry})
            : observer_start(data, choice.channels);
    start.scattering = chart_scattering(data, start, options);
    if (options.pitch_mm[0] > 0) start.dot_spread = 0.5;
    return start;
}

std::vector<int> folds_of(Eigen::Index count, int folds, std::uint64_t cut) {
    std::vector<std::size_t> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), std::size_t{0});
    RandomStream random(20261125, cut);
    for (std::size_t k = order.size(); k > 1; --k)
        std::swap(order[k - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
    std::vector<int> fold(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) fold[order[k]] = static_cast<int>(k) % folds;
    return fold;
}

bool is_fitted_anew(const ChartData& data) {
    constexpr Eigen::Index most = 250;
    return (data.is_of_laminates() ? data.squares.roots.rows() : data.mixtures()) <= most;
}

LeftOut leave_out(const ChartData& data, int folds, const ObserverChoice& choice, const ChartFitOptions& options,
                  const ResidualShape* shape, const ObserverParts& whole, const Progress* progress) {
    const std::vector<int> fold = folds_of(data.mixtures(), folds);
    LeftOut out = empty_prediction(data, folds);
    const auto predict = [&](std::size_t k) {
        const Rows rows = rows_of(fold, static_cast<int>(k));
        const Eigen::MatrixX3d misfit = fit_without(data, rows, static_cast<int>(k), choice, options,
                                                    is_fitted_anew(data) ? nullptr : &whole, progress, out);
        optics::ColourResidual residual;
        if (options.residual && !rows.left.empty()) {
            const ChartData part = chart_rows(data, rows.kept);
            const ChosenResidual chosen =
                shape ? ChosenResidual{*shape, 0, true} : choose_residual_shape(part, misfit, progress);
            if (chosen.helps) residual = make_residual(part, misfit, chosen.shape);
        }
        correct(data, rows.left, residual, out);
    };
    parallel_for(0, static_cast<std::size_t>(folds), 1, predict, progress);
    return out;
}

double judged_anew(const std::vector<std::vector<double>>& errors) {
    double sum = 0;
    for (std::size_t fold = 0; fold < errors.front().size(); ++fold) {
        std::vector<double> others;
        for (const std::vector<double>& of : errors) others.push_back(std::reduce(of.begin(), of.end()) - of[fold]);
        sum += errors[first_as_good(others)][fold];
    }
    return sum;
}

ChannelCurve channel_curve(const ChartData& data, const ChartFitOptions& options, const Progress* progress) {
    const std::vector<ObserverChoice> tried = candidates(data, options);
    if (tried.size() == 1) return {};
    const auto cuts = static_cast<std::size_t>(std::clamp<Eigen::Index>(cut_mixtures / data.mixtures(), 1, most_cuts));
    std::vector<std::vector<int>> fold;
    for (std::size_t cut = 0; cut < cuts; ++cut) fold.push_back(folds_of(data.mixtures(), choice_folds, cut));
    std::vector<LeftOut> left(tried.size() * cuts, empty_prediction(data, choice_folds));
    std::vector<ObserverParts> whole(is_fitted_anew(data) ? 0 : tried.size());
    parallel_for(
        0, whole.size(), 1,
        [&](std::size_t task) {
            const std::size_t at = tried.size() - 1 - task;
            whole[at] = fit_observer(data, chart_model(data, tried[at], options), chart_start(data, tried[at], options),
                                     progress)
                            .parts;
        },
        progress);
    const std::size_t fits = cuts * choice_folds;
    std::vector<std::vector<Eigen::MatrixX3d>> misfits(fits, std::vector<Eigen::MatrixX3d>(tried.size()));
    // The largest first: they take longest.
    parallel_for(
        0, tried.size() * fits, 1,
        [&](std::size_t task) {
            const std::size_t at = tried.size() - 1 - task / fits, of = task % fits, cut = of / choice_folds;
            const int k = static_cast<int>(of % choice_folds);
            misfits[of][at] = fit_without(data, rows_of(fold[cut], k), k, tried[at], options,
                                          whole.empty() ? nullptr : &whole[at], progress, left[at * cuts + cut]);
        },
        progress);
    // What all channels leave of a fold's others is learnt by one factorisation of their kernel.
    const ResidualShape usual = usual_residual_shape(data.resins());
    parallel_for(
        0, fits, 1,
        [&](std::size_t of) {
            const std::size_t cut = of / choice_folds;
            const Rows rows = rows_of(fold[cut], static_cast<int>(of % choice_folds));
            std::vector<optics::ColourResidual> residuals(tried.size());
            if (options.residual && !rows.left.empty())
                residuals = make_residuals(chart_rows(data, rows.kept), misfits[of], usual);
            for (std::size_t at = 0; at < tried.size(); ++at)
                correct(data, rows.left, residuals[at], left[at * cuts + cut]);
        },
        progress);
    ChannelCurve curve;
    for (std::size_t k = 0; k < tried.size(); ++k) {
        ChannelChoice& choice = curve.choices.emplace_back(ChannelChoice{tried[k], 0, 0});
        for (std::size_t cut = 0; cut < cuts; ++cut) {
            choice.physics += mean_difference(left[k * cuts + cut].physics, data) / static_cast<double>(cuts);
            choice.with_residual += mean_difference(left[k * cuts + cut].corrected, data) / static_cast<double>(cuts);
        }
    }
    for (std::size_t cut = 0; cut < cuts; ++cut) {
        std::vector<std::vector<double>> errors;
        for (std::size_t k = 0; k < tried.size(); ++k)
            errors.push_back(fold_errors(left[k * cuts + cut].corrected, data, fold[cut]));
        curve.anew += judged_anew(errors) / static_cast<double>(cuts * fold[cut].size());
    }
    return curve;
}

ObserverChoice best_choice(const std::vector<ChannelChoice>& curve, const ChartFitOptions& options) {
    if (curve.empty()) return {options.channels > 0 ? options.channels : least_channels, false};
    std::vector<double> errors;
    for (const ChannelChoice& choice : curve) errors.push_back(choice.with_residual);
    return curve[first_as_good(errors)].observer;
}

double mean_difference(const Eigen::MatrixX3d& predicted, const ChartData& data) {
    return optics::summarize(root_differences(predicted, data.roots)).mean;
}

}  // namespace voxtone::calibration
