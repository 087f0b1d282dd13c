// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress_events.h"

#include <atomic>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "base/warning.h"

using namespace voxtone;

TEST_CASE("A message's name stands in brackets at its end") {
    CHECK(message_name(named_warning("tiny", "[it] is small")) == "tiny");
    CHECK(message_name("[it] is small").empty());
    CHECK(message_name("is small]").empty());
    CHECK(message_name("").empty());
}

TEST_CASE("Events are one JSON object a line") {
    std::string text;
    double now_s = 5;
    ProgressEvents events([&](std::string_view piece) { text += piece; }, [&] { return now_s; });
    events.begin_stage("lay\"ers\n", 40, "layers");
    now_s += 0.05;
    events.advance(1);  // too early to tell
    now_s += 1;
    events.advance(19);
    events.warn(named_warning("side-file", "C:\\model \"a\"\x01"));
    events.note("n");
    events.advance(20);  // too soon after the last
    now_s += 1;
    events.end_stage();
    now_s += 5;
    events.tick();  // between stages
    events.expect({{"predict", 30}});
    events.begin_stage("predict", 0);
    now_s += 0.5;
    events.tick();  // too early
    now_s += 0.5;
    events.tick();
    events.end_stage();
    events.result("{\n  \"layers\": 40,\n\t\"name\": \"a  b\"\n}\n");
    text += error_event(ExitCode::invalid_input, "no triangles [invalid-input]") + "\n";
    CHECK(text == R"({"event":"stage","stage":"lay\"ers\n","state":"begin","steps":40,"unit":"layers"})"
                  "\n"
                  R"({"event":"progress","stage":"lay\"ers\n","done":20,"steps":40,"seconds":1.05})"
                  "\n"
                  R"({"event":"warning","name":"side-file","message":"C:\\model \"a\"\u0001 [side-file]"})"
                  "\n"
                  R"({"event":"note","message":"n"})"
                  "\n"
                  R"({"event":"stage","stage":"lay\"ers\n","state":"end","done":40,"seconds":2.05})"
                  "\n"
                  R"({"event":"stage","stage":"predict","state":"begin","steps":0,"unit":"steps"})"
                  "\n"
                  R"({"event":"progress","stage":"predict","done":0,"steps":0,"seconds":1.00,"job_seconds_left":29})"
                  "\n"
                  R"({"event":"stage","stage":"predict","state":"end","done":0,"seconds":1.00})"
                  "\n"
                  R"({"event":"result","result":{"layers": 40,"name": "a  b"}})"
                  "\n"
                  R"({"event":"error","exit_code":3,"name":"invalid-input","message":"no triangles [invalid-input]"})"
                  "\n");
}

TEST_CASE(
    "Events tell what is left of the job at the pace of the stages before, no more often than ten times a second") {
    std::string text;
    double now_s = 0;
    ProgressEvents events([&](std::string_view piece) { text += piece; }, [&] { return now_s; });
    const auto last = [&] {
        const std::size_t end = text.rfind('\n'), begin = text.rfind('\n', end - 1);
        return text.substr(begin == std::string::npos ? 0 : begin + 1,
                           end - (begin == std::string::npos ? 0 : begin + 1));
    };
    events.expect({{"loop", 30}, {"predict", 10}});
    events.begin_stage("loop", 10);
    now_s = 0.05;
    events.advance(1);
    CHECK_THAT(last(), Catch::Matchers::Contains("begin"));
    now_s = 70;
    events.end_stage();  // 80 s for 40 with what steadies it: twice as long
    events.begin_stage("predict", 8);
    events.expect_steps(4);
    now_s = 70.2;
    events.advance(0);
    CHECK_THAT(last(),
               Catch::Matchers::Contains("\"steps\":4") && Catch::Matchers::Contains("\"job_seconds_left\":20"));
    const std::size_t before = text.size();
    now_s = 70.29;
    events.advance(1);
    CHECK(text.size() == before);
    now_s = 70.31;
    events.advance(9);
    CHECK_THAT(last(), Catch::Matchers::Contains("\"done\":10"));
}

TEST_CASE("Events come by themselves where nothing is reported", "[slow]") {
    std::atomic<int> told{0};
    ProgressEvents events([&](std::string_view) { ++told; }, steady_seconds(), true);
    events.begin_stage("predict", 0);
    while (told < 3) std::this_thread::yield();
    SUCCEED("the ticker told; without it this would not end");
}

TEST_CASE("Inside of a step its share is told, and the time left does not stand still") {
    std::string text;
    double now_s = 0;
    ProgressEvents events([&](std::string_view piece) { text += piece; }, [&] { return now_s; });
    const Progress& inside = events;
    events.expect({{"loop", 100}});
    events.begin_stage("loop", 10, "predictions");
    const auto last = [&](const std::string& key) {
        const std::size_t at = text.rfind("\"" + key + "\":");
        return at == std::string::npos ? -1 : std::stod(text.substr(at + key.size() + 3));
    };
    // Four times as slow as expected, steadily: within the first of ten predictions that is found out, and told.
    double left_before = 1e9;
    int still = 0, k = 0;
    for (const double from : {0.0, 0.5}) {
        const PartRange half(&inside, from, from + 0.5);
        for (int tenth = 1; tenth <= 10; ++tenth) {
            now_s += 2;
            tell_part(&inside, tenth / 10.0);
            events.tick();
            CHECK(last("part") == Approx(++k / 20.0));
            const double left = last("job_seconds_left");
            still = left == left_before ? still + 1 : 0;
            CHECK(still < 9);  // 18 s
            left_before = left;
        }
    }
    CHECK(left_before > 150);  // of 360, and 60 by the clock and what was expected
    tell_part(&inside, 0.1);
    CHECK(events.part() == 1);
    events.advance();
    CHECK(events.part() == 0);
    tell_part(nullptr, 1);
    const Progress silent;
    tell_part(&silent, 1);  // shows no parts
}
