// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/report_json.h"

#include "io/files/json_writer.h"

namespace voxtone::io {

namespace {

void write_resins(JsonWriter& json, const Report& report) {
    double total_ml = 0;
    json.line().key("resins").begin_list();
    for (const ReportResin& resin : report.resins) {
        json.line().begin_object().add("name", resin.name).add("role", resin.role);
        json.add("material_name", resin.material_name).add("rgb", resin.rgb);
        json.add("voxels", resin.voxels).add("ml", resin.ml).end_object();
        total_ml += resin.ml;
    }
    json.end_list().line().add("resin_ml", total_ml);
}

void write_region(JsonWriter& json, const ReportRegion& region) {
    json.line().begin_object().add("kind", region.kind).add("asked", region.asked).add("printed", region.printed);
    if (!region.asked_seen.empty()) json.add("asked_seen", region.asked_seen);
    json.add("place", region.place).add("place_mm", region.place_mm).add("pieces", region.pieces);
    json.add("area_mm2", region.area_mm2).add("seen_share", region.seen_share);
    if (!region.from.empty()) json.add("seen", region.from);
    for (const auto& [key, value] : {std::pair{"de2000", region.de2000},
                                     {"unevenness", region.unevenness},
                                     {"rim", region.rim},
                                     {"type_mm", region.type_mm}})
        if (value) json.add(key, *value);
    if (region.contrast_asked > 0) json.add("contrast", region.contrast).add("contrast_asked", region.contrast_asked);
    json.add("good", region.good).add("why", region.why).end_object();
}

void write_verdict(JsonWriter& json, const ReportVerdict& verdict) {
    json.line().key("verdict").begin_object().add("level", name_of(verdict.level)).add("sentence", verdict.sentence);
    if (!verdict.headline.empty()) json.line().add("headline", verdict.headline);
    if (!verdict.but.empty()) json.line().add("worst", verdict.but);
    if (verdict.seen_mean) {
        json.line().key("seen_de2000").begin_object().add("mean", *verdict.seen_mean);
        json.add("p95", verdict.seen_p95.value_or(*verdict.seen_mean));
        if (verdict.reach_mean) json.add("out_of_reach", *verdict.reach_mean);
        json.end_object();
        if (verdict.paper) json.add("paper", *verdict.paper);
        json.add("viewing_distance_mm", verdict.viewing_distance_mm);
        json.add("off_share", verdict.off_share).add("wrong_share", verdict.wrong_share);
        json.line().key("sides").begin_list();
        for (const ReportVerdict::Side& side : verdict.sides)
            json.begin_object().add("from", side.name).add("mean", side.mean).add("share", side.share).end_object();
        json.end_list();
    }
    json.line().add("good_up_to", verdict.good_up_to).add("bad_above", verdict.bad_above);
    json.key("causes").begin_list();
    for (const ReportVerdict::Cause& cause : verdict.causes)
        json.begin_object().add("cause", cause.name).add("share", cause.share).end_object();
    json.end_list().line().key("advice").begin_list();
    for (const ReportAdvice& advice : verdict.advice)
        json.line()
            .begin_object()
            .add("text", advice.text)
            .add("options", advice.options)
            .add("figure", advice.figure)
            .add("now", advice.now)
            .add("then", advice.then)
            .end_object();
    json.end_list().line().key("regions").begin_list();
    for (const ReportRegion& region : verdict.regions) write_region(json, region);
    json.end_list().end_object();
}

void write_gamut(JsonWriter& json, const ReportGamut& gamut) {
    json.line().key("gamut").begin_object().add("mapped_share", gamut.mapped_share);
    json.key("de2000").begin_object().add("mean", gamut.mean_de2000).add("p95", gamut.p95_de2000);
    json.add("max", gamut.max_de2000).end_object().end_object();
}

void write_prediction(JsonWriter& json, const ReportPrediction& p) {
    json.line().key("predicted").begin_object().add("model", p.model).add("cell_um", p.cell_um);
    json.add("cells", p.cells).add("seconds", p.seconds);
    json.key("de2000").begin_object().add("mean", p.mean_de2000).add("median", p.median_de2000);
    json.add("p95", p.p95_de2000).add("max", p.max_de2000).key("histogram").begin_list();
    for (const auto& [edge, share] : p.histogram)
        json.line().begin_object().add("from", edge).add("share", share).end_object();
    json.end_list().end_object().end_object();
}

void write_loop(JsonWriter& json, const ReportLoop& loop) {
    json.line().key("loop").begin_object().add("best", loop.best).add("seconds", loop.seconds).add("note", loop.note);
    json.key("iterations").begin_list();
    for (const ReportIteration& i : loop.iterations) {
        json.line().begin_object().add("iteration", i.number);
        json.key("seen_de2000").begin_object().add("mean", i.mean).add("median", i.median).add("p95", i.p95);
        json.end_object().key("cells_de2000").begin_object().add("mean", i.cells_mean).end_object();
        json.add("stuck_share", i.saturated_share).add("seconds", i.seconds).end_object();
    }
    json.end_list().end_object();
}

void write_table(JsonWriter& json, const ReportTable& table) {
    json.line().begin_object().add("title", table.title).add("header", table.header).key("rows").begin_list();
    for (const auto& row : table.rows) json.line().value(row);
    json.end_list().end_object();
}

void write_translucency(JsonWriter& json, const ReportTranslucency& alpha) {
    json.line().key("translucency").begin_object().add("asked_mean", alpha.asked_mean);
    json.add("shown_mean", alpha.shown_mean).key("given_up").begin_object().add("mean", alpha.given_up_mean);
    json.add("max", alpha.given_up_max).add("share", alpha.given_up_share).end_object().end_object();
}

void write_section(JsonWriter& json, const ReportSection& section) {
    json.line().begin_object().add("title", section.title).add("text", section.paragraphs);
    json.key("tables").begin_list();
    for (const ReportTable& table : section.tables) write_table(json, table);
    json.end_list().end_object();
}

void write_printing(JsonWriter& json, const ReportPrinting& printing) {
    if (printing.support_ml) json.add("support_ml", *printing.support_ml);
    if (printing.passes == 0) return;
    json.line().key("printing").begin_object().add("passes_per_layer", printing.passes_of_layer);
    json.add("passes", printing.passes);
    if (printing.seconds) json.add("seconds", *printing.seconds);
    json.add("source", printing.source).end_object();
}

}  // namespace

std::string report_json(const Report& report) {
    JsonWriter json;
    json.begin_object().add("format", "voxtone-report").add("version", 1);
    json.line().add("title", report.title).add("program", "voxtone " + report.program_version);
    json.line().key("printer").begin_object().add("id", report.printer_id).add("name", report.printer_name);
    json.end_object().line().add("pitch_um", report.pitch_um).add("size_mm", report.size_mm);
    json.line().key("size_px").begin_list().value(report.size_px[0]).value(report.size_px[1]).end_list();
    json.add("layers", report.size_px[2]).add("voxels", report.body_voxels);
    write_resins(json, report);
    write_printing(json, report.printing);
    if (report.verdict) write_verdict(json, *report.verdict);
    if (report.gamut) write_gamut(json, *report.gamut);
    if (report.translucency) write_translucency(json, *report.translucency);
    if (report.prediction) write_prediction(json, *report.prediction);
    if (report.loop) write_loop(json, *report.loop);
    json.line().add("warnings", report.warnings).line().key("stages").begin_list();
    for (const ReportStage& stage : report.stages)
        json.line().begin_object().add("name", stage.name).add("seconds", stage.seconds).end_object();
    json.end_list().line().add("seconds", report.total_seconds);
    json.add("peak_memory_bytes", report.peak_memory_bytes).add("output_bytes", report.output_bytes);
    if (!report.prediction_note.empty()) json.line().add("prediction", report.prediction_note);
    json.line().key("sections").begin_list();
    for (const ReportSection& section : report.sections) write_section(json, section);
    json.end_list().line().key("job").begin_object();
    for (const auto& [key, value] : report.job)
        std::visit([&json, &name = key](const auto& set_to) { json.line().add(name, set_to); }, value);
    json.end_object().end_object();
    return json.text() + "\n";
}

}  // namespace voxtone::io
