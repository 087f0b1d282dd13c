// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is in the output folder stays until something whole takes its place, and only if the user said so.
#include <unistd.h>

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "io/disk/folder_lock.h"
#include "run_program.h"

using namespace voxtone::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr const char* quick = "slice --quiet --no-report --iterations 0 ";

std::string box(const Folder& folder) {
    folder.write("box.obj", soft_box_obj(3, 2, 1));
    return folder / "box.obj";
}

}  // namespace

TEST_CASE("No verb replaces a file that is there without --overwrite") {
    const Folder folder("photograph");
    REQUIRE(run_program(quick + box(folder) + " -o " + (folder / "out")).exit_code == 0);
    folder.write("photo.png", "precious");
    const std::string photo = folder / "photo.png";
    const auto kept = [&](const std::string& command) {
        INFO(command);
        const Outcome outcome = run_program(command);
        CHECK(outcome.exit_code == 3);
        CHECK_THAT(outcome.err, Contains("photo.png") && Contains("--overwrite"));
        CHECK(read_file(photo) == "precious");
    };
    kept("predict " + (folder / "out") + " --view body -o " + (folder / "seen.png") + " -o " + photo);
    kept("laminate dataset marble --points 4 --paths 10 -o " + photo);
    folder.write("photo.json", "precious");
    kept("calibrate simulate none.json -o " + photo);
    kept("calibrate fit none.csv --report " + photo + " -o " + (folder / "resins.json"));
    kept("calibrate photo none.tif --target none.json --overlay " + photo + " -o " + (folder / "patches.csv"));
    const Outcome twice =
        run_program("predict " + (folder / "out") + " --view body --overwrite -o " + photo + " -o " + photo);
    CHECK(twice.exit_code == 3);
    CHECK_THAT(twice.err, Contains("twice"));
    REQUIRE(run_program("predict --quiet --predict layered-profile --cell 0.5mm --overwrite " + (folder / "out") +
                        " --view top -o " + photo)
                .exit_code == 0);
    CHECK(read_file(photo) != "precious");
}

TEST_CASE("Another job's stack is refused, and stays when the new job fails") {
    const Folder folder("others");
    const std::string out = folder / "out";
    REQUIRE(run_program(quick + box(folder) + " -o " + out).exit_code == 0);
    const auto before = read_tree(out);
    const Outcome other = run_program(quick + box(folder) + " --size 2.9mm -o " + out);
    CHECK(other.exit_code == 3);
    CHECK_THAT(other.err, Contains("holds a stack of 37 layers") && Contains("--overwrite"));
    CHECK(read_tree(out) == before);
    folder.write("broken.obj", "f 1 2 3\n");
    CHECK(run_program(quick + (folder / "broken.obj") + " --overwrite -o " + out).exit_code == 3);
    CHECK(read_tree(out) == before);
    CHECK(run_program(quick + box(folder) + " --size 2.9mm --overwrite -o " + out).exit_code == 0);
    CHECK(read_tree(out) != before);
}

TEST_CASE("A folder that another job holds is said to be, and why: 75, try again") {
    const Folder folder("held");
    fs::create_directory(folder / "out");
    const voxtone::io::FolderLock held(folder / "out");
    const Outcome outcome = run_program(quick + box(folder) + " -o " + (folder / "out"));
    CHECK(outcome.exit_code == 75);
    CHECK_THAT(outcome.err, Contains(fmt::format("process {}", getpid())) && Contains("since"));
}

TEST_CASE("What verify would refuse is refused before the work") {
    const Folder folder("thin");
    folder.write("slab.obj", soft_box_obj(5, 3, 0.5));
    const Outcome outcome = run_program(quick + (folder / "slab.obj") + " -o " + (folder / "out"));
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Contains("19 layers") && Contains("no fewer than 30"));
    CHECK_FALSE(fs::exists(folder / "out"));
    folder.write("lenient.json", lenient_printer());
    CHECK(run_program(quick + (folder / "slab.obj") + " --printer " + (folder / "lenient.json") + " -o " +
                      (folder / "out"))
              .exit_code == 0);
}
