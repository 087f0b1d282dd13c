// SPDX-License-Identifier: GPL-3.0-or-later
//
// From OUT to the printer's computer, as a user takes it there.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "io/files/base64.h"
#include "io/layers/manifest.h"
#include "io/pictures/picture_writer.h"
#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr const char* quick = "slice --quiet --no-report --iterations 0 ";

/// High enough for the printer, coloured all over, and lying on its coloured underside.
std::string box(const Folder& folder) {
    folder.write("box.obj", soft_box_obj(3, 2, 1));
    return folder / "box.obj";
}

std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& [name, bytes] : read_tree(folder)) names.insert(name);
    return names;
}

}  // namespace

TEST_CASE("A job leaves what the printer takes, hands it over where it is told to, and does neither twice") {
    const Folder folder("to-printer");
    const std::string job = quick + box(folder) + " -o " + (folder / "out");
    REQUIRE(run_program(job).exit_code == 0);
    const fs::path printer = folder.path() / "out/printer";
    CHECK(names_in(printer).size() == 37 + 1);  // 1 mm of 27 um
    CHECK(names_in(printer).contains("HOW-TO-PRINT.html"));
    CHECK(run_program("verify " + printer.string()).exit_code == 0);
    const std::string page = read_file(printer / "HOW-TO-PRINT.html");
    for (const char* words :
         {"High Mix", "Voxel Print utility", "27 um", "VeroMGT-V", "205, 25, 110", "slice_00036.png", "600 x 300 dpi",
          "voxtone target marker --printer stratasys-j750-hm", "box.obj"})
        CHECK_THAT(page, Contains(words));
    // 3 x 2 mm of it lie on the tray, and all of it is coloured: 6 of 22 mm2.
    CHECK_THAT(page, Contains("0.06 of 0.22 cm<sup>2</sup>") && Contains("facing down"));

    // Done before: the print is handed over all the same.
    REQUIRE(run_program(job + " --for-printer " + (folder / "usb/box")).exit_code == 0);
    CHECK(read_tree(folder / "usb/box") == read_tree(printer));
    CHECK(run_program("verify " + (folder / "usb/box")).exit_code == 0);
    REQUIRE(run_program(job + " --for-printer " + (folder / "usb/box")).exit_code == 0);
    REQUIRE(run_program(job + " --for-printer " + (folder / "box.zip")).exit_code == 0);
    if (is_here("unzip")) {
        REQUIRE(run_shell("cd " + folder.path().string() + " && mkdir un && cd un && unzip -q ../box.zip") == 0);
        CHECK(read_tree(folder / "un") == read_tree(printer));
    }
    CHECK(run_program("verify " + (folder / "box.zip")).exit_code == 0);
    if (is_here("zip")) {
        REQUIRE(run_shell("cd " + folder.path().string() +
                          " && cp box.zip less.zip && zip -qd less.zip layers/slice_00002.png") == 0);
        const Outcome less = run_program("verify " + (folder / "less.zip"));
        CHECK(less.exit_code == 6);
        CHECK_THAT(less.out, Contains("[missing-layer] layers/slice_00002.png"));
    }

    // Another print is refused before it is made, and takes the place where that is allowed.
    const std::string other = quick + box(folder) + " --depth 0.9mm --for-printer " + (folder / "usb/box") + " -o ";
    const Outcome refused = run_program(other + (folder / "other"));
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("holds another print") && Contains("--overwrite"));
    CHECK_FALSE(fs::exists(folder.path() / "other"));
    REQUIRE(run_program(other + (folder / "other") + " --overwrite").exit_code == 0);
    CHECK(read_tree(folder / "usb/box") == read_tree(folder / "other/printer"));
    // The place for it is no part of the job: job.json does not keep it.
    CHECK(read_file(folder / "other/job.json").find("usb") == std::string::npos);

    // -o x.gcvf: the file alone, and all else beside it; by a second time it is there, and another takes its place
    // where that is allowed.
    const std::string one = quick + box(folder) + " -o " + (folder / "one.gcvf");
    REQUIRE(run_program(one).exit_code == 0);
    CHECK(read_file(folder / "one.gcvf") == read_file(folder / "one/printer/stack.gcvf"));
    CHECK(run_program("verify " + (folder / "one.gcvf")).exit_code == 0);
    CHECK(run_program(one).exit_code == 0);
    fs::remove_all(folder.path() / "one");
    CHECK_THAT(run_program(one + " --depth 0.9mm").err, Contains("one.gcvf: holds another print"));
    CHECK(run_program(one + " --depth 0.9mm --overwrite").exit_code == 0);
    CHECK(read_file(folder / "one.gcvf") == read_file(folder / "one/printer/stack.gcvf"));
    folder.write("mine.gcvf", "a letter");
    CHECK_THAT(run_program(quick + box(folder) + " --overwrite -o " + (folder / "mine.gcvf")).err,
               Contains("nothing that was made for a printer"));
    CHECK(read_file(folder / "mine.gcvf") == "a letter");
    CHECK_THAT(run_program(one + " --for-printer " + (folder / "two.zip")).err, Contains("names another place"));

    CHECK_THAT(
        run_program(quick + box(folder) + " --shard 1/2 --for-printer " + (folder / "x") + " -o " + (folder / "y")).err,
        Contains("voxtone merge"));
    CHECK(run_program(quick + box(folder) + " --overwrite --for-printer " + (folder / "out/sub") + " -o " +
                      (folder / "out"))
              .exit_code == 3);
    CHECK(run_program("verify " + (folder / "out")).exit_code == 0);
}

