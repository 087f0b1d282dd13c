// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/orientations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/look/air_under.h"
#include "slicer/printer/placement.h"
#include "slicer/printer/tray_room.h"
#include "slicer/surface/area_points.h"

namespace voxtone::slicer {

namespace {

constexpr std::array up_turns{"", "x90", "x180", "x-90", "y90", "y-90"};
constexpr int silhouette_lines = 6;
constexpr std::array turns_about_z{"", "z90"};  // half a turn more is the same print, turned on the tray

std::string joined(const std::string& first, const std::string& second) {
    return first.empty() || second.empty() ? first + second : first + "," + second;
}

/// What is the same however the body is turned about the upright.
void look_from_below(const std::vector<AreaPoint>& pieces, double area_mm2, const Eigen::Matrix3d& turn,
                     Orientation& orientation) {
    std::size_t down = 0, coloured = 0;
    for (const AreaPoint& piece : pieces) {
        if (turn.row(2).dot(piece.normal) > -std::numbers::sqrt2 / 2) continue;
        ++down;
        coloured += piece.white ? 0 : 1;
    }
    const double piece_mm2 = pieces.empty() ? 0 : area_mm2 / double(pieces.size());
    orientation.downward_mm2 = double(down) * piece_mm2;
    orientation.coloured_down_mm2 = double(coloured) * piece_mm2;
}

SolidMesh turned_mesh(const SolidMesh& mesh, const Eigen::Matrix3d& turn) {
    SolidMesh turned = mesh;
    for (Eigen::Vector3d& position : turned.positions_mm) position = turn * position;
    return turned;
}

void measure(const OpenedJob& job, const Eigen::Vector3d& extent_mm, Orientation& orientation) {
    const Eigen::Vector3d tray_mm = job.printer.sliced_tray_mm();
    const VoxelGrid grid = grid_around(Eigen::Vector3d::Zero(), extent_mm, job.printer.sliced_pitch_mm());
    orientation.size_mm = {extent_mm.x(), extent_mm.y(), extent_mm.z()};
    orientation.layers = grid.size[2];
    orientation.passes = std::uint64_t(grid.size[2]) * std::uint64_t(job.printer.sliced_passes().of_layer(extent_mm));
    orientation.fits = grid.size[2] >= job.printer.min_layers;
    for (int axis = 0; axis < 3; ++axis) orientation.fits = orientation.fits && fits_in(extent_mm[axis], tray_mm[axis]);
}

// Right angles are exact but for the last digits of a turn.
bool same_size(const Orientation& a, const Orientation& b) {
    constexpr double mm = 1e-6;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (std::abs(a.size_mm[axis] - b.size_mm[axis]) > mm) return false;
    return true;
}

/// The coloured surface that lies down, in whole percents of the surface: below is the noise of its samples.
long coloured_share(const Orientation& o, double surface_mm2) {
    return surface_mm2 > 0 ? std::lround(100 * o.coloured_down_mm2 / surface_mm2) : 0;
}

/// Of one way's printing time, of that of another.
double share_of_time(const Orientation& one, const Orientation& of) {
    if (one.passes > 0 && of.passes > 0) return double(one.passes) / double(of.passes);
    return double(one.layers) / double(of.layers);
}

std::string name_of_turn(const Orientation& o) { return o.rotate.empty() ? "as it is" : "--rotate " + o.rotate; }

/// What the best costs in time: against the job's own, and against the fastest, where that is worth a word.
std::string time_text(const Orientation& best, const Orientation& own, std::span<const Orientation> all) {
    constexpr double worth_a_word = 0.1;
    std::string text;
    if (!best.as_it_is && best.layers != own.layers)
        text += fmt::format("; {} layers instead of {}", best.layers, own.layers);
    if (const double share = share_of_time(best, own); !best.as_it_is && std::abs(share - 1) > worth_a_word)
        text += fmt::format(", some {:.2g} times its printing time", share);
    const auto shorter = [&](const Orientation& a, const Orientation& b) {
        if (a.fits != b.fits) return a.fits;
        return share_of_time(a, best) < share_of_time(b, best);
    };
    const Orientation& fastest = *std::ranges::min_element(all, shorter);
    if (const double share = share_of_time(fastest, best); fastest.fits && share < 1 - worth_a_word)
        text += fmt::format(
            "; {} prints in some {:.0f} % of that time ({} layers), with {:.2f} cm2 of coloured surface on support",
            name_of_turn(fastest), 100 * share, fastest.layers, fastest.coloured_down_mm2 / 100);
    return text;
}

std::tuple<bool, long, int, double> rank(const Orientation& o, double surface_mm2) {
    return {!o.fits, coloured_share(o, surface_mm2), o.layers, o.under_ml};
}

}  // namespace

std::vector<Orientation> orientations(const OpenedJob& job, const JobBody& body, const Progress& progress) {
    // What --rotate does comes before the mirrors, and the body is behind both.
    Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
    const PlacementOptions& placed = job.options.placement;
    if (placed.swap_xy) mirror.row(0).swap(mirror.row(1));
    if (placed.flip_x) mirror.row(0) *= -1;
    if (placed.flip_y) mirror.row(1) *= -1;
    const auto turn_of = [&](const std::string& text) -> Eigen::Matrix3d {
        return mirror * (text.empty() ? Eigen::Matrix3d::Identity() : parse_rotation(text)) * mirror.transpose();
    };
    const std::vector<AreaPoint> pieces = area_points(*body.surface, body.model.mesh);
    const double area_mm2 = coloured_area_mm2(*body.surface);
    std::vector<Orientation> found(up_turns.size() * turns_about_z.size());
    std::vector<char> repeats(found.size(), 0);
    parallel_for(
        0, up_turns.size(), 1,
        [&](std::size_t up) {
            const SolidMesh turned = turned_mesh(*body.solid, turn_of(up_turns[up]));
            Orientation seen;
            const AirUnder under = look_under(turned);
            look_from_below(pieces, area_mm2, turn_of(up_turns[up]), seen);
            seen.under_ml = under.ml;
            for (std::size_t about = 0; about < turns_about_z.size(); ++about) {
                const std::string turn = joined(up_turns[up], turns_about_z[about]);
                Orientation& orientation = found[up * turns_about_z.size() + about];
                orientation = seen;
                orientation.rotate = joined(placed.rotation_text, turn);
                orientation.as_it_is = turn.empty();
                orientation.front = (about == 0 ? under.front : under.turned).lines(silhouette_lines);
                measure(job, (turn_of(turn) * body.placement.extent_mm).cwiseAbs(), orientation);
                const Orientation& first = found[up * turns_about_z.size()];
                repeats[up * turns_about_z.size() + about] = about > 0 && same_size(first, orientation);
            }
        },
        &progress);
    std::vector<Orientation> different;
    for (std::size_t n = 0; n < found.size(); ++n)
        if (!repeats[n]) different.push_back(std::move(found[n]));
    std::ranges::stable_sort(different, {}, [&](const Orientation& o) { return rank(o, area_mm2); });
    return different;
}

std::optional<OrientationAdvice> advised_orientation(std::span<const Orientation> best_first, double surface_mm2) {
    if (best_first.empty() || !best_first.front().fits) return std::nullopt;
    const Orientation& best = best_first.front();
    const auto own = std::ranges::find_if(best_first, &Orientation::as_it_is);
    if (own == best_first.end() || best.as_it_is)
        return OrientationAdvice{best.rotate,
                                 fmt::format("no other way lays less coloured surface on support ({:.2f} "
                                             "cm2, which comes out matt), or is lower with as little{}",
                                             best.coloured_down_mm2 / 100, time_text(best, best, best_first))};
    std::string why;
    if (!own->fits)
        why = "it does not fit as it is";
    else if (coloured_share(best, surface_mm2) < coloured_share(*own, surface_mm2))
        why = fmt::format(
            "it lays {:.2f} cm2 of coloured surface on support, where it comes out matt, instead of "
            "{:.2f} cm2",
            best.coloured_down_mm2 / 100, own->coloured_down_mm2 / 100);
    else if (best.layers < own->layers)
        why = fmt::format("it lays as little coloured surface on support ({:.2f} cm2), and is lower",
                          best.coloured_down_mm2 / 100);
    else
        why = fmt::format(
            "it is as good in all else, and has less air below to fill with support ({:.2f} ml instead "
            "of {:.2f})",
            best.under_ml, own->under_ml);
    return OrientationAdvice{best.rotate, why + time_text(best, *own, best_first)};
}

}  // namespace voxtone::slicer
