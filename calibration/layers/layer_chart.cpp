// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/measured_values.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/tables/table_cells.h"
#include "calibration/tables/text_table.h"
#include "io/files/json_object.h"

namespace voxtone::calibration {

namespace {

constexpr std::uint64_t most_chart_bytes = std::uint64_t{64} << 20;
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

std::size_t resin_of(LayerChart& chart, std::string_view role) {
    const auto known = std::ranges::find(chart.roles, role);
    if (known != chart.roles.end()) return static_cast<std::size_t>(known - chart.roles.begin());
    chart.roles.emplace_back(role);
    return chart.roles.size() - 1;
}

ChartLayer parse_layer(LayerChart& chart, std::string_view text, const std::string& where) {
    const std::size_t blank = std::min(text.find_last_of(" \t"), text.size());
    const std::string_view role = trimmed(text.substr(0, blank));
    const double mm = number(trimmed(text.substr(blank))).value_or(0);
    if (!(mm >= least_mm && mm <= most_mm) || !is_role(role))
        throw InputError(
            fmt::format("{}: the layer {} is not a resin's role and its thickness in mm, such as W 0.08; layers are "
                        "listed from the top, with commas between.",
                        where, shown(text)));
    return {resin_of(chart, role), mm};
}

void add_laminate(LayerChart& chart, std::vector<double>& lab, LayerLaminate laminate,
                  const std::vector<double>& colour, const std::string& where) {
    if (chart.laminates.size() >= most_laminates)
        throw InputError(fmt::format("{}: more than {} laminates.", where, most_laminates));
    if (laminate.empty() || laminate.size() > most_layers)
        throw InputError(fmt::format("{}: {} layers; expected 1 to {}.", where, laminate.size(), most_layers));
    if (!(colour[0] >= -1 && colour[0] <= 110) || !(std::abs(colour[1]) <= 200) || !(std::abs(colour[2]) <= 200))
        throw InputError(fmt::format("{}: L, a, b of {}, {}, {} is no colour that a print has.", where, colour[0],
                                     colour[1], colour[2]));
    chart.laminates.push_back(std::move(laminate));
    lab.insert(lab.end(), colour.begin(), colour.end());
}

void finish(LayerChart& chart, const std::vector<double>& lab, std::string_view named,
            std::optional<optics::Illuminant> illuminant) {
    if (chart.laminates.empty()) throw InputError(fmt::format("{}: no laminate.", chart.source));
    chart.lab = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
        lab.data(), static_cast<Eigen::Index>(chart.laminates.size()), 3);
    PatchTable lights;
    lights.source = chart.source;
    make_rho(lights, Quantity::lab, {std::string(named), {}}, illuminant);
    chart.illuminant = lights.channels.illuminant;
    chart.notes = lights.notes;
}

bool is_laminate_header(const std::vector<std::string>& cells) {
    return cells.size() >= 4 && in_capitals(cells[0]) == "LAYERS";
}

LayerChart parse_table(std::string_view text, LayerChart chart, std::optional<optics::Illuminant> illuminant) {
    constexpr std::string_view example = "a chart of laminates begins with layers,L,a,b";
    CsvText table(text, chart.source, example, is_laminate_header);
    const std::vector<std::string>& names = table.names();
    if (names.size() != 4 || in_capitals(names[1]) != "L" || in_capitals(names[2]) != "A" ||
        in_capitals(names[3]) != "B")
        table.fail(example);
    std::vector<double> lab;
    while (table.next()) {
        LayerLaminate laminate;
        for (const std::string_view layer : split(table.cells()[0], ','))
            laminate.push_back(parse_layer(chart, layer, table.where()));
        add_laminate(chart, lab, std::move(laminate), {table.number(1), table.number(2), table.number(3)},
                     table.where());
    }
    finish(chart, lab, conditions_of(table).illuminant, illuminant);
    return chart;
}

// A colour's name as a role: letters and digits, once only.
void add_palette(const io::JsonObject& file, LayerChart& chart) {
    for (const io::JsonObject& colour : file.objects("palette")) {
        std::string role = colour.text("color");
        std::erase_if(
            role, [](char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); });
        if (!is_role(role) || std::ranges::find(chart.roles, role) != chart.roles.end())
            role = fmt::format("R{}", chart.roles.size());
        chart.roles.push_back(role);
    }
}

