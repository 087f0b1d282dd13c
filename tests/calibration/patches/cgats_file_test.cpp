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
          replaced(inks, "1 \"cyan one\" 20 0 5 0 71.25 -19.5 -8", "1\t5\" proof\t20\t0\t5\t0\t71.25\t-19.5\t-8"),
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

TEST_CASE("A field of CGATS that is no ink is no resin, and is named") {
    for (const char* field : {"TEMPERATURE", "DENSITY", "M_CONDITION", "FILTER", "CHROMA", "DELTA_E", "OBS_NO",
                              "GLOSS_60", "LAB_DE", "OPACITY", "STATUS"})
        for (const char* value : {"0", "1.2", "23", "OK"}) {
            const auto table =
                parsed_with(of_fields(fmt::format("SAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B {}", field),
                                      fmt::format("1 50 0 0 0 60 -20 -15 {}\n2 0 0 0 0 90 0 0 {}", value, value)),
                            {});
            CAPTURE(field, value);
            CHECK(table.patches[0].top == PatchMixture{{"C", 0.5}, {"W", 0.5}});
            CHECK_THAT(notes_of(table), Contains(fmt::format("\"{}\"", field)));
        }
    const auto named =
        parsed_with(of_fields("W Vio_2 LAB_L LAB_A LAB_B", "0.9 0.1 60 20 -15\n1 0 90 0 0"), {"W", "Vio_2"});
    CHECK(named.patches[0].top == PatchMixture{{"Vio_2", 0.1}, {"W", 0.9}});
    const auto numbered =
        parsed_with(of_fields("5CLR_1 5CLR_2 5CLR_3 5CLR_4 5CLR_5 LAB_L LAB_A LAB_B", "0 0 0 0 20 60 20 -15"),
                    {"C", "M", "Y", "K", "O", "W"});
    CHECK(numbered.patches[0].top == PatchMixture{{"O", 0.2}, {"W", 0.8}});
}

TEST_CASE("What stands before the ink's name is no part of it, and bare paper is no mixture") {
    const auto mixture = [](const std::string& fields, const std::string& row) {
        return parsed_with(of_fields("SAMPLE_ID " + fields + " XYZ_X XYZ_Y XYZ_Z", "1 " + row + " 40 45 30"), {})
            .patches.at(0)
            .top;
    };
    CHECK(mixture("CMY_C CMY_M CMY_Y", "20 0 0") == PatchMixture{{"C", 0.2}, {"W", 0.8}});
    CHECK(mixture("CMYKOG_C CMYKOG_M CMYKOG_Y CMYKOG_K CMYKOG_O CMYKOG_G", "0 0 0 0 20 0") ==
          PatchMixture{{"O", 0.2}, {"W", 0.8}});
    CHECK(mixture("CMYKW_C CMYKW_M CMYKW_Y CMYKW_K CMYKW_W", "20 0 0 0 80") == PatchMixture{{"C", 0.2}, {"W", 0.8}});
    CHECK(mixture("CMYKcm_C CMYKcm_M CMYKcm_Y CMYKcm_K CMYKcm_c CMYKcm_m", "0 0 0 0 20 0") ==
          PatchMixture{{"W", 0.8}, {"c", 0.2}});
    CHECK(mixture("cmyk_c cmyk_m cmyk_y cmyk_k", "20 0 0 0") == PatchMixture{{"C", 0.2}, {"W", 0.8}});
    // By the file's word, whatever the letters.
    CHECK(parsed_with(of_fields("SAMPLE_ID KPS_K KPS_P KPS_S LAB_L LAB_A LAB_B", "1 0 20 0 70 0 0",
                                "CTI3\nCOLOR_REP \"KPS_LAB\"\n"),
                      {})
              .patches.at(0)
              .top == PatchMixture{{"P", 0.2}, {"W", 0.8}});
    const std::string white = of_fields("SAMPLE_ID CMYKW_C CMYKW_M CMYKW_Y CMYKW_K CMYKW_W XYZ_X XYZ_Y XYZ_Z",
                                        "1 0 0 0 0 0 80 85 70\n2 20 0 0 0 80 40 45 30\n3 0 0 0 0 0 80 85 70\n"
                                        "4 20 0 0 0 30 40 45 30\n5 0 0 0 0 100 81 86 71");
    CHECK_THAT(chart_fault(white), Contains("line 9") && Contains("sum to 50") && Contains("bare paper") &&
                                       Contains("2 of 3 rows") && Contains("--printable-only"));
    const auto full = parsed_with(white, {}, true);
    CHECK(full.patches.size() == 2);
    CHECK_THAT(notes_of(full), Contains("2 rows are of bare paper") && Contains("left out are 1 row whose"));
}

