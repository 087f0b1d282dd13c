// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/print/print_commands.h"
#include "cli/program/help.h"
#include "cli/program/outcome.h"
#include "io/profiles/resin_file.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

struct ListArguments {
    std::string what;
    bool json = false;
};

using Json = nlohmann::ordered_json;

Json printer_json(const slicer::PrinterProfile& p) {
    Json entry{{"id", p.id},
               {"name", p.name},
               {"pitch_um", {p.pitch_um.x(), p.pitch_um.y(), p.pitch_um.z()}},
               {"max_resins", p.max_resins},
               {"min_layers", p.min_layers},
               {"default_roles", p.default_roles},
               {"default_resins", p.default_resins},
               {"formats", names_of(p.formats)},
               {"warnings", p.warnings()}};
    if (p.tray_mm.allFinite()) entry["tray_mm"] = {p.tray_mm.x(), p.tray_mm.y(), p.tray_mm.z()};
    return entry;
}

/// A line under the name of what is listed.
std::string detail(const std::string& text) { return fmt::format("{:<20} {}\n", "", text); }

std::string tray_text(const slicer::PrinterProfile& p) {
    if (!p.tray_mm.allFinite()) return "tray of any size";
    return fmt::format("tray {:g} x {:g} x {:g} mm", p.tray_mm.x(), p.tray_mm.y(), p.tray_mm.z());
}

std::string printer_text(const slicer::PrinterProfile& p) {
    std::string text = fmt::format("{:<20} {}\n", p.id, p.name);
    text += detail(fmt::format(
        "{}; voxel {:.3f} x {:.3f} x {:.3f} um; {}", tray_text(p), p.pitch_um.x(), p.pitch_um.y(), p.pitch_um.z(),
        p.min_layers > 1 ? fmt::format("no fewer than {} layers", p.min_layers) : std::string("any number of layers")));
    text +=
        detail(fmt::format("{} resins at once, {} of {} by default; writes {}", p.max_resins,
                           fmt::join(p.default_roles, ","), p.default_resins, fmt::join(names_of(p.formats), ", ")));
    for (const std::string& warning : p.warnings()) text += detail(warning);
    return text;
}

Json resin_set_json(const optics::ResinSet& set) {
    Json resins = Json::array();
    for (const optics::Resin& resin : set.resins) resins.push_back({{"name", resin.name}, {"role", resin.role}});
    return {{"name", set.name},
            {"source", set.source},
            {"channels", set.channels.size()},
            {"channels_are", optics::channels_text(set.channels)},
            {"resins", resins}};
}

std::string resin_set_text(const optics::ResinSet& set) {
    std::string text = fmt::format("{:<20} {}\n", set.name, set.source);
    text += detail("channels: " + optics::channels_text(set.channels));
    for (const optics::Resin& resin : set.resins) text += detail(fmt::format("{:<3} {}", resin.role, resin.name));
    return text;
}

std::vector<optics::ResinSet> resin_sets() {
    std::vector<optics::ResinSet> sets;
    for (const std::string& name : io::known_resin_sets()) sets.push_back(io::find_resin_set(name));
    return sets;
}

template <class Entries, class AsJson, class AsText>
void print_list(const Entries& entries, bool json, AsJson as_json, AsText as_text) {
    Json list = Json::array();
    std::string text;
    for (const auto& entry : entries) {
        list.push_back(as_json(entry));
        text += as_text(entry);
    }
    print_out(json ? list.dump() + "\n" : text);
}

}  // namespace

Command add_list_command(CLI::App& program) {
    auto arguments = std::make_shared<ListArguments>();
    CLI::App* command = program.add_subcommand("list", "List the printers or the resin sets that the program knows");
    command->add_option("what", arguments->what, "printers or resins")
        ->required()
        ->check(CLI::IsMember({"printers", "resins"}));
    command->add_flag("--json", arguments->json, "one JSON array instead of text");
    add_example(*command, "printers");
    return [arguments] {
        if (arguments->what == "printers")
            print_list(slicer::list_printers(), arguments->json, printer_json, printer_text);
        else
            print_list(resin_sets(), arguments->json, resin_set_json, resin_set_text);
        return 0;
    };
}

}  // namespace voxtone::cli
