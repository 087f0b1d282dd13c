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
#include "voxtone/optics/colour/spectral_colour.h"

namespace voxtone::calibration {

PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted) {
    VOXTONE_EXPECT(predicted.size() == table.patches.size());
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(table.channels.wavelengths_nm);
    const auto colour = [&](const std::vector<double>& rho) {
        return Eigen::Vector3d(weights *
                               Eigen::Map<const Eigen::VectorXd>(rho.data(), static_cast<Eigen::Index>(rho.size())));
    };
    PatchCheck check;
    std::vector<double> differences;
    double squares = 0;
    for (std::size_t p = 0; p < predicted.size(); ++p) {
        const std::vector<double>& measured = table.patches[p].rho;
        CheckedPatch& patch = check.patches.emplace_back();
        patch.predicted = predicted[p];
        patch.measured_rgb = colour(measured);
        patch.predicted_rgb = colour(predicted[p]);
        patch.difference = optics::ciede2000(optics::lab_from_linear_srgb(patch.predicted_rgb),
                                             optics::lab_from_linear_srgb(patch.measured_rgb));
        differences.push_back(patch.difference);
        for (std::size_t c = 0; c < measured.size(); ++c) {
            const double error = predicted[p][c] - measured[c];
            patch.worst = std::max(patch.worst, std::abs(error));
            squares += error * error;
        }
    }
    check.differences = optics::summarize(differences);
    const std::size_t values = predicted.size() * table.channels.size();
    check.rms = values > 0 ? std::sqrt(squares / static_cast<double>(values)) : 0;
    return check;
}

PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options) {
    if (set.channels != table.channels) {
        const auto name = [](const optics::Channels& c) {
            return c.is_rgb() ? std::string("R, G, B")
                              : fmt::format("{} wavelengths from {} to {} nm", c.size(), c.wavelengths_nm.front(),
                                            c.wavelengths_nm.back());
        };
        throw InputError(fmt::format(
            "{}: the patches have {}, the resin set \"{}\" has {}; measure and calibrate with the same channels.",
            table.source, name(table.channels), set.name, name(set.channels)));
    }
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
    return compare_patches(table, predicted);
}

}  // namespace voxtone::calibration
