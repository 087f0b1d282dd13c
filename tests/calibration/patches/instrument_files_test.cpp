// SPDX-License-Identifier: GPL-3.0-or-later
//
// Charts as each tool writes them are read right, or refused by what they are, and none that nobody has measured is
// taken for a measured one. The files are made by hand after what the tools write; their colours are invented.
#include <algorithm>

#include "tests/calibration/patches/chart_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

// Argyll 2.3: targen, printtarg and chartread keep these keywords and fields.
std::string argyll(const std::string& kind, const std::string& device, const std::string& inks, const std::string& rows,
                   const std::string& keywords = "") {
    std::string fields = "SAMPLE_ID SAMPLE_LOC";
    for (const char ink : inks) fields += fmt::format(" {}_{}", device, ink);
    const auto count = std::ranges::count(rows, '\n') + 1;
    return fmt::format(
        "{}   \n\nDESCRIPTOR \"Argyll Calibration Target chart information\"\nORIGINATOR \"Argyll\"\n"
        "KEYWORD \"DEVICE_CLASS\"\nDEVICE_CLASS \"OUTPUT\"\nCOLOR_REP \"{}\"\n{}\nNUMBER_OF_FIELDS {}\n"
        "BEGIN_DATA_FORMAT\n{} XYZ_X XYZ_Y XYZ_Z \nEND_DATA_FORMAT\n\nNUMBER_OF_SETS {}\nBEGIN_DATA\n{}\nEND_DATA\n",
        kind, kind == "CTI3" ? device + "_XYZ" : device, keywords, 5 + inks.size(), fields, count, rows);
}

const std::string four =
                      "1 \"A1\" 20.000 0.0000 5.0000 0.0000 30.1 38.2 40.3\n2 \"A2\" 0.0000 0.0000 0.0000 0.0000 "
                      "80.1 84.2 69.3",
                  five =
                      "1 \"A1\" 20.000 0.0000 0.0000 0.0000 80.000 30.1 38.2 40.3\n2 \"A2\" 0.0000 0.0000 0.0000 "
                      "0.0000 100.00 80.1 84.2 69.3",
                  guess = "APPROX_WHITE_POINT \"76.0 79.0 65.0\"";

std::string spectra(double level) {
    std::string text;
    for (int nm = 380; nm <= 730; nm += 10) text += fmt::format("\t{}", level);
    return text;
}

// i1Profiler's CGATS: tabs, quoted keywords, spectra by nm380 to nm730; `measured`: with them.
std::string i1profiler(bool measured) {
    std::string text = "CGATS.17\nORIGINATOR\t\"i1Profiler\"\nKEYWORD\t\"SAMPLE_ID\"\nNUMBER_OF_FIELDS\t" +
                       std::to_string(measured ? 42 : 6) +
                       "\nMEASUREMENT_SOURCE\t\"MeasurementCondition=M0\tFilter=no\"\nBEGIN_DATA_FORMAT\n"
                       "SAMPLE_ID\tSAMPLE_NAME\tCMYK_C\tCMYK_M\tCMYK_Y\tCMYK_K";
    for (int nm = 380; nm <= 730 && measured; nm += 10) text += fmt::format("\tnm{}", nm);
    text += "\nEND_DATA_FORMAT\nNUMBER_OF_SETS\t2\nBEGIN_DATA\n";
    text += "1\t\"A1\"\t20.00\t0.00\t0.00\t0.00" + (measured ? spectra(0.4) : "") + "\n";
    text += "2\t\"A2\"\t0.00\t0.00\t0.00\t0.00" + (measured ? spectra(0.8) : "") + "\n";
    return text + "END_DATA\n";
}

std::string cxf(const std::string& objects) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<cc:CxF xmlns:cc=\"http://colorexchangeformat.com/CxF3-core\">"
           "<cc:Resources><cc:ObjectCollection>" +
           objects +
           "</cc:ObjectCollection><cc:ColorSpecificationCollection><cc:ColorSpecification "
           "Id=\"M0\"><cc:MeasurementSpec>"
           "<cc:WavelengthRange StartWL=\"380\" Increment=\"10\"/></cc:MeasurementSpec></cc:ColorSpecification>"
           "</cc:ColorSpecificationCollection></cc:Resources></cc:CxF>";
}

// i1Profiler keeps what is printed and what is measured in two objects of one location.
std::string cxf_object(const std::string& type, int column, const std::string& inside) {
    return fmt::format(
        "<cc:Object ObjectType=\"{}\" Name=\"{}{}\" Id=\"c\">{}<cc:TagCollection Name=\"Location\"><cc:Tag "
        "Name=\"Column\" "
        "Value=\"{}\"/><cc:Tag Name=\"Page\" Value=\"1\"/><cc:Tag Name=\"Row\" Value=\"0\"/></cc:TagCollection>"
        "</cc:Object>\n",
        type, type, column, inside, column);
}

