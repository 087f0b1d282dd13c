// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes before a camera: the room that prints stand in, and from where they are seen.
#pragma once

#include <array>

#include <Eigen/Core>

#include "optics/camera/camera.h"
#include "slicer/proof/proof_options.h"

namespace voxtone::slicer {

struct Box {
    Eigen::Vector3d low, high;
};

/// The corners, by three bits.
[[nodiscard]] Eigen::Vector3d corner_of(const Box& box, int corner);
/// What holds a turned box.
[[nodiscard]] Box turned(const Eigen::Matrix3d& turn, const Box& box);
/// The room by its axes in the model's frame: rows are its x, to the right before the front view, its y, away, and its
/// z, up.
[[nodiscard]] Eigen::Matrix3d room_axes(ProofUp up, double turn_deg);

/// The axis of the room, one way or the other, that runs nearest to the right before the camera: what stands side by
/// side stands along it. `first`: the box of what stands there first, in the model's frame.
[[nodiscard]] Eigen::Vector3d rightward(const ResolvedProof& job, const Box& first, const Eigen::Matrix3d& axes,
                                        bool flat);

/// `room`: what is to be seen, in the room's frame; `flat`: a picture's slab.
[[nodiscard]] optics::CameraView place_camera(const ResolvedProof& job, const Box& room, const Eigen::Matrix3d& axes,
                                              bool flat);

/// As `proof` places it before one body with these options; their stacks, files and size do not count. Throws
/// UsageError.
[[nodiscard]] optics::CameraView camera_before(ProofOptions options, const Box& body, int width_px, int height_px);

[[nodiscard]] inline Eigen::Vector3d vector_of(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }
[[nodiscard]] inline optics::Point point_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace voxtone::slicer
