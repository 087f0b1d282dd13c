// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "cli/print/print_commands.h"
#include "cli/program/outcome.h"
#include "io/files/json_writer.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

struct ListArguments {
    std::string what;
    bool json = false;
};

std::vector<std::string> sets_of(const std::string& family) {
    std::vector<std::string> names = io::known_resin_sets();
    std::erase_if(names, [&](const std::string& name) { return io::resin_family(name) != family; });
    return names;
}

std::vector<std::string> printers_that_take(const std::string& family) {
    std::vector<std::string> ids;
    for (const slicer::PrinterProfile& printer : slicer::list_printers())
        if (printer.takes(family)) ids.push_back(printer.id);
    return ids;
}

/// What printers' software calls it, as it stands on the cartridge; empty where no printer says.
std::string cartridge_of(const std::string& family, const std::string& role) {
    for (const slicer::PrinterProfile& printer : slicer::list_printers())
        for (const slicer::Cartridges& taken : printer.cartridges)
            if (const auto name = taken.names.find(role); taken.family == family && name != taken.names.end())
                return name->second;
    return {};
}

void add_printer(io::JsonWriter& json, const slicer::PrinterProfile& p) {
    json.begin_object().add("id", p.id).add("name", p.name).add("pitch_um", p.pitch_um);
    json.add("max_resins", p.max_resins).add("min_layers", p.min_layers).add("default_roles", p.default_roles);
    json.add("default_resins", p.default_resins).add("formats", names_of(p.formats)).add("warnings", p.warnings());
    if (p.tray_mm.allFinite()) json.add("tray_mm", p.tray_mm);
    if (!p.cartridges.empty()) json.key("cartridges").begin_list();
    for (const slicer::Cartridges& taken : p.cartridges)
        json.begin_object().add("family", taken.family).add("resins", sets_of(taken.family)).end_object();
    if (!p.cartridges.empty()) json.end_list();
    json.end_object();
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
    for (const slicer::Cartridges& taken : p.cartridges)
        text += detail(
            fmt::format("takes {} cartridges: resin sets {}", taken.family, fmt::join(sets_of(taken.family), ", ")));
    for (const std::string& warning : p.warnings()) text += detail(warning);
    return text;
}

void add_resin_set(io::JsonWriter& json, const optics::ResinSet& set) {
    json.begin_object().add("name", set.name).add("source", set.source).add("channels", set.channels.size());
    json.add("channels_are", optics::channels_text(set.channels));
    const std::string family = io::resin_family(set.name);
    json.add("family", family).add("printers", printers_that_take(family)).key("resins").begin_list();
    for (const optics::Resin& resin : set.resins)
        json.begin_object()
            .add("name", resin.name)
            .add("role", resin.role)
            .add("cartridge", cartridge_of(family, resin.role))
            .end_object();
    json.end_list().end_object();
}

std::string resin_set_text(const optics::ResinSet& set) {
    std::string text = fmt::format("{:<20} {}\n", set.name, set.source);
    text += detail("channels: " + optics::channels_text(set.channels));
    const std::string family = io::resin_family(set.name);
    text += detail(fmt::format("{} cartridges, which {} take", family, fmt::join(printers_that_take(family), ", ")));
    for (const optics::Resin& resin : set.resins) {
        const std::string cartridge = cartridge_of(family, resin.role);
        text += detail(fmt::format("{:<3} {}{}", resin.role, resin.name,
                                   cartridge.empty() || cartridge == resin.name ? "" : ", cartridge " + cartridge));
    }
    return text;
}

std::vector<optics::ResinSet> resin_sets() {
    std::vector<optics::ResinSet> sets;
    for (const std::string& name : io::known_resin_sets()) sets.push_back(io::find_resin_set(name));
    return sets;
}

struct Listed {
    io::JsonWriter json;
    std::string text;
};

template <class Entries, class AddTo, class AsText>
Listed listed(const Entries& entries, AddTo add_to, AsText as_text) {
    Listed list;
    list.json.begin_list();
    for (const auto& entry : entries) {
        add_to(list.json, entry);
        list.text += as_text(entry);
    }
    list.json.end_list();
    return list;
}

void print_lists(const ListArguments& arguments) {
    const Listed printers = listed(slicer::list_printers(), add_printer, printer_text);
    const Listed resins = listed(resin_sets(), add_resin_set, resin_set_text);
    if (arguments.what.empty() && arguments.json)
        print_out(fmt::format("{{\"printers\":{},\"resins\":{}}}\n", printers.json.text(), resins.json.text()));
    else if (arguments.what.empty())
        print_out("Printers (--printer):\n\n" + printers.text + "\nResin sets (--resins):\n\n" + resins.text);
    else if (const Listed& list = arguments.what == "printers" ? printers : resins; arguments.json)
        print_out(list.json.text() + "\n");
    else
        print_out(list.text);
}

}  // namespace

Verb list_verb() {
    auto arguments = std::make_shared<ListArguments>();
    Verb command("list", "List the printers or the resin sets that the program knows", "printers");
    command.add("what", arguments->what, "printers or resins; both where it is left out",
                {.choices = {"printers", "resins"}});
    command.add("--json", arguments->json, "one JSON array instead of text; of both an object of two");
    command.run = [arguments] {
        print_lists(*arguments);
        return 0;
    };
    return command;
}

}  // namespace voxtone::cli
