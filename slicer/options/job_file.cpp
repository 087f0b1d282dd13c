// SPDX-License-Identifier: GPL-3.0-or-later
//
// The job file: {"format": "voxtone-job", "version": 1, <key>: <value>, ...} with the keys of the option table.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/files/json_keys.h"
#include "voxtone/slicer/options/slice_options.h"

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

}  // namespace

std::string job_json(const SliceOptions& options) {
    Json job{{"format", "voxtone-job"}, {"version", 1}};
    for (const OptionSpec& spec : slice_option_table()) job[spec.key] = json_value(spec, spec.get(options));
    return job.dump(2) + "\n";
}

void read_job(const std::string& path, SliceOptions& options) {
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
    std::vector<std::string> known{"format", "version"};
    for (const OptionSpec& spec : slice_option_table()) known.push_back(spec.key);
    for (const auto& [key, value] : job.items()) {
        if (key == "format" || key == "version") continue;
        const auto table = slice_option_table();
        const auto spec = std::find_if(table.begin(), table.end(), [&](const OptionSpec& s) { return s.key == key; });
        if (spec == table.end()) throw InputError(fmt::format("{}: {}", path, io::unknown_key_message(key, known)));
        try {
            spec->set(options, option_text(value, fmt::format("{}: key '{}'", path, key)));
        } catch (const UsageError& error) {
            throw InputError(fmt::format("{}: {}", path, error.what()));
        }
        // An empty path stays empty: nothing was named.
        for (const auto& [name, named] : {std::pair{"model", &options.model}, std::pair{"profiles", &options.profiles}})
            if (key == name && !named->empty() && std::filesystem::path(*named).is_relative())
                *named = (std::filesystem::path(path).parent_path() / *named).string();
        if (key == "stack-materials")
            for (std::string& entry : options.stack_materials)
                if (const std::size_t at = entry.find('=') + 1;
                    at > 0 && at < entry.size() && std::filesystem::path(entry.substr(at)).is_relative())
                    entry =
                        entry.substr(0, at) + (std::filesystem::path(path).parent_path() / entry.substr(at)).string();
    }
}

}  // namespace voxtone::slicer
