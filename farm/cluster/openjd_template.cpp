// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/openjd_template.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/json_writer.h"

namespace voxtone::farm {

namespace {

// Limits of the specification, in characters.
constexpr std::size_t longest_step_name = 64, longest_job_name = 128, longest_parameter = 1024;
constexpr int notify_s = 60;  // a loop saves itself within 30 s of SIGTERM

constexpr const char* program_parameter = "{{Param.Program}}";
constexpr const char* batch_parameter = "{{Param.Batch}}";

/// The first characters of a text in UTF-8, so many at most.
std::string first_characters(const std::string& text, std::size_t most) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins = (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80;
        if (begins && ++count > most) return text.substr(0, i);
    }
    return text;
}

bool has_control(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte < 0x20 || byte == 0x7F) return true;
        const bool c1 = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
        if (c1) return true;
    }
    return false;
}

void expect_writable(const std::string& text, const char* what) {
    if (text.find("{{") != std::string::npos)
        throw InputError(fmt::format(
            "{} '{}' holds '{{{{', which begins a reference in a template of Open Job Description and cannot be quoted "
            "there: name it otherwise",
            what, text));
    if (has_control(text))
        throw InputError(fmt::format(
            "{} '{}' holds a control character, which no template of Open Job Description may: name it otherwise", what,
            text));
}

void write_parameter(io::JsonWriter& json, const char* name, const char* type, const std::filesystem::path& path,
                     const char* what, const char* description) {
    expect_writable(path.string(), what);
    if (path.string().size() > longest_parameter)
        throw InputError(fmt::format("{} '{}' is longer than the {} characters that Open Job Description allows", what,
                                     path.string(), longest_parameter));
    json.line().begin_object().add("name", name).add("type", "PATH").add("objectType", type).add("dataFlow", "NONE");
    json.add("description", description).add("default", path.string()).end_object();
}

class Steps {
public:
    explicit Steps(io::JsonWriter& json) : json_(json) {}

    /// Unique by its number, whatever is left of a long name. What it depends on must be there.
    std::string add(const std::string& job, const ChainStage& stage, const std::vector<std::string>& after) {
        const std::string name = name_of_step(fmt::format("{}: ", voxtone::name_of(stage.stage)) + job);
        begin(name, after);
        write_requirements(stage.cores, stage.memory_bytes);
        std::vector<std::string> arguments{"task", batch_parameter, "--job=" + job, "--stage",
                                           std::string(voxtone::name_of(stage.stage))};
        if (stage.stage == TaskStage::layers) {
            write_tasks(stage.tasks);
            arguments.insert(arguments.end(), {"--shard", fmt::format("{{{{Task.Param.Shard}}}}/{}", stage.tasks)});
        }
        arguments.insert(arguments.end(), {"--threads", std::to_string(stage.cores)});
        end(std::move(arguments), stage.limit_s);
        return name;
    }
    void add_last(const std::vector<std::string>& after) {
        constexpr double limit_s = 1800;
        constexpr std::uint64_t memory_bytes = std::uint64_t{512} << 20;
        begin("summary", after);
        write_requirements(1, memory_bytes);
        end({"task", batch_parameter, "--last"}, limit_s);
    }

private:
    std::string name_of_step(const std::string& text) {
        return first_characters(fmt::format("{} {}", ++count_, text), longest_step_name);
    }
    void begin(const std::string& name, const std::vector<std::string>& after) {
        json_.line().begin_object().add("name", name);
        if (after.empty()) return;
        json_.line().key("dependencies").begin_list();
        for (const std::string& step : after) json_.begin_object().add("dependsOn", step).end_object();
        json_.end_list();
    }
    void write_requirements(int cores, std::uint64_t memory_bytes) {
        constexpr std::uint64_t mib = std::uint64_t{1} << 20;
        json_.line().key("hostRequirements").begin_object().key("amounts").begin_list();
        json_.begin_object().add("name", "amount.worker.vcpu").add("min", cores).end_object();
        json_.begin_object()
            .add("name", "amount.worker.memory")
            .add("min", (memory_bytes + mib - 1) / mib)
            .end_object();
        json_.end_list().end_object();
    }
    void write_tasks(int tasks) {
        json_.line().key("parameterSpace").begin_object().key("taskParameterDefinitions").begin_list();
        json_.begin_object().add("name", "Shard").add("type", "INT").add("range", fmt::format("1-{}", tasks));
        json_.end_object().end_list().end_object();
    }
    void end(std::vector<std::string> arguments, double limit_s) {
        arguments.insert(arguments.end(), {"--progress", "openjd"});
        json_.line().key("script").begin_object().key("actions").begin_object().key("onRun").begin_object();
        json_.line().add("command", program_parameter).add("args", arguments);
        json_.line().add("timeout", static_cast<std::uint64_t>(std::max(1.0, std::ceil(limit_s))));
        json_.key("cancelation").begin_object().add("mode", "NOTIFY_THEN_TERMINATE");
        json_.add("notifyPeriodInSeconds", notify_s).end_object();
        json_.end_object().end_object().end_object().end_object();
    }

    io::JsonWriter& json_;
    std::size_t count_ = 0;
};

}  // namespace

std::string openjd_template(std::span<const OpenJobChain> jobs, const OpenJobFrame& frame) {
    io::JsonWriter json;
    json.begin_object().add("specificationVersion", "jobtemplate-2023-09");
    json.line().add("name", first_characters("voxtone: " + frame.out.filename().string(), longest_job_name));
    json.line().key("parameterDefinitions").begin_list();
    write_parameter(json, "Program", "FILE", frame.program, "the program", "voxtone, as every worker finds it");
    write_parameter(json, "Batch", "DIRECTORY", frame.out, "the folder",
                    "folder of the batch, on a disk that all workers share");
    json.end_list().line().key("steps").begin_list();
    Steps steps(json);
    std::vector<std::string> ends;
    for (const OpenJobChain& job : jobs) {
        expect_writable(job.job, "the job");
        std::vector<std::string> before;
        for (const ChainStage& stage : job.chain.stages) before = {steps.add(job.job, stage, before)};
        ends.insert(ends.end(), before.begin(), before.end());
    }
    steps.add_last(ends);
    return json.end_list().end_object().text() + "\n";
}

}  // namespace voxtone::farm