TEST_CASE("Pages name the cartridges that the resin set is of") {
    const Folder folder("cartridges");
    const auto page_of = [&](const std::string& printer, const std::string& resins, const std::string& said) {
        const std::string job = box(folder) + " --printer " + printer + " --resins " + resins;
        const std::string out = folder / (printer + resins);
        const Outcome sliced = run_program(quick + job + " --formats png,gcvf -o " + out);
        CHECK(sliced.exit_code == 0);
        CHECK((sliced.err.find("[cartridges]") == std::string::npos) == said.empty());
        CHECK_THAT(sliced.err + run_program("estimate " + job).out, Contains(said));
        return read_file(out + "/printer/HOW-TO-PRINT.html");
    };
    CHECK_THAT(page_of("stratasys-j750-hm", "j750-vivid", ""), Contains("VeroCY-V") && !Contains("VeroCyan<"));
    CHECK_THAT(page_of("stratasys-j750-hm", "j750-opaque", ""), Contains("VeroMgnt") && !Contains("VeroMGT-V"));
    CHECK_THAT(page_of("stratasys-j55", "j750-opaque",
                       "of Vero opaque cartridges, and printer stratasys-j55 takes Vero Vivid"),
               Contains("[cartridges]") && Contains("VeroMagenta") && !Contains("VeroMGT-V"));
}

TEST_CASE("A GCVF for the printer is the same for one thread and many, and of shards") {
    const Folder folder("gcvf-shards");
    const std::string job = quick + box(folder) + " --formats gcvf -o ";
    REQUIRE(run_program(job + (folder / "many")).exit_code == 0);
    REQUIRE(run_program(job + (folder / "one") + " --threads 1").exit_code == 0);
    for (const char* shard : {"2/3", "1/3", "3/3"})
        REQUIRE(run_program(job + (folder / "parts") + " --shard " + shard).exit_code == 0);
    const Outcome merged =
        run_program("merge --no-report " + (folder / "parts") + " --for-printer " + (folder / "usb"));
    INFO(merged.err);
    REQUIRE(merged.exit_code == 0);
    const auto wanted = read_tree(folder / "many/printer");
    CHECK(names_in(folder / "many/printer") == std::set<std::string>{"HOW-TO-PRINT.html", "stack.gcvf"});
    for (const char* other : {"one/printer", "parts/printer", "usb"}) {
        CAPTURE(other);
        CHECK(read_tree(folder.path() / other) == wanted);
    }
    CHECK(run_program("verify " + (folder / "usb")).exit_code == 0);
    REQUIRE(run_program("merge --no-report " + (folder / "parts") + " --for-printer " + (folder / "usb")).exit_code ==
            0);
    for (const auto& [name, bytes] : read_tree(folder / "parts/shards")) CHECK(name.find("whole") == std::string::npos);
}

