// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/help.h"

#include <memory>
#include <sstream>

#include <fmt/core.h>

#include "cli/program/option_text.h"
#include "cli/program/words.h"

namespace voxtone::cli {

namespace {

constexpr std::size_t page_columns = 100, help_column = 30;

std::string entry(const std::string& head, const std::string& help) {
    const std::string first = "  " + head;
    const std::string text = wrapped(help, page_columns, help_column);
    if (first.size() + 2 > help_column) return first + "\n" + std::string(help_column, ' ') + text + "\n";
    return first + std::string(help_column - first.size(), ' ') + text + "\n";
}

std::string usage(const CLI::App& command) {
    std::string text = "Usage: " + full_name(command) + " [OPTIONS]";
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_positional()) continue;
        const bool many = option->get_items_expected_max() >= CLI::detail::expected_max_vector_size;
        const std::string name = option->get_name(true) + (many ? "..." : "");
        text += option->get_required() ? " " + name : " [" + name + "]";
    }
    return text + (command.get_subcommands({}).empty() ? "\n" : " VERB\n");
}

std::string option_section(const OptionGroup& group) {
    std::string text = "\n" + group.heading + ":\n";
    for (const OptionText& option : group.options)
        text += entry(option.names + (option.value.empty() ? "" : " " + option.value), option.help);
    return text;
}

std::string options_section(const CLI::App& command, bool all) {
    std::string text, left_out;
    for (const OptionGroup& group : option_groups(command)) {
        if (all || !group.rare)
            text += option_section(group);
        else
            left_out +=
                fmt::format("{}{} ({} options)", left_out.empty() ? "" : ", ", group.heading, group.options.size());
    }
    if (!left_out.empty()) text += fmt::format("\nMore by `{} --help-all`: {}\n", full_name(command), left_out);
    return text;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

class HelpFormatter final : public CLI::FormatterBase {
public:
    std::string make_help(const CLI::App* command, std::string, CLI::AppFormatMode mode) const override {
        const bool all = mode != CLI::AppFormatMode::Normal;
        std::string text = wrapped(command->get_description(), page_columns, 0) + "\n\n" + usage(*command);
        text += options_section(*command, all);
        const auto verbs = command->get_subcommands({});
        if (!verbs.empty()) text += "\nVerbs:\n";
        for (const CLI::App* verb : verbs) text += entry(verb->get_name(), first_line(verb->get_description()));
        if (!command->get_footer().empty()) text += "\nExample:\n  " + command->get_footer() + "\n";
        if (!verbs.empty()) text += fmt::format("\n`{} VERB --help` tells more of each.\n", full_name(*command));
        if (all)
            for (const CLI::App* verb : verbs)
                text += "\n" + std::string(page_columns, '-') + "\n" + make_help(verb, "", mode);
        return text;
    }
};

}  // namespace

void set_up_help(CLI::App& program) {
    program.formatter(std::make_shared<HelpFormatter>());
    program.set_help_flag("-h,--help", "print this and stop");
    program.set_help_all_flag("--help-all", "print this with the options that few need, and stop");
}

void add_example(CLI::App& command, const std::string& arguments) {
    command.footer(full_name(command) + " " + arguments);
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
