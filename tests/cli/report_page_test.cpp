// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pages that the program wrote, in a real browser: what they show are the numbers of the files beside them.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "exr_numbers.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/srgb_code.h"
#include "run_program.h"
#include "tests/io/report/chromium.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Contains;

namespace {

/// As the page writes a colour.
std::string hex(const ExrNumbers& numbers, int x, int y) {
    const float* at = numbers.at(x, y);
    return fmt::format("#{:02x}{:02x}{:02x}", io::linear_to_srgb8(at[0]), io::linear_to_srgb8(at[1]),
                       io::linear_to_srgb8(at[2]));
}

/// Stripes of colour and a dark square.
void write_picture(const Folder& folder) {
    io::Picture8 picture{90, 60, 3, {}};
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 90; ++x) {
            const bool dark = x > 50 && x < 75 && y > 20 && y < 45;
            for (const int code : {60 + 2 * x, 220 - 2 * y, 80 + (x / 15) % 2 * 120})
                picture.codes.push_back(std::uint8_t(dark ? 25 : std::min(255, code)));
        }
    const auto png = io::png_bytes(picture);
    folder.write("picture.png", {png.begin(), png.end()});
}

/// The picture as a print, made once for all tests that read it.
struct Print {
    Folder folder{"page"};
    Print() {
        write_picture(folder);
        REQUIRE(run_program(fmt::format("slice {} --width 6mm --thickness 2.5mm --iterations 1 --quiet -o {}",
                                        folder / "picture.png", folder / "out"))
                    .exit_code == 0);
    }
};
const Folder& print_folder() {
    static const Print print;
    return print.folder;
}

std::string text_of(Chromium& browser, const std::string& id) {
    return browser.evaluate("document.getElementById('" + id + "').innerText").get<std::string>();
}

}  // namespace

TEST_CASE("The page of a print shows the numbers of its EXR files, and each of its worst places") {
    if (find_chromium().empty()) return skip("there is no Chromium on this machine (Debian: chromium)");
    const Folder& folder = print_folder();
    const ExrNumbers target = read_exr(folder / "out/target.exr"), print = read_exr(folder / "out/predicted.exr");
    Chromium& browser = shared_chromium();
    browser.open(folder / "out/report.html");
    (void)browser.evaluate("document.getElementById('viewer-canvas').scrollIntoView({block: 'center'})");
    browser.draw();
    const auto [left, top, width, height] = browser.box("#viewer-canvas");
    // Pixels of a cell, 2 x 1 x 3 voxels of the J750 High Mix.
    const double cell_x = 2 * 25.4 / 600, cell_y = 25.4 / 300;
    const double mm_x = target.width * cell_x, mm_y = target.height * cell_y;
    const double px_per_mm = height / (2 * 0.53 * std::max(mm_y, mm_x * height / width));
    for (const auto& [column, row] : {std::pair{2, 3}, {20, 11}, {45, 30}, {60, 40}, {target.width - 2, 1}}) {
        CAPTURE(column, row);
        browser.move(left + width / 2 + ((column + 0.5) * cell_x - mm_x / 2) * px_per_mm,
                     top + height / 2 + ((row + 0.5) * cell_y - mm_y / 2) * px_per_mm);
        REQUIRE(browser.wait_for(
            fmt::format("document.getElementById('probe-list').innerText.includes('{}, {}')", column, row)));
        CHECK_THAT(text_of(browser, "probe-values"),
                   Contains(hex(target, column, row)) && Contains(hex(print, column, row)));
        CHECK_THAT(text_of(browser, "probe-mixture"), Contains("0.7 to 1 mm") && Contains(" %"));
    }
    // A worst place has the difference that its line in the list says.
    const int places = browser.evaluate("document.querySelectorAll('ol.worst button.place').length").get<int>();
    CHECK(places >= 1);
    const auto said =
        browser.evaluate("Number(document.querySelector('ol.worst button.place').innerText.match(/[\\d.]+/)[0])");
    (void)browser.evaluate("document.querySelector('ol.worst button.place').click()");
    CHECK(browser.wait_for(
        fmt::format("document.getElementById('probe-list').innerText.includes('{:.1f}')", said.get<double>())));
    CHECK(browser.complaints() == std::vector<std::string>{});
    CHECK(browser.requests() == std::vector<std::string>{});
}

