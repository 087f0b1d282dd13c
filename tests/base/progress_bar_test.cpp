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
    CHECK(duration_text(9.95) == "10 s");
    CHECK(duration_text(9.96) == "10 s");
    CHECK(duration_text(3599.4) == "59 min 59 s");
    CHECK(duration_text(3599.5) == "1 h 00 min");
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

TEST_CASE("A bar is not drawn again at once, nor between stages, and its name alone where no more fits") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.begin_stage("layers", 10);
    desk.now_s += 0.09;
    bar.advance();
    CHECK(desk.pieces.size() == 1);
    desk.now_s += 0.02;
    bar.advance();
    CHECK(desk.pieces.size() == 2);
    bar.end_stage();
    bar.tick();
    CHECK(desk.pieces.size() == 3);
    desk.columns = 7;  // one is left free
    bar.begin_stage("layers", 10);
    CHECK(desk.pieces.back() == "layers");
    desk.columns = 6;
    desk.now_s += 1;
    bar.tick();
    CHECK(desk.pieces.back() == "\r\x1b[K");
}

TEST_CASE("A log that ticks gives its signs of life by itself", "[slow]") {
    std::atomic<int> told{0};
    std::atomic<double> now_s{0};
    ProgressLines lines([&](std::string_view) { ++told; }, [&] { return now_s.load(); }, true);
    lines.begin_stage("predict", 0);
    now_s = 30;
    while (told < 1) std::this_thread::yield();
    SUCCEED("the ticker told; without it this would not end");
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

TEST_CASE("While a part is worked on its name stands before what is warned of, once") {
    Desk desk;
    ProgressQuiet quiet(desk.sink);
    {
        const WarningsOfPart tray(quiet, "tray");
        {
            const WarningsOfPart cow(quiet, "cow");
            quiet.warn("w");
            quiet.warn("cow: is turned");
        }
        quiet.warn("w");
    }
    quiet.warn("w");
    CHECK(desk.all() == "warning: cow: w\nwarning: cow: is turned\nwarning: tray: w\nwarning: w\n");
    Progress nobody;
    const WarningsOfPart unheard(nobody, "cow");  // is no fault
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

TEST_CASE("Rates have three digits, and thousands and millions their letters") {
    for (const auto& [steps, rate] : {std::pair{20, "(2/s)"}, std::pair{9990, "(999/s)"}, std::pair{10000, "(1k/s)"},
                                      std::pair{123400, "(12.3k/s)"}, std::pair{9990000, "(999k/s)"},
                                      std::pair{10000000, "(1M/s)"}, std::pair{25600000, "(2.56M/s)"}}) {
        Desk desk;
        ProgressLines lines(desk.sink, desk.clock);
        lines.begin_stage("voxels", 0);
        lines.advance(std::uint64_t(steps));
        desk.now_s += 10;
        lines.end_stage();
        CHECK_THAT(desk.all(), Contains(rate));
    }
}

TEST_CASE("A bar of block characters is filled by eighths") {
    const auto drawn = [](std::uint64_t done) {
        Desk desk;
        desk.look.unicode = true;
        ProgressBar bar(desk.sink, desk.clock, desk.look);
        bar.begin_stage("x", 240, "y");  // of 30 columns: a step is an eighth of one
        desk.now_s += 0.5;
        bar.advance(done);
        const std::string text = desk.pieces.back();
        return text.substr(text.find("▕"), text.rfind("▏") + std::string("▏").size() - text.find("▕"));
    };
    const auto bar = [](int whole, const std::string& part) {
        std::string text = "▕";
        for (int i = 0; i < whole; ++i) text += "█";
        return text + part + std::string(std::size_t(30 - whole - (part.empty() ? 0 : 1)), ' ') + "▏";
    };
    CHECK(drawn(8) == bar(1, ""));
    CHECK(drawn(9) == bar(1, "▏"));
    CHECK(drawn(12) == bar(1, "▌"));
    CHECK(drawn(15) == bar(1, "▉"));
    CHECK(drawn(239) == bar(29, "▉"));
    CHECK(drawn(240) == bar(30, ""));
}

TEST_CASE("A bar shows the most that was done, and no time left before a second has passed") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.begin_stage("layers", 100, "layers");
    desk.now_s += 0.99;
    bar.advance(10);
    CHECK_THAT(desk.pieces.back(), Contains("10/100") && EndsWith("  1.0 s") && !Contains("/s") && !Contains("left"));
    desk.now_s += 1;
    bar.advance(10);
    CHECK_THAT(desk.pieces.back(), Contains(" 20 %") && Contains("10.1/s") && EndsWith("8.0 s left"));
    // Steps beyond the end: full, and nothing is left.
    desk.now_s += 1;
    bar.advance(100);
    CHECK_THAT(desk.pieces.back(),
               Contains("[==============================]") && Contains("100 %") && EndsWith("0.0 s left"));
    bar.expect_steps(50);
    desk.now_s += 1;
    bar.tick();
    CHECK_THAT(desk.pieces.back(), Contains("120/100"));  // not fewer than are done, and never more
}

TEST_CASE("A bar of fewer steps than were announced ends where they end") {
    Desk desk;
    ProgressBar bar(desk.sink, desk.clock, desk.look);
    bar.begin_stage("loop", 100);
    bar.expect_steps(20);
    desk.now_s += 2;
    bar.advance(10);
    CHECK_THAT(desk.pieces.back(), Contains("10/20 steps") && Contains(" 50 %"));
    bar.expect_steps(5);
    desk.now_s += 2;
    bar.tick();
    CHECK_THAT(desk.pieces.back(), Contains("10/10 steps"));
    ProgressLines lines(desk.sink, desk.clock);
    lines.begin_stage("loop", 100);
    lines.expect_steps(20);
    desk.now_s += 25;
    lines.tick();
    CHECK_THAT(desk.pieces.back(), StartsWith("loop: 0/20 steps after 25 s"));
}

TEST_CASE("Lines keep their pauses to the second") {
    const auto pieces_of = [](auto work) {
        Desk desk;
        ProgressLines lines(desk.sink, desk.clock);
        work(desk, lines);
        return desk.pieces.size();
    };
    for (const auto& [seconds, lines_of_end] : {std::pair{0.99, 0u}, std::pair{1.0, 1u}})
        CHECK(pieces_of([&, seconds = seconds](Desk& desk, ProgressLines& lines) {
                  lines.begin_stage("a", 0);
                  desk.now_s += seconds;
                  lines.end_stage();
              }) == lines_of_end);
    for (const auto& [seconds, tenths] : {std::pair{1.99, 0u}, std::pair{2.0, 1u}})
        CHECK(pieces_of([&, seconds = seconds](Desk& desk, ProgressLines& lines) {
                  lines.begin_stage("a", 10);
                  desk.now_s += seconds;
                  lines.advance(1);
              }) == tenths);
    for (const auto& [seconds, signs] : {std::pair{19.49, 0u}, std::pair{19.5, 1u}})
        CHECK(pieces_of([&, seconds = seconds](Desk& desk, ProgressLines& lines) {
                  lines.begin_stage("a", 0);
                  desk.now_s += seconds;
                  lines.tick();
              }) == signs);
    CHECK(pieces_of([&](Desk& desk, ProgressLines& lines) {
              lines.begin_stage("a", 10);
              desk.now_s += 1;
              lines.end_stage();
              desk.now_s += 100;
              lines.tick();  // between stages
          }) == 1);
}