TEST_CASE("Inks that 8 bits have rounded are taken as a whole, said") {
    const auto with_sum = [](double sum) {
        return fmt::format("{}{} {} 0 0 70 -20 -15\nEND_DATA\n",
                           inks.substr(0, inks.find("BEGIN_DATA\n")) + "BEGIN_DATA\n1 x 10 0 0 0 71 -19 -8\n2 y ",
                           sum - 50, 50);
    };
    for (const double sum : {100.05, 100.392, 100.784, 100.8}) {
        const auto table = parsed_with(with_sum(sum), {});
        REQUIRE(table.patches.size() == 2);
        CHECK(table.patches[1].top.size() == 2);
        CHECK(table.patches[1].top[0].fraction + table.patches[1].top[1].fraction == Approx(1).epsilon(1e-15));
        CHECK_THAT(notes_of(table), Contains("1 of 2 rows") && Contains("8 bits"));
    }
    CHECK_THAT(notes_of(parsed_with(with_sum(100), {})), !Contains("8 bits"));
    CHECK_THAT(chart_fault(with_sum(100.9)),
               Contains("sum to 100.9") && Contains("1 of 2 rows") && Contains("--printable-only"));
    CHECK_THAT(notes_of(parsed_with(with_sum(150), {}, true)),
               Contains("left out are 1 row whose") && Contains("1 row is taken"));
    CHECK_THAT(chart_fault(of_fields("CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B", "90 90 0 0 50 0 0")),
               Contains("no row of the chart would do"));
}

TEST_CASE("A quote within a quoted word of CGATS is doubled") {
    for (const char* name : {"\"\"\"cyan one\"\"\"", "\"5\"\" proof\"", "\"\"", "\"a\"\"\"", "\"\"\"\""}) {
        const auto table = parsed(replaced(inks, "\"cyan one\"", name));
        CAPTURE(name);
        REQUIRE(table.patches.size() == 2);
        CHECK(table.patches[0].top == PatchMixture{{"C", 0.2}, {"W", 0.75}, {"Y", 0.05}});
    }
    // A spreadsheet quotes whole lines.
    const auto excel = parsed(
        replaced(inks, "WEIGHTING_FUNCTION \"ILLUMINANT, D50\"", "\"WEIGHTING_FUNCTION \"\"ILLUMINANT, D65\"\"\""));
    CHECK(excel.channels.illuminant == optics::Illuminant::d65);
}

TEST_CASE("CGATS that a spreadsheet has saved as a table is read") {
    const auto expected = parsed(inks);
    for (const char separator : {',', ';'}) {
        std::string text;
        std::size_t from = 0;
        for (bool table = false; from < inks.size();) {
            const std::size_t to = inks.find('\n', from);
            std::string line = inks.substr(from, to - from);
            from = to + 1;
            const bool begins = line.starts_with("BEGIN_DATA");
            if (line.starts_with("END_DATA")) table = false;
            if (line.starts_with("1 ")) line = replaced(line, "\"cyan one\"", "cyan_one");
            if (table) line = replaced(line, " ", std::string(1, separator));
            if (!table && line.find('"') != std::string::npos) {
                line = "\"" + replaced(line, "\"", "\"\"") + "\"";
            }
            text += line + (table ? "" : std::string(8, separator)) + "\r\n";
            table = table || begins;
        }
        CAPTURE(text);
        const auto table = parsed(text);
        REQUIRE(table.patches.size() == 2);
        CHECK(table.patches[0].top == expected.patches[0].top);
        CHECK(table.patches[0].rho == expected.patches[0].rho);
        CHECK(table.patches[1].top == expected.patches[1].top);
    }
}

TEST_CASE("Fields whose names have blanks are told apart by tabs") {
    std::string fields = "SAMPLE_ID\tCMYK_C\tCMYK_M\tCMYK_Y\tCMYK_K", row = "1\t50\t0\t0\t0";
    for (int nm = 400; nm <= 700; nm += 50) fields += fmt::format("\tR{} nm", nm), row += "\t0.5";
    const auto table = parsed_with(of_fields(fields, row, "CGATS.17\nNUMBER_OF_FIELDS 12\n"), {});
    CHECK(table.channels.wavelengths_nm.size() == 7);
}

TEST_CASE("Charts that nobody has measured are refused") {
    for (const char* kind : {"CTI1", "CTI2", "CTI1   ", "cti2"}) {
        const std::string text = of_fields("SAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K XYZ_X XYZ_Y XYZ_Z",
                                           "1 20 0 0 0 40 45 30\n2 0 0 0 0 80 85 70", std::string(kind) + "\n\n");
        CHECK_THAT(chart_fault(text), Contains("nobody has measured") && Contains(".ti3"));
        CHECK(parsed("CTI3\n" + text.substr(text.find('\n'))).patches.size() == 2);
    }
}

