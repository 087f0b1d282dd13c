// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/isolate.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/packed_values.h"
#include "tests/io/files/taken_program.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

/// What misbehaving_program.cpp leaves when it was asked for this.
std::vector<std::byte> ask(const std::string& wish, IsolationLimits limits = {}, const Progress* progress = nullptr) {
    if (built_with_address_sanitizer()) limits.memory_bytes = 0;
    return run_isolated("test.obj", test::misbehaving_program(), bytes_of(wish), limits, progress);
}

/// Of those that have ended.
double processor_s_of_children() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// In files without a name that this process has open.
std::size_t bytes_in_memory_files() {
    std::size_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        std::error_code gone;
        struct stat about {};
        if (std::filesystem::read_symlink(entry.path(), gone).string().starts_with("/memfd:") &&
            stat(entry.path().c_str(), &about) == 0)
            bytes += static_cast<std::size_t>(about.st_blocks) * 512;
    }
    return bytes;
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("amid its work a program asks who started it") {
    const IsolationLimits limits{.memory_bytes = built_with_address_sanitizer() ? 0 : std::uint64_t{256} << 20};
    const auto start = [&] {
        return std::make_unique<IsolatedProgram>("test.obj", test::misbehaving_program(), bytes_of("ask a"), limits);
    };
    SECTION("as often as it likes, and each time it is answered") {
        const auto program = start();
        int questions = 0;
        program->answer_by([&](std::span<const std::byte> question, const Progress*, std::uint8_t& missing) {
            ++questions;
            missing |= 128;
            std::vector<std::byte> answer(question.begin(), question.end());
            answer.push_back(std::byte{'b'});
            return answer;
        });
        CHECK(text_of(program->result()) == "abb");
        CHECK(questions == 2);
        CHECK((program->missing_walls() & 128) != 0);
        program->post_request(bytes_of("ask x"));
        CHECK(text_of(program->result()) == "xbb");
    }
    SECTION("a refusal is thrown in it") {
        const auto program = start();
        program->answer_by([](auto, auto, auto&) -> std::vector<std::byte> { throw InputError("no such thing"); });
        CHECK_THROWS_WITH(program->result(), "no such thing");
        program->post_request(bytes_of("echo"));  // and it is of use as before
        CHECK(text_of(program->result()) == "echo");
    }
    SECTION("nobody answers") { CHECK_THROWS_WITH(start()->result(), Contains("may not have")); }
    SECTION("what else is thrown ends it") {
        const auto program = start();
        program->answer_by([](auto, auto, auto&) -> std::vector<std::byte> { throw TryAgain("later"); });
        CHECK_THROWS_AS(program->result(), TryAgain);
    }
}

TEST_CASE("work in another program", "[slow]") {
    SECTION("its result comes back, small or large") {
        for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{50} << 20}) {
            const std::vector<std::byte> bytes = ask("make " + std::to_string(size));
            REQUIRE(bytes.size() == size);
            bool same = true;
            for (std::size_t i = 0; i < size; ++i) same &= bytes[i] == static_cast<std::byte>(i * 7);
            CHECK(same);
        }
        const std::string large(std::size_t{3} << 20, 'x');
        CHECK(text_of(ask(large)) == large);
        CHECK(text_of(ask("")).empty());
    }
    SECTION("errors keep their text and kind") {
        CHECK_THROWS_WITH(ask("input error"), "line 7 is wrong");
        CHECK_THROWS_AS(ask("input error"), InputError);
        CHECK_THROWS_AS(ask("file error"), FileError);
        CHECK_THROWS_AS(ask("resource error"), ResourceError);
        CHECK_THROWS_WITH(ask("exception"), Contains("a library says so"));
    }
    SECTION("a crash, a silent end, endless work, endless memory") {
        CHECK_THROWS_WITH(ask("die"), Contains("test.obj") && Contains("crash"));
        CHECK_THROWS_WITH(ask("leave"), Contains("exit code 3"));
        // By the processor's time: how long that takes on a busy machine nobody knows.
        const double before_s = processor_s_of_children();
        CHECK_THROWS_WITH(ask("spin", {.timeout_s = 0.2}), Contains("0.2 s of processor time"));
        CHECK_THROWS_AS(ask("spin", {.timeout_s = 0.2}), ResourceError);
        // What others of its kind took counts.
        IsolatedProgram late("test.obj", test::misbehaving_program(), bytes_of("spin"),
                             {.memory_bytes = 0, .timeout_s = 1000});
        late.count_as_spent(999.8);
        CHECK(late.spent_s() >= 999.8);
        CHECK_THROWS_WITH(late.result(), Contains("1000 s of processor time"));
        const double taken_s = processor_s_of_children() - before_s;
        CHECK(taken_s > 2 * 0.19);
        CHECK(taken_s < 5);
        if (!built_with_address_sanitizer()) {
            CHECK_THROWS_WITH(ask("abort"), Contains("signal 6"));
            const IsolationLimits small{.memory_bytes = std::uint64_t{64} << 20, .more = "--read-memory"};
            CHECK_THROWS_WITH(ask("hoard", small), Contains("64 MiB") && Contains("--read-memory"));
            CHECK_THROWS_AS(ask("hoard", small), ResourceError);
            CHECK_THROWS_AS(ask("make 100000000", small), ResourceError);
        }
    }
    SECTION("what it leaves is not believed") {
        CHECK_THROWS_WITH(ask("leave garbage"), Contains("test.obj") && Contains("crash"));
        CHECK_THROWS_AS(ask("leave garbage"), InputError);
        CHECK_THROWS_AS(ask("leave a byte"), InputError);
        CHECK_THROWS_WITH(ask("leave nonsense"), Contains("test.obj") && Contains("no answer"));
    }
    SECTION("what the machine does to it is not the file's fault") {
        CHECK_THROWS_AS(ask("die of memory"), TryAgain);
        CHECK_THROWS_WITH(ask("die of memory"), Contains("nothing is known to be wrong with the file"));
        const auto start = std::chrono::steady_clock::now();
        CHECK_THROWS_AS(ask("pause", {.timeout_s = 0.05}), TryAgain);  // no time of the processor goes by
        CHECK(std::chrono::steady_clock::now() - start > std::chrono::milliseconds(500));
    }
    SECTION("one after the other") {
        IsolatedProgram program("test.obj", test::misbehaving_program(), bytes_of("first"), {.memory_bytes = 0});
        CHECK(text_of(program.result()) == "first");
        program.post_request(bytes_of("a longer second"));
        CHECK(text_of(program.result()) == "a longer second");
        program.post_request(bytes_of("input error"));
        CHECK_THROWS_AS(program.result(), InputError);
        program.post_request(bytes_of("x"));
        CHECK(text_of(program.result()) == "x");
    }
    SECTION("what it says is not heard") { CHECK(text_of(ask("chatter")) == "chatter"); }
    SECTION("the user's wish to stop ends it") {
        Progress progress;
        std::thread user([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(150));
            progress.cancel();
        });
        CHECK_THROWS_AS(ask("pause", {.memory_bytes = 0}, &progress), Cancelled);
        user.join();
    }
}

