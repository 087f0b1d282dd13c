// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_fit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "calibration/chart/chart_folds.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_start.h"
#include "calibration/layers/layer_model.h"
#include "optics/colour/observed_colour.h"

namespace voxtone::calibration {

namespace {

ColourTargets targets_of(const LayerChart& chart) {
    ColourTargets targets;
    targets.roots.resize(chart.lab.rows(), 3);
    targets.counts = Eigen::VectorXd::Ones(chart.lab.rows());
    const Eigen::Matrix3d map = lab_of_roots(), back = map.inverse();
    for (Eigen::Index i = 0; i < chart.lab.rows(); ++i) {
        const Eigen::Vector3d lab = chart.lab.row(i).transpose();
        targets.roots.row(i) = (back * (lab + Eigen::Vector3d(16, 0, 0))).transpose();
        targets.metric.push_back(optics::ciede2000_metric(lab) * map);
    }
    return targets;
}

struct Fitted {
    ObserverParts parts;
    bool converged = false;
};

Fitted fit_parts(const LayerChart& chart, int channels, const LayerFitOptions& options, const Progress* progress,
                 int most_steps = steps_of_trial) {
    LayerModel model(chart, channels, options.g, options.eta);
    Eigen::VectorXd unknowns = model.unknowns_of(layer_start(chart, channels));
    Fitted fitted;
    fitted.converged = fit_colours(targets_of(chart), model, unknowns, progress, most_steps);
    fitted.parts = model.parts(unknowns);
    return fitted;
}

std::vector<double> differences_of(const LayerChart& chart, const ObserverParts& parts,
                                   const LayerFitOptions& options) {
    LayerModel model(chart, parts.a.cols(), options.g, options.eta);
    return root_differences(model.roots(parts), targets_of(chart).roots);
}

std::vector<HeldOutPatch> worst_of(const LayerChart& chart, const std::vector<double>& differences) {
    return largest_differences(differences, [&](std::size_t k) { return laminate_text(chart, k); });
}

std::vector<double> left_out(const LayerChart& chart, int channels, const LayerFitOptions& options,
                             const Progress* progress) {
    const std::vector<int> fold = folds_of(chart.lab.rows(), options.folds);
    std::vector<double> differences(fold.size());
    for (int cut = 0; cut < options.folds; ++cut) {
        std::vector<std::size_t> kept, left;
        for (std::size_t k = 0; k < fold.size(); ++k) (fold[k] == cut ? left : kept).push_back(k);
        const Fitted fitted = fit_parts(chart_laminates(chart, kept), channels, options, progress);
        const std::vector<double> judged = differences_of(chart_laminates(chart, left), fitted.parts, options);
        for (std::size_t k = 0; k < left.size(); ++k) differences[left[k]] = judged[k];
    }
    return differences;
}

optics::ResinSet set_of(const LayerChart& chart, const ObserverParts& parts, const LayerFitOptions& options) {
    optics::ResinSet set = set_of_parts(chart.roles, parts, chart.illuminant);
    set.name = options.name;
    set.g = options.g, set.eta = options.eta, set.dot_spread = 0;
    set.source = fmt::format("voxtone calibrate fit, {} laminates of {}", chart.laminates.size(), chart.source);
    return set;
}

void expect_enough(const LayerChart& chart, int channels) {
    if (channels < least_channels || channels > most_channels)
        throw InputError(
            fmt::format("{} channels: a fit takes {} to {}, or auto.", channels, least_channels, most_channels));
    const std::size_t least = chart.roles.size() * static_cast<std::size_t>(channels);
    if (chart.roles.size() > 64)
        throw InputError(fmt::format("{}: {} resins; at most 64.", chart.source, chart.roles.size()));
    if (chart.laminates.size() >= least) return;
    throw InputError(
        fmt::format("{}: {} laminates are too few for {} resins in {} channels; measure at least {}, or ask for fewer "
                    "channels.",
                    chart.source, chart.laminates.size(), chart.roles.size(), channels, least));
}

}  // namespace

LayerFit fit_layers(const LayerChart& chart, const LayerFitOptions& options, const Progress* progress) {
    const Stopwatch watch;
    const int channels = options.channels > 0 ? options.channels : usual_layer_channels;
    expect_enough(chart, channels);
    LayerFit result;
    const Fitted fitted = fit_parts(chart, channels, options, progress, steps_of_result);
    if (!fitted.converged)
        result.warnings.emplace_back(
            named_warning("not-converged", "the least squares stopped before it came to rest"));
    result.set = set_of(chart, fitted.parts, options);
    std::vector<double> differences = differences_of(chart, fitted.parts, options);
    result.fitted = optics::summarize(differences);
    if (options.folds > 1) {
        differences = left_out(chart, channels, options, progress);
        result.held_out = optics::summarize(differences);
    }
    result.worst = worst_of(chart, differences);
    result.seconds = watch.total();
    return result;
}

LayerCheck check_layers(const optics::ResinSet& set, const LayerChart& chart) {
    std::vector<std::size_t> resin;
    for (const std::string& role : chart.roles) {
        const int found = set.find(role);
        if (found < 0)
            throw InputError(fmt::format("{}: the resin set \"{}\" has no resin {}.", chart.source, set.name, role));
        resin.push_back(static_cast<std::size_t>(found));
    }
    const LaminateReflectance laminates(chart.laminates, set.g, set.eta);
    const std::size_t channels = set.channels.size();
    std::vector<std::vector<double>> rho(channels);
    parallel_for(0, channels, 1, [&](std::size_t c) {
        std::vector<optics::Medium> media;
        for (const std::size_t r : resin) media.push_back(set.resins[r].medium(c));
        rho[c] = laminates.rho(laminates.laws(std::move(media)));
    });
    const optics::ObservedColour<double> observed(set.channels);
    const Eigen::Vector3d white = optics::colorimetric_white(chart.illuminant);
    LayerCheck check;
    for (std::size_t i = 0; i < chart.laminates.size(); ++i) {
        std::vector<double> reading;
        for (const std::vector<double>& channel : rho)
            reading.push_back(set.measured.gain * (set.measured.surface + channel[i]));
        const Eigen::Vector3d lab = chart.lab.row(static_cast<Eigen::Index>(i)).transpose();
        const Eigen::Vector3d xyz = optics::adapt_white(optics::xyz_from_lab(lab, white), white, optics::d65_white());
        check.differences.push_back(optics::ciede2000(optics::lab_from_linear_srgb(observed.absolute(reading.data())),
                                                      optics::lab_from_xyz(xyz)));
    }
    check.summary = optics::summarize(check.differences);
    check.worst = worst_of(chart, check.differences);
    return check;
}

}  // namespace voxtone::calibration
