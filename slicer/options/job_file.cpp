// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/options/job_file.h"

#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/files/json_keys.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::slicer {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json json_value(const OptionSpec& spec, const std::string& value) {
    switch (spec.kind) {
        case OptionSpec::Kind::flag:
            return value == "true";
        case OptionSpec::Kind::number:
            return Json::parse(value);
        case OptionSpec::Kind::list: {
            Json list = Json::array();
            std::stringstream parts(value);
            for (std::string part; std::getline(parts, part, ',');) list.push_back(part);
            return list;
        }
        default:
            return value;
    }
}

std::string option_text(const Json& value, const std::string& where) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
    if (value.is_number()) return value.dump();
    if (value.is_array()) {
        std::string text;
        for (const Json& item : value) {
            if (!item.is_string()) throw InputError(where + ": a list of texts is expected");
            if (!text.empty()) text += ',';
            text += item.get<std::string>();
        }
        return text;
    }
    throw InputError(where + ": a text, a number, true, false or a list of texts is expected");
}

/// The object of a job file of this version.
Json parse_job(const std::string& path) {
    std::ifstream file(path);
    if (!file)
        throw FileError(fmt::format("{}: the job file cannot be read; check the path and its permissions", path));
    Json job;
    try {
        job = Json::parse(file);
    } catch (const Json::parse_error& error) {
        throw InputError(
            fmt::format("{}: not valid JSON at byte {}; `voxtone slice --dump-default` prints a job file to start from",
                        path, error.byte));
    }
    if (!job.is_object() || job.value("format", Json()) != "voxtone-job")
        throw InputError(fmt::format("{}: not a job file: \"format\": \"voxtone-job\" is missing", path));
    if (job.value("version", Json()) != 1)
        throw InputError(fmt::format("{}: version {} is unknown to this program, which reads version 1", path,
                                     job.value("version", Json()).dump()));
    return job;
}

const OptionSpec& find_option(const std::string& key, const std::string& path) {
    std::vector<std::string> known{"format", "version", "inputs"};
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.key == key) return spec;
        known.push_back(spec.key);
    }
    throw InputError(fmt::format("{}: {}", path, io::unknown_key_message(key, known)));
}

/// Whether the text is that of a file, and not of something that comes with the program; seen from `folder`.
bool is_file_name(const std::string& text, const fs::path& folder) {
    if (text.find('/') != std::string::npos || text.ends_with(".json")) return true;
    std::error_code none;
    return !io::known_resin_set_text(text) && fs::is_regular_file(folder / text, none);
}

/// Every path that the options of `keys` name becomes `place(path)`; paths are seen from `folder`.
template <class Wanted, class Place>
void replace_paths(SliceOptions& options, const fs::path& folder, Wanted&& wanted, Place&& place) {
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.names == OptionSpec::Names::nothing || !wanted(spec.key)) continue;
        if (spec.names == OptionSpec::Names::inputs_by_role) {
            for (std::string& entry : options.stack_materials)
                if (const std::size_t equals = entry.find('='); equals != std::string::npos)
                    entry = entry.substr(0, equals + 1) + place(entry.substr(equals + 1));
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
    const fs::path path = (folder / text).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).string();
}

/// As the folder sees it, with a '/' in it: no word of the program's own has one.
std::string path_within(const fs::path& folder, const std::string& text) {
    const std::string path = fs::proximate(text, folder).string();
    return path.find('/') == std::string::npos && path != "." ? "./" + path : path;
}

Json options_json(const SliceOptions& options) {
    Json job{{"format", "voxtone-job"}, {"version", 1}};
    for (const OptionSpec& spec : slice_option_table()) job[spec.key] = json_value(spec, spec.get(options));
    return job;
}

std::string text_of(const Json& job) { return job.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

JobInput input_of(const Json& entry, const std::string& path, const fs::path& folder) {
    const auto refuse = [&](const std::string& rule) {
        throw InputError(fmt::format("{}: key 'inputs': {}", path, rule));
    };
    if (!entry.is_object()) refuse("a list of objects is expected");
    JobInput input;
    for (const auto& [key, value] : entry.items()) {
        std::string* const to = key == "input"    ? &input.key
                                : key == "file"   ? &input.file
                                : key == "sha256" ? &input.sha256
                                                  : nullptr;
        if (!to) refuse(io::unknown_key_message(key, std::vector<std::string>{"input", "file", "sha256"}));
        if (!value.is_string()) refuse(fmt::format("'{}' is no text", key));
        *to = value.get<std::string>();
    }
    if (input.key.empty()) refuse("an entry does not say which 'input' it is");
    if (!input.file.empty()) input.file = path_from(folder, input.file);
    return input;
}

constexpr auto every_key = [](const std::string&) { return true; };

}  // namespace

std::string job_json(const SliceOptions& options) {
    SliceOptions anywhere = options;
    replace_paths(anywhere, fs::path(), every_key,
                  [](const std::string& text) { return path_from(fs::current_path(), text); });
    return text_of(options_json(anywhere));
}

std::string job_record(const SliceOptions& options, std::span<const JobInput> inputs, const fs::path& folder) {
    SliceOptions left = options;
    left.overwrite = left.resume = false;
    replace_paths(left, fs::path(), every_key, [&](const std::string& text) { return path_within(folder, text); });
    Json job = options_json(left), list = Json::array();
    for (const JobInput& input : inputs) {
        Json& entry = list.emplace_back(Json{{"input", input.key}});
        if (!input.file.empty()) entry["file"] = path_within(folder, input.file);
        if (!input.sha256.empty()) entry["sha256"] = input.sha256;
    }
    job["inputs"] = std::move(list);
    return text_of(job);
}

void read_job(const std::string& path, SliceOptions& options) {
    const Json job = parse_job(path);
    for (const auto& [key, value] : job.items()) {
        if (key == "format" || key == "version" || key == "inputs") continue;
        const OptionSpec& spec = find_option(key, path);
        try {
            spec.set(options, option_text(value, fmt::format("{}: key '{}'", path, key)));
            if (spec.get(options) != spec.get(SliceOptions{})) options.named.push_back(key);
        } catch (const UsageError& error) {
            throw InputError(fmt::format("{}: {}", path, error.what()));
        }
    }
    const fs::path folder = fs::path(path).parent_path();
    replace_paths(
        options, folder, [&](const std::string& key) { return job.contains(key); },
        [&](const std::string& text) { return path_from(folder, text); });
    if (!job.contains("inputs")) return;
    if (!job["inputs"].is_array())
        throw InputError(fmt::format("{}: key 'inputs': a list of objects is expected", path));
    options.recorded_inputs.clear();
    for (const Json& entry : job["inputs"]) options.recorded_inputs.push_back(input_of(entry, path, folder));
}

}  // namespace voxtone::slicer
