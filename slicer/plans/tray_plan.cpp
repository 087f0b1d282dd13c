// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/tray_plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/files/csv_table.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/read_bytes.h"
#include "io/layers/stack_folder.h"
#include "io/models/model_reader.h"
#include "slicer/options/command_words.h"
#include "slicer/options/job_file.h"
#include "slicer/options/label_template.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"
#include "slicer/plans/fault_list.h"
#include "slicer/plans/job_names.h"
#include "slicer/plans/labelled_copies.h"
#include "slicer/plans/plan_table.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr int most_copies = 10'000;
constexpr double most_mm = 10'000;
constexpr const char *parts_key = "parts", *name_key = "name", *copies_key = "copies", *at_key = "at",
                     *priority_key = "priority", *cuts_key = "cuts", *turn_key = "turn", *first_key = "first";
constexpr std::string_view format_name = "voxtone-tray";

/// Of a print, and so of all its parts.
constexpr const char* of_the_tray[] = {"out",     "overwrite", "resume",      "printer",    "resins", "load",
                                       "formats", "layers",    "threads",     "shard",      "until",  "mixtures",
                                       "memory",  "strict",    "read-time",   "report",     "gap",    "arrange",
                                       "trays",   "fail-fast", "read-memory", "for-printer"};

/// Of a plan or a part, whose `words` are no options.
std::vector<std::string> with_options(std::vector<std::string> words) {
    for (std::string& key : option_keys()) words.push_back(std::move(key));
    return words;
}
std::vector<std::string> keys_of_plan() { return with_options({"format", "version", parts_key}); }
/// Of which one says what the part is.
std::vector<std::string> keys_of_bodies() {
    std::vector<std::string> words = component_keys();
    words.insert(words.end(), {"model", std::string(part_job_key)});
    return words;
}

/// Texts of the user's own. Throws InputError for keys that are none.
TemplateValues own_values(const io::JsonObject& object, const std::vector<std::string>& known) {
    for (const std::string& key : object.keys())
        if (is_word_for_copies(key) && std::ranges::find(known, key) == known.end())
            object.fail(key, "is said in a part, as \"copies\": {\"model\": ..., \"copies\": 3}");
    return values_of_row(object, known);
}

std::array<double, 3> place_of(const io::JsonObject& object, const std::vector<double>& values) {
    if (values.size() != 2 && values.size() != 3)
        object.fail(at_key, "is a place, [x, y] or [x, y, z] in mm, or a list of places, one for each copy");
    for (const double v : values)
        if (!(v >= 0 && v <= most_mm)) object.fail(at_key, "is counted in mm from the tray's corner: from 0 to 10000");
    return {values[0], values[1], values.size() == 3 ? values[2] : 0};
}

/// "10 20; 30 40 5", as a cell of a table has it.
std::vector<std::vector<double>> numbers_in(const io::JsonObject& object, std::string text) {
    std::ranges::replace(text, ',', ' ');
    std::vector<std::vector<double>> lists;
    std::istringstream places(text);
    for (std::string place; std::getline(places, place, ';');) {
        std::vector<double>& list = lists.emplace_back();
        std::istringstream words(place);
        for (std::string word; words >> word;) try {
                list.push_back(parse_number<double>(at_key, word));
            } catch (const UsageError& error) {
                object.fail(at_key, error.what());
            }
    }
    return lists;
}

/// One place, or a list of them.
std::vector<std::array<double, 3>> places_of(const io::JsonObject& object) {
    std::vector<std::array<double, 3>> places;
    std::vector<std::vector<double>> lists;
    if (object.is_text(at_key)) {
        lists = numbers_in(object, object.text(at_key));
    } else {
        try {
            lists = object.number_lists(at_key, 0, 0, most_mm);
        } catch (const InputError&) {
            lists = {object.numbers(at_key, 0, 0, most_mm)};
        }
    }
    for (const std::vector<double>& list : lists) places.push_back(place_of(object, list));
    return places;
}

