// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_csv.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "optics/colour/channels.h"
#include "optics/colour/colour.h"
#include "tests/calibration/patches/chart_samples.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

// What the eye sees of a patch, under the illuminant of its channels.
Eigen::Vector3d lab_of(const PatchTable& table, std::size_t patch) {
    const Eigen::Vector3d white = optics::colorimetric_white(table.channels.illuminant);
    const auto& rho = table.patches[patch].rho;
    return optics::lab_from_xyz({rho[0] * white[0], rho[1] * white[1], rho[2] * white[2]}, white);
}

const std::string with_lab = "W,C,M,Y,K,L,a,b\n";

}  // namespace

TEST_CASE("A chart of mixtures is read from shares and Lab") {
    const PatchTable table = parsed("# a chart\n" + with_lab + "0.9,0.1,0,0,0,70,-20,-15\n1,0,0,0,0,92,-1,3\n");
    CHECK(table.is_chart);
    CHECK(table.channels == optics::colorimetric_channels(optics::Illuminant::d50));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    CHECK(table.patches[1].top == PatchMixture{{"W", 1}});
    CHECK(table.patches[0].thickness_mm == 0);
    CHECK(table.patches[0].backing.empty());
    CHECK(table.patches[0].where == "chart: line 3");
    CHECK((lab_of(table, 0) - Eigen::Vector3d(70, -20, -15)).norm() < 1e-9);
    // Y/Yn of L* = 70 by CIE 15: ((70 + 16) / 116)^3.
    CHECK(table.patches[0].rho[1] == Approx(std::pow(86.0 / 116, 3)).epsilon(1e-12));
    REQUIRE(table.notes.size() == 1);
    CHECK_THAT(table.notes[0], Contains("D50, 2 degree") && Contains("--illuminant"));
}

TEST_CASE("The illuminant of a chart is the user's word, the file's, or D50") {
    const std::string rows = with_lab + "1,0,0,0,0,92,-1,3\n";
    CHECK(parsed(rows, optics::Illuminant::d65).channels.illuminant == optics::Illuminant::d65);
    CHECK(parsed(rows, optics::Illuminant::d65).notes.empty());
    const PatchTable named = parsed("# illuminant: A\n# observer: 2 degree\n" + rows);
    CHECK(named.channels.illuminant == optics::Illuminant::a);
    CHECK(named.notes.empty());
    const PatchTable both = parsed("# illuminant: A\n" + rows, optics::Illuminant::d50);
    CHECK(both.channels.illuminant == optics::Illuminant::d50);
    REQUIRE(both.notes.size() == 1);
    CHECK_THAT(both.notes[0], Contains("\"A\"") && Contains("D50"));
    CHECK_THAT(chart_fault("# illuminant: F11\n" + rows), Contains("\"F11\"") && Contains("D50, D65 and A"));
    CHECK_THAT(chart_fault("# observer: 10\n" + rows), Contains("10 degree") && Contains("spectra"));
}

TEST_CASE("Shares are fractions or percent, and sum to 1 exactly afterwards") {
    const PatchTable percent = parsed("C,W,L,a,b\n33.3,66.6,50,-10,-10\n0,100,90,0,0\n");
    CHECK(percent.patches[0].top[0].fraction == Approx(33.3 / 99.9).epsilon(1e-15));
    CHECK(percent.patches[0].top[0].fraction + percent.patches[0].top[1].fraction == 1);
    CHECK_THAT(chart_fault("C,W,L,a,b\n0.1,0.9,50,0,0\n0.1,0.8,50,0,0\n"),
               Contains("line 3") && Contains("sum to 0.9 (C 0.1, W 0.8)") && Contains("0.2 %"));
    CHECK_THAT(chart_fault("C,W,L,a,b\n10,90,50,0,0\n10,90.3,50,0,0\n"), Contains("line 3") && Contains("100.3"));
    CHECK_THAT(chart_fault("C,W,L,a,b\n-0.1,1.1,50,0,0\n"), Contains("share of C is -0.1"));
    CHECK_THAT(chart_fault("C,M,Y,K,L,a,b\n0.1,0,0,0,50,0,0\n"), Contains("W for the white"));
}

