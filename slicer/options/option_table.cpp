// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_table.h"

#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/units.h"
#include "slicer/options/option_values.h"
#include "slicer/options/table_of_body.h"
#include "slicer/options/table_of_colour.h"
#include "slicer/options/table_of_layers.h"
#include "slicer/options/table_of_run.h"

namespace voxtone::slicer {

namespace {

using Kind = OptionSpec::Kind;

void expect_choice(const OptionSpec& spec, const std::string& value) {
    if (!spec.choices.empty() && std::ranges::find(spec.choices, value) == spec.choices.end())
        refuse_choice(spec.option, value, spec.choices);
}

/// The kind, the text and the value of each type of member.
struct MemberKind {
    Kind operator()(std::monostate) const { return Kind::text; }
    Kind operator()(std::string SliceOptions::*) const { return Kind::text; }
    Kind operator()(std::vector<std::string> SliceOptions::*) const { return Kind::list; }
    Kind operator()(bool SliceOptions::*) const { return Kind::flag; }
    Kind operator()(OptionSpec::Length) const { return Kind::length; }
    template <class Number>
    Kind operator()(Number SliceOptions::*) const {
        return Kind::number;
    }
};

struct MemberText {
    const OptionSpec& spec;
    const SliceOptions& options;

    std::string operator()(std::monostate) const {
        for (const OptionSpec::Preset& preset : spec.presets)
            if (std::ranges::all_of(preset.values,
                                    [&](const auto& at) { return find_option(at.first)->get(options) == at.second; }))
                return preset.name;
        return {};
    }
    std::string operator()(std::string SliceOptions::*text) const { return options.*text; }
    std::string operator()(std::vector<std::string> SliceOptions::*list) const {
        return fmt::format("{}", fmt::join(options.*list, ","));
    }
    std::string operator()(bool SliceOptions::*flag) const { return options.*flag ? "true" : "false"; }
    std::string operator()(OptionSpec::Length length) const { return fmt::format("{}mm", options.*length.mm); }
    template <class Number>
    std::string operator()(Number SliceOptions::*number) const {
        return fmt::format("{}", options.*number);
    }
};

struct MemberSetter {
    const OptionSpec& spec;
    SliceOptions& options;
    const std::string& value;

    void operator()(std::monostate) const {
        expect_choice(spec, value);
        for (const OptionSpec::Preset& preset : spec.presets)
            if (preset.name == value)
                for (const auto& [key, set] : preset.values) find_option(key)->set(options, set);
    }
    void operator()(std::string SliceOptions::*text) const {
        expect_choice(spec, value);
        options.*text = value;
    }
    void operator()(std::vector<std::string> SliceOptions::*list) const {
        const std::vector<std::string> parts = parse_list(value);
        for (const std::string& part : parts) expect_choice(spec, part);
        if (std::set<std::string>(parts.begin(), parts.end()).size() != parts.size())
            throw UsageError(fmt::format("--{}: '{}' names something twice", spec.option, value));
        options.*list = parts;
    }
    void operator()(bool SliceOptions::*flag) const { options.*flag = parse_flag(spec.option, value); }
    void operator()(OptionSpec::Length length) const {
        options.*length.mm = parse_length_mm(value, "--" + spec.option);
    }
    template <class Number>
    void operator()(Number SliceOptions::*number) const {
        options.*number = parse_number<Number>(spec.option, value);
    }
};

std::vector<OptionSpec> whole_table() {
    std::vector<OptionSpec> table;
    for (std::vector<OptionSpec> part : {table_of_body(), table_of_colour(), table_of_layers(), table_of_run()})
        table.insert(table.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
    for (OptionSpec& spec : table) {
        if (spec.option.empty()) spec.option = spec.key;
        VOXTONE_EXPECT(spec.is_preset() == std::holds_alternative<std::monostate>(spec.member));
    }
    return table;
}

}  // namespace

Kind OptionSpec::kind() const { return std::visit(MemberKind{}, member); }

std::string OptionSpec::get(const SliceOptions& options) const {
    return std::visit(MemberText{*this, options}, member);
}

void OptionSpec::set(SliceOptions& options, const std::string& value) const {
    std::visit(MemberSetter{*this, options, value}, member);
}

std::span<const OptionSpec> slice_option_table() {
    static const std::vector<OptionSpec> table = whole_table();
    return table;
}

const OptionSpec* find_option(std::string_view key) {
    for (const OptionSpec& spec : slice_option_table())
        if (spec.key == key) return &spec;
    return nullptr;
}

const OptionSpec* find_former_key(std::string_view key) {
    for (const OptionSpec& spec : slice_option_table())
        if (!spec.former_key.empty() && spec.former_key == key) return &spec;
    return nullptr;
}

std::vector<std::string> option_keys() {
    std::vector<std::string> keys, former;
    for (const OptionSpec& spec : slice_option_table()) {
        keys.push_back(spec.key);
        if (!spec.former_key.empty()) former.push_back(spec.former_key);
    }
    keys.insert(keys.end(), former.begin(), former.end());
    return keys;
}

std::string deciding_lines(const SliceOptions& options, Decides least, std::span<const OptionSpec> table) {
    const SliceOptions defaults;
    std::string lines;
    for (const OptionSpec& spec : table) {
        if (spec.decides > least || spec.names != OptionSpec::Names::nothing || spec.is_preset()) continue;
        const std::string value = spec.get(options);
        if (value != spec.get(defaults)) lines += fmt::format("{}={}\n", spec.key, value);
    }
    return lines;
}

std::vector<std::string> predict_choices() {
    std::vector<std::string> choices{std::string(predict_auto), std::string(predict_none)};
    for (const std::string& model : names_of<PredictionModel>()) choices.push_back(model);
    return choices;
}

}  // namespace voxtone::slicer
