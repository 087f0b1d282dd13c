// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/top_print.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "halftone/loop/eye_filter.h"
#include "slicer/look/prediction_files.h"

namespace voxtone::slicer {

namespace {

/// Of a perfect diffuser's: a photograph shows how light is lost at a slab's sides, which no white of the same place
/// takes out of it.
PredictOptions as_photographed(PredictOptions options) {
    options.absolute = true;
    return options;
}

/// Places of cells.
TopPrint picture_of(const PredictOptions& options, const PredictedStack& predicted, const PredictFigures& figures) {
    const optics::Surface& surface = predicted.prediction.surface;
    const auto size = picture_cells(predicted.stack.volume, surface.cell_voxels);
    const auto px_per_mm = picture_px_per_mm(predicted.stack.volume, surface.cell_voxels);
    TopPrint top;
    top.columns = size[0], top.rows = size[1];
    top.cell_mm = {1 / px_per_mm[0], 1 / px_per_mm[1]};
    const std::size_t cells = std::size_t(size[0]) * std::size_t(size[1]);
    if (surface.cells.size() != cells)
        throw InputError(fmt::format(
            "{}: the slab has holes or no straight outline: {} of the {} cells of its box are there, and photographs "
            "are compared with slabs that fill theirs",
            options.stack, surface.cells.size(), cells));
    const Eigen::Vector3f white = photographed_white(predicted, figures);
    top.rgb.resize(cells);
    top.cell_of.resize(cells);
    for (std::size_t i = 0; i < cells; ++i) {
        const optics::SurfaceCell& cell = surface.cells[i];
        const std::size_t at =
            std::size_t(size[1] - 1 - cell.cell[1]) * std::size_t(size[0]) + std::size_t(cell.cell[0]);
        top.rgb[at] = predicted.prediction.rgb[i].cwiseQuotient(white);
        top.cell_of[at] = i;
    }
    top.set = predicted.stack.resins;
    top.illuminant = predicted.stack.illuminant;
    return top;
}

}  // namespace

TopPrint predict_top_picture(const PredictOptions& options, Progress& progress) {
    PredictFigures figures;
    PredictedStack predicted = predict_from_above(as_photographed(options), figures, progress);
    TopPrint top = picture_of(options, predicted, figures);
    top.surface = std::move(predicted.prediction.surface);
    return top;
}

std::variant<TopPrint, BodyPrint> predict_photographed(const PredictOptions& options, ResinParts parts,
                                                       Progress& progress) {
    PredictFigures figures;
    PredictedStack predicted = predict_slab_or_body(as_photographed(options), figures, progress);
    if (!figures.from_above) return body_print(std::move(predicted), figures);
    TopPrint top = picture_of(options, predicted, figures);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    const std::vector<Eigen::Vector3f> by_paths = colours_by_paths(predicted, figures, progress);
    for (const std::size_t cell : top.cell_of) top.by_paths.push_back(by_paths[cell]);
    top.response = resin_response(predicted, figures, parts, progress);
    top.surface = std::move(predicted.prediction.surface);
    return top;
}

SeenPicture eye_over(const TopPrint& top, double viewing_distance_mm) {
    const auto eye = std::make_shared<const halftone::EyeFilter>(top.surface, viewing_distance_mm);
    return [eye, cell_of = top.cell_of](std::span<const Eigen::Vector3f> rgb) {
        std::vector<Eigen::Vector3f> by_cell(rgb.size()), seen;
        for (std::size_t i = 0; i < rgb.size(); ++i) by_cell[cell_of[i]] = rgb[i];
        by_cell = eye->filter(by_cell);
        for (const std::size_t cell : cell_of) seen.push_back(by_cell[cell]);
        return seen;
    };
}

SeenPicture eye_over(int columns, int rows, const std::array<double, 2>& pixel_mm, double viewing_distance_mm) {
    optics::Surface flat;
    flat.cell_voxels = {1, 1, 1};
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            flat.cells.push_back({.cell = {column, row, 0},
                                  .centre_mm = {float(column * pixel_mm[0]), float(row * pixel_mm[1]), 0},
                                  .normal = {0, 0, 1},
                                  .area_mm2 = float(pixel_mm[0] * pixel_mm[1])});
    const auto eye = std::make_shared<const halftone::EyeFilter>(flat, viewing_distance_mm);
    return [eye](std::span<const Eigen::Vector3f> rgb) { return eye->filter(rgb); };
}

}  // namespace voxtone::slicer
