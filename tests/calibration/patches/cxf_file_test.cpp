// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cxf_file.h"

#include "optics/colour/channels.h"
#include "tests/calibration/patches/chart_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

std::string cmyk(double c, double m, double y, double k) {
    return fmt::format(
        "<cc:DeviceColorValues><cc:ColorCMYK><cc:Cyan>{}</cc:Cyan><cc:Magenta>{}</cc:Magenta>"
        "<cc:Yellow>{}</cc:Yellow><cc:Black>{}</cc:Black></cc:ColorCMYK></cc:DeviceColorValues>",
        c, m, y, k);
}

std::string lab(double l, double a, double b, const std::string& specification = "S") {
    return fmt::format(
        "<cc:ColorValues><cc:ColorCIELab ColorSpecification=\"{}\"><cc:L>{}</cc:L><cc:A>{}</cc:A><cc:B>{}</cc:B>"
        "</cc:ColorCIELab></cc:ColorValues>",
        specification, l, a, b);
}

std::string spectrum(double low, double high, const std::string& start = " StartWL=\"400\"") {
    return "<cc:ColorValues><cc:ReflectanceSpectrum" + start + " ColorSpecification=\"S\">" +
           spectrum_row(400, 700, 20, low, high, "\n ") + "</cc:ReflectanceSpectrum></cc:ColorValues>";
}

std::string object(const std::string& name, const std::string& inside, const std::string& type = "Sample") {
    return fmt::format("<cc:Object ObjectType=\"{}\" Name=\"{}\" Id=\"i\">{}</cc:Object>\n", type, name, inside);
}

std::string file(const std::string& objects, const std::string& illuminant = "D50",
                 const std::string& observer = "2_Degree", const std::string& increment = " Increment=\"20\"") {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<cc:CxF xmlns:cc=\"http://colorexchangeformat.com/CxF3-core\">"
           "<cc:FileInformation><cc:Creator>a "
           "test</cc:Creator></cc:FileInformation><cc:Resources>\n<cc:ObjectCollection>\n" +
           objects +
           "</cc:ObjectCollection><cc:ColorSpecificationCollection><cc:ColorSpecification Id=\"S\"><cc:TristimulusSpec>"
           "<cc:Illuminant>" +
           illuminant + "</cc:Illuminant><cc:Observer>" + observer +
           "</cc:Observer></cc:TristimulusSpec><cc:MeasurementSpec><cc:WavelengthRange StartWL=\"400\"" + increment +
           "/></cc:MeasurementSpec></cc:ColorSpecification></cc:ColorSpecificationCollection></cc:Resources></cc:CxF>";
}

std::string location(int row, int column) {
    return fmt::format(
        "<cc:TagCollection Name=\"Location\"><cc:Tag Name=\"Row\" Value=\"{}\"/><cc:Tag Name=\"Column\" Value=\"{}\"/>"
        "</cc:TagCollection>",
        row, column);
}

}  // namespace

TEST_CASE("CxF3 with Lab is a chart under the illuminant that it names") {
    const auto table = parsed(file(
        object("A1", cmyk(20, 0, 5, 0) + lab(70, -20, -10)) + object("A2", cmyk(0, 0, 0, 0) + lab(92, 0, 3)), "D65"));
    CHECK(table.is_chart);
    CHECK(table.channels == optics::colorimetric_channels(optics::Illuminant::d65));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.2}, {"W", 0.75}, {"Y", 0.05}});
    CHECK(table.patches[0].rho[1] == Approx(std::pow(86.0 / 116, 3)));
    CHECK(table.patches[0].where == "chart: object \"A1\"");
}

TEST_CASE("CxF3 gives spectra before Lab, and its mixtures with any resins") {
    const std::string mixture =
        "<cc:DeviceColorValues><cc:ColorCMYKPlusN><cc:Cyan>10</cc:Cyan><cc:Magenta>0</cc:Magenta><cc:Yellow>0</"
        "cc:Yellow>"
        "<cc:Black>0</cc:Black><cc:SpotColor><cc:Name>White</cc:Name><cc:Percentage>50</cc:Percentage></cc:SpotColor>"
        "<cc:SpotColor Name=\"Orange\"><cc:Percentage>40</cc:Percentage></cc:SpotColor></cc:ColorCMYKPlusN>"
        "</cc:DeviceColorValues>";
    const auto table = parsed(file(object("A1", mixture + spectrum(0.1, 0.7) + lab(1, 2, 3)), "D50", "10_Degree"));
    REQUIRE(table.channels.wavelengths_nm.size() == 16);
    CHECK(table.channels.wavelengths_nm[1] == 420);
    CHECK(table.patches[0].rho.front() == 0.1);
    CHECK(table.patches[0].rho.back() == 0.7);
    CHECK(table.patches[0].top == PatchMixture{{"C", 0.1}, {"Orange", 0.4}, {"W", 0.5}});
    CHECK(table.notes.empty());
    // The range of wavelengths may stand in the specification alone.
    CHECK(parsed(file(object("A1", mixture + spectrum(0.1, 0.7, "")))).channels == table.channels);
    const auto xyz =
        parsed(file(object("A1", cmyk(0, 0, 0, 50) + "<cc:ColorValues><cc:ColorCIEXYZ><cc:X>18</cc:X><cc:Y>20</"
                                                     "cc:Y><cc:Z>16</cc:Z></cc:ColorCIEXYZ></cc:ColorValues>")));
    CHECK(xyz.patches[0].rho[1] == Approx(0.2));
}

