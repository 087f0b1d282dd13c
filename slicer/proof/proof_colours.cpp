// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_colours.h"

#include <limits>

#include "base/parallel.h"
#include "optics/colour/channels.h"
#include "optics/layered/mixture_correction.h"

namespace voxtone::slicer {

namespace {

constexpr std::uint8_t sees_print = 2;  // optics::CameraPicture::sees

}  // namespace

std::optional<SeenPoint> seen_print(const ProofScene& scene, const optics::Camera& camera, std::size_t pixel) {
    const auto width = static_cast<std::size_t>(camera.width_px());
    return seen_along(scene, camera, camera.direction(double(pixel % width) + 0.5, double(pixel / width) + 0.5));
}

std::optional<SeenPoint> seen_along(const ProofScene& scene, const optics::Camera& camera, const optics::Point& way) {
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<SeenPoint> seen;
    for (std::size_t k = 0; k < scene.camera.prints.size(); ++k) {
        const optics::ResinBody& print = scene.camera.prints[k];
        const optics::Point from = optics::along(camera.position(), print.corner_mm, -1);
        double distance = 0;
        optics::BoundaryNormals normals;
        if (!print.boundary->meets(from, way, distance, normals) || distance >= nearest) continue;
        nearest = distance;
        seen = {k, optics::along(from, way, distance), normals};
    }
    return seen;
}

std::vector<Eigen::Vector3f> proof_colours(const optics::CameraPicture& picture, const ProofScene& scene) {
    const Eigen::Matrix3Xf weights = optics::linear_srgb_weights(scene.channels()).cast<float>();
    std::vector<Eigen::Vector3f> rgb;
    for (std::size_t p = 0; p < picture.samples.size(); ++p)
        rgb.push_back(weights * Eigen::Map<const Eigen::VectorXf>(picture.value.data() + p * picture.channels,
                                                                  static_cast<Eigen::Index>(picture.channels)));
    std::vector<optics::MixtureCorrection> corrections;
    bool any = false;
    for (const auto& print : scene.prints) {
        corrections.emplace_back(print->stack.resins, -1, print->scene.volume->pitch_mm());
        any = any || corrections.back().any();
    }
    if (!any) return rgb;
    const optics::Camera camera(scene.camera.view);
    parallel_for(0, rgb.size(), 256, [&](std::size_t p) {
        if (picture.sees[p] != sees_print) return;
        const std::optional<SeenPoint> seen = seen_print(scene, camera, p);
        if (!seen || !corrections[seen->print].any()) return;
        const std::array<float, 3> place{float(seen->place_mm[0]), float(seen->place_mm[1]), float(seen->place_mm[2])};
        rgb[p] = corrections[seen->print].at(*scene.prints[seen->print]->scene.volume, place) * rgb[p].eval();
    });
    return rgb;
}

}  // namespace voxtone::slicer
