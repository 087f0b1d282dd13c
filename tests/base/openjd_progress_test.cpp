// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/openjd_progress.h"

#include <atomic>
#include <mutex>
#include <string>

#include <catch2/catch.hpp>

using namespace voxtone;

TEST_CASE("Open Job Description's messages are one a line, and percent never fall") {
    std::string text;
    double now_s = 100;
    OpenJobProgress progress([&](std::string_view piece) { text += piece; }, [&] { return now_s; });
    progress.begin_stage("read model", 0);
    now_s += 5;
    progress.end_stage();
    progress.expect({{"layers", 10}, {"report", 10}});
    progress.begin_stage("layers", 40, "layers");
    now_s += 9;
    progress.tick();  // too early
    progress.advance(20);
    now_s += 1;
    progress.tick();
    progress.warn("a name\nwith a line");
    progress.note("openjd_fail: a model may be called so");
    progress.expect({{"report", 1000}});  // it will take longer than was thought: percent stay
    now_s += 10;
    progress.tick();
    progress.end_stage();
    now_s += 10;
    progress.tick();  // between stages
    progress.finish();
    CHECK(text ==
          "openjd_status: read model\n"
          "openjd_status: layers, 0 of 40 layers\n"
          "openjd_progress: 20.0\n"
          "openjd_status: layers, 20 of 40 layers\n"
          "openjd_progress: 46.2\n"
          "warning: a name with a line\n"
          "note: openjd_fail: a model may be called so\n"
          "openjd_status: layers, 20 of 40 layers\n"
          "openjd_progress: 46.2\n"
          "openjd_status: between two stages\n"
          "openjd_progress: 100\n");
    CHECK(openjd_failure("one\ntwo") == "openjd_fail: one two");
}

TEST_CASE("Open Job Description's messages come by themselves where nothing else is said", "[slow]") {
    std::mutex mutex;
    std::string text;
    std::atomic<double> now_s{0};
    OpenJobProgress progress(
        [&](std::string_view piece) {
            const std::lock_guard lock(mutex);
            text += piece;
        },
        [&] { return now_s.load(); }, true);
    progress.begin_stage("layers", 0);
    now_s = 11;
    for (;;) {
        const std::lock_guard lock(mutex);
        if (text == "openjd_status: layers\nopenjd_status: layers\n") break;
    }
    SUCCEED("the ticker wrote; without it this would not end");
}

TEST_CASE("Open Job Description's percent count time gone, and steps no more than there are") {
    std::string text;
    double now_s = 0;
    OpenJobProgress progress([&](std::string_view piece) { text += piece; }, [&] { return now_s; });
    progress.tick();  // before the first stage
    CHECK(text.empty());
    progress.expect({{"layers", 30}});
    progress.begin_stage("layers", 10, "layers");
    progress.expect_steps(8);
    progress.advance(20);
    now_s = 10;
    progress.tick();
    CHECK(text ==
          "openjd_status: layers, 0 of 10 layers\nopenjd_progress: 0.0\nopenjd_status: layers, 8 of 8 layers\n"
          "openjd_progress: 99.9\n");
    text.clear();
    now_s = 19.9;
    progress.tick();
    CHECK(text.empty());
    now_s = 20;
    progress.tick();
    CHECK_FALSE(text.empty());
    text.clear();
    progress.warn("a\rb");
    CHECK(text == "warning: a b\n");
}
