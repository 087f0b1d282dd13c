// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/patch_options.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/base/units.h"
#include "voxtone/calibration/patches/patch_file.h"
#include "voxtone/slicer/predict/stack_volume.h"
#include "voxtone/slicer/printer/printer.h"

namespace voxtone::cli {

void add_patch_options(CLI::App& command, PatchOptions& options) {
    command
        .add_option("--white", options.white,
                    "reflectance of the white reference that the values were divided by: 0.99 for Spectralon of 99 %")
        ->capture_default_str();
    command
        .add_option(
            "--base", options.base,
            "thickness of the base under the squares, for all patches; empty: the table's base_mm, else without end")
        ->type_name("LENGTH")
        ->group("Model");
    command
        .add_option("--under", options.under,
                    "what a base of known thickness lies on: black in optical contact, or air above a sheet")
        ->check(CLI::IsMember({"black", "air"}))
        ->group("Model")
        ->capture_default_str();
    command
        .add_option("--printer", options.printer,
                    "mixtures are dithers of this printer's voxels; empty: ideal mixtures")
        ->type_name("ID|FILE")
        ->group("Model");
    command
        .add_option("--pitch", options.pitch,
                    "the same by the voxel's size along columns, rows, layers: 42.33,84.67,27um")
        ->type_name("X,Y,Z")
        ->group("Model");
}

calibration::PatchTable read_patches(const std::string& file, const PatchOptions& options,
                                     calibration::PatchModelOptions& model, Progress& progress) {
    if (!options.printer.empty() && !options.pitch.empty())
        throw UsageError("--printer and --pitch both give the voxel's size; give one of them");
    if (!options.pitch.empty()) model.pitch_mm = slicer::parse_pitch_mm(options.pitch);
    if (!options.printer.empty()) {
        const auto pitch = slicer::find_printer(options.printer).pitch_mm();
        model.pitch_mm = {pitch.x(), pitch.y(), pitch.z()};
    }
    model.under = options.under == "air" ? calibration::UnderBase::air : calibration::UnderBase::black;
    calibration::PatchTable table = calibration::read_patches(file);
    calibration::apply_white_reference(table, options.white);
    if (!options.base.empty()) {
        const double base_mm = parse_length_mm(options.base, "--base");
        for (calibration::Patch& patch : table.patches) patch.base_mm = base_mm;
    }
    const bool mixed =
        std::any_of(table.patches.begin(), table.patches.end(), [](const auto& p) { return p.top.size() > 1; });
    if (mixed && options.printer.empty() && options.pitch.empty())
        progress.warn(
            "mixtures are taken as ideal; those of a printed target are dithers of voxels, and extinctions come out up "
            "to a "
            "third wrong without them: give --printer or --pitch");
    return table;
}

}  // namespace voxtone::cli
