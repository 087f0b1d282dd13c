// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_reading.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <Eigen/Core>

#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "optics/colour/channels.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

namespace {

constexpr double allowed_sum_error = 0.002;

double sum_of(const PatchMixture& mixture) {
    double sum = 0;
    for (const ResinShare& share : mixture) sum += share.fraction;
    return sum;
}

std::string shares_as_written(const PatchMixture& mixture) {
    std::string text;
    for (const ResinShare& share : mixture)
        text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", share.role, share.fraction);
    return text;
}

// What the numbers of a row sum to where they are complete, 1 or 100, as most rows have it.
double whole_of(const ChartReading& reading) {
    double largest = 0;
    std::vector<double> sums;
    for (const Patch& patch : reading.table.patches) {
        for (const ResinShare& share : patch.top) largest = std::max(largest, share.fraction);
        sums.push_back(sum_of(patch.top));
    }
    // Inks of a device are percent, unless no value of all is above 1: no chart has inks of 1 % at most.
    if (reading.rest_is_white) return largest > 1 ? 100 : 1;
    const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() / 2);
    std::nth_element(sums.begin(), middle, sums.end());
    return *middle > 10 ? 100 : 1;
}

void check_sum(const Patch& patch, double sum, double whole, bool rest_is_white) {
    const double off = sum / whole - 1;
    if (rest_is_white ? off <= allowed_sum_error : std::abs(off) <= allowed_sum_error) return;
    if (rest_is_white)
        throw InputError(fmt::format(
            "{}: the ink percentages sum to {:.6g} ({}), more than {:.6g}, so that no white is left: ink percentages "
            "are not shares of the volume; give the shares of all resins, in columns such as W,C,M,Y,K.",
            patch.where, sum, shares_as_written(patch.top), whole));
    throw InputError(
        fmt::format("{}: the shares sum to {:.6g} ({}), not to {:.6g} within 0.2 %; give every resin of the mixture a "
                    "column (W for "
                    "the white between inks), and only resins.",
                    patch.where, sum, shares_as_written(patch.top), whole));
}

void normalise(Patch& patch, double whole, bool rest_is_white) {
    for (const ResinShare& share : patch.top)
        if (share.fraction < 0)
            throw InputError(fmt::format("{}: the share of {} is {}, but no mixture has less than nothing of a resin.",
                                         patch.where, share.role, share.fraction));
    double sum = sum_of(patch.top);
    check_sum(patch, sum, whole, rest_is_white);
    if (rest_is_white && sum < whole) {
        patch.top.push_back({"W", whole - sum});
        sum = whole;
    }
    std::erase_if(patch.top, [](const ResinShare& share) { return share.fraction == 0; });
    for (ResinShare& share : patch.top) share.fraction /= sum;
    std::ranges::sort(patch.top, {}, &ResinShare::role);
}

void check_layers(PatchTable& table) {
    std::size_t unseen = 0;
    for (Patch& patch : table.patches) {
        if (!(patch.thickness_mm == 0 || (patch.thickness_mm >= 0.001 && patch.thickness_mm <= 1000)))
            throw InputError(
                fmt::format("{}: thickness_mm is {}; expected mm, from 0.001 to 1000, or 0 where the patch is thick.",
                            patch.where, patch.thickness_mm));
        if (!(patch.base_mm == 0 || (patch.base_mm >= 0.001 && patch.base_mm <= 10000)))
            throw InputError(
                fmt::format("{}: base_mm is {}; expected mm, from 0.001 to 10000, or 0 where it is not known.",
                            patch.where, patch.base_mm));
        if (patch.thickness_mm > 0 && patch.backing.empty())
            throw InputError(fmt::format(
                "{}: the patch is {} mm thick, but nothing says which resin lies under it: give a column backing, or "
                "leave thickness_mm out where light does not get through.",
                patch.where, patch.thickness_mm));
        if (patch.thickness_mm > 0 || (patch.backing.empty() && patch.base_mm == 0)) continue;
        patch.backing.clear();
        patch.base_mm = 0;
        ++unseen;
    }
    if (unseen > 0)
        table.notes.push_back(fmt::format(
            "{}: {} patches have a backing and no thickness_mm; they are taken as thick, so that it is not seen.",
            table.source, unseen));
}

