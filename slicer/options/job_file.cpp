// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/job_file.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <sstream>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/named_path.h"
#include "io/files/json_writer.h"
#include "io/profiles/resin_file.h"
#include "optics/colour/lamp.h"
#include "slicer/options/mark_words.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// As it was written, if it is a whole number that a double would round.
OptionValue number_of_text(const std::string& text) {
    const char* const begin = text.data();
    const char* const end = begin + text.size();
    if (std::uint64_t whole = 0; std::from_chars(begin, end, whole).ptr == end) return whole;
    double number = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(begin, end, number);
    return number;
}

std::vector<std::string> split_at(const std::string& text, char mark) {
    std::vector<std::string> parts;
    std::stringstream rest(text);
    for (std::string part; std::getline(rest, part, mark);) parts.push_back(part);
    return parts;
}

/// The object of a job file of this version, with no key but those of options.
io::JsonObject parse_job(const std::string& path) {
    const auto read = [&] {
        try {
            return io::JsonObject::read(path);
        } catch (const InputError& error) {
            throw InputError(
                fmt::format("{}; `voxtone slice --dump-default` prints a job file to start from", error.what()));
        }
    };
    io::JsonObject job = read();
    if (!job.is_text("format") || job.text("format") != "voxtone-job")
        throw InputError(fmt::format("{}: not a job file: \"format\": \"voxtone-job\" is missing", path));
    if (job.integer("version", 0, 1000000) != 1)
        job.fail("version",
                 fmt::format("version {} is unknown to this program, which reads version 1", job.any_text("version")));
    refuse_copies(job);
    std::vector<std::string> known{"format", "version", "inputs"};
    for (std::string& key : option_keys()) known.push_back(std::move(key));
    job.allow_only(known);
    return job;
}

/// Whether the text is that of a file, and not of something that comes with the program; seen from `folder`.
bool is_file_name(const std::string& text, const fs::path& folder) {
    if (text.find('/') != std::string::npos || text.ends_with(".json")) return true;
    std::error_code none;
    return !io::known_resin_set_text(text) && !optics::known_lamp(text) && fs::is_regular_file(folder / text, none);
}

/// Every path that the options of `keys` name becomes `place(path)`; paths are seen from `folder`.
template <class Wanted, class Place>
void replace_paths(SliceOptions& options, const fs::path& folder, Wanted&& wanted, Place&& place) {
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.names == OptionSpec::Names::nothing || !wanted(spec.key)) continue;
        if (spec.names == OptionSpec::Names::inputs_by_role) {
            std::string entries;
            for (const std::string& entry : split_at(spec.get(options), ',')) {
                const std::size_t file = entry.find('=') + 1;  // 0: none is named
                entries += (entries.empty() ? "" : ",") + entry.substr(0, file);
                entries += file == 0 ? entry : place(entry.substr(file));
            }
            spec.set(options, entries);
            continue;
        }
        if (spec.kind() == OptionSpec::Kind::texts) {
            const bool labels = spec.names == OptionSpec::Names::inputs_of_labels;
            for (std::string& mark : labels ? options.labels : options.decals)
                mark = with_files(labels ? MarkFamily::label : MarkFamily::decal, mark, place);
            continue;
        }
        const std::string text = spec.get(options);
        if (text.empty()) continue;  // nothing was named
        if (spec.names == OptionSpec::Names::input_or_known && !is_file_name(text, folder)) continue;
        spec.set(options, place(text));
    }
}

/// Seen from the folder, without "." and the like.
std::string path_from(const fs::path& folder, const std::string& text) {
    const fs::path path = io::named_path(folder, text).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).string();
}

/// As the folder sees it, with a '/' in it: no word of the program's own has one.
std::string path_within(const fs::path& folder, const std::string& text) {
    const std::string path = fs::proximate(text, folder).string();
    return path.find('/') == std::string::npos && path != "." ? "./" + path : path;
}

constexpr std::size_t blanks_a_level = 2;

void add_options(io::JsonWriter& json, const SliceOptions& options) {
    json.add("format", "voxtone-job").add("version", 1);
    for (const OptionSpec& spec : slice_option_table())
        if (!spec.is_preset() && !spec.is_of_another(options))
            std::visit([&](const auto& value) { json.add(spec.key, value); }, option_value(spec, options));
}

JobInput input_of(const io::JsonObject& entry, const fs::path& folder) {
    entry.allow_only({"input", "file", "sha256"});
    JobInput input;
    if (!entry.has("input") || entry.text("input").empty())
        entry.fail("input", "does not say which 'input' of the job this entry is");
    input.key = entry.text("input");
    if (entry.has("file") && !entry.text("file").empty()) input.file = path_from(folder, entry.text("file"));
    if (entry.has("sha256")) input.sha256 = entry.text("sha256");
    return input;
}

constexpr auto every_key = [](const std::string&) { return true; };

}  // namespace

OptionValue option_value(const OptionSpec& spec, const SliceOptions& options) {
    const std::string text = spec.get(options);
    switch (spec.kind()) {
        case OptionSpec::Kind::flag:
            return text == "true";
        case OptionSpec::Kind::number:
            return number_of_text(text);
        case OptionSpec::Kind::list:
            return split_at(text, ',');
        case OptionSpec::Kind::texts:
            return split_at(text, '\n');
        default:
            return text;
    }
}

