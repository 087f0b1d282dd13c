// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cgats_file.h"

#include "optics/colour/channels.h"
#include "tests/calibration/patches/chart_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

const std::string inks =
    "CGATS.17\n"
    "ORIGINATOR \"our own # generator\"   # a comment\n"
    "KEYWORD \"WEIGHTING_FUNCTION\"\n"
    "WEIGHTING_FUNCTION \"ILLUMINANT, D50\"\n"
    "WEIGHTING_FUNCTION \"OBSERVER, 2 degree\"\n"
    "NUMBER_OF_FIELDS 9\n"
    "BEGIN_DATA_FORMAT\n"
    "SAMPLE_ID SAMPLE_NAME CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B\n"
    "END_DATA_FORMAT\n"
    "NUMBER_OF_SETS 2\n"
    "BEGIN_DATA\n"
    "1 \"cyan one\" 20 0 5 0 71.25 -19.5 -8\n"
    "2 \"paper\" 0 0 0 0 92 -1 3\n"
    "END_DATA\n";

std::string of_fields(const std::string& fields, const std::string& rows, const std::string& head = "CGATS.17\n") {
    return head + "BEGIN_DATA_FORMAT\n" + fields + "\nEND_DATA_FORMAT\nBEGIN_DATA\n" + rows + "\nEND_DATA\n";
}

}  // namespace

TEST_CASE("CGATS with ink percentages is a chart whose rest is white") {
    const PatchTable table = parsed(inks);
    CHECK(table.is_chart);
    CHECK(table.channels == optics::colorimetric_channels(optics::Illuminant::d50));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.2}, {"W", 0.75}, {"Y", 0.05}});
    CHECK(table.patches[1].top == PatchMixture{{"W", 1}});
    CHECK(table.patches[0].rho[1] == Approx(std::pow((71.25 + 16) / 116, 3)));
    CHECK(table.patches[0].where == "chart: line 12");
    REQUIRE(table.notes.size() == 1);
    CHECK_THAT(table.notes[0], Contains("ink percentages") && Contains("white (W)"));
}

TEST_CASE("CGATS is read with every line end, tabs, decimal commas and rows over several lines") {
    const PatchTable expected = parsed(inks);
    for (const std::string& text :
         {replaced(inks, "\n", "\r\n"), replaced(inks, "\n", "\r"), "\xEF\xBB\xBF" + inks,
          replaced(inks, "71.25", "71,25"), replaced(inks, "20 0 5 0 71.25", "20\n0 5\n0 71.25"),
          replaced(inks, "\"cyan one\" 20 0 5", "\"cyan one\"\t20\t0\t5"),
          replaced(inks, "2 \"paper\" 0 0 0 0 92 -1 3", "2\t\t0\t0\t0\t0\t92\t-1\t3"), replaced(inks, "CGATS.17\n", ""),
          replaced(inks, "BEGIN_DATA\n", "BEGIN_DATA # here\n\n")}) {
        INFO(text);
        const PatchTable table = parsed(text);
        REQUIRE(table.patches.size() == 2);
        for (std::size_t p = 0; p < 2; ++p) {
            CHECK(table.patches[p].top == expected.patches[p].top);
            CHECK(table.patches[p].rho == expected.patches[p].rho);
        }
    }
}

TEST_CASE("Lines of CGATS are counted alike with every line end") {
    for (const char* end : {"\n", "\r\n", "\r"}) {
        const std::string text = replaced(inks, "\n", end);
        CAPTURE(end);
        CHECK(parsed(text).patches[0].where == "chart: line 12");
        CHECK(parsed(text).patches[1].where == "chart: line 13");
        CHECK_THAT(chart_fault(replaced(text, " 71.25 ", " x ")), Contains("line 12"));
        CHECK(parsed(replaced(inks, "CGATS.17\n", std::string("CGATS.17") + end + end + end)).patches[0].where ==
              "chart: line 14");
    }
}

