// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/folder_lock.h"

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
