// SPDX-License-Identifier: GPL-3.0-or-later
//
// The report page in a real browser: what it shows, what keys and pointers do, and that it says and asks for nothing.
// Each page leaves a screenshot in the build folder.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <tuple>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/files/whole_file.h"
#include "tests/io/report/chromium.h"
#include "tests/io/report/page_sample.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;
namespace sample = voxtone::test::page_sample;
namespace fs = std::filesystem;
using Catch::Contains;

namespace {

#define NEEDS_CHROMIUM \
    if (find_chromium().empty()) return skip("there is no Chromium on this machine (Debian: chromium)")

const fs::path shots = fs::path(build_dir()) / "report-pages";

fs::path write_page(const std::string& name, const io::Report& report) {
    fs::create_directories(shots);
    io::write_whole_file(shots / (name + ".html"), io::report_html(report));
    return shots / (name + ".html");
}

void keep_shot(Chromium& browser, const std::string& name) {
    io::write_whole_file(shots / (name + ".png"), browser.screenshot());
}

void check_silent(const Chromium& browser) {
    CHECK(browser.complaints() == std::vector<std::string>{});
    CHECK(browser.requests() == std::vector<std::string>{});
}

/// The view in the middle of the window.
std::array<double, 4> bring(Chromium& browser, const std::string& selector) {
    (void)browser.evaluate("document.querySelector('" + selector + "').scrollIntoView({block: 'center'})");
    browser.draw();
    return browser.box(selector);
}

std::string text_of(Chromium& browser, const std::string& selector) {
    return browser.evaluate("document.querySelector('" + selector + "').innerText").get<std::string>();
}

std::string hex(const io::Rgb& rgb) { return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]); }

/// A button of a panel by its text.
void press(Chromium& browser, const std::string& panel, const std::string& text) {
    (void)browser.evaluate("[...document.querySelectorAll('#" + panel + " button')].find((b) => b.textContent === '" +
                           text + "').click()");
    browser.draw();
}

/// Contrast of the texts that are shown, by WCAG 2.1; the worst, and where.
const char* const worst_contrast = R"JS((() => {
  const parse = (text) => text.match(/[\d.]+/g).map(Number);
  const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : Math.pow((c + 0.055) / 1.055, 2.4);
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ground = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const [r, g, b, a = 1] = parse(getComputedStyle(e).backgroundColor);
      if (a > 0.7) return [r, g, b];
    }
    return [255, 255, 255];
  };
  let worst = [21, ""];
  for (const element of document.querySelectorAll("body *")) {
    const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !element.checkVisibility() || element.tagName === "SCRIPT") continue;
    const a = luminance(parse(getComputedStyle(element).color)), b = luminance(ground(element));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < worst[0]) worst = [ratio, element.outerHTML.slice(0, 120)];
  }
  return worst;
})())JS";

}  // namespace

