// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/outcome.h"

#include <cstdio>
#include <new>
#include <string>
#include <system_error>

#include <unistd.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/contracts.h"
#include "base/error.h"
#include "run_program.h"

using namespace voxtone;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

struct Told {
    int exit_code = -1;
    std::string out;
};

/// What `guarded` makes of the work, and what came to stdout meanwhile.
Told told_of(cli::Messages messages, const std::function<int()>& work) {
    const test::Folder folder("outcome");
    std::fflush(stdout);
    const int before = dup(STDOUT_FILENO);
    std::FILE* const file = std::fopen((folder / "out").c_str(), "w");
    dup2(fileno(file), STDOUT_FILENO);
    Told told;
    told.exit_code = cli::guarded(messages, work);
    std::fflush(stdout);
    dup2(before, STDOUT_FILENO);
    close(before);
    std::fclose(file);
    told.out = test::read_file(folder / "out");
    return told;
}

}  // namespace

TEST_CASE("Whatever is thrown has an exit code and, with --json, an event") {
    const auto expect = [](int exit_code, const std::string& words, const std::function<int()>& work) {
        const Told told = told_of(cli::Messages::events, work);
        INFO(told.out);
        CHECK(told.exit_code == exit_code);
        const auto event = nlohmann::json::parse(told.out);
        CHECK(event.at("event") == "error");
        CHECK(event.at("exit_code") == exit_code);
        CHECK_THAT(event.at("message").get<std::string>(), Contains(words));
        CHECK(told_of(cli::Messages::text, work).out.empty());
        CHECK_THAT(told_of(cli::Messages::openjd, work).out, StartsWith("openjd_fail: ") && Contains(words));
    };
    expect(3, "no triangles", []() -> int { throw InputError("no triangles"); });
    expect(5, "cancelled", []() -> int { throw Cancelled(); });
    expect(1, "a bug of ours", []() -> int {
        VOXTONE_EXPECT(1 > 2);
        return 0;
    });
    expect(1, "an unexpected failure", []() -> int { throw std::runtime_error("odd"); });
    expect(1, "no known kind", []() -> int { throw 7; });
    expect(1, "odd", []() -> int { throw std::system_error(std::make_error_code(std::errc::io_error), "odd"); });
    expect(75, "another thread", []() -> int {  // as a thread that finds no room
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again), "pthread_create");
    });
    expect(75, "another thread", []() -> int {
        throw std::runtime_error("pthread_create has failed: Resource temporarily unavailable");  // TBB's
    });
    const Told memory = told_of(cli::Messages::events, []() -> int { throw std::bad_alloc(); });
    CHECK(memory.exit_code >= 5);
    CHECK_THAT(nlohmann::json::parse(memory.out).at("message").get<std::string>(), Contains("memory"));
    CHECK(told_of(cli::Messages::events, [] { return 6; }).exit_code == 6);
}