LayerChart parse_json(std::string_view text, LayerChart chart, std::optional<optics::Illuminant> illuminant) {
    const io::JsonObject file = io::JsonObject::parse(text, chart.source);
    if (!file.has("entries") || !file.has("palette"))
        file.fail("entries",
                  "is missing: a chart of laminates in JSON has a palette and entries with recipe and lab, as "
                  "ChromaPrint3D writes them");
    add_palette(file, chart);
    if (chart.roles.empty()) file.fail("palette", "is empty");
    const std::string order = file.has("layer_order") ? file.text("layer_order") : "Top2Bottom";
    if (order != "Top2Bottom" && order != "Bottom2Top")
        file.fail("layer_order", "is neither Top2Bottom nor Bottom2Top");
    const double mm = file.number("layer_height_mm", least_mm, most_mm);
    const ChartLayer base{file.integer("base_channel_idx", 0, chart.roles.size() - 1),
                          mm * static_cast<double>(file.integer("base_layers", 1, 10000))};
    std::vector<double> lab;
    std::size_t entry = 0;
    for (const io::JsonObject& one : file.objects("entries")) {
        LayerLaminate laminate;
        for (const std::uint64_t resin : one.integers("recipe", 0, 0, chart.roles.size() - 1))
            laminate.push_back({resin, mm});
        if (order == "Bottom2Top") std::ranges::reverse(laminate);
        laminate.push_back(base);
        add_laminate(chart, lab, std::move(laminate), one.numbers("lab", 3, -1000, 1000),
                     fmt::format("{}: entries[{}]", chart.source, entry++));
    }
    finish(chart, lab, "", illuminant);
    return chart;
}

}  // namespace

bool is_layer_chart(std::string_view text) {
    if (first_line(text).starts_with('{')) return true;
    const io::CsvReader csv(text, io::CsvRules::lenient, is_laminate_header);
    const std::vector<std::string>& names = csv.header().cells;
    return names.size() > 1 && in_capitals(names[0]) == "LAYERS";
}

LayerChart parse_layer_chart(std::string_view text, std::string source, std::optional<optics::Illuminant> illuminant) {
    LayerChart chart;
    chart.source = std::move(source);
    return first_line(text).starts_with('{') ? parse_json(text, std::move(chart), illuminant)
                                             : parse_table(text, std::move(chart), illuminant);
}

std::optional<LayerChart> read_layer_chart(const std::filesystem::path& file,
                                           std::optional<optics::Illuminant> illuminant) {
    const std::string text = read_text(file, most_chart_bytes);
    if (!is_layer_chart(text)) return std::nullopt;
    return parse_layer_chart(text, file.string(), illuminant);
}

std::string laminate_text(const LayerChart& chart, std::size_t laminate) {
    std::string text;
    for (const ChartLayer& layer : chart.laminates[laminate])
        text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", chart.roles[layer.resin], layer.thickness_mm);
    return text;
}

LayerChart chart_laminates(const LayerChart& chart, const std::vector<std::size_t>& keep) {
    LayerChart part = chart;
    part.laminates.clear();
    part.lab.resize(static_cast<Eigen::Index>(keep.size()), 3);
    for (std::size_t i = 0; i < keep.size(); ++i) {
        part.laminates.push_back(chart.laminates[keep[i]]);
        part.lab.row(static_cast<Eigen::Index>(i)) = chart.lab.row(static_cast<Eigen::Index>(keep[i]));
    }
    return part;
}

}  // namespace voxtone::calibration
