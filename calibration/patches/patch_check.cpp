// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/patches/patch_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/calibration/patches/patch_file.h"
#include "voxtone/optics/colour/observed_colour.h"

namespace voxtone::calibration {

namespace {

std::vector<double> list_of(const Eigen::Vector3d& rgb) { return {rgb[0], rgb[1], rgb[2]}; }

}  // namespace

PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted,
                           const optics::Channels& channels) {
    VOXTONE_EXPECT(predicted.size() == table.patches.size());
    const optics::ObservedColour<double> of_table(table.channels), of_set(channels);
    const bool same = channels == table.channels;
    PatchCheck check;
    if (same) check.compared_in = channels;
    std::vector<double> differences;
    double squares = 0;
    for (std::size_t p = 0; p < predicted.size(); ++p) {
        CheckedPatch& patch = check.patches.emplace_back();
        VOXTONE_EXPECT(predicted[p].size() == of_set.channels());
        patch.predicted = predicted[p];
        patch.measured_rgb = of_table.absolute(table.patches[p].rho.data());
        patch.predicted_rgb = of_set.absolute(predicted[p].data());
        patch.difference = optics::ciede2000(optics::lab_from_linear_srgb(patch.predicted_rgb),
                                             optics::lab_from_linear_srgb(patch.measured_rgb));
        differences.push_back(patch.difference);
        const std::vector<double> measured = same ? table.patches[p].rho : list_of(patch.measured_rgb);
        patch.off = same ? predicted[p] : list_of(patch.predicted_rgb);
        for (std::size_t c = 0; c < measured.size(); ++c) {
            patch.off[c] -= measured[c];
            patch.worst = std::max(patch.worst, std::abs(patch.off[c]));
            squares += patch.off[c] * patch.off[c];
        }
    }
    check.differences = optics::summarize(differences);
    const std::size_t values = predicted.size() * check.compared_in.size();
    check.rms = values > 0 ? std::sqrt(squares / static_cast<double>(values)) : 0;
    return check;
}

PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options) {
    std::vector<std::string> roles;
    for (const optics::Resin& resin : set.resins) roles.push_back(resin.role);
    for (const Patch& patch : table.patches) {
        std::vector<std::string> needed{patch.backing};
        for (const ResinShare& share : patch.top) needed.push_back(share.role);
        for (const std::string& role : needed)
            if (set.find(role) < 0)
                throw InputError(fmt::format("{}: patch {}: the resin set \"{}\" has no resin {}; it has {}.",
                                             patch.where.empty() ? table.source : patch.where, patch_name(patch),
                                             set.name, role, fmt::join(roles, ", ")));
    }
    options.g = set.g, options.eta = set.eta;
    const PatchModel model(table.patches, roles, options);
    std::vector<std::vector<double>> predicted(table.patches.size(), std::vector<double>(set.channels.size()));
    parallel_for(0, set.channels.size(), 1, [&](std::size_t c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : set.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media);
        for (std::size_t p = 0; p < rho.size(); ++p) predicted[p][c] = rho[p];
    });
    return compare_patches(table, predicted, set.channels);
}

}  // namespace voxtone::calibration
