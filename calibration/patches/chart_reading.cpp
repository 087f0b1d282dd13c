// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_reading.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <Eigen/Core>

#include "base/counted.h"
#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/tables/table_cells.h"
#include "optics/colour/channels.h"
#include "optics/colour/colour.h"
#include "optics/numerics/median.h"

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
    return optics::median(std::move(sums)) > 10 ? 100 : 1;
}

bool fills_volume(const ChartReading& reading, const Patch& patch, double whole) {
    constexpr double of_printing = 1e-9;  // of numbers as texts
    const double off = sum_of(patch.top) / whole - 1;
    if (reading.inks == 0) return std::abs(off) <= allowed_sum_error + of_printing;
    // Half a step of 8 bits is 0.196 % of an ink, and four inks are what most devices have.
    constexpr double of_ink = 0.002;
    const auto there = std::ranges::count_if(patch.top, [](const ResinShare& share) { return share.fraction > 0; });
    if (off > 0) return off <= of_ink * static_cast<double>(std::max<std::size_t>(4, reading.inks)) + of_printing;
    return reading.rest_is_white || -off <= of_ink * static_cast<double>(there) + of_printing;
}

std::string words_of_misfit(const ChartReading& reading, const Patch& patch, double whole) {
    const double sum = sum_of(patch.top);
    const std::string shares = shares_as_written(patch.top);
    if (reading.rest_is_white)
        return fmt::format(
            "{}: the ink percentages sum to {:.6g} ({}{}), more than {:.6g}, so that no white is left: ink percentages "
            "are not shares of the volume; give the shares of all resins, in columns such as W,C,M,Y,K",
            patch.where, sum, shares, reading.behind_curves ? ", behind the curves of its CAL table" : "", whole);
    if (reading.inks > 0)
        return fmt::format(
            "{}: the ink percentages, white among them, sum to {:.6g} ({}{}), not to {:.6g}: what they leave is bare "
            "paper, of which no volume is made",
            patch.where, sum, shares, reading.behind_curves ? ", behind the curves of its CAL table" : "", whole);
    std::string words = fmt::format(
        "{}: the shares sum to {:.6g} ({}), not to {:.6g} within 0.2 %; give every resin of the mixture a column (W "
        "for "
        "the white between inks), and only resins",
        patch.where, sum, shares, whole);
    if (!reading.aside.empty())
        words += fmt::format(" (left aside were {}; `calibrate fit --resins` names others)", shown_list(reading.aside));
    return words;
}

// Rows that no volume can hold are left out, or the first is refused.
void expect_volumes(ChartReading& reading, double whole, bool printable_only) {
    std::vector<Patch>& patches = reading.table.patches;
    if (reading.inks > 0 && !reading.rest_is_white) {
        const std::size_t bare = std::erase_if(patches, [](const Patch& patch) { return sum_of(patch.top) == 0; });
        if (bare > 0)
            reading.table.notes.push_back(fmt::format("{}: {} of bare paper, without any ink, left out.",
                                                      reading.table.source,
                                                      bare == 1 ? "1 row is" : fmt::format("{} rows are", bare)));
    }
    const auto fits = [&](const Patch& patch) { return fills_volume(reading, patch, whole); };
    const auto misfit = std::ranges::find_if_not(patches, fits);
    if (misfit == patches.end()) return;
    const auto good = std::ranges::count_if(patches, fits);
    if (!printable_only || good == 0)
        throw InputError(fmt::format(
            "{}; {}.", words_of_misfit(reading, *misfit, whole),
            good == 0
                ? "no row of the chart would do"
                : fmt::format("{} of {} rows would do: --printable-only takes them alone", good, patches.size())));
    const std::size_t dropped = std::erase_if(patches, [&](const Patch& patch) { return !fits(patch); });
    reading.table.notes.push_back(
        fmt::format("{}: left out are {} whose {} do not sum to what a volume holds; {} taken.", reading.table.source,
                    counted(dropped, "row"), reading.inks > 0 ? "ink percentages" : "shares",
                    good == 1 ? "1 row is" : fmt::format("{} rows are", good)));
}

void normalise(ChartReading& reading, double whole) {
    constexpr double seen = 2e-5;
    std::size_t rounded = 0;
    double most = 0;
    for (Patch& patch : reading.table.patches) {
        double sum = sum_of(patch.top);
        if (reading.inks > 0 && std::abs(sum / whole - 1) > seen && (sum > whole || !reading.rest_is_white)) {
            ++rounded;
            most = std::max(most, std::abs(sum / whole - 1));
        }
        if (reading.rest_is_white && sum < whole) {
            patch.top.push_back({"W", whole - sum});
            sum = whole;
        }
        std::erase_if(patch.top, [](const ResinShare& share) { return share.fraction == 0; });
        for (ResinShare& share : patch.top) share.fraction /= sum;
        std::ranges::sort(patch.top, {}, &ResinShare::role);
    }
    if (rounded > 0)
        reading.table.notes.push_back(fmt::format(
            "{}: the inks of {} of {} rows do not sum to 100 % by up to {:.2g} %, as 8 bits round them, and "
            "are taken as if they did.",
            reading.table.source, rounded, reading.table.patches.size(), 100 * most));
}

void expect_shares(const PatchTable& table) {
    for (const Patch& patch : table.patches)
        for (const ResinShare& share : patch.top)
            if (share.fraction < 0)
                throw InputError(
                    fmt::format("{}: the share of {} is {}, but no mixture has less than nothing of a resin.",
                                patch.where, share.role, share.fraction));
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

// Values that somebody filled in to make a table complete.
void expect_measured(const PatchTable& table) {
    constexpr std::size_t least_mixtures = 3;
    const std::vector<Patch>& patches = table.patches;
    const auto same = [&](const Patch& patch) { return patch.rho == patches.front().rho; };
    if (!std::ranges::all_of(patches, same) || std::ranges::max(repeat_groups(table)) + 1 < least_mixtures) return;
    throw InputError(
        fmt::format("{}: all {} patches have one and the same colour, which no instrument reads of several mixtures: "
                    "nobody has measured them; measure them, and fill their colours in.",
                    table.source, patches.size()));
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

PatchTable finished_chart(ChartReading reading, const ChartRules& rules) {
    PatchTable& table = reading.table;
    table.is_chart = true;
    if (table.patches.empty())
        throw InputError(fmt::format("{}: no patch; give one line per measured mixture.", table.source));
    const double whole = whole_of(reading);
    if (reading.rest_is_white)
        table.notes.push_back(fmt::format(
            "{}: ink percentages of a device are taken as shares of the volume, with white (W) as the rest.",
            table.source));
    expect_shares(table);
    expect_volumes(reading, whole, rules.printable_only);
    normalise(reading, whole);
    check_layers(table);
    check_coverage(table);
    make_rho(table, reading.quantity, reading.conditions, rules.illuminant);
    expect_measured(table);
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
