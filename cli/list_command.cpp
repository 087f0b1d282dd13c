// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/cli/commands.h"
#include "voxtone/io/profiles/resin_file.h"
#include "voxtone/slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

struct ListArguments {
    std::string what;
    bool json = false;
};

void list_printers(bool json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const slicer::PrinterProfile& p : slicer::list_printers()) {
        if (json) {
            nlohmann::ordered_json entry{{"id", p.id},
                                         {"name", p.name},
                                         {"pitch_um", {p.pitch_um.x(), p.pitch_um.y(), p.pitch_um.z()}},
                                         {"max_resins", p.max_resins},
                                         {"default_roles", p.default_roles},
                                         {"formats", names_of(p.formats)},
                                         {"warnings", p.warnings()}};
            if (p.tray_mm.allFinite()) entry["tray_mm"] = {p.tray_mm.x(), p.tray_mm.y(), p.tray_mm.z()};
            list.push_back(std::move(entry));
            continue;
        }
        fmt::print("{:<20} {}\n", p.id, p.name);
        fmt::print("{:<20} voxel {:.3f} x {:.3f} x {:.3f} um; {} resins at once, {} by default; writes {}\n", "",
                   p.pitch_um.x(), p.pitch_um.y(), p.pitch_um.z(), p.max_resins, fmt::join(p.default_roles, ","),
                   fmt::join(names_of(p.formats), ", "));
        for (const std::string& warning : p.warnings()) fmt::print("{:<20} {}\n", "", warning);
    }
    if (json) fmt::print("{}\n", list.dump());
}

void list_resins(bool json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const std::string& name : io::known_resin_sets()) {
        const optics::ResinSet set = io::find_resin_set(name);
        if (json) {
            nlohmann::ordered_json resins = nlohmann::ordered_json::array();
            for (const optics::Resin& resin : set.resins)
                resins.push_back({{"name", resin.name}, {"role", resin.role}});
            list.push_back(
                {{"name", set.name}, {"source", set.source}, {"channels", set.channels.size()}, {"resins", resins}});
            continue;
        }
        fmt::print("{:<20} {}\n", set.name, set.source);
        for (const optics::Resin& resin : set.resins) fmt::print("{:<20} {:<3} {}\n", "", resin.role, resin.name);
    }
    if (json) fmt::print("{}\n", list.dump());
}

}  // namespace

Command add_list_command(CLI::App& program) {
    auto arguments = std::make_shared<ListArguments>();
    CLI::App* command = program.add_subcommand("list", "List the printers or the resin sets that the program knows");
    command->add_option("what", arguments->what, "printers or resins")
        ->required()
        ->check(CLI::IsMember({"printers", "resins"}));
    command->add_flag("--json", arguments->json, "one JSON array instead of text");
    return [arguments] {
        arguments->what == "printers" ? list_printers(arguments->json) : list_resins(arguments->json);
        return 0;
    };
}

}  // namespace voxtone::cli
