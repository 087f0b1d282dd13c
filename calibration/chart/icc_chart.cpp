// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/icc_chart.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "calibration/chart/icc_measurements.h"
#include "calibration/chart/mixture_samples.h"
#include "calibration/patches/chart_reading.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t least_icc_patches = 10, most_icc_patches = 10000;

struct ForeignClass {
    std::string_view signature, meaning;
};
constexpr ForeignClass foreign_classes[] = {{"nmcl", "a list of named colours"},
                                            {"link", "a link from one device to another"},
                                            {"abst", "a change of colours without a device"},
                                            {"spac", "a conversion between colour spaces"},
                                            {"scnr", "a scanner or camera"},
                                            {"mntr", "a display"}};

void expect_printer(const io::DeviceProfile& profile) {
    if (profile.device_class == "prtr") return;
    const auto found = std::ranges::find(foreign_classes, profile.device_class, &ForeignClass::signature);
    throw InputError(fmt::format(
        "{}: is the profile of {} ({}), which says nothing of resins; give the output profile (class prtr) of the "
        "printer.",
        profile.name, found == std::end(foreign_classes) ? "an unknown class" : found->meaning,
        shown(profile.colour_space)));
}

bool is_numbered_space(std::string_view space) { return space.ends_with("CLR") || space.starts_with("MCH"); }

void expect_resin_channels(const io::DeviceProfile& profile) {
    const std::string& space = profile.colour_space;
    if ((space == "CMYK" || space == "CMY " || is_numbered_space(space)) && profile.channels > 0) return;
    throw InputError(fmt::format(
        "{}: its channels are {}, from which the printer's software chooses resins by itself, so that no mixture is "
        "known; give a profile whose channels are the resins (CMYK, CMY or nCLR), or a measured chart.",
        profile.name, trimmed(space)));
}

void expect_table(const io::DeviceProfile& profile) {
    if (profile.table != io::DeviceTable::none) return;
    throw InputError(fmt::format(
        "{}: has no table from device to colour (A2B0 or A2B1), so that it tells no mixture's colour; give a profile "
        "that has one, or a measured chart.",
        profile.name));
}

std::vector<double> flattened(const std::vector<std::vector<double>>& mixtures) {
    std::vector<double> values;
    for (const auto& mixture : mixtures) values.insert(values.end(), mixture.begin(), mixture.end());
    return values;
}

Eigen::Vector3d lab_at(const std::vector<double>& lab, std::size_t sample) {
    return {lab[3 * sample], lab[3 * sample + 1], lab[3 * sample + 2]};
}

void expect_white(const io::DeviceProfile& profile, const Eigen::Vector3d& lab) {
    const double chroma = std::hypot(lab.y(), lab.z());
    if (lab.x() >= least_white_lightness && chroma <= most_white_chroma) return;
    throw InputError(fmt::format(
        "{}: with 0 of all channels its colour is L {:.1f}, a {:.1f}, b {:.1f}, which is no printer's white (L at "
        "least {}, chroma at most {}): its channels count backwards, or it is another device's; give the profile of "
        "the printer that mixes with white.",
        profile.name, lab.x(), lab.y(), lab.z(), least_white_lightness, most_white_chroma));
}

