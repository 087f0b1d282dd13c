// SPDX-License-Identifier: GPL-3.0-or-later
//
// What tests of the readers ask of a model. They read in this process: what is tested is the reading, not the wall
// around it.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "base/error.h"
#include "io/codecs/read_here.h"
#include "io/models/model_reader.h"
#include "io/pictures/texture.h"
#include "model_samples.h"
#include "optics/colour/colour.h"

namespace voxtone::test {

inline float linear(double code) { return static_cast<float>(optics::srgb_decode(code)); }

/// Colour of a triangle's corner as io/models/mesh.h defines it.
inline Eigen::Vector3f corner_colour(const io::TexturedMesh& mesh, std::size_t t, std::size_t c) {
    const io::SurfaceMaterial& material = mesh.materials[mesh.material_of_triangle[t]];
    Eigen::Vector3f rgb = material.rgb;
    if (!mesh.corner_rgb.empty()) rgb = rgb.cwiseProduct(mesh.corner_rgb[t][c]);
    if (material.texture)
        rgb = rgb.cwiseProduct(material.texture->sample(mesh.corner_uv[t][c].x(), mesh.corner_uv[t][c].y()));
    return rgb;
}

inline bool near(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin = 2e-3f) {
    return (a - b).cwiseAbs().maxCoeff() < margin;
}

/// The first of the files, written into `folder`.
inline io::ModelFile read(const Folder& folder, const Files& files, const io::ReadOptions& options = {}) {
    return io::read_model_here(folder.write(files), options);
}
/// The same in a folder of its own, `others` beside it.
inline io::ModelFile read_alone(Files files, const Files& others = {}, const io::ReadOptions& options = {}) {
    files.insert(files.end(), others.begin(), others.end());
    return read(Folder(), files, options);
}

/// What refuses the reading of a file, in one sentence.
template <class Read>
[[nodiscard]] std::string refusal_by(Read&& reading) {
    try {
        (void)reading();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

inline Eigen::Vector3d corner_place(const io::ModelFile& file, std::size_t t, std::size_t c) {
    return file.mesh.positions[file.mesh.triangles[t][c]];
}
inline double volume_of(const io::TexturedMesh& mesh) {
    double six = 0;
    for (const auto& t : mesh.triangles)
        six += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]]));
    return six / 6;
}

inline std::string warnings(const io::ModelFile& file) {
    std::string all;
    for (const std::string& warning : file.warnings) all += warning + "\n";
    return all;
}

}  // namespace voxtone::test
