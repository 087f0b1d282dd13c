// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/parser.h"

#include <algorithm>
#include <cctype>
#include <list>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/units.h"

namespace voxtone::cli {

namespace {

/// An option while a command line is parsed.
struct Declared {
    const Option* option;
    CLI::Option* parsed = nullptr;
    std::string text{};  ///< of a length
};

/// A number in its unit, as the parser takes it. Empty: it is one; else what is wrong.
std::string to_number(std::string& text, const std::string& name, double (*parse)(std::string_view, std::string_view)) {
    try {
        text = fmt::format("{}", parse(text, name));
        return {};
    } catch (const UsageError& error) {
        return std::string(error.what()).substr(name.size() + 2);  // it is named once more
    }
}

struct Declare {
    CLI::App& app;
    Declared& to;
    std::string names;

    CLI::Option* operator()(std::monostate) const { return app.add_flag(names); }
    CLI::Option* operator()(bool* value) const { return app.add_flag(names, *value); }
    CLI::Option* operator()(Length) const { return app.add_option(names, to.text); }
    CLI::Option* operator()(OptionalLength) const { return app.add_option(names, to.text); }
    CLI::Option* operator()(Memory value) const { return in_units(*value.gib, parse_memory_gib); }
    CLI::Option* operator()(Time value) const { return in_units(*value.seconds, parse_time_s); }
    template <class Type>
    CLI::Option* operator()(Type* value) const {
        return app.add_option(names, *value);
    }

private:
    CLI::Option* in_units(double& value, double (*parse)(std::string_view, std::string_view)) const {
        const auto convert = [=, name = to.option->shown()](std::string& text) { return to_number(text, name, parse); };
        return app.add_option(names, value)->transform(CLI::Validator(convert, ""));
    }
};

std::string refusal(const OptionRules& rules, const std::string& text) {
    if (!rules.choices.empty() && !rules.verb_checks && std::ranges::find(rules.choices, text) == rules.choices.end())
        return fmt::format("'{}' is none of {}", text, fmt::join(rules.choices, ", "));
    double number = 0;
    if (const std::string range = rules.range.text();
        !range.empty() && CLI::detail::lexical_cast(text, number) && !rules.range.holds(number))
        return fmt::format("{} is not {}", text, range);
    return {};
}

void declare(CLI::App& app, Declared& to) {
    const Option& option = *to.option;
    const OptionRules& rules = option.rules;
    const std::string names = rules.off ? fmt::format("{0},!--no-{1}", option.names, option.name()) : option.names;
    to.parsed = std::visit(Declare{app, to, names}, option.value);
    if (option.is_flag()) return;
    to.parsed->check(CLI::Validator([&rules](std::string& text) { return refusal(rules, text); }, ""));
    if (option.is_list() && rules.one_each) to.parsed->allow_extra_args(false);
    if (rules.separator != 0) to.parsed->delimiter(rules.separator);
    if (rules.count.second > 0) to.parsed->expected(rules.count.first, rules.count.second);
    if (rules.bare) to.parsed->expected(0, 1);
}

/// A verb while a command line is parsed, and its steps.
struct Parser {
    CLI::App& app;
    const Verb& verb;
    std::list<Declared> options;  // lists: the parser keeps references
    std::list<Parser> steps;

    Parser(CLI::App& parsed, const Verb& named) : app(parsed), verb(named) {
        app.set_help_flag("-h,--help");
        app.set_help_all_flag("--help-all");
        for (const Option& option : verb.options)
            if (!std::holds_alternative<std::monostate>(option.value))
                declare(app, options.emplace_back(Declared{&option}));
        for (const Verb& step : verb.steps) steps.emplace_back(*app.add_subcommand(step.name), step);
        if (!verb.steps.empty()) app.require_subcommand(1);
    }

