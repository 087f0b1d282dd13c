// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/calibration/target/ideal_patch.h"
#include "voxtone/calibration/target/target_file.h"
#include "voxtone/calibration/target/target_scene.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/pictures/srgb_code.h"
#include "voxtone/io/profiles/resin_file.h"
#include "voxtone/slicer/stacks/print_boxes.h"

namespace voxtone::cli {

namespace {

struct CalibrateTargetArguments {
    calibration::TargetOptions options;
    std::string printer = "stratasys-j750-hm", out, resin_set, layout = "B";
    std::string square = "10mm", top = "0.675mm", base = "5mm", gap = "2mm", marker = "9mm", quiet = "1.5mm";
    std::uint64_t seed = 1;
    bool gcvf = false, overwrite = false;
    int threads = 0;
    ConsoleOptions console;
};

calibration::Target lay_out(CalibrateTargetArguments& a, const slicer::PrinterProfile& printer) {
    calibration::TargetOptions& o = a.options;
    o.layout = static_cast<calibration::TargetLayout>(a.layout[0] - 'A');
    o.printer = printer.id;
    o.pitch_um = {printer.pitch_um.x(), printer.pitch_um.y(), printer.pitch_um.z()};
    o.square_mm = parse_length_mm(a.square, "--square");
    o.top_mm = parse_length_mm(a.top, "--top");
    o.base_mm = parse_length_mm(a.base, "--base");
    o.gap_mm = parse_length_mm(a.gap, "--gap");
    o.marker_mm = parse_length_mm(a.marker, "--marker");
    o.quiet_mm = parse_length_mm(a.quiet, "--quiet-zone");
    return calibration::lay_out_target(o);
}

/// What light goes through the base, where that can be told.
void warn_of_base(const calibration::Target& target, const optics::ResinSet* set, Progress& progress) {
    constexpr double opaque_mm = 15, seen = 0.001;
    if (!set && target.base_mm < opaque_mm) {
        progress.warn(fmt::format(
            "A base of {:.4g} mm may not be opaque: of Vero white, 5 mm are 0.03 darker over black than 15 mm. "
            "Photograph the target on a "
            "black sheet (the fit knows the thickness), print --base 15mm, or give --resin-set to have it computed.",
            target.base_mm));
        return;
    }
    if (!set) return;
    for (const std::string& role : {target.light, target.dark}) {
        const std::vector<double> lost = calibration::lost_through_base(*set, role, target.base_mm);
        if (*std::max_element(lost.begin(), lost.end()) > seen)
            progress.warn(
                fmt::format("{:.4g} mm of {} are not opaque: over black they are {:.3f} darker (by channel) than "
                            "without end. Photograph the target on a "
                            "black sheet (the fit knows the thickness) or print a thicker base.",
                            target.base_mm, role, fmt::join(lost, ", ")));
    }
}

calibration::TargetColours preview_colours(const calibration::Target& target, const optics::ResinSet* set,
                                           const slicer::PrinterProfile& printer) {
    if (set && set->channels.is_rgb()) return calibration::reflected_colours(target, *set);
    std::vector<Eigen::Vector3d> colours;
    for (const io::Rgb& rgb : printer.display_colours(target.roles))
        colours.emplace_back(io::srgb8_to_linear()[rgb[0]], io::srgb8_to_linear()[rgb[1]],
                             io::srgb8_to_linear()[rgb[2]]);
    return calibration::drawn_colours(target, colours);
}

CommandResult make_target(CalibrateTargetArguments& a, Progress& progress) {
    const slicer::PrinterProfile printer = slicer::find_printer(a.printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    const calibration::Target target = lay_out(a, printer);
    std::unique_ptr<const optics::ResinSet> set;
    if (!a.resin_set.empty())
        set = std::make_unique<const optics::ResinSet>(io::find_resin_set(a.resin_set).subset(target.roles));
    warn_of_base(target, set.get(), progress);

    slicer::BoxPrint print;
    for (calibration::TargetBox& box : calibration::target_boxes(target))
        print.boxes.push_back({box.min_mm, box.max_mm, std::move(box.fractions)});
    print.size_mm = {target.size_mm.x(), target.size_mm.y(), target.base_mm + target.top_mm};
    print.roles = target.roles;
    print.seed = a.seed;
    io::StackOutputs outputs;
    outputs.gcvf = a.gcvf;
    const io::StackDescription stack = slicer::print_boxes(print, printer, a.out, outputs, a.overwrite, progress);
    const std::filesystem::path out(a.out);
    constexpr double preview_px_per_mm = 8;
    const io::LinearPicture preview =
        calibration::target_preview(target, preview_colours(target, set.get(), printer), preview_px_per_mm);
    io::write_whole_file(out / "target.png", io::png_bytes(io::encode_over(preview, Eigen::Vector3f::Zero())));
    io::write_whole_file(out / "target.json", calibration::target_text(target));

    double ml = 0;
    for (const io::StackResin& resin : stack.resins) ml += resin.ml;
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-target"},
                                      {"version", 1},
                                      {"target", (out / "target.json").string()},
                                      {"squares", target.squares.size()},
                                      {"size_mm", {print.size_mm.x(), print.size_mm.y(), print.size_mm.z()}},
                                      {"layers", stack.layers},
                                      {"ml", ml},
                                      {"content_sha256", stack.content_sha256}};
    return {json.dump(), fmt::format("{}: layout {}, {} squares, {:.1f} x {:.1f} x {:.2f} mm, {} layers, {:.1f} ml; "
                                     "described by target.json, drawn in target.png\n",
                                     a.out, target.layout, target.squares.size(), print.size_mm.x(), print.size_mm.y(),
                                     print.size_mm.z(), stack.layers, ml)};
}

}  // namespace

Command add_calibrate_target_command(CLI::App& calibrate) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    CalibrateTargetArguments& a = *arguments;
    CLI::App* command = calibrate.add_subcommand(
        "target", "Make the printable target: a stack, its description (target.json) and a picture of it");
    const auto length = [&](const char* name, std::string& value, const char* help) {
        command->add_option(name, value, help)->type_name("LENGTH")->capture_default_str();
    };
    command->add_option("--printer", a.printer, "printer (`voxtone list printers`) or file of its profile")
        ->type_name("ID|FILE")
        ->capture_default_str();
    command->add_option("--resins", a.options.roles, "roles of the resins, two or more: C,M,Y,K,W")
        ->type_name("ROLES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->required();
    command->add_option("--layout", a.layout, "A: pure resins; B: and 10:90 mixtures; C: and 5, 25, 50 %")
        ->check(CLI::IsMember({"A", "B", "C"}))
        ->capture_default_str();
    command->add_option("-o,--out", a.out, "output folder")->type_name("FOLDER")->required();
    command->add_option("--light", a.options.light, "role of the resin of the light half and of the frame")
        ->type_name("ROLE")
        ->capture_default_str();
    command->add_option("--dark", a.options.dark, "role of the resin of the dark half and of the markers")
        ->type_name("ROLE")
        ->capture_default_str();
    command
        ->add_option(
            "--resin-set", a.resin_set,
            "resins as far as they are known already: says whether the base is opaque, and colours the picture")
        ->type_name("SET|FILE");
    length("--square", a.square, "edge of a square");
    length("--top", a.top, "thickness of the squares, rounded to whole layers");
    length("--base", a.base, "thickness of the base under them, rounded up to whole layers");
    length("--gap", a.gap, "between squares");
    length("--marker", a.marker, "edge of a marker");
    length("--quiet-zone", a.quiet, "light around a marker");
    command->add_option("--seed", a.seed, "seed of the dither")->type_name("N")->capture_default_str();
    command->add_flag("--gcvf", a.gcvf, "write a GCVF container too");
    command->add_flag("--overwrite", a.overwrite, "write into a folder that holds other things");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console,
                              [&](Progress& progress) { return make_target(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