SliceOptions with_absolute_paths(SliceOptions options) {
    replace_paths(options, fs::path(), every_key,
                  [](const std::string& text) { return path_from(fs::current_path(), text); });
    return options;
}

std::string job_json(const SliceOptions& options) {
    io::JsonWriter json(blanks_a_level);
    json.begin_object();
    add_options(json, with_absolute_paths(options));
    return json.end_object().text() + "\n";
}

std::string job_record(const SliceOptions& options, std::span<const JobInput> inputs, const fs::path& folder) {
    SliceOptions left = options;
    const SliceOptions defaults;
    for (const OptionSpec& spec : slice_option_table())
        if (spec.decides == Decides::this_run) spec.set(left, spec.get(defaults));
    replace_paths(left, fs::path(), every_key, [&](const std::string& text) { return path_within(folder, text); });
    io::JsonWriter json(blanks_a_level);
    json.begin_object();
    add_options(json, left);
    json.key("inputs").begin_list();
    for (const JobInput& input : inputs) {
        json.begin_object().add("input", input.key);
        if (!input.file.empty()) json.add("file", path_within(folder, input.file));
        if (!input.sha256.empty()) json.add("sha256", input.sha256);
        json.end_object();
    }
    return json.end_list().end_object().text() + "\n";
}

std::string input_named_in(const fs::path& folder, const std::string& name) {
    return name.empty() || !is_file_name(name, folder) ? name : path_from(folder, name);
}

namespace {

/// The words of a mark as an object: {"text": "A-17", "place": "bottom"}.
std::string spelled_mark(const io::JsonObject& object) {
    MarkWords words;
    for (const std::string& key : object.keys()) words.emplace_back(key, object.any_text(key));
    std::stable_partition(words.begin(), words.end(), [](const auto& word) { return is_mark_subject(word.first); });
    return spell_mark(words);
}

/// An option's value as `OptionSpec::set` takes it. Marks are texts or objects, one or a list of them.
std::string value_in(const io::JsonObject& from, const OptionSpec& spec) {
    const std::string& key = spec.key;
    if (spec.kind() != OptionSpec::Kind::texts) return from.any_text(key);
    if (from.is_object(key)) return spelled_mark(from.object(key));
    std::vector<std::string> marks;
    try {
        marks = from.is_text(key) ? std::vector{from.any_text(key)} : from.texts(key);
    } catch (const InputError&) {
        for (const io::JsonObject& mark : from.objects(key)) marks.push_back(spelled_mark(mark));
    }
    std::string lines;
    for (const std::string& mark : marks) {
        if (!lines.empty()) lines += '\n';
        for (const char c : mark) lines += c == '\n' ? "\\n" : std::string(1, c);  // of one text
    }
    return lines;
}

}  // namespace

std::vector<std::string> take_options(const io::JsonObject& from, const fs::path& folder, SliceOptions& options) {
    const SliceOptions defaults;
    std::vector<std::string> taken, set_by_preset;
    for (const OptionSpec& spec : slice_option_table()) {
        if (!from.has(spec.key)) continue;
        try {
            SliceOptions said;
            spec.set(said, value_in(from, spec));
            if (spec.get(said) == spec.get(defaults) &&
                std::ranges::find(set_by_preset, spec.key) != set_by_preset.end())
                continue;
            spec.set(options, value_in(from, spec));
        } catch (const UsageError& error) {
            from.fail(spec.key, error.what());
        }
        for (const OptionSpec::Preset& preset : spec.presets)
            for (const auto& [set, value] : preset.values) set_by_preset.push_back(set);
        taken.push_back(spec.key);
    }
    replace_paths(
        options, folder, [&](const std::string& key) { return from.has(key); },
        [&](const std::string& text) { return path_from(folder, text); });
    return taken;
}

bool is_word_for_copies(std::string_view key) {
    constexpr std::string_view words[]{"copies", "count", "quantity", "qty", "amount", "pieces"};
    return std::ranges::find(words, key) != std::end(words);
}

void refuse_copies(const io::JsonObject& of_job) {
    for (const std::string& key : of_job.keys())
        if (is_word_for_copies(key))
            of_job.fail(key,
                        "copies are a tray's, and a job is of one print: name the model in a part of a tray's plan, "
                        "with \"copies\" (`voxtone tray`)");
}

void read_job(const std::string& path, SliceOptions& options) {
    const io::JsonObject job = parse_job(path);
    const fs::path folder = fs::path(path).parent_path();
    const SliceOptions defaults;
    for (const std::string& key : take_options(job, folder, options))
        if (const OptionSpec& spec = *find_option(key); spec.get(options) != spec.get(defaults))
            options.named.push_back(key);
    if (!job.has("inputs")) return;
    options.recorded_inputs.clear();
    for (const io::JsonObject& entry : job.objects("inputs"))
        options.recorded_inputs.push_back(input_of(entry, folder));
}

}  // namespace voxtone::slicer
