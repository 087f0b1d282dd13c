// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/measured_values.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Core>

#include "base/contracts.h"
#include "base/error.h"
#include "calibration/tables/table_cells.h"
#include "optics/colour/channels.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

using optics::Illuminant;

namespace {

// A value above it is in percent: no surface reflects twice what a perfect diffuser does.
constexpr double most_share = 2;

struct NamedIlluminant {
    const char* name;
    Illuminant illuminant;
};
constexpr NamedIlluminant named_illuminants[] = {
    {"D50", Illuminant::d50}, {"D65", Illuminant::d65}, {"A", Illuminant::a}};

const char* name_of(Illuminant illuminant) {
    return std::ranges::find(named_illuminants, illuminant, &NamedIlluminant::illuminant)->name;
}

std::optional<Illuminant> illuminant_named(std::string_view text) {
    const std::string name = in_capitals(text);
    const auto found = std::ranges::find_if(named_illuminants, [&](const auto& n) { return name == n.name; });
    return found == std::end(named_illuminants) ? std::nullopt : std::optional(found->illuminant);
}

Illuminant illuminant_of_colours(PatchTable& table, const MeasuringConditions& conditions,
                                 std::optional<Illuminant> told) {
    const std::string observer = in_capitals(conditions.observer);
    if (observer.starts_with("10"))
        throw InputError(fmt::format(
            "{}: its colours are those of the 10 degree observer; colours of the 2 degree observer are wanted, which "
            "cannot be computed from them: export again with 2 degree, or export spectra, which need no observer.",
            table.source));
    if (told) {
        if (!conditions.illuminant.empty() && illuminant_named(conditions.illuminant) != told)
            table.notes.push_back(fmt::format("{}: the file names the illuminant {}, but {} is taken as you say.",
                                              table.source, shown(conditions.illuminant), name_of(*told)));
        return *told;
    }
    if (conditions.illuminant.empty()) {
        table.notes.push_back(
            fmt::format("{}: nothing names the illuminant of its colours; they are taken as D50, 2 degree, which "
                        "--illuminant can change.",
                        table.source));
        return Illuminant::d50;
    }
    const auto named = illuminant_named(conditions.illuminant);
    if (!named)
        throw InputError(fmt::format(
            "{}: its colours are under the illuminant {}; D50, D65 and A are known: export again under one of them, "
            "or export spectra.",
            table.source, shown(conditions.illuminant)));
    return *named;
}

// What white is, and what lay before the instrument.
void check_reading(PatchTable& table, const MeasuringConditions& conditions) {
    constexpr std::string_view of_paper[] = {"PAPER", "SUBSTRATE", "MEDIA", "RELATIVE"};
    if (const std::string base = in_capitals(conditions.white_base);
        std::ranges::find(of_paper, base) != std::end(of_paper))
        throw InputError(fmt::format(
            "{}: its values are relative to the paper (white base {}), which hides how light the paper is; export them "
            "again relative to a perfect diffuser (absolute).",
            table.source, shown(conditions.white_base)));
    const std::string filter = in_capitals(conditions.filter);
    if (filter.starts_with("POL") || filter == "YES" || filter == "M3")
        table.notes.push_back(fmt::format(
            "{}: was read through a polarising filter ({}), which takes the surface's light away, so that dark colours "
            "are darker than they look; measure without one where there is a choice.",
            table.source, shown(conditions.filter)));
}

// Whether numbers go to 100 where shares go to 1.
bool in_percent(const PatchTable& table) {
    return std::ranges::any_of(table.patches,
                               [](const Patch& p) { return !p.rho.empty() && std::ranges::max(p.rho) > most_share; });
}

void scale(PatchTable& table, double factor) {
    for (Patch& patch : table.patches) {
        for (double& value : patch.rho) value *= factor;
        for (double& error : patch.error) error *= factor;
    }
}

// d (X/Xn) / d f of CIELAB's curve.
double slope_of_cube(double f) {
    constexpr double knee = 6.0 / 29;  // CIE 15:2018, 8.2.1
    return f > knee ? 3 * f * f : 3 * knee * knee;
}

void make_rho_from_lab(const PatchTable& table, Patch& patch) {
    const Eigen::Vector3d lab(patch.rho[0], patch.rho[1], patch.rho[2]);
    if (!(lab[0] >= -1 && lab[0] <= 110))
        throw InputError(fmt::format(
            "{}: L is {}, outside 0 to 100, so that this is no colour of a print; are the columns in order?",
            patch.where.empty() ? table.source : patch.where, lab[0]));
    const Eigen::Vector3d white = optics::colorimetric_white(table.channels.illuminant);
    const Eigen::Vector3d rho = optics::xyz_from_lab(lab, white).cwiseQuotient(white);
    patch.rho = {rho[0], rho[1], rho[2]};
    if (patch.error.empty()) return;
    const double fy = (lab[0] + 16) / 116, error_y = patch.error[0] / 116;
    const double error_x = std::hypot(error_y, patch.error[1] / 500),
                 error_z = std::hypot(error_y, patch.error[2] / 200);
    patch.error = {error_x * slope_of_cube(fy + lab[1] / 500), error_y * slope_of_cube(fy),
                   error_z * slope_of_cube(fy - lab[2] / 200)};
}

void divide_by_white(PatchTable& table) {
    const Eigen::Vector3d white = optics::colorimetric_white(table.channels.illuminant);
    for (Patch& patch : table.patches)
        for (std::size_t c = 0; c < 3; ++c) {
            patch.rho[c] /= white[static_cast<Eigen::Index>(c)];
            if (!patch.error.empty()) patch.error[c] /= white[static_cast<Eigen::Index>(c)];
        }
}

std::string measured_name(const optics::Channels& channels, std::size_t c) {
    constexpr const char* relative[] = {"X/Xn", "Y/Yn", "Z/Zn"};
    return channels.is_own() ? relative[c] : channel_name(channels, c);
}

void check_ranges(PatchTable& table) {
    std::size_t outside = 0;
    for (const Patch& patch : table.patches) {
        const std::string& where = patch.where.empty() ? table.source : patch.where;
        for (std::size_t c = 0; c < patch.rho.size(); ++c)
            if (!(patch.rho[c] >= least_rho && patch.rho[c] <= most_rho))
                throw InputError(fmt::format(
                    "{}: {} of a perfect diffuser is {:.4g}, outside {} to {}, which no print reflects; are the "
                    "columns in order, and the values relative to a perfect diffuser?",
                    where, measured_name(table.channels, c), patch.rho[c], least_rho, most_rho));
        if (std::ranges::any_of(patch.error, [](double error) { return !(error > 0 && error <= 1); }))
            throw InputError(
                fmt::format("{}: a standard error must be above 0, and no larger than white itself.", where));
        if (std::ranges::any_of(patch.rho, [](double rho) { return rho < 0 || rho > 1; })) ++outside;
    }
    if (outside > 0)
        table.notes.push_back(fmt::format(
            "{}: {} of {} patches have values below 0 or above a perfect diffuser's; they are kept as they are.",
            table.source, outside, table.patches.size()));
}

bool is_colorimetric(const optics::Channels& channels) {
    return channels == optics::colorimetric_channels(channels.illuminant);
}

void note_word(MeasuringConditions& conditions, std::string_view name, std::string_view value) {
    const std::string key = in_capitals(trimmed(name));
    if (key == "ILLUMINANT" || key == "ILLUMINATION" || key == "ILLUMINATION_NAME")
        conditions.illuminant = trimmed(value);
    if (key == "WHITEBASE" || key == "WHITE_BASE") conditions.white_base = trimmed(value);
    if (key == "FILTER" || key == "PHYSICAL_FILTER" || key == "POLARIZATION") conditions.filter = trimmed(value);
    if (key == "OBSERVER" || key == "OBSERVER_ANGLE" || key == "OBSERVERANGLE") conditions.observer = trimmed(value);
}

}  // namespace

