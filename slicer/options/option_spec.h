// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is declared of an option: an entry of the option table (option_table.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "slicer/options/option_words.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

struct ResolvedJob;

/// What of a job an option decides: whom another value makes a stranger.
enum class Decides : std::uint8_t {
    bits,             ///< resins of voxels, from the appearance loop on
    bits_after_loop,  ///< which layers there are, in which files, and when the loop ends: its state serves all values
    looks,            ///< what the report shows and says of the print
    work,             ///< how the work is done, and not what it makes
    this_run,         ///< the same, and of one run alone: job.json does not keep it
};

struct OptionSpec {
    enum class Kind { text, list, texts, number, length, flag };
    /// What its text is the name of.
    enum class Names { nothing, input, input_or_known, inputs_by_role, inputs_of_labels, inputs_of_decals, output };
    /// A number that is a length in mm and written with its unit.
    struct Length {
        double SliceOptions::*mm;
    };
    /// Texts that may hold commas; said one by one, or in lines.
    struct Texts {
        std::vector<std::string> SliceOptions::*texts;
    };
    /// Of what another kind of print declares (SliceOptions::other): text, list, number, length or flag.
    struct Other {
        Kind kind = Kind::text;
        std::string usual{};  ///< the default, as `get` says it
        bool whole = false;   ///< of a number: none but 0, 1, 2 ...
    };
    using Member =
        std::variant<std::monostate, Other, std::string SliceOptions::*, std::vector<std::string> SliceOptions::*,
                     bool SliceOptions::*, int SliceOptions::*, std::uint32_t SliceOptions::*,
                     std::uint64_t SliceOptions::*, double SliceOptions::*, Length, Texts>;
    /// A choice that stands for values of other options.
    struct Preset {
        std::string name;
        std::vector<std::pair<std::string, std::string>> values;  ///< key, value
    };
    /// The rule that is broken; empty: none.
    using Rule = std::function<std::string_view(const SliceOptions&)>;
    /// Why a job would do nothing with it; empty: it would not.
    using Idle = std::function<std::string_view(const SliceOptions&, bool is_picture)>;

    std::string key;                     ///< of the job file, and with dashes of the command line
    bool positional = false;             ///< it may also stand alone
    std::string letter{};                ///< "o" for -o
    std::string metavar{};               ///< "FILE", "ID", "a-b"
    std::string group{};                 ///< heading in --help
    std::string help{};                  ///< what it does, with its unit and its choices
    std::vector<std::string> choices{};  ///< empty: free
    std::string bare{};                  ///< what the option means without a value; empty: it wants one
    Member member{};
    Names names = Names::nothing;
    Decides decides = Decides::bits;
    std::string only_for{};      ///< what --show says where the print has it, and its rule holds; empty: any
    bool decides_scope = false;  ///< other options do nothing beside some value of this one
    std::vector<Idle> idle{};
    Rule rule{};
    std::function<void(const SliceOptions&, ResolvedJob&)> resolve{};
    std::vector<Preset> presets{};  ///< not empty: it has no value of its own, and is kept and counted as what it sets
    /// Of presets, by the other entries: the table fills them in.
    std::function<std::string(const SliceOptions&)> get_preset{};
    std::function<void(SliceOptions&, const Preset&)> set_preset{};

    [[nodiscard]] Kind kind() const;
    /// Its value as text. Of one with presets the first that the options agree with; empty: none.
    [[nodiscard]] std::string get(const SliceOptions& options) const;
    /// Throws UsageError that names the option, the value and the rule.
    void set(SliceOptions& options, const std::string& value) const;
    /// Throws UsageError for what is none of its choices.
    void expect_choice(const std::string& value) const;
    [[nodiscard]] bool is_preset() const { return !presets.empty(); }
    /// Whether a print of this kind has it.
    [[nodiscard]] bool belongs_to(std::string_view show) const { return only_for.empty() || only_for == show; }
    /// Whether it comes with another kind of print than is asked for, and is no part of this job.
    [[nodiscard]] bool is_of_another(const SliceOptions& options) const;
};

/// Words of `predict` besides the models' names.
inline constexpr std::string_view predict_auto = "auto", predict_none = "none";
/// All that `predict` may be.
[[nodiscard]] std::vector<std::string> predict_choices();

/// `rule`, where it is broken.
[[nodiscard]] constexpr std::string_view unless(bool good, std::string_view rule) {
    return good ? std::string_view() : rule;
}

}  // namespace voxtone::slicer
