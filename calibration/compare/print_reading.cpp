// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/compare/edge_blur.h"
#include "calibration/compare/ground_light.h"
#include "calibration/compare/print_finder.h"
#include "calibration/photo/colour_checker.h"
#include "calibration/photo/patch_sampling.h"

namespace voxtone::calibration {

namespace {

constexpr double chart_doubt = 0.03;  // residual of the chart in linear sRGB, as photo_measurement.cpp has it
constexpr double most_clipped = 0.5;  // of the cells: more says nothing
constexpr double some_clipped = 0.02;
constexpr double least_brightness = 0.02;  // of full scale, of the print's lightest tenth

PrintCorners place_of(const PrintPlace& place) {
    const Eigen::Vector2d s = place.size();
    return {place.to_px({0, 0}), place.to_px({s.x(), 0}), place.to_px(s), place.to_px({0, s.y()})};
}

PrintCorners chart_corners(const CheckerView& view, const CheckerChart& chart) {
    const double w = chart.columns, h = chart.rows;
    return {view.place.to_px({0, 0}), view.place.to_px({w, 0}), view.place.to_px({w, h}), view.place.to_px({0, h})};
}

/// What each cell is divided by, and into what colours it goes.
template <class Light, class Colour>
void correct(PrintReading& reading, int columns, const Light& light, const Colour& colour) {
    double least = 1e30, most = 0;
    for (std::size_t cell = 0; cell < reading.cells.value.size(); ++cell) {
        const Eigen::Vector2d at(double(cell % std::size_t(columns)) + 0.5, double(cell / std::size_t(columns)) + 0.5);
        const Eigen::Vector2d px = reading.found.place.to_px(at);
        const double here = light(px);
        least = std::min(least, here);
        most = std::max(most, here);
        reading.cells.value[cell] =
            colour(px, reading.cells.value[cell].template cast<double>().eval()).template cast<float>();
    }
    reading.light_falls_to = least / most;
}

void correct_by_chart(PrintReading& reading, const io::Photograph& photo, const PredictedPrint& print,
                      const ReadPrintOptions& options, const Eigen::Vector3d& clip) {
    const CheckerChart& chart = *options.checker;
    const CheckerView view =
        find_checker_in(photo, chart, clip, place_of(reading.found.place), options.checker_corners);
    const std::vector<LitSample> ground = ground_samples(photo, reading.found.place, chart_corners(view, chart));
    const PhotoModel model =
        PhotoModel::fit(usable_patches(view, chart), ground, photo.width_px, photo.height_px, photo.name);
    correct(
        reading, print.columns, [&](const Eigen::Vector2d& px) { return model.light(px); },
        [&](const Eigen::Vector2d& px, const Eigen::Vector3d& v) { return model.reflectance(px, v); });
    reading.has_checker = reading.light_from_ground = true;
    if (model.chart_residual() > chart_doubt)
        reading.warnings.push_back(named_warning(
            "checker-off",
            fmt::format("{}: after the colour correction the checker's patches are still off by {:.3f} on average "
                        "(linear, white is 1); colours of the print will be as much.",
                        photo.name, model.chart_residual())));
}

void correct_by_ground(PrintReading& reading, const io::Photograph& photo, const PredictedPrint& print) {
    const std::optional<GroundLight> light = GroundLight::fit(ground_samples(photo, reading.found.place), photo);
    if (!light) {
        reading.warnings.push_back(named_warning(
            "uneven-ground",
            fmt::format(
                "{}: the ground around the print is too dark or not even, so uneven light could not be found and "
                "stays in the comparison.",
                photo.name)));
        return;
    }
    reading.light_from_ground = true;
    const double middle = light->at(reading.found.place.to_px(print.size() / 2));
    correct(
        reading, print.columns, [&](const Eigen::Vector2d& px) { return light->at(px); },
        [&](const Eigen::Vector2d& px, const Eigen::Vector3d& v) -> Eigen::Vector3d {
            return v * (middle / light->at(px));
        });
}

void check_exposure(PrintReading& reading, const io::Photograph& photo) {
    std::vector<float> lightness;
    std::size_t bad = 0;
    for (std::size_t cell = 0; cell < reading.cells.value.size(); ++cell) {
        lightness.push_back(reading.cells.value[cell].maxCoeff());
        bad += !reading.cells.good[cell];
    }
    reading.clipped = double(bad) / double(lightness.size());
    if (reading.clipped > most_clipped)
        throw InputError(
            fmt::format("{}: {:.0f} % of the print are overexposed or out of the picture: a channel is "
                        "clipped there, so that its colour is not known; expose less",
                        photo.name, 100 * reading.clipped));
    if (reading.clipped > some_clipped)
        reading.warnings.push_back(named_warning(
            "clipped-print",
            fmt::format("{}: {:.0f} % of the print are overexposed (a mirrored lamp, or the exposure) and were left "
                        "out.",
                        photo.name, 100 * reading.clipped)));
    const auto tenth = lightness.begin() + std::ptrdiff_t(lightness.size() * 9 / 10);
    std::nth_element(lightness.begin(), tenth, lightness.end());
    if (photo.bits < 32 && double(*tenth) < least_brightness)
        throw InputError(
            fmt::format("{}: the photograph is underexposed: the lightest tenth of the print reaches "
                        "{:.1f} % of full scale; expose longer",
                        photo.name, 100 * double(*tenth)));
}

/// ln (seen / predicted) of an oblong of cells by channel, medians; nothing where too few count.
std::optional<Eigen::Vector3d> median_ratio(const PrintReading& reading, const PredictedPrint& print, int column,
                                            int row, int columns, int rows) {
    constexpr float darkest = 0.02f;  // of white: noise
    constexpr std::size_t least = 20;
    std::array<std::vector<double>, 3> ratios;
    for (int y = row; y < row + rows; ++y)
        for (int x = column; x < column + columns; ++x) {
            const std::size_t cell = print.index(x, y);
            const Eigen::Vector3f &seen = reading.cells.value[cell], &as = print.rgb[cell];
            if (!reading.cells.good[cell] || as.minCoeff() < darkest || !(seen.minCoeff() > 0)) continue;
            for (int c = 0; c < 3; ++c) ratios[std::size_t(c)].push_back(std::log(double(seen[c] / as[c])));
        }
    if (ratios[0].size() < least) return std::nullopt;
    Eigen::Vector3d medians;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto middle = ratios[c].begin() + std::ptrdiff_t(ratios[c].size() / 2);
        std::nth_element(ratios[c].begin(), middle, ratios[c].end());
        medians[Eigen::Index(c)] = *middle;
    }
    return medians;
}

/// One corner darker than the rest in all colours alike is a shadow on it, whatever the resins.
void tell_shaded_corner(PrintReading& reading, const PredictedPrint& print) {
    constexpr double part = 0.15, shaded = -0.15, lit = -0.08, alike = 0.08;
    const auto all = median_ratio(reading, print, 0, 0, print.columns, print.rows);
    const int columns = int(part * print.columns), rows = int(part * print.rows);
    if (!all || columns < 1 || rows < 1) return;
    constexpr std::array<const char*, 4> names{"upper left", "upper right", "lower left", "lower right"};
    std::optional<std::size_t> shadowed;
    double darker = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const auto of = median_ratio(reading, print, corner % 2 == 0 ? 0 : print.columns - columns,
                                     corner < 2 ? 0 : print.rows - rows, columns, rows);
        if (!of) continue;
        const Eigen::Vector3d off = *of - *all;
        if (off.mean() > lit) continue;
        if (shadowed || off.mean() > shaded || off.maxCoeff() - off.minCoeff() > alike) return;
        shadowed = corner, darker = off.mean();
    }
    if (!shadowed) return;
    reading.warnings.push_back(named_warning(
        "shaded-corner",
        fmt::format("{}: the print's {} corner is {:.0f} % darker than the rest in all colours alike, as in the shadow "
                    "of a finger or of the camera; it counts as a difference of the print. Photograph it again.",
                    reading.photograph, names[*shadowed], 100 * (1 - std::exp(darker)))));
}

}  // namespace

