// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/viewer_report.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include <fmt/core.h>

#include "io/pictures/srgb_code.h"
#include "slicer/colour/asked_alpha.h"
#include "slicer/colour/place_words.h"
#include "slicer/colour/verdict.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/support_contact.h"
#include "slicer/part/loop_plan.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

/// Dark where support material will touch the print: those faces come out matt in the glossy mode of printing.
SurfaceLook support_look(const JobPrediction& p) {
    const SupportContact contact(p.volume, 0, 1);
    SurfaceLook look{"support", "dark where support material touches the print, which leaves it matt", {}};
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells) {
        optics::Point at{}, outward{};
        for (std::size_t a = 0; a < 3; ++a) {
            at[a] = double(cell.centre_mm[a]);
            outward[a] = double(cell.normal[a]);
        }
        look.rgb.push_back(Eigen::Vector3f::Constant(contact.touched(at, outward) ? 0.1f : 0.8f));
    }
    return look;
}

SurfaceLooks predicted_looks(const ColourReport& s, const JobPrediction& p) {
    SurfaceLooks looks;
    looks.looks.push_back({"target", "what was asked for", p.target});
    if (!p.open_loop.empty())
        looks.looks.push_back({"open loop", "what would be seen without the appearance loop", p.open_loop});
    looks.looks.push_back({"print", fmt::format("what will be seen, by the model {}", p.model), p.predicted.rgb});
    if (s.translucency) {
        auto maps = alpha_of_cells(p.predicted.surface, p.volume.pitch_mm(), s.body, *s.translucency);
        for (std::size_t map = 0; map < maps.size(); ++map)
            looks.looks.push_back({alpha_maps()[map].name, alpha_maps()[map].caption, std::move(maps[map])});
    }
    looks.seen = p.seen.difference;
    looks.single = p.difference;
    return looks;
}

Eigen::Vector3d vector_of(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

io::Rgb codes_of(const Eigen::Vector3f& rgb) {
    return {io::linear_to_srgb8(rgb[0]), io::linear_to_srgb8(rgb[1]), io::linear_to_srgb8(rgb[2])};
}

io::ViewerPlace place_of(const ColourReport& s, const JobPrediction& p, std::size_t i, const PlaceWords& words) {
    const optics::SurfaceCell& cell = p.predicted.surface.cells[i];
    const double thin_mm = 2 * s.job.options.colour.depth_mm;
    const CellLoss loss = loss_of_cell(p, s.colour, i, thin_mm);
    io::ViewerPlace place;
    for (std::size_t a = 0; a < 3; ++a) {
        place.at_mm[a] = double(cell.centre_mm[a]);
        place.normal[a] = double(cell.normal[a]);
    }
    place.seen = p.seen.difference[i];
    place.target = codes_of(p.seen.target[i]);
    place.print = codes_of(p.seen.print[i]);
    place.cause = name_of(loss.cause);
    if (loss.cause == LossCause::thin_wall) place.cause += fmt::format(", {:.2f} mm", loss.wall_mm);
    place.words = words.at(place.at_mm);
    return place;
}

std::optional<io::ViewerSurface> predicted_surface(const ColourReport& s, const JobPrediction& p, std::size_t bytes) {
    if (s.body.is_picture) return viewer_picture(p.volume, p.predicted.surface, predicted_looks(s, p), bytes);
    if (s.cell_triangles.empty()) return std::nullopt;
    const io::ColouredMesh mesh = body_mesh(s.cell_triangles, {0, 0, 0}, p.predicted);
    const double grain_mm = *std::max_element(p.cell_um.begin(), p.cell_um.end()) * 1e-3;
    SurfaceLooks looks = predicted_looks(s, p);
    looks.looks.push_back(support_look(p));
    return viewer_body(mesh, looks, grain_mm, bytes);
}

}  // namespace

std::vector<io::ViewerPlace> worst_places(const ColourReport& s, const JobPrediction& p) {
    constexpr std::size_t most = 10;
    constexpr double apart = 1.0 / 12;  // of the body
    const std::vector<double>& seen = p.seen.difference;
    const auto& size = p.volume.size();
    const auto& pitch = p.volume.pitch_mm();
    const double apart_mm = apart * std::max({size[0] * pitch[0], size[1] * pitch[1], size[2] * pitch[2]});
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] > s.job.options.verdict.good) order.push_back(i);
    std::vector<double> off(seen.size());
    for (const std::size_t i : order) off[i] = seen[i] * p.sides.weight(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return off[a] > off[b]; });
    std::vector<io::ViewerPlace> places;
    std::vector<Eigen::Vector3d> taken;
    const PlaceWords words(s.body);
    for (const std::size_t i : order) {
        const Eigen::Vector3d at = vector_of(p.predicted.surface.cells[i].centre_mm);
        const auto near = [&](const Eigen::Vector3d& other) { return (other - at).norm() < apart_mm; };
        if (std::any_of(taken.begin(), taken.end(), near)) continue;
        taken.push_back(at);
        places.push_back(place_of(s, p, i, words));
        if (places.size() == most) break;
    }
    return places;
}

std::optional<io::ViewerSurface> viewer_surface(const ColourReport& s, std::size_t bytes, const Progress& progress) {
    if (s.prediction) return predicted_surface(s, *s.prediction, bytes);
    std::vector<PaintedSurface> painted{
        {"target", "what was asked for", target_surface(s)},
        prints_all_white(s.surface_colour, s.job.resins)
            ? PaintedSurface{"print", "all of white resin", separated_surface(s)}
            : PaintedSurface{"colours in reach",
                             "what the resins can reach on a thick body, by the separation's own model: no prediction "
                             "of the print",
                             separated_surface(s)}};
    if (s.translucency) {
        const auto maps = PrintedAlpha(*s.body.surface, s.surface_colour, *s.translucency).maps();
        for (std::size_t map = 0; map < maps.size(); ++map)
            painted.push_back({alpha_maps()[map].name, alpha_maps()[map].caption, maps[map]});
    }
    io::ViewerSurface surface =
        viewer_painted(painted, s.body.grid.origin_mm, s.body.is_picture, true, bytes, &progress);
    surface.expected = painted[1].name;
    return surface;
}

void add_viewer(const ColourReport& s, io::Report& report, const Progress& progress) {
    constexpr std::size_t least_bytes = 50'000;  // less shows no surface
    const std::size_t bytes = surface_bytes_left(report);
    progress.check_cancelled();
    if (bytes < least_bytes) return;
    if (s.prediction) {
        report.viewer.viewing_distance_mm = s.job.options.loop.viewing_distance_mm;
        report.viewer.worst = worst_places(s, *s.prediction);
    }
    report.viewer.surface = viewer_surface(s, bytes, progress);
}

}  // namespace voxtone::slicer