TEST_CASE("A large result is held once: what is fetched of it leaves the memory that it came in") {
    constexpr std::size_t size = (std::size_t{40} << 20) + 12345;
    IsolatedProgram program("test.obj", test::misbehaving_program(), bytes_of("make " + std::to_string(size)), {});
    IsolatedProgram::Pieces pieces = program.result_in_pieces(nullptr);
    REQUIRE(pieces.size == size);
    CHECK(bytes_in_memory_files() >= size);
    std::vector<std::byte> first(std::size_t{30} << 20), last(size - first.size());
    pieces.fetch(first.data(), first.size());
    CHECK(bytes_in_memory_files() <= last.size() + (1 << 20));
    pieces.fetch(last.data(), last.size());
    CHECK(bytes_in_memory_files() <= 1 << 20);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < size; ++i)
        wrong += (i < first.size() ? first[i] : last[i - first.size()]) != static_cast<std::byte>(i * 7);
    CHECK(wrong == 0);
}

TEST_CASE("Values are the same bytes packed at once and piece by piece, and come back from either") {
    const std::vector<std::uint32_t> many((std::size_t{9} << 20) + 5, 7);  // more than the reader takes in one piece
    const std::vector<std::string> words{"", "one", std::string(5000, 'x')};
    const std::vector<std::byte> at_once = [&] {
        PackedWriter writer;
        writer(many, words);
        return writer.bytes;
    }();
    std::vector<std::byte> in_pieces;
    packing(many)(*std::make_unique<PackedWriter>([&](const void* from, std::size_t size) {
        const auto* const first = static_cast<const std::byte*>(from);
        in_pieces.insert(in_pieces.end(), first, first + size);
    }));
    REQUIRE(in_pieces.size() < at_once.size());
    CHECK(std::equal(in_pieces.begin(), in_pieces.end(), at_once.begin()));
    std::vector<std::uint32_t> same;
    std::vector<std::string> same_words;
    PackedReader reader(at_once);
    reader(same, same_words);
    reader.expect_end();
    CHECK(same == many);
    CHECK(same_words == words);
    PackedReader cut(std::span<const std::byte>(at_once).first(in_pieces.size() - 1));
    CHECK_THROWS_WITH(cut(same), Contains("cut short"));
}

TEST_CASE("another program is given no open file") {
    const int leaky = open("/dev/zero", O_RDONLY);  // without O_CLOEXEC, as libraries open files
    REQUIRE(leaky >= 0);
    const std::string open_files = text_of(ask("open files"));
    // A sanitizer's report must be seen: there stderr stays what it was, which may be a pipe that cannot be sought in.
    CHECK((open_files == "0 1 2 " || (built_with_address_sanitizer() && open_files == "0 1 ")));
    close(leaky);
}

TEST_CASE("it works while its result is not yet asked for, and ends with whom it works for", "[slow]") {
    IsolatedProgram first("a.obj", test::misbehaving_program(), bytes_of("make 5"), {.memory_bytes = 0});
    IsolatedProgram second("b.obj", test::misbehaving_program(), bytes_of("make 6"), {.memory_bytes = 0});
    CHECK(second.result().size() == 6);
    CHECK(first.result().size() == 5);

    IsolatedProgram late("c.obj", test::misbehaving_program(), bytes_of("make 7"),
                         {.memory_bytes = 0, .timeout_s = 0.3});
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    CHECK(late.result().size() == 7);  // it was in time

    const auto start = std::chrono::steady_clock::now();
    { const IsolatedProgram endless("d.obj", test::misbehaving_program(), bytes_of("pause"), {.memory_bytes = 0}); }
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}

TEST_CASE("a program that cannot be run is told") {
    CHECK_THROWS_AS(run_isolated("a.obj", "/nowhere/voxtone-read", {}, {}), FileError);
    CHECK_THROWS_WITH(run_isolated("a.obj", "/nowhere/voxtone-read", {}, {}),
                      Contains("/nowhere/voxtone-read cannot be run") && Contains("install voxtone again"));
    const TemporaryFolder folder;
    const std::filesystem::path text = folder.path() / "voxtone-read";
    std::ofstream(text) << "no program\n";
    std::filesystem::permissions(text, std::filesystem::perms::owner_all);
    CHECK_THROWS_AS(run_isolated("a.obj", text, {}, {}), FileError);
}
