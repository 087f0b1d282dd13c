// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress_bar.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "base/parallel.h"

using namespace voxtone;
using Catch::Contains;
using Catch::EndsWith;
using Catch::StartsWith;

namespace {

/// A sink that keeps what it gets, and a clock that is set by hand.
struct Desk {
    std::vector<std::string> pieces;
    double now_s = 100;
    int columns = 100;
    TextSink sink = [this](std::string_view text) { pieces.emplace_back(text); };
    SecondsClock clock = [this] { return now_s; };
    ProgressBar::Look look{[this] { return columns; }, false};
    [[nodiscard]] std::string all() const {
        std::string text;
        for (const std::string& piece : pieces) text += piece;
        return text;
    }
};

int columns_of(std::string_view text) {
    return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xC0') != '\x80'; }));
}

}  // namespace

TEST_CASE("Durations are written as a person says them") {
    CHECK(duration_text(0) == "0.0 s");
    CHECK(duration_text(9.94) == "9.9 s");
    CHECK(duration_text(9.96) == "10 s");
    CHECK(duration_text(59.6) == "1 min 00 s");
    CHECK(duration_text(185) == "3 min 05 s");
    CHECK(duration_text(7620) == "2 h 07 min");
}

TEST_CASE("The bar shows stage, share, count, rate and time left") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.begin_stage("layers", 400, "layers");
    CHECK(desk.pieces.back() == "layers  [>                             ]    0 %  0/400 layers  0.0 s");
    desk.now_s += 10;
    bar.advance(100);
    CHECK(desk.pieces.back() ==
          "\r\x1b[Klayers  [=======>                      ]   25 %  100/400 layers  10/s  30 s left");
    desk.now_s += 30;
    bar.advance(300);
    bar.end_stage();
    CHECK(desk.pieces.back() == "\r\x1b[Klayers: 400 layers in 40 s (10/s)\n");
}

TEST_CASE("The bar is drawn ten times a second at most") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.begin_stage("layers", 100000, "layers");
    for (int i = 0; i < 10000; ++i) {
        desk.now_s += 1e-3;
        bar.advance();
    }
    CHECK(desk.pieces.size() >= 90);  // 10 s
    CHECK(desk.pieces.size() <= 101);
}

TEST_CASE("The bar never wraps, however narrow the terminal is") {
    for (const bool unicode : {false, true})
        for (int columns = 1; columns < 130; ++columns) {
            Desk desk;
            desk.columns = columns;
            desk.look.unicode = unicode;
            ProgressBar bar(desk.sink, desk.clock, desk.look);
            bar.begin_stage("layers", 4000, "layers");
            for (const int step : {7, 1234, 2759}) {
                desk.now_s += 60;
                bar.advance(std::uint64_t(step));
                std::string drawn = desk.pieces.back();
                if (drawn.starts_with("\r\x1b[K")) drawn.erase(0, 4);
                INFO(columns << ": " << drawn);
                CHECK(columns_of(drawn) < std::max(columns, 2));
                if (columns > 60)
                    CHECK_THAT(drawn, Contains("4000/4000") || Contains("7/4000") || Contains("1241/4000"));
            }
        }
}

TEST_CASE("A warning stands on its own line, with the bar below") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.warn("before");
    CHECK(desk.pieces.back() == "warning: before\n");
    bar.begin_stage("repair", 0);
    bar.warn("two\x1b[2Jholes");
    CHECK_THAT(desk.pieces.back(),
               StartsWith("\r\x1b[Kwarning: two?[2Jholes\n") && Contains("\nrepair") && !EndsWith("\n"));
    desk.now_s += 2;
    bar.end_stage();
    CHECK_THAT(desk.pieces.back(), EndsWith("repair: 2.0 s\n"));
}

TEST_CASE("A stage that fails leaves no bar behind") {
    Desk desk;
    {
        ProgressBar bar(desk.sink, desk.clock, desk.look);
        bar.begin_stage("solid", 10);
    }
    CHECK(desk.pieces.back() == "\r\x1b[K");
}

