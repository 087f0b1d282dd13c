// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_difference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "calibration/compare/print_spread.h"

namespace voxtone::calibration {

namespace {

constexpr double border_mm = 0.3;    // beside the edge: its rounding, the ground, and what is off in place
constexpr double least_named = 0.3;  // CIEDE2000 in the mean, that a cause must account for
constexpr double least_spread_mm = 0.03;
constexpr double dark_cell = 0.01;  // of white: ratios of darker cells are noise

using Picture = std::vector<Eigen::Vector3f>;

double luminance(const Eigen::Vector3f& rgb) { return optics::xyz_from_linear_srgb(rgb.cast<double>()).y(); }

/// Of the value below which half of the weight lies.
double weighted_median(std::vector<std::pair<double, double>> values) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    double half = 0;
    for (const auto& [value, weight] : values) half += weight / 2;
    for (const auto& [value, weight] : values) {
        half -= weight;
        if (half <= 0) return value;
    }
    return values.back().first;
}

/// Median of ln(seen / predicted) over cells that count, of one number of each.
template <class Of>
double log_ratio(const Picture& seen, const Picture& predicted, const std::vector<std::uint8_t>& counts, const Of& of) {
    std::vector<std::pair<double, double>> ratios;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (!counts[i]) continue;
        const double s = of(seen[i]), p = of(predicted[i]);
        if (p < dark_cell || !(s > 0)) continue;
        ratios.emplace_back(std::log(s / p), std::cbrt(p));
    }
    return weighted_median(std::move(ratios));
}

std::vector<std::uint8_t> counted(const PredictedPrint& print, const CellSamples& cells) {
    const int bx = int(std::ceil(border_mm / print.cell_mm.x())), by = int(std::ceil(border_mm / print.cell_mm.y()));
    std::vector<std::uint8_t> counts = cells.good;
    for (int row = 0; row < print.rows; ++row)
        for (int column = 0; column < print.columns; ++column)
            if (column < bx || row < by || column >= print.columns - bx || row >= print.rows - by)
                counts[print.index(column, row)] = 0;
    return counts;
}

void scale(Picture& picture, const Eigen::Vector3d& gain) {
    for (Eigen::Vector3f& rgb : picture) rgb = rgb.cwiseProduct(gain.cast<float>());
}

/// What does not count is as predicted, so that an eye does not mix in what is not known.
Picture filled(const Picture& seen, const Picture& predicted, const std::vector<std::uint8_t>& counts) {
    Picture all = seen;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!counts[i]) all[i] = predicted[i];
    return all;
}

Eigen::Vector3d lab_of(const Eigen::Vector3f& rgb) {
    return optics::lab_from_linear_srgb(rgb.cwiseMax(0.0f).cast<double>());
}

std::vector<float> differences(const Picture& a, const Picture& b, const std::vector<std::uint8_t>& counts) {
    std::vector<float> all(a.size(), 0.0f);
    for (std::size_t i = 0; i < a.size(); ++i)
        if (counts[i]) all[i] = float(optics::ciede2000(lab_of(a[i]), lab_of(b[i])));
    return all;
}

optics::DifferenceSummary summary_of(const std::vector<float>& all, const std::vector<std::uint8_t>& counts) {
    std::vector<double> some;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (counts[i]) some.push_back(double(all[i]));
    return optics::summarize(some);
}

/// Mean CIEDE2000 as seen.
double mean_seen(const PredictedPrint& print, const Picture& predicted, const Picture& seen,
                 const std::vector<std::uint8_t>& counts) {
    return summary_of(differences(print.seen(predicted), print.seen(filled(seen, predicted, counts)), counts), counts)
        .mean;
}

/// Exposure and cast of one reading, which are taken out of it.
struct Gains {
    double exposure_ev = 0;
    Eigen::Vector3d cast = Eigen::Vector3d::Ones();
};

Gains gains_of(const PredictedPrint& print, const Picture& seen, const std::vector<std::uint8_t>& counts) {
    Gains gains;
    const double log_y = log_ratio(seen, print.rgb, counts, luminance);
    gains.exposure_ev = log_y / std::log(2.0);
    for (int c = 0; c < 3; ++c)
        gains.cast[c] = std::exp(
            log_ratio(seen, print.rgb, counts, [c](const Eigen::Vector3f& v) { return double(v[c]); }) - log_y);
    return gains;
}

struct TileSums {
    TileCells at;
    Eigen::Vector3d predicted = Eigen::Vector3d::Zero(), printed = Eigen::Vector3d::Zero();
    double cells = 0;
};