TEST_CASE("The page of a body turns, compares, flips and says nothing to the console") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("body", sample::body()));
    REQUIRE(browser.evaluate("document.documentElement.classList.contains('has-viewer')").get<bool>());
    const auto [left, top, width, height] = bring(browser, "#viewer-canvas");
    const double y = top + height / 2 + 40, near = left + width / 2 - 30, far = left + width / 2 + 30;
    keep_shot(browser, "body");

    // Target left of the divider, print right of it; unlit, so that codes are exact.
    CHECK(browser.pixel(near, y) == sample::target);
    CHECK(browser.pixel(far, y) == sample::print);
    browser.drag(left + width / 2, top + 60, left + width / 2 + 60, top + 60);
    CHECK(browser.pixel(far, y) == sample::target);
    browser.key(" ");
    CHECK(browser.pixel(far, y) == sample::print);
    // One alone.
    browser.key("1");
    CHECK(browser.pixel(near, y) == sample::target);
    CHECK(browser.pixel(far, y) == sample::target);
    browser.key("2");
    CHECK(browser.pixel(near, y) == sample::open_loop);
    browser.key("3");
    CHECK(browser.pixel(near, y) == sample::print);
    browser.key(" ");
    CHECK(browser.pixel(near, y) == sample::target);
    browser.key(" ");
    CHECK(browser.pixel(near, y) == sample::print);
    browser.key("d");
    CHECK(browser.pixel(near, y) == sample::target);

    // False colours: white without a difference at the bottom, 6.0 at the top.
    browser.key("4");
    press(browser, "viewer", "bottom");
    CHECK(browser.pixel(left + width / 2, top + height / 2) == io::Rgb{255, 255, 255});
    press(browser, "viewer", "top");
    const io::Rgb worse = browser.pixel(left + width / 2, top + height / 2);
    CHECK(worse[0] > 200);
    CHECK(worse[1] < 140);
    CHECK(worse[2] < 30);

    // Turning changes nothing on a ball of one colour, its difference it does; reset comes back to the same picture.
    browser.key("0");
    const auto before = browser.screenshot();
    browser.drag(left + 60, top + 60, left + 60, top + 200);
    CHECK(browser.screenshot() != before);
    browser.key("0");
    browser.move(left + width + 20, top - 10);
    browser.key("3");
    // Light shades it.
    browser.key("l");
    CHECK(browser.pixel(near, y) != sample::print);
    browser.key("l");
    CHECK(browser.pixel(near, y) == sample::print);
    check_silent(browser);
}

TEST_CASE("The probe of a body tells what is there") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("probe", sample::body()));
    const auto [left, top, width, height] = bring(browser, "#viewer-canvas");
    press(browser, "viewer", "top");
    browser.move(left + width / 2 + 1, top + height / 2 + 1);
    REQUIRE(browser.wait_for("!document.getElementById('probe-values').hidden"));
    CHECK_THAT(text_of(browser, "#probe-values"), Contains(hex(sample::target)) && Contains(hex(sample::print)));
    // The uppermost ring has 6.0 as seen and 12.0 alone.
    CHECK_THAT(text_of(browser, "#probe-list"), Contains("6.0") && Contains("12.0"));
    // A ball of 8 mm from above, to a voxel; the upper millimetre is cyan.
    const double thickness = std::stod(
        browser
            .evaluate("[...document.querySelectorAll('#probe-list dt')].find((d) => /thickness/.test(d.textContent))"
                      ".nextElementSibling.textContent")
            .get<std::string>());
    CHECK(thickness == Approx(8).margin(0.2));
    const std::string mixture = text_of(browser, "#probe-mixture");
    CHECK_THAT(mixture, Contains("C 100 %"));
    // From below it is white.
    press(browser, "viewer", "bottom");
    browser.move(left + width / 2 + 2, top + height / 2 + 2);
    CHECK(browser.wait_for("/W 100 %/.test(document.getElementById('probe-mixture').innerText)"));
    CHECK_FALSE(browser.evaluate("/C \\d/.test(document.getElementById('probe-mixture').innerText)").get<bool>());
    // Beside the body there is nothing.
    browser.move(left + 5, top + 5);
    CHECK(browser.wait_for("document.getElementById('probe-values').hidden"));
    // The worst place: the camera turns there, and probes it.
    (void)browser.evaluate("document.querySelector('button.place').click()");
    CHECK(browser.wait_for("/ 9\\.00/.test(document.getElementById('probe-list').innerText)"));
    CHECK(browser.wait_for("!document.getElementById('viewer-mark').hidden"));
    const auto mark = browser.box("#viewer-mark"), canvas = browser.box("#viewer-canvas");
    CHECK(mark[0] + mark[2] / 2 == Approx(canvas[0] + canvas[2] / 2).margin(1));
    CHECK(mark[1] + mark[3] / 2 == Approx(canvas[1] + canvas[3] / 2).margin(1));
    // The divider does not lie on it.
    const auto divider = browser.box("#viewer-divider");
    CHECK(divider[0] + divider[2] < mark[0]);
    check_silent(browser);
}