void note_condition(MeasuringConditions& conditions, std::string_view name, std::string_view value) {
    const std::string key = in_capitals(trimmed(name));
    value = trimmed(value);
    if (key == "WEIGHTING_FUNCTION") {  // "ILLUMINANT, D50"
        const std::size_t comma = value.find_first_of(",= ");
        if (comma == std::string_view::npos) return;
        const std::size_t rest = std::min(value.find_first_not_of(",= ", comma), value.size());
        note_word(conditions, value.substr(0, comma), value.substr(rest));
    } else if (key == "MEASUREMENT_SOURCE") {  // "Illumination=D50 ObserverAngle=2 Filter=No"
        for (std::size_t from = 0; from < value.size();) {
            const std::size_t to = std::min(value.find_first_of(" \t", from), value.size());
            const std::string_view part = value.substr(from, to - from);
            if (const std::size_t equals = part.find('='); equals != std::string_view::npos)
                note_word(conditions, part.substr(0, equals), part.substr(equals + 1));
            from = to + 1;
        }
    } else {
        note_word(conditions, key, value);
    }
}

MeasuringConditions conditions_of(const TextTable& table) {
    MeasuringConditions conditions;
    for (const auto& [name, value] : table.words()) note_condition(conditions, name, value);
    return conditions;
}

