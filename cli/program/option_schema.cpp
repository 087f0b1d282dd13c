// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/option_schema.h"

#include <algorithm>
#include <array>
#include <vector>

#include "cli/program/option_text.h"
#include "io/files/json_writer.h"
#include "io/programs/build_identity.h"
#include "slicer/options/option_table.h"

namespace voxtone::cli {

namespace {

/// Whether `--no-NAME` turns it off.
bool can_be_turned_off(const CLI::Option& option) {
    const std::vector<std::string>& names = option.get_lnames();
    return std::ranges::any_of(names,
                               [&](const auto& name) { return std::ranges::find(names, "no-" + name) != names.end(); });
}

std::string default_of(const CLI::Option& option) {
    std::string usual = option.get_default_str();
    if (usual.size() > 1 && usual.front() == '[' && usual.back() == ']') usual = usual.substr(1, usual.size() - 2);
    return usual == "\"\"" ? "" : usual;
}

/// What another value leaves of a finished job (slicer/kept), the more the greater.
enum class Leaves { nothing, settled_loop, loop, stack };
constexpr std::array leaves_words{"nothing", "settled-loop", "loop", "stack"};

Leaves leaves_of(const std::string& name) {
    const slicer::OptionSpec* const spec = slicer::find_option(name);
    if (!spec) return Leaves::nothing;
    Leaves least = Leaves::stack;
    for (const auto& [choice, values] : spec->presets)
        for (const auto& [set, value] : values) least = std::min(least, leaves_of(set));
    if (spec->is_preset()) return least;
    if (spec->decides >= slicer::Decides::work) return Leaves::stack;
    if (spec->decides <= slicer::Decides::bits) return Leaves::nothing;
    return name == "iterations" ? Leaves::settled_loop : Leaves::loop;
}

void add_option(io::JsonWriter& json, const CLI::Option& option, bool rare, bool of_job) {
    const bool positional = option.get_positional(), flag = option.get_items_expected_max() == 0;
    const OptionText text = option_text(option, positional);
    const std::string name = positional ? option.get_single_name() : option.get_lnames().front();
    json.begin_object().add("name", name);
    json.add("positional", positional).add("required", option.get_required()).add("flag", flag);
    json.add("can_be_turned_off", can_be_turned_off(option));
    json.add("many", option.get_items_expected_max() >= CLI::detail::expected_max_vector_size);
    json.add("separator", option.get_delimiter() ? std::string(1, option.get_delimiter()) : std::string());
    json.add("value", text.value).add("default", default_of(option)).add("choices", text.choices);
    if (of_job) json.add("leaves", leaves_words.at(std::size_t(leaves_of(name))));
    json.add("group", option.get_group()).add("rare", rare).add("help", text.help).end_object();
}

void add_options(io::JsonWriter& json, const CLI::App& command) {
    const std::vector<OptionGroup> groups = option_groups(command);
    json.key("options").begin_list();
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty() || option->get_lnames() == std::vector<std::string>{"help"}) continue;
        if (option->get_name() == "--help-all") continue;
        const auto group = std::ranges::find(groups, option->get_group(), &OptionGroup::heading);
        add_option(json.line(), *option, group != groups.end() && group->rare, command.get_name() == "slice");
    }
    json.end_list();
}

void add_command(io::JsonWriter& json, const CLI::App& command) {
    json.begin_object().add("name", command.get_name()).add("help", command.get_description());
    json.add("example", command.get_footer());
    add_options(json, command);
    json.key("steps").begin_list();
    for (const CLI::App* step : command.get_subcommands({})) add_command(json.line(), *step);
    json.end_list().end_object();
}

}  // namespace

std::string option_schema(const CLI::App& program) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-options").add("version", 1);
    json.add("program", "voxtone " + io::program_version()).key("verbs").begin_list();
    for (const CLI::App* verb : program.get_subcommands({})) add_command(json.line(), *verb);
    return json.end_list().end_object().text() + "\n";
}

}  // namespace voxtone::cli