TEST_CASE("A chart takes XYZ on either scale, linear R, G, B and spectra in shares or percent") {
    const auto xyz = parsed("W,Y,X,Y,Z\n0.5,0.5,0.48,0.5,0.2\n1,0,0.8,0.83,0.7\n", optics::Illuminant::d65);
    CHECK(xyz.patches[0].top == PatchMixture{{"W", 0.5}, {"Y", 0.5}});
    CHECK(xyz.patches[0].rho[1] == 0.5);
    CHECK(xyz.patches[0].rho[0] == Approx(0.48 / optics::d65_white().x()));
    const auto hundred = parsed("W,Y,XYZ_X,XYZ_Y,XYZ_Z\n50,50,48,50,1.5\n", optics::Illuminant::d65);
    CHECK(hundred.patches[0].rho[1] == Approx(0.5));
    CHECK(hundred.patches[0].rho[2] == Approx(0.015 / optics::d65_white().z()));

    const auto rgb = parsed("W,K,R,G,B\n0.5,0.5,0.2,0.21,-0.03\n");
    CHECK(rgb.channels.is_rgb());
    CHECK(rgb.patches[0].rho == std::vector<double>{0.2, 0.21, -0.03});

    const auto spectra = parsed("W,K,700,420,500 nm\n1,0,0.9,0.8,0.85\n");
    CHECK(spectra.channels.wavelengths_nm == std::vector<double>{420, 500, 700});
    CHECK(spectra.patches[0].rho == std::vector<double>{0.8, 0.85, 0.9});
    CHECK(spectra.notes.empty());
    const auto percent = parsed("W,K,400,700\n1,0,80,90\n0,1,1.9,1.8\n");
    CHECK(percent.patches[1].rho[0] == Approx(0.019));
    REQUIRE(percent.notes.size() == 1);
    CHECK_THAT(percent.notes[0], Contains("percent"));
    // Beside a spectrum R, G and B are resins, and Lab is not needed.
    CHECK(parsed("W,R,G,B,400,700,L,a,b\n0.4,0.2,0.2,0.2,0.3,0.3,1,2,3\n").patches[0].top.size() == 4);
}

TEST_CASE("Standard errors of a chart go with its values") {
    const auto lab = parsed("W,L,a,b,L_se,a_se,b_se\n1,60,10,-20,0.5,0.3,0.4\n");
    // Against a difference quotient of the curve.
    const auto rho = [&](double l, double a, double b) {
        const Eigen::Vector3d white = optics::d50_white();
        return Eigen::Vector3d(optics::xyz_from_lab({l, a, b}, white).cwiseQuotient(white));
    };
    const Eigen::Vector3d by_l = (rho(60.01, 10, -20) - rho(59.99, 10, -20)) / 0.02;
    const Eigen::Vector3d by_a = (rho(60, 10.01, -20) - rho(60, 9.99, -20)) / 0.02;
    const Eigen::Vector3d by_b = (rho(60, 10, -19.99) - rho(60, 10, -20.01)) / 0.02;
    for (Eigen::Index c = 0; c < 3; ++c)
        CHECK(lab.patches[0].error[static_cast<std::size_t>(c)] ==
              Approx(std::hypot(by_l[c] * 0.5, by_a[c] * 0.3, by_b[c] * 0.4)).epsilon(1e-5));
    CHECK(parsed("W,400,700,700_se,400_se\n1,80,90,2,1\n").patches[0].error == std::vector<double>{0.01, 0.02});
    CHECK_THAT(chart_fault("W,L,a,b,L_se\n1,60,0,0,1\n"), Contains("1 of 3"));
    CHECK_THAT(chart_fault("W,L,a,b,L_se,a_se,b_se\n1,60,10,-20,0,1,1\n"), Contains("standard error"));
}