std::vector<TileSums> sums_of(const PredictedPrint& print, const Picture& printed, const Picture& predicted,
                              const std::vector<std::uint8_t>& counts) {
    std::vector<TileSums> tiles;
    for (const TileCells& at : tiles_over(print)) {
        TileSums tile{.at = at};
        for (int row = at.row; row < at.row + at.rows; ++row)
            for (int column = at.column; column < at.column + at.columns; ++column) {
                const std::size_t cell = print.index(column, row);
                if (!counts[cell]) continue;
                tile.predicted += predicted[cell].cast<double>();
                tile.printed += printed[cell].cast<double>();
                tile.cells += 1;
            }
        tiles.push_back(tile);
    }
    std::erase_if(tiles, [](const TileSums& t) { return t.cells < 0.3 * t.at.columns * t.at.rows; });
    return tiles;
}

std::vector<ResinSample> resin_samples(const PredictedPrint& print, const std::vector<PrintRegion>& regions) {
    std::vector<ResinSample> samples;
    const std::size_t channels = print.response.channels;
    for (const PrintRegion& region : regions) {
        if (region.predicted.minCoeff() < dark_cell || region.printed.minCoeff() < dark_cell) continue;
        ResinSample sample;
        sample.place = region.place;
        sample.log_ratio = (region.printed.array() / region.predicted.array()).log();
        for (std::size_t r = 0; r < print.response.resins; ++r) {
            Eigen::Vector3d by = Eigen::Vector3d::Zero();
            for (std::size_t c = 0; c < channels; ++c) by += region.by_value.col(Eigen::Index(2 * (r * channels + c)));
            sample.by_extinction.emplace_back(by.cwiseQuotient(region.predicted));
        }
        sample.weight = std::cbrt(region.predicted.mean());
        samples.push_back(std::move(sample));
    }
    return samples;
}

std::vector<PrintTile> told(const PredictedPrint& print, const std::vector<TileSums>& sums) {
    std::vector<PrintTile> tiles;
    for (const TileSums& sum : sums) {
        PrintTile tile;
        tile.corner_mm = {sum.at.column * print.cell_mm.x(), sum.at.row * print.cell_mm.y()};
        tile.size_mm = {sum.at.columns * print.cell_mm.x(), sum.at.rows * print.cell_mm.y()};
        tile.predicted = sum.predicted / sum.cells;
        tile.printed = sum.printed / sum.cells;
        const Eigen::Vector3d a = lab_of(tile.predicted.cast<float>()), b = lab_of(tile.printed.cast<float>());
        tile.off_lab = b - a;
        tile.ciede2000 = optics::ciede2000(a, b);
        tiles.push_back(tile);
    }
    std::ranges::sort(tiles, [](const PrintTile& a, const PrintTile& b) { return a.ciede2000 > b.ciede2000; });
    return tiles;
}

/// What each of them is worth, and how it is told.
struct Cause {
    double worth;
    std::string sentence;
};

std::string exposure_words(const PrintDifference& d, bool has_checker) {
    return fmt::format("exposure: the photograph is {:.2f} EV {} than predicted ({})", std::abs(d.exposure_ev),
                       d.exposure_ev > 0 ? "brighter" : "darker",
                       has_checker ? "beside the checker: the print's lightness, or how light falls on it"
                                   : "without a colour checker the camera's exposure and the print's lightness cannot "
                                     "be told apart");
}

std::string cast_words(const PrintDifference& d, bool has_checker) {
    return fmt::format("cast: red, green and blue {:.2f}, {:.2f} and {:.2f} times as predicted ({})", d.cast[0],
                       d.cast[1], d.cast[2],
                       has_checker ? "by the colour checker: the print's own"
                                   : "the camera's white balance, or the print's: only a colour checker tells");
}

std::string spread_words(const PrintDifference& d, bool camera_known) {
    return fmt::format(
        "blur: colours run {:.2f} mm wider than predicted (a Gaussian's standard deviation; {}): droplets that spread, "
        "or light that goes farther than the resins' set says",
        camera_known ? d.print_spread_mm : d.spread_mm,
        camera_known ? "the camera's taken off" : "the camera's is in it");
}

std::string resin_words(const PredictedPrint& print, const ResinHints& hints) {
    const ResinHint& hint = hints.resins[*hints.named];
    return fmt::format(
        "resin: {} errs as if its extinction were {:.0f} +- {:.0f} % {} than the set has ({:.0f} % of "
        "what is left)",
        print.resin(*hints.named), 100 * std::abs(hint.change), 100 * hint.error,
        hint.change > 0 ? "larger" : "smaller", 100 * hint.explained);
}

