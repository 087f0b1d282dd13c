// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/help.h"

#include <sstream>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace voxtone::cli {

namespace {

constexpr std::size_t page_columns = 100, help_column = 30;

std::string entry(const std::string& head, const std::string& help) {
    const std::string first = "  " + head;
    const std::string text = wrapped(help, page_columns, help_column);
    if (first.size() + 2 > help_column) return first + "\n" + std::string(help_column, ' ') + text + "\n";
    return first + std::string(help_column - first.size(), ' ') + text + "\n";
}

std::string usage(const Verb& verb) {
    std::string text = "Usage: " + verb.full_name + " [OPTIONS]";
    for (const Option& option : verb.options) {
        if (option.standing().empty()) continue;
        const std::string name = option.standing() + (option.is_many() ? "..." : "");
        text += option.rules.required ? " " + name : " [" + name + "]";
    }
    return text + (verb.steps.empty() ? "\n" : " VERB\n");
}

std::string option_section(const OptionGroup& group, bool standing) {
    std::string text = "\n" + group.heading + ":\n";
    for (const Option* option : group.options) {
        const std::string value = option->value_text();
        const std::string names = standing ? option->standing() : fmt::format("{}", fmt::join(option->dashed(), ", "));
        text += entry(names + (value.empty() ? "" : " " + value), option->told(standing));
    }
    return text;
}

std::string options_section(const Verb& verb, bool all) {
    std::string text, left_out;
    for (const OptionGroup& group : verb.groups()) {
        if (all || !group.rare)
            text += option_section(group, group.standing);
        else
            left_out +=
                fmt::format("{}{} ({} options)", left_out.empty() ? "" : ", ", group.heading, group.options.size());
    }
    if (!left_out.empty()) text += fmt::format("\nMore by `{} --help-all`: {}\n", verb.full_name, left_out);
    return text;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

std::string help_text(const Verb& verb, bool all) {
    std::string text = wrapped(verb.help, page_columns, 0) + "\n\n" + usage(verb) + options_section(verb, all);
    if (!verb.steps.empty()) text += "\nVerbs:\n";
    for (const Verb& step : verb.steps) text += entry(step.name, first_line(step.help));
    text += "\nExample:\n  " + verb.full_name + " " + verb.example + "\n";
    if (!verb.steps.empty()) text += fmt::format("\n`{} VERB --help` tells more of each.\n", verb.full_name);
    if (all)
        for (const Verb& step : verb.steps) text += "\n" + std::string(page_columns, '-') + "\n" + help_text(step, all);
    return text;
}

std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent) {
    std::string result;
    std::istringstream paragraphs(text);
    for (std::string paragraph; std::getline(paragraphs, paragraph);) {
        if (!result.empty()) result += "\n" + std::string(indent, ' ');
        std::istringstream words(paragraph);
        std::size_t column = indent;
        for (std::string word; words >> word;) {
            if (column > indent && column + 1 + word.size() > columns) {
                result += "\n" + std::string(indent, ' ');
                column = indent;
            } else if (column > indent) {
                result += ' ';
                ++column;
            }
            result += word;
            column += word.size();
        }
    }
    return result;
}

}  // namespace voxtone::cli