PatchTable sampled_table(const io::DeviceProfile& profile, const std::vector<std::string>& roles,
                         const IccChartOptions& options) {
    ChartReading reading;
    PatchTable& table = reading.table;
    table.source = profile.name;
    reading.conditions = {"D50", "2 degree"};
    const bool absolute = options.white == ProfileWhite::perfect_diffuser;
    const std::vector<double>& lab = absolute ? profile.lab_absolute : profile.lab_relative;
    for (std::size_t p = 0; p < lab.size() / 3; ++p) {
        Patch patch;
        double rest = 1;
        for (std::size_t c = 0; c < roles.size(); ++c) {
            patch.top.push_back({roles[c], profile.samples[p * roles.size() + c]});
            rest -= patch.top.back().fraction;
        }
        constexpr double rounding = 1e-9;
        if (rest > rounding) patch.top.push_back({options.rest, rest});
        patch.rho = {lab[3 * p], lab[3 * p + 1], lab[3 * p + 2]};
        patch.where = fmt::format("{}, mixture {}", profile.name, p + 1);
        table.patches.push_back(std::move(patch));
    }
    if (profile.table == io::DeviceTable::perceptual)
        table.notes.push_back(
            fmt::format("{}: has only a perceptual table (A2B0), whose colours may be bent to please.", profile.name));
    if (!absolute)
        table.notes.push_back(fmt::format(
            "{}: colours are relative to the printer's own white, which is lighter then than it is.", profile.name));
    return finished_chart(std::move(reading));
}

}  // namespace

void IccChartOptions::validate() const {
    if (patches < least_icc_patches || patches > most_icc_patches)
        throw UsageError(
            fmt::format("--patches is {}; give a number from {} to {}", patches, least_icc_patches, most_icc_patches));
    std::set<std::string> seen;
    const auto check = [&](const std::string& role, std::string_view option) {
        if (!is_role(role))
            throw UsageError(
                fmt::format("{}: {} is no role of a resin; give a short word such as C", option, shown(role)));
        if (!seen.insert(role).second)
            throw UsageError(
                fmt::format("{}: {} is there twice; every channel and the rest are resins of their own", option, role));
    };
    check(rest, "--rest");
    for (const std::string& role : channels_are) check(role, "--channels-are");
}

std::vector<std::string> channel_roles(const io::DeviceProfile& profile, const IccChartOptions& options) {
    expect_printer(profile);
    expect_resin_channels(profile);
    expect_table(profile);
    std::vector<std::string> roles = options.channels_are;
    if (roles.empty() && is_numbered_space(profile.colour_space))
        throw InputError(fmt::format(
            "{}: its {} channels have no names; say which resin each of them is, as --channels-are C,M,Y,K does.",
            profile.name, profile.channels));
    if (roles.empty()) roles = {"C", "M", "Y"};
    if (options.channels_are.empty() && profile.channels == 4) roles.push_back("K");
    if (roles.size() != profile.channels)
        throw InputError(fmt::format(
            "{}: --channels-are names {} resins ({}), but the profile has {} channels ({}); "
            "name each of them, in their order.",
            profile.name, roles.size(), fmt::join(roles, ","), profile.channels, trimmed(profile.colour_space)));
    if (std::ranges::find(roles, options.rest) != roles.end())
        throw InputError(
            fmt::format("{}: {} is a channel already, and cannot be the rest beside all channels; give "
                        "--rest another role.",
                        profile.name, options.rest));
    return roles;
}

IccChart chart_of_profile(const io::DeviceProfile& profile, const IccChartOptions& options) {
    const std::vector<std::string> roles = channel_roles(profile, options);
    IccChart chart{{}, profile.description, std::string(trimmed(profile.colour_space)), {}, {}};
    chart.white = lab_at(profile.lab_absolute, 0);
    expect_white(profile, chart.white);
    std::vector<std::string> notes;
    if (auto measured = icc_measurements(profile, roles, options.rest, notes)) {
        chart.table = std::move(measured->table);
        chart.measured = std::move(measured->tag);
    } else {
        chart.table = sampled_table(profile, roles, options);
    }
    chart.table.notes.insert(chart.table.notes.begin(), notes.begin(), notes.end());
    return chart;
}

IccChart read_icc_chart(const std::filesystem::path& file, const IccChartOptions& options, const Progress* progress) {
    options.validate();
    const auto choose = [&](const io::DeviceProfile& profile) {
        const std::size_t inks = channel_roles(profile, options).size();
        return flattened(mixture_samples(inks, std::max(options.patches, inks + 1)));
    };
    return chart_of_profile(io::read_device_profile(file, choose, progress), options);
}

}  // namespace voxtone::calibration
