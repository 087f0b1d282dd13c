// SPDX-License-Identifier: GPL-3.0-or-later
#include "tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "gratings.h"

namespace voxtone::loop_benchmark {
namespace {

std::string number(double v, int digits = 2) { return std::isfinite(v) ? fmt::format("{:.{}f}", v, digits) : "-"; }

std::string ratio(double before, double after) { return before > 0 ? number(after / before) : "-"; }

/// Of the fitting set or of the held-out one; empty where none of it was printed.
std::string mean_row(const std::vector<SlabRow>& rows, bool held_out, Figures Scores::*which) {
    std::array<Figures, 2> mean;
    const auto n = std::count_if(rows.begin(), rows.end(), [&](const SlabRow& r) { return r.held_out == held_out; });
    if (n == 0) return "";
    for (const SlabRow& r : rows)
        for (std::size_t v = 0; r.held_out == held_out && v < 2; ++v) {
            const Figures& of = r.scores[v].*which;
            mean[v].mean += of.mean / double(n);
            mean[v].median += of.median / double(n);
            mean[v].percentile_95 += of.percentile_95 / double(n);
        }
    const auto& [a, b] = mean;
    return fmt::format("| **mean, {} set** | {} targets | {} -> {} | {} | {} -> {} | {} | {} -> {} | {} | |\n",
                       held_out ? "held-out" : "fitting", n, number(a.mean), number(b.mean), ratio(a.mean, b.mean),
                       number(a.median), number(b.median), ratio(a.median, b.median), number(a.percentile_95),
                       number(b.percentile_95), ratio(a.percentile_95, b.percentile_95));
}

std::string error_table(const std::vector<SlabRow>& rows, const std::vector<std::string>& names, const char* title,
                        Figures Scores::*which) {
    std::string text = fmt::format(
        "\n**{}**, CIEDE2000, {} -> {}\n\n"
        "| target | cells | mean | ratio | median | ratio | 95 % | ratio | noise (taken out) |\n"
        "|---|---|---|---|---|---|---|---|---|\n",
        title, names[0], names[1]);
    for (const SlabRow& r : rows) {
        const Figures &a = r.scores[0].*which, &b = r.scores[1].*which;
        text += fmt::format("| {} | {} | {} -> {} | {} | {} -> {} | {} | {} -> {} | {} | {}, {} |\n", r.name, a.cells,
                            number(a.mean), number(b.mean), ratio(a.mean, b.mean), number(a.median), number(b.median),
                            ratio(a.median, b.median), number(a.percentile_95), number(b.percentile_95),
                            ratio(a.percentile_95, b.percentile_95), number(a.noise), number(b.noise));
    }
    for (const bool held_out : {false, true}) text += mean_row(rows, held_out, which);
    return text;
}

}  // namespace

std::string slab_tables(const std::vector<SlabRow>& rows, const std::vector<std::string>& names) {
    std::string text =
        error_table(rows, names, "After the eye filter at 300 mm, colour smoothed as light, in-gamut pixels",
                    &Scores::eye_in_gamut) +
        error_table(rows, names, "After the eye filter, in-gamut pixels, what surrounds them mapped into the gamut",
                    &Scores::eye_reachable) +
        error_table(rows, names, "As the program says it, colour smoothed as it is perceived, in-gamut pixels",
                    &Scores::seen_in_gamut) +
        error_table(rows, names,
                    "After the eye filter in S-CIELAB's own channels, in which white is not neutral, in-gamut pixels",
                    &Scores::s_cielab_in_gamut) +
        error_table(rows, names, "Cells of 0.085 mm, in-gamut pixels", &Scores::cells_in_gamut) +
        error_table(rows, names, "After the eye filter, all pixels, target mapped into the gamut",
                    &Scores::eye_mapped) +
        error_table(rows, names, "After the eye filter, all pixels", &Scores::eye_all) +
        error_table(rows, names, "Cells of 0.085 mm, all pixels", &Scores::cells_all);
    text += fmt::format(
        "\n**Work**, {} -> {}\n\n| target | in gamut | iterations | seconds | core seconds | of the error as seen at a "
        "limit |\n|---|---|---|---|---|---|\n",
        names[0], names[1]);
    for (const SlabRow& r : rows)
        text += fmt::format(
            "| {} | {:.0f} % | {} | {} -> {} | {} -> {} | {:.0f} % -> {:.0f} % |\n", r.name, 100 * r.share_in_gamut,
            r.print[1].iterations >= 0 ? std::to_string(r.print[1].iterations) : "-", number(r.print[0].seconds, 1),
            number(r.print[1].seconds, 1), number(r.print[0].core_seconds, 1), number(r.print[1].core_seconds, 1),
            100 * r.scores[0].at_limit, 100 * r.scores[1].at_limit);
    text += fmt::format(
        "\n**Contrast kept** (slope of what is finer than {} mm of L* as seen, in-gamut pixels) and paper (mean "
        "CIEDE2000 "
        "as seen where the target is white), {} -> {}\n\n| target | contrast | ratio | paper |\n|---|---|---|---|\n",
        fine_mm, names[0], names[1]);
    for (const SlabRow& r : rows)
        text +=
            fmt::format("| {} | {} -> {} | {} | {} -> {} |\n", r.name, number(r.scores[0].contrast_kept),
                        number(r.scores[1].contrast_kept), ratio(r.scores[0].contrast_kept, r.scores[1].contrast_kept),
                        number(r.scores[0].paper), number(r.scores[1].paper));
    for (const SlabRow& r : rows) {
        if (!r.gratings) continue;
        text += fmt::format("\n**Modulation kept**, {}\n\n| line pairs per mm | {} | {} | ratio |\n|---|---|---|---|\n",
                            r.name, names[0], names[1]);
        for (std::size_t f = 0; f < 3; ++f)
            text += fmt::format("| {} | {} | {} | {} |\n", grating_frequencies[f], number(r.modulation[0][f]),
                                number(r.modulation[1][f]), ratio(r.modulation[0][f], r.modulation[1][f]));
    }
    return text;
}

}  // namespace voxtone::loop_benchmark