// Colours as the eye compares them: under the illuminant that they were measured for, spectra and R, G, B under D65.
std::vector<Eigen::Vector3d> labs_of(const PatchTable& table) {
    const optics::Channels& channels = table.channels;
    const Eigen::Vector3d white = optics::colorimetric_white(channels.illuminant);
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(channels);
    std::vector<Eigen::Vector3d> labs;
    for (const Patch& patch : table.patches) {
        const Eigen::Map<const Eigen::VectorXd> rho(patch.rho.data(), static_cast<Eigen::Index>(patch.rho.size()));
        labs.push_back(channels.is_own() ? optics::lab_from_xyz(rho.head<3>().cwiseProduct(white), white)
                                         : optics::lab_from_linear_srgb(weights * rho));
    }
    return labs;
}

Eigen::Vector3d median_of(const std::vector<Eigen::Vector3d>& colours, const std::vector<std::size_t>& group) {
    Eigen::Vector3d median;
    std::vector<double> values(group.size());
    for (Eigen::Index c = 0; c < 3; ++c) {
        std::ranges::transform(group, values.begin(), [&](std::size_t p) { return colours[p][c]; });
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        median[c] = values.size() % 2 == 1 ? *middle : (*middle + *std::max_element(values.begin(), middle)) / 2;
    }
    return median;
}

}  // namespace

PatchTable finished_chart(ChartReading reading, std::optional<optics::Illuminant> illuminant) {
    PatchTable& table = reading.table;
    table.is_chart = true;
    if (table.patches.empty())
        throw InputError(fmt::format("{}: no patch; give one line per measured mixture.", table.source));
    const double whole = whole_of(reading);
    if (reading.rest_is_white)
        table.notes.push_back(fmt::format(
            "{}: ink percentages of a device are taken as shares of the volume, with white (W) as the rest.",
            table.source));
    for (Patch& patch : table.patches) normalise(patch, whole, reading.rest_is_white);
    check_layers(table);
    check_coverage(table);
    make_rho(table, reading.quantity, reading.conditions, illuminant);
    check_repeats(table);
    return std::move(table);
}

std::vector<std::size_t> repeat_groups(const PatchTable& table) {
    std::map<std::string, std::size_t> known;
    std::vector<std::size_t> groups;
    for (const Patch& patch : table.patches) {
        std::string key = fmt::format("{} {} {}", patch.thickness_mm, patch.base_mm, patch.backing);
        for (const ResinShare& share : patch.top)
            if (const long parts = std::lround(share.fraction * 1e4); parts > 0)
                key += fmt::format(" {}:{}", share.role, parts);
        groups.push_back(known.try_emplace(key, known.size()).first->second);
    }
    return groups;
}

void check_repeats(const PatchTable& table) {
    const std::vector<std::size_t> groups = repeat_groups(table);
    const std::vector<Eigen::Vector3d> colours = labs_of(table);
    std::vector<std::vector<std::size_t>> members(table.patches.size());
    for (std::size_t p = 0; p < groups.size(); ++p) members[groups[p]].push_back(p);
    for (const std::vector<std::size_t>& group : members) {
        if (group.size() < 2) continue;
        const auto difference = [&](const Eigen::Vector3d& from) {
            return [&colours, from](std::size_t p) { return optics::ciede2000(colours[p], from); };
        };
        // Of two it cannot be known which is right; of more, the median says so.
        const bool pair = group.size() == 2;
        const Eigen::Vector3d middle = pair ? colours[group[0]] : median_of(colours, group);
        const std::size_t wrong = pair ? group[1] : *std::ranges::max_element(group, {}, difference(middle));
        const std::size_t other = pair ? group[0] : *std::ranges::min_element(group, {}, difference(middle));
        const double apart = difference(middle)(wrong);
        if (apart <= most_repeat_difference) continue;
        throw InputError(fmt::format(
            "{}: {} was measured {} ({}), and differs from {} by {:.1f} CIEDE2000, more than {} that printing twice "
            "explains: one of them is another patch, or is damaged; measure again, or leave the wrong one out.",
            table.patches[wrong].where, patch_name(table.patches[wrong]),
            pair ? "already" : fmt::format("{} times", group.size()), table.patches[other].where,
            pair ? "there" : "the median of all", apart, most_repeat_difference));
    }
}

}  // namespace voxtone::calibration
