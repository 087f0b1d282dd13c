// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/units.h"
#include "io/files/json_object.h"
#include "slicer/batch/job_names.h"
#include "slicer/batch/plan_rows.h"
#include "slicer/options/command_words.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr int most_copies = 10'000;
constexpr double most_mm = 10'000;
constexpr const char *parts_key = "parts", *gap_key = "gap", *name_key = "name", *copies_key = "copies", *at_key = "at",
                     *priority_key = "priority", *cuts_key = "cuts";

/// Of a print, and so of all its parts.
constexpr const char* of_the_tray[] = {"out",       "overwrite", "resume",  "printer", "resins",     "load",
                                       "formats",   "layers",    "threads", "shard",   "until",      "mixtures",
                                       "read-time", "memory",    "strict",  "report",  "read-memory"};

void expect_keys(const io::JsonObject& object, std::vector<std::string> known) {
    for (const OptionSpec& spec : slice_option_table()) known.push_back(spec.key);
    object.allow_only(known);
}

/// "2mm", or millimetres as a number.
double length_of(const io::JsonObject& object, const char* key) {
    const double mm = parse_length_mm(object.any_text(key), key);
    if (!(mm >= 0 && mm <= most_mm)) object.fail(key, "is a length from 0 to 10 m");
    return mm;
}

std::array<double, 3> place_of(const io::JsonObject& object, const std::vector<double>& values) {
    if (values.size() != 2 && values.size() != 3)
        object.fail(at_key, "is a place, [x, y] or [x, y, z] in mm, or a list of places, one for each copy");
    for (const double v : values)
        if (!(v >= 0 && v <= most_mm)) object.fail(at_key, "is counted in mm from the tray's corner: from 0 to 10000");
    return {values[0], values[1], values.size() == 3 ? values[2] : 0};
}

/// One place, or a list of them.
std::vector<std::array<double, 3>> places_of(const io::JsonObject& object) {
    std::vector<std::array<double, 3>> places;
    std::vector<std::vector<double>> lists;
    try {
        lists = object.number_lists(at_key, 0, 0, most_mm);
    } catch (const InputError&) {
        lists = {object.numbers(at_key, 0, 0, most_mm)};
    }
    for (const std::vector<double>& list : lists) places.push_back(place_of(object, list));
    return places;
}

TrayPart part_of(const io::JsonObject& object, const fs::path& folder, const SliceOptions& common, std::string place) {
    expect_keys(object, {name_key, copies_key, at_key, priority_key, cuts_key});
    for (const char* key : of_the_tray)
        if (object.has(key)) object.fail(key, "is one for the whole tray: say it beside \"parts\", not in one of them");
    TrayPart part;
    part.options = common;
    part.place = std::move(place);
    const std::vector<std::string> said = take_options(object, folder, part.options);
    if (part.options.model.empty()) object.fail("model", "names the part's model or picture");
    part.options = with_absolute_paths(std::move(part.options));
    drop_idle(part.options, said);  // what is said for all is meant where it can be: a picture has no size
    part.name = object.has(name_key) ? object.any_text(name_key) : fs::path(part.options.model).stem().string();
    if (object.has(at_key)) part.at_mm = places_of(object);
    part.copies = static_cast<int>(part.at_mm.empty() ? 1 : part.at_mm.size());
    const auto whole = [&](const char* key, int least, int most) {
        const std::string text = object.any_text(key);
        int value = 0;
        try {
            std::size_t end = 0;
            value = std::stoi(text, &end);
            if (end != text.size()) value = least - 1;
        } catch (const std::exception&) {
            value = least - 1;
        }
        if (value < least || value > most)
            object.fail(key, fmt::format("is a whole number from {} to {}", least, most));
        return value;
    };
    if (object.has(copies_key)) part.copies = whole(copies_key, 1, most_copies);
    if (object.has(priority_key)) part.priority = whole(priority_key, -1000, 1000);
    if (!part.at_mm.empty() && part.at_mm.size() != static_cast<std::size_t>(part.copies))
        object.fail(at_key, fmt::format("gives {} places for {} copies; give one for each, or none", part.at_mm.size(),
                                        part.copies));
    if (object.has(cuts_key)) {
        const std::string text = object.any_text(cuts_key);
        if (text != "true" && text != "false") object.fail(cuts_key, "is true or false");
        part.cuts = text == "true";
    }
    return part;
}

