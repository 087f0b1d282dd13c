// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_surfaces.h"
#include "calibration/patches/table_observer.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

std::vector<double> list_of(const Eigen::Vector3d& rgb) { return {rgb[0], rgb[1], rgb[2]}; }

// Differences of patches whose predictions and predicted colours are known.
void measure_differences(const PatchTable& table, const optics::Channels& channels, PatchCheck& check) {
    // Spectra are seen in the light in which the set tells its colours: another one moves them by half a unit.
    const TableObserver observer =
        table_observer(table.channels, channels.is_own() ? channels.illuminant : optics::Illuminant::d65);
    const Eigen::Matrix3Xd of_table = optics::linear_srgb_of(observer.white) * observer.weights;
    const bool same = channels == table.channels;
    if (same) check.compared_in = channels;
    std::vector<double> differences;
    double squares = 0;
    for (std::size_t p = 0; p < check.patches.size(); ++p) {
        CheckedPatch& patch = check.patches[p];
        patch.measured_rgb = of_table * Eigen::Map<const Eigen::VectorXd>(table.patches[p].rho.data(), of_table.cols());
        patch.difference = optics::ciede2000(optics::lab_from_linear_srgb(patch.predicted_rgb),
                                             optics::lab_from_linear_srgb(patch.measured_rgb));
        differences.push_back(patch.difference);
        const std::vector<double> measured = same ? table.patches[p].rho : list_of(patch.measured_rgb);
        patch.off = same ? patch.predicted : list_of(patch.predicted_rgb);
        for (std::size_t c = 0; c < measured.size(); ++c) {
            patch.off[c] -= measured[c];
            patch.worst = std::max(patch.worst, std::abs(patch.off[c]));
            squares += patch.off[c] * patch.off[c];
        }
    }
    check.differences = optics::summarize(differences);
    const std::size_t values = check.patches.size() * check.compared_in.size();
    check.rms = values > 0 ? std::sqrt(squares / static_cast<double>(values)) : 0;
}

std::vector<std::string> roles_in(const optics::ResinSet& set) {
    std::vector<std::string> roles;
    for (const optics::Resin& resin : set.resins) roles.push_back(resin.role);
    return roles;
}

void expect_resins(const optics::ResinSet& set, const PatchTable& table) {
    for (const Patch& patch : table.patches) {
        std::vector<std::string> needed;
        if (!patch.backing.empty() && !patch.on) needed.push_back(patch.backing);
        for (const PatchLayer& layer : patch.under) needed.push_back(layer.role);
        for (const ResinShare& share : patch.top) needed.push_back(share.role);
        for (const std::string& role : needed)
            if (set.find(role) < 0)
                throw InputError(fmt::format("{}: patch {}: the resin set \"{}\" has no resin {}; it has {}.",
                                             patch.where.empty() ? table.source : patch.where, patch_name(patch),
                                             set.name, role, fmt::join(roles_in(set), ", ")));
    }
}

// rho of every square upon its base in the set's channels, [patch][channel]; of a chart as its instrument reads it.
std::vector<std::vector<double>> predict_squares(const optics::ResinSet& set, const PatchTable& table,
                                                 PatchModelOptions options) {
    options.g = set.g, options.eta = set.eta, options.dot_spread = set.dot_spread;
    const optics::FlatMeasurement read = table.is_chart ? set.measured : optics::FlatMeasurement{};
    const PatchModel model(in_channels_of(set, table).patches, roles_in(set), options);
    std::vector<std::vector<double>> predicted(table.patches.size(), std::vector<double>(set.channels.size()));
    parallel_for(0, set.channels.size(), 1, [&](std::size_t c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media, c);
        for (std::size_t p = 0; p < rho.size(); ++p) predicted[p][c] = read.gain * (read.surface + rho[p]);
    });
    return predicted;
}

bool is_thick(const Patch& patch) { return patch.thickness_mm == 0 && patch.backing.empty(); }

// Thick pieces of mixtures, read as the set was measured, its residual included, and the thin ones of the same table.
PatchCheck check_mixtures(const optics::ResinSet& set, const PatchTable& table, const PatchModelOptions& options) {
    PatchCheck check;
    check.patches.resize(table.patches.size());
    const optics::FlatColour flat(set, options.pitch_mm);
    const Eigen::Matrix3d to_rgb = optics::linear_srgb_of(flat.white());
    PatchTable thin = table;
    std::erase_if(thin.patches, is_thick);
    const optics::ObservedColour<double> of_set(set.channels);
    std::vector<std::vector<double>> squares = predict_squares(set, thin, options);
    for (std::size_t p = 0, square = 0; p < table.patches.size(); ++p) {
        if (is_thick(table.patches[p])) continue;
        check.patches[p].predicted = std::move(squares[square++]);
        check.patches[p].predicted_rgb = of_set.absolute(check.patches[p].predicted.data());
    }
    parallel_for(0, table.patches.size(), 64, [&](std::size_t p) {
        if (!is_thick(table.patches[p])) return;
        std::vector<double> shares(set.resins.size());
        for (const ResinShare& share : table.patches[p].top)
            shares[static_cast<std::size_t>(set.find(share.role))] += share.fraction;
        check.patches[p].predicted = flat.reading(shares);
        check.patches[p].predicted_rgb = to_rgb * flat.xyz(shares);
    });
    measure_differences(table, set.channels, check);
    return check;
}

}  // namespace

PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted,
                           const optics::Channels& channels) {
    VOXTONE_EXPECT(predicted.size() == table.patches.size());
    const optics::ObservedColour<double> of_set(channels);
    PatchCheck check;
    for (const std::vector<double>& rho : predicted) {
        VOXTONE_EXPECT(rho.size() == of_set.channels());
        CheckedPatch& patch = check.patches.emplace_back();
        patch.predicted = rho;
        patch.predicted_rgb = of_set.absolute(rho.data());
    }
    measure_differences(table, channels, check);
    return check;
}

PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options) {
    expect_resins(set, table);
    if (std::ranges::any_of(table.patches, is_thick)) return check_mixtures(set, table, options);
    return compare_patches(table, predict_squares(set, table, options), set.channels);
}

std::vector<std::size_t> largest_first(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) { return values[k]; });
    return order;
}

std::vector<std::size_t> largest_first(const PatchCheck& check) {
    std::vector<double> values;
    for (const CheckedPatch& patch : check.patches) values.push_back(patch.difference);
    return largest_first(values);
}

}  // namespace voxtone::calibration
