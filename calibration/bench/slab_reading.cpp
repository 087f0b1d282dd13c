// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/slab_reading.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double most_left_out = 0.12, most_of_column = 0.4;   // of the strip; of a column of it
constexpr double said_left_out = 0.02, most_roughness = 0.01;  // of the brightest level, ...
constexpr double dark_roughness = 0.002;                       // ... or of a perfect diffuser
constexpr double bare_contrast = 0.8;               // of the sheet's: an edge beside the slab that nothing covers
constexpr double same_as_bare = 0.02;               // levels within this of the bare sheet's: there is no slab
constexpr double softer_by = 1.5, softer_px = 0.5;  // than the sheet's edge: refused
constexpr double shots_differ = 0.01;               // of white
constexpr double clear_step = 0.05;                 // from here on the edge under the slab is held against the board
constexpr double most_offset_mm = 0.25, most_bend_deg = 1.5, sure = 4;
constexpr double same_scale = 0.005, far_edge_mm = 5;

// The sharpest of the bare edges beside the slab.
double blur_beside(const io::Photograph& photo, const BoardView& board, const BenchReference& reference) {
    constexpr int reach = 4;
    double least = 0;
    for (int row = -reach; row <= reach; ++row)
        for (int column = -reach; column <= reach; ++column) {
            StripOptions options;
            options.middle_mm = reference.square_mm * Vector2d(column, row);
            if (options.middle_mm.norm() < 1.3 * reference.square_mm) continue;
            options.width_mm = 0.3 * reference.square_mm;
            options.length_mm = 0.5 * reference.square_mm;
            try {
                EdgeStrip strip = cut_strip(photo, board, reference.light->scale(photo), options);
                if ((row + column) & 1) {  // white lies left of black there
                    std::ranges::reverse(strip.mean);
                    std::ranges::reverse(strip.error);
                }
                const EdgeBlur edge = fit_bare_edge(strip);
                if (edge.contrast > bare_contrast * reference.sheet->edge.contrast)
                    least = least > 0 ? std::min(least, edge.blur_mm) : edge.blur_mm;
            } catch (const InputError&) {  // cut off by the picture's border, or clipped there
            }
        }
    return least;
}

void check_slab_is_there(const EdgeStrip& strip, const BenchReference& reference, const std::string& name) {
    const double end = strip.x_mm.back();
    const Vector3d white = side_mean(strip, end / 2, end), black = side_mean(strip, -end, -end / 2);
    double off = 0;
    for (std::size_t c = 0; c < 3; ++c)
        off = std::max({off, std::abs(white[Eigen::Index(c)] - reference.sheet->seen_white[c]),
                        std::abs(black[Eigen::Index(c)] - reference.sheet->seen_black[c])});
    if (off < same_as_bare)
        throw InputError(
            fmt::format("{}: both sides of the edge are as bright as the bare sheet's: there is no slab on it", name));
    // The darkest slab still leaves white not darker than black.
    if ((white - black).maxCoeff() < -same_as_bare)
        throw InputError(
            fmt::format("{}: it is brighter over the sheet's black than over its white, by {:.3f}: a shadow or glare, "
                        "or the sheet has another edge there",
                        name, (black - white).maxCoeff()));
}

// Board and edge are on one flat sheet: where they disagree it is bent, or something refracts.
void check_edge(const SeenEdge& edge, const std::string& name) {
    if (edge.step < clear_step) return;
    if (std::abs(edge.offset_mm) > most_offset_mm)
        throw InputError(
            fmt::format("{}: the edge under the slab lies {:+.2f} mm from where the board around it says; the sheet is "
                        "bent, or slab or glass are tilted; lay the sheet on something flat, press the gel out",
                        name, edge.offset_mm));
    if (std::abs(edge.turn_deg) > most_bend_deg && std::abs(edge.turn_deg) > sure * edge.turn_error_deg)
        throw InputError(fmt::format(
            "{}: the edge under the slab is turned by {:.1f} degrees against the board around it; the sheet "
            "is bent, or slab or glass are tilted; lay the sheet on something flat, press the gel out",
            name, edge.turn_deg));
}

void check_scratches(const EdgeStrip& strip, const std::string& name, std::vector<std::string>& warnings) {
    if (strip.left_out_share > most_left_out || strip.left_out_most > most_of_column)
        throw InputError(
            fmt::format("{}: {:.0f} % of the region differ from what lies above and below (up to {:.0f} % of one place "
                        "across the edge): scratches, bubbles or dust; polish or clean the slab, press the gel out",
                        name, 100 * strip.left_out_share, 100 * strip.left_out_most));
    const double brightest = side_mean(strip, strip.x_mm.back() / 2, strip.x_mm.back()).maxCoeff();
    if (strip.roughness > std::max(most_roughness * brightest, dark_roughness))
        throw InputError(
            fmt::format("{}: neighbouring parts of the region differ by {:.4f} (a perfect diffuser is 1) along the "
                        "edge, more than noise explains: "
                        "scratched all over, or full of bubbles; polish the slab, press the gel out",
                        name, strip.roughness));
    if (strip.left_out_share > said_left_out)
        warnings.push_back(named_warning(
            "slab-photo", fmt::format("{}: {:.1f} % of the region were left out as scratches, bubbles or dust.", name,
                                      100 * strip.left_out_share)));
}

}  // namespace

