// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_table.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "slicer/options/mark_words.h"
#include "slicer/options/table_of_body.h"
#include "slicer/options/table_of_colour.h"
#include "slicer/options/table_of_marks.h"
#include "slicer/options/table_of_run.h"
#include "slicer/options/table_of_shows.h"
#include "slicer/options/table_of_tray.h"

namespace voxtone::slicer {

namespace {

std::string preset_of(const OptionSpec& spec, const SliceOptions& options) {
    const auto agrees = [&](const auto& entry) { return find_option(entry.first)->get(options) == entry.second; };
    for (const OptionSpec::Preset& preset : spec.presets)
        if (std::ranges::all_of(preset.values, agrees)) return preset.name;
    return {};
}

void apply(const OptionSpec::Preset& preset, SliceOptions& options) {
    for (const auto& [key, value] : preset.values) find_option(key)->set(options, value);
}

/// Names of files are left out, as their contents count; empty where there is nothing besides.
std::string deciding_text(const OptionSpec& spec, const SliceOptions& options) {
    using Names = OptionSpec::Names;
    if (spec.names == Names::nothing) return spec.get(options);
    if (spec.names != Names::inputs_of_labels && spec.names != Names::inputs_of_decals) return spec.get({});
    const bool labels = spec.names == Names::inputs_of_labels;
    std::string text;
    for (const std::string& mark : labels ? options.labels : options.decals)
        text += with_files(labels ? MarkFamily::label : MarkFamily::decal, mark,
                           [](const std::string&) { return std::string("a file"); }) +
                "\n";
    return text;
}

std::vector<OptionSpec> whole_table() {
    std::vector<OptionSpec> table;
    for (std::vector<OptionSpec> part :
         {table_of_body(), table_of_tray(), table_of_marks(), table_of_colour(), table_of_shows(), table_of_run()})
        table.insert(table.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
    for (OptionSpec& spec : table) {
        if (spec.is_preset()) {
            spec.get_preset = [key = spec.key](const SliceOptions& o) { return preset_of(*find_option(key), o); };
            spec.set_preset = [](SliceOptions& o, const OptionSpec::Preset& preset) { apply(preset, o); };
        }
        VOXTONE_EXPECT(spec.is_preset() == std::holds_alternative<std::monostate>(spec.member));
    }
    return table;
}

std::vector<OptionSpec>& made_table() {
    static std::vector<OptionSpec> table = whole_table();
    return table;
}

}  // namespace

std::span<const OptionSpec> slice_option_table() { return made_table(); }

void declare_show(OtherShow show) {
    add_show(std::move(show));
    made_table() = whole_table();
}

const OptionSpec* find_option(std::string_view key) {
    for (const OptionSpec& spec : slice_option_table())
        if (spec.key == key) return &spec;
    return nullptr;
}

std::vector<std::string> option_keys() {
    std::vector<std::string> keys;
    for (const OptionSpec& spec : slice_option_table()) keys.push_back(spec.key);
    return keys;
}

std::string deciding_lines(const SliceOptions& options, Decides least, std::span<const OptionSpec> table) {
    const SliceOptions defaults;
    std::string lines;
    for (const OptionSpec& spec : table) {
        if (spec.decides > least || spec.is_preset()) continue;
        const std::string value = deciding_text(spec, options);
        if (value != spec.get(defaults)) lines += fmt::format("{}={}\n", spec.key, value);
    }
    return lines;
}

}  // namespace voxtone::slicer