TEST_CASE("Thickness, backing and base of a chart are read where they are known") {
    const auto table = parsed("W,T,thickness_mm,backing,base_mm,L,a,b\n0.1,0.9,0.5,K,3,50,0,0\n1,0,,,,92,0,0\n");
    CHECK(table.patches[0].thickness_mm == 0.5);
    CHECK(table.patches[0].backing == "K");
    CHECK(table.patches[0].base_mm == 3);
    CHECK(table.patches[1].thickness_mm == 0);
    CHECK_THAT(chart_fault("W,thickness_mm,L,a,b\n1,0.5,50,0,0\n"), Contains("0.5 mm") && Contains("backing"));
    CHECK_THAT(chart_fault("W,thickness_mm,backing,L,a,b\n1,-1,K,50,0,0\n"), Contains("thickness_mm is -1"));
    CHECK_THAT(chart_fault("W,thickness_mm,backing,L,a,b\n1,1,K+W,50,0,0\n"), Contains("K+W"));
    const auto thick = parsed("W,backing,L,a,b\n1,K,50,0,0\n", optics::Illuminant::d50);
    CHECK(thick.patches[0].backing.empty());
    CHECK_THAT(thick.notes.at(0), Contains("taken as thick"));
}

TEST_CASE("Tables of spreadsheets are read: CRLF, CR, byte order mark, semicolons, decimal commas, quotes") {
    const std::string plain = "name,W,C,L,a,b\n\"A, 1\",0.9,0.1,70,-20.5,-15\n";
    const auto expected = parsed(plain);
    const auto same = [&](const std::string& text) {
        INFO(text);
        const auto table = parsed(text);
        REQUIRE(table.patches.size() == 1);
        CHECK(table.patches[0].top == expected.patches[0].top);
        CHECK(table.patches[0].rho == expected.patches[0].rho);
    };
    same("\xEF\xBB\xBF" + plain);
    same("name,W,C,L,a,b\r\nA1,0.9,0.1,70,-20.5,-15\r\n,,,,,\r\n");
    same("name,W,C,L,a,b\rA1,0.9,0.1,70,-20.5,-15");
    same("name;W;C;L;a;b\nA1;0,9;0,1;70;-20,5;-15\n");
    same("SAMPLE_ID\tW\tC\tLAB_L\tLAB_A\tLAB_B\n1\t0,9\t0,1\t70\t-20,5\t-15\n");
    std::string utf16 = "\xFF\xFE";
    for (const char c : plain) utf16 += {c, '\0'};
    same(utf16);
    same("sep=;\r\nname;W;C;L;a;b;\r\nA1;0,9;0,1;70;-20,5;-15;\r\n");
    same("name,W,C,L,a,b\n\"5\"\" proof\",90%,10 %,70,-20.5,-15\n,,,,,\n");
    same("name,W,C,L,a,b\n5\" proof,90,10,70,-20.5,-15\n");
}

