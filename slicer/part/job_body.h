// SPDX-License-Identifier: GPL-3.0-or-later
//
// First half of a job: from the file to a body on the voxel grid with its coloured surface.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "io/models/mesh.h"
#include "io/models/side_file.h"
#include "io/pictures/picture.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/mesh/spatial_index.h"
#include "slicer/options/resolved_job.h"
#include "slicer/printer/placement.h"
#include "slicer/printer/printer.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/solid/relief.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// The name of the warning of walls that may break when the support is washed off.
inline constexpr std::string_view fragile_warning = "fragile";

struct JobBody {
    std::string name;                      ///< empty: as the model's file
    std::vector<io::SideFile> side_files;  ///< that reading the model looked for beside it
    io::ModelFile model;                   ///< positions in mm on the tray
    bool is_picture = false;
    Placement placement;
    SolidIndex solid;
    RepairReport repair;
    std::vector<std::uint32_t> wrapped_triangles;  ///< of the model, that a wrap stands for (mesh/mesh_repair.h)
    SurfaceIndex surface;
    std::vector<std::string> resin_of_decal;  ///< role, by decal of the mesh; empty: a mixture makes its colour
    Relief relief;                            ///< of marks that are raised or engraved, on the grid
    VoxelGrid grid;                     ///< of the body alone; where it lies in the print, the plan says (job_plan.h)
    std::vector<std::string> warnings;  ///< of reader, placement and repair
    std::vector<std::string> notes;     ///< what may be worth a thought
    double read_s = 0;
};

/// What is wrong with the model before it is read. Throws InputError for a folder, UsageError for options that do not
/// go with a picture.
void check_model(const ResolvedJob& job);

/// Throws FileError, InputError.
[[nodiscard]] io::Picture read_input_picture(const ResolvedJob& job, const Progress& progress);

/// The second picture of --view both. Throws FileError, InputError for another shape than the first.
[[nodiscard]] std::shared_ptr<const io::Texture> read_night_picture(const ResolvedJob& job, const Progress& progress);

/// The model as its file has it, placed, with what there is to say of it: the first steps of `prepare_body`. Throws
/// FileError, InputError.
[[nodiscard]] JobBody read_body(const ResolvedJob& job, Progress& progress);

/// Throws FileError, InputError.
[[nodiscard]] JobBody prepare_body(const ResolvedJob& job, const PrinterProfile& printer, Progress& progress);

/// Warnings, size and notes, to the user.
void say_body(const JobBody& body, Progress& progress);

/// What makes it higher, as check_layer_count (placement.h) wants it.
[[nodiscard]] std::string enough_layers(const JobBody& body);

/// What of a repaired body is seen and coloured. `body`: its model and grid.
[[nodiscard]] VisibleSurface coloured_surface_of(const JobBody& body, const RepairedMesh& repaired, Progress& progress);

/// The mesh of a body as its boundary for light paths, in mm from the corner of its grid: the staircase of its voxels
/// lets light out near corners at once and shows slanting faces up to 7 CIEDE2000 too light (docs/decisions/010).
/// It is what is seen from outside of the repaired mesh, or the wrap where one stands for a mesh
/// that was not closed; sheets that enclose nothing are as thick as they are printed. Where shells cross, its seams are
/// as rough as the visible surface's pieces; what gets through them leaves at the voxels. Copies the mesh.
[[nodiscard]] MeshBoundary boundary_of(const JobBody& body);

}  // namespace voxtone::slicer
