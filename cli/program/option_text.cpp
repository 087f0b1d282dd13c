// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/option_text.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace voxtone::cli {

namespace {

constexpr std::array rare_headings{std::string_view("Layered profiles"), std::string_view(fine_tuning)};

std::vector<std::string> split(std::string_view text, std::string_view separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(separator, begin);
        parts.emplace_back(text.substr(begin, end - begin));
        if (end == std::string_view::npos) return parts;
        begin = end + separator.size();
    }
}

/// "-o, --out"; "--report, --no-report" for a flag that can be turned off.
std::string names_of_option(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return fmt::format("{}", fmt::join(names, ", "));
}

/// CLI11 writes types as "INT", and rules behind them: "INT:INT in [0 - 1024]", "TEXT:{A,B,C}".
struct TypeAndRule {
    std::string type, rule;
};
TypeAndRule type_and_rule(const CLI::Option& option) {
    const std::string whole = option.get_type_name();
    const std::size_t colon = whole.find(':');
    TypeAndRule parts{whole.substr(0, colon), colon == std::string::npos ? "" : whole.substr(colon + 1)};
    if (parts.type == "INT" || parts.type == "UINT") parts.type = "N";
    if (parts.type == "FLOAT") parts.type = "NUMBER";
    return parts;
}

/// Of "{A,B,C}".
std::vector<std::string> choices_of_rule(const std::string& rule) {
    if (rule.size() < 3 || rule.front() != '{' || rule.back() != '}') return {};
    return split(std::string_view(rule).substr(1, rule.size() - 2), ",");
}

/// Of a help text that ends in "[a|b]", as options say whose words are checked by the job.
std::vector<std::string> choices_of_help(const std::string& help) {
    const std::size_t open = help.rfind('[');
    if (open == std::string::npos || help.find('|', open) == std::string::npos) return {};
    const std::size_t close = help.find(']', open);
    if (close == std::string::npos) return {};
    return split(std::string_view(help).substr(open + 1, close - open - 1), "|");
}

/// "0 to 1024" of "INT in [0 - 1024]".
std::string range_of_rule(const std::string& rule) {
    const std::size_t open = rule.find(" in ["), dash = rule.find(" - ", open);
    if (open == std::string::npos || dash == std::string::npos || rule.back() != ']') return {};
    return rule.substr(open + 5, dash - open - 5) + " to " + rule.substr(dash + 3, rule.size() - dash - 4);
}

/// What stands in brackets behind the help: choices that it does not list itself, the range, the default.
std::string rules_of_option(const CLI::Option& option, const TypeAndRule& type, bool positional) {
    std::vector<std::string> rules;
    if (const auto choices = choices_of_rule(type.rule); !choices.empty())
        rules.push_back(fmt::format("{}", fmt::join(choices, ", ")));
    if (const std::string range = range_of_rule(type.rule); !range.empty()) rules.push_back(range);
    if (option.get_required() && !positional) rules.emplace_back("required");
    std::string usual = option.get_default_str();
    if (option.get_items_expected_max() == 0) usual = usual == "true" ? "on" : "";
    if (usual.size() > 1 && usual.front() == '[' && usual.back() == ']') usual = usual.substr(1, usual.size() - 2);
    if (!usual.empty() && usual != "\"\"") rules.push_back("default: " + usual);
    return rules.empty() ? "" : fmt::format(" ({})", fmt::join(rules, "; "));
}

}  // namespace

OptionText option_text(const CLI::Option& option, bool positional) {
    const TypeAndRule type = type_and_rule(option);
    OptionText text;
    text.names = positional ? option.get_name(true) : names_of_option(option);
    if (option.get_items_expected_max() > 0) text.value = type.type;
    if (option.get_items_expected_max() >= CLI::detail::expected_max_vector_size && !option.get_delimiter())
        text.value += "...";
    text.choices = choices_of_rule(type.rule);
    if (text.choices.empty()) text.choices = choices_of_help(option.get_description());
    text.help = option.get_description() + rules_of_option(option, type, positional);
    return text;
}

std::vector<OptionGroup> option_groups(const CLI::App& command) {
    std::vector<OptionGroup> groups;
    OptionGroup positionals{"Arguments", false, {}};
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional() && !option->get_group().empty())
            positionals.options.push_back(option_text(*option, true));
    if (!positionals.options.empty()) groups.push_back(positionals);
    for (const std::string& heading : command.get_groups()) {
        OptionGroup group{
            heading, std::find(rare_headings.begin(), rare_headings.end(), heading) != rare_headings.end(), {}};
        for (const CLI::Option* option : command.get_options())
            if (option->get_group() == heading && option->nonpositional())
                group.options.push_back(option_text(*option, false));
        if (!heading.empty() && !group.options.empty()) groups.push_back(std::move(group));
    }
    return groups;
}

}  // namespace voxtone::cli
