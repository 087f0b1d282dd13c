// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_file.h"

#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

PatchTable parsed(const std::string& text) { return parse_patches(text, "p.csv"); }

// The message of the error that the text must cause.
std::string fault(const std::string& text) {
    try {
        (void)parsed(text);
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("accepted: " << text);
    return {};
}

const std::string header = "top,backing,thickness_mm,R,G,B\n";

}  // namespace

TEST_CASE("Patches are read with comments, mixtures, wavelengths, errors and base thickness") {
    const PatchTable rgb = parsed("\xEF\xBB\xBF# target 7\r\n" + header +
                                  "C:10+W:90,K,0.675,0.1,0.2,0.3\r\n\n  W , W ,0.675, 0.8,0.9,+0.7\n");
    CHECK(rgb.channels.is_rgb());
    REQUIRE(rgb.patches.size() == 2);
    CHECK(rgb.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    CHECK(rgb.patches[0].backing == "K");
    CHECK(rgb.patches[0].rho == std::vector<double>{0.1, 0.2, 0.3});
    CHECK(rgb.patches[0].base_mm == 0);
    CHECK(rgb.patches[0].error.empty());
    CHECK(rgb.patches[0].where == "p.csv: line 3");
    CHECK(rgb.patches[1].top == PatchMixture{{"W", 1}});

    const PatchTable spectral =
        parsed("top,backing,thickness_mm,400_se,base_mm,400,425.5,425.5_se\nW,K,1,0.01,5,0.3,0.4,0.02\n");
    CHECK(spectral.channels.wavelengths_nm == std::vector<double>{400, 425.5});
    CHECK(spectral.patches[0].base_mm == 5);
    CHECK(spectral.patches[0].error == std::vector<double>{0.01, 0.02});
    CHECK(spectral.patches[0].rho == std::vector<double>{0.3, 0.4});
}

TEST_CASE("Targets are read as spreadsheets of any country write them") {
    const PatchTable expected = parsed(header + "C:10+W:90,K,0.675,0.1,0.2,0.3\n");
    std::string utf16 = "\xFF\xFE";
    for (const char c : "top\tbacking\tthickness_mm\tR\tG\tB\r\nC:10+W:90\tK\t0,675\t0,1\t0,2\t0,3\r\n")
        if (c != '\0') utf16 += {c, '\0'};
    for (const std::string& text :
         {std::string("top;backing;thickness_mm;R;G;B\nC:10+W:90;K;0,675;0,1;0,2;0,3\n"),
          std::string("sep=;\r\ntop;backing;thickness_mm;R;G;B;\r\nC:10+W:90;K;0,675;0,1;0,2;0,3;\r\n;;;;;;\r\n"),
          std::string("Bench 7\n\ntop\tbacking\tthickness_mm\tR\tG\tB\rC:10+W:90\tK\t0.675\t0.1\t0.2\t0.3\r"), utf16}) {
        CAPTURE(text);
        const PatchTable table = parsed(text);
        REQUIRE(table.patches.size() == 1);
        CHECK(table.patches[0].top == expected.patches[0].top);
        CHECK(table.patches[0].thickness_mm == 0.675);
        CHECK(table.patches[0].rho == expected.patches[0].rho);
    }
}

TEST_CASE("A table of patches written and read again is the same") {
    PatchTable table;
    table.channels.wavelengths_nm = {400, 405.25};
    table.patches = {{{{"C", 0.05}, {"W", 0.95}}, "K", 0.675, 5, {0.1234567890123, 1.0 / 3}, {0.001, 0.002}, {}},
                     {{{"Y", 1}}, "W", 0.25, 0, {-0.001, 1}, {0.005, 0.004}, {}}};
    const PatchTable again = parsed(patch_table_text(table, "first\nsecond"));
    CHECK(again.channels == table.channels);
    REQUIRE(again.patches.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(mixture_text(again.patches[k].top) == mixture_text(table.patches[k].top));
        CHECK(again.patches[k].backing == table.patches[k].backing);
        CHECK(again.patches[k].thickness_mm == table.patches[k].thickness_mm);
        CHECK(again.patches[k].base_mm == table.patches[k].base_mm);
        CHECK(again.patches[k].rho == table.patches[k].rho);
        CHECK(again.patches[k].error == table.patches[k].error);
    }
}

TEST_CASE("Tables in wide channels are written and read again, and not mixed with others") {
    PatchTable table;
    table.channels = optics::wide_channels();
    table.patches = {{{{"C", 1}}, "K", 0.675, 5, {0.05, 0.2, 0.7}, {0.001, 0.002, 0.001}, {}}};
    const std::string text = patch_table_text(table);
    CHECK_THAT(text, Contains("wR,wG,wB,base_mm,wR_se"));
    const PatchTable again = parsed(text);
    CHECK(again.channels == optics::wide_channels());
    CHECK(again.patches[0].rho == table.patches[0].rho);
    CHECK(again.patches[0].error == table.patches[0].error);
    CHECK_THROWS_WITH(parsed("top,backing,thickness_mm,wR,G,wB\nC,K,0.6,0.1,0.1,0.1\n"),
                      Contains("three channels of one kind"));
}

TEST_CASE("Values relative to a white reference become relative to a perfect diffuser") {
    PatchTable table = parsed("top,backing,thickness_mm,450,550,450_se,550_se\nW,W,1,0.8,1,0.01,0.02\n");
    apply_white_reference(table, 0.99);
    CHECK(table.patches[0].rho[0] == Approx(0.792));
    CHECK(table.patches[0].rho[1] == Approx(0.99));
    CHECK(table.patches[0].error[1] == Approx(0.0198));
    CHECK_THROWS_AS(apply_white_reference(table, 99), InputError);
    CHECK_THROWS_AS(apply_white_reference(table, 0), InputError);
}

TEST_CASE("Mixtures are percentages of roles that sum to 100, in one order") {
    CHECK(parse_mixture("W:90+C:10") == parse_mixture("C:10+W:90"));
    CHECK(mixture_text(parse_mixture(" W:90 + C:10 ")) == "C:10+W:90");
    CHECK(mixture_text(parse_mixture("C:33.333333+M:33.333333+Y:33.333334")) == "C:33.3333+M:33.3333+Y:33.3333");
    CHECK(mixture_text(parse_mixture("Clear")) == "Clear");
    for (const char* wrong : {"", "C:10", "C:10+W:80", "C+W", "C:x+W:90", "C:0+W:100", "C:-10+W:110", "C:50+C:50",
                              "C:10+", "C:10+W:90+", "C:nan+W:90", "C:10:90", ":10+W:90"}) {
        INFO(wrong);
        CHECK_THROWS_AS(parse_mixture(wrong), InputError);
    }
}

TEST_CASE("A faulty table names line, patch and what is wrong") {
    CHECK_THAT(fault(""), Contains("p.csv") && Contains("no header"));
    CHECK_THAT(fault(header), Contains("no patches"));
    CHECK_THAT(fault("top;backing;thickness_mm;R;G;B\n"), Contains("no patches"));
    CHECK_THAT(fault("top,thickness_mm,R,G,B\n"), Contains("column 2") && Contains("backing"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G\n"), Contains("line 1") && Contains("missing"));
    CHECK_THAT(fault("top,backing,thickness_mm\n"), Contains("no channel"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,r_s\n"), Contains("r_s"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,R_se\n"), Contains("1 of 3"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,450\n"), Contains("wavelengths in one table"));
    CHECK_THAT(fault("top,backing,thickness_mm,425,400\n"), Contains("must rise"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,R\n"), Contains("twice"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,0.2\n"), Contains("line 2") && Contains("5 cells"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,0.2,x\n"), Contains("line 2, column 6 (\"B\"): \"x\" is no number"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,nan,0.2\n"), Contains("no number"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,1e999,0.2\n"), Contains("no number"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,-0.01,0.2\n"),
               Contains("C on W") && Contains("G is -0.01") && Contains("negative"));
    CHECK_THAT(fault(header + "C,W,0.675,0.1,0.2,12\n"), Contains("B is 12") && Contains("above 1"));
    CHECK_THAT(fault(header + "C,W,0,0.1,0.2,0.3\n"), Contains("thickness_mm is 0"));
    CHECK_THAT(fault(header + "C:20+W:90,W,1,0.1,0.2,0.3\n"), Contains("line 2") && Contains("sum to 110"));
    CHECK_THAT(fault(header + "C,,1,0.1,0.2,0.3\n"), Contains("role"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,R_se,G_se,B_se\nC,W,1,0,0,0,0.1,0,0.1\n"),
               Contains("standard error of G"));
    CHECK_THAT(fault("top,backing,thickness_mm,R,G,B,R_se,G_se,B_se\nC,W,1,0,-0.031,0,0.1,0.005,0.1\n"),
               Contains("negative"));
    // No control character of a file reaches the terminal.
    CHECK_THAT(fault(header + "C,W,\x1b[2J,0.1,0.2,0.3\n"), !Contains("\x1b"));
}

TEST_CASE("A patch measured twice is refused unless the rows agree") {
    const std::string row = "C:10+W:90,W,0.675,0.1,0.2,0.3\n";
    CHECK(parsed(header + row + row).patches.size() == 1);
    CHECK(parsed(header + row + "C:10+W:90,W,0.5,0.1,0.2,0.4\n").patches.size() == 2);
    CHECK_THAT(fault(header + row + "W:90+C:10,W,0.675,0.1,0.25,0.3\n"), Contains("line 3") && Contains("line 2") &&
                                                                             Contains("C:10+W:90 on W") &&
                                                                             Contains("G 0.2 there and 0.25 here"));
}

TEST_CASE("No cut or damaged table does more than throw an InputError") {
    const std::string text =
        "# t\ntop,backing,thickness_mm,R,G,B,R_se,G_se,B_se,base_mm\nC:10+W:90,K,0.675,0.1,0.2,0.3,0.01,0.01,0.01,5\n";
    const auto survive = [](const std::string& damaged) {
        try {
            (void)parse_patches(damaged, "p.csv");
        } catch (const InputError&) {
        }
    };
    for (std::size_t length = 0; length <= text.size(); ++length) survive(text.substr(0, length));
    for (std::size_t at = 0; at < text.size(); ++at)
        for (const char c : {'\0', '\n', ',', '"', '+', ':', '-', '9', '\xff'}) {
            std::string damaged = text;
            damaged[at] = c;
            survive(damaged);
        }
    survive(std::string(100000, ','));
    survive(header + std::string(1 << 20, ','));
    survive(header + std::string(1 << 16, '+') + ",W,1,0,0,0\n");
    CHECK_THROWS_AS(read_patches("/nowhere/patches.csv"), FileError);
}
