// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/scratch_file.h"

#include <sys/resource.h>

#include <array>
#include <csignal>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;

namespace {

std::vector<std::byte> pattern(std::size_t size, unsigned seed) {
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>((i * 31 + seed) % 251);
    return bytes;
}

}  // namespace

TEST_CASE("What is put into a scratch file comes back, from where it was put, and nobody sees the file") {
    const TemporaryFolder folder;
    {
        ScratchFile file(folder.path());
        const auto first = pattern(100'000, 1), second = pattern(300, 2);
        file.write(7, first);
        file.write(7 + 50'000, second);
        std::vector<std::byte> back(first.size());
        file.read(7, back);
        CHECK(std::equal(back.begin(), back.begin() + 50'000, first.begin()));
        CHECK(std::equal(second.begin(), second.end(), back.begin() + 50'000));
        CHECK(std::equal(back.begin() + 50'300, back.end(), first.begin() + 50'300));
        CHECK(std::filesystem::is_empty(folder.path()));
        std::array<std::byte, 10> beyond{};
        CHECK_THROWS_AS(file.read(7 + 100'000 - 5, beyond), FileError);
    }
    CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("A scratch file that has no room, or no folder, says so") {
    const TemporaryFolder folder;
    CHECK_THROWS_AS(ScratchFile(folder.path() / "not-there"), FileError);
    ScratchFile file(folder.path());
    // A limit on the size of files stands for a full disk: writes fail with EFBIG, once the signal is ignored.
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, before.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    CHECK_THROWS_WITH(file.write(0, pattern(10'000, 3)), Catch::Contains(folder.path().string()));
    REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
    (void)std::signal(SIGXFSZ, handler);
}
