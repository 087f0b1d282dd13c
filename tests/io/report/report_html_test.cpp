// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/report_html.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include "io/pictures/picture_writer.h"
#include "io/report/customer_page.h"
#include "io/report/report_json.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

const std::string evil =
    "</title></script><script>alert('x')</script><img src=http://a.b/c onerror=\"e()\">&\x1b[2J\xFF";

ReportPicture picture(const std::string& caption, double px_per_mm) {
    Picture8 pixels{40, 20, 4, std::vector<std::uint8_t>(40 * 20 * 4, 200)};
    return {caption, png_bytes(pixels), 40, 20, px_per_mm};
}

Report sample(const std::string& text) {
    Report report;
    report.title = text;
    report.program_version = "1.2.3";
    report.printer_id = text;
    report.printer_name = text;
    report.pitch_um = {25400.0 / 600, 25400.0 / 300, 27};
    report.size_mm = {60.03, 32.85, 105.84};
    report.size_px = {1418, 388, 3920};
    report.body_voxels = 1234567;
    report.resins = {{text, text, text, {220, 222, 216}, 1200000, 0.116},
                     {"VeroCyan", "C", "", {0, 150, 200}, 34567, 3.4}};
    report.warnings = {text, "second"};
    report.stages = {{text, 12.5}, {"Layers", 37.5}};
    report.total_seconds = 51.2;
    report.peak_memory_bytes = 412'000'000;
    report.gamut = ReportGamut{0.125, 0.84, 3.21, 9.87};
    report.prediction_note = text;
    report.views = {{text, {picture(text, 2), picture("predicted", 2)}}, {"front", {picture("f", 0)}}};
    report.layers = {{0, 0.0135, picture("l", 2)}, {1960, 52.9335, picture("l", 2)}};
    report.sections = {{text,
                        {text},
                        {{text, {text, "Count"}, {{text, "12"}, {"b", "3.5 %"}}}},
                        {picture(text, 1)},
                        {{text, "<svg id=\"curve\"></svg>"}}}};
    report.job = {{text, text}, {"printer", "stratasys-j750-hm"}};
    ViewerSurface surface;
    surface.size_px = {1, 1};
    surface.covered = {1};
    surface.looks = {{text, text, {1, 2, 3}}};
    surface.note = text;
    report.viewer.surface = surface;
    report.viewer.worst = {{{1, 2, 3}, {0, 0, 1}, 4.5, {1, 2, 3}, {4, 5, 6}, text, "", text}};
    return report;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + what.size())) ++n;
    return n;
}

}  // namespace

TEST_CASE("The page tells the figures with their units") {
    const std::string html = report_html(sample("spot.obj"));
    CHECK_THAT(html,
               Contains("60.03 × 32.85 × 105.84 mm") && Contains("1418 × 388 px") && Contains("42.33 × 84.67 µm"));
    CHECK_THAT(html, Contains("3\u202f920") && Contains("of 27 µm") && Contains("1\u202f234\u202f567 voxels") &&
                         Contains("3.52 ml") && Contains("3.40 ml") && Contains("0.116 ml"));
    CHECK_THAT(html, Contains("51 s") && Contains("peak memory 393 MiB") && Contains("12.5 %") && Contains("9.87"));
    CHECK_THAT(html, Contains("0, 150, 200") && Contains("layer 1960, 52.934 mm"));
    // 40 px at 2 px/mm are 20 mm: a bar of 5 mm is a quarter of that.
    CHECK_THAT(html, Contains("width:25.000%") && Contains(">5 mm<"));
    CHECK_THAT(html, Contains("<th class=\"n\">Count</th>") && Contains("<td class=\"n\">3.5 %</td>"));
}

TEST_CASE("A resin is called what the printer's software calls it, in the table and in the viewer's legend") {
    Report report = sample("x");
    report.resins[1].material_name = "VeroCY-V";
    const std::string page = report_html(report);
    CHECK_THAT(page, Contains("\"name\": \"VeroCY-V\""));
    CHECK_THAT(page, !Contains("\"name\": \"VeroCyan\""));
    CHECK_THAT(page, Contains("VeroCY-V <span class=\"soft\">VeroCyan</span>"));
}

