// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "io/files/json_writer.h"
#include "io/layers/verify.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

struct VerifyArguments {
    std::string stack, printer;
    RunOptions run;
};

std::string report_json(const io::StackReport& report) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-verify").add("version", 1).add("passed", report.passed());
    json.add("layers", report.layers).add("size_px", report.size_px).add("printer", report.printer);
    json.add("empty_layers", report.empty_layers).add("content_sha256", report.content_sha256);
    json.add("fault_count", report.fault_count).add("notes", report.notes).key("faults").begin_list();
    for (const io::StackFault& fault : report.faults)
        json.begin_object()
            .add("rule", fault.rule)
            .add("where", fault.where)
            .add("what", fault.what)
            .add("remedy", fault.remedy)
            .end_object();
    return json.end_list().end_object().text();
}

io::VerifyRules rules_of(const slicer::PrinterProfile& printer) {
    io::VerifyRules rules;
    rules.printer = printer.id;
    rules.most_colours = static_cast<std::uint32_t>(printer.max_colours);
    rules.least_layers = static_cast<std::uint32_t>(printer.min_layers);
    rules.pitch_um = {printer.pitch_um.x(), printer.pitch_um.y(), printer.pitch_um.z()};
    return rules;
}

/// What the printer accepts: that of --printer, else that of the manifest, else what all printers of the family accept.
io::VerifyRules rules_for(const std::string& asked, const std::string& of_manifest) {
    if (!asked.empty()) return rules_of(slicer::find_printer(asked));
    io::VerifyRules usual;
    if (of_manifest.empty()) return usual;
    const std::vector<slicer::PrinterProfile> known = slicer::list_printers();
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const auto& printer) { return printer.id == of_manifest; });
    if (found != known.end()) return rules_of(*found);
    usual.most_colours = io::max_materials - 1;
    usual.least_layers = 1;
    usual.notes.push_back(fmt::format(
        "the printer of the manifest, '{}', is not known here: its voxel size, number of colours and fewest "
        "layers were not checked; name its profile with --printer FILE.json",
        of_manifest));
    return usual;
}

int run(const VerifyArguments& arguments) {
    return run_on_console(arguments.run, [&](Progress& progress) {
        const io::StackReport report = io::verify_stack(
            arguments.stack, [&](const std::string& printer) { return rules_for(arguments.printer, printer); },
            &progress);
        return JobResult{report_json(report), io::report_text(report),
                         report.passed() ? ExitCode::done : ExitCode::check_failed};
    });
}

}  // namespace

Verb verify_verb() {
    auto arguments = std::make_shared<VerifyArguments>();
    Verb command(
        "verify",
        "Check a layer stack, ours or anyone's, as the printer's software would; exit code 6 with every fault named",
        "out/cow");
    command.add("stack", arguments->stack, "output folder, folder of PNG layers, or .gcvf file",
                {.unit = "FOLDER|FILE", .required = true});
    command.add("--printer", arguments->printer, "check against this printer; empty: the one that the manifest names",
                {.unit = "ID|FILE"});
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