void take_model(const io::JsonObject& object, const fs::path& folder, TrayPart& part) {
    std::vector<std::string> said;
    if (object.has(part_job_key)) part.job = take_part_job(object, folder, of_the_tray, part.options, said);
    const std::vector<std::string> of_part = take_options(object, folder, part.options);
    said.insert(said.end(), of_part.begin(), of_part.end());
    part.turn = part.options.turn;
    part.options.turn = false;
    std::erase(said, turn_key);
    if (part.options.model.empty())
        object.fail(
            "model",
            "is missing: it names the part's model or picture; so does a \"job\", and a component is a \"box\", "
            "\"cylinder\", \"stack\" or \"gcvf\"");
    part.options = with_absolute_paths(std::move(part.options));
    drop_idle(part.options, said);  // what is said for all is meant where it can be: a picture has no size
}

bool truth_of(const io::JsonObject& object, const char* key) {
    if (!object.has(key)) return false;
    const std::string text = object.any_text(key);
    if (text != "true" && text != "false") object.fail(key, "is true or false");
    return text == "true";
}

TrayPart part_of(const io::JsonObject& object, const fs::path& folder, const SliceOptions& common, std::string place) {
    TemplateValues own = own_values(object, keys_of_part());
    for (const char* key : of_the_tray)
        if (object.has(key))
            object.fail(key,
                        "is one for the whole tray: say it beside \"parts\", or on the command line, and not in one of "
                        "them");
    TrayPart part;
    part.options = common;
    part.place = std::move(place);
    part.values = std::move(own);
    part.cuts = truth_of(object, cuts_key);
    part.first = truth_of(object, first_key);
    part.component = component_of(object, folder, part.cuts);
    const bool is_body = part.component && part.component->kind == ComponentKind::body;
    if (!part.component || is_body) take_model(object, folder, part);
    if (is_body) {
        part.turn = false;  // its voxels are made before places are looked for
        part.options.labels.clear();
        part.options.decals.clear();
    }
    part.has_own_name = object.has(name_key);
    part.name = part.has_own_name ? object.any_text(name_key)
                : part.component  ? part.component->usual_name()
                                  : fs::path(part.options.model).stem().string();
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
    return part;
}

/// Two parts for which the plan has one name are a mistake, two of one model's are not.
void refuse_equal_names(const TrayPlan& plan) {
    std::map<std::string, const TrayPart*> named;
    for (const TrayPart& part : plan.parts) {
        if (!part.has_own_name) continue;
        const auto [other, is_new] = named.emplace(part.name, &part);
        if (!is_new)
            throw InputError(
                fmt::format("{}: is named '{}', as {} is; their folders in OUT/parts would be one: give one of them "
                            "another \"name\", or make it one part of several \"copies\"",
                            part.place, part.name, other->second->place));
    }
}

/// A name for each part that is a folder's; those that the plan does not name are numbered where two are alike.
void settle_names(TrayPlan& plan) {
    std::map<std::string, int> times;
    for (const TrayPart& part : plan.parts) ++times[part.name];
    std::map<std::string, std::string> taken;
    std::map<std::string, int> numbers;
    for (TrayPart& part : plan.parts) {
        if (times[part.name] > 1 && !part.has_own_name) part.name += fmt::format("-{}", ++numbers[part.name]);
        if (const std::string fault = name_fault(part.name); !fault.empty())
            throw InputError(fmt::format("{}: the part's name '{}' {}; give it another under \"name\"", part.place,
                                         part.name, fault));
        const auto [other, is_new] = taken.emplace(part.name, part.place);
        if (!is_new)
            throw InputError(fmt::format("{}: is called '{}', as {} is; give one of them another \"name\"", part.place,
                                         part.name, other->second));
    }
}

/// A part as a file of either kind has it.
struct PartRow {
    io::JsonObject object;
    std::string place;
};