TEST_CASE("What the operator reads is not cut off, in a window and on paper") {
    if (find_chromium().empty()) return skip("there is no Chromium on this machine (Debian: chromium)");
    const Folder& folder = print_folder();
    Chromium& browser = shared_chromium();
    for (const std::string page : {"printer/HOW-TO-PRINT.html", "resin-assignment.html"})
        for (const int width : {1400, 900, 720}) {
            browser.open(folder / "out/" + page, width, 1000, 2);
            for (const std::string media : {"screen", "print"}) {
                browser.prefer_media(media);
                CAPTURE(page, width, media);
                CHECK(browser.evaluate("document.documentElement.scrollWidth <= innerWidth").get<bool>());
                CHECK(browser
                          .evaluate("[...document.querySelectorAll('.table')]"
                                    ".filter(t => t.scrollWidth > t.clientWidth + 1).length")
                          .get<int>() == 0);
            }
        }
}

TEST_CASE("predict writes a page too, with the voxels that it read") {
    const Folder& folder = print_folder();
    const std::string command = fmt::format("predict {} --quiet --cell 0.17mm -o {}", folder / "out", folder / "page");
    REQUIRE(run_program(command + "1.html --threads 1").exit_code == 0);
    REQUIRE(run_program(command + "2.html --threads 2").exit_code == 0);
    const std::string page = read_file(folder / "page1.html");
    CHECK_THAT(page, Contains("id=\"viewer-data\"") && Contains("\"surface\"") && Contains("id=\"voxel-data\""));
    // The data have the same bytes for any number of threads; times and memory around them have not.
    for (const char* id : {"viewer-data", "voxel-data"}) {
        const auto data = [id](const std::string& html) {
            const std::size_t from = html.find(fmt::format("id=\"{}\"", id)), to = html.find("</script>", from);
            return html.substr(from, to - from);
        };
        CHECK(data(page) == data(read_file(folder / "page2.html")));
    }
    if (find_chromium().empty()) return skip("there is no Chromium on this machine (Debian: chromium)");
    Chromium& browser = shared_chromium();
    browser.open(folder / "page1.html");
    CHECK(browser.evaluate("document.documentElement.className") == "has-viewer has-cut");
    CHECK(browser.complaints() == std::vector<std::string>{});
}

