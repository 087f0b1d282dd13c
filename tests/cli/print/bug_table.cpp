// SPDX-License-Identifier: GPL-3.0-or-later
#include "bug_table.h"

#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/places.h"

namespace voxtone::test {

namespace {

using Json = nlohmann::json;

void expect_known(const Json& object) {
    static const std::set<std::string> known{
        "id",   "source", "expected", "lines",      "file",         "verb",  "options", "exit",       "says", "unsaid",
        "lost", "body",   "size_mm",  "volume_mm3", "volume_error", "sides", "spots",   "code_error", "top",  "like"};
    for (const auto& [key, value] : object.items())
        if (!known.contains(key)) throw std::runtime_error("expected.json: unknown key " + key);
}

/// null: it is not judged.
template <class Value>
void take(const Json& json, const char* key, std::optional<Value>& value) {
    if (!json.contains(key)) return;
    value.reset();
    if (!json.at(key).is_null()) value = json.at(key).get<Value>();
}

/// What `json` has of a line; the rest stays.
void take(const Json& json, const Json& bodies, BugLine& line) {
    expect_known(json);
    if (json.contains("body")) {
        line.sides.clear();
        line.spots.clear();
        take(bodies.at(json.at("body").get<std::string>()), bodies, line);
    }
    line.verb = json.value("verb", line.verb);
    line.options = json.value("options", line.options);
    line.exit_code = json.value("exit", line.exit_code);
    line.lost = json.value("lost", line.lost);
    line.says = json.value("says", line.says);
    line.unsaid = json.value("unsaid", line.unsaid);
    take(json, "size_mm", line.size_mm);
    take(json, "volume_mm3", line.volume_mm3);
    line.like = json.value("like", line.like);
    line.top = json.value("top", line.top);
    line.volume_error = json.value("volume_error", line.volume_error);
    line.code_error = json.value("code_error", line.code_error);
    if (json.contains("sides"))
        for (const auto& [side, codes] : json.at("sides").items()) {
            if (codes.is_null())
                line.sides.erase(side);
            else
                line.sides[side] = codes.get<Codes>();
        }
    if (!json.contains("spots")) return;
    line.spots.clear();
    for (const Json& spot : json.at("spots")) line.spots.push_back({{spot.at(0), spot.at(1)}, spot.at(2).get<Codes>()});
}

}  // namespace

std::filesystem::path bug_folder() { return std::filesystem::path(test_data()) / "bugs"; }

std::vector<BugLine> bug_table() {
    const Json table = Json::parse(read_file(bug_folder() / "expected.json"));
    std::vector<BugLine> lines;
    for (const Json& report : table.at("reports")) {
        BugLine of_all;
        of_all.id = report.at("id");
        of_all.verb = "slice";
        take(report, table.at("bodies"), of_all);
        for (const Json& json : report.at("lines")) {
            BugLine& line = lines.emplace_back(of_all);
            line.file = json.at("file");
            take(json, table.at("bodies"), line);
        }
    }
    return lines;
}

}  // namespace voxtone::test