TEST_CASE("Inks of a chart that was printed through a calibration are those behind its curves") {
    const std::string chart =
        of_fields("SAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B",
                  "1 50 0 0 0 60 -20 -15\n2 25 0 10 0 70 -10 5\n3 0 0 0 0 90 0 0", "CTI3\nCOLOR_REP \"CMYK_LAB\"\n");
    const auto curves = [](const std::string& rows, const std::string& fields = "CMYK_I CMYK_C CMYK_M CMYK_Y CMYK_K") {
        return of_fields(fields, rows, "CAL\n\nDEVICE_CLASS \"OUTPUT\"\nCOLOR_REP \"CMYK\"\n");
    };
    const std::string bent = curves("0 0 0 0 0\n0.5 0.8 0.6 0.5 0.5\n1 1 1 1 1"),
                      straight = curves("0 0 0 0 0\n1 1 1 1 1");
    for (const std::string& text : {chart + bent, bent + chart}) {
        const auto table = parsed_with(text, {});
        CHECK(table.patches[0].top == PatchMixture{{"C", 0.8}, {"W", 0.2}});
        REQUIRE(table.patches[1].top.size() == 3);
        CHECK(table.patches[1].top[0].fraction == Approx(0.4));
        CHECK(table.patches[1].top[2].fraction == Approx(0.1));
        CHECK_THAT(notes_of(table), Contains("CAL"));
    }
    for (const std::string& text : {chart + straight, straight + chart, chart}) {
        CHECK(parsed_with(text, {}).patches[0].top == PatchMixture{{"C", 0.5}, {"W", 0.5}});
        CHECK_THAT(notes_of(parsed_with(text, {})), !Contains("CAL"));
    }
    CHECK(
        parsed_with(chart + curves("0 0 0 0 0\n50 80 60 50 50\n100 100 100 100 100"), {}).patches[0].top[0].fraction ==
        Approx(0.8));
    // The sum rule is one of what was printed.
    const std::string over = replaced(chart, "1 50 0 0 0", "1 50 40 0 0");
    CHECK(parsed(over).patches.size() == 3);
    CHECK_THAT(chart_fault(over + bent), Contains("sum to 128") && Contains("CAL") && Contains("2 of 3 rows"));
    CHECK(parsed_with(over + bent, {}, true).patches.size() == 2);
    // What does not fit is refused by that name.
    for (const std::string& damaged :
         {curves("0 0 0 0\n0.5 0.8 0.5 0.4\n1 1 1 1", "CMYK_C CMYK_M CMYK_Y CMYK_K"),
          curves("0 0 0 0 0\n0.5 x 0.6 0.5 0.5\n1 1 1 1 1"), curves("0 0 0 0 0\n0.5 0.8 0.6 0.5 0.5\n0.5 1 1 1 1"),
          curves("0 0 0 0 0\n0.5 0.8 0.6 0.5 0.5\n1 1 1 1 1", "CMYK_I CMYK_C CMYK_C CMYK_Y CMYK_K"),
          curves("0 0 0 0\n0.5 0.8 0.6 0.5\n1 1 1 1", "RGB_I RGB_R RGB_G RGB_B")}) {
        CAPTURE(damaged);
        CHECK_THAT(chart_fault(chart + damaged), Contains("CAL"));
    }
    CHECK_THAT(chart_fault(chart + curves("0 0 0 0\n0.5 0.8 0.5 0.4\n1 1 1 1", "CMYK_I CMYK_C CMYK_M CMYK_Y")),
               Contains("CAL") && Contains("none of K"));
    CHECK_THAT(chart_fault(bent), Contains("CAL") && Contains("no measurement"));
    // What else stands behind a chart is not looked at.
    CHECK(parsed(chart + of_fields("A", "1 2 3", "CTI3\n")).patches.size() == 3);
    for_each_cut(bent.substr(0, bent.size() - 1), [&](const std::string& cut) {
        try {
            (void)parsed(chart + cut);
        } catch (const InputError&) {
        }
    });
    survive_damage(chart + bent);
}

TEST_CASE("What was white and what lay before the instrument is read where programs write it") {
    const auto with = [](const std::string& head) {
        return of_fields("W LAB_L LAB_A LAB_B", "1 90 0 0", "CGATS.17\n" + head + "\n");
    };
    for (const char* paper : {"MEASUREMENT_SOURCE \"Illumination=D50 ObserverAngle=2 WhiteBase=Paper Filter=No\"",
                              "MEASUREMENT_SOURCE \"WhiteBase=paper\"", "WHITE_BASE \"Paper\""})
        CHECK_THAT(chart_fault(with(paper)), Contains("relative to the paper") && Contains("absolute"));
    CHECK_THAT(chart_fault("# WhiteBase: Paper\nW,L,a,b\n1,90,0,0\n"), Contains("relative to the paper"));
    for (const char* filter :
         {"MEASUREMENT_SOURCE \"WhiteBase=Abs Filter=Pol\"", "FILTER \"Pol\"", "POLARIZATION \"Yes\""})
        CHECK_THAT(notes_of(parsed(with(filter))), Contains("polarising"));
    for (const char* none : {"MEASUREMENT_SOURCE \"WhiteBase=Abs Filter=No\"", "FILTER \"UV\"", "POLARIZATION \"No\""})
        CHECK_THAT(notes_of(parsed(with(none))), !Contains("polarising"));
}
