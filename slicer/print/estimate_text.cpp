// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/estimate_text.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/machine_memory.h"
#include "base/progress_bar.h"
#include "io/disk/disk_space.h"
#include "io/files/json_writer.h"

namespace voxtone::slicer {

namespace {

void write_resins(io::JsonWriter& json, const JobEstimate& estimate) {
    json.add("ml", estimate.body_ml);
    if (estimate.g) json.add("g", *estimate.g);
    if (estimate.price) json.add("price", *estimate.price);
    if (!estimate.currency.empty()) json.add("currency", estimate.currency);
    json.key("resins").begin_list();
    for (const ResinEstimate& resin : estimate.resins) {
        json.begin_object().add("role", resin.role).add("name", resin.name).add("ml", resin.ml);
        if (resin.g) json.add("g", *resin.g);
        if (resin.price) json.add("price", *resin.price);
        json.end_object();
    }
    json.end_list();
    if (!estimate.why_no_resins.empty()) json.add("why_no_resins", estimate.why_no_resins);
}

void write_phases(io::JsonWriter& json, const JobEstimate& estimate) {
    json.key("phases").begin_list();
    for (const PhaseEstimate& phase : estimate.phases) {
        json.begin_object()
            .add("name", name_of(phase.phase))
            .add("cpu_seconds", phase.cpu_s)
            .add("seconds", phase.seconds);
        json.add("memory_bytes", phase.memory_bytes).add("measured", phase.measured).end_object();
    }
    json.end_list().add("threads", estimate.threads);
    json.add("cpu_seconds", estimate.cpu_s).add("seconds", estimate.seconds);
    json.add("memory_bytes", estimate.memory_bytes);
}

/// Of the printer.
void write_printing(io::JsonWriter& json, const JobEstimate& estimate) {
    const PrintingTime& printing = estimate.printing;
    if (printing.passes > 0) {
        json.key("printing").begin_object().add("passes_per_layer", printing.passes_of_layer);
        json.add("passes", printing.passes);
        if (printing.seconds) json.add("seconds", *printing.seconds);
        json.add("source", printing.source).end_object();
    }
    if (estimate.support_ml) json.add("support_ml", *estimate.support_ml);
}

std::string printing_lines(const JobEstimate& estimate) {
    std::string text;
    if (estimate.support_ml)
        text += fmt::format(
            "  support: some {:.3g} ml below what hangs over; the printer's program adds what the print stands on\n",
            *estimate.support_ml);
    if (const std::string printing = printing_text(estimate.printing); !printing.empty())
        text += fmt::format("  printing: {}\n", printing);
    return text;
}

void write_orientations(io::JsonWriter& json, const JobEstimate& estimate) {
    if (estimate.orientations.empty()) return;
    json.key("orientations").begin_list();
    for (const Orientation& o : estimate.orientations) {
        json.begin_object().add("rotate", o.rotate).add("size_mm", o.size_mm).add("layers", o.layers);
        json.add("fits", o.fits).add("under_ml", o.under_ml).add("downward_mm2", o.downward_mm2);
        json.add("coloured_down_mm2", o.coloured_down_mm2).add("as_it_is", o.as_it_is);
        if (o.passes > 0) json.add("passes", o.passes);
        json.end_object();
    }
    json.end_list();
    if (const auto& advised = estimate.advised_orientation)
        json.key("advised_orientation")
            .begin_object()
            .add("rotate", advised->rotate)
            .add("reason", advised->reason)
            .end_object();
}

std::string size_text(const JobEstimate& e) {
    return fmt::format("{:.2f} x {:.2f} x {:.2f} mm, {} x {} px, {} layers of {:g} um", e.size_mm[0], e.size_mm[1],
                       e.size_mm[2], e.size_px[0], e.size_px[1], e.layers, e.layer_um);
}

/// " 12.3 g  1.05 EUR", as far as it is known.
std::string weight_text(const std::optional<double>& g, const std::optional<double>& price,
                        const std::string& currency) {
    std::string text;
    if (g) text += fmt::format("  {:9.3f} g", *g);
    if (price) text += fmt::format("  {:8.2f} {}", *price, currency);
    return text;
}

std::string resins_text(const JobEstimate& estimate) {
    std::string text;
    for (const ResinEstimate& resin : estimate.resins)
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml{}\n", resin.role, resin.name, resin.ml,
                            weight_text(resin.g, resin.price, estimate.currency));
    text += fmt::format("  {:<20} {:9.3f} ml{}\n", "all", estimate.body_ml,
                        weight_text(estimate.g, estimate.price, estimate.currency));
    if (!estimate.why_no_resins.empty()) text += "  " + estimate.why_no_resins + "\n";
    if (!estimate.resins.empty() && !estimate.g)
        text += "  no weight: the resin set does not say the density of all of them (density_g_per_ml)\n";
    return text;
}

std::string phases_text(const JobEstimate& estimate) {
    std::string text = fmt::format("  {:<20} {:>12} {:>12} {:>12}\n", "phase", "time", "processor", "memory");
    for (const PhaseEstimate& phase : estimate.phases)
        text += fmt::format("  {:<20} {:>12} {:>12} {:>12}{}\n", name_of(phase.phase), duration_text(phase.seconds),
                            duration_text(phase.cpu_s), memory_text(phase.memory_bytes),
                            phase.measured ? "  (measured)" : "");
    text += fmt::format("  {:<20} {:>12} {:>12} {:>12}  on {} {}\n", "all", duration_text(estimate.seconds),
                        duration_text(estimate.cpu_s), memory_text(estimate.memory_bytes), estimate.threads,
                        estimate.threads == 1 ? "thread" : "threads");
    return text;
}

/// Their views from the front, some in a row, each on the line of its turn.
std::string gallery(const std::vector<Orientation>& orientations) {
    constexpr std::size_t in_a_row = 6;
    constexpr int wide = 14;
    std::string text;
    for (std::size_t first = 0; first < orientations.size(); first += in_a_row) {
        const std::size_t end = std::min(first + in_a_row, orientations.size());
        std::size_t lines = 0;
        for (std::size_t n = first; n < end; ++n) lines = std::max(lines, orientations[n].front.size());
        for (std::size_t line = lines; line > 0; --line) {
            std::string row;
            for (std::size_t n = first; n < end; ++n) {
                const std::vector<std::string>& front = orientations[n].front;
                row += fmt::format("{:<{}}", line <= front.size() ? front[front.size() - line] : "", wide);
            }
            text += "  " + row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
        }
        std::string names;
        for (std::size_t n = first; n < end; ++n)
            names += fmt::format("{:<{}}", orientations[n].rotate.empty() ? "as it is" : orientations[n].rotate, wide);
        text += "  " + names.substr(0, names.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

std::string orientations_text(const JobEstimate& estimate) {
    if (estimate.orientations.empty()) return {};
    std::string text = fmt::format(
        "  orientations: the body takes {:.3f} ml in each; support is not counted, and fills some of what hangs over\n"
        "  {:<24} {:>26} {:>7} {:>8} {:>9} {:>13} {:>13}\n",
        estimate.body_ml, "--rotate", "size", "layers", "passes", "under it", "faces down", "coloured");
    for (const Orientation& o : estimate.orientations)
        text += fmt::format("  {:<24} {:>26} {:>7} {:>8} {:>6.2f} ml {:>9.2f} cm2 {:>9.2f} cm2{}\n",
                            o.as_it_is ? fmt::format("{} (as it is)", o.rotate) : o.rotate,
                            fmt::format("{:.1f} x {:.1f} x {:.1f} mm", o.size_mm[0], o.size_mm[1], o.size_mm[2]),
                            o.layers, o.passes > 0 ? fmt::format("{}", o.passes) : "-", o.under_ml,
                            o.downward_mm2 / 100, o.coloured_down_mm2 / 100, o.fits ? "" : "  does not fit");
    text += gallery(estimate.orientations);
    const auto& advised = estimate.advised_orientation;
    if (!advised) return text + "  none of them fits\n";
    const std::string turn =
        estimate.orientations.front().as_it_is ? "leave it as it is" : "--rotate " + advised->rotate;
    return text + fmt::format("  recommended: {}: {}\n", turn, advised->reason);
}

std::string disk_text(const JobEstimate& estimate) {
    std::string text = fmt::format("up to {} on disk", io::bytes_text(estimate.disk_bytes));
    if (estimate.free_disk_bytes) text += fmt::format(" ({} free)", io::bytes_text(*estimate.free_disk_bytes));
    return text;
}

}  // namespace

std::string estimate_json(const JobEstimate& estimate) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-estimate").add("version", 1);
    json.add("model", estimate.model).add("printer", estimate.printer);
    json.add("size_mm", estimate.size_mm).add("size_px", estimate.size_px);
    json.add("first_layer", estimate.first_layer).add("layers", estimate.layers).add("layer_um", estimate.layer_um);
    json.add("surface_mm2", estimate.surface_mm2);
    write_resins(json, estimate);
    write_printing(json, estimate);
    json.add("loop", estimate.loop).add("prediction", estimate.prediction);
    write_phases(json, estimate);
    json.add("disk_bytes", estimate.disk_bytes);
    if (estimate.free_disk_bytes) json.add("free_disk_bytes", *estimate.free_disk_bytes);
    write_orientations(json, estimate);
    json.add("warnings", estimate.warnings).add("notes", estimate.notes).end_object();
    return json.text();
}

std::string estimate_text(const JobEstimate& estimate) {
    return fmt::format("{}: {}\n  coloured surface {:.1f} cm2\n", estimate.model, size_text(estimate),
                       estimate.surface_mm2 / 100) +
           resins_text(estimate) + printing_lines(estimate) + phases_text(estimate) + "  " + disk_text(estimate) +
           "\n" + orientations_text(estimate);
}

std::string estimate_summary(const JobEstimate& estimate) {
    std::string text = fmt::format("{}; {:.1f} cm2 of coloured surface; {:.3g} ml", size_text(estimate),
                                   estimate.surface_mm2 / 100, estimate.body_ml);
    for (const ResinEstimate& resin : estimate.resins)
        text += fmt::format("{}{} {:.3g}", &resin == estimate.resins.data() ? " (" : ", ", resin.role, resin.ml);
    if (!estimate.resins.empty()) text += ")";
    if (estimate.price) text += fmt::format(", {:.2f} {}", *estimate.price, estimate.currency);
    if (estimate.printing.passes > 0) text += fmt::format("; {}", printing_text(estimate.printing));
    return text + fmt::format("; about {} on {} {} and {} of memory, {}", duration_text(estimate.seconds),
                              estimate.threads, estimate.threads == 1 ? "thread" : "threads",
                              memory_text(estimate.memory_bytes), disk_text(estimate));
}

std::string loop_advice(const JobEstimate& estimate) {
    constexpr double worth_a_word_s = 20;
    if (estimate.loop_s < worth_a_word_s) return {};
    return fmt::format(
        "the appearance loop takes about {} of that; --iterations N sets a limit, --iterations 0 leaves it out",
        duration_text(estimate.loop_s));
}

}  // namespace voxtone::slicer
