// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_tables.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "optics/colour/colour.h"

namespace voxtone::loop_benchmark {
namespace {

/// Standard error of the mean of the windows' means, noise included.
double sampling_error(const BodyJudgement& j, const Colours& target, const Colours& print,
                      const std::vector<char>& mask) {
    const std::vector<double> d = differences(target, print);
    std::vector<double> sum(j.windows, 0), count(j.windows, 0);
    for (std::size_t i = 0; i < d.size(); ++i)
        if (mask[i]) sum[j.window[i]] += d[i], count[j.window[i]] += 1;
    double n = 0, mean = 0, square = 0;
    for (std::size_t w = 0; w < j.windows; ++w)
        if (count[w] > 0) mean += sum[w] / count[w], n += 1;
    if (n < 2) return 0;
    mean /= n;
    for (std::size_t w = 0; w < j.windows; ++w)
        if (count[w] > 0) square += (sum[w] / count[w] - mean) * (sum[w] / count[w] - mean);
    return std::sqrt(square / (n - 1) / n);
}

}  // namespace

std::array<BodyFigures, 2> body_figures(const BodyJudgement& j, double viewing_distance_mm) {
    const halftone::EyeFilter eye(j.cells.surface, viewing_distance_mm);
    const Colours target = eye.filter(j.cells.target);
    const std::array<Colours, 2> half{eye.filter(j.cells.half[0]), eye.filter(j.cells.half[1])};
    const Colours print = eye.filter(j.cells.print());
    std::array<BodyFigures, 2> figures;
    for (std::size_t thin = 0; thin < 2; ++thin) {
        std::vector<char> mask(j.inner.size());
        for (std::size_t i = 0; i < mask.size(); ++i)
            mask[i] = j.inner[i] && j.cells.in_gamut[i] && static_cast<std::size_t>(j.thin[i]) == thin;
        figures[thin] = {compare(target, half, mask), compare(j.cells.target, j.cells.half, mask),
                         sampling_error(j, target, print, mask)};
    }
    return figures;
}

std::vector<double> solid_differences(const BodyJudgement& j, double viewing_distance_mm) {
    constexpr float same = 0.02F;  // linear; what else a window sees is not of its solid
    const halftone::EyeFilter eye(j.cells.surface, viewing_distance_mm, halftone::EyeSurround::none,
                                  halftone::OpponentSpace::cielab, halftone::EyeParts::narrowest);
    const Colours target = eye.smoothed(j.cells.target), print = eye.smoothed(j.cells.print());
    std::vector<std::array<Eigen::Vector3d, 2>> sum(j.solids.size(),
                                                    {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    std::vector<double> cells(j.solids.size(), 0);
    for (std::size_t i = 0; i < print.size(); ++i) {
        const std::size_t solid = j.solid_of[j.window[i]];
        if (!j.inner[i] || (j.cells.target[i] - j.solids[solid].target).cwiseAbs().maxCoeff() > same) continue;
        sum[solid][0] += target[i].cast<double>(), sum[solid][1] += print[i].cast<double>(), ++cells[solid];
    }
    std::vector<double> difference;
    for (std::size_t s = 0; s < sum.size(); ++s) {
        const double n = std::max(1.0, cells[s]);
        difference.push_back(differences({(sum[s][0] / n).cast<float>()}, {(sum[s][1] / n).cast<float>()})[0]);
    }
    return difference;
}

std::string figurine_table(const std::vector<FigurineRow>& rows) {
    std::string text = "| body | mean of its solids | each, open loop to loop (sRGB, mm2) |\n|---|---|---|\n";
    const auto mean = [](const std::vector<double>& d) {
        return std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(std::max<std::size_t>(1, d.size()));
    };
    for (const FigurineRow& row : rows) {
        if (row.solids.empty()) {
            text += fmt::format("| {} | no solid of flat colour | |\n", row.name);
            continue;
        }
        text += fmt::format("| {} | {:.2f} to {:.2f} |", row.name, mean(row.difference[0]), mean(row.difference[1]));
        for (std::size_t s = 0; s < row.solids.size(); ++s) {
            const Eigen::Vector3d rgb = row.solids[s].target.cast<double>().cwiseMax(0);
            text += fmt::format("{} ({:.0f} {:.0f} {:.0f}, {:.0f}) {:.1f} to {:.1f}", s ? ";" : "",
                                255 * optics::srgb_encode(rgb[0]), 255 * optics::srgb_encode(rgb[1]),
                                255 * optics::srgb_encode(rgb[2]), row.solids[s].area_mm2, row.difference[0][s],
                                row.difference[1][s]);
        }
        text += " |\n";
    }
    return text;
}

std::string body_table(const std::vector<BodyRow>& rows, const std::vector<std::string>& names) {
    std::string text = fmt::format(
        "\n**Bodies**, CIEDE2000 of in-gamut cells in windows drawn over the surface, {} -> {}; thin: less than 2 mm "
        "of body under the cell\n\n"
        "| body | part | of the surface | cells judged | as seen from 300 mm: mean (+- of sampling) | median | 95 % | "
        "cells of 0.085 mm: mean | seconds | core seconds | iterations |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n",
        names[0], names[1]);
    for (const BodyRow& r : rows)
        for (std::size_t thin = 0; thin < 2; ++thin) {
            const auto& f = thin ? r.thin : r.thick;
            if (f[0].seen.cells == 0) continue;
            text += fmt::format(
                "| {} | {} | {:.1f} % | {} | {:.2f} (+- {:.2f}) -> {:.2f} (+- {:.2f}) | {:.2f} -> {:.2f} | {:.2f} -> "
                "{:.2f} | {:.2f} -> {:.2f} | {:.0f} -> {:.0f} | {:.0f} -> {:.0f} | {} |\n",
                r.name, thin ? "thin" : "thick", 100 * (thin ? r.thin_share : 1 - r.thin_share), f[0].seen.cells,
                f[0].seen.mean, f[0].sampling, f[1].seen.mean, f[1].sampling, f[0].seen.median, f[1].seen.median,
                f[0].seen.percentile_95, f[1].seen.percentile_95, f[0].cells.mean, f[1].cells.mean, r.print[0].seconds,
                r.print[1].seconds, r.print[0].core_seconds, r.print[1].core_seconds,
                r.print[1].iterations >= 0 ? std::to_string(r.print[1].iterations) : "-");
        }
    return text;
}

}  // namespace voxtone::loop_benchmark