    const Parser& deepest() const {
        for (const Parser& step : steps)
            if (step.app.parsed()) return step.deepest();
        return *this;
    }
};

bool is_said(const Verb& verb, const std::string& shown) {
    const Option* const option = verb.find(shown);
    return option && verb.said->contains(option->name());
}

void set_lengths(const Declared& of) {
    if (of.text.empty()) return;
    if (const auto* const to = std::get_if<Length>(&of.option->value))
        *to->mm = parse_length_mm(of.text, of.option->shown());
    if (const auto* const to = std::get_if<OptionalLength>(&of.option->value))
        *to->mm = parse_length_mm(of.text, of.option->shown());
}

std::string tells_more(const Verb& verb, const std::string& message) {
    return fmt::format("{}; `{} --help` tells more", message, verb.full_name);
}

void expect_together(const Verb& verb, const Option& option) {
    const std::string name = option.shown();
    const OptionRules& rules = option.rules;
    const bool said = verb.said->contains(option.name());
    if (rules.required && !said)
        throw UsageError(tells_more(verb, fmt::format("{} is required: {}", name, option.help)));
    if (said && !rules.needs.empty() && !is_said(verb, rules.needs))
        throw UsageError(
            tells_more(verb, fmt::format("{} only goes with {}: give both, or leave it out", name, rules.needs)));
    if (said && !rules.not_with.empty() && is_said(verb, rules.not_with))
        throw UsageError(
            tells_more(verb, fmt::format("{} does not go with {}: leave one of them out", name, rules.not_with)));
}

void take(const Parser& parser) {
    for (const Declared& of : parser.options)
        if (of.parsed->count() > 0) parser.verb.said->insert(of.option->name());
    for (const Declared& of : parser.options) expect_together(parser.verb, *of.option);
    for (const Declared& of : parser.options) set_lengths(of);
}

/// Where the text has this name of an option, and not a longer one; npos: nowhere.
std::size_t place_of_name(const std::string& text, const std::string& name) {
    const auto goes_on = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if ((at == 0 || !goes_on(text[at - 1])) && (end == text.size() || !goes_on(text[end]))) return at;
    }
    return std::string::npos;
}

/// The option that CLI11's sentence names first; null: none.
const Declared* named_option(const Parser& parser, const std::string& text) {
    const Declared* first = nullptr;
    std::size_t begin = std::string::npos;
    for (const Declared& of : parser.options)
        if (const std::size_t at = place_of_name(text, of.parsed->get_name()); at < begin) begin = at, first = &of;
    return first;
}

std::string conversion_message(const Declared& of, const std::string& name) {
    const std::string values = fmt::format("{}", fmt::join(of.parsed->results(), ", "));
    if (of.option->is_flag()) return fmt::format("{} is on or off: it takes no value but true or false", name);
    const std::string message =
        fmt::format("{}: '{}' is not {}", name, values,
                    of.option->is_whole_number() ? "a whole number that it can be" : "a number");
    const std::string point = with_decimal_point(values);
    return point.empty() ? message : message + " (decimals stand behind a point: " + point + ")";
}

std::string count_message(const Declared& of, const std::string& name) {
    const int least = of.parsed->get_items_expected_min(), most = of.parsed->get_items_expected_max();
    const std::size_t given = of.parsed->results().size();
    const std::string values = fmt::format("{}", fmt::join(of.parsed->results(), ", "));
    if (given == 0 && most <= 1) return fmt::format("{}: its value is missing", name);
    if (most <= 1)
        return fmt::format("{} is given {} times ({}), and only one can count: leave the others out", name, given,
                           values);
    const std::string wanted = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    return fmt::format("{} wants {} values, one behind the other or with commas between, and has {}{}", name, wanted,
                       given, given == 0 ? "" : ": " + values);
}

/// One sentence for every kind of error but words that are too many.
std::string message(const Parser& parser, const CLI::ParseError& error) {
    const std::string text = error.what();
    const Declared* const of = named_option(parser, text);
    if (!of) return fmt::format("the options cannot be understood ({})", text);
    const std::string name = of->option->shown();
    if (dynamic_cast<const CLI::ValidationError*>(&error)) return text;  // ours, behind the name
    if (dynamic_cast<const CLI::ConversionError*>(&error)) return conversion_message(*of, name);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return count_message(*of, name);
    return fmt::format("{} cannot be understood ({})", name, text);
}

}  // namespace

Asked parse(const Verb& program, const Words& words) {
    CLI::App app("", program.name);
    app.set_version_flag("--version", "");
    const Parser parser(app, program);
    using What = Asked::What;
    try {
        app.parse(Words(words.rbegin(), words.rend()));  // CLI11 takes them from the back
    } catch (const CLI::CallForAllHelp&) {
        return {What::help_all, &parser.deepest().verb};
    } catch (const CLI::CallForHelp&) {
        return {What::help, &parser.deepest().verb};
    } catch (const CLI::CallForVersion&) {
        return {What::version, &program};
    } catch (const CLI::ParseError& error) {
        const Verb& verb = parser.deepest().verb;
        const std::vector<std::string> extras = app.remaining(true);
        if (const std::string what = unknown_words(verb, extras, dynamic_cast<const CLI::ExtrasError*>(&error));
            !what.empty())
            throw UsageError(what);
        throw UsageError(tells_more(verb, message(parser.deepest(), error)));
    }
    take(parser.deepest());
    return {What::run, &parser.deepest().verb};
}

}  // namespace voxtone::cli
