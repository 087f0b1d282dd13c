// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies and jobs for tests of estimates, without a file of a model.
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "slicer/part/opened_job.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/slicer/mesh/shapes.h"

namespace voxtone::test {

/// As `prepare_body` leaves it, every triangle visible. `rgb`: one for each triangle; empty: white.
inline slicer::JobBody body_of(const slicer::SolidMesh& mesh, const Eigen::Vector3d& pitch_mm,
                               const std::vector<Eigen::Vector3f>& rgb = {}) {
    slicer::JobBody body;
    slicer::VisibleSurface surface;
    io::TexturedMesh& textured = body.model.mesh;
    surface.positions_mm = textured.positions = mesh.positions_mm;
    surface.triangles = textured.triangles = mesh.triangles;
    textured.materials.emplace_back();
    textured.material_of_triangle.assign(mesh.triangles.size(), 0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
        if (!rgb.empty()) textured.corner_rgb.push_back({rgb[t], rgb[t], rgb[t]});
    }
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh.positions_mm) box.extend(p);
    body.placement.extent_mm = box.sizes();
    body.grid = slicer::grid_around(box.min(), box.max(), pitch_mm);
    body.solid = slicer::SolidIndex(mesh);
    body.surface = slicer::SurfaceIndex(std::move(surface));
    return body;
}

/// A job about a model that is not looked at.
class SampleJob {
public:
    explicit SampleJob(const std::string& iterations = "auto", const std::string& predict = "auto") {
        options.iterations = iterations;
        options.predict = predict;
        options.model = (folder_.path() / "model.obj").string();
        options.out = (folder_.path() / "out").string();
        std::ofstream(options.model) << "v 0 0 0\n";
    }
    [[nodiscard]] slicer::OpenedJob opened() const { return slicer::open_job(options); }

    slicer::SliceOptions options;

private:
    io::TemporaryFolder folder_;
};

}  // namespace voxtone::test
