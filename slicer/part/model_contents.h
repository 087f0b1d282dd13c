// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is in a file, as a job would take it, in the time of reading it: nothing is repaired, separated or predicted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "io/models/mesh.h"
#include "io/models/side_file.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

struct ContentsMaterial {
    std::string name;
    std::array<double, 3> rgb{};         ///< linear sRGB
    std::optional<std::size_t> texture;  ///< of ModelContents::textures
    std::size_t triangles = 0;
};

struct ModelContents {
    std::string file;
    std::string error;  ///< why it cannot be read; empty: the rest says what is in it
    ExitCode exit_code = ExitCode::done;
    std::string format;   ///< "OBJ", "picture", ...
    std::string unit_is;  ///< "assumed", "asked", "file"; of a picture "width" or empty
    double mm_per_unit = 1;
    std::optional<std::array<double, 3>> size_mm;  ///< nothing: a picture without a width
    std::size_t triangles = 0, vertices = 0;
    std::size_t parts = 0;  ///< pieces that share no corner
    bool vertex_colours = false, material_colours = false;
    std::vector<std::array<std::uint32_t, 2>> textures;  ///< pixels
    std::vector<ContentsMaterial> materials;             ///< that triangles have
    std::array<std::uint32_t, 2> picture_px{};
    double dpi = 0;  ///< of a picture; 0: it does not say
    std::vector<io::SideFile> side_files;
    std::vector<std::string> warnings, notes;  ///< as `slice` says them
    std::string refused;                       ///< why a job would refuse it as it is; empty: it would not for its size
};

/// Looks at a mesh in mm as long as there is one. Of a picture it is the slab that it is printed as, 100 mm wide where
/// nothing says how wide.
using MeshViewer = std::function<void(const io::TexturedMesh& mesh_mm, bool is_picture)>;

/// What is wrong with a file is in its contents. `view` is called once for what can be read. Throws UsageError for
/// options that are wrong, Cancelled, what `view` throws.
[[nodiscard]] ModelContents read_contents(const SliceOptions& options, Progress& progress, const MeshViewer& view = {});

}  // namespace voxtone::slicer