TEST_CASE("CGATS names resins by role or by number, and inks beside white are shares") {
    const auto roles = parsed(of_fields("SAMPLE_ID W C LAB_L LAB_A LAB_B", "1 0.9 0.1 70 -20 -15"));
    CHECK(roles.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    const auto numbered = parsed(of_fields("4CLR_1 4CLR_2 4CLR_3 4CLR_4 LAB_L LAB_A LAB_B", "0 10 0 0 70 20 5"));
    CHECK(numbered.patches[0].top == PatchMixture{{"M", 0.1}, {"W", 0.9}});
    CHECK_THAT(numbered.notes.at(0), Contains("C, M, Y, K"));
    const auto white = parsed(of_fields("CMYK_C CMYK_M CMYK_Y CMYK_K W LAB_L LAB_A LAB_B", "10 0 0 0 90 70 -20 -15"));
    CHECK(white.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    CHECK_THAT(chart_fault(of_fields("CMYK_C CMYK_M CMYK_Y CMYK_K W LAB_L LAB_A LAB_B", "10 0 0 0 80 70 -20 -15")),
               Contains("sum to 90"));
}

TEST_CASE("Spectra of CGATS are read by all names of a wavelength, of any observer") {
    for (const char* prefix : {"SPECTRAL_NM", "SPECTRAL_NM_", "SPECTRAL_", "SPEC_", "NM_", "NM", "nm", "nm_"}) {
        std::string fields = "SAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K";
        for (int nm = 400; nm <= 700; nm += 10) fields += fmt::format(" {}{}", prefix, nm);
        fields += " LAB_L LAB_A LAB_B";
        const std::string row = "1 50 0 0 0 " + spectrum_row(400, 700, 10, 0.2, 0.5, "\t") + " 50 0 0";
        const auto table =
            parsed(of_fields(fields, row, "CGATS.17\nOBSERVER_ANGLE \"10\"\nILLUMINATION_NAME \"F2\"\n"));
        INFO(fields);
        REQUIRE(table.channels.wavelengths_nm.size() == 31);
        CHECK(table.channels.wavelengths_nm.back() == 700);
        CHECK(table.patches[0].rho.front() == 0.2);
        CHECK(table.patches[0].rho.back() == 0.5);
    }
}

TEST_CASE("Illuminant and observer of CGATS are read where programs write them") {
    const auto with = [](const std::string& head) {
        return of_fields("W LAB_L LAB_A LAB_B", "1 90 0 0", "CGATS.17\n" + head + "\n");
    };
    CHECK(parsed(with("ILLUMINATION_NAME \"D65\"")).channels.illuminant == optics::Illuminant::d65);
    CHECK(parsed(with("WEIGHTING_FUNCTION \"ILLUMINANT,A\"")).channels.illuminant == optics::Illuminant::a);
    CHECK(parsed(with("MEASUREMENT_SOURCE \"Illumination=D65 ObserverAngle=2 Filter=No\"")).channels.illuminant ==
          optics::Illuminant::d65);
    CHECK(parsed(with("MEASUREMENT_SOURCE D65")).notes.size() == 1);  // the lamp, not the illuminant of Lab
    for (const char* ten : {"OBSERVER_ANGLE \"10\"", "WEIGHTING_FUNCTION \"OBSERVER, 10 degree\"", "OBSERVER 10",
                            "MEASUREMENT_SOURCE \"Illumination=D50\tObserverAngle=10\""}) {
        INFO(ten);
        CHECK_THAT(chart_fault(with(ten)), Contains("10 degree") && Contains("spectra"));
    }
    for (const char* odd :
         {"WEIGHTING_FUNCTION \"ILLUMINANT\"", "WEIGHTING_FUNCTION \"ILLUMINANT, \"", "WEIGHTING_FUNCTION"})
        CHECK(parsed(with(odd)).channels.illuminant == optics::Illuminant::d50);
}

TEST_CASE("Of several tables in CGATS the first that can be used is taken") {
    const std::string first = of_fields("SAMPLE_ID DENSITY", "1 0.5");
    const auto table = parsed(first + of_fields("W LAB_L LAB_A LAB_B", "1 90 0 0", "") +
                              of_fields("K LAB_L LAB_A LAB_B", "1 9 0 0", ""));
    REQUIRE(table.patches.size() == 1);
    CHECK(table.patches[0].top == PatchMixture{{"W", 1}});
    CHECK_THAT(chart_fault(first), Contains("nothing is measured"));
}

TEST_CASE("Faulty CGATS is refused with a sentence") {
    CHECK_THAT(chart_fault(replaced(inks, "NUMBER_OF_FIELDS 9", "NUMBER_OF_FIELDS 10")),
               Contains("NUMBER_OF_FIELDS is 10"));
    CHECK_THAT(chart_fault(replaced(inks, "NUMBER_OF_SETS 2", "NUMBER_OF_SETS 3")),
               Contains("NUMBER_OF_SETS is 3") && Contains("2 rows"));
    CHECK_THAT(chart_fault(replaced(inks, " 92 -1 3", " 92 -1")), Contains("8 values"));
    CHECK_THAT(chart_fault(replaced(inks, " 71.25 ", " x ")), Contains("line 12") && Contains("\"x\""));
    CHECK_THAT(chart_fault(replaced(inks, "20 0 5 0", "90 0 15 0")), Contains("line 12") && Contains("sum to 105"));
    CHECK_THAT(chart_fault("CGATS.17\nBEGIN_DATA\n1\nEND_DATA\n"), Contains("BEGIN_DATA_FORMAT"));
    CHECK_THAT(chart_fault(of_fields("RGB_R RGB_G RGB_B LAB_L LAB_A LAB_B", "0 0 0 9 0 0")),
               Contains("RGB of a device"));
    CHECK_THAT(chart_fault(of_fields("5CLR_1 5CLR_2 5CLR_3 5CLR_4 5CLR_5 LAB_L LAB_A LAB_B", "0 0 0 0 0 9 0 0")),
               Contains("5 device fields"));
    CHECK_THAT(chart_fault(of_fields("SAMPLE_ID LAB_L LAB_A LAB_B", "1 9 0 0")), Contains("share of a resin"));
}

TEST_CASE("CGATS that is cut anywhere before its end is refused") {
    const std::string text = inks.substr(0, inks.size() - 1);
    for_each_cut(text, [](const std::string& cut) {
        INFO(cut);
        CHECK_THROWS_AS(parsed(cut), InputError);
    });
    survive_damage(inks);
}
