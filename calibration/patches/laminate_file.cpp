// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/laminate_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/measured_values.h"
#include "calibration/tables/table_cells.h"
#include "calibration/tables/text_table.h"
#include "io/files/json_object.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t most_laminates = 100000, most_layers = 1000;
constexpr double least_mm = 0.001, most_mm = 1000;

std::string_view first_line(std::string_view text) {
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
        if (!trimmed(line).empty() && !trimmed(line).starts_with('#')) return trimmed(line);
        text.remove_prefix(std::min(line.size() + 1, text.size()));
    }
    return {};
}

PatchLayer parse_layer(std::string_view text, const std::string& where) {
    const std::size_t blank = std::min(text.find_last_of(" \t"), text.size());
    const std::string_view role = trimmed(text.substr(0, blank));
    const double mm = number(trimmed(text.substr(blank))).value_or(0);
    if (!(mm >= least_mm && mm <= most_mm) || !is_role(role))
        throw InputError(
            fmt::format("{}: the layer {} is not a resin's role and its thickness in mm, such as W 0.08; layers are "
                        "listed from the top, with commas between.",
                        where, shown(text)));
    return {std::string(role), mm};
}

void add_laminate(PatchTable& table, std::vector<PatchLayer> layers, const std::vector<double>& lab,
                  const std::string& where) {
    if (table.patches.size() >= most_laminates)
        throw InputError(fmt::format("{}: more than {} laminates.", where, most_laminates));
    if (layers.empty() || layers.size() > most_layers)
        throw InputError(fmt::format("{}: {} layers; expected 1 to {}.", where, layers.size(), most_layers));
    if (!(lab[0] >= -1 && lab[0] <= 110) || !(std::abs(lab[1]) <= 200) || !(std::abs(lab[2]) <= 200))
        throw InputError(
            fmt::format("{}: L, a, b of {}, {}, {} is no colour that a print has.", where, lab[0], lab[1], lab[2]));
    Patch& patch = table.patches.emplace_back();
    patch.top = {{layers.front().role, 1}}, patch.thickness_mm = layers.front().thickness_mm;
    patch.under.assign(layers.begin() + 1, layers.end());
    patch.rho = lab, patch.where = where;
}

bool is_laminate_header(const std::vector<std::string>& cells) {
    return cells.size() >= 4 && in_capitals(cells[0]) == "LAYERS";
}

MeasuringConditions parse_table(std::string_view text, PatchTable& chart) {
    constexpr std::string_view example = "a chart of laminates begins with layers,L,a,b";
    CsvText table(text, chart.source, example, is_laminate_header);
    const std::vector<std::string>& names = table.names();
    if (names.size() != 4 || in_capitals(names[1]) != "L" || in_capitals(names[2]) != "A" ||
        in_capitals(names[3]) != "B")
        table.fail(example);
    while (table.next()) {
        std::vector<PatchLayer> layers;
        for (const std::string_view layer : split(table.cells()[0], ','))
            layers.push_back(parse_layer(layer, table.where()));
        add_laminate(chart, std::move(layers), {table.number(1), table.number(2), table.number(3)}, table.where());
    }
    return conditions_of(table);
}

// A colour's name as a role: letters and digits, once only.
std::vector<std::string> palette_of(const io::JsonObject& file) {
    std::vector<std::string> roles;
    for (const io::JsonObject& colour : file.objects("palette")) {
        std::string role = colour.text("color");
        std::erase_if(
            role, [](char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); });
        if (!is_role(role) || std::ranges::find(roles, role) != roles.end()) role = fmt::format("R{}", roles.size());
        roles.push_back(role);
    }
    if (roles.empty()) file.fail("palette", "is empty");
    return roles;
}

void parse_json(std::string_view text, PatchTable& chart) {
    const io::JsonObject file = io::JsonObject::parse(text, chart.source);
    if (!file.has("entries") || !file.has("palette"))
        file.fail("entries",
                  "is missing: a chart of laminates in JSON has a palette and entries with recipe and lab, as "
                  "ChromaPrint3D writes them");
    const std::vector<std::string> roles = palette_of(file);
    const std::string order = file.has("layer_order") ? file.text("layer_order") : "Top2Bottom";
    if (order != "Top2Bottom" && order != "Bottom2Top")
        file.fail("layer_order", "is neither Top2Bottom nor Bottom2Top");
    const double mm = file.number("layer_height_mm", least_mm, most_mm);
    const PatchLayer base{roles[file.integer("base_channel_idx", 0, roles.size() - 1)],
                          mm * static_cast<double>(file.integer("base_layers", 1, 10000))};
    std::size_t entry = 0;
    for (const io::JsonObject& one : file.objects("entries")) {
        std::vector<PatchLayer> layers;
        for (const std::uint64_t resin : one.integers("recipe", 0, 0, roles.size() - 1))
            layers.push_back({roles[resin], mm});
        if (order == "Bottom2Top") std::ranges::reverse(layers);
        layers.push_back(base);
        add_laminate(chart, std::move(layers), one.numbers("lab", 3, -1000, 1000),
                     fmt::format("{}: entries[{}]", chart.source, entry++));
    }
}

}  // namespace

bool is_laminate_file(std::string_view text) {
    if (first_line(text).starts_with('{')) return true;
    const io::CsvReader csv(text, io::CsvRules::lenient, is_laminate_header);
    const std::vector<std::string>& names = csv.header().cells;
    return names.size() > 1 && in_capitals(names[0]) == "LAYERS";
}

PatchTable read_laminates(std::string_view text, std::string source, std::optional<optics::Illuminant> illuminant) {
    PatchTable chart;
    chart.source = std::move(source);
    chart.is_chart = true;
    MeasuringConditions conditions;
    if (first_line(text).starts_with('{'))
        parse_json(text, chart);
    else
        conditions = parse_table(text, chart);
    if (chart.patches.empty()) throw InputError(fmt::format("{}: no laminate.", chart.source));
    make_rho(chart, Quantity::lab, conditions, illuminant);
    return chart;
}

}  // namespace voxtone::calibration
