// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/output_files.h"

#include <fstream>
#include <iterator>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("outputs are refused before the work: there already, named twice, no folder", "[output-files]") {
    const TemporaryFolder folder;
    const fs::path photo = folder.path() / "photo.png", fresh = folder.path() / "new.png";
    std::ofstream(photo) << "precious";
    CHECK_NOTHROW(expect_outputs({fresh}, false));
    CHECK_THROWS_WITH(expect_outputs({fresh, photo}, false), Contains("photo.png") && Contains("--overwrite"));
    CHECK_NOTHROW(expect_outputs({fresh, photo}, true));
    CHECK_THROWS_WITH(expect_outputs({fresh, folder.path() / "." / "new.png"}, true), Contains("twice"));
    CHECK_THROWS_AS(expect_outputs({folder.path()}, true), FileError);
    CHECK_THROWS_AS(expect_outputs({folder.path() / "none" / "a.png"}, true), FileError);
    CHECK(text_of(photo) == "precious");
}
