// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/tray_record.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/machine_memory.h"
#include "base/process_usage.h"
#include "base/progress_bar.h"
#include "base/warning.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/layers/stack_folder.h"
#include "io/report/report.h"
#include "slicer/part/report_files.h"
#include "slicer/plans/part_about.h"
#include "slicer/plate/part_outline.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// Of a component, which shows what it shows.
constexpr const char* no_verdict = "none: component";
constexpr const char *verdict_key = "verdict", *failed_key = "failed", *customer_key = "customer";

int copies_on(const ReadyPart& part, int tray) { return int(std::ranges::count(part.copies, tray, &PlacedCopy::tray)); }

double mm3_of(const PreparedTray& prepared, int tray, std::uint64_t voxels) {
    return double(voxels) * prepared.places.trays[std::size_t(tray)].voxel_volume_mm3();
}

std::optional<io::JsonObject> own_verdict(const ReadyPart& part) {
    if (part.report.empty()) return std::nullopt;
    const io::JsonObject report = io::JsonObject::parse(part.report, "report");
    if (!report.has(verdict_key) || !report.is_object(verdict_key)) return std::nullopt;
    return report.object(verdict_key);
}

/// As its own report says; empty: it has none, or as of a draft none on its looks.
std::string verdict_of(const ReadyPart& part) {
    const std::optional<io::JsonObject> verdict = own_verdict(part);
    std::string level = verdict ? verdict->text("level") : std::string();
    return level == name_of(io::VerdictLevel::unknown) ? std::string() : level;
}

/// What its page says first; of a draft what of its colours the resins reach.
std::string sentence_of(const ReadyPart& part) {
    const std::optional<io::JsonObject> verdict = own_verdict(part);
    return verdict ? verdict->text("sentence") : std::string();
}

/// What its own report says first, with its figure.
std::string verdict_line(const ReadyPart& part) {
    if (part.component) return "not predicted: a " + std::string(name_of(part.part.component->kind));
    if (part.alone.empty()) return "one body with what lies beside it";
    const std::optional<io::JsonObject> verdict = own_verdict(part);
    if (!verdict) return "not predicted";
    std::string text = verdict_of(part);
    if (text.empty())
        return verdict->has("headline") ? "not predicted; " + verdict->text("headline") : std::string("not predicted");
    if (verdict->has("seen_de2000"))
        text += fmt::format(", {:.1f} CIEDE2000", verdict->object("seen_de2000").number("mean", 0, 1000));
    return text;
}

void write_places(io::JsonWriter& json, const ReadyPart& part, int tray, const VoxelGrid& grid,
                  const std::array<double, 3>& corner_mm) {
    json.key("at_px").begin_list();
    for (const PlacedCopy& copy : part.copies)
        if (copy.tray == tray) json.value(copy.at);
    json.end_list().key("at_mm").begin_list();
    for (const PlacedCopy& copy : part.copies) {
        if (copy.tray != tray) continue;
        std::array<double, 3> mm = corner_mm;
        for (std::size_t axis = 0; axis < 3; ++axis) mm[axis] += grid.pitch_mm[int(axis)] * copy.at[axis];
        json.value(mm);
    }
    json.end_list();
}

}  // namespace

std::vector<Overlap> overlaps_of(const PreparedTray& prepared, int tray, const std::vector<Overlap>& of_copies) {
    std::vector<Overlap> sums;
    std::size_t at = 0;
    for (const ReadyPart& part : prepared.parts.ready) {
        Overlap& sum = sums.emplace_back();
        for (auto left = std::ranges::count(part.alone, tray, &PlacedCopy::tray); left > 0; --left, ++at) {
            sum.voxels += of_copies[at].voxels;
            sum.to_equals += of_copies[at].to_equals;
        }
    }
    return sums;
}

std::vector<std::string> overlap_notes(const PreparedTray& prepared, int tray, const std::vector<Overlap>& overlaps) {
    std::vector<std::string> notes;
    for (std::size_t p = 0; p < overlaps.size(); ++p) {
        if (overlaps[p].voxels == 0) continue;
        std::string note = fmt::format("{}: {:.1f} mm3 of it lie where another part is printed",
                                       prepared.parts.ready[p].part.name, mm3_of(prepared, tray, overlaps[p].voxels));
        if (overlaps[p].to_equals > 0)
            note += fmt::format(
                ", {:.1f} of them one of the same priority, which has them because it stands later in the plan: say by "
                "\"priority\" whose they are",
                mm3_of(prepared, tray, overlaps[p].to_equals));
        notes.push_back(named_warning("parts-overlap", std::move(note)));
    }
    return notes;
}

std::vector<io::StackMember> members_of(const PreparedTray& prepared, int tray) {
    std::vector<io::StackMember> members;
    const Eigen::Vector3d pitch_mm = prepared.places.trays[std::size_t(tray)].pitch_mm;
    for (const ReadyPart& part : prepared.parts.ready) {
        if (part.is_joined || copies_on(part, tray) == 0) continue;
        const VoxelGrid& own = part.grid();
        io::StackMember member{
            part.part.name, {}, 0, part.component ? no_verdict : verdict_of(part), about_part(part.part)};
        for (const PlacedCopy& copy : part.copies) {
            if (copy.tray != tray) continue;
            std::array<double, 6>& box = member.boxes_mm.emplace_back();
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box[axis] = copy.at[axis] * pitch_mm[Eigen::Index(axis)];
                box[axis + 3] = (copy.at[axis] + own.size[axis]) * pitch_mm[Eigen::Index(axis)];
            }
        }
        if (!part.part.cuts)
            member.ml = double(part.component ? part.component->all_voxels() : voxels_of(part.ready->body)) *
                        own.voxel_volume_mm3() * 1e-3 * double(member.boxes_mm.size());
        members.push_back(std::move(member));
    }
    return members;
}

