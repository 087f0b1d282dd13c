// SPDX-License-Identifier: GPL-3.0-or-later
//
// The list of photographs: what it says, and what it refuses.
#include "calibration/bench/bench_list.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

const std::string head = "# a bench\nfile,shows,resin,thickness_mm\n",
                  light = "checker.tif,checker,,\nsheet.tif,sheet\n";

void refuse(const std::string& text, const std::string& why) {
    INFO(why);
    CHECK_THROWS_WITH(parse_bench_list(text, "list.csv"), Contains("list.csv") && Contains(why));
}

}  // namespace

TEST_CASE("a list of photographs says which shows what, those of one slab beside each other", "[edge]") {
    const BenchList list = parse_bench_list(
        head + light + "paper.tif,paper,,\na.tif,slab,W,0.5\nb.tif,slab,C,1\n\"c.tif\", slab, W, 0.5\r\n", "list.csv");
    CHECK(list.checker == "checker.tif");
    CHECK(list.sheet == "sheet.tif");
    CHECK(list.paper == "paper.tif");
    REQUIRE(list.slabs.size() == 3);
    CHECK(list.slabs[1].file == "c.tif");
    CHECK(list.slabs[1].thickness_mm == 0.5);
    CHECK(list.slabs[2].resin == "C");
    const BenchList back = parse_bench_list(bench_list_text(list), "again");
    REQUIRE(back.slabs.size() == 3);
    CHECK(back.slabs[1].file == "c.tif");
    CHECK(back.paper == "paper.tif");
}

TEST_CASE("a list is read as spreadsheets of any country write it", "[edge]") {
    const std::string text =
        "sep=;\r\nfile;shows;resin;thickness_mm;\r\nchecker.tif;checker;;;\r\nsheet.tif;sheet\r\na.tif;slab;W;0,5;\r\n;"
        ";;;\r\n";
    const BenchList list = parse_bench_list(text, "list.csv");
    REQUIRE(list.slabs.size() == 1);
    CHECK(list.slabs[0].thickness_mm == 0.5);
    const io::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "photos");
    std::string bytes = "\xFF\xFE";
    for (const char c :
         "file\tshows\tresin\tthickness_mm\nchecker.tif\tchecker\t\t\nsheet.tif\tsheet\t\t\nphotos\\a.tif\tslab\tW\t0."
         "5\n")
        if (c != '\0') bytes += {c, '\0'};
    for (const auto& [name, content] : {std::pair("photos/a.tif", std::string()), std::pair("list.txt", bytes)})
        std::ofstream(folder.path() / name, std::ios::binary) << content;
    CHECK(read_bench_list(folder.path() / "list.txt").slabs.at(0).file == (folder.path() / "photos/a.tif").string());
}

TEST_CASE("a list that cannot be read is refused by line", "[edge]") {
    refuse("", "no header line");
    refuse("photo,what\n", "expected the header");
    refuse(head + "sheet.tif,sheet\na.tif,slab,W,1\n", "no line shows \"checker\"");
    refuse(head + "c.tif,checker\na.tif,slab,W,1\n", "no line shows \"sheet\"");
    refuse(head + light, "no line shows \"slab\"");
    refuse(head + light + "more.tif,sheet\n", "line 5: a second photograph");
    refuse(head + light + "a.tif,slab,W\n", "line 5, column 4 (\"thickness_mm\"): \"\" is no number");
    refuse(head + light + "a.tif,slab,W,half\n", "\"half\" is no number");
    refuse(head + light + "a.tif,slab,W,50\n", "from 0.05 to 10");
    refuse(head + light + "a.tif,slab,,1\n", "the resin");
    refuse(head + light + "a.tif,lamp,,\n", "\"lamp\"; expected checker, paper, sheet or slab");
    refuse(head + light + "a.tif,paper,W,1\n", "belong to a slab");
    refuse(head + light + "a.tif,slab,W,1\na.tif,slab,C,1\n", "listed twice");
    refuse(head + light + ",slab,W,1\n", "no file");
    const std::string whole = head + light + "a.tif,slab,W,1\nb.tif,slab,C,1\n";
    for (std::size_t size = 0; size < whole.size(); ++size) {
        try {
            static_cast<void>(parse_bench_list(whole.substr(0, size), "cut.csv"));
        } catch (const InputError&) {
        }
    }
}
