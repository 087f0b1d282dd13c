// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/completion.h"

#include <cstddef>

#include "cli/program/option_text.h"
#include "io/profiles/resin_file.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

const CLI::App* next_command(const CLI::App& command, const std::string& word) {
    for (const CLI::App* verb : command.get_subcommands({}))
        if (verb->get_name() == word) return verb;
    return nullptr;
}

/// Null where there is no such option, or it is a flag.
const CLI::Option* option_with_value(const CLI::App& command, const std::string& name) {
    const CLI::Option* option = command.get_option_no_throw(name);
    return option && option->get_items_expected_max() > 0 ? option : nullptr;
}

std::vector<std::string> values_of(const CLI::Option& option, bool positional) {
    const OptionText text = option_text(option, positional);
    if (!text.choices.empty()) return text.choices;
    std::vector<std::string> names;
    if (text.value.starts_with("ID|"))
        for (const slicer::PrinterProfile& printer : slicer::list_printers()) names.push_back(printer.id);
    if (text.value.starts_with("SET|")) names = io::known_resin_sets();
    return names;
}

std::vector<std::string> names_to_begin_with(const CLI::App& command, bool options) {
    std::vector<std::string> names;
    if (options)
        for (const CLI::Option* option : command.get_options()) {
            if (option->get_group().empty()) continue;
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        }
    else if (!command.get_subcommands({}).empty())
        for (const CLI::App* verb : command.get_subcommands({})) names.push_back(verb->get_name());
    else
        for (const CLI::Option* option : command.get_options())
            if (option->get_positional())
                for (const std::string& value : values_of(*option, true)) names.push_back(value);
    return names;
}

}  // namespace

std::vector<std::string> completions(const CLI::App& program, const Words& words) {
    const CLI::App* command = &program;
    std::string last = words.empty() ? "" : words.back();
    const CLI::Option* waiting = nullptr;  // for its value
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        if (waiting) {
            if (words[i] != "=") waiting = nullptr;  // bash takes --name=value for three words
        } else if (words[i].starts_with('-')) {
            waiting = option_with_value(*command, words[i]);
        } else if (const CLI::App* next = next_command(*command, words[i])) {
            command = next;
        }
    }
    if (waiting && last == "=") last.clear();
    if (const std::size_t sign = last.find('='); last.starts_with("--") && sign != std::string::npos) {
        waiting = option_with_value(*command, last.substr(0, sign));
        if (!waiting) return {};
        last.erase(0, sign + 1);
    }
    std::vector<std::string> fitting;
    for (const std::string& name :
         waiting ? values_of(*waiting, false) : names_to_begin_with(*command, last.starts_with('-')))
        if (name.starts_with(last)) fitting.push_back(name);
    return fitting;
}

}  // namespace voxtone::cli
