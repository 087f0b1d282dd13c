// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/calibration/fit/fit_text.h"
#include "voxtone/calibration/patches/patch_check.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/patch_options.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::cli {

namespace {

struct CalibrateCheckArguments {
    std::string resins, patches;
    PatchOptions measured;
    int threads = 0;
    ConsoleOptions console;
};

int run(const CalibrateCheckArguments& arguments) {
    const ThreadLimit limit(static_cast<std::size_t>(arguments.threads));
    return run_on_console(arguments.console, [&](Progress& progress) {
        calibration::PatchModelOptions options;
        const calibration::PatchTable table = read_patches(arguments.patches, arguments.measured, options, progress);
        const auto check = calibration::check_resins(io::find_resin_set(arguments.resins), table, options);
        return CommandResult{calibration::check_json(check, table), calibration::check_text(check, table)};
    });
}

}  // namespace

Command add_calibrate_check_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateCheckArguments>();
    CLI::App* command =
        calibrate.add_subcommand("check", "How well a resin set predicts measured patches, as CIEDE2000");
    command->add_option("resins", arguments->resins, "resin set (`voxtone list resins`) or file")
        ->required()
        ->type_name("SET|FILE");
    command->add_option("patches", arguments->patches, "CSV of measured patches")->required()->type_name("FILE");
    add_patch_options(*command, arguments->measured);
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
