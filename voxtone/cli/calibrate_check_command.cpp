// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/calibration/fit_text.h"
#include "voxtone/calibration/patch_check.h"
#include "voxtone/calibration/patch_file.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/resin_file.h"
#include "voxtone/slicer/printer.h"

namespace voxtone::cli {

namespace {

struct Arguments {
    std::string resins, patches, printer, base, under = "black";
    double white = 1;
    int threads = 0;
    ConsoleOptions console;
};

int run(const Arguments& arguments) {
    const ThreadLimit limit(static_cast<std::size_t>(arguments.threads));
    return run_on_console(arguments.console, [&](Progress&) {
        calibration::PatchModelOptions options;
        if (!arguments.printer.empty()) {
            const auto pitch = slicer::find_printer(arguments.printer).pitch_mm();
            options.pitch_mm = {pitch.x(), pitch.y(), pitch.z()};
        }
        options.under = arguments.under == "air" ? calibration::UnderBase::air : calibration::UnderBase::black;
        calibration::PatchTable table = calibration::read_patches(arguments.patches);
        calibration::apply_white_reference(table, arguments.white);
        if (!arguments.base.empty()) {
            const double base_mm = parse_length_mm(arguments.base, "--base");
            for (calibration::Patch& patch : table.patches) patch.base_mm = base_mm;
        }
        const auto check = calibration::check_resins(io::find_resin_set(arguments.resins), table, options);
        return CommandResult{calibration::check_json(check, table), calibration::check_text(check, table)};
    });
}

}  // namespace

Command add_calibrate_check_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        calibrate.add_subcommand("check", "How well a resin set predicts measured patches, as CIEDE2000");
    command->add_option("resins", arguments->resins, "resin set (`voxtone list resins`) or file")
        ->required()
        ->type_name("SET|FILE");
    command->add_option("patches", arguments->patches, "CSV of measured patches")->required()->type_name("FILE");
    command
        ->add_option("--white", arguments->white,
                     "reflectance of the white reference that the values were divided by: 0.99 for Spectralon of 99 %")
        ->capture_default_str();
    command
        ->add_option("--base", arguments->base,
                     "thickness of the base under the squares; empty: the table's base_mm, else without end")
        ->type_name("LENGTH");
    command
        ->add_option("--under", arguments->under,
                     "what a base of known thickness lies on: black in optical contact, or air above a sheet")
        ->check(CLI::IsMember({"black", "air"}))
        ->capture_default_str();
    command
        ->add_option("--printer", arguments->printer,
                     "mixtures are dithers of this printer's voxels; empty: ideal mixtures")
        ->type_name("ID|FILE");
    command->add_option("--threads", arguments->threads, "threads; 0: one per core")
        ->group("Run")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
