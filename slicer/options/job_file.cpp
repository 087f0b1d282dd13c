// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/options/job_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/files/json_keys.h"

namespace voxtone::slicer {

namespace {

using Json = nlohmann::ordered_json;

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
    std::vector<std::string> known{"format", "version"};
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.key == key) return spec;
        known.push_back(spec.key);
    }
    throw InputError(fmt::format("{}: {}", path, io::unknown_key_message(key, known)));
}

/// The rest of `text` from `begin` on, seen from the job file's folder. An empty path stays empty: nothing was named.
void make_relative_to(const std::filesystem::path& folder, std::string& text, std::size_t begin = 0) {
    const std::string named = text.substr(begin);
    if (!named.empty() && std::filesystem::path(named).is_relative())
        text = text.substr(0, begin) + (folder / named).string();
}

}  // namespace

std::string job_json(const SliceOptions& options) {
    Json job{{"format", "voxtone-job"}, {"version", 1}};
    for (const OptionSpec& spec : slice_option_table()) job[spec.key] = json_value(spec, spec.get(options));
    return job.dump(2) + "\n";
}

void read_job(const std::string& path, SliceOptions& options) {
    const Json job = parse_job(path);
    for (const auto& [key, value] : job.items()) {
        if (key == "format" || key == "version") continue;
        const OptionSpec& spec = find_option(key, path);
        try {
            spec.set(options, option_text(value, fmt::format("{}: key '{}'", path, key)));
            if (spec.get(options) != spec.get(SliceOptions{})) options.named.push_back(key);
        } catch (const UsageError& error) {
            throw InputError(fmt::format("{}: {}", path, error.what()));
        }
    }
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    if (job.contains("model")) make_relative_to(folder, options.model);
    if (job.contains("texture")) make_relative_to(folder, options.texture);
    if (job.contains("profiles")) make_relative_to(folder, options.profiles);
    if (job.contains("stack-materials"))
        for (std::string& entry : options.stack_materials)
            if (const std::size_t equals = entry.find('='); equals != std::string::npos)
                make_relative_to(folder, entry, equals + 1);
}

}  // namespace voxtone::slicer