TEST_CASE("The probe of a picture has the numbers of its pixels") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("picture", sample::picture()));
    const auto [left, top, width, height] = bring(browser, "#viewer-canvas");
    keep_shot(browser, "picture");
    // All of 10 x 5 mm in view, as camera.js has it.
    const double half_mm = 0.53 * std::max(5.0, 10.0 * height / width), px_per_mm = height / (2 * half_mm);
    for (const auto& [column, row] : {std::pair{3u, 2u}, {28u, 10u}, {39u, 19u}, {31u, 4u}}) {
        const double x = left + width / 2 + ((column + 0.5) * 0.25 - 5) * px_per_mm;
        const double y = top + height / 2 + ((row + 0.5) * 0.25 - 2.5) * px_per_mm;
        browser.move(x, y);
        CAPTURE(column, row);
        REQUIRE(browser.wait_for(fmt::format("/{}  {}|{}, {}/.test(document.getElementById('probe-list').innerText)",
                                             column, row, column, row)));
        const std::string values = text_of(browser, "#probe-values");
        CHECK_THAT(values, Contains(hex(sample::picture_target(column, row))) &&
                               Contains(hex(sample::picture_print(column, row))));
        CHECK_THAT(values, Contains(fmt::format("{:.1f}", (column + row) / 10.0)) &&
                               Contains(fmt::format("{:.1f}", (2 * column + row) / 10.0)));
        CHECK(browser.pixel(x, y) ==
              (x < left + width / 2 ? sample::picture_target(column, row) : sample::picture_print(column, row)));
    }
    // A wheel zooms after a click, and a drag pans: the pixel under the pointer stays.
    const double pixel = 0.25 * px_per_mm, x = left + width / 2 + (26.5 - 20) * pixel,
                 y = top + height / 2 + (12.5 - 10) * pixel;  // the middle of pixel 26, 12 of 40 x 20
    const auto probes = [&](double at_x, double at_y, int column, int row) {
        browser.move(left + 1, top + 1);
        browser.move(at_x, at_y);
        CAPTURE(at_x - x, at_y - y, column, row);
        CHECK(browser.wait_for(fmt::format("/{}  {}|{}, {}/.test(document.getElementById('probe-list').innerText)",
                                           column, row, column, row),
                               5));
    };
    probes(x, y, 26, 12);
    probes(x + pixel, y + pixel, 27, 13);
    browser.click(x, y);
    browser.wheel(x, y, -600);  // 2^(600/300): four times as large
    probes(x, y, 26, 12);
    probes(x + pixel, y + pixel, 26, 12);
    probes(x + 4 * pixel, y - 4 * pixel, 27, 11);
    browser.drag(left + 100, top + 100, left + 140, top + 120);
    probes(x + 40, y + 20, 26, 12);
    probes(x + 40 - 4 * pixel, y + 20, 25, 12);
    check_silent(browser);
}

