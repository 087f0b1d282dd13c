// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/folder_lock.h"

#include <chrono>
#include <fstream>
#include <iterator>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
namespace fs = std::filesystem;

namespace {

std::ptrdiff_t files_in(const fs::path& folder) { return std::distance(fs::directory_iterator(folder), {}); }

}  // namespace

TEST_CASE("a lock goes with its job and is taken over from a dead one", "[folder-lock]") {
    const TemporaryFolder folder;
    {
        const FolderLock first(folder.path());
        CHECK(fs::exists(folder.path() / lock_name));
        CHECK_THROWS_AS(FolderLock(folder.path()), TryAgain);
    }
    CHECK(files_in(folder.path()) == 0);
    std::ofstream(folder.path() / lock_name) << "not ours at all";
    { const FolderLock second(folder.path()); }
    CHECK(files_in(folder.path()) == 0);
}

TEST_CASE("a line that another host left a moment ago is told of: its lock may not be seen here", "[folder-lock]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / lock_name;
    const auto left = [&](const std::string& line, int seconds_ago) {
        std::ofstream(file) << line;
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::seconds(seconds_ago));
        return FolderLock(folder.path()).doubt();
    };
    const std::string other_host = "node-17 4711 99 2026-11-26T12:00:00Z 0123abcd\n";
    CHECK_THAT(left(other_host, 5), Catch::Contains("node-17") && Catch::Contains("4711") &&
                                        Catch::Contains("2026-11-26T12:00:00Z") &&
                                        Catch::Contains("no locks between hosts"));
    CHECK(left(other_host, 120).empty());
    // One of this host that is in another container is another host's, one that can be seen from here is no more.
    const std::string here = host_name() + " 4194305 99 2026-11-26T12:00:00Z ";
    CHECK_THAT(left(here + "0123abcd\n", 5), Catch::Contains("4194305"));
    CHECK(left(here + process_space() + "\n", 5).empty());
    CHECK(left("", 5).empty());
}
