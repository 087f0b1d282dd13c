// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/printed_codes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "drawn_page.h"
#include "io/lettering/make_code.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr double module_mm = 0.4;

/// On a page of 16 x 14 mm, its lower left corner 3 mm from the left and 2 mm above the edge.
JobPrediction page_with(const io::CodeSymbol& code) {
    return test::page_of(16, 14, [&](double x, double y) {
        const int column = int(std::floor((x - 3) / module_mm)),
                  row = code.rows - 1 - int(std::floor((y - 2) / module_mm));
        const bool is_dark = column >= 0 && row >= 0 && column < code.columns && row < code.rows &&
                             code.dark[std::size_t(row * code.columns + column)];
        return Eigen::Vector3f::Constant(is_dark ? 0.01f : 0.95f);
    });
}

/// Light that spreads: what a Gaussian of this standard deviation leaves, by its own sum over cells.
std::vector<Eigen::Vector3f> blurred(const JobPrediction& p, double sigma_mm) {
    const auto& cells = p.predicted.surface.cells;
    std::vector<Eigen::Vector3f> out(cells.size());
    const int reach = int(std::ceil(3 * sigma_mm / test::drawn_cell_mm));
    int columns = 0, rows = 0;
    for (const auto& cell : cells)
        columns = std::max(columns, cell.cell[0] + 1), rows = std::max(rows, cell.cell[1] + 1);
    std::vector<std::size_t> at(std::size_t(columns * rows));
    for (std::size_t i = 0; i < cells.size(); ++i) at[std::size_t(cells[i].cell[1] * columns + cells[i].cell[0])] = i;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        float all = 0;
        for (int dy = -reach; dy <= reach; ++dy)
            for (int dx = -reach; dx <= reach; ++dx) {
                const int x = cells[i].cell[0] + dx, y = cells[i].cell[1] + dy;
                if (x < 0 || y < 0 || x >= columns || y >= rows) continue;
                const double r = std::hypot(dx, dy) * test::drawn_cell_mm / sigma_mm;
                const auto weight = float(std::exp(-r * r / 2));
                sum += weight * p.target[at[std::size_t(y * columns + x)]], all += weight;
            }
        out[i] = sum / all;
    }
    return out;
}

}  // namespace

TEST_CASE("A code that comes out as asked is read, one that runs together is not, and its place is told") {
    const io::CodeSymbol code = io::make_code(io::CodeKind::qr, "https://example.org/anna");
    JobPrediction page = page_with(code);
    auto found = printed_codes(page);
    REQUIRE(found.size() == 1);
    CHECK(found[0].kind == "QR code");
    CHECK(found[0].is_read);
    const double edge = code.columns * module_mm;
    CHECK(found[0].width_mm == Approx(edge).margin(2 * module_mm));
    CHECK(found[0].height_mm == Approx(edge).margin(2 * module_mm));
    CHECK(found[0].module_mm == Approx(module_mm).epsilon(0.08));
    for (const std::uint32_t i : found[0].cells) {
        const auto& c = page.predicted.surface.cells[i].centre_mm;
        CHECK((c[0] > 3 - module_mm && c[0] < 3 + edge + module_mm && c[1] > 2 - module_mm &&
               c[1] < 2 + edge + module_mm));
    }
    page.predicted.rgb = blurred(page, module_mm);
    found = printed_codes(page);
    REQUIRE(found.size() == 1);
    CHECK_FALSE(found[0].is_read);
    // A little of it is no harm.
    page.predicted.rgb = blurred(page, module_mm / 4);
    CHECK(printed_codes(page).at(0).is_read);
}

namespace {

using Bars = std::vector<std::pair<double, double>>;  ///< from, to

/// Code 39: nine elements a character, bars and spaces in turns, three of them wide; from 4 mm on.
Bars bars_of(const std::string& text) {
    const std::map<char, std::string> wide{{'*', "nwnnwnwnn"}, {'A', "wnnnnwnnw"}, {'0', "nnnwwnwnn"},
                                           {'1', "wnnwnnnnw"}, {'4', "nnnwwnnnw"}, {'7', "nnnwnnwnw"}};
    Bars bars;
    double x = 4;
    for (const char c : "*" + text + "*") {
        for (std::size_t n = 0; n < 9; ++n) {
            const double width = wide.at(c)[n] == 'w' ? 0.9 : 0.34;
            if (n % 2 == 0) bars.emplace_back(x, x + width);
            x += width;
        }
        x += 0.34;
    }
    return bars;
}

bool is_bar(const Bars& bars, double at) {
    return std::ranges::any_of(bars, [&](const auto& bar) { return at >= bar.first && at < bar.second; });
}

}  // namespace