void decode(io::Photograph& photo, io::SampleCoding coding) {
    if (coding != io::SampleCoding::unknown) photo.coding = coding;
    // What a file of 16 bits without a word holds: what cameras' programs write.
    if (photo.coding == io::SampleCoding::unknown) photo.coding = io::SampleCoding::srgb;
    if (photo.coding == io::SampleCoding::srgb) io::make_linear(photo);
}

PrintReading read_print(io::Photograph photo, const PredictedPrint& print, const ReadPrintOptions& options) {
    PrintReading reading;
    reading.photograph = photo.name;
    reading.width_px = photo.width_px;
    reading.height_px = photo.height_px;
    const Eigen::Vector3d clip = clipping_level(photo);
    decode(photo, options.coding);
    const std::vector<PrintCorners> may_be =
        options.corners ? std::vector{checked_corners(photo, *options.corners)} : find_prints(photo);
    reading.found = place_print(photo, may_be, print);
    reading.cells = sample_cells(photo, reading.found.place, print.columns, print.rows, clip);
    check_exposure(reading, photo);
    if (const auto blur_px = edge_blur_px(photo, reading.found.place))
        reading.camera_blur_mm = *blur_px * print.cell_mm.x() / reading.found.place.px_per_cell();
    if (options.checker)
        correct_by_chart(reading, photo, print, options, clip);
    else
        correct_by_ground(reading, photo, print);
    tell_shaded_corner(reading, print);
    return reading;
}

}  // namespace voxtone::calibration
