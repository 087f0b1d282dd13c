// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/verb.h"

#include <algorithm>
#include <array>
#include <span>
#include <sstream>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace voxtone::cli {

namespace {

constexpr std::array rare_headings{std::string_view("Layered profiles"), std::string_view(fine_tuning)};

/// 1000000 and 0.1, where {:g} would write 1e+06.
std::string bound(double value) {
    return value == std::int64_t(value) ? fmt::format("{}", std::int64_t(value)) : fmt::format("{:g}", value);
}

std::vector<std::string> split_names(const std::string& names) {
    std::vector<std::string> parts;
    std::istringstream rest(names);
    for (std::string part; std::getline(rest, part, ',');) parts.push_back(part);
    return parts;
}

/// What stands for the value.
struct UnitOf {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(const bool*) const { return {}; }
    std::string operator()(Length) const { return "LENGTH"; }
    std::string operator()(OptionalLength) const { return "LENGTH"; }
    std::string operator()(Memory) const { return "GIB"; }
    std::string operator()(Time) const { return "S"; }
    std::string operator()(const double*) const { return "NUMBER"; }
    std::string operator()(const std::optional<double>*) const { return "NUMBER"; }
    std::string operator()(const std::vector<double>*) const { return "NUMBER"; }
    std::string operator()(const std::array<double, 2>*) const { return "NUMBER"; }
    std::string operator()(const std::string*) const { return "TEXT"; }
    std::string operator()(const std::filesystem::path*) const { return "TEXT"; }
    std::string operator()(const std::vector<std::string>*) const { return "TEXT"; }
    std::string operator()(const std::vector<std::filesystem::path>*) const { return "TEXT"; }
    template <class Whole>
    std::string operator()(const Whole*) const {
        return "N";
    }
};

std::string joined(std::span<const double> numbers) {
    std::string text;
    for (const double number : numbers) text += fmt::format("{}{:g}", text.empty() ? "" : ",", number);
    return text;
}

struct DefaultOf {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
    std::string operator()(Length value) const { return *value.mm == 0 ? "0" : fmt::format("{:g}mm", *value.mm); }
    std::string operator()(OptionalLength) const { return {}; }
    std::string operator()(Memory value) const { return fmt::format("{:g}", *value.gib); }
    std::string operator()(Time value) const { return fmt::format("{:g}", *value.seconds); }
    std::string operator()(const double* value) const { return fmt::format("{:g}", *value); }
    std::string operator()(const std::string* value) const { return *value; }
    std::string operator()(const std::filesystem::path* value) const { return value->string(); }
    template <class Type>
    std::string operator()(const std::optional<Type>*) const {
        return {};
    }
    std::string operator()(const std::vector<std::filesystem::path>*) const { return {}; }
    std::string operator()(const std::vector<double>* value) const { return joined(*value); }
    std::string operator()(const std::array<double, 2>* value) const { return joined(*value); }
    template <class Type>
    std::string operator()(const std::vector<Type>* value) const {
        return fmt::format("{}", fmt::join(*value, ","));
    }
    template <class Whole>
    std::string operator()(const Whole* value) const {
        return fmt::format("{}", *value);
    }
};

}  // namespace

std::string Range::text() const {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (least == -none && most == none) return {};
    return most == none ? "at least " + bound(least) : bound(least) + " to " + bound(most);
}

std::vector<std::string> Option::dashed() const {
    std::vector<std::string> dashed = split_names(names);
    std::erase_if(dashed, [](const std::string& part) { return !part.starts_with('-'); });
    if (rules.off) dashed.push_back("--no-" + name());
    return dashed;
}

std::string Option::standing() const { return names.starts_with('-') ? "" : names.substr(0, names.find(',')); }

std::string Option::name() const {
    if (const std::size_t at = names.find("--"); at != std::string::npos)
        return names.substr(at + 2, names.find(',', at) - at - 2);
    return names;
}

std::string Option::shown() const { return names.find("--") == std::string::npos ? names : "--" + name(); }

bool Option::is_flag() const {
    return std::holds_alternative<std::monostate>(value) || std::holds_alternative<bool*>(value);
}

bool Option::is_list() const {
    return std::visit(
        [](auto to) {
            return requires { to->begin(); }
            &&!std::is_same_v<decltype(to), std::string*> && !std::is_same_v<decltype(to), std::array<double, 2>*> &&
                !std::is_same_v<decltype(to), std::filesystem::path*>;
        },
        value);
}

bool Option::is_whole_number() const { return std::visit(UnitOf{}, value) == "N"; }

std::string Option::value_text() const {
    if (is_flag()) return {};
    const std::string text = rules.unit.empty() ? std::visit(UnitOf{}, value) : rules.unit;
    return is_many() && rules.separator == 0 ? text + "..." : text;
}

std::string Option::usual() const {
    if (!rules.usual.empty() || rules.required || (is_flag() && !rules.off)) return rules.usual;
    return std::visit(DefaultOf{}, value);
}

std::string Option::told(bool alone) const {
    std::vector<std::string> said;
    if (!rules.choices.empty()) said.push_back(fmt::format("{}", fmt::join(rules.choices, ", ")));
    if (const std::string range = rules.range.text(); !range.empty()) said.push_back(range);
    if (rules.required && !alone) said.emplace_back("required");
    std::string by_default = usual();
    if (is_flag()) by_default = by_default == "true" ? "on" : "";
    if (!by_default.empty()) said.push_back("default: " + by_default);
    return said.empty() ? help : fmt::format("{} ({})", help, fmt::join(said, "; "));
}

Verb::Verb(std::string called, std::string what, std::string tried)
    : name(std::move(called)), help(std::move(what)), example(std::move(tried)) {
    add_row({"-h,--help", {}, "print this and stop", {}});
    add_row({"--help-all", {}, "print this with the options that few need, and stop", {}});
}

void Verb::add_row(Option option) {
    if (option.rules.group.empty()) option.rules.group = heading_;
    options.push_back(std::move(option));
}

std::vector<OptionGroup> Verb::groups() const {
    std::vector<OptionGroup> groups;
    OptionGroup standing{"Arguments", false, true, {}};
    for (const Option& option : options) {
        if (!option.standing().empty()) standing.options.push_back(&option);
        if (option.dashed().empty()) continue;
        const std::string& heading = option.rules.group;
        auto group = std::ranges::find(groups, heading, &OptionGroup::heading);
        if (group == groups.end())
            group = groups.insert(
                group, {heading, std::ranges::find(rare_headings, heading) != rare_headings.end(), false, {}});
        group->options.push_back(&option);
    }
    if (!standing.options.empty()) groups.insert(groups.begin(), standing);
    return groups;
}

const Option* Verb::find(const std::string& dashed) const {
    for (const Option& option : options)
        if (const auto names = option.dashed(); std::ranges::find(names, dashed) != names.end()) return &option;
    return nullptr;
}

const Verb* Verb::step(const std::string& called) const {
    const auto found = std::ranges::find(steps, called, &Verb::name);
    return found == steps.end() ? nullptr : &*found;
}

void Verb::settle(const std::string& parent) {
    full_name = parent.empty() ? name : parent + " " + name;
    for (Verb& step : steps) step.settle(full_name);
}

}  // namespace voxtone::cli