std::string with_spots(double cyan, double orange, double green) {
    return fmt::format(
        "<cc:DeviceColorValues><cc:ColorCMYKPlusN><cc:Cyan>{}</cc:Cyan><cc:Magenta>0</cc:Magenta>"
        "<cc:Yellow>0</cc:Yellow><cc:Black>0</cc:Black><cc:SpotColor><cc:Name>Orange</cc:Name><cc:Percentage>{}"
        "</cc:Percentage></cc:SpotColor><cc:SpotColor><cc:Name>Green</cc:Name><cc:Percentage>{}</cc:Percentage>"
        "</cc:SpotColor></cc:ColorCMYKPlusN></cc:DeviceColorValues>",
        cyan, orange, green);
}

std::string read_spectrum(double level) {
    return "<cc:ColorValues><cc:ReflectanceSpectrum ColorSpecification=\"M0\" StartWL=\"380\">" + spectra(level) +
           "</cc:ReflectanceSpectrum></cc:ColorValues>";
}

}  // namespace

TEST_CASE("Argyll's measured charts of four and five inks are read") {
    CHECK(parsed(argyll("CTI3", "CMYK", "CMYK", four)).patches[0].top ==
          PatchMixture{{"C", 0.2}, {"W", 0.75}, {"Y", 0.05}});
    const auto table = parsed(argyll("CTI3", "CMYKW", "CMYKW", five));
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.2}, {"W", 0.8}});
    CHECK(table.patches[1].where == "chart: line 17");
}

TEST_CASE("Argyll's charts that are to be printed are refused by what they are, with any number of inks") {
    for (const char* kind : {"CTI1", "CTI2"}) {
        const std::string name = std::string("a .ti") + kind[3];
        CHECK_THAT(chart_fault(argyll(kind, "CMYK", "CMYK", four, guess)),
                   Contains("nobody has measured") && Contains(name) && Contains(".ti3"));
        CHECK_THAT(chart_fault(argyll(kind, "CMYKW", "CMYKW", five, guess)), Contains(name));
        // Behind the curves of a calibration, and before them.
        const std::string curves =
            "CAL\n\nBEGIN_DATA_FORMAT\nCMYK_I CMYK_C CMYK_M CMYK_Y CMYK_K\nEND_DATA_FORMAT\n"
            "BEGIN_DATA\n0 0 0 0 0\n1 1 1 1 1\nEND_DATA\n";
        CHECK_THAT(chart_fault(argyll(kind, "CMYK", "CMYK", four) + curves), Contains(name));
        CHECK_THAT(chart_fault(curves + argyll(kind, "CMYK", "CMYK", four)), Contains(name));
    }
    // The first line may be lost or changed on the way; targen's guess of the paper is not.
    CHECK_THAT(chart_fault(argyll("CGATS.17", "CMYK", "CMYK", four, guess)), Contains("APPROX_WHITE_POINT"));
    CHECK(parsed(argyll("CTI3", "CMYK", "CMYK", four, guess)).patches.size() == 2);
}

TEST_CASE("i1Profiler's CGATS is read where it is measured, and refused where it is a list of patches") {
    const auto table = parsed(i1profiler(true));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.channels.wavelengths_nm.size() == 36);
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.2}, {"W", 0.8}});
    CHECK(table.patches[1].rho.front() == 0.8);
    CHECK_THAT(chart_fault(i1profiler(false)), Contains("nothing is measured"));
}

TEST_CASE("CxF with spot inks is paired by location, and what it aims at is not what was measured") {
    const std::string aims = cxf_object("Target", 0, with_spots(10, 20, 0)) +
                             cxf_object("Target", 1, with_spots(0, 0, 30)),
                      read = cxf_object("M0_Measurement", 1, read_spectrum(0.7)) +
                             cxf_object("M0_Measurement", 0, read_spectrum(0.3));
    const auto table = parsed(cxf(aims + read));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.patches[0].top == PatchMixture{{"Green", 0.3}, {"W", 0.7}});
    CHECK(table.patches[0].rho.front() == 0.7);
    CHECK(table.patches[1].top == PatchMixture{{"C", 0.1}, {"Orange", 0.2}, {"W", 0.7}});
    // A chart that was never measured.
    CHECK_THAT(chart_fault(cxf(aims)), Contains("no measured chart"));
    // Colours that are wanted stand before those that were measured.
    const std::string wanted = cxf_object("Target", 0, with_spots(10, 20, 0) + read_spectrum(0.9)) +
                               cxf_object("Target", 1, with_spots(0, 0, 30) + read_spectrum(0.95));
    const auto both = parsed(cxf(wanted + read));
    REQUIRE(both.patches.size() == 2);
    CHECK(both.patches[0].rho.front() == 0.7);
    CHECK_THAT(notes_of(both), Contains("\"M0_Measurement\" is taken") && !Contains("aims at"));
    CHECK_THAT(notes_of(parsed(cxf(wanted))), Contains("\"Target\"") && Contains("aims at"));
}

