// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/patch_options.h"

#include "base/error.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

void add_patch_options(CLI::App& command, LengthOptions& lengths, PatchOptions& options,
                       calibration::MeasuredPatchOptions& measured) {
    add_value(command, "--white", measured.white,
              "reflectance of the white reference that the values were divided by: 0.99 for Spectralon of 99 %");
    command
        .add_option_function<std::string>(
            "--illuminant",
            [&measured](const std::string& word) {
                measured.reading.illuminant = word == "D65" ? optics::Illuminant::d65
                                              : word == "A" ? optics::Illuminant::a
                                                            : optics::Illuminant::d50;
            },
            "of a chart's L,a,b or X,Y,Z; empty: what the file says, else D50")
        ->type_name("D50|D65|A")
        ->check(CLI::IsMember({"D50", "D65", "A"}));
    command.add_flag(
        "--printable-only", measured.reading.printable_only,
        "of a chart that goes beyond what a volume holds take the rows that do not: inks of 100 % together");
    lengths
        .add(command, "--base", measured.base_mm,
             "thickness of the base under the squares, for all patches; empty: the table's base_mm, else without end")
        ->group("Model");
    add_value(command, "--under", options.under,
              "what a base of known thickness lies on: black in optical contact, or air above a sheet")
        ->check(CLI::IsMember({"black", "air"}))
        ->group("Model");
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

void add_patch_map_options(CLI::App& command, calibration::PatchMapFiles& files) {
    command
        .add_option("--target", files.target,
                    "the page shows the patches where they lie on this target (target.json); empty: as a chart")
        ->type_name("FILE")
        ->group("Page");
    command
        .add_option("--picture", files.picture,
                    "the page shows this photograph of the target too: what `calibrate photo --picture` wrote")
        ->type_name("FILE.png")
        ->group("Page");
}

void set_patch_model(const PatchOptions& options, calibration::PatchModelOptions& model,
                     calibration::MeasuredPatchOptions& measured) {
    if (!options.printer.empty() && !options.pitch.empty())
        throw UsageError("--printer and --pitch both give the voxel's size; give one of them");
    if (!options.pitch.empty()) model.pitch_mm = slicer::parse_pitch_mm(options.pitch);
    if (!options.printer.empty()) {
        const auto printer = slicer::find_printer(options.printer);
        measured.reading.known = printer.default_roles;
        const auto pitch = printer.sliced_pitch_mm();
        model.pitch_mm = {pitch.x(), pitch.y(), pitch.z()};
    }
    model.under = options.under == "air" ? calibration::UnderBase::air : calibration::UnderBase::black;
}

}  // namespace voxtone::cli
