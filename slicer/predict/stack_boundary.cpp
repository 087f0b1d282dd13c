// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/stack_boundary.h"

#include <cmath>
#include <filesystem>
#include <string_view>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/file_digest.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_values.h"
#include "slicer/options/resolve_job.h"
#include "slicer/part/job_body.h"
#include "slicer/predict/part_in_tray.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view model_key = "model";

/// The model and what lies beside it; empty where all of it is as it was.
std::string changed_model(const SliceOptions& requested, const Progress& progress) {
    bool recorded = false;
    for (const JobInput& input : requested.recorded_inputs) {
        if (!input.key.starts_with(model_key)) continue;
        recorded = true;
        if (input.sha256.empty()) continue;
        std::error_code none;
        if (!fs::exists(input.file, none)) return fmt::format("{} is gone", input.file);
        if (io::file_sha256(input.file, &progress) != input.sha256)
            return fmt::format("{} holds something else than when it was sliced", input.file);
    }
    return recorded ? "" : "its job.json does not say what the model held";
}

/// Whether the mesh fills the grid that the layers have.
bool fits(const VoxelGrid& grid, const StackVolume& stack) {
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        if (grid.size[a] != stack.volume.size()[a]) return false;
        if (std::abs(grid.origin_mm[axis] - stack.corner_mm[a]) > 0.01 * grid.pitch_mm[axis]) return false;
    }
    return true;
}

}  // namespace

StackBody body_of_stack(const std::string& stack, const StackVolume& volume, Progress& progress) {
    const fs::path job_file = fs::path(stack) / job_file_name;
    std::error_code none;
    if (find_part_in_tray(stack)) return {{}, "it is one part of a tray"};
    if (!fs::exists(job_file, none)) return {{}, fmt::format("there is no {} to name its model", job_file.string())};
    try {
        SliceOptions requested;
        read_job(job_file.string(), requested);
        const ResolvedJob job = resolve(requested);
        if (job.kind == ModelKind::tray_plan) return {{}, "it is a tray of many parts"};
        if (job.layers) return {{}, "it is a part of its body's layers"};
        if (std::string why = changed_model(requested, progress); !why.empty()) return {{}, std::move(why)};
        JobBody body = prepare_body(job, find_printer(job.printer), progress);
        if (!fits(body.grid, volume)) return {{}, fmt::format("{} makes another body now", job.model)};
        return {std::move(body), {}};
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        return {{}, error.what()};
    }
}

StackBoundary boundary_of_stack(const std::string& stack, const StackVolume& volume, Progress& progress) {
    if (volume.of_picture) return {{}, "it is a picture's slab, whose faces are flat"};
    StackBody found = body_of_stack(stack, volume, progress);
    if (!found.body) return {{}, std::move(found.why_not)};
    if (found.body->is_picture) return {{}, "it is a picture's slab, whose faces are flat"};
    if (!found.body->relief.empty()) return {{}, "its labels are raised or engraved, which its mesh is not"};
    return {boundary_of(*found.body), {}};
}

}  // namespace voxtone::slicer
