// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/ended_fit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "calibration/fit/patch_map.h"
#include "calibration/patches/patch_file.h"

namespace voxtone::calibration {

namespace {

void expect_known(const Target& target, const optics::ResinSet& resins) {
    for (const std::string& role : target.roles)
        if (resins.find(role) < 0)
            throw InputError(
                fmt::format("--target: holds the resin {}, of which nothing is known here; is it the target of these "
                            "patches?",
                            role));
}

}  // namespace

SquareEnds square_ends(const PatchTable& table, const Target& target, const optics::ResinSet& resins, UnderBase under) {
    expect_known(target, resins);
    return square_ends(table, target, resins, under, light_of_deep_squares(target, resins));
}

SquareEnds square_ends(const PatchTable& table, const Target& target, const optics::ResinSet& resins, UnderBase under,
                       const LightOfSquares& deep) {
    expect_known(target, resins);
    const std::vector<std::size_t> patch_of = patches_of_squares(table, target);
    if (std::ranges::all_of(patch_of, [](std::size_t patch) { return patch == 0; }))
        throw InputError(
            fmt::format("{}: none of its patches is a square of the target, whose resins are {}; is --target that of "
                        "another print?",
                        table.source, fmt::join(target.roles, ", ")));
    const auto light = light_of_squares(target, resins, under == UnderBase::air, deep);
    SquareEnds ends;
    ends.more.assign(table.patches.size(), std::vector<double>(table.channels.size(), 0.0));
    for (std::size_t s = 0; s < patch_of.size(); ++s)
        for (std::size_t c = 0; patch_of[s] > 0 && c < table.channels.size(); ++c)
            ends.more[patch_of[s] - 1][c] = light[s][c].more(table.patches[patch_of[s] - 1].rho[c]);
    return ends;
}

void take_ends_off(PatchTable& table, const SquareEnds& ends) {
    constexpr double least = 0.2;  // what a reading is off by cannot be more than the reading
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        for (std::size_t c = 0; c < table.channels.size(); ++c) {
            double& rho = table.patches[p].rho[c];
            if (rho > 0) rho = std::max(rho - ends.more[p][c], least * rho);
        }
}

EndedFit fit_ended_squares(PatchTable table, const Target& target, const FitOptions& options, const Progress* progress,
                           double paths) {
    constexpr int most_rounds = 5;
    constexpr double still = 1e-4;  // far below the noise of a reading
    EndedFit result;
    result.fit = fit_resins(table, options, progress);
    result.table = table;
    std::vector<std::vector<double>> before;
    LightOfSquares deep;
    for (int round = 0; round < most_rounds; ++round) {
        if (round < 2) {
            expect_known(target, result.fit.set);
            deep = light_of_deep_squares(target, result.fit.set, paths);
        }
        const SquareEnds ends = square_ends(result.table, target, result.fit.set, options.model.under, deep);
        double moved = 0;
        result.most = 0;
        for (std::size_t p = 0; p < table.patches.size(); ++p)
            for (std::size_t c = 0; c < table.channels.size(); ++c) {
                const double more = ends.more[p][c];
                moved = std::max(moved, std::abs(more - (before.empty() ? 0 : before[p][c])));
                if (std::abs(more) <= std::abs(*result.most)) continue;
                result.most = more;
                result.where = fmt::format("{} in {}", patch_name(table.patches[p]), channel_name(table.channels, c));
            }
        if (moved < still) break;
        before = ends.more;
        result.table = table;
        take_ends_off(result.table, ends);
        result.fit = fit_resins(result.table, options, progress);
    }
    return result;
}

std::string ends_sentence(const EndedFit& ended) {
    if (!ended.most) return {};
    return fmt::format(
        "Squares have ends: what light between them does was taken from the patches, up to {:+.4f} ({}).\n",
        *ended.most, ended.where);
}

}  // namespace voxtone::calibration