std::string tray_json(const PreparedTray& prepared, int tray, const std::vector<Overlap>& overlaps,
                      const io::StackDescription& stack) {
    const VoxelGrid& grid = prepared.places.trays[std::size_t(tray)];
    const std::array<double, 3>& corner = prepared.places.corner_mm[std::size_t(tray)];
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-tray-stack").add("version", 1);
    json.add("tray", tray + 1).add("trays", prepared.trays()).add("corner_mm", corner);
    json.add("content_sha256", stack.content_sha256).add("layers", stack.layers).key("parts").begin_list();
    for (std::size_t p = 0; p < prepared.parts.ready.size(); ++p) {
        const ReadyPart& part = prepared.parts.ready[p];
        json.line().begin_object().add("name", part.part.name);
        if (part.component)
            json.add("component", name_of(part.part.component->kind)).add("model", part.part.component->path);
        else
            json.add("model", part.ready->job.options.model);
        if (part.is_joined) json.add("joined", true);
        if (!part.component) json.add("illuminant", part.ready->job.options.illuminant);
        json.add("rotate", part.ready ? part.ready->job.options.raw.rotate : "").add("priority", part.part.priority);
        json.add("cuts", part.part.cuts).add("size_px", part.grid().size);
        write_places(json, part, tray, grid, corner);
        const auto joined = double(std::ranges::count(part.alone, tray, &PlacedCopy::tray));
        json.add("overlapped_mm3", mm3_of(prepared, tray, overlaps[p].voxels) + joined * part.shared_mm3);
        json.add("overlapped_by_equals_mm3", mm3_of(prepared, tray, overlaps[p].to_equals));
        if (!part.page.empty()) json.add("report", part.page);
        if (const std::string verdict = verdict_of(part); !verdict.empty()) json.add(verdict_key, verdict);
        if (const std::string sentence = sentence_of(part); !sentence.empty()) json.add("sentence", sentence);
        json.end_object();
    }
    json.end_list().key(failed_key).begin_list();
    for (const FailedPart& part : prepared.parts.failed) {
        json.begin_object().add("name", part.name).add("exit_code", static_cast<int>(part.exit_code));
        if (!part.customer.empty()) json.add(customer_key, part.customer);
        json.add("message", part.message).end_object();
    }
    return json.end_list().end_object().text();
}

std::string tray_summary(const PreparedTray& prepared, int tray, const io::StackDescription& stack, double seconds,
                         const fs::path& folder) {
    std::string text = fmt::format("{}: {:.2f} x {:.2f} x {:.2f} mm, {} x {} px, {} layers of {:g} um\n",
                                   folder.string(), stack.size_mm[0], stack.size_mm[1], stack.size_mm[2],
                                   stack.size_px[0], stack.size_px[1], stack.layers, stack.pitch_um[2]);
    for (const ReadyPart& part : prepared.parts.ready)
        if (const int copies = copies_on(part, tray); copies > 0)
            text += fmt::format("  {:<20} {:<10} {}\n", part.is_joined ? part.ready->body.name : part.part.name,
                                copies == 1 ? "once" : fmt::format("{} copies", copies), verdict_line(part));
    for (const FailedPart& part : prepared.parts.failed)
        text += fmt::format("  {:<20} fails: {}\n", part.who(), part.message);
    for (const io::StackResin& resin : stack.resins)
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml\n", resin.role, resin.name, resin.ml);
    if (prepared.any_job().options.report) text += fmt::format("  report: {}\n", (folder / report_file::page).string());
    return text +
           fmt::format("  done in {}; peak memory {}\n", duration_text(seconds), memory_text(peak_memory_bytes()));
}

std::string failure_of(const PreparedTray& prepared) {
    std::string text;
    for (const ReadyPart& part : prepared.parts.ready)
        if (verdict_of(part) == name_of(io::VerdictLevel::bad))
            text += fmt::format("{}: {}\n", part.is_joined ? part.ready->body.name : part.part.name, sentence_of(part));
    return prepared.parts.failed.empty() ? text : std::string();
}

std::vector<std::string> verdicts_of(const PreparedTray& prepared) {
    std::vector<std::string> verdicts;
    for (const ReadyPart& part : prepared.parts.ready)
        if (std::string verdict = verdict_of(part); !verdict.empty()) verdicts.push_back(std::move(verdict));
    return verdicts;
}

ExitCode exit_code_of(const OpenedTray& tray, const std::vector<FailedPart>& failed,
                      const std::vector<std::string>& verdicts) {
    if (!failed.empty()) return failed.front().exit_code;
    const bool bad = std::ranges::find(verdicts, name_of(io::VerdictLevel::bad)) != verdicts.end();
    return bad && tray.plan.common.strict ? ExitCode::check_failed : ExitCode::done;
}

std::optional<TrayEnding> ending_in(const fs::path& folder) {
    try {
        const io::JsonObject tray = io::JsonObject::read(folder / tray_file_name);
        TrayEnding ending;
        for (const io::JsonObject& part : tray.objects("parts"))
            if (part.has(verdict_key)) ending.verdicts.push_back(part.text(verdict_key));
        for (const io::JsonObject& part : tray.objects(failed_key))
            ending.failed.push_back({part.text("name"), part.text("message"),
                                     static_cast<ExitCode>(part.integer("exit_code", 0, 255)),
                                     part.has(customer_key) ? part.text(customer_key) : std::string()});
        return ending;
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace voxtone::slicer