TEST_CASE("A faulty chart names line, column and what is wrong") {
    CHECK_THAT(chart_fault("W,C\n1,0\n"), Contains("line 1") && Contains("nothing is measured"));
    CHECK_THAT(chart_fault("W,L,a\n1,50,0\n"), Contains("of L, a and b one is missing"));
    CHECK_THAT(chart_fault("W,X,Z,Y\n1,0.5,0.5,0\n"), Contains("luminance or yellow"));
    CHECK_THAT(chart_fault("L,a,b\n50,0,0\n"), Contains("no column has the share"));
    CHECK_THAT(chart_fault("RGB_R,RGB_G,RGB_B,LAB_L,LAB_A,LAB_B\n1,2,3,50,0,0\n"), Contains("RGB of a device"));
    CHECK_THAT(chart_fault("W,W,L,a,b\n1,0,50,0,0\n"), Contains("\"W\"") && Contains("two columns"));
    CHECK_THAT(chart_fault("W,L,a,b,LAB_L\n1,50,0,0,50\n"), Contains("twice"));
    CHECK_THAT(chart_fault("W,400,400,700\n1,0,0,0\n"), Contains("400 nm is there twice"));
    CHECK_THAT(chart_fault("W,40,700\n1,0,0\n"), Contains("wavelength of 40 nm"));
    CHECK_THAT(chart_fault("W,thicknes_mm,L,a,b\n1,1,50,0,0\n"), Contains("did you mean 'thickness_mm'"));
    CHECK_THAT(chart_fault("W,top,L,a,b\n1,C,50,0,0\n"), Contains("top"));
    CHECK_THAT(chart_fault("W:C,L,a,b\n1,50,0,0\n"), Contains("share of a resin") && Contains("\"W:C\""));
    CHECK_THAT(chart_fault(with_lab), Contains("no patch"));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,50,0,0\n"), Contains("line 2") && Contains("7 cells"));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,50,x,0\n"), Contains("\"a\"") && Contains("\"x\""));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,50,,0\n"), Contains("is empty"));
    CHECK_THAT(chart_fault("W,K,L,a,b\n1,me,50,0,0\n"), Contains("\"me\"") && Contains("share of a resin"));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,111,0,0\n"), Contains("line 2") && Contains("L is 111"));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,-1.5,0,0\n"), Contains("L is -1.5"));
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,90,200,0\n"), Contains("X/Xn") && Contains("1.5"));
    CHECK_THAT(chart_fault("W,400,700\n1,0.5,-0.2\n"), Contains("700 nm") && Contains("-0.2"));
    CHECK_THAT(chart_fault("W,430,700\n1,0.5,0.5\n"), Contains("430 to 700 nm") && Contains("420 to 680"));
    CHECK_THAT(chart_fault("W,400,670\n1,0.5,0.5\n"), Contains("400 to 670 nm"));
    CHECK_THAT(chart_fault("CMYK_C,CMYK_M,CMYK_Y,CMYK_K,L,a,b\n60,60,0,0,30,0,0\n"),
               Contains("sum to 120") && Contains("ink percentages"));
    CHECK_THAT(chart_fault("6CLR_1,6CLR_2,6CLR_3,6CLR_4,6CLR_5,6CLR_6,L,a,b\n1,0,0,0,0,0,30,0,0\n"),
               Contains("6 device fields") && Contains("rename"));
    CHECK_THAT(chart_fault("\x1b[2J,L,a,b\n1,50,0,0\n"), !Contains("\x1b"));
}

