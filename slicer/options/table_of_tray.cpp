// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_tray.h"

#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Job = ResolvedJob;
using Length = OptionSpec::Length;

/// Asked of one body alone (option_scope.h).
std::string_view of_many_parts(const SliceOptions&, bool) {
    return "it is for many parts in one print: name several models, or the plan of a tray";
}

}  // namespace

std::vector<OptionSpec> table_of_tray() {
    constexpr double most_mm = 1e4;
    constexpr int most_trays = 100;
    const std::string group = "Tray";
    return {
        plain(Length{&O::gap_mm}, at(&Job::tray, &TrayOptions::gap_mm),
              {.key = "gap",
               .group = group,
               .help = "many parts: room between those whose places are not given; light passes between parts that are "
                       "nearer "
                       "than 2 mm, and they are looped as one",
               .idle = {of_many_parts},
               .rule = [](const O& o) { return unless(o.gap_mm >= 0 && o.gap_mm <= most_mm, "must be 0 to 10 m"); }}),
        choice(&O::arrange, at(&Job::tray, &TrayOptions::arrange),
               {.key = "arrange",
                .metavar = "HOW",
                .group = group,
                .help = "many parts: where those stand whose places are not given. plate: beside each other; stacked: "
                        "over each other, too; none: where the coordinates in their files put them",
                .idle = {of_many_parts}}),
        plain(&O::turn, at(&Job::tray, &TrayOptions::turn),
              {.key = "turn",
               .group = group,
               .help = "many parts: turn them by right angles about the vertical where they come to lie closer so; a "
                       "part that is turned is another body, with a loop of its own",
               .idle = {of_many_parts}}),
        plain(&O::trays, at(&Job::tray, &TrayOptions::trays),
              {.key = "trays",
               .metavar = "N",
               .group = group,
               .help = "many parts: most trays to fill; what finds no room in OUT goes to OUT-2, OUT-3 and so on",
               .idle = {of_many_parts},
               .rule = [](const O& o) { return unless(o.trays >= 1 && o.trays <= most_trays, "must be 1 to 100"); }}),
        plain(&O::fail_fast, at(&Job::tray, &TrayOptions::fail_fast),
              {.key = "fail-fast",
               .group = group,
               .help = "many parts: stop at the first that fails; else the tray is made without it, and the exit code "
                       "is the part's",
               .decides = Decides::work,
               .idle = {of_many_parts}}),
    };
}

}  // namespace voxtone::slicer