struct PlanText {
    std::optional<io::JsonObject> common;  ///< of a table nothing
    std::vector<PartRow> parts;
    std::vector<std::string> faults;  ///< of lines that are no part
};

std::string text_of(const fs::path& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    return io::read_text(file, most_bytes);
}

bool is_table(const fs::path& file) { return io::is_table_file(file, "model"); }

/// What can be known to be wrong of the header, before the same is said of each line.
void check_header(const PlanTable& table, const std::string& file) {
    io::JsonWriter json;
    json.begin_object();
    for (const std::string& word : table.header) json.add(word, "");
    const std::string place = fmt::format("{}: line {}", file, table.header_line);
    (void)own_values(io::JsonObject::of_line(json.end_object().text(), place), keys_of_part());
    const std::vector<std::string> bodies = keys_of_bodies();
    if (std::ranges::find_first_of(table.header, bodies) == table.header.end())
        throw InputError(
            fmt::format("{}: has no column `model`, which names the model or picture of each part; its columns are {}",
                        place, fmt::join(table.header, ", ")));
}

PlanText text_of_table(const std::string& file) {
    const PlanTable table = plan_table(text_of(file), keys_of_part());
    PlanText plan;
    for (const std::string& fault : table.faults) plan.faults.push_back(fmt::format("{}: {}", file, fault));
    if (!table.header.empty()) check_header(table, file);
    for (const PlanTableRow& row : table.rows) {
        const std::string place = fmt::format("{}: line {}", file, row.line);
        plan.parts.push_back({io::JsonObject::of_line(row.json, place), place});
    }
    return plan;
}

/// Whether it was made of models that were named without a plan: who named them knows no such file.
bool is_of_models(const fs::path& file) {
    return file.filename() == tray_plan_name && file.parent_path().filename() == io::parts_name;
}

/// From here, where it lies below.
std::string shown_path(const fs::path& file) {
    const fs::path whole = fs::absolute(file).lexically_normal(), near = whole.lexically_proximate(fs::current_path());
    return (near.empty() || *near.begin() == ".." ? whole : near).string();
}

PlanText text_of_object(const std::string& file) {
    io::JsonObject object = io::JsonObject::read(file);
    if (object.has("format") && object.any_text("format") == "voxtone-job")
        object.fail("format", "is that of a job of one model: `voxtone slice --job FILE` takes it");
    if (!object.has("format") || object.text("format") != format_name)
        object.fail("format",
                    "must be \"voxtone-tray\"; the plan of a batch, a job for each line, is `voxtone batch`'s");
    (void)own_values(object, keys_of_plan());
    if (object.integer("version", 1, 1000) != 1) object.fail("version", "is 1: a newer voxtone wrote this plan");
    if (object.has("model")) object.fail("model", "belongs to a part: {\"parts\": [{\"model\": ...}]}");
    if (object.has("out")) object.fail("out", "is not the plan's to say: name the folder with -o");
    PlanText plan;
    int number = 0;
    for (io::JsonObject& part : object.objects(parts_key)) {
        std::string place = is_of_models(file) ? shown_path(fs::path(file).parent_path() / part.text("model"))
                                               : fmt::format("{}: parts[{}]", file, number++);
        plan.parts.push_back({std::move(part), std::move(place)});
    }
    plan.common = std::move(object);
    return plan;
}

/// What the plan says of all parts; where the user said it besides, that.
void take_common(const io::JsonObject& object, const fs::path& folder, const SliceOptions& said, SliceOptions& common) {
    (void)take_options(object, folder, common);
    for (const std::string& key : said.named)
        if (const OptionSpec& spec = *find_option(key); key != "model") spec.set(common, spec.get(said));
}

}  // namespace

