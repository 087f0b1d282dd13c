// SPDX-License-Identifier: GPL-3.0-or-later
//
// Templates are checked by the rules of Open Job Description, version 2023-09, as far as they concern what is used of
// it: `openjd check` of its own tools is no Debian package.
#include "farm/cluster/openjd_template.h"

#include <algorithm>
#include <regex>
#include <set>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Contains;
using nlohmann::json;

namespace {

std::size_t characters(const std::string& text) {
    return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

bool has_control(const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](char c) { return (c >= 0 && c < 0x20) || c == 0x7F; });
}

/// Faults of a template, each in a few words.
class Faults {
public:
    explicit Faults(const json& text) {
        expect_keys(text, {"specificationVersion", "name", "steps"}, {"parameterDefinitions"});
        expect(text.at("specificationVersion") == "jobtemplate-2023-09", "version");
        expect_name(text.at("name"), 128);
        for (const json& parameter : text.at("parameterDefinitions")) look_at_parameter(parameter);
        expect(!text.at("steps").empty(), "no steps");
        for (const json& step : text.at("steps")) look_at_step(step);
    }
    std::vector<std::string> found;

private:
    void expect(bool right, const std::string& what) {
        if (!right) found.push_back(what);
    }
    void expect_keys(const json& object, const std::set<std::string>& needed, const std::set<std::string>& others) {
        for (const std::string& key : needed) expect(object.contains(key), "without " + key);
        for (const auto& [key, value] : object.items())
            expect(needed.contains(key) || others.contains(key), "unknown " + key);
    }
    void expect_name(const std::string& name, std::size_t most) {
        expect(!name.empty() && characters(name) <= most && !has_control(name), "name " + name);
    }
    void look_at_parameter(const json& parameter) {
        expect_keys(parameter, {"name", "type"}, {"description", "default", "objectType", "dataFlow"});
        const std::string name = parameter.at("name");
        expect(std::regex_match(name, std::regex("[A-Za-z_][A-Za-z0-9_]{0,63}")), "identifier " + name);
        expect(parameters_.insert(name).second, "parameter twice");
        expect(parameter.at("type") == "PATH", "type");
        expect(std::set<std::string>{"FILE", "DIRECTORY"}.contains(parameter.at("objectType")), "object type");
        expect(std::set<std::string>{"NONE", "IN", "OUT", "INOUT"}.contains(parameter.at("dataFlow")), "data flow");
        const std::size_t length = characters(parameter.at("default"));
        expect(length >= 1 && length <= 1024, "default");
    }
    void look_at_step(const json& step) {
        expect_keys(step, {"name", "script"}, {"dependencies", "hostRequirements", "parameterSpace"});
        expect_name(step.at("name"), 64);
        tasks_.clear();
        if (step.contains("dependencies")) {
            expect(!step["dependencies"].empty(), "empty dependencies");
            for (const json& dependency : step["dependencies"]) {
                expect_keys(dependency, {"dependsOn"}, {});
                // Any step of the template may be named; ours stand before.
                expect(steps_.contains(dependency.at("dependsOn")), "depends on nothing");
            }
        }
        expect(steps_.insert(step.at("name")).second, "step twice");
        for (const json& amount : step.at("hostRequirements").at("amounts")) look_at_amount(amount);
        if (step.contains("parameterSpace")) look_at_tasks(step["parameterSpace"]);
        look_at_action(step.at("script").at("actions").at("onRun"));
    }
    void look_at_amount(const json& amount) {
        expect_keys(amount, {"name", "min"}, {});
        const std::string name = amount.at("name");
        expect(name == "amount.worker.vcpu" || name == "amount.worker.memory", "amount " + name);
        expect(amount.at("min").get<double>() >= (name == "amount.worker.vcpu" ? 1 : 0), "min");
    }
    void look_at_tasks(const json& space) {
        expect_keys(space, {"taskParameterDefinitions"}, {"combination"});
        for (const json& parameter : space.at("taskParameterDefinitions")) {
            expect_keys(parameter, {"name", "type", "range"}, {});
            expect(parameter.at("type") == "INT", "task type");
            expect(std::regex_match(parameter.at("range").get<std::string>(), std::regex("1-[1-9][0-9]*")), "range");
            tasks_.insert(parameter.at("name"));
        }
    }
    void look_at_action(const json& action) {
        expect_keys(action, {"command"}, {"args", "timeout", "cancelation"});
        look_at_format(action.at("command"));
        expect(!action.at("command").get<std::string>().empty(), "no command");
        for (const json& word : action.at("args")) look_at_format(word);
        expect(action.at("timeout").get<std::int64_t>() > 0, "timeout");
        const json& cancelation = action.at("cancelation");
        expect_keys(cancelation, {"mode"}, {"notifyPeriodInSeconds"});
        expect(cancelation.at("mode") == "NOTIFY_THEN_TERMINATE", "mode");
        const auto notify_s = cancelation.at("notifyPeriodInSeconds").get<std::int64_t>();
        expect(notify_s > 0 && notify_s <= 600, "notify period");
    }
    /// Of an action: every reference is to what there is.
    void look_at_format(const std::string& text) {
        expect(!has_control(text), "control character in " + text);
        static const std::regex reference(R"(\{\{\s*([A-Za-z_.]+)\s*\}\})");
        for (std::sregex_iterator at(text.begin(), text.end(), reference), end; at != end; ++at) {
            const std::string name = (*at)[1];
            const bool is_known = (name.starts_with("Param.") && parameters_.contains(name.substr(6))) ||
                                  (name.starts_with("Task.Param.") && tasks_.contains(name.substr(11)));
            expect(is_known, "refers to " + name);
        }
        expect(std::regex_replace(text, reference, "").find("{{") == std::string::npos, "half a reference in " + text);
    }

