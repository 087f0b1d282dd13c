// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "voxtone/base/printable.h"
#include "voxtone/io/report/report_html.h"

namespace voxtone::io {

namespace {

using Json = nlohmann::ordered_json;

Json table_json(const ReportTable& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json cells = Json::array();
        for (const std::string& cell : row) cells.push_back(valid_utf8(cell));
        rows.push_back(cells);
    }
    Json header = Json::array();
    for (const std::string& cell : table.header) header.push_back(valid_utf8(cell));
    return {{"title", valid_utf8(table.title)}, {"header", header}, {"rows", rows}};
}

Json section_json(const ReportSection& section) {
    Json result{{"title", valid_utf8(section.title)}, {"text", Json::array()}, {"tables", Json::array()}};
    for (const std::string& paragraph : section.paragraphs) result["text"].push_back(valid_utf8(paragraph));
    for (const ReportTable& table : section.tables) result["tables"].push_back(table_json(table));
    return result;
}

}  // namespace

std::string report_json(const Report& report) {
    Json json{{"format", "voxtone-report"}, {"version", 1}};
    json["title"] = valid_utf8(report.title);
    json["program"] = "voxtone " + valid_utf8(report.program_version);
    json["printer"] = {{"id", valid_utf8(report.printer_id)}, {"name", valid_utf8(report.printer_name)}};
    json["pitch_um"] = report.pitch_um;
    json["size_mm"] = report.size_mm;
    json["size_px"] = {report.size_px[0], report.size_px[1]};
    json["layers"] = report.size_px[2];
    json["voxels"] = report.body_voxels;
    json["resins"] = Json::array();
    double total_ml = 0;
    for (const ReportResin& resin : report.resins) {
        json["resins"].push_back({{"name", valid_utf8(resin.name)},
                                  {"role", valid_utf8(resin.role)},
                                  {"material_name", valid_utf8(resin.material_name)},
                                  {"rgb", resin.rgb},
                                  {"voxels", resin.voxels},
                                  {"ml", resin.ml}});
        total_ml += resin.ml;
    }
    json["resin_ml"] = total_ml;
    if (report.gamut)
        json["gamut"] = {{"mapped_share", report.gamut->mapped_share},
                         {"de2000",
                          {{"mean", report.gamut->mean_de2000},
                           {"p95", report.gamut->p95_de2000},
                           {"max", report.gamut->max_de2000}}}};
    if (report.prediction) {
        const ReportPrediction& p = *report.prediction;
        Json histogram = Json::array();
        for (const auto& [edge, share] : p.histogram) histogram.push_back({{"from", edge}, {"share", share}});
        json["predicted"] = {{"model", valid_utf8(p.model)},
                             {"cell_um", p.cell_um},
                             {"cells", p.cells},
                             {"seconds", p.seconds},
                             {"de2000",
                              {{"mean", p.mean_de2000},
                               {"median", p.median_de2000},
                               {"p95", p.p95_de2000},
                               {"max", p.max_de2000},
                               {"histogram", histogram}}}};
    }
    if (report.loop) {
        Json iterations = Json::array();
        for (const ReportIteration& i : report.loop->iterations)
            iterations.push_back({{"iteration", i.number},
                                  {"seen_de2000", {{"mean", i.mean}, {"median", i.median}, {"p95", i.p95}}},
                                  {"cells_de2000", {{"mean", i.cells_mean}}},
                                  {"stuck_share", i.stuck_share},
                                  {"seconds", i.seconds}});
        json["loop"] = {{"best", report.loop->best},
                        {"seconds", report.loop->seconds},
                        {"note", valid_utf8(report.loop->note)},
                        {"iterations", iterations}};
    }
    json["warnings"] = Json::array();
    for (const std::string& warning : report.warnings) json["warnings"].push_back(valid_utf8(warning));
    json["stages"] = Json::array();
    for (const ReportStage& stage : report.stages)
        json["stages"].push_back({{"name", valid_utf8(stage.name)}, {"seconds", stage.seconds}});
    json["seconds"] = report.total_seconds;
    json["peak_memory_bytes"] = report.peak_memory_bytes;
    json["output_bytes"] = report.output_bytes;
    if (!report.prediction_note.empty()) json["prediction"] = valid_utf8(report.prediction_note);
    json["sections"] = Json::array();
    for (const ReportSection& section : report.sections) json["sections"].push_back(section_json(section));
    json["job"] = Json::object();
    for (const auto& [key, value] : report.job) json["job"][valid_utf8(key)] = valid_utf8(value);
    return json.dump(2) + "\n";
}

}  // namespace voxtone::io
