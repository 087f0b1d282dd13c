// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/chart/chart_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/base/random.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/calibration/chart/chart_lengths.h"
#include "voxtone/calibration/chart/colour_fit.h"
#include "voxtone/calibration/chart/observer_fit.h"
#include "voxtone/calibration/chart/observer_start.h"
#include "voxtone/calibration/chart/residual_fit.h"
#include "voxtone/calibration/chart/square_colours.h"

namespace voxtone::calibration {

namespace {

constexpr int least_channels = 3, most_channels = 12;
constexpr std::size_t choice_folds = 5;
// Few mixtures are cut anew several times: one cut of thirty says little.
constexpr Eigen::Index cut_mixtures = 240;
constexpr Eigen::Index most_cuts = 8;
// Fewer channels are taken where they are as good within this: every one costs light transport its price.
constexpr double as_good = 1.01;

ObserverModel model_of(const ChartData& data, int channels, const ChartFitOptions& options) {
    return {data.resins(),
            white_resin(data),
            channels,
            {.g = options.g,
             .eta = options.eta,
             .geometry = options.geometry,
             .pitch_mm = options.pitch_mm,
             .lengths = !data.squares.patches.empty()}};
}

optics::Channels channels_of(const ChartData& data, const ObserverParts& parts) {
    optics::Channels channels;
    channels.illuminant = data.illuminant;
    for (Eigen::Index c = 0; c < parts.weights.rows(); ++c)
        channels.xyz.push_back({parts.weights(c, 0) * data.white[0], parts.weights(c, 1) * data.white[1],
                                parts.weights(c, 2) * data.white[2]});
    return channels;
}

Eigen::VectorXd scattering_of(const ChartData& data, const ObserverParts& parts, const ChartFitOptions& options) {
    const std::vector<double> of = white_scattering(channels_of(data, parts), options.g, options.lengths_from);
    return Eigen::Map<const Eigen::VectorXd>(of.data(), static_cast<Eigen::Index>(of.size()));
}

ObserverParts start_of(const ChartData& data, int channels, const ChartFitOptions& options) {
    ObserverParts start = observer_start(data, channels);
    start.scattering = scattering_of(data, start, options);
    if (options.pitch_mm[0] > 0) start.dot_spread = 0.5;
    return start;
}

// Fold of each mixture: an even cut of a shuffled order.
std::vector<int> folds_of(Eigen::Index mixtures, int folds, std::uint64_t cut = 0) {
    std::vector<std::size_t> order(static_cast<std::size_t>(mixtures));
    std::iota(order.begin(), order.end(), std::size_t{0});
    RandomStream random(20261125, cut);
    for (std::size_t k = order.size(); k > 1; --k)
        std::swap(order[k - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
    std::vector<int> fold(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) fold[order[k]] = static_cast<int>(k) % folds;
    return fold;
}

struct LeftOut {
    Eigen::MatrixX3d physics, corrected;  ///< roots of every mixture by a fit without its fold
    Eigen::MatrixX3d squares;             ///< the same of every thin square
    std::vector<ObserverParts> parts;     ///< of each fold's fit; empty: not wanted
};

struct Rows {
    std::vector<Eigen::Index> kept, left;
};

Rows rows_of(const std::vector<int>& fold, int k) {
    Rows rows;
    for (std::size_t i = 0; i < fold.size(); ++i)
        (fold[i] == k ? rows.left : rows.kept).push_back(static_cast<Eigen::Index>(i));
    return rows;
}

// One fold: what the others say of it.
void predict_fold(const ChartData& data, const std::vector<int>& fold, int k, int channels,
                  const ChartFitOptions& options, const ResidualShape& shape, const Progress* progress, LeftOut& out) {
    const auto [kept, left] = rows_of(fold, k);
    if (left.empty()) return;
    ChartData part = chart_rows(data, kept);
    const int folds = *std::ranges::max_element(fold) + 1;
    const auto [kept_squares, left_squares] = rows_of(folds_of(data.squares.roots.rows(), folds), k);
    part.squares = square_rows(data.squares, kept_squares);
    const ObserverModel model = model_of(data, channels, options);
    const ObserverFit fit = fit_observer(part, model, start_of(part, channels, options), progress);
    if (!out.parts.empty()) out.parts[static_cast<std::size_t>(k)] = fit.parts;
    const ThinSquares others = square_rows(data.squares, left_squares);
    const Eigen::MatrixX3d square_roots = SquareColours(others, data.roles, model).roots(fit.parts);
    for (std::size_t i = 0; i < left_squares.size(); ++i)
        out.squares.row(left_squares[i]) = square_roots.row(static_cast<Eigen::Index>(i));
    const Eigen::MatrixX3d physics = predicted_roots(model, fit.parts, data.shares(left, Eigen::all));
    const optics::ColourResidual residual =
        options.residual ? make_residual(part, part.roots - fit.roots, shape) : optics::ColourResidual();
    for (std::size_t i = 0; i < left.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        const Eigen::VectorXd shares = data.shares.row(left[i]).transpose();
        out.physics.row(left[i]) = physics.row(row);
        out.corrected.row(left[i]) =
            physics.row(row) + residual({shares.data(), static_cast<std::size_t>(shares.size())}).transpose();
    }
}

double mean_difference(const Eigen::MatrixX3d& predicted, const ChartData& data) {
    return optics::summarize(root_differences(predicted, data.roots)).mean;
}

LeftOut empty_prediction(const ChartData& data) {
    return {Eigen::MatrixX3d::Zero(data.mixtures(), 3),
            Eigen::MatrixX3d::Zero(data.mixtures(), 3),
            Eigen::MatrixX3d::Zero(data.squares.roots.rows(), 3),
            {}};
}

// Numbers of channels that so many mixtures can bear: not more unknowns than measured values.
std::vector<int> candidates(const ChartData& data, const ChartFitOptions& options) {
    if (options.channels > 0) return {options.channels};
    std::vector<int> tried;
    for (const int channels : {3, 4, 5, 6, 8})
        if (channels == least_channels || model_of(data, channels, options).unknowns() < 3 * data.mixtures())
            tried.push_back(channels);
    return tried;
}

std::vector<ChannelChoice> channel_curve(const ChartData& data, const ChartFitOptions& options,
                                         const Progress* progress) {
    const std::vector<int> tried = candidates(data, options);
    if (tried.size() == 1) return {};
    const auto cuts = static_cast<std::size_t>(std::clamp<Eigen::Index>(cut_mixtures / data.mixtures(), 1, most_cuts));
    std::vector<std::vector<int>> fold;
    for (std::size_t cut = 0; cut < cuts; ++cut)
        fold.push_back(folds_of(data.mixtures(), static_cast<int>(choice_folds), cut));
    std::vector<LeftOut> left(tried.size() * cuts, empty_prediction(data));
    const std::size_t fits = cuts * choice_folds;
    // The largest first: they take longest.
    parallel_for(
        0, tried.size() * fits, 1,
        [&](std::size_t task) {
            const std::size_t at = tried.size() - 1 - task / fits, cut = task % fits / choice_folds;
            predict_fold(data, fold[cut], static_cast<int>(task % choice_folds), tried[at], options,
                         usual_residual_shape(data.resins()), progress, left[at * cuts + cut]);
        },
        progress);
    std::vector<ChannelChoice> curve;
    for (std::size_t k = 0; k < tried.size(); ++k) {
        ChannelChoice& choice = curve.emplace_back(ChannelChoice{tried[k], 0, 0});
        for (std::size_t cut = 0; cut < cuts; ++cut) {
            choice.physics += mean_difference(left[k * cuts + cut].physics, data) / static_cast<double>(cuts);
            choice.with_residual += mean_difference(left[k * cuts + cut].corrected, data) / static_cast<double>(cuts);
        }
    }
    return curve;
}

int best_channels(const std::vector<ChannelChoice>& curve, const ChartFitOptions& options) {
    if (curve.empty()) return options.channels > 0 ? options.channels : least_channels;
    const auto error = [](const ChannelChoice& choice) { return choice.with_residual; };
    const double least = std::ranges::min(curve, {}, error).with_residual;
    return std::ranges::find_if(curve, [&](const ChannelChoice& c) { return error(c) <= as_good * least; })->channels;
}

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

optics::ResinSet set_of(const ChartData& data, const ObserverParts& parts, const PatchTable& table,
                        const ChartFitOptions& options) {
    optics::ResinSet set;
    set.name = options.name;
    set.g = options.g, set.eta = options.eta;
    set.dot_spread = parts.dot_spread;
    set.channels = channels_of(data, parts);
    for (Eigen::Index r = 0; r < data.resins(); ++r) {
        const std::string& role = data.roles[static_cast<std::size_t>(r)];
        optics::Resin resin{role, role, {}, {}};
        for (Eigen::Index c = 0; c < parts.weights.rows(); ++c) {
            const double sum = parts.a(r, c) + parts.s(r, c);
            resin.sigma_t_per_mm.push_back(parts.scattering[c] * sum);
            resin.albedo.push_back(parts.s(r, c) / sum);
        }
        set.resins.push_back(std::move(resin));
    }
    set.measured = {options.geometry, parts.surface, parts.gain};
    set.source =
        fmt::format("voxtone calibrate fit, {} mixtures of {}; lengths from {}", data.mixtures(), table.source,
                    data.squares.patches.empty() ? "the white of " + options.lengths_from.name
                                                 : fmt::format("{} thin squares", data.squares.patches.size()));
    return set;
}

// Where a set must not be trusted: mixtures that hold more of a resin than any patch did.
void add_limits(const ChartData& data, ChartFit& fit) {
    for (Eigen::Index r = 0; r < data.resins(); ++r) {
        const double most = data.shares.col(r).maxCoeff();
        if (most < 0.95)
            fit.warnings.push_back(fmt::format(
                "no patch holds more than {:.0f} % of {}: colours of mixtures beyond that are the model's word alone",
                100 * most, data.roles[static_cast<std::size_t>(r)]));
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
    // A J750's chart gains up to 3 %, by values that contradict each other (docs/benchmarks.md, "Charts of mixtures"):
    // that much is no knowledge. Chosen on that chart.
    constexpr double clearly = 0.97;
    ChartFitOptions ideal = options;
    ideal.pitch_mm = {};
    const auto fitted = [&](const ChartFitOptions& law) {
        const int channels = law.channels > 0 ? law.channels : of_channels;
        const ObserverFit found =
            fit_observer(data, model_of(data, channels, law), start_of(data, channels, law), progress);
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
    fit.squares_held_out = optics::summarize(root_differences(left.squares, data.squares.roots));
}

void add_held_out(const ChartData& data, const LeftOut& left, ChartFit& fit) {
    const std::vector<double> differences = root_differences(left.corrected, data.roots);
    fit.held_out = optics::summarize(differences);
    fit.held_out_physics = optics::summarize(root_differences(left.physics, data.roots));
    std::vector<std::size_t> order(differences.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return differences[a] > differences[b]; });
    constexpr std::size_t told = 8;
    for (std::size_t k = 0; k < std::min(told, order.size()); ++k)
        fit.worst.push_back({data.names[order[k]], differences[order[k]]});
    for (std::size_t i = 0; i < differences.size(); ++i)
        if (data.shares.row(static_cast<Eigen::Index>(i)).maxCoeff() > 0.999)
            fit.solids.push_back({data.names[i], differences[i]});
}

}  // namespace

ChartFit fit_chart(const PatchTable& table, const ChartFitOptions& asked, const Progress* progress) {
    VOXTONE_EXPECT(asked.folds >= 2);
    if (asked.channels != 0 && (asked.channels < least_channels || asked.channels > most_channels))
        throw InputError(
            fmt::format("{} channels: a fit takes {} to {}, or auto.", asked.channels, least_channels, most_channels));
    const Stopwatch watch;
    const ChartData data = chart_data(table, asked.squares);
    expect_enough(data, table, asked);
    ChartFit result;
    result.noise = data.noise;
    ChartFitOptions options = asked;
    if (!tells_spread(data, asked, progress, result)) options.pitch_mm = {};
    result.curve = channel_curve(data, options, progress);
    const int channels = best_channels(result.curve, options);

    const ObserverModel model = model_of(data, channels, options);
    ObserverFit fit = fit_observer(data, model, start_of(data, channels, options), progress);
    if (!model.options().lengths) fit.parts.scattering = scattering_of(data, fit.parts, options);
    if (model.fits_spread() && !model.options().lengths) {
        fit = fit_observer(data, model, fit.parts, progress);
        fit.parts.scattering = scattering_of(data, fit.parts, options);
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
    const std::vector<int> fold = folds_of(data.mixtures(), folds);
    LeftOut out = empty_prediction(data);
    out.parts.resize(static_cast<std::size_t>(folds));
    parallel_for(
        0, static_cast<std::size_t>(folds), 1,
        [&](std::size_t k) { predict_fold(data, fold, static_cast<int>(k), channels, chosen, shape, progress, out); },
        progress);
    add_held_out(data, out, result);
    add_limits(data, result);
    add_parameter_errors(data, model, out, result);
    if (model.fits_spread())
        result.dot_spread_text = fmt::format("Dot spread {:.2f} +- {:.2f}: 0 are sharp voxels, 1 an ideal mixture.",
                                             result.set.dot_spread, result.dot_spread_error);
    if (!fit.converged) result.warnings.emplace_back("the least squares stopped before it came to rest");
    result.seconds = watch.total();
    return result;
}

}  // namespace voxtone::calibration