namespace {

std::string done(const std::string& command) {
    const Outcome outcome = run_program(command);
    INFO(command << "\n" << outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome.out;
}

std::string hex_of(const std::vector<double>& rho) {
    return fmt::format("#{:02x}{:02x}{:02x}", io::linear_to_srgb8(float(rho[0])), io::linear_to_srgb8(float(rho[1])),
                       io::linear_to_srgb8(float(rho[2])));
}

}  // namespace

TEST_CASE("The page of a calibration shows target and photograph, and the probe tells each square's numbers") {
    const Folder folder("calibration-page");
    const std::string target = folder / "target/target.json";
    done("calibrate target --resins C,K,W --layout B --quiet -o " + folder / "target");
    // Of resins that the program's own are not.
    done(
        fmt::format("calibrate simulate {} --resins {}/examples/07-resins.json --quiet --width 1200 --height 800 "
                    "--tilt-x 8 --turn 20 -o {}",
                    target, source_dir(), folder / "photo.png"));
    done(fmt::format("calibrate photo {} --target {} --picture {} --quiet -o {}", folder / "photo.png", target,
                     folder / "straight.png", folder / "patches.csv"));
    const std::string out =
        done(fmt::format("calibrate check vero-opaque {} --json --target {} --picture {} -o {}", folder / "patches.csv",
                         target, folder / "straight.png", folder / "check.html"));
    const nlohmann::json patches =
        nlohmann::json::parse(out.substr(out.rfind("{\"event\":\"result\""))).at("result").at("patches").at("list");
    const nlohmann::json described = nlohmann::json::parse(read_file(target));
    if (find_chromium().empty()) return skip("there is no Chromium on this machine (Debian: chromium)");
    Chromium& browser = shared_chromium();
    browser.open(folder / "check.html");
    CHECK(browser.evaluate("document.documentElement.className") == "has-viewer");
    CHECK_THAT(text_of(browser, "viewer-looks"), Contains("1 photograph") && Contains("2 measured") &&
                                                     Contains("3 predicted") && Contains("4 difference"));
    (void)browser.evaluate("document.getElementById('viewer-canvas').scrollIntoView({block: 'center'})");
    browser.draw();
    const auto [left, top, width, height] = browser.box("#viewer-canvas");
    const double mm_x = described["size_mm"][0], mm_y = described["size_mm"][1];
    const double px_per_mm = height / (2 * 0.53 * std::max(mm_y, mm_x * height / width));
    REQUIRE(described["squares"].size() == patches.size());
    for (std::size_t s = 0; s < patches.size(); s += 3) {  // a third of the squares, over the whole target
        const std::vector<double> area = described["squares"][s]["area_mm"];
        const double x = left + width / 2 + ((area[0] + area[2]) / 2 - mm_x / 2) * px_per_mm + 4;
        const double y = top + height / 2 - ((area[1] + area[3]) / 2 - mm_y / 2) * px_per_mm + 4;
        const std::string name = patches[s]["patch"];
        CAPTURE(name);
        browser.move(x, y);
        REQUIRE(browser.wait_for(
            fmt::format("document.querySelector('#probe-list dd').textContent === {}", nlohmann::json(name).dump())));
        const std::string measured = hex_of(patches[s]["measured"]), predicted = hex_of(patches[s]["predicted"]);
        CHECK_THAT(text_of(browser, "probe-values"),
                   Contains(measured) && Contains(predicted) &&
                       Contains(fmt::format("{:.2f}", patches[s]["de2000"].get<double>())));
        CHECK_THAT(
            text_of(browser, "probe-mixture"),
            Contains(name.substr(0, name.find(':')) == name ? name.substr(0, name.find(' ')) + " 100 %" : " 10 %"));
        const auto pixel_hex = [&] {
            const auto rgb = browser.pixel(x, y);
            return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
        };
        browser.key("2");
        CHECK(pixel_hex() == measured);
        browser.key("l");  // a picture has no shape that light would show
        CHECK(pixel_hex() == measured);
        browser.key("3");
        CHECK(pixel_hex() == predicted);
        // Space flips to the photograph: near to what was measured of the whole square, grain and dust apart.
        browser.key(" ");
        const auto seen = browser.pixel(x, y);
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(std::abs(int(seen[c]) - int(io::linear_to_srgb8(patches[s]["measured"][c].get<float>()))) <= 40);
    }
    // The list begins with the square that is farthest off; a click shows it.
    const auto worst = std::max_element(patches.begin(), patches.end(), [](const auto& a, const auto& b) {
        return a["de2000"].template get<double>() < b["de2000"].template get<double>();
    });
    const std::string name = (*worst)["patch"];
    CHECK_THAT(browser.evaluate("document.querySelector('ol.worst button.place').innerText").get<std::string>(),
               Contains(name));
    (void)browser.evaluate("document.querySelector('ol.worst button.place').click()");
    CHECK(browser.wait_for(
        fmt::format("document.querySelector('#probe-list dd').textContent === {}", nlohmann::json(name).dump())));
    CHECK(browser.printed_pages() <= 2);
    CHECK(browser.complaints() == std::vector<std::string>{});
    CHECK(browser.requests() == std::vector<std::string>{});
}
