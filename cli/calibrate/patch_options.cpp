// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/patch_options.h"

#include "base/error.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

void add_patch_options(Verb& command, PatchOptions& options, calibration::MeasuredPatchOptions& measured) {
    command.add("--white", measured.white,
                "reflectance of the white reference that the values were divided by: 0.99 for Spectralon of 99 %");
    command.add("--illuminant", options.illuminant, "of a chart's L,a,b or X,Y,Z; empty: what the file says, else D50",
                {.unit = "D50|D65|A", .choices = {"D50", "D65", "A"}});
    command.add("--printable-only", measured.reading.printable_only,
                "of a chart that goes beyond what a volume holds take the rows that do not: inks of 100 % together");
    command.add(
        "--base", length(measured.base_mm),
        "thickness of the base under the squares, for all patches; empty: the table's base_mm, else without end",
        {.group = "Model"});
    command.add("--under", options.under,
                "what a base of known thickness lies on: black in optical contact, or air above a sheet",
                {.choices = {"black", "air"}, .group = "Model"});
    command.add("--printer", options.printer, "mixtures are dithers of this printer's voxels; empty: ideal mixtures",
                {.unit = "ID|FILE", .group = "Model"});
    command.add("--pitch", options.pitch, "the same by the voxel's size along columns, rows, layers: 42.33,84.67,27um",
                {.unit = "X,Y,Z", .group = "Model"});
}

void add_patch_map_options(Verb& command, calibration::PatchMapFiles& files) {
    command.add("--target", files.target,
                "the page shows the patches where they lie on this target (target.json); empty: as a chart",
                {.unit = "FILE", .group = "Page"});
    command.add("--picture", files.picture,
                "the page shows this photograph of the target too: what `calibrate photo --picture` wrote",
                {.unit = "FILE.png", .group = "Page"});
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
    if (!options.illuminant.empty())
        measured.reading.illuminant = options.illuminant == "D65" ? optics::Illuminant::d65
                                      : options.illuminant == "A" ? optics::Illuminant::a
                                                                  : optics::Illuminant::d50;
    model.under = options.under == "air" ? calibration::UnderBase::air : calibration::UnderBase::black;
}

}  // namespace voxtone::cli
