// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/fit_text.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/chart/chart_text.h"
#include "calibration/patches/patch_file.h"
#include "io/files/json_writer.h"

namespace voxtone::calibration {

namespace {

// A value to the digits that its error leaves: 0.99910(4), 6.02(8).
std::string with_error(double value, double error) {
    if (!(error > 0)) return fmt::format("{:g}", value);
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(error))) + 1, 0, 8);
    return fmt::format("{:.{}f} +- {:.{}f}", value, digits, error, digits);
}

// A lower limit has no error of its own.
std::string extinction_text(const FittedValue& of, const FittedValue& shown) {
    const bool limit = std::ranges::find(of.doubts, Doubt::opaque) != of.doubts.end();
    return limit ? fmt::format("> {:.2g}", shown.value) : with_error(shown.value, shown.standard_error);
}

std::string doubts_of(const FittedValue& albedo, const FittedValue& sigma_t) {
    std::string text;
    const auto add = [&](const char* of, const FittedValue& value) {
        for (const Doubt d : value.doubts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", of, doubt_name(d));
    };
    add("albedo", albedo);
    add("extinction", sigma_t);
    return text;
}

std::string differences_text(const optics::DifferenceSummary& d) {
    return fmt::format("CIEDE2000 of {} patches: mean {:.2f}, median {:.2f}, 95 % {:.2f}, largest {:.2f}", d.count,
                       d.mean, d.median, d.percentile_95, d.max);
}

std::string worst_patches(const PatchCheck& check, const PatchTable& table) {
    const std::vector<std::size_t> order = largest_first(check);
    std::string text;
    for (std::size_t k = 0; k < order.size() && k < 5; ++k) {
        const CheckedPatch& patch = check.patches[order[k]];
        text += fmt::format("  {:<16} CIEDE2000 {:.2f}, largest error of a reflectance {:.4f}\n",
                            patch_name(table.patches[order[k]]), patch.difference, patch.worst);
    }
    return text;
}

void add_differences_in(io::JsonWriter& json, const optics::DifferenceSummary& d) {
    json.add("mean_de2000", d.mean).add("median_de2000", d.median).add("p95_de2000", d.percentile_95);
    json.add("max_de2000", d.max);
}

void add_patches_of(io::JsonWriter& json, const PatchCheck& check, const PatchTable& table) {
    json.key("patches").begin_object();
    add_differences_in(json, check.differences);
    json.add("rms", check.rms).key("list").begin_list();
    for (std::size_t p = 0; p < check.patches.size(); ++p) {
        const CheckedPatch& patch = check.patches[p];
        json.begin_object().add("patch", patch_name(table.patches[p]));
        json.add("thickness_mm", table.patches[p].thickness_mm).add("de2000", patch.difference);
        json.add("measured", table.patches[p].rho).add("predicted", patch.predicted);
        if (check.compared_in != table.channels)  // the two lists have nothing to do with each other
            json.add("measured_rgb", patch.measured_rgb).add("predicted_rgb", patch.predicted_rgb);
        json.end_object();
    }
    json.end_list().end_object();
}

void add_check(io::JsonWriter& json, const PatchCheck& check, const PatchTable& table) {
    json.begin_object().add("format", "voxtone-check").add("version", 1);
    add_patches_of(json, check, table);
    json.end_object();
}

void add_sweep(io::JsonWriter& json, const std::vector<SweepLine>& lines) {
    json.key("g_sweep").begin_list();
    for (const SweepLine& line : lines) {
        json.begin_object().add("g", line.g).add("chi2_per_freedom", line.chi2);
        add_differences_in(json, line.differences);
        json.end_object();
    }
    json.end_list();
}

void add_resin(io::JsonWriter& json, const FittedResin& resin, const optics::Channels& channels) {
    json.begin_object().add("role", resin.role).key("channels").begin_list();
    for (std::size_t c = 0; c < channels.size(); ++c) {
        json.begin_object().add("channel", channel_name(channels, c));
        add_value(json, "albedo", resin.albedo[c]);
        add_value(json, "sigma_t_per_mm", resin.sigma_t[c]);
        add_value(json, "reduced_per_mm", resin.reduced[c]);
        json.end_object();
    }
    json.end_list().end_object();
}

}  // namespace

void add_value(io::JsonWriter& json, const char* key, const FittedValue& value) {
    json.key(key).begin_object().add("value", value.value).add("standard_error", value.standard_error);
    json.add("low", value.low).add("high", value.high).key("doubts").begin_list();
    for (const Doubt d : value.doubts) json.value(doubt_name(d));
    json.end_list().end_object();
}

std::string dot_spread_sentence(const ResinFit& fit) {
    if (fit.dot_spread_error == 0) return {};
    return fmt::format("Dot spread {:.2f} +- {:.2f}: 0 are sharp voxels, 1 an ideal mixture.\n", fit.set.dot_spread,
                       fit.dot_spread_error);
}

std::string spread_sentence(const std::optional<SpreadFit>& spread) {
    if (!spread) return {};
    if (!spread->is_told())
        return fmt::format(
            "Checkers do not tell how far resin runs: {:.3f} +- {:.3f} and {:.3f} +- {:.3f} mm along x and y.\n",
            spread->mm[0], spread->error[0], spread->mm[1], spread->error[1]);
    return fmt::format(
        "Resin runs {0:.3f} +- {1:.3f} mm along x and {2:.3f} +- {3:.3f} mm along y (chi2 {4:.0f} of {5}): put "
        "\"spread_mm\": [{0:.3f}, {2:.3f}] into the printer's profile. The set's own dot spread is 0 then.\n",
        spread->mm[0], spread->error[0], spread->mm[1], spread->error[1], spread->chi2, spread->freedom);
}