void name_causes(const PredictedPrint& print, bool has_checker, bool camera_known, PrintDifference& d) {
    std::vector<Cause> causes;
    if (d.as_taken - d.after_exposure >= least_named)
        causes.push_back({d.as_taken - d.after_exposure, exposure_words(d, has_checker)});
    if (d.after_exposure - d.after_cast >= least_named)
        causes.push_back({d.after_exposure - d.after_cast, cast_words(d, has_checker)});
    if (d.print_spread_mm >= least_spread_mm)
        causes.push_back({d.after_cast - d.after_spread, spread_words(d, camera_known)});
    if (d.hints.named)
        causes.push_back({d.hints.resins[*d.hints.named].explained * d.after_spread, resin_words(print, d.hints)});
    std::ranges::stable_sort(causes, [](const Cause& a, const Cause& b) { return a.worth > b.worth; });
    for (Cause& cause : causes) d.causes.push_back(std::move(cause.sentence));
}

}  // namespace

std::string tile_words(const PrintTile& tile) {
    constexpr double least = 0.5;
    const auto [l, a, b] = std::tuple(tile.off_lab[0], tile.off_lab[1], tile.off_lab[2]);
    std::vector<std::pair<double, std::string>> ways{{std::abs(l), l > 0 ? "lighter" : "darker"},
                                                     {std::abs(a), a > 0 ? "redder" : "greener"},
                                                     {std::abs(b), b > 0 ? "yellower" : "bluer"}};
    std::ranges::stable_sort(ways, [](const auto& x, const auto& y) { return x.first > y.first; });
    if (ways[0].first < least) return "printed as predicted";
    std::string words = fmt::format("printed {:.1f} {}", ways[0].first, ways[0].second);
    if (ways[1].first >= std::max(least, 0.3 * ways[0].first))
        words += fmt::format(" and {:.1f} {}", ways[1].first, ways[1].second);
    return words + " than predicted";
}

PrintDifference difference_of(const PredictedPrint& print, const std::vector<PrintReading>& readings) {
    PrintDifference d;
    const double n = double(readings.size());
    const bool has_checker = std::ranges::all_of(readings, &PrintReading::has_checker);
    Picture sum(print.cells(), Eigen::Vector3f::Zero());
    std::vector<int> seen_by(print.cells(), 0);
    Eigen::Vector3d log_cast = Eigen::Vector3d::Zero();
    double camera2 = 0;
    bool camera_known = true;
    for (const PrintReading& reading : readings) {
        const std::vector<std::uint8_t> counts = counted(print, reading.cells);
        Picture seen = reading.cells.value;
        d.as_taken += mean_seen(print, print.rgb, seen, counts) / n;
        const Gains gains = gains_of(print, seen, counts);
        scale(seen, Eigen::Vector3d::Constant(std::exp2(-gains.exposure_ev)));
        d.after_exposure += mean_seen(print, print.rgb, seen, counts) / n;
        Picture neutral = seen;
        scale(neutral, gains.cast.cwiseInverse());
        d.after_cast += mean_seen(print, print.rgb, neutral, counts) / n;
        d.exposure_ev += gains.exposure_ev / n;
        log_cast += gains.cast.array().log().matrix() / n;
        camera_known &= reading.camera_blur_mm.has_value();
        camera2 += std::pow(reading.camera_blur_mm.value_or(0), 2) / n;
        const Picture& used = has_checker ? seen : neutral;
        if (d.shown.empty()) d.shown = used;
        for (std::size_t i = 0; i < used.size(); ++i)
            if (counts[i]) sum[i] += used[i], ++seen_by[i];
    }
    d.cast = log_cast.array().exp();
    std::vector<std::uint8_t> counts(print.cells());
    d.printed = print.rgb;
    for (std::size_t i = 0; i < counts.size(); ++i)
        if ((counts[i] = seen_by[i] > 0)) d.shown[i] = d.printed[i] = sum[i] / float(seen_by[i]);
    d.predicted_seen = print.seen(print.rgb);
    d.printed_seen = print.seen(d.printed);
    d.difference = differences(d.predicted_seen, d.printed_seen, counts);
    d.ciede2000 = summary_of(d.difference, counts);

    d.spread_mm = fitted_spread_mm(print.rgb, d.printed, counts, print.columns, print.cell_mm);
    d.print_spread_mm = std::sqrt(std::max(d.spread_mm * d.spread_mm - camera2, 0.0));
    const Picture spread = spread_cells(print.rgb, print.columns, d.spread_mm * print.cell_mm.cwiseInverse());
    d.after_spread = mean_seen(print, spread, d.printed, counts);
    const Picture by_paths = spread_cells(print.by_paths, print.columns, d.spread_mm * print.cell_mm.cwiseInverse());
    d.regions = regions_of(print, d.printed, by_paths, counts);
    d.hints = hint_at_resins(resin_samples(print, d.regions), print.response.resins);
    d.tiles = told(print, sums_of(print, d.printed, print.rgb, counts));
    name_causes(print, has_checker, camera_known, d);
    d.counts = std::move(counts);
    return d;
}

}  // namespace voxtone::calibration