TEST_CASE("Tables of SpectraMagic with the resins beside them are read: SCI and SCE, spectra before L, a, b") {
    std::string head = "Project\tchart 7\n\nData Name\tType\tW\tC\tL*(D65)\ta*(D65)\tb*(D65)\tdE*ab(D65)",
                rows[2] = {"1\tSample\t0.9\t0.1\t86\t-20\t-15\t1.2", "2\tSample\t1\t0\t94\t0\t1\t0.3"};
    CHECK(parsed_with(head + "\n" + rows[0] + "\n" + rows[1] + "\n", {}).patches[0].top ==
          PatchMixture{{"C", 0.1}, {"W", 0.9}});
    for (int nm = 360; nm <= 740; nm += 10) {
        head += fmt::format("\t{} nm", nm);
        rows[0] += "\t40.5", rows[1] += "\t80.5";
    }
    const auto table = parsed_with(head + "\n" + rows[0] + "\n" + rows[1] + "\n", {});
    CHECK(table.channels.wavelengths_nm.size() == 39);
    CHECK(table.patches[1].rho.front() == Approx(0.805));
    CHECK_THAT(notes_of(table), Contains("\"Data Name\"") || Contains("\"Type\""));
}

TEST_CASE("QTX of Color iQC is refused by that name") {
    for (const char* section : {"[STANDARD_DATA 0]", "\r\n[BATCH_DATA 0]"})
        CHECK_THAT(chart_fault(std::string(section) + "\nSTD_NAME=C 10\nSTD_REFLPOINTS=31,\nSTD_REFLINTERVAL=10,\n"
                                                      "STD_REFLLOW=400,\nSTD_R=83.4,84.9,84.6,\n"),
                   Contains("QTX") && Contains("Color iQC") && Contains("CSV"));
}

TEST_CASE("A chart whose colours somebody filled in is no measured one") {
    const std::string head = "W,C,L,a,b\n", zeros = "1,0,0,0,0\n0.5,0.5,0,0,0\n0,1,0,0,0\n";
    CHECK_THAT(chart_fault(head + zeros), Contains("one and the same colour") && Contains("nobody has measured"));
    CHECK_THAT(chart_fault(head + "1,0,50,0,0\n0.5,0.5,50,0,0\n0,1,50,0,0\n"), Contains("all 3 patches"));
    CHECK(parsed(head + "1,0,50,0,0\n0.5,0.5,50,0,0\n0,1,50,0,0.01\n").patches.size() == 3);
    // One mixture printed thrice may be one colour.
    CHECK(parsed(head + "1,0,90,0,0\n1,0,90,0,0\n1,0,90,0,0\n").patches.size() == 3);
    // Cells without a value, in CGATS as in CSV.
    const std::string fields =
        "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_ID\tW\tC\tLAB_L\tLAB_A\tLAB_B\nEND_DATA_FORMAT\n"
        "BEGIN_DATA\n1\t1\t0\t\t\t\n";
    CHECK_THAT(chart_fault(fields + "2\t0.5\t0.5\t\t\t\nEND_DATA\n"), Contains("no patch is measured yet"));
    CHECK_THAT(notes_of(parsed(fields + "2\t0.5\t0.5\t60\t-20\t-15\nEND_DATA\n")),
               Contains("1 patches have no colour"));
}

TEST_CASE("A message of a table names line and column, whatever its format") {
    CHECK_THAT(chart_fault("W,C,L,a,b\n1,0,90,0,0\n0.9,x,80,0,0\n"), Contains("line 3, column 2 (\"C\")"));
    CHECK_THAT(chart_fault(i1profiler(true).replace(i1profiler(true).find("0.8"), 3, "?.8")),
               Contains("line 12, column 7 (\"nm380\"): \"?.8\" is no number"));
    CHECK_THAT(chart_fault("top,backing,thickness_mm,R,G,B\nC,W,1,0.1,?,0.3\n"), Contains("line 2, column 5 (\"G\")"));
    CHECK_THAT(chart_fault(argyll("CTI3", "CMYK", "CMYK", four) +
                           "CAL\nBEGIN_DATA_FORMAT\nCMYK_I CMYK_C\nEND_DATA_FORMAT\nBEGIN_DATA\n0 y\nEND_DATA\n"),
               Contains("its CAL table: line 24, column 2 (\"CMYK_C\"): \"y\" is no number"));
}
