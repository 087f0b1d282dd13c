// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels and decals onto a body: what they show is set, made or read, finds its place, and becomes a decal of the mesh
// (io/models/decal.h), which is colour like any other from there on: separation, loop, prediction and report see it.
#pragma once

#include <string>
#include <vector>

#include "io/files/read_options.h"
#include "io/models/mesh.h"
#include "slicer/mesh/spatial_index.h"
#include "slicer/options/mark_options.h"
#include "slicer/surface/emboss.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

struct BodyToMark {
    io::TexturedMesh& mesh;  ///< gets the decals; in mm
    const SolidIndex& solid;
    SurfaceIndex& surface;  ///< a picture's slab, coloured on its face alone, takes colour below its marks too
    bool is_picture = false;
    double pitch_mm = 0;  ///< the finest of the print, at which drawings are drawn
};

struct LaidMarks {
    std::vector<std::string> warnings;   ///< of what was read for them
    std::vector<std::string> notes;      ///< what there is to say of each: its size, where it lies, its colour
    std::vector<EmbossedMark> embossed;  ///< those that are raised or engraved
};

/// One over the other, in their order. Throws InputError for one that is larger than any face, lies beside the body or
/// has no letters for its text; FileError.
LaidMarks lay_marks(const std::vector<MarkOptions>& marks, const BodyToMark& body, const io::ReadOptions& reading);

}  // namespace voxtone::slicer
