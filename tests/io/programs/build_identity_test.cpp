// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/programs/build_identity.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"
#include "tests/places.h"

using namespace voxtone::io;
namespace fs = std::filesystem;

TEST_CASE("a build is told from another one by what decides its bits") {
    CHECK(std::regex_match(build_identity(), std::regex("[0-9]+[.][0-9]+[.][0-9]+ build [0-9a-f]{16}")));
    CHECK(build_identity() == program_version() + " build " + build_digest());
    const TemporaryFolder folder;
    const fs::path root = folder.path() / "tree", made = folder.path() / "made.cpp";
    const auto write = [&](const std::string& name, const std::string& text) {
        fs::create_directories((root / name).parent_path());
        std::ofstream(root / name) << text;
    };
    const auto digest = [&](const std::string& toolchain = "g++ 12") {
        const std::string command =
            fmt::format("cmake '-DROOT={}' '-DOUTPUT={}' '-DTOOLCHAIN={}' -P '{}'", root.string(), made.string(),
                        toolchain, voxtone::test::source_dir() + "/cmake/write_build_digest.cmake");
        REQUIRE(std::system(command.c_str()) == 0);
        return text_of(made);
    };
    write("optics/a.cpp", "one");
    write("data/resins/b.json", "two");
    const std::string first = digest();
    CHECK(first.find("voxtone_build_digest[]") != std::string::npos);
    write("tests/c.cpp", "three");  // decides nothing
    write("docs/d.md", "four");
    CHECK(digest() == first);
    const auto written = fs::last_write_time(made);
    CHECK(digest() == first);
    CHECK(fs::last_write_time(made) == written);  // nothing is compiled for it
    CHECK(digest("g++ 13") != first);
    write("optics/a.cpp", "other");
    const std::string second = digest();
    CHECK(second != first);
    write("data/resins/b.json", "another");
    CHECK(digest() != second);
}