void make_rho(PatchTable& table, Quantity quantity, const MeasuringConditions& conditions,
              std::optional<Illuminant> illuminant) {
    check_reading(table, conditions);
    if (quantity == Quantity::lab || quantity == Quantity::xyz)
        table.channels = optics::colorimetric_channels(illuminant_of_colours(table, conditions, illuminant));
    if ((quantity == Quantity::spectrum || quantity == Quantity::xyz) && in_percent(table)) {
        scale(table, 0.01);
        if (quantity == Quantity::spectrum)
            table.notes.push_back(
                fmt::format("{}: spectra have values above {} and are taken as percent.", table.source, most_share));
    }
    if (quantity == Quantity::xyz) divide_by_white(table);
    if (quantity == Quantity::lab)
        for (Patch& patch : table.patches) make_rho_from_lab(table, patch);
    check_ranges(table);
}

void check_coverage(const PatchTable& table) {
    const std::vector<double>& nm = table.channels.wavelengths_nm;
    constexpr double from = 420, to = 680;
    if (nm.empty() || (nm.front() <= from && nm.back() >= to)) return;
    throw InputError(fmt::format(
        "{}: its spectra go from {} to {} nm, but the colour needs all from {} to {} nm: measure or export the whole "
        "range, or give L,a,b instead.",
        table.source, nm.front(), nm.back(), from, to));
}

std::vector<std::string> written_names(const optics::Channels& channels, bool with_errors) {
    std::vector<std::string> names;
    if (channels == optics::wide_channels()) {
        names = {"wR", "wG", "wB"};
    } else if (channels.is_own()) {
        VOXTONE_EXPECT(is_colorimetric(channels));
        names = with_errors ? std::vector<std::string>{"X", "Y", "Z"} : std::vector<std::string>{"L", "a", "b"};
    } else {
        for (std::size_t c = 0; c < channels.size(); ++c)
            names.push_back(channels.is_rgb() ? channel_name(channels, c)
                                              : fmt::format("{}", channels.wavelengths_nm[c]));
    }
    const std::size_t values = names.size();
    for (std::size_t c = 0; with_errors && c < values; ++c) names.push_back(names[c] + "_se");
    return names;
}

std::vector<double> written_values(const optics::Channels& channels, const Patch& patch, bool with_errors) {
    VOXTONE_EXPECT(patch.rho.size() == channels.size() && (!with_errors || patch.error.size() == channels.size()));
    std::vector<double> values = patch.rho, errors = with_errors ? patch.error : std::vector<double>{};
    if (is_colorimetric(channels)) {
        const Eigen::Vector3d white = optics::colorimetric_white(channels.illuminant);
        for (std::size_t c = 0; c < 3; ++c) {
            values[c] *= white[static_cast<Eigen::Index>(c)];
            if (with_errors) errors[c] *= white[static_cast<Eigen::Index>(c)];
        }
        if (!with_errors) {
            const Eigen::Vector3d lab = optics::lab_from_xyz({values[0], values[1], values[2]}, white);
            values.assign(lab.begin(), lab.end());
        }
    }
    values.insert(values.end(), errors.begin(), errors.end());
    return values;
}

std::string written_illuminant(const optics::Channels& channels) {
    return is_colorimetric(channels) ? fmt::format("illuminant: {}", name_of(channels.illuminant)) : "";
}

}  // namespace voxtone::calibration
