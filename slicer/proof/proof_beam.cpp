// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_beam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/parallel.h"
#include "slicer/proof/proof_colours.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;

constexpr double usual_thin_mm = 1, usual_spot_mm = 2;  // a slit, a pointer's laser; a spot

int slab_of(const ProofPrint& print, const optics::Point& place) {
    constexpr double rounding_mm = 0.01;
    const Vector3d p = vector_of(place), slack = Vector3d::Constant(rounding_mm);
    for (std::size_t k = 0; k < print.boxes.size(); ++k)
        if (((p + slack).array() >= print.boxes[k].low.array()).all() &&
            ((p - slack).array() <= print.boxes[k].high.array()).all())
            return static_cast<int>(k);
    return -1;
}

struct InPicture {
    double x = 0, y = 0;
};

InPicture middle_of(std::size_t pixel, std::size_t width) {
    return {double(pixel % width) + 0.5, double(pixel / width) + 0.5};
}

InPicture centre_of(const std::vector<SeenPiece>& pieces, std::size_t width) {
    InPicture sum;
    double count = 0;
    for (const SeenPiece& piece : pieces)
        for (const std::size_t pixel : piece.pixels) {
            const auto [x, y] = middle_of(pixel, width);
            sum.x += x, sum.y += y, ++count;
        }
    return {sum.x / count, sum.y / count};
}

struct Nearest {
    std::size_t pixel = 0;
    double distance = std::numeric_limits<double>::infinity();
};
Nearest nearest_pixel(const SeenPiece& piece, const InPicture& to, std::size_t width) {
    Nearest nearest;
    for (const std::size_t pixel : piece.pixels) {
        const auto [x, y] = middle_of(pixel, width);
        const double distance = std::hypot(x - to.x, y - to.y);
        if (distance < nearest.distance) nearest = {pixel, distance};
    }
    return nearest;
}

/// The plane that touches the surface there. Slabs stand in rows: `along` goes to the right in the picture, across all
/// of them. It goes up on bodies, so that the lamp stands above: the ground would hide one that stands below.
optics::BeamPlane plane_at(const ProofScene& scene, const SeenPoint& seen, double turn_deg) {
    const optics::CameraView& view = scene.camera.view;
    const Vector3d normal = vector_of(seen.normals.shading).normalized(), up = vector_of(view.up),
                   ahead = vector_of(view.target) - vector_of(view.position), right = ahead.cross(up).normalized();
    const bool slab = !scene.prints[seen.print]->boxes.empty();
    const auto within = [&](const Vector3d& way) -> Vector3d { return way - way.dot(normal) * normal; };
    Vector3d along = within(slab ? right : up);
    constexpr double square_on = 0.1;
    if (along.norm() < square_on) along = within(slab ? up : right);
    along = Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180, normal) * along.normalized();
    return {optics::along(seen.place_mm, scene.camera.prints[seen.print].corner_mm, 1), point_of(normal),
            point_of(along)};
}

SeenPoint seen_at(const ProofScene& scene, const optics::Camera& camera, const optics::Point& place,
                  const std::string& words) {
    const Vector3d way = vector_of(place) - vector_of(camera.position());
    std::optional<SeenPoint> seen;
    if (way.norm() > 0) seen = seen_along(scene, camera, point_of(way.normalized()));
    if (!seen)
        throw InputError(
            fmt::format("--light-at {}: the camera sees no print there, so the picture would be dark; name a place of "
                        "the surface that it sees, mm in the model's frame as printed, or middle",
                        words));
    return *seen;
}

