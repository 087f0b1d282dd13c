// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/body_print.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/half_space_reflectance.h"
#include "slicer/look/prediction_files.h"

namespace voxtone::slicer {

/// What a photograph is exposed for: thick white resin in even light; of a picture that is lit from behind, and of sets
/// without white, the lightest hundredth of it.
Eigen::Vector3f photographed_white(const PredictedStack& predicted, const PredictFigures& figures) {
    const optics::ResinSet& set = predicted.stack.resins;
    if (predicted.stack.white >= 0 && !figures.from_behind) {
        const optics::HalfSpaceReflectance reflectance(set.g, set.eta, optics::MeasuringGeometry::diffuse_8);
        const optics::Resin& white = set.resins[std::size_t(predicted.stack.white)];
        std::vector<double> value;
        for (std::size_t c = 0; c < set.channels.size(); ++c) value.push_back(reflectance(white.medium(c)));
        return optics::ObservedColour<double>(set.channels).absolute(value.data()).cast<float>();
    }
    std::vector<float> levels;
    for (const Eigen::Vector3f& rgb : predicted.prediction.rgb) levels.push_back(rgb.maxCoeff());
    const auto lightest = levels.begin() + std::ptrdiff_t(levels.size() * 99 / 100);
    std::nth_element(levels.begin(), lightest, levels.end());
    return Eigen::Vector3f::Constant(std::max(*lightest, 1e-6f));
}

BodyPrint body_print(PredictedStack predicted, const PredictFigures& figures) {
    BodyPrint print;
    const StackVolume& stack = predicted.stack;
    print.mesh = body_mesh(stack.volume, stack.corner_mm, predicted.prediction);
    if (print.mesh.triangles.empty())
        throw InputError(
            "the stack's body is not larger than a cell of the prediction: there is no surface to look at");
    const Eigen::Vector3f white = photographed_white(predicted, figures);
    for (Eigen::Vector3f& rgb : print.mesh.rgb) rgb = rgb.cwiseQuotient(white);
    std::vector<double> areas;
    for (const optics::SurfaceCell& cell : predicted.prediction.surface.cells) {
        print.normals.emplace_back(cell.normal[0], cell.normal[1], cell.normal[2]);
        areas.push_back(double(cell.area_mm2));
    }
    const auto middle = areas.begin() + std::ptrdiff_t(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    print.cell_mm = std::sqrt(*middle);
    for (std::size_t a = 0; a < 3; ++a) {
        print.low_mm[a] = stack.corner_mm[a];
        print.high_mm[a] = stack.corner_mm[a] + stack.volume.size()[a] * stack.volume.pitch_mm()[a];
    }
    std::vector<Eigen::Vector3d> positions;
    for (const Eigen::Vector3f& p : print.mesh.positions_mm) positions.push_back(p.cast<double>());
    print.surface = std::make_shared<const MeshBoundary>(positions, print.mesh.triangles, Eigen::Vector3d::Zero());
    print.set = std::move(predicted.stack.resins);
    print.illuminant = predicted.stack.illuminant;
    return print;
}

std::vector<std::uint8_t> BodyPrint::sees_sky(std::span<const std::uint32_t> vertices,
                                              std::span<const Eigen::Vector3d> directions) const {
    std::vector<std::uint8_t> sees(vertices.size() * directions.size());
    parallel_for(0, vertices.size(), 64, [&](std::size_t v) {
        const Eigen::Vector3d normal = normals[vertices[v]].cast<double>();
        // Half a cell outside of the facets, which cut off what bulges between their corners.
        const Eigen::Vector3d from = mesh.positions_mm[vertices[v]].cast<double>() + 0.5 * cell_mm * normal;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const Eigen::Vector3d& way = directions[d];
            double distance = 0;
            optics::BoundaryNormals met;
            sees[v * directions.size() + d] =
                normal.dot(way) > 0 &&
                !surface->meets({from.x(), from.y(), from.z()}, {way.x(), way.y(), way.z()}, distance, met);
        }
    });
    return sees;
}

}  // namespace voxtone::slicer