TEST_CASE("No text can become markup, and nothing comes from outside") {
    const std::string calm = report_html(sample("calm")), html = report_html(sample(evil));
    for (const char* mark : {"<script", "</script", "<img", "onerror=\"", "<title", "\x1b"})
        CHECK(count(html, mark) == count(calm, mark));
    CHECK(count(html, "<") == count(calm, "<"));
    CHECK(count(calm, "http") == 1);  // http-equiv
    CHECK_THAT(calm, Contains("default-src 'none'"));
    CHECK(count(html, "\xFF") == 0);
}

TEST_CASE("Pictures are in the page as they are") {
    Report report;
    report.title = "t";
    ReportPicture three = picture("p", 0);
    for (const auto& [bytes, text] : {std::pair<std::vector<std::uint8_t>, std::string>{{'M', 'a', 'n'}, "TWFu"},
                                      {{'M', 'a'}, "TWE="},
                                      {{'M'}, "TQ=="},
                                      {{0xFB, 0xFF, 0xFE, 0x00}, "+//+AA=="}}) {
        three.file = bytes;
        report.views = {{"v", {three}}};
        CHECK_THAT(report_html(report), Contains("base64," + text + "\""));
    }
}

TEST_CASE("Parts of a tray are listed with their figures, each with its page and the place to turn to") {
    Report report = sample("calm");
    ReportPart cow, nameless;
    cow.name = "cow & calf", cow.page = "parts/cow & calf/report.html", cow.picture = picture("", 0);
    nameless.name = evil;
    cow.copies = 20, cow.ml = 1.234, cow.level = VerdictLevel::fair, cow.headline = "Nearly", cow.seen_mean = 3.14;
    report.parts = {cow, nameless};
    report.viewer.worst.resize(2);
    report.viewer.worst[0].words = "upper left, seen from behind";
    const std::string html = report_html(report);
    CHECK_THAT(html, Contains("2 parts, 21 in all"));
    CHECK_THAT(html,
               Contains("<a href=\"parts/cow%20%26%20calf/report.html\">cow &amp; calf</a><small>Nearly</small>"));
    CHECK_THAT(html, Contains("<td class=\"n\">20</td><td class=\"n\">1.23</td>"));
    CHECK_THAT(html, Contains("<i class=\"mark fair\"></i>3.1</td>"));
    CHECK_THAT(html, Contains("data-place=\"0\" disabled>upper left, seen from behind</button>"));
    CHECK_THAT(html, Contains("data-place=\"1\" disabled>show it</button>"));
    CHECK_THAT(html, Contains("<i class=\"mark unknown\"></i>not predicted</td>"));
    CHECK(count(html, "Where it is worst") == 0);  // the parts say so
    CHECK(count(html, "<script>alert") == 0);
    CHECK(still_page_bytes(report) > html.size() / 2);
    // Where nothing was predicted no place is the worst.
    report.parts[0].seen_mean.reset();
    const std::string unseen = report_html(report);
    CHECK(count(unseen, "<th>Place</th>") == 1);
    CHECK(count(unseen, "Worst place") + count(unseen, "Difference as seen") + count(unseen, "class=\"mark") == 0);
}

TEST_CASE("Who ordered it reads the worst thing, too, once, and is led only where there is a place") {
    Report report = sample("sign");
    ReportVerdict& verdict = report.verdict.emplace();
    verdict.level = VerdictLevel::fair;
    verdict.sentence = "Fair.";
    verdict.headline = "On the whole fair";
    verdict.but = "Worst: type below 2.1 mm (6 pt) is not readable.";
    verdict.but_normal = {0, 0, 1};
    CHECK_THAT(customer_html(report), Contains("type below 2.1 mm (6 pt) is not readable"));
    CHECK(count(report_html(report), "show me") == 1);
    report.verdict->but = "Its glass is LOST.", report.verdict->but_normal = {};
    report.warnings = {"Its glass is LOST. [lost-colour]"};
    CHECK(count(customer_html(report), "LOST") == 1);
    CHECK(count(report_html(report), "show me") == 0);
}

TEST_CASE("Where the print's white is darker than paper whoever reads is told how much") {
    Report report = sample("sheet");
    ReportVerdict& verdict = report.verdict.emplace();
    verdict.level = VerdictLevel::fair;
    verdict.sentence = "Fair.";
    verdict.seen_mean = 2.9;
    CHECK_THAT(customer_html(report) + report_html(report), !Contains("its white"));
    verdict.paper = 0.83;
    CHECK_THAT(customer_html(report), Contains("its white is darker: it has 83 % of the light"));
    CHECK_THAT(report_html(report), Contains("its white has 0.83 of the light"));
    CHECK(nlohmann::json::parse(report_json(report))["verdict"]["paper"] == 0.83);
    verdict.level = VerdictLevel::unknown;
    CHECK_THAT(customer_html(report), !Contains("its white"));
}

