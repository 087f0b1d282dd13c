// SPDX-License-Identifier: GPL-3.0-or-later
//
// Another kind of print than of colours, as a floor above would declare it: relics, known by a file.
#pragma once

#include <memory>
#include <string>

#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"
#include "slicer/options/table_of_shows.h"

namespace voxtone::slicer {

struct RelicOptions final : OtherOptions {
    std::string relic, below;
    double deep_mm = 0;
    [[nodiscard]] double depth_mm() const override { return deep_mm; }
    [[nodiscard]] const std::string& core() const override { return below; }
    [[nodiscard]] const char* core_option() const override { return "below"; }
};

inline void declare_relics() {
    using Other = OptionSpec::Other;
    using Kind = OptionSpec::Kind;
    declare_show(
        {"relic",
         "what is left of somebody",
         "Relics",
         {{.key = "bone", .metavar = "FILE", .help = "the file", .member = Other{}, .names = OptionSpec::Names::input},
          {.key = "below", .metavar = "ROLE", .help = "resin below", .member = Other{Kind::text, "K"}},
          {.key = "deep",
           .metavar = "LENGTH",
           .help = "how deep it lies",
           .member = Other{Kind::length, "2mm"},
           .rule =
               [](const SliceOptions& o) {
                   return unless(find_option("deep")->get(o) != "0mm", "it would lie on the ground");
               }},
          {.key = "fingers", .metavar = "N", .help = "how many", .member = Other{Kind::number, "5", true}},
          {.key = "worth", .metavar = "X", .help = "to whom it is", .member = Other{Kind::number, "1"}},
          {.key = "guards",
           .metavar = "ROLE=FILE",
           .help = "by role",
           .member = Other{Kind::list},
           .names = OptionSpec::Names::inputs_by_role},
          {.key = "holy", .help = "or not", .member = Other{Kind::flag, "false"}}},
         [](const SliceOptions& o) {
             auto made = std::make_shared<RelicOptions>();
             made->relic = find_option("bone")->get(o);
             made->below = find_option("below")->get(o);
             const std::string deep = find_option("deep")->get(o);
             made->deep_mm = parse_number<double>("deep", deep.substr(0, deep.size() - 2));
             return made;
         }});
}

/// A job that shows one.
inline SliceOptions with_relic(SliceOptions options, const std::string& file) {
    options.show = "relic";
    find_option("bone")->set(options, file);
    return options;
}

}  // namespace voxtone::slicer