TEST_CASE("The cut shows single voxels, layer by layer, by keys and wheel") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("cut", sample::body()));
    const auto [left, top, width, height] = bring(browser, "#cut-canvas");
    const auto shown = [&](const std::string& what) {
        return browser.wait_for("document.getElementById('cut-canvas').dataset.shown === '" + what + "'");
    };
    REQUIRE(shown("2 100 false"));
    CHECK_THAT(text_of(browser, "#cut-label"), Contains("layer 100") && Contains("5.025 mm"));
    // Cyan outside, white inside, nothing around, in the colours of the bitmaps.
    browser.move(left + width / 2, top + height / 2);
    CHECK_THAT(text_of(browser, "#cut-probe"), Contains("White (W)") && Contains("layer 100"));
    CHECK(browser.pixel(left + width / 2, top + height / 2) == io::Rgb{220, 222, 216});
    const double px_per_mm = 0.94 * height / 10;
    browser.move(left + width / 2 + 3.5 * px_per_mm, top + height / 2);
    CHECK_THAT(text_of(browser, "#cut-probe"), Contains("Cyan (C)"));
    CHECK(browser.pixel(left + width / 2 + 3.5 * px_per_mm, top + height / 2) == io::Rgb{0, 150, 200});
    browser.move(left + width / 2 + 4.7 * px_per_mm, top + height / 2);
    CHECK_THAT(text_of(browser, "#cut-probe"), Contains("nothing"));
    // The next layer is carried whole; its bitmap is a click away.
    browser.click(left + 3, top + 3);
    browser.key("ArrowUp");
    CHECK(shown("2 101 true"));
    CHECK(browser.evaluate("document.querySelector('#cut-link a').getAttribute('href')") == "layers/slice_00101.png");
    browser.wheel(left + width / 2, top + height / 2, 100);
    CHECK(shown("2 100 false"));
    browser.key("End");
    CHECK(shown("2 199 false"));
    // Upright, and in the body above.
    press(browser, "cut", "front");
    CHECK(shown("1 50 false"));
    browser.move(left + width / 2, top + height / 2 - 3.5 * px_per_mm);
    CHECK_THAT(text_of(browser, "#cut-probe"), Contains("Cyan (C)"));
    browser.move(left + width / 2, top + height / 2 + 3.5 * px_per_mm);
    CHECK_THAT(text_of(browser, "#cut-probe"), Contains("White (W)"));
    keep_shot(browser, "cut");
    press(browser, "cut", "Cut the body above");
    const auto view = bring(browser, "#viewer-canvas");
    press(browser, "viewer", "front");
    browser.key("1");
    CHECK(browser.pixel(view[0] + view[2] / 2 + 20, view[1] + view[3] / 2 + 20) == io::Rgb{220, 222, 216});
    check_silent(browser);
}

TEST_CASE("The page can be used by keys alone and read by weak eyes") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("keys", sample::body()));
    std::set<std::string> reached;
    for (int i = 0; i < 60; ++i) {
        browser.key("Tab");
        reached.insert(
            browser
                .evaluate("(document.activeElement.id || document.activeElement.textContent.trim()) + "
                          "(getComputedStyle(document.activeElement).outlineStyle === 'none' ? ' unseen' : '')")
                .get<std::string>());
    }
    for (const char* name :
         {"1 target", "3 print", "4 difference", "viewer-compare", "viewer-lit", "viewer-reset", "top", "viewer-canvas",
          "viewer-divider", "layer", "cut-slider", "cut-closer", "cut-canvas"}) {
        CAPTURE(name);
        CHECK(reached.count(name) == 1);
    }
    // The divider, the view and the probe by keys.
    (void)browser.evaluate("document.getElementById('viewer-divider').focus()");
    browser.key("Home");
    CHECK(browser.evaluate("document.getElementById('viewer-divider').getAttribute('aria-valuenow')") == "0");
    browser.key("ArrowRight");
    CHECK(browser.evaluate("document.getElementById('viewer-divider').getAttribute('aria-valuenow')") == "2");
    (void)browser.evaluate("document.getElementById('viewer-canvas').focus()");
    browser.key("p");
    CHECK(browser.wait_for("!document.getElementById('probe-values').hidden"));
    const std::string middle = text_of(browser, "#probe-list");
    browser.key("ArrowLeft");
    browser.key("p");
    CHECK(browser.wait_for("document.getElementById('probe-list').innerText !== " + nlohmann::json(middle).dump()));
    (void)browser.evaluate("document.querySelector('details summary').click()");
    for (const char* scheme : {"light", "dark"}) {
        browser.prefer(scheme);
        const nlohmann::json worst = browser.evaluate(worst_contrast);
        CAPTURE(scheme, worst.dump());
        CHECK(worst[0].get<double>() >= 4.5);
    }
    check_silent(browser);
}

TEST_CASE("Fingers turn, spread and shift the view, and not the page") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    browser.open(write_page("fingers", sample::body()));
    const auto [left, top, width, height] = bring(browser, "#viewer-canvas");
    const double x = left + width / 4, y = top + height / 2;
    browser.key("4");
    const std::string scale = text_of(browser, "#viewer .viewer-scale");
    const double scrolled = browser.evaluate("window.scrollY").get<double>();
    const auto before = browser.screenshot();
    browser.touch({{x, y}}, {{x, y + 150}});
    CHECK(browser.screenshot() != before);
    CHECK(text_of(browser, "#viewer .viewer-scale") == scale);
    // Four times as far apart.
    browser.touch({{x, y}, {x + 50, y}}, {{x - 75, y}, {x + 125, y}});
    CHECK(text_of(browser, "#viewer .viewer-scale") != scale);
    CHECK(browser.evaluate("window.scrollY").get<double>() == scrolled);
    CHECK(browser.evaluate("window.visualViewport.scale").get<double>() == 1);
    check_silent(browser);
}

