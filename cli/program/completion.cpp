// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/completion.h"

#include <cstddef>

#include "io/profiles/resin_file.h"
#include "slicer/printer/printer.h"

namespace voxtone::cli {

namespace {

/// Null where there is no such option, or it is a flag.
const Option* option_with_value(const Verb& verb, const std::string& name) {
    const Option* option = verb.find(name);
    return option && !option->is_flag() ? option : nullptr;
}

std::vector<std::string> values_of(const Option& option) {
    if (!option.rules.choices.empty()) return option.rules.choices;
    std::vector<std::string> names;
    if (option.rules.unit.starts_with("ID|"))
        for (const slicer::PrinterProfile& printer : slicer::list_printers()) names.push_back(printer.id);
    if (option.rules.unit.starts_with("SET|")) names = io::known_resin_sets();
    return names;
}

std::vector<std::string> names_to_begin_with(const Verb& verb, bool options) {
    std::vector<std::string> names;
    if (!options)
        for (const Verb& step : verb.steps) names.push_back(step.name);
    for (const Option& option : verb.options) {
        if (options)
            for (const std::string& name : option.dashed()) names.push_back(name);
        else if (!option.standing().empty())
            for (const std::string& value : values_of(option)) names.push_back(value);
    }
    std::erase_if(names, [&](const std::string& name) { return options && !name.starts_with("--"); });
    return names;
}

}  // namespace

std::vector<std::string> completions(const Verb& program, const Words& words) {
    const Verb* verb = &program;
    std::string last = words.empty() ? "" : words.back();
    const Option* waiting = nullptr;  // for its value
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        if (waiting) {
            if (words[i] != "=") waiting = nullptr;  // bash takes --name=value for three words
        } else if (words[i].starts_with('-')) {
            waiting = option_with_value(*verb, words[i]);
        } else if (const Verb* next = verb->step(words[i])) {
            verb = next;
        }
    }
    if (waiting && last == "=") last.clear();
    if (const std::size_t sign = last.find('='); last.starts_with("--") && sign != std::string::npos) {
        waiting = option_with_value(*verb, last.substr(0, sign));
        if (!waiting) return {};
        last.erase(0, sign + 1);
    }
    std::vector<std::string> fitting;
    for (const std::string& name : waiting ? values_of(*waiting) : names_to_begin_with(*verb, last.starts_with('-')))
        if (name.starts_with(last)) fitting.push_back(name);
    return fitting;
}

}  // namespace voxtone::cli