std::vector<optics::BeamPlane> middle_planes(const ResolvedProof& job, bool each, const ProofScene& scene,
                                             const optics::Camera& camera, const std::vector<SeenPiece>& pieces) {
    if (pieces.empty())
        throw InputError(
            "--light-at middle: the camera sees no print, so the beam would light nothing; turn it (--view, "
            "--look-at)");
    const auto width = static_cast<std::size_t>(camera.width_px());
    const InPicture centre = centre_of(pieces, width);
    const SeenPiece& central = *std::min_element(pieces.begin(), pieces.end(), [&](const auto& a, const auto& b) {
        return nearest_pixel(a, centre, width).distance < nearest_pixel(b, centre, width).distance;
    });
    std::vector<optics::BeamPlane> planes;
    for (const SeenPiece& piece : pieces) {
        if (!each && &piece != &central) continue;
        const std::size_t pixel = nearest_pixel(piece, centre_of({piece}, width), width).pixel;
        planes.push_back(plane_at(scene, *seen_print(scene, camera, pixel), job.requested.turn_light_deg));
    }
    return planes;
}

}  // namespace

std::vector<SeenPiece> seen_pieces(const ProofScene& scene, const Progress& progress) {
    const optics::Camera camera(scene.camera.view);
    const auto width = static_cast<std::size_t>(camera.width_px());
    std::vector<std::pair<std::size_t, int>> seen_by(width * static_cast<std::size_t>(camera.height_px()), {0, -2});
    parallel_for(
        0, seen_by.size(), 4096,
        [&](std::size_t p) {
            if (const auto seen = seen_print(scene, camera, p))
                seen_by[p] = {seen->print, slab_of(*scene.prints[seen->print], seen->place_mm)};
        },
        &progress);
    std::vector<SeenPiece> pieces;
    for (std::size_t k = 0; k < scene.prints.size(); ++k)
        for (int slab = -1; slab < static_cast<int>(scene.prints[k]->boxes.size()); ++slab) {
            SeenPiece piece{k, slab, {}};
            for (std::size_t p = 0; p < seen_by.size(); ++p)
                if (seen_by[p] == std::pair{k, slab}) piece.pixels.push_back(p);
            if (!piece.pixels.empty()) pieces.push_back(std::move(piece));
        }
    return pieces;
}

optics::Beam make_beam(const ResolvedProof& job, const ProofLamp& lamp, const ProofScene& scene,
                       const std::vector<SeenPiece>& pieces) {
    optics::BeamKind kind;
    const bool laser = lamp.kind == ProofLight::laser, spot = laser || lamp.kind == ProofLight::spot;
    if (lamp.kind != ProofLight::edge) {
        const double usual_mm = lamp.kind == ProofLight::spot ? usual_spot_mm : usual_thin_mm;
        kind.shape = spot ? optics::BeamShape::spot : optics::BeamShape::slit;
        kind.width_mm = job.requested.light_width_mm.value_or(usual_mm);
    }
    // However thin, it sends as much light as the usual spot: what it makes glow is seen.
    if (laser) kind.times = (usual_spot_mm / kind.width_mm) * (usual_spot_mm / kind.width_mm);
    const optics::Camera camera(scene.camera.view);
    if (!job.light_at) return {kind, middle_planes(job, spot, scene, camera, pieces)};
    const SeenPoint seen = seen_at(scene, camera, *job.light_at, job.requested.light_at);
    return {kind, {plane_at(scene, seen, job.requested.turn_light_deg)}};
}

std::string beam_words(const optics::Beam& beam) {
    const auto& [x, y, z] = beam.planes().front().place;
    std::string at = fmt::format("({:.3g}, {:.3g}, {:.3g}) mm", x, y, z);
    const double width = beam.kind().width_mm;
    switch (beam.kind().shape) {
        case optics::BeamShape::edge:
            return fmt::format("the edge of a beam across {}", at);
        case optics::BeamShape::slit:
            return fmt::format("a slit of light, {:g} mm wide, across {}", width, at);
        case optics::BeamShape::spot:
            break;
    }
    if (beam.planes().size() > 1) at += fmt::format(" and {} other places", beam.planes().size() - 1);
    const bool is_unit = beam.kind().times == 1;
    return fmt::format("a {}, {:g} mm wide, at {}", is_unit ? "spot of light" : "laser", width, at);
}

}  // namespace voxtone::slicer