TEST_CASE("The bars of a price tag are a code, those of three characters alone are none") {
    const auto page_of = [&](const std::string& text) {
        const Bars bars = bars_of(text);
        return test::page_of(bars.back().second + 4, 14, [&](double at, double y) {
            return Eigen::Vector3f::Constant(y > 3 && y < 11 && is_bar(bars, at) ? 0.01f : 0.95f);
        });
    };
    JobPrediction page = page_of("A1047");
    auto found = printed_codes(page);
    REQUIRE(found.size() == 1);
    CHECK(found[0].kind == "bar code");
    CHECK(found[0].is_read);
    // Narrow bars of 0.34 mm: so far a scanner that looks for edges reads them.
    page.predicted.rgb = blurred(page, 0.2);
    CHECK(printed_codes(page).at(0).is_read);
    page.predicted.rgb = blurred(page, 0.6);
    CHECK_FALSE(printed_codes(page).at(0).is_read);
    CHECK(printed_codes(page_of("A10")).empty());
}

TEST_CASE("Equal bars on one page are codes each, as high as they are, lying or standing") {
    const Bars bars = bars_of("A1047");
    const double wide = bars.back().second + 4;
    const std::array<std::array<double, 2>, 2> heights{{{3, 6}, {9, 14}}};
    for (const bool stand : {false, true}) {
        const auto colour = [&](double along, double across) {
            const bool lies =
                std::ranges::any_of(heights, [&](const auto& h) { return across > h[0] && across < h[1]; });
            return Eigen::Vector3f::Constant(lies && is_bar(bars, along) ? 0.01f : 0.95f);
        };
        const JobPrediction page = stand ? test::page_of(17, wide, [&](double x, double y) { return colour(y, x); })
                                         : test::page_of(wide, 17, [&](double x, double y) { return colour(x, y); });
        const auto found = printed_codes(page);
        CAPTURE(stand);
        REQUIRE(found.size() == 2);
        std::vector<double> high;
        for (const PrintedCode& code : found) {
            CHECK(code.is_read);
            CHECK((stand ? code.height_mm : code.width_mm) == Approx(wide - 8).margin(0.6));
            high.push_back(stand ? code.width_mm : code.height_mm);
        }
        std::ranges::sort(high);
        CHECK(high[0] == Approx(3).margin(0.3));
        CHECK(high[1] == Approx(5).margin(0.3));
    }
}

TEST_CASE("Of an EAN-13 the modules are measured, however high it is") {
    // By ISO/IEC 15420: digits of the left half in two sets, whose order says the first one.
    constexpr std::array<const char*, 10> odd{"0001101", "0011001", "0010011", "0111101", "0100011",
                                              "0110001", "0101111", "0111011", "0110111", "0001011"};
    const std::string digits = "4006381333931", sets = "OEOOEE";
    const auto turned = [](std::string bars, bool mirror) {
        for (char& bar : bars) bar = bar == '0' ? '1' : '0';
        if (mirror) std::ranges::reverse(bars);
        return bars;
    };
    std::string bars = "101";
    for (std::size_t n = 1; n < 13; ++n) {
        const std::string digit = odd[std::size_t(digits[n] - '0')];
        bars += n > 6 ? turned(digit, false) : sets[n - 1] == 'O' ? digit : turned(digit, true);
        if (n == 6) bars += "01010";
    }
    bars += "101";
    constexpr double wide_mm = 0.42;
    for (const double high : {8.0, 60.0}) {
        const JobPrediction page = test::page_of(10 + 95 * wide_mm, high + 6, [&](double x, double y) {
            const int at = int(std::floor((x - 5) / wide_mm));
            const bool is_dark =
                at >= 0 && at < int(bars.size()) && bars[std::size_t(at)] == '1' && y > 3 && y < high + 3;
            return Eigen::Vector3f::Constant(is_dark ? 0.01f : 0.95f);
        });
        const auto found = printed_codes(page);
        CAPTURE(high);
        REQUIRE(found.size() == 1);
        CHECK(found[0].module_mm == Approx(wide_mm).epsilon(0.03));
        CHECK(found[0].height_mm == Approx(high).margin(0.3));
    }
}

TEST_CASE("A code that reads as another is not the one that was asked for, and what is no code is none") {
    JobPrediction page = page_with(io::make_code(io::CodeKind::qr, "lot 1"));
    const JobPrediction other = page_with(io::make_code(io::CodeKind::qr, "lot 2"));
    page.predicted.rgb = other.target;
    const auto found = printed_codes(page);
    REQUIRE(found.size() == 1);
    CHECK_FALSE(found[0].is_read);
    const JobPrediction bars = test::page_of(
        8, 6, [](double x, double) { return Eigen::Vector3f::Constant(std::fmod(x, 0.8) < 0.4 ? 0.02f : 0.9f); });
    CHECK(printed_codes(bars).empty());
}

TEST_CASE("A Data Matrix is a code, too, wherever on the page it lies") {
    const JobPrediction page = page_with(io::make_code(io::CodeKind::data_matrix, "VX-100"));
    const auto found = printed_codes(page);
    REQUIRE(found.size() == 1);
    CHECK(found[0].kind == "Data Matrix");
    CHECK(found[0].is_read);
    for (const std::uint32_t i : found[0].cells) CHECK(page.predicted.surface.cells[i].centre_mm[0] < 8);
}
