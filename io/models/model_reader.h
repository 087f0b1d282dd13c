// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models from files: OBJ + MTL, PLY, STL, glTF 2.0 / GLB, 3MF, FBX and VRML 2.
//
// Colour, as io/models/mesh.h combines it (linear sRGB):
// - OBJ: texture over vertex colours over Kd (io/codecs/parse_obj.h): Kd does NOT multiply the map, as the MTL note
//   would have it: exporters leave grey defaults there (0.64, 0.8) beside finished photographs, and people expect the
//   colours of the picture. A Kd that is no grey and was not applied is reported. Vertex colours are sRGB, as Kd is.
//   Textures may be cut into tiles (io/models/udim.h).
// - PLY: colours of vertices, or of faces where those of vertices are all alike, are sRGB codes; textures
//   by `comment TextureFile` and `texnumber`, with coordinates of vertices or of each face's corners.
// - OBJ, MTL, PLY: the range of colours goes by type and by what occurs (io/models/colour_range.h).
// - STL: none. Attribute words that look like the colours of VisCAM or Magics are lost, which is said.
// - glTF: baseColorFactor (linear) * COLOR_0 (linear) * baseColorTexture (sRGB) with KHR_texture_transform; the older
//   specular-glossiness where it is the material, emission where there is no base or a black one. Alpha counts where
//   alphaMode is BLEND; MASK is opaque from its cutoff on. Node transforms, skins and morph weights in the pose of the
//   file and copies of EXT_mesh_gpu_instancing are applied, hidden nodes and animations left aside. COLOR_1 and
//   attributes of other names are no colours by the standard: lost where there is no COLOR_0. The axes are turned from
//   y up to z up: (x, y, z) -> (x, -z, y).
// - 3MF: the core specification with materials and properties (io/codecs/threemf_part.h), and what slicers write beside
//   it (io/models/slicer_roles.h): items that are off, modifiers and blockers are left aside, negative volumes are cut
//   out (io/codecs/cut_volumes.h), parts of several extruders, and triangles that are painted as a whole, get the
//   colours of their filaments. Packages are read however they were packed (io/models/threemf_package.h). A required
//   extension that is not known refuses the file. Layers of textures and colours over each other (multiproperties) are
//   made into one picture, triangle by triangle.
// - FBX: io/codecs/parse_fbx.h. VRML: io/codecs/parse_vrml.h.
// In all but glTF, FBX and VRML the axes stay as they are. Where no triangle of the model uses a texture's texel, the
// nearest used one is put (io/models/texel_coverage.h).
//
// Alpha is composed over white, with a warning where it is used. What is transparent as a whole is not: a material, a
// texture or corners of alpha 0 (Tr 1 in a library of MeshLab means opaque) would vanish, so they are taken to be
// opaque, with a warning. Corners of transparent black beside others that are seen have no colour: white.
//
// A picture may be given (ReadOptions::texture) to a mesh that has texture coordinates; it is laid, as it is, on what
// has no picture of its own or one that is missing. Colours that are in the file and will not be seen on the print are
// ModelFile::lost_colour, one warning.
//
// Of a ZIP archive the one model that it holds is read, or the one that a path names behind it ("a.zip/b/c.obj"), with
// the files in the archive (io/codecs/model_archive.h).
//
// Points and lines are left aside with a warning; polygons are triangulated; degenerate faces are kept. Equal positions
// are one vertex.
//
// A file is taken for hostile: it is parsed, and its pictures decoded, in a child process with a budget of memory and
// time (io/files/isolate.h); names in it are followed only inside its folder (io/codecs/side_files.h); declared sizes
// are checked first. Errors: FileError (cannot be read), InputError (what is wrong with it, and what to try).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/files/read_options.h"
#include "io/models/mesh.h"
#include "io/models/side_file.h"

namespace voxtone::io {

[[nodiscard]] ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options = {});
/// What was read besides, and what is to be known of it.
struct ModelSources {
    std::vector<SideFile> side_files;  ///< that were looked for beside it, with what was read of them
    std::vector<std::string> notes;    ///< which model of an archive was taken, in whole sentences
};
/// Adds to `sources`.
[[nodiscard]] ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options,
                                   ModelSources& sources);

/// The files beside it that the model names, found or not, whatever else is wrong with it. Throws as `read_model`.
[[nodiscard]] std::vector<SideFile> side_files_of(const std::filesystem::path& path, const ReadOptions& options = {});

/// "obj" of "A.OBJ"; empty where there is none.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);
/// Whether the name ends as that of a model, or of an archive of one (model_name_endings, .vrml, .wrz, any case).
[[nodiscard]] bool is_model_name(const std::filesystem::path& path);
[[nodiscard]] bool is_vrml_name(const std::filesystem::path& path);
/// As such names end, for messages.
inline constexpr std::string_view model_name_endings = ".obj, .ply, .stl, .gltf, .glb, .3mf, .fbx, .wrl, .zip";
/// By its extension; files without it may hold a picture all the same.
[[nodiscard]] bool is_picture_name(const std::filesystem::path& path);

}  // namespace voxtone::io
