// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace voxtone::slicer {

using Eigen::Vector3d;

Eigen::Matrix3d room_axes(ProofUp up, double turn_deg) {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // rows: the room's x, y and z
    switch (up) {
        case ProofUp::z:
            break;
        case ProofUp::minus_z:
            axes << 1, 0, 0, 0, -1, 0, 0, 0, -1;
            break;
        case ProofUp::y:
            axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
            break;
        case ProofUp::minus_y:
            axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
            break;
        case ProofUp::x:
            axes << 0, 0, -1, 0, 1, 0, 1, 0, 0;
            break;
        case ProofUp::minus_x:
            axes << 0, 0, 1, 0, 1, 0, -1, 0, 0;
            break;
    }
    return Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180, Vector3d::UnitZ()) * axes;
}

Vector3d corner_of(const Box& box, int corner) {
    return {corner & 1 ? box.high.x() : box.low.x(), corner & 2 ? box.high.y() : box.low.y(),
            corner & 4 ? box.high.z() : box.low.z()};
}

Box turned(const Eigen::Matrix3d& turn, const Box& box) {
    Box held{turn * box.low, turn * box.low};
    for (int corner = 1; corner < 8; ++corner) {
        const Vector3d p = turn * corner_of(box, corner);
        held = {held.low.cwiseMin(p), held.high.cwiseMax(p)};
    }
    return held;
}
namespace {

struct Direction {
    double azimuth_deg, height_deg;
};
/// Where the camera stands, seen from the body.
Direction stand_of(ProofView view) {
    switch (view) {
        case ProofView::three_quarter:
            return {-62, 24};
        case ProofView::front:
            return {-90, 9};
        case ProofView::right:
            return {0, 9};
        case ProofView::back:
            return {90, 9};
        case ProofView::left:
            return {180, 9};
        case ProofView::top:
            return {-90, 90};
        case ProofView::bottom:
            return {-90, -90};
    }
    return {};
}

/// From the body to the camera, in the room.
Vector3d stand_direction(const ResolvedProof& job, bool flat) {
    const Direction stand = stand_of(job.view.value_or(flat ? ProofView::top : ProofView::three_quarter));
    const double a = stand.azimuth_deg * std::numbers::pi / 180, h = stand.height_deg * std::numbers::pi / 180;
    return {std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)};
}

/// Whether a camera that looks along it has no horizon.
bool is_upright(const Vector3d& direction) {
    return direction.cross(Vector3d::UnitZ()).norm() < 1e-6 * direction.norm();
}

/// So far off that the box just fits the picture.
double fitting_distance(const ResolvedProof& job, const Box& box, const Vector3d& from) {
    const Vector3d middle = 0.5 * (box.low + box.high), back = from.normalized();
    Vector3d right = Vector3d::UnitZ().cross(back);
    if (right.norm() < 1e-6) right = Vector3d::UnitX();
    right.normalize();
    const Vector3d up = back.cross(right);
    constexpr double margin = 1.12;
    const double half_width = 0.5 * optics::film_width_mm / job.requested.focal_mm,
                 half_height = half_width * job.height_px / job.width_px;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p = corner_of(box, corner) - middle;
        const double across = std::max(std::abs(p.dot(right)) / half_width, std::abs(p.dot(up)) / half_height);
        distance = std::max(distance, margin * across + p.dot(back));
    }
    return distance;
}

}  // namespace

Vector3d rightward(const ResolvedProof& job, const Box& first, const Eigen::Matrix3d& axes, bool flat) {
    const Vector3d middle = 0.5 * (first.low + first.high), seen = job.look_at ? vector_of(*job.look_at) : middle,
                   back = job.camera ? Vector3d(axes * (vector_of(*job.camera) - seen)) : stand_direction(job, flat),
                   up = is_upright(back) ? Vector3d::UnitY() : Vector3d::UnitZ(), right = up.cross(back);
    return std::abs(right.x()) >= std::abs(right.y()) ? Vector3d(std::copysign(1, right.x()), 0, 0)
                                                      : Vector3d(0, std::copysign(1, right.y()), 0);
}

optics::CameraView place_camera(const ResolvedProof& job, const Box& room, const Eigen::Matrix3d& axes, bool flat) {
    optics::CameraView view;
    const Eigen::Matrix3d to_model = axes.transpose();
    view.target = job.look_at.value_or(point_of(to_model * (0.5 * (room.low + room.high))));
    view.focal_mm = job.requested.focal_mm;
    view.width_px = job.width_px;
    view.height_px = job.height_px;
    const Vector3d from = stand_direction(job, flat);
    view.position =
        job.camera.value_or(point_of(vector_of(view.target) + fitting_distance(job, room, from) * (to_model * from)));
    const Vector3d ahead = axes * (vector_of(view.target) - vector_of(view.position));
    view.up = point_of(to_model * (is_upright(ahead) ? Vector3d::UnitY() : Vector3d::UnitZ()));
    return view;
}

optics::CameraView camera_before(ProofOptions options, const Box& body, int width_px, int height_px) {
    options.stacks = {"body"};
    options.files = {"picture.png"};
    options.size = ProofOptions{}.size;
    ResolvedProof job = resolve(options);
    job.width_px = width_px, job.height_px = height_px;
    const Eigen::Matrix3d axes = room_axes(job.up, options.turn_deg);
    return place_camera(job, turned(axes, body), axes, false);
}

}  // namespace voxtone::slicer