TEST_CASE("Shards whose resins are gone are merged without the printer's folder, which a later merge makes") {
    const Folder folder("shards-lost-resins");
    folder.write("mine.json", read_file(source_dir() + "/data/resins/j750-opaque.json"));
    const std::string resins = folder / "mine.json", job = quick + box(folder) + " --resins " + resins;
    for (const char* out : {"usual", "lost"})
        for (const char* shard : {"1/2", "2/2"})
            REQUIRE(run_program(job + " --formats png,gcvf -o " + (folder / out) + " --shard " + shard).exit_code == 0);
    REQUIRE(run_program("merge --no-report " + (folder / "usual")).exit_code == 0);
    const std::string merge = "merge --no-report " + (folder / "lost");
    fs::rename(resins, resins + ".away");
    for (int again = 0; again < 2; ++again) {
        const Outcome merged = run_program(merge);
        CHECK(merged.exit_code == 0);
        CHECK_THAT(merged.err, Contains("is not made, as the job cannot be opened") && Contains("[printer-folder]"));
        CHECK_FALSE(fs::exists(folder.path() / "lost/printer"));
        CHECK(run_program("verify " + (folder / "lost")).exit_code == 0);
    }
    fs::rename(resins + ".away", resins);
    const Outcome made = run_program(merge);
    CHECK(made.exit_code == 0);
    CHECK_THAT(made.err, !Contains("[printer-folder]"));
    CHECK(read_tree(folder / "lost/printer") == read_tree(folder / "usual/printer"));
    CHECK(names_in(folder / "lost/shards") == names_in(folder / "usual/shards"));
    CHECK(run_program("verify " + (folder / "lost/printer")).exit_code == 0);
}

TEST_CASE("A shard whose part of the Zbuffer was lost or spoilt is asked for again") {
    const Folder folder("lost-part");
    const std::string job = quick + box(folder) + " -o " + (folder / "out") + " --shard ";
    for (const char* shard : {"1/2", "2/2"}) REQUIRE(run_program(job + shard).exit_code == 0);
    fs::path part;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "out/shards"))
        if (entry.path().filename() == "0002-of-0002.png") part = entry.path();
    REQUIRE_FALSE(part.empty());
    const std::string good = read_file(part);
    fs::remove(part);
    const Outcome lost = run_program("merge --no-report " + (folder / "out"));
    CHECK(lost.exit_code == 3);
    CHECK_THAT(lost.err, Contains("0002-of-0002.png: is not there") && Contains("--shard 2/2"));
    folder.write(fs::relative(part, folder.path()).string(), read_file(part.parent_path() / "0001-of-0002.png"));
    CHECK_THAT(run_program("merge --no-report " + (folder / "out")).err, Contains("not what the shard's record says"));
    folder.write(fs::relative(part, folder.path()).string(), good);
    CHECK(run_program("merge --no-report " + (folder / "out")).exit_code == 0);
    CHECK(run_program("verify " + (folder / "out/printer")).exit_code == 0);
}

