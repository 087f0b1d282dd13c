// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/option_schema.h"

#include <algorithm>
#include <array>
#include <vector>

#include "io/files/json_writer.h"
#include "io/programs/build_identity.h"
#include "slicer/options/option_table.h"

namespace voxtone::cli {

namespace {

/// What another value leaves of a finished job (slicer/part), the more the greater.
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

void add_option(io::JsonWriter& json, const Option& option, bool rare, bool of_job) {
    const bool positional = !option.standing().empty();
    json.begin_object().add("name", option.name());
    json.add("positional", positional).add("required", option.rules.required).add("flag", option.is_flag());
    json.add("can_be_turned_off", option.rules.off).add("many", option.is_many());
    json.add("separator", std::string(option.rules.separator != 0, option.rules.separator));
    json.add("value", option.value_text()).add("default", option.usual()).add("choices", option.rules.choices);
    if (of_job) json.add("leaves", leaves_words.at(std::size_t(leaves_of(option.name()))));
    json.add("group", option.rules.group).add("rare", rare).add("help", option.told(positional)).end_object();
}

void add_verb(io::JsonWriter& json, const Verb& verb) {
    json.begin_object().add("name", verb.name).add("help", verb.help);
    json.add("example", verb.full_name + " " + verb.example).key("options").begin_list();
    const std::vector<OptionGroup> groups = verb.groups();
    for (const Option& option : verb.options) {
        if (option.name().starts_with("help")) continue;
        const auto group = std::ranges::find(groups, option.rules.group, &OptionGroup::heading);
        add_option(json.line(), option, group != groups.end() && group->rare, verb.name == "slice");
    }
    json.end_list().key("steps").begin_list();
    for (const Verb& step : verb.steps) add_verb(json.line(), step);
    json.end_list().end_object();
}

}  // namespace

std::string option_schema(const Verb& program) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-options").add("version", 1);
    json.add("program", "voxtone " + io::program_version()).key("verbs").begin_list();
    for (const Verb& verb : program.steps) add_verb(json.line(), verb);
    return json.end_list().end_object().text() + "\n";
}

}  // namespace voxtone::cli
