// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_spec.h"

#include <algorithm>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/units.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

using Kind = OptionSpec::Kind;

/// The kind, the text and the value of each type of member.
struct MemberKind {
    Kind operator()(std::monostate) const { return Kind::text; }
    Kind operator()(const OptionSpec::Other& other) const { return other.kind; }
    Kind operator()(std::string SliceOptions::*) const { return Kind::text; }
    Kind operator()(std::vector<std::string> SliceOptions::*) const { return Kind::list; }
    Kind operator()(OptionSpec::Texts) const { return Kind::texts; }
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

    std::string operator()(std::monostate) const { return spec.get_preset ? spec.get_preset(options) : std::string(); }
    std::string operator()(const OptionSpec::Other& other) const {
        const auto said = options.other.find(spec.key);
        return said == options.other.end() ? other.usual : said->second;
    }
    std::string operator()(std::string SliceOptions::*text) const { return options.*text; }
    std::string operator()(std::vector<std::string> SliceOptions::*list) const {
        return fmt::format("{}", fmt::join(options.*list, ","));
    }
    std::string operator()(OptionSpec::Texts list) const {
        return fmt::format("{}", fmt::join(options.*list.texts, "\n"));
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
        spec.expect_choice(value);
        for (const OptionSpec::Preset& preset : spec.presets)
            if (preset.name == value && spec.set_preset) spec.set_preset(options, preset);
    }
    void operator()(std::string SliceOptions::*text) const {
        spec.expect_choice(value);
        options.*text = value;
    }
    void operator()(const OptionSpec::Other& other) const {
        std::string text = other_text(other);
        if (text == other.usual)
            options.other.erase(spec.key);
        else
            options.other[spec.key] = std::move(text);
    }
    void operator()(std::vector<std::string> SliceOptions::*list) const { options.*list = parts_of_list(); }
    void operator()(OptionSpec::Texts list) const {
        std::vector<std::string> texts;
        for (std::size_t begin = 0; begin < value.size();) {
            const std::size_t end = std::min(value.find('\n', begin), value.size());
            if (end > begin) texts.push_back(value.substr(begin, end - begin));
            begin = end + 1;
        }
        options.*list.texts = texts;
    }
    void operator()(bool SliceOptions::*flag) const { options.*flag = parse_flag(spec.key, value); }
    void operator()(OptionSpec::Length length) const { options.*length.mm = parse_length_mm(value, "--" + spec.key); }
    void operator()(double SliceOptions::*number) const {
        const std::string what = "--" + spec.key;
        options.*number = spec.metavar == "GIB" ? parse_memory_gib(value, what)
                          : spec.metavar == "S" ? parse_time_s(value, what)
                                                : parse_number<double>(spec.key, value);
    }
    template <class Number>
    void operator()(Number SliceOptions::*number) const {
        options.*number = parse_number<Number>(spec.key, value);
    }

private:
    [[nodiscard]] std::vector<std::string> parts_of_list() const {
        std::vector<std::string> parts = parse_list(value);
        for (const std::string& part : parts) spec.expect_choice(part);
        if (std::set<std::string>(parts.begin(), parts.end()).size() != parts.size())
            throw UsageError(fmt::format("--{}: '{}' names something twice", spec.key, value));
        return parts;
    }
    /// Two spellings of one value are one job.
    [[nodiscard]] std::string other_text(const OptionSpec::Other& other) const {
        switch (other.kind) {
            case Kind::flag:
                return parse_flag(spec.key, value) ? "true" : "false";
            case Kind::length:
                return fmt::format("{}mm", parse_length_mm(value, "--" + spec.key));
            case Kind::number:
                return other.whole ? fmt::format("{}", parse_number<std::uint32_t>(spec.key, value))
                                   : fmt::format("{}", parse_number<double>(spec.key, value));
            case Kind::list:
                return fmt::format("{}", fmt::join(parts_of_list(), ","));
            default:
                spec.expect_choice(value);
                return value;
        }
    }
};

}  // namespace

Kind OptionSpec::kind() const { return std::visit(MemberKind{}, member); }

std::string OptionSpec::get(const SliceOptions& options) const {
    return std::visit(MemberText{*this, options}, member);
}

void OptionSpec::set(SliceOptions& options, const std::string& value) const {
    std::visit(MemberSetter{*this, options, value}, member);
}

void OptionSpec::expect_choice(const std::string& value) const {
    if (!choices.empty() && std::ranges::find(choices, value) == choices.end()) refuse_choice(key, value, choices);
}

bool OptionSpec::is_of_another(const SliceOptions& options) const {
    return std::holds_alternative<Other>(member) && !belongs_to(options.show);
}

std::vector<std::string> predict_choices() {
    std::vector<std::string> choices{std::string(predict_auto), std::string(predict_none)};
    for (const std::string& model : names_of<PredictionModel>()) choices.push_back(model);
    return choices;
}

}  // namespace voxtone::slicer
