// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/disk_space.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/disk/open_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

TEST_CASE("a full disk is a reason to try again, said as such, other faults are not", "[whole-file]") {
    CHECK_THROWS_AS(fail_to_write("a.png", "could not be written", ENOSPC), TryAgain);
    CHECK_THROWS_WITH(fail_to_write("a.png", "could not be written", EDQUOT), Contains("a.png") && Contains("full"));
    CHECK_THROWS_AS(fail_to_write("a.png", "could not be written", EIO), FileError);
    CHECK_THROWS_AS(fail_to_write("out", "cannot be put in place", EXDEV), FileError);
    CHECK_THROWS_WITH(fail_to_write("out", "cannot be put in place", EXDEV),
                      Contains("overlayfs") && Contains("mounted volume"));
    try {
        fail_to_write("a.png", "could not be written", ENOSPC);
    } catch (const Error& error) {
        CHECK(static_cast<int>(error.exit_code()) == 75);
    }
    // A device that is always full.
    const OpenFile full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
    REQUIRE(full);
    CHECK(::write(full.get(), "x", 1) < 0);
    CHECK(errno == ENOSPC);
}

TEST_CASE("room on the disk is asked for where the folder will be", "[disk-space]") {
    const TemporaryFolder folder;
    const auto free = free_disk_bytes(folder.path() / "not" / "yet" / "there");
    REQUIRE(free);
    CHECK(*free > 0);
    CHECK_NOTHROW(expect_disk_space(folder.path(), 1, "a byte"));
    CHECK_THROWS_AS(expect_disk_space(folder.path(), std::uint64_t{1} << 62, "the layers"), TryAgain);
    CHECK_THROWS_WITH(expect_disk_space(folder.path(), std::uint64_t{1} << 62, "the layers"),
                      Contains("free") && Contains("the layers need"));
}
