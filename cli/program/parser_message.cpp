// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/parser_message.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/units.h"

namespace voxtone::cli {

namespace {

/// Where the text has this name of an option, and not a longer one; npos: nowhere.
std::size_t place_of_name(const std::string& text, const std::string& name) {
    const auto goes_on = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
    if (name.empty()) return std::string::npos;
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if ((at == 0 || !goes_on(text[at - 1])) && (end == text.size() || !goes_on(text[end]))) return at;
    }
    return std::string::npos;
}

/// The options that CLI11's sentence names, in its order.
std::vector<const CLI::Option*> named_options(const CLI::App& command, const std::string& text) {
    std::vector<std::pair<std::size_t, const CLI::Option*>> found;
    for (const CLI::Option* option : command.get_options())
        if (const std::size_t at = place_of_name(text, option->get_name()); at != std::string::npos)
            found.emplace_back(at, option);
    std::sort(found.begin(), found.end());
    std::vector<const CLI::Option*> options;
    for (const auto& [at, option] : found) options.push_back(option);
    return options;
}

std::string values_of(const CLI::Option& option) { return fmt::format("{}", fmt::join(option.results(), ", ")); }

/// "{a,b}" behind `mark`, with blanks; empty: the text has none.
std::string set_behind(const std::string& text, const std::string& mark) {
    const std::size_t begin = text.find(mark);
    if (begin == std::string::npos || text.back() != '}') return {};
    std::string set;
    for (const char c : text.substr(begin + mark.size(), text.size() - begin - mark.size() - 1))
        set += c == ',' ? std::string(", ") : std::string(1, c);
    return set;
}

/// "0 to 1000" for "0.000000 to 1000.000000".
std::string without_zeros(std::string range) {
    const std::string zeros = ".000000";
    for (std::size_t at = 0; (at = range.find(zeros)) != std::string::npos;) range.erase(at, zeros.size());
    return range;
}

/// "NAME: foo not in {a,b}" and "NAME: Value 7 not in range 0 to 5".
std::string rule_message(const CLI::Option& option, const std::string& text) {
    const std::string name = option.get_name(), said = text.substr(std::min(text.size(), name.size() + 2));
    if (const std::string set = set_behind(said, " not in {"); !set.empty())
        return fmt::format("{}: '{}' is none of {}", name, said.substr(0, said.find(" not in {")), set);
    const std::string value = "Value ", range = " not in range ";
    const std::size_t at = said.find(range);
    if (said.starts_with(value) && at != std::string::npos)
        return fmt::format("{}: {} is not {}", name, said.substr(value.size(), at - value.size()),
                           without_zeros(said.substr(at + range.size())));
    return fmt::format("{}: {}", name, said);
}

std::string conversion_message(const CLI::Option& option) {
    const std::string name = option.get_name(), values = values_of(option);
    if (option.get_items_expected_max() == 0)
        return fmt::format("{} is on or off: it takes no value but true or false", name);
    const bool whole = option.get_type_name().starts_with("INT") || option.get_type_name().starts_with("UINT") ||
                       option.get_type_name() == "N";
    const std::string message =
        fmt::format("{}: '{}' is not {}", name, values, whole ? "a whole number that it can be" : "a number");
    const std::string point = with_decimal_point(values);
    return point.empty() ? message : message + " (decimals stand behind a point: " + point + ")";
}

std::string count_message(const CLI::Option& option) {
    const std::string name = option.get_name();
    const int least = option.get_items_expected_min(), most = option.get_items_expected_max();
    const std::size_t given = option.results().size();
    if (given == 0 && most <= 1) return fmt::format("{}: its value is missing", name);
    if (most <= 1)
        return fmt::format("{} is given {} times ({}), and only one can count: leave the others out", name, given,
                           values_of(option));
    const std::string wanted = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    return fmt::format("{} wants {} values, one behind the other or with commas between, and has {}{}", name, wanted,
                       given, given == 0 ? "" : ": " + values_of(option));
}

}  // namespace

std::string parser_message(const CLI::App& command, const CLI::ParseError& error) {
    const std::string text = error.what();
    const std::vector<const CLI::Option*> options = named_options(command, text);
    if (options.empty()) return fmt::format("the options cannot be understood ({})", text);
    const CLI::Option& option = *options.front();
    const std::string name = option.get_name(), other = options.size() > 1 ? options[1]->get_name() : "another option";
    if (dynamic_cast<const CLI::RequiredError*>(&error))
        return fmt::format("{} is required: {}", name, option.get_description());
    if (dynamic_cast<const CLI::RequiresError*>(&error))
        return fmt::format("{} only goes with {}: give both, or leave it out", name, other);
    if (dynamic_cast<const CLI::ExcludesError*>(&error))
        return fmt::format("{} does not go with {}: leave one of them out", name, other);
    if (dynamic_cast<const CLI::ValidationError*>(&error)) return rule_message(option, text);
    if (dynamic_cast<const CLI::ConversionError*>(&error)) return conversion_message(option);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return count_message(option);
    return fmt::format("{} cannot be understood ({})", name, text);
}

}  // namespace voxtone::cli