SlabView read_slab(const io::Photograph& photo, const BenchReference& reference, std::vector<std::string>& warnings) {
    SlabView view;
    view.board = find_board(photo, reference.square_mm);
    const double moved = (view.board.place.to_px(Vector2d::Zero()) - reference.edge_px).norm() / view.board.px_per_mm;
    if (moved > far_edge_mm)
        throw InputError(
            fmt::format("{}: its edge lies {:.1f} mm from where the bare sheet's was, out of the region whose light is "
                        "known; put sheet and camera back, and photograph all again",
                        photo.name, moved));
    view.strip = cut_strip(photo, view.board, reference.light->scale(photo),
                           {Vector2d::Zero(), reference.width_mm, reference.length_mm});
    check_slab_is_there(view.strip, reference, photo.name);
    check_scratches(view.strip, photo.name, warnings);
    view.edge = seen_edge(view.strip);
    check_edge(view.edge, photo.name);
    view.blur_mm = blur_beside(photo, view.board, reference);
    const double sheet_blur = reference.sheet->edge.blur_mm, pitch = 1 / view.board.px_per_mm;
    if (view.blur_mm > softer_by * sheet_blur + softer_px * pitch)
        throw InputError(
            fmt::format("{}: the photograph is blurred: bare edges beside the slab spread over {:.3f} mm, that of the "
                        "bare sheet over {:.3f} mm; focus on the sheet, not on the slab, and do not touch the camera",
                        photo.name, view.blur_mm, sheet_blur));
    if (view.blur_mm == 0)
        warnings.push_back(named_warning(
            "slab-photo",
            fmt::format("{}: no bare edge is seen beside the slab, so that its focus is not known.", photo.name)));
    return view;
}

EdgeProfile join_views(const std::vector<SlabView>& views, const std::string& resin, double thickness_mm,
                       std::vector<std::string>& warnings) {
    const EdgeStrip& first = views.front().strip;
    EdgeProfile profile{resin, thickness_mm, first.x_mm, {}, {}};
    const auto samples = first.x_mm.size();
    const double count = double(views.size());
    std::vector<Vector3d> mean(samples, Vector3d::Zero()), inner(samples, Vector3d::Zero()), outer = inner;
    // Scales differ by some parts of a thousand: values at the first one's places.
    const auto at = [&](const EdgeStrip& strip, const std::vector<Vector3d>& values, double x) -> Vector3d {
        const double pitch = strip.x_mm[1] - strip.x_mm[0];
        const double t = std::clamp((x - strip.x_mm[0]) / pitch, 0.0, double(values.size()) - 1.000001);
        const auto k = std::size_t(t);
        return values[k] + (t - double(k)) * (values[k + 1] - values[k]);
    };
    for (const SlabView& view : views) {
        if (std::abs(view.board.px_per_mm / views.front().board.px_per_mm - 1) > same_scale)
            throw InputError(fmt::format(
                "{} of {} mm: its photographs have {:.2f} and {:.2f} pixels per mm; the camera was moved between them",
                resin, thickness_mm, views.front().board.px_per_mm, view.board.px_per_mm));
        for (std::size_t k = 0; k < samples; ++k) {
            mean[k] += at(view.strip, view.strip.mean, first.x_mm[k]) / count;
            inner[k] += at(view.strip, view.strip.error, first.x_mm[k]).cwiseAbs2() / (count * count);
        }
    }
    double most = 0;
    if (views.size() > 1) {
        std::vector<Vector3d> spread(samples, Vector3d::Zero());
        for (const SlabView& view : views)
            for (std::size_t k = 0; k < samples; ++k)
                spread[k] +=
                    (at(view.strip, view.strip.mean, first.x_mm[k]) - mean[k]).cwiseAbs2() / (count * (count - 1));
        constexpr std::size_t reach = 4;
        for (std::size_t k = 0; k < samples; ++k) {
            const std::size_t from = k < reach ? 0 : k - reach, to = std::min(samples, k + reach + 1);
            for (std::size_t i = from; i < to; ++i) outer[k] += spread[i] / double(to - from);
            most = std::max(most, outer[k].cwiseSqrt().maxCoeff());
        }
    } else {
        warnings.push_back(
            named_warning("slab-photo", fmt::format("{} of {} mm: one photograph; take a second one with slab and "
                                                    "glass shifted, so that what lies on the slab "
                                                    "can be told from what lies on the sheet.",
                                                    resin, thickness_mm)));
    }
    if (most > shots_differ)
        warnings.push_back(named_warning(
            "slab-photo",
            fmt::format("{} of {} mm: its photographs differ by {:.3f}; scratches along the edge, bubbles, or another "
                        "light. Its errors are as large.",
                        resin, thickness_mm, 2 * most)));
    for (int c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < samples; ++k) {
            profile.value[std::size_t(c)].push_back(mean[k][c]);
            profile.error[std::size_t(c)].push_back(std::sqrt(std::max(inner[k][c], outer[k][c])));
        }
    return profile;
}

}  // namespace voxtone::calibration
