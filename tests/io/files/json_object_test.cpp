// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_object.h"

#include <functional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/json_lines.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

const std::string text = R"({"first": 1,
 "strange \"}{\u0041": {"deep": [[1, 2],
   [3, "]", {"a": true}]],
  "last": 2},
 "once": 1,
 "rows": [
  {"name": "one"},
  {"name": "two",
   "share": 7}],
 "end": 2
})";

std::size_t line_of(const std::vector<JsonStep>& path) { return line_in_json(text, path); }

std::string fault(const std::function<void(const JsonObject&)>& ask) {
    try {
        ask(JsonObject::parse(text, "a.json"));
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("no error");
    return {};
}

}  // namespace

TEST_CASE("What stands in a JSON text has a line, whatever stands before it") {
    const std::string strange = "strange \"}{A";
    CHECK(line_of({}) == 1);
    CHECK(line_of({"first"}) == 1);
    CHECK(line_of({strange}) == 2);
    CHECK(line_of({strange, "deep", std::size_t{1}}) == 3);
    CHECK(line_of({strange, "deep", std::size_t{1}, std::size_t{2}, "a"}) == 3);
    CHECK(line_of({strange, "last"}) == 4);
    CHECK(line_of({"rows", std::size_t{1}}) == 8);
    CHECK(line_of({"rows", std::size_t{1}, "share"}) == 9);
    CHECK(line_of({"end"}) == 10);
    // Not there.
    CHECK(line_of({"second"}) == 0);
    CHECK(line_of({"rows", std::size_t{2}}) == 0);
    CHECK(line_of({"first", "of"}) == 0);
    CHECK(line_of({"rows", "name"}) == 0);
    CHECK(line_in_json("\xef\xbb\xbf\n{\n\"a\": 1}", std::vector<JsonStep>{"a"}) == 3);
    CHECK(line_in_json("{}", std::vector<JsonStep>{"a"}) == 0);
    // Deep nesting takes no stack, and a text that is none no time and no place behind its end.
    const std::string deep = "{\"a\": " + std::string(1'000'000, '[') + std::string(1'000'000, ']') + ",\n\"b\": 1}";
    CHECK(line_in_json(deep, std::vector<JsonStep>{"b"}) == 2);
    for (std::size_t cut = 0; cut < text.size(); ++cut)
        CHECK(line_in_json(std::string_view(text).substr(0, cut), std::vector<JsonStep>{"none"}) == 0);
}

TEST_CASE("A fault in a JSON object names file, line, key and rule") {
    CHECK(fault([](const JsonObject& o) { (void)o.objects("rows")[1].number("share", 0, 1); }) ==
          "a.json: line 9: key `rows[1].share`: is 7, expected a number from 0 to 1");
    CHECK_THAT(fault([](const JsonObject& o) { o.fail("rows[1]", "is wrong"); }),
               Contains("a.json: line 8: key `rows[1]`: is wrong"));
    CHECK_THAT(fault([](const JsonObject& o) { o.objects("rows")[1].allow_only({"name"}); }),
               Contains("a.json: line 9: rows[1]: unknown key 'share'"));
    // Of a key that is missing, the line of what it is missing in; of the whole, none.
    CHECK_THAT(fault([](const JsonObject& o) { (void)o.objects("rows")[1].text("role"); }),
               Contains("a.json: line 8: key `rows[1].role`: is missing"));
    CHECK_THAT(fault([](const JsonObject& o) { (void)o.text("role"); }), Contains("a.json: key `role`: is missing"));
}

TEST_CASE("A value of any kind can be had as a text") {
    const JsonObject object = JsonObject::parse(
        R"({"a": "x", "b": true, "c": 1.50, "d": ["C", "M"], "e": [], "f": {}, "g": [1], "h": null})", "a.json");
    CHECK(object.any_text("a") == "x");
    CHECK(object.any_text("b") == "true");
    CHECK(object.any_text("c") == "1.5");
    CHECK(object.any_text("d") == "C,M");
    CHECK(object.any_text("e").empty());
    for (const char* key : {"f", "g", "h"}) CHECK_THROWS_AS(object.any_text(key), InputError);
}

TEST_CASE("A key that an object has twice is refused with the line of the second") {
    const auto refusal = [](const std::string& json) -> std::string {
        try {
            (void)JsonObject::parse(json, "a.json");
        } catch (const InputError& error) {
            return error.what();
        }
        return "taken";
    };
    CHECK_THAT(refusal("{\"size\": 1,\n \"depth\": 2,\n \"size\": 1}"),
               Contains("a.json: line 3: key `size` stands here a second time"));
    // Within lists and objects, and however it is written.
    CHECK_THAT(refusal("{\"rows\": [{\"a\": 1},\n {\"a\": [1, {\"b\": 2}], \"b\": {},\n \"a\": 2}]}"),
               Contains("line 3: key `a`"));
    CHECK_THAT(refusal("{\"si\\u007ae\": 1,\n\"size\": 2}"), Contains("line 2: key `size`"));
    CHECK_THAT(refusal("{\"a\\\"\": 1, \"a\\\"\": 2}"), Contains("key `a\"`"));
    // The same word in another object, or as a value, is none.
    CHECK(refusal(R"({"a": {"a": {"a": "a"}}, "b": ["a", "a", {"a": 1}, {"a": 1}], "c": "a\": \"a"})") == "taken");
    CHECK(refusal(text) == "taken");
}