    std::set<std::string> parameters_, steps_, tasks_;
};

ChainStage stage_of(TaskStage stage, int tasks, int cores) {
    ChainStage made;
    made.stage = stage;
    made.tasks = tasks;
    made.cores = cores;
    made.memory_bytes = 1'500'000'000;
    made.limit_s = 700.2;
    return made;
}

OpenJobChain whole(const std::string& name) { return {name, {{stage_of(TaskStage::whole, 1, 2)}, 1, {}}}; }

OpenJobChain cut(const std::string& name) {
    return {name,
            {{stage_of(TaskStage::prepare, 1, 4), stage_of(TaskStage::layers, 16, 2), stage_of(TaskStage::merge, 1, 1)},
             16,
             {}}};
}

std::string template_of(const std::vector<OpenJobChain>& jobs, const std::string& out = "/shared/monday") {
    return openjd_template(jobs, {"/usr/bin/voxtone", out});
}

}  // namespace

TEST_CASE("a template keeps to the specification", "[cluster]") {
    const std::vector<OpenJobChain> jobs{whole("a"), cut("b"), whole("tête \"x\" $(y) {z}"),
                                         whole(std::string(255, 'n')), cut(std::string(255, 'n') + "m")};
    const json text = json::parse(template_of(jobs));
    CHECK(Faults(text).found == std::vector<std::string>{});
    CHECK(text["steps"].size() == 1 + 3 + 1 + 1 + 3 + 1);
    // The checker itself sees what is wrong.
    json wrong = text;
    wrong["steps"][1]["dependencies"] = json::array({{{"dependsOn", "nobody"}}});
    wrong["steps"][2]["script"]["actions"]["onRun"]["args"].push_back("{{Task.Param.Frame}}");
    wrong["steps"][3]["name"] = wrong["steps"][0]["name"];
    wrong["colour"] = 1;
    CHECK(Faults(wrong).found == std::vector<std::string>{"unknown colour", "depends on nothing",
                                                          "refers to Task.Param.Frame", "step twice",
                                                          "depends on nothing"});
}

TEST_CASE("steps are the tasks of a job, one behind the other", "[cluster]") {
    const json steps = json::parse(template_of({cut("cow"), whole("fox")})).at("steps");
    REQUIRE(steps.size() == 5);
    CHECK(steps[0]["name"] == "1 prepare: cow");
    CHECK_FALSE(steps[0].contains("dependencies"));
    CHECK_FALSE(steps[0].contains("parameterSpace"));
    CHECK(steps[1]["name"] == "2 layers: cow");
    CHECK(steps[1]["dependencies"] == json::parse(R"([{"dependsOn": "1 prepare: cow"}])"));
    CHECK(steps[1]["parameterSpace"]["taskParameterDefinitions"][0]["range"] == "1-16");
    const json& run = steps[1]["script"]["actions"]["onRun"];
    CHECK(run["command"] == "{{Param.Program}}");
    CHECK(run["args"] == json::parse(R"(["task", "{{Param.Batch}}", "--job=cow", "--stage", "layers", "--shard",
                                         "{{Task.Param.Shard}}/16", "--threads", "2", "--progress", "openjd"])"));
    CHECK(run["timeout"] == 701);
    const json& amounts = steps[1]["hostRequirements"]["amounts"];
    CHECK(amounts[0]["min"] == 2);
    CHECK(amounts[1]["min"] == 1431);  // 1.5e9 bytes in MiB, rounded up
    CHECK(steps[2]["dependencies"] == json::parse(R"([{"dependsOn": "2 layers: cow"}])"));
    CHECK_FALSE(steps[3].contains("dependencies"));  // jobs do not wait for each other
    CHECK(steps[4]["dependencies"] == json::parse(R"([{"dependsOn": "3 merge: cow"}, {"dependsOn": "4 whole: fox"}])"));
    CHECK(steps[4]["script"]["actions"]["onRun"]["args"][2] == "--last");
}

TEST_CASE("what cannot stand in a template is refused", "[cluster]") {
    CHECK_THROWS_WITH(template_of({whole("a{{b")}), Contains("'a{{b'") && Contains("name it otherwise"));
    CHECK_THROWS_AS(template_of({whole("a\nb")}), InputError);
    CHECK_THROWS_AS(template_of({whole("a\xC2\x85z")}), InputError);
    CHECK_THROWS_AS(template_of({whole("a")}, "/shared/{{x}}"), InputError);
    CHECK_THROWS_AS(template_of({whole("a")}, "/" + std::string(1024, 'x')), InputError);
}
