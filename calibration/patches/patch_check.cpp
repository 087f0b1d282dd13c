// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/patches/patch_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/calibration/patches/patch_mixture.h"
#include "voxtone/optics/colour/channels.h"
#include "voxtone/optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

Eigen::Vector3d seen_colour(const Eigen::Matrix3Xd& weights, const std::vector<double>& rho) {
    return weights * Eigen::Map<const Eigen::VectorXd>(rho.data(), static_cast<Eigen::Index>(rho.size()));
}

std::vector<std::string> roles_in(const optics::ResinSet& set) {
    std::vector<std::string> roles;
    for (const optics::Resin& resin : set.resins) roles.push_back(resin.role);
    return roles;
}

void expect_resins(const optics::ResinSet& set, const PatchTable& table) {
    for (const Patch& patch : table.patches) {
        std::vector<std::string> needed;
        if (!patch.backing.empty()) needed.push_back(patch.backing);
        for (const ResinShare& share : patch.top) needed.push_back(share.role);
        for (const std::string& role : needed)
            if (set.find(role) < 0)
                throw InputError(fmt::format("{}: patch {}: the resin set \"{}\" has no resin {}; it has {}.",
                                             patch.where.empty() ? table.source : patch.where, patch_name(patch),
                                             set.name, role, fmt::join(roles_in(set), ", ")));
    }
}

// rho of every patch in the set's channels, [patch][channel], by the model of thin squares upon a base.
std::vector<std::vector<double>> predict_squares(const optics::ResinSet& set, const PatchTable& table,
                                                 PatchModelOptions options) {
    options.g = set.g, options.eta = set.eta;
    const PatchModel model(table.patches, roles_in(set), options);
    std::vector<std::vector<double>> predicted(table.patches.size(), std::vector<double>(set.channels.size()));
    parallel_for(0, set.channels.size(), 1, [&](std::size_t c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media);
        for (std::size_t p = 0; p < rho.size(); ++p) predicted[p][c] = rho[p];
    });
    return predicted;
}

// One patch of a chart: a thick piece of a mixture, read as the set was measured, its residual included.
void predict_mixture(const optics::FlatColour& flat, const optics::ResinSet& set, const Eigen::Matrix3d& to_rgb,
                     const Patch& patch, CheckedPatch& checked) {
    std::vector<double> shares(set.resins.size());
    for (const ResinShare& share : patch.top) shares[static_cast<std::size_t>(set.find(share.role))] += share.fraction;
    checked.predicted = flat.reading(shares);
    checked.predicted_rgb = to_rgb * flat.xyz(shares);
}

void measure_differences(const PatchTable& table, const optics::Channels& channels, PatchCheck& check) {
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(table.channels);
    const bool same = channels == table.channels;
    std::vector<double> differences;
    double squares = 0;
    for (std::size_t p = 0; p < check.patches.size(); ++p) {
        CheckedPatch& patch = check.patches[p];
        patch.measured_rgb = seen_colour(weights, table.patches[p].rho);
        patch.difference = optics::ciede2000(optics::lab_from_linear_srgb(patch.predicted_rgb),
                                             optics::lab_from_linear_srgb(patch.measured_rgb));
        differences.push_back(patch.difference);
        const std::size_t values = same ? channels.size() : 3;
        for (std::size_t c = 0; c < values; ++c) {
            const auto k = static_cast<Eigen::Index>(c);
            const double error = same ? patch.predicted[c] - table.patches[p].rho[c]
                                      : patch.predicted_rgb[k] - patch.measured_rgb[k];
            patch.worst = std::max(patch.worst, std::abs(error));
            squares += error * error / static_cast<double>(values);
        }
    }
    check.differences = optics::summarize(differences);
    check.rms = check.patches.empty() ? 0 : std::sqrt(squares / static_cast<double>(check.patches.size()));
}

bool is_thick(const Patch& patch) { return patch.thickness_mm == 0 && patch.backing.empty(); }

}  // namespace

PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted,
                           const optics::Channels& channels) {
    VOXTONE_EXPECT(predicted.size() == table.patches.size());
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(channels);
    PatchCheck check;
    for (const std::vector<double>& rho : predicted)
        check.patches.push_back({rho, Eigen::Vector3d::Zero(), seen_colour(weights, rho), 0, 0});
    measure_differences(table, channels, check);
    return check;
}

PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted) {
    return compare_patches(table, predicted, table.channels);
}

PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options) {
    expect_resins(set, table);
    if (!std::ranges::any_of(table.patches, is_thick))
        return compare_patches(table, predict_squares(set, table, options), set.channels);
    PatchCheck check;
    check.patches.resize(table.patches.size());
    const optics::FlatColour flat(set, options.pitch_mm);
    const Eigen::Matrix3d to_rgb = optics::linear_srgb_of(flat.white());
    parallel_for(0, table.patches.size(), 64, [&](std::size_t p) {
        if (!is_thick(table.patches[p]))
            throw InputError(fmt::format("{}: patch {} has a thickness, but others of its table are thick; give all of "
                                         "them a thickness, or none.",
                                         table.patches[p].where, patch_name(table.patches[p])));
        predict_mixture(flat, set, to_rgb, table.patches[p], check.patches[p]);
    });
    measure_differences(table, set.channels, check);
    return check;
}

}  // namespace voxtone::calibration