TEST_CASE("Without WebGL the page shows today's pictures, and the cut all the same") {
    NEEDS_CHROMIUM;
    Chromium browser({"--disable-3d-apis"});
    browser.open(write_page("without-webgl", sample::body()));
    keep_shot(browser, "without-webgl");
    CHECK(browser.evaluate("document.getElementById('viewer').hidden").get<bool>());
    CHECK(browser.evaluate("document.querySelector('section.views').checkVisibility()").get<bool>());
    CHECK(browser.evaluate("document.getElementById('cut').checkVisibility()").get<bool>());
    CHECK(browser.evaluate("document.getElementById('cut-in-view').hidden").get<bool>());
    check_silent(browser);
}

TEST_CASE("The page prints on two sheets, without its tools") {
    NEEDS_CHROMIUM;
    Chromium& browser = shared_chromium();
    io::Report report = sample::body();
    for (int i = 0; i < 8; ++i) report.viewer.worst.push_back(report.viewer.worst[std::size_t(i)]);
    browser.open(write_page("printed", report));
    const std::size_t pages = browser.printed_pages();
    CHECK(pages >= 1);
    CHECK(pages <= 2);
    // What one clicks and drags is on the screen alone; what it told of, the worst places, is on paper too.
    const auto seen = [&](const std::string& selector) {
        return browser
            .evaluate("[...document.querySelectorAll('" + selector + "')].filter((e) => e.checkVisibility()).length")
            .get<int>();
    };
    const std::string tools = ".screen-only, input, canvas, .tabs, .keys, button:not(.place)";
    CHECK(seen(tools) > 5);
    browser.prefer_media("print");
    CHECK(seen(tools) == 0);
    CHECK(seen("button.place") > 0);
    CHECK(seen("section.views") == 1);
}

TEST_CASE("Pages of one and of eight megabytes open soon") {
    NEEDS_CHROMIUM;
    for (const auto& [name, rings, least, most] :
         {std::tuple{"one-megabyte", 180, 0.6e6, 1.5e6}, {"eight-megabytes", 281, 6.5e6, 8.1e6}}) {
        io::Report report = sample::body(rings);
        // What does not become smaller: noise.
        std::uint32_t state = 1;
        const auto noise = [&state] { return std::uint8_t((state = state * 1664525 + 1013904223) >> 24); };
        for (io::ViewerLook& look : report.viewer.surface->looks)
            for (std::uint8_t& code : look.rgb) code = noise();
        if (most > 2e6)
            for (io::ViewerLayer& layer : report.viewer.voxels->layers) {
                std::vector<std::byte> bytes(25 * 100 * 15);
                for (std::byte& byte : bytes) byte = std::byte(noise());
                layer.deflated = io::deflated(bytes, 1);
            }
        const fs::path page = write_page(name, report);
        CAPTURE(name, fs::file_size(page));
        CHECK(double(fs::file_size(page)) > least);
        CHECK(double(fs::file_size(page)) < most);
        Chromium& browser = shared_chromium();
        const double seconds = browser.open(page);
        CAPTURE(seconds);
        CHECK(seconds > 0);
        // What a user is promised; beside other tests and without a GPU it may take any time.
        WANTED(seconds < 1);
        // What nobody looks at first is unpacked after it.
        CHECK(browser.evaluate("Number(document.documentElement.dataset.ready) / 1000").get<double>() > seconds);
        CHECK(browser.evaluate("document.documentElement.classList.contains('has-viewer')").get<bool>());
        check_silent(browser);
    }
}