TEST_CASE("The page at the printer shows a print in its colours, as it lies on the tray") {
    const Folder folder("from-above");
    // Red at the upper left, blue below, white at the right.
    voxtone::io::Picture8 flag{30, 20, 3, {}};
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 30; ++x)
            for (const int code : x >= 15  ? std::array{255, 255, 255}
                                  : y < 10 ? std::array{255, 0, 0}
                                           : std::array{0, 0, 255})
                flag.codes.push_back(std::uint8_t(code));
    const auto png = voxtone::io::png_bytes(flag);
    folder.write("flag.png", std::string(png.begin(), png.end()));
    for (const std::string more : {"", "--flip-x"}) {
        INFO(more);
        REQUIRE(run_program(quick + std::string("--width 3mm --thickness 1mm --overwrite ") + more + " " +
                            (folder / "flag.png") + " -o " + (folder / "out"))
                    .exit_code == 0);
        const std::string page = read_file(folder / "out/printer/HOW-TO-PRINT.html"), mark = "data:image/png;base64,";
        const std::size_t at = page.find(mark) + mark.size();
        const auto bytes = voxtone::io::base64_bytes(std::string_view(page).substr(at, page.find('"', at) - at));
        folder.write("above.png", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        const Bitmap above = read_png(folder / "above.png");
        const auto is = [&](double x, double y, std::array<int, 3> wanted) {  // what is lower is a little darker
            const auto seen = above.at(int(x * above.width), int(y * above.height));
            return std::abs(seen[0] - wanted[0]) < 9 && std::abs(seen[1] - wanted[1]) < 9 &&
                   std::abs(seen[2] - wanted[2]) < 9;
        };
        const double left = more.empty() ? 0.25 : 0.75;
        CHECK(is(left, 0.25, std::array{255, 0, 0}));
        CHECK(is(left, 0.75, std::array{0, 0, 255}));
        CHECK(is(1 - left, 0.25, std::array{255, 255, 255}));
    }
}

TEST_CASE("A tray's page names its parts, and the marker is a print like any other") {
    const Folder folder("printer-tray");
    folder.write("low.obj", soft_box_obj(3, 2, 1));
    folder.write("high.obj", soft_box_obj(2, 2, 2));
    REQUIRE(run_program("tray --quiet --no-report --iterations 0 " + (folder / "low.obj") + " " +
                        (folder / "high.obj") + " --gap 3mm -o " + (folder / "tray") + " --for-printer " +
                        (folder / "tray.zip"))
                .exit_code == 0);
    const std::string page = read_file(folder / "tray/printer/HOW-TO-PRINT.html");
    CHECK_THAT(page, Contains("a tray of 2 parts") && Contains("<td>low</td>") && Contains("<td>high</td>"));
    CHECK(run_program("verify " + (folder / "tray/printer")).exit_code == 0);
    CHECK(fs::exists(folder.path() / "tray.zip"));
    const auto stack = voxtone::io::read_manifest(folder.path() / "tray/manifest.json");
    REQUIRE(stack.members.size() == 2);
    const std::array<std::array<double, 3>, 2> size_mm{{{3, 2, 1}, {2, 2, 2}}};
    for (std::size_t m = 0; m < 2; ++m) {
        const voxtone::io::StackMember& member = stack.members[m];
        CHECK(member.name == (m == 0 ? "low" : "high"));
        CHECK(member.ml == Approx(size_mm[m][0] * size_mm[m][1] * size_mm[m][2] * 1e-3).epsilon(0.05));
        REQUIRE(member.boxes_mm.size() == 1);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double low = member.boxes_mm[0][axis], high = member.boxes_mm[0][axis + 3];
            CHECK(high - low == Approx(size_mm[m][axis]).margin(stack.pitch_um[axis] * 1e-3));
            CHECK(low >= 0);
            CHECK(high <= stack.size_mm[axis] + 1e-6);
        }
    }
    CHECK_THAT(page, Contains("in the colours that were asked for"));
    double ml = 0;
    for (const auto& resin : stack.resins) ml += resin.ml;
    CHECK(stack.members[0].ml + stack.members[1].ml == Approx(ml).epsilon(0.01));

    REQUIRE(run_program("target marker --gcvf -o " + (folder / "marker")).exit_code == 0);
    CHECK(run_program("verify " + (folder / "marker/printer")).exit_code == 0);
    CHECK_THAT(read_file(folder / "marker/printer/HOW-TO-PRINT.html"), Contains("set flip_x"));
    CHECK(run_program("target marker -o " + (folder / "marker")).exit_code == 3);
    CHECK(run_program("target marker --load W -o " + (folder / "other")).exit_code == 3);
}
