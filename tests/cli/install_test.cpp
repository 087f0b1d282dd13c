// SPDX-License-Identifier: GPL-3.0-or-later
//
// `cmake --install` makes a program that runs from anywhere, with all that belongs to it.
#include <filesystem>
#include <string>

#include <catch2/catch.hpp>

#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

int run_in(const std::filesystem::path& folder, const std::string& command) {
    return run_shell("cd '" + folder.string() + "' && " + command + " >out.txt 2>err.txt");
}

}  // namespace

TEST_CASE("The installed program runs from elsewhere, with its helpers, manual and completion") {
    const Folder folder("install"), elsewhere("elsewhere");
    const std::filesystem::path prefix = folder.path() / "usr";
    REQUIRE(run_in(folder.path(), "cmake --install '" + build_dir() + "' --component program --prefix '" +
                                      prefix.string() + "'") == 0);
    for (const char* file : {"bin/voxtone", "libexec/voxtone/voxtone-read", "libexec/voxtone/voxtone-calibrate",
                             "libexec/voxtone/voxtone-photographs.so", "libexec/voxtone/voxtone-vdb.so",
                             "share/man/man1/voxtone.1", "share/man/man1/voxtone-slice.1",
                             "share/man/man1/voxtone-calibrate.1", "share/bash-completion/completions/voxtone",
                             "share/zsh/site-functions/_voxtone", "share/voxtone/schema/job.schema.json"}) {
        INFO(file);
        CHECK(std::filesystem::exists(prefix / file));
    }
    // Nobody who makes the path of the build on another machine is asked for anything there.
    for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix)) {
        if (!entry.is_regular_file()) continue;
        INFO(entry.path().string());
        const std::string bytes = read_file(entry.path());
        CHECK(bytes.find(build_dir()) == std::string::npos);
        CHECK(bytes.find(source_dir()) == std::string::npos);
    }
    elsewhere.write("marker.obj", marker_obj());
    const std::string voxtone =
        "env -u VOXTONE_HELPERS PATH='" + (prefix / "bin").string() + ":/usr/bin:/bin' voxtone ";
    CHECK(run_in(elsewhere.path(), voxtone + "slice marker.obj --iterations 0 --predict none --quiet -o print") == 0);
    INFO(read_file(elsewhere / "err.txt"));
    CHECK(std::filesystem::exists(elsewhere / "print/manifest.json"));
    CHECK(run_in(elsewhere.path(), voxtone + "verify print") == 0);
    CHECK(run_in(elsewhere.path(), voxtone + "calibrate --help") == 0);
    CHECK_THAT(read_file(elsewhere / "out.txt"), Contains("voxtone calibrate"));
}