std::string fit_text(const ResinFit& fit, const PatchTable& table) {
    std::string text =
        fmt::format("{} resins from {} patches, {} channels, g {}, eta {}, {:.2f} s\n\n", fit.resins.size(),
                    table.patches.size(), table.channels.size(), fit.set.g, fit.set.eta, fit.seconds);
    text += fmt::format("{:<8} {:<8} {:<28} {:<24} {:<24} {}\n", "resin", "channel", "albedo", "extinction /mm",
                        "reduced extinction /mm", "doubts");
    std::map<Doubt, int> doubts;
    for (const FittedResin& resin : fit.resins)
        for (std::size_t c = 0; c < table.channels.size(); ++c) {
            const FittedValue &a = resin.albedo[c], &s = resin.sigma_t[c], &r = resin.reduced[c];
            text += fmt::format("{:<8} {:<8} {:<28} {:<24} {:<24} {}\n", c == 0 ? resin.role : "",
                                channel_name(table.channels, c), with_error(a.value, a.standard_error),
                                extinction_text(s, s), extinction_text(s, r), doubts_of(a, s));
            for (const Doubt d : a.doubts) ++doubts[d];
            for (const Doubt d : s.doubts) ++doubts[d];
        }
    text += fmt::format("\n{}\n{}", differences_text(fit.patches.differences), worst_patches(fit.patches, table));
    text += dot_spread_sentence(fit);
    for (const auto& [d, count] : doubts)
        text += fmt::format("{} values \"{}\": {}\n", count, doubt_name(d), doubt_meaning(d));
    if (!fit.misfit.empty()) {
        std::vector<std::string> names;
        for (const std::size_t c : fit.misfit)
            names.push_back(
                fmt::format("{} (chi2 {:.0f} of {})", channel_name(table.channels, c), fit.chi2[c], fit.freedom));
        text += fmt::format(
            "The residuals are larger than the noise explains in {}: look at the patches above, at --g, at the "
            "thickness of squares and base, "
            "and at --pitch for dithered mixtures; errors were scaled up.\n",
            fmt::join(names, ", "));
    }
    for (const std::string& warning : fit.warnings) text += fmt::format("{}\n", warning);
    if (fit.freedom <= 0)
        text += fmt::format(
            "There are no more patches than values to find ({} less): residuals say nothing of how good the fit is.\n",
            -fit.freedom);
    return text;
}

std::string fit_json(const ResinFit& fit, const PatchTable& table, const FitExtras& extras) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-fit").add("version", 1).add("g", fit.set.g).add("eta", fit.set.eta);
    json.add("seconds", fit.seconds).add("freedom", fit.freedom).key("channels").begin_list();
    for (std::size_t c = 0; c < table.channels.size(); ++c) json.value(channel_name(table.channels, c));
    json.end_list().add("chi2", fit.chi2).key("misfit").begin_list();
    for (const std::size_t c : fit.misfit) json.value(channel_name(table.channels, c));
    json.end_list().key("dot_spread").begin_object().add("value", fit.set.dot_spread);
    json.add("error", fit.dot_spread_error).end_object();
    json.add("warnings", fit.warnings).key("resins").begin_list();
    for (const FittedResin& resin : fit.resins) add_resin(json, resin, table.channels);
    json.end_list();
    if (extras.spread) {
        json.key("spread").begin_object().add("mm", extras.spread->mm).add("error", extras.spread->error);
        json.add("chi2", extras.spread->chi2).add("freedom", extras.spread->freedom).end_object();
    }
    if (extras.ends) json.add("square_ends", *extras.ends);
    add_patches_of(json, fit.patches, table);
    if (extras.check) {
        json.key("check");
        add_check(json, *extras.check, *extras.checked);
    }
    if (!extras.sweep.empty()) add_sweep(json, extras.sweep);
    return json.end_object().text();
}

std::string check_text(const PatchCheck& check, const PatchTable& table) {
    if (table.is_of_laminates()) return laminate_check_text(check, table);
    return fmt::format("{}\nrms error of a reflectance {:.4f}\n{}", differences_text(check.differences), check.rms,
                       worst_patches(check, table));
}

std::string check_json(const PatchCheck& check, const PatchTable& table) {
    if (table.is_of_laminates()) return laminate_check_json(check, table);
    io::JsonWriter json;
    add_check(json, check, table);
    return json.text();
}

std::string sweep_text(const std::vector<SweepLine>& lines) {
    std::string text = fmt::format("\n{:>6} {:>18} {:>8} {:>8} {:>8} {:>8}\n", "g", "chi2 per freedom", "mean",
                                   "median", "95 %", "largest CIEDE2000");
    for (const SweepLine& line : lines)
        text += fmt::format("{:>6.2f} {:>18.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n", line.g, line.chi2,
                            line.differences.mean, line.differences.median, line.differences.percentile_95,
                            line.differences.max);
    return text;
}

}  // namespace voxtone::calibration