TEST_CASE("Who ordered it reads what may break and what is lost, and neither options nor tools") {
    Report report = sample("figure");
    report.warnings = {
        "walls under 0.6 mm may break: 0.4 mm over 2 mm below (1.0, 2.0, 0.3 mm). Thickened in a mesh "
        "editor they would not [fragile]",
        "3 pairs of pieces meet in a point alone: let them overlap in a mesh editor [fragile]",
        "a.png has transparent pixels; they were laid over white. --alpha translucency prints them so "
        "that light goes through, --cut-out leaves them out [transparent]",
        "the print is only 1 mm large [tiny]"};
    const std::string html = customer_html(report);
    CHECK(count(html, "may break when the support is washed off") == 1);
    CHECK_THAT(html, Contains("a.png has transparent pixels; they were laid over white.</p>"));
    for (const char* of_shop : {"--alpha", "mesh editor", "[", "(1.0", "1 mm large"})
        CHECK_THAT(html.substr(html.find("Please note")), !Contains(of_shop));
}

TEST_CASE("The customer's page says something of the looks, whatever is known of them") {
    Report report = sample("sword");
    report.verdict.reset();
    const auto said = [&] {
        const std::string html = customer_html(report), begin = "<p class=\"verdict ";
        const std::size_t at = html.find('>', html.find(begin));
        REQUIRE(html.find(begin) != std::string::npos);
        return html.substr(at + 1, html.find("</p>", at) - at - 1);
    };
    CHECK(said() == "How it will look was not predicted.");
    report.verdict.emplace();
    CHECK_THAT(said(), Contains("colours that are in reach"));
    report.verdict->level = VerdictLevel::good;
    report.verdict->sentence = "It will look as asked: white everywhere.";
    CHECK(said() == report.verdict->sentence);
    report.verdict->headline = "On the whole good, 1.2";
    CHECK(said() == report.verdict->headline);
    // Of a body only, and only where its picture was predicted.
    report.verdict->sides.clear();
    CHECK_THAT(customer_html(report, ""), !Contains("Fine stripes"));
    report.verdict->sides.push_back({"front", 1.2, 0.5});
    CHECK_THAT(customer_html(report, ""), Contains("Fine stripes along curved faces"));
    report.verdict.reset();
    CHECK_THAT(customer_html(report, ""), !Contains("Fine stripes"));
}

TEST_CASE("Drawings are in the page as they are, their captions as text") {
    const std::string html = report_html(sample("profile <1>"));
    CHECK(count(html, "<svg id=\"curve\"></svg><figcaption>profile &lt;1&gt;</figcaption>") == 1);
}

TEST_CASE("A report with nothing in it is still a page") {
    const std::string html = report_html({});
    CHECK_THAT(html, Contains("<h1></h1>") && Contains("</html>"));
    CHECK(count(html, "<section") == 0);
}

TEST_CASE("report.json has the same figures") {
    const auto json = nlohmann::json::parse(report_json(sample(evil)));
    CHECK(json["format"] == "voxtone-report");
    CHECK(json["size_mm"] == nlohmann::json({60.03, 32.85, 105.84}));
    CHECK(json["size_px"] == nlohmann::json({1418, 388}));
    CHECK(json["layers"] == 3920);
    CHECK(json["resins"][1]["rgb"] == nlohmann::json({0, 150, 200}));
    CHECK(json["resin_ml"].get<double>() == Approx(3.516));
    CHECK(json["seconds"] == 51.2);
    CHECK(json["gamut"]["de2000"]["p95"] == 3.21);
    CHECK(json["warnings"][1] == "second");
    CHECK(json["sections"][0]["tables"][0]["rows"][1][1] == "3.5 %");
    CHECK(json["job"]["printer"] == "stratasys-j750-hm");
    CHECK(json["title"].get<std::string>().substr(0, 8) == "</title>");
    CHECK_FALSE(nlohmann::json::parse(report_json({})).contains("gamut"));
}
