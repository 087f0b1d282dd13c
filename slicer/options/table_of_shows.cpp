// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_shows.h"

#include <algorithm>
#include <utility>

#include "base/contracts.h"
#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

std::vector<OtherShow>& declared() {
    static std::vector<OtherShow> shows;
    return shows;
}

OptionSpec show_entry() {
    OptionSpec spec{.key = "show",
                    .metavar = "NAME",
                    .group = "Colour",
                    .help = "what the surface is to show: colour",
                    .choices = {colour_show},
                    .member = &SliceOptions::show,
                    .decides_scope = true};
    for (const OtherShow& show : declared()) {
        spec.help += ", or " + show.name + ": " + show.about;
        spec.choices.push_back(show.name);
    }
    spec.resolve = [](const SliceOptions& o, ResolvedJob& job) {
        if (shows_colours(o)) return;
        job.other = std::ranges::find(declared(), o.show, &OtherShow::name)->resolve(o);
        job.loop.iterations = 0;  // it is a loop of colours
    };
    return spec;
}

}  // namespace

void add_show(OtherShow show) {
    for (OptionSpec& spec : show.options) {
        VOXTONE_EXPECT(std::holds_alternative<OptionSpec::Other>(spec.member));
        spec.group = show.heading;
        spec.only_for = show.name;
    }
    std::erase_if(declared(), [&](const OtherShow& before) { return before.name == show.name; });
    declared().push_back(std::move(show));
}

bool is_show(std::string_view name) {
    return name == colour_show || std::ranges::find(declared(), name, &OtherShow::name) != declared().end();
}

std::vector<OptionSpec> table_of_shows() {
    std::vector<OptionSpec> table{show_entry()};
    for (const OtherShow& show : declared()) table.insert(table.end(), show.options.begin(), show.options.end());
    return table;
}

}  // namespace voxtone::slicer