/// A name for each part that is a folder's; those that the plan does not name are numbered where two are alike.
void settle_names(TrayPlan& plan) {
    std::map<std::string, int> times;
    for (const TrayPart& part : plan.parts) ++times[part.name];
    std::map<std::string, std::string> taken;
    std::map<std::string, int> numbers;
    for (TrayPart& part : plan.parts) {
        if (times[part.name] > 1) part.name += fmt::format("-{}", ++numbers[part.name]);
        if (const std::string fault = name_fault(part.name); !fault.empty())
            throw InputError(fmt::format("{}: the part's name '{}' {}; give it another under \"name\"", part.place,
                                         part.name, fault));
        const auto [other, is_new] = taken.emplace(part.name, part.place);
        if (!is_new)
            throw InputError(fmt::format("{}: is called '{}', as {} is; give one of them another \"name\"", part.place,
                                         part.name, other->second));
    }
}

TrayPlan plan_of_table(const std::string& file, const SliceOptions& common) {
    const PlanRows rows = read_plan_rows(std::vector<std::string>{file});
    if (!rows.faults.empty()) throw InputError(rows.faults.front());
    TrayPlan plan;
    plan.common = common;
    for (const PlanRow& row : rows.rows) {
        const std::string place = fmt::format("{}: line {}", rows.source, row.line);
        plan.parts.push_back(part_of(io::JsonObject::parse(row.json, place), row.folder, plan.common, place));
    }
    return plan;
}

TrayPlan plan_of_object(const std::string& file, const SliceOptions& common) {
    const io::JsonObject object = io::JsonObject::read(file);
    expect_keys(object, {"format", "version", parts_key, gap_key});
    if (!object.has("format") || object.text("format") != "voxtone-tray")
        object.fail("format",
                    "must be \"voxtone-tray\"; the plan of a batch, a job for each line, is `voxtone batch`'s");
    if (object.integer("version", 1, 1000) != 1) object.fail("version", "is 1: a newer voxtone wrote this plan");
    if (object.has("model")) object.fail("model", "belongs to a part: {\"parts\": [{\"model\": ...}]}");
    if (object.has("out")) object.fail("out", "is not the plan's to say: name the folder with -o");
    const fs::path folder = fs::path(file).parent_path();
    TrayPlan plan;
    plan.common = common;
    (void)take_options(object, folder, plan.common);
    if (object.has(gap_key)) plan.gap_mm = length_of(object, gap_key);
    int number = 0;
    for (const io::JsonObject& part : object.objects(parts_key))
        plan.parts.push_back(part_of(part, folder, plan.common, fmt::format("{}: parts[{}]", file, number++)));
    return plan;
}

}  // namespace

TrayPlan read_tray_plan(const std::string& file, const SliceOptions& common) {
    TrayPlan plan = fs::path(file).extension() == ".csv" ? plan_of_table(file, common) : plan_of_object(file, common);
    if (plan.parts.empty()) throw InputError(fmt::format("{}: has no part; name a model for each in \"parts\"", file));
    settle_names(plan);
    return plan;
}

TrayPlan tray_of_models(const std::vector<std::string>& models, const SliceOptions& common) {
    TrayPlan plan;
    plan.common = common;
    for (const std::string& model : models) {
        TrayPart part;
        part.options = common;
        part.options.model = model;
        part.options = with_absolute_paths(std::move(part.options));
        drop_idle(part.options, {});
        part.name = fs::path(model).stem().string();
        part.place = model;
        plan.parts.push_back(std::move(part));
    }
    settle_names(plan);
    return plan;
}

}  // namespace voxtone::slicer