TEST_CASE("The time left is that of the whole job where it is known, and the bar moves without steps") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.expect({{"layers", 4}, {"predict", 28}});
    bar.begin_stage("layers", 400, "layers");
    desk.now_s += 2;
    bar.advance(200);
    CHECK_THAT(desk.pieces.back(), EndsWith("about 30 s left"));
    desk.now_s += 2;
    bar.advance(200);
    bar.end_stage();
    bar.begin_stage("predict", 0);
    const std::size_t before = desk.pieces.size();
    for (int i = 0; i < 5; ++i) {
        desk.now_s += 1;
        bar.tick();
        CHECK(desk.pieces.back() != desk.pieces[desk.pieces.size() - 2]);
    }
    CHECK(desk.pieces.size() == before + 5);
    CHECK_THAT(desk.pieces.back(), EndsWith("predict  5.0 s  about 25 s left"));
}

TEST_CASE("A bar that ticks draws by itself", "[slow]") {
    std::atomic<int> drawn{0};
    ProgressBar bar([&](std::string_view) { ++drawn; }, steady_seconds(), {[] { return 80; }, false, true});
    bar.begin_stage("predict", 0);
    while (drawn < 3) std::this_thread::yield();
    SUCCEED("the ticker drew; without it this would not end");
}

TEST_CASE("A log is silent about what takes no time, and gives a sign of life in what takes long") {
    Desk desk;
    ProgressLines lines(desk.sink, desk.clock);
    for (const int stage : {1, 2, 3}) {
        lines.begin_stage("verify", 40, "layers");
        for (int i = 0; i < 40; ++i) {
            desk.now_s += 0.001 * stage;
            lines.advance();
        }
        lines.end_stage();
    }
    CHECK(desk.pieces.empty());
    lines.expect({{"predict", 60}});
    lines.begin_stage("predict", 0);
    for (int i = 0; i < 50; ++i) {
        desk.now_s += 1;
        lines.tick();
    }
    CHECK(desk.all() == "predict after 20 s, about 40 s left\npredict after 40 s, about 20 s left\n");
    lines.end_stage();
    CHECK_THAT(desk.pieces.back(), EndsWith("predict: 50 s\n"));
}

TEST_CASE("A log gets every tenth and the end") {
    Desk desk;
    ProgressLines lines(desk.sink, desk.clock);
    lines.begin_stage("layers", 25, "layers");
    for (int i = 0; i < 25; ++i) {
        desk.now_s += 1;
        lines.advance();
    }
    lines.end_stage();
    CHECK(desk.pieces[0] == "layers: 10 % (3/25 layers) after 3.0 s, 22 s left\n");  // 2.5 is not whole: 3
    CHECK(desk.pieces[1] == "layers: 20 % (5/25 layers) after 5.0 s, 20 s left\n");
    CHECK(desk.pieces.back() == "layers: 25 layers in 25 s (1/s)\n");
    CHECK(desk.pieces.size() == 10);  // 10 to 90 %, end
}

TEST_CASE("Large steps skip tenths, and stages of unknown length and without steps have no tenths") {
    Desk desk;
    ProgressLines lines(desk.sink, desk.clock);
    lines.begin_stage("layers", 10);
    desk.now_s += 3;
    lines.advance(7);
    lines.advance(3);
    lines.end_stage();
    CHECK(desk.pieces.size() == 2);
    CHECK_THAT(desk.pieces[0], Contains("70 % (7/10 steps)"));
    desk.pieces.clear();
    lines.begin_stage("reading", 0, "bytes");
    lines.advance(1000);
    desk.now_s += 2;
    lines.end_stage();
    CHECK(desk.all() == "reading: 1000 bytes in 2.0 s (500/s)\n");
}

TEST_CASE("Quiet means warnings only") {
    Desk desk;
    ProgressQuiet quiet(desk.sink);
    quiet.begin_stage("layers", 2);
    quiet.advance(2);
    quiet.note("n");
    quiet.warn("w");
    quiet.end_stage();
    CHECK(desk.all() == "warning: w\n");
}

TEST_CASE("Every step of every thread is counted") {
    Desk desk;
    ProgressBar bar(desk.sink, steady_seconds(), desk.look);
    const ThreadLimit limit(4);
    bar.begin_stage("layers", 20000, "layers");
    parallel_for(
        0, 20000, 1, [&](std::size_t) { bar.advance(); }, &bar);
    bar.end_stage();
    CHECK_THAT(desk.pieces.back(), Contains("layers: 20000 layers in "));
}