TEST_CASE("Resins are those that are known or named, and every other column is left aside and named") {
    CHECK(parsed("row,Black,White,Clear,VeroCyan,L,a,b\n1,0.1,0.2,0.3,0.4,50,0,0\n").patches[0].top.size() == 4);
    const std::string own = "row,Black,b2,Vio_3,L,a,b\n1,0.1,0.5,0.4,50,0,0\n";
    CHECK_THAT(chart_fault(own), Contains("sum to 0.1") && Contains("\"b2\", \"Vio_3\"") && Contains("--resins"));
    CHECK(parsed_with(own, {"b2", "Vio_3"}).patches[0].top.size() == 3);
    CHECK(parsed("# resins: Black,b2,Vio_3\n" + own).patches[0].top.size() == 3);
    CHECK(parsed("Titel;;\n# Resins: Black, b2,Vio_3;;;;\nBlack;b2;Vio_3;L;a;b\n0,1;0,5;0,4;50;0;0\n")
              .patches[0]
              .top.size() == 3);
    CHECK(parsed("\"# resins: Black,b2,Vio_3\"\n" + own).patches[0].top.size() == 3);
    CHECK(parse_patches(own, "chart", {.known = {"b2", "Vio_3"}}).patches[0].top.size() == 3);
    // What the usual programs write beside a measurement is not worth a word.
    const PatchTable usual = parsed_with("Sample_Name,W,DE_2000,LCH_C,LAB_H,,L,a,b\nx,1,3,4,2,,50,0,0\n", {});
    CHECK(usual.patches[0].top.size() == 1);
    CHECK(usual.notes.empty());
    for (const char* name : {"TEMPERATURE", "DENSITY", "dE", "dE*00", "gloss60", "Gloss", "M_CONDITION", "OBS_NO",
                             "Notes2", "Opacity", "R2", "K/S", "x", "Delta E", "MODE"})
        for (const char* value : {"0", "0.12", "23", "", "n/a"}) {
            const PatchTable table =
                parsed_with(fmt::format("C,W,{},L,a,b\n10,90,{},50,0,0\n0,100,{},90,0,0\n", name, value, value), {});
            CAPTURE(name, value, notes_of(table));
            CHECK(table.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
            CHECK_THAT(notes_of(table), Contains(fmt::format("\"{}\"", name)) && Contains("left aside"));
        }
}

TEST_CASE("Lab and XYZ are read under the names that instruments give them") {
    const auto rho_of = [](const std::string& names) {
        const PatchTable table = parsed_with("C,W," + names + "\n10,90,70,-20,-15\n", {});
        CHECK(table.patches[0].top.size() == 2);
        return table.patches[0].rho;
    };
    const auto lab = rho_of("L,a,b");
    for (const char* names : {"L*,a*,b*", "CIE L,CIE a,CIE b", "CIE L*,CIE a*,CIE b*", "LAB L,LAB A,LAB B",
                              "LAB_L,LAB_A,LAB_B", "CIELAB_L,CIELAB_a,CIELAB_b", "L*(D50),a*(D50),b*(D50)",
                              "L*(2\xC2\xB0/D50),a*(2\xC2\xB0/D50),b*(2\xC2\xB0/D50)", "L* SCI,a* SCI,b* SCI",
                              "M1 L*,M1 a*,M1 b*", "L,A,B", "l,a,b", "Lab_L_D50,Lab_a_D50,Lab_b_D50"}) {
        CAPTURE(names);
        CHECK(rho_of(names) == lab);
    }
    const auto xyz = [&](const std::string& names) {
        return parsed_with("C,W," + names + "\n10,90,40,45,30\n", {}).patches[0].rho;
    };
    for (const char* names : {"XYZ_X,XYZ_Y,XYZ_Z", "CIE X,CIE Y,CIE Z", "X(D50),Y(D50),Z(D50)", "XYZ X,XYZ Y,XYZ Z"})
        CHECK(xyz(names) == xyz("X,Y,Z"));
    CHECK(parsed_with("c,m,y,k,w,l,a,b\n10,0,0,0,90,70,-20,-15\n", {}).patches[0].top ==
          PatchMixture{{"C", 0.1}, {"W", 0.9}});
    // A name may tell the illuminant and the observer.
    CHECK(parsed("W,L*(D65),a*(D65),b*(D65)\n1,90,0,0\n").channels.illuminant == optics::Illuminant::d65);
    CHECK_THAT(chart_fault("W,L*(10\xC2\xB0/D65),a*(10\xC2\xB0/D65),b*(10\xC2\xB0/D65)\n1,90,0,0\n"),
               Contains("10 degree"));
    CHECK_THAT(chart_fault("W,L*(F11),a*(F11),b*(F11)\n1,90,0,0\n"), Contains("F11"));
    CHECK_THAT(chart_fault("W,Lstar,astar,bstar\n1,90,0,0\n"),
               Contains("nothing is measured") && Contains("\"Lstar\", \"astar\", \"bstar\""));
}

TEST_CASE("Of several ways to measure one is taken, and said") {
    const std::string both = "W,L*(SCI),a*(SCI),b*(SCI),L*(SCE),a*(SCE),b*(SCE)\n1,86,1,2,84,1,2\n";
    const PatchTable table = parsed_with(both, {});
    CHECK(lab_of(table, 0).x() == Approx(86));
    CHECK_THAT(notes_of(table), Contains("2 ways") && Contains("SCI"));
    // One that is whole goes before one that is not, and 2 degree before 10.
    CHECK(lab_of(parsed_with("W,L*(SCI),L*(SCE),a*(SCE),b*(SCE)\n1,86,84,1,2\n", {}), 0).x() == Approx(84));
    CHECK(lab_of(parsed_with("W,L*(10/D50),a*(10/D50),b*(10/D50),L*(2/D50),a*(2/D50),b*(2/D50)\n1,86,1,2,84,1,2\n", {}),
                 0)
              .x() == Approx(84));
    std::string names = "W", values = "1";
    for (const char* way : {" SCE", " SCI"})
        for (int nm = 400; nm <= 700; nm += 50) {
            names += fmt::format(",R{} nm{}", nm, way);
            values += way == std::string(" SCE") ? ",0.5" : ",0.54";
        }
    const PatchTable spectra = parsed_with(names + "\n" + values + "\n", {});
    CHECK(spectra.patches[0].rho == std::vector<double>(7, 0.5));
    CHECK_THAT(notes_of(spectra), Contains("spectra") && Contains("SCE"));
    // Spectra beside Lab, as SpectraMagic writes them.
    CHECK(parsed_with("W,L*(D50),a*(D50),b*(D50),400 nm,700 nm\n1,90,-46,0,0.5,0.6\n", {}).patches[0].rho ==
          std::vector<double>{0.5, 0.6});
    CHECK_THAT(notes_of(parsed_with("W,M3 L*,M3 a*,M3 b*\n1,86,1,2\n", {})), Contains("polarising"));
}

TEST_CASE("Titles above the header of a chart are left aside, said") {
    const PatchTable table =
        parsed("Measured 2026-11-02, CM-700d, SCI\n\nC;W;L;a;b\n0,1;0,9;70;-20;-15\n", optics::Illuminant::d50);
    REQUIRE(table.patches.size() == 1);
    CHECK(table.patches[0].where == "chart: line 4");
    CHECK_THAT(notes_of(table), Contains("line 3: what stands above the header"));
    // A header that is none is told, and no row is taken for one.
    CHECK_THAT(chart_fault("W,C,L,a\n0.9,0.1,450,550\n0.9,0.1,450,550\n"),
               Contains("line 1") && Contains("one is missing"));
}

TEST_CASE("Values out of range stay as they are and are counted") {
    const auto table = parsed("W,400,700\n1,-0.02,1.2\n1,0,1.19\n", optics::Illuminant::d50);
    CHECK(table.patches[0].rho == std::vector<double>{-0.02, 1.2});
    REQUIRE(table.notes.size() == 1);
    CHECK_THAT(table.notes[0], Contains("2 of 2 patches"));
}

TEST_CASE("Repeats of a mixture are rows of their own unless they contradict each other") {
    const auto table = parsed(with_lab + "1,0,0,0,0,90,0,0\n0.5,0.5,0,0,0,60,-20,-20\n1,0,0,0,0,93,0,0\n");
    CHECK(table.patches.size() == 3);
    CHECK(repeat_groups(table) == std::vector<std::size_t>{0, 1, 0});
    // L* 60 and 54: by CIEDE2000 (a = b = 0) 6 / S_L with S_L = 1 + 0.015 49 / sqrt(69) = 1.0885, so 5.5.
    CHECK_THAT(chart_fault(with_lab + "1,0,0,0,0,60,0,0\n0,0,0,0,1,5,0,0\n1,0,0,0,0,54,0,0\n"),
               Contains("line 4") && Contains("line 2") && Contains("5.5 CIEDE2000"));
    CHECK_NOTHROW(parsed(with_lab + "1,0,0,0,0,60,0,0\n1,0,0,0,0,55,0,0\n"));
    // Of more than two the median says which is wrong.
    const std::string many = with_lab + "1,0,0,0,0,60,0,0\n1,0,0,0,0,58,0,0\n1,0,0,0,0,57.5,0,0\n";
    CHECK_NOTHROW(parsed(many + "1,0,0,0,0,54,0,0\n"));
    CHECK_THAT(chart_fault(many + "1,0,0,0,0,50,0,0\n"),
               Contains("line 5") && Contains("measured 4 times") && Contains("line 3") && Contains("median"));
    CHECK_NOTHROW(parsed("W,thickness_mm,backing,L,a,b\n1,1,K,90,0,0\n1,1,W,60,0,0\n1,2,K,30,0,0\n"));
}

TEST_CASE("A chart written and read again is the same") {
    const auto same = [](const PatchTable& table) {
        const std::string text = patch_table_text(table, "a chart\nof two lines");
        INFO(text);
        const PatchTable again = parsed(text);
        CHECK(again.is_chart);
        CHECK(again.channels == table.channels);
        REQUIRE(again.patches.size() == table.patches.size());
        for (std::size_t p = 0; p < table.patches.size(); ++p) {
            const Patch &a = again.patches[p], &b = table.patches[p];
            CHECK(a.thickness_mm == b.thickness_mm);
            CHECK(a.backing == b.backing);
            CHECK(a.base_mm == b.base_mm);
            REQUIRE(a.top.size() == b.top.size());
            for (std::size_t k = 0; k < b.top.size(); ++k) {
                CHECK(a.top[k].role == b.top[k].role);
                CHECK(a.top[k].fraction == Approx(b.top[k].fraction).epsilon(1e-14));
            }
            for (std::size_t c = 0; c < b.rho.size(); ++c) CHECK(std::abs(a.rho[c] - b.rho[c]) < 1e-13);
            REQUIRE(a.error.size() == b.error.size());
            for (std::size_t c = 0; c < b.error.size(); ++c) CHECK(std::abs(a.error[c] - b.error[c]) < 1e-13);
        }
    };
    same(parsed_with("Vio,b2,W,L,a,b\n0.5,0.3,0.2,80,-5,90\n", {"Vio", "b2"}));
    same(parsed("Y,W,L,a,b\n0.3333,0.6667,80,-5,90\n0,1,92,0,3\n", optics::Illuminant::d65));
    same(parsed("W,L,a,b,L_se,a_se,b_se\n1,60,10,-20,0.5,0.3,0.4\n", optics::Illuminant::a));
    same(parsed("W,K,thickness_mm,backing,base_mm,400,500.5,700\n0.5,0.5,1,K,4,-0.01,0.3,1.02\n1,0,0,,,0.5,0.6,0.7\n"));
    same(parsed("W,K,R,G,B,R_se,G_se,B_se\n0.25,0.75,0.1,0.2,-0.05,0.01,0.01,0.01\n"));
}

TEST_CASE("A target may be measured as Lab or XYZ") {
    const auto lab = parsed("# illuminant: D65\ntop,backing,thickness_mm,L,a,b\nC:10+W:90,K,0.5,70,-20,-15\n");
    CHECK_FALSE(lab.is_chart);
    CHECK(lab.channels == optics::colorimetric_channels(optics::Illuminant::d65));
    CHECK(lab.patches[0].rho[1] == Approx(std::pow(86.0 / 116, 3)));
    CHECK(lab.notes.empty());
    const auto xyz = parsed("top,backing,thickness_mm,X,Y,Z\nW,K,0.5,70,75,60\nW,W,0.5,80,85,70\n");
    CHECK(xyz.patches[0].rho[1] == Approx(0.75));
    CHECK(xyz.notes.size() == 1);
    const PatchTable again = parsed(patch_table_text(lab));
    CHECK(again.channels == lab.channels);
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(again.patches[0].rho[c] - lab.patches[0].rho[c]) < 1e-13);
    CHECK_THAT(chart_fault("top,backing,thickness_mm,L,a,b,R\n"), Contains("one kind"));
    CHECK_THAT(chart_fault("top,backing,thickness_mm,L,a,b\nW,K,1,60,0,0\nW,K,1,61,0,0\n"),
               Contains("measured already") && Contains("L 60 there and 61 here"));
}

TEST_CASE("No cut or damaged chart does more than throw an InputError") {
    const std::string text = "# c\nname,W,C,thickness_mm,backing,L,a,b\n\"A\",0.9,0.1,1,K,70,-20,-15\n";
    for_each_cut(text, [](const std::string& cut) {
        try {
            (void)parsed(cut);
        } catch (const InputError&) {
        }
    });
    survive_damage(text);
    std::string suffixes = "W,X";
    for (int k = 0; k < 100000; ++k) suffixes += "_se";
    CHECK(parsed(suffixes + ",L,a,b\n1,0,50,2,3\n").patches.size() == 1);
    CHECK_THROWS_AS(parsed(std::string(1 << 20, ';')), InputError);
}

TEST_CASE("The mixtures of a real printer are read as a chart") {
    const auto file = std::filesystem::path(source_dir()) / "../shared/prints/j750-mixtures.csv";
    if (!std::filesystem::exists(file)) return skip("the measured prints are not beside the tree");
    const PatchTable table = read_patches(file);
    CHECK(table.is_chart);
    CHECK(table.patches.size() == 1169);
    const auto groups = repeat_groups(table);
    CHECK(std::set<std::size_t>(groups.begin(), groups.end()).size() == 1136);
}