namespace {

void note_own_words(const PlanText& text, TrayPlan& plan) {
    std::set<std::string> own;
    const auto add = [&](const io::JsonObject& object, const std::vector<std::string>& known) {
        for (std::string& word : own_words(object, known)) own.insert(std::move(word));
    };
    if (text.common) add(*text.common, keys_of_plan());
    for (const PartRow& part : text.parts) add(part.object, keys_of_part());
    if (!own.empty()) plan.notes.push_back(own_words_note(own));
}

TrayPlan plan_of_text(const PlanText& text, const std::string& file, const fs::path& folder,
                      const SliceOptions& common) {
    if (text.parts.empty() && text.faults.empty())
        throw InputError(fmt::format(
            "{}: has no part; {}", file,
            text.common ? "name a model for each in \"parts\"" : "each has a line below the header, with its model"));
    TrayPlan plan;
    plan.file = file;
    plan.common = common;
    plan.common.model.clear();
    if (text.common) take_common(*text.common, folder, common, plan.common);
    FaultList faults;
    for (const std::string& fault : text.faults) faults.look([&] { throw InputError(fault); });
    for (const PartRow& part : text.parts)
        faults.look([&] { plan.parts.push_back(part_of(part.object, folder, plan.common, part.place)); });
    faults.expect_none(fmt::format("{} of the {} parts of {} are not as a plan has them", faults.size(),
                                   text.parts.size() + text.faults.size(), file));
    if (text.common)
        for (TrayPart& part : plan.parts) part.values.merge(own_values(*text.common, keys_of_plan()));
    note_own_words(text, plan);
    refuse_equal_names(plan);
    label_copies(plan);
    settle_names(plan);
    return plan;
}

}  // namespace

std::vector<std::string> keys_of_part() {
    std::vector<std::string> words = component_keys();
    words.insert(words.end(),
                 {std::string(part_job_key), name_key, copies_key, at_key, priority_key, cuts_key, first_key});
    return with_options(std::move(words));
}

TrayPlan read_tray_plan(const std::string& file, const SliceOptions& common) {
    return plan_of_text(is_table(file) ? text_of_table(file) : text_of_object(file), file, fs::path(file).parent_path(),
                        common);
}

TrayPlan tray_plan_of_models(const TrayModels& models, const SliceOptions& common) {
    const fs::path here = fs::current_path();
    const std::string file(tray_plan_name);
    const io::JsonObject object = io::JsonObject::parse(tray_plan_of(models, here), file);
    PlanText text;
    for (io::JsonObject& part : object.objects(parts_key)) {
        std::string place = shown_path(here / part.text("model"));
        text.parts.push_back({std::move(part), std::move(place)});
    }
    return plan_of_text(text, file, here, common);
}

std::string tray_plan_of(const TrayModels& models, const fs::path& folder) {
    io::JsonWriter json;
    json.begin_object().add("format", format_name).add("version", 1).key(parts_key).begin_list();
    for (const std::string& model : models.files) {
        json.line().begin_object();
        json.add("model", fs::proximate(fs::absolute(model), fs::absolute(folder)).generic_string());
        if (models.copies > 1) json.add(copies_key, models.copies);
        json.end_object();
    }
    return json.end_list().end_object().text() + "\n";
}

bool is_tray_plan(const fs::path& file) {
    const bool json = io::extension_of(file) == "json";
    if (std::error_code none; !fs::is_regular_file(file, none) || (!json && !is_table(file))) return false;
    try {
        if (json) {
            const io::JsonObject object = io::JsonObject::read(file);
            return object.has("format") && object.any_text("format") == format_name;
        }
        const std::vector<std::string> header = plan_table(text_of(file), keys_of_part()).header;
        return std::ranges::any_of(header, [](const std::string& word) {
            const std::vector<std::string> components = component_keys();
            if (word == part_job_key) return true;
            if (std::ranges::find(components, word) != components.end()) return true;
            return word == copies_key || word == at_key || word == priority_key || word == cuts_key ||
                   word == turn_key || word == first_key;
        });
    } catch (const Error&) {
        return false;  // whoever reads it says what is wrong
    }
}

}  // namespace voxtone::slicer
