// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one table of options: what a verb is called, what it takes, what it does. The parser, --help, the manual, the
// shells' completion and --help-json (and by that Python's wrapper and the page of `serve`) are made of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace voxtone::cli {

/// Numbers that are written with their unit (base/units.h): lengths ("60mm"), memory ("2GiB"; a bare number is in GiB)
/// and times ("2min"; a bare number is in s).
struct Length {
    double* mm;
};
/// Not given or empty: nothing.
struct OptionalLength {
    std::optional<double>* mm;
};
struct Memory {
    double* gib;
};
struct Time {
    double* seconds;
};
[[nodiscard]] inline Length length(double& mm) { return {&mm}; }
[[nodiscard]] inline OptionalLength length(std::optional<double>& mm) { return {&mm}; }
[[nodiscard]] inline Memory memory(double& gib) { return {&gib}; }
[[nodiscard]] inline Time time(double& seconds) { return {&seconds}; }

/// Where a value goes, which says what it may be and what it is by default. monostate: nowhere, the parser itself does
/// what it asks for.
using OptionValue =
    std::variant<std::monostate, bool*, std::string*, std::filesystem::path*, int*, std::uint32_t*, std::uint64_t*,
                 double*, std::optional<double>*, std::optional<std::uint64_t>*, Length, OptionalLength, Memory, Time,
                 std::vector<std::string>*, std::vector<std::filesystem::path>*, std::vector<double>*,
                 std::vector<std::uint32_t>*, std::array<double, 2>*>;

struct Range {
    double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
    [[nodiscard]] bool holds(double value) const { return value >= least && value <= most; }
    /// "0 to 1024", "at least 0"; empty: any number.
    [[nodiscard]] std::string text() const;
};

/// What is seldom said of an option.
struct OptionRules {
    std::string unit{};                  ///< stands for the value: "FILE"; empty: by the value's kind
    Range range{};                       ///< of a number
    std::vector<std::string> choices{};  ///< all that it may be; empty: free
    bool verb_checks = false;            ///< the verb refuses other choices itself, or takes a file as well
    std::string usual{};                 ///< default as it is told; empty: that of the value
    bool required = false;
    bool off = false;                 ///< --no-NAME turns the flag off
    bool one_each = false;            ///< a list's: said again for each value (or with separators)
    char separator = 0;               ///< between values of a list, besides blanks
    std::pair<int, int> count{};      ///< of a list: least and most; {0, 0}: as many as one likes
    bool bare = false;                ///< it may stand without its value
    std::string needs{}, not_with{};  ///< names of other options
    std::string group{};              ///< heading; empty: the verb's present one
};

struct Option {
    std::string names;  ///< "-o,--out"; without dashes it stands alone
    OptionValue value;
    std::string help;  ///< what it does, with its unit
    OptionRules rules;

    [[nodiscard]] std::vector<std::string> dashed() const;  ///< "-o", "--out"; "--no-report" among them
    [[nodiscard]] std::string standing() const;             ///< its name where it stands alone; empty: it does not
    [[nodiscard]] std::string name() const;                 ///< "out"
    [[nodiscard]] std::string shown() const;                ///< "--out": as messages name it
    [[nodiscard]] bool is_flag() const;
    [[nodiscard]] bool is_list() const;
    [[nodiscard]] bool is_many() const { return is_list() && rules.count == std::pair<int, int>{}; }
    [[nodiscard]] bool is_whole_number() const;
    [[nodiscard]] std::string value_text() const;  ///< "LENGTH", "FILE..."; empty of a flag
    [[nodiscard]] std::string usual() const;       ///< its default; empty: none
    /// What it does, its choices and range, its default. `standing`: as one that stands alone.
    [[nodiscard]] std::string told(bool standing) const;
};

/// Heading of options that few need; there are others (verb.cpp).
inline constexpr const char* fine_tuning = "Fine tuning";

/// Options of a verb under one heading, in the order of their declaration.
struct OptionGroup {
    std::string heading;
    bool rare = false;      ///< told by --help-all and the manual only
    bool standing = false;  ///< by the names under which they stand alone
    std::vector<const Option*> options;
};

class Verb {
public:
    /// With --help and --help-all.
    Verb(std::string called, std::string what, std::string tried);

    std::string name, help, example;  ///< example: a command line that a user could try, without the verb's full name
    std::string full_name;            ///< "voxtone laminate search"
    std::vector<Option> options;
    std::vector<Verb> steps;                                ///< of a family, of which exactly one is chosen
    std::function<int()> run;                               ///< the exit code; owns what the values go to
    using Said = std::set<std::string>;                     ///< names of options
    std::shared_ptr<Said> said = std::make_shared<Said>();  ///< those of the command line, once it was parsed

    /// Heading of options that are added from here on.
    void group(std::string heading) { heading_ = std::move(heading); }
    void add_row(Option option);
    template <class Type>
    void add(std::string names, Type& value, std::string what, OptionRules rules = {}) {
        add_row({std::move(names), &value, std::move(what), std::move(rules)});
    }
    template <class Quantity>
    requires(!std::is_lvalue_reference_v<Quantity>) void add(std::string names, Quantity&& value, std::string what,
                                                             OptionRules rules = {}) {
        add_row({std::move(names), value, std::move(what), std::move(rules)});
    }

    /// Those that a user may name, those that stand alone first.
    [[nodiscard]] std::vector<OptionGroup> groups() const;
    /// Of "--out" or "-o"; null: it has none.
    [[nodiscard]] const Option* find(const std::string& dashed) const;
    /// Null: it has none.
    [[nodiscard]] const Verb* step(const std::string& called) const;
    /// Gives all below their full names.
    void settle(const std::string& parent);

private:
    std::string heading_ = "Options";
};

}  // namespace voxtone::cli