TEST_CASE("Mixture and measurement of CxF3 may stand in two objects, and are paired by place or name") {
    const std::string targets =
        object("T1", cmyk(10, 0, 0, 0) + location(1, 1)) + object("T2", cmyk(0, 20, 0, 0) + location(1, 2));
    const std::string measured = object("x", spectrum(0.5, 0.6) + location(1, 2), "M0_Measurement") +
                                 object("y", spectrum(0.3, 0.4) + location(1, 1), "M0_Measurement");
    const auto table = parsed(file(targets + measured));
    REQUIRE(table.patches.size() == 2);
    CHECK(table.patches[0].top == PatchMixture{{"M", 0.2}, {"W", 0.8}});
    CHECK(table.patches[1].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    const auto by_name = parsed(file(targets + object("T1", spectrum(0.3, 0.4), "M1_Measurement")));
    CHECK(by_name.patches[0].top == PatchMixture{{"C", 0.1}, {"W", 0.9}});
    const auto two_kinds = parsed(file(targets + measured + object("T1", spectrum(0.9, 0.9), "M2_Measurement") +
                                       object("paper", spectrum(0.9, 0.9), "M0_Measurement")));
    CHECK(two_kinds.patches.size() == 2);
    REQUIRE(two_kinds.notes.size() == 3);
    CHECK_THAT(two_kinds.notes[0], Contains("1 measured objects have no mixture"));
    CHECK_THAT(two_kinds.notes[1], Contains("M0_Measurement"));
}

TEST_CASE("Faulty CxF3 is refused with a sentence") {
    const std::string good = cmyk(10, 0, 0, 0);
    CHECK_THAT(chart_fault("<svg/>"), Contains("\"svg\", not CxF"));
    CHECK_THAT(chart_fault("<?xml version=\"1.0\"?>\n"), Contains("without an element"));
    CHECK_THAT(chart_fault(file("")), Contains("no object has a ReflectanceSpectrum"));
    CHECK_THAT(chart_fault(file(object("A", lab(50, 0, 0)))), Contains("says its mixture"));
    CHECK_THAT(chart_fault(file(object(
                   "A", "<cc:DeviceColorValues><cc:ColorRGB><cc:R>1</cc:R></cc:ColorRGB></cc:DeviceColorValues>" +
                            lab(50, 0, 0)))),
               Contains("RGB of a device"));
    CHECK_THAT(chart_fault(file(object("A", good + lab(50, 0, 0)), "D50", "10_Degree")), Contains("10 degree"));
    CHECK_THAT(chart_fault(file(object("A", good + lab(50, 0, 0)), "F2")), Contains("\"F2\""));
    CHECK_THAT(chart_fault(file(object("A", good + spectrum(0.1, 0.2)), "D50", "2_Degree", "")), Contains("Increment"));
    CHECK_THAT(chart_fault(file(object("A", good + spectrum(0.1, 0.2)), "D50", "2_Degree", " Increment=\"10\"")),
               Contains("400 to 550 nm"));
    CHECK_THAT(chart_fault(file(object("A", good + spectrum(0.1, 0.2)) +
                                object("B", good + spectrum(0.1, 0.2, " StartWL=\"380\"")))),
               Contains("other wavelengths") && Contains("\"B\""));
    CHECK_THAT(chart_fault(file(object("A", good + lab(50, 0, 0)) + object("B", good + spectrum(0.1, 0.2)))),
               Contains("measured alike"));
    CHECK_THAT(chart_fault(file(object("A", good + lab(60, 0, 0)) + object("B", good + lab(50, 0, 0)))),
               Contains("\"A\"") && Contains("\"B\"") && Contains("CIEDE2000"));
    CHECK_THAT(chart_fault(file(object("A", cmyk(70, 70, 0, 0) + lab(50, 0, 0)))),
               Contains("\"A\"") && Contains("sum to 140"));
    CHECK_THAT(chart_fault(file(object(
                   "A", good + "<cc:ColorValues><cc:ColorCIELab><cc:L>x</cc:L></cc:ColorCIELab></cc:ColorValues>"))),
               Contains("\"x\" in cc:L") || Contains("\"x\" in L"));
    CHECK_THAT(chart_fault(file(object(
                   "A", good + "<cc:ColorValues><cc:ColorCIELab><cc:L>5</cc:L></cc:ColorCIELab></cc:ColorValues>"))),
               Contains("some are missing"));
}

TEST_CASE("CxF3 that is cut anywhere before its end is refused") {
    const std::string text = file(object("A1", cmyk(20, 0, 5, 0) + location(1, 1)) +
                                  object("x", spectrum(0.1, 0.6) + location(1, 1), "M0_Measurement"));
    for_each_cut(text, [](const std::string& cut) {
        INFO(cut);
        CHECK_THROWS_AS(parsed(cut), InputError);
    });
    survive_damage(text);
    // An object within the colour of another.
    CHECK_THROWS_AS(
        parsed("<CxF><Object><ColorValues><ColorCIELab><Object/><L>1</L></ColorCIELab></ColorValues></Object></CxF>"),
        InputError);
}
