// SPDX-License-Identifier: GPL-3.0-or-later
//
// The marker, as its bitmaps are read back: it looks like itself in one way only, and each resin lies in its square.
#include "slicer/print/marker_print.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/layers/stack_reader.h"
#include "io/layers/verify.h"
#include "marker_picture.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Contains;
using voxtone::io::TemporaryFolder;
using voxtone::io::text_of;
namespace fs = std::filesystem;

namespace {

constexpr int edge = 64;  // of a look at it, in cells of 1 mm

/// What is seen of the marker, [y][x] in mm from its corner; y upward.
using Look = std::array<std::array<io::Material, edge>, edge>;

struct Marker {
    Look above{}, below{};
    std::array<std::array<int, edge>, edge> top{};  ///< layer, -1: none
    std::vector<std::uint64_t> voxels;              ///< of each material
    int layers = 0;
    double width_mm = 0, depth_mm = 0;
};

/// As the model lies: rows of bitmaps run towards the front.
Marker look_at(const fs::path& out) {
    const io::StackReader reader(out);
    const io::StackDescription& stack = *reader.description();
    Marker marker;
    marker.voxels.resize(stack.resins.size() + 1);
    marker.layers = int(reader.layers());
    marker.width_mm = stack.size_mm[0], marker.depth_mm = stack.size_mm[1];
    for (auto& row : marker.top) row.fill(-1);
    for (std::uint32_t k = 0; k < reader.layers(); ++k) {
        const io::LayerRuns layer = reader.read(k, stack.palette());
        for (std::uint32_t y = 0; y < layer.rows(); ++y) {
            std::uint32_t x = 0;
            const double mm = stack.size_mm[1] - (y + 0.5) * stack.pitch_um[1] * 1e-3;
            const int row = int(mm);
            const bool is_middle = std::abs(mm - row - 0.5) <= 0.05;
            for (const io::Run run : layer.row(y)) {
                marker.voxels[run.material] += run.length;
                for (int cell = 0; is_middle && run.material != io::background && cell < edge; ++cell) {
                    // The middle of the cell.
                    const auto column = std::uint32_t((cell + 0.5) * 1000 / stack.pitch_um[0]);
                    if (column < x || column >= x + run.length) continue;
                    marker.above[std::size_t(row)][std::size_t(cell)] = io::Material(run.material);
                    marker.top[std::size_t(row)][std::size_t(cell)] = int(k);
                    if (k == 0) marker.below[std::size_t(row)][std::size_t(cell)] = io::Material(run.material);
                }
                x += run.length;
            }
        }
    }
    return marker;
}

/// The eight ways in which a bitmap can come out; square, so that all can be compared.
std::set<Look> all_ways(const Look& look) {
    std::set<Look> ways;
    for (int way = 0; way < 8; ++way) {
        Look turned{};
        for (std::size_t y = 0; y < edge; ++y)
            for (std::size_t x = 0; x < edge; ++x) {
                const std::size_t a = way & 1 ? edge - 1 - x : x, b = way & 2 ? edge - 1 - y : y;
                turned[y][x] = way & 4 ? look[a][b] : look[b][a];
            }
        ways.insert(turned);
    }
    return ways;
}

/// Only what is of another material than the plate.
Look signs_of(const Look& look, io::Material plate) {
    Look signs{};
    for (std::size_t y = 0; y < edge; ++y)
        for (std::size_t x = 0; x < edge; ++x) signs[y][x] = look[y][x] == plate ? io::background : look[y][x];
    return signs;
}

/// What is seen of the boxes in cells of half a millimetre, the back first: a letter for each resin but the plate's,
/// a space where there is nothing. Of the voxels from `low_mm` to `high_mm`, those on top.
std::string drawn(const BoxPrint& print, double low_mm, double high_mm) {
    std::string text;
    for (int y = int(std::lround(print.size_mm.y() * 2)) - 1; y >= 0; --y) {
        std::string row;
        for (int x = 0; x < int(std::lround(print.size_mm.x() * 2)); ++x) {
            double top = 0;
            char seen = ' ';
            for (const PrintBox& box : print.boxes) {
                const double at_x = x / 2.0 + 0.25, at_y = y / 2.0 + 0.25;
                if (at_x < box.min_mm.x() || at_x > box.max_mm.x() || at_y < box.min_mm.y() || at_y > box.max_mm.y() ||
                    box.min_mm.z() > high_mm || box.max_mm.z() < low_mm || std::min(box.max_mm.z(), high_mm) < top)
                    continue;
                top = std::min(box.max_mm.z(), high_mm);
                const auto resin = std::size_t(std::ranges::max_element(box.fractions) - box.fractions.begin());
                seen = print.roles[resin] == "W" ? '.' : print.roles[resin][0];
            }
            row += seen;
        }
        text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("The marker's picture, from above and in its lowest layers") {
    const BoxPrint print = marker_boxes({"C", "M", "Y", "K", "W"}, find_printer("stratasys-j750-hm"));
    CHECK((drawn(print, 0, 99) == test::marker_from_above));
    const std::string lowest = drawn(print, 0, 0.3), bare(104, '.');
    std::string wanted;
    for (int row = 0; row < 64; ++row)
        wanted += row == 30 ? test::marker_from_below : row > 30 && row < 44 ? "" : bare + "\n";
    CHECK((lowest == wanted));
    CHECK(print.size_mm == Eigen::Vector3d(52, 32, 4.5));
    // A printer that loads neither white nor black takes its lightest and its darkest.
    const BoxPrint others = marker_boxes({"M", "Y", "C"}, find_printer("stratasys-j750-hm"));
    CHECK(others.boxes[0].fractions == std::vector<double>{0, 1, 0});  // the plate, of yellow
    CHECK(others.boxes[1].fractions[1] == 0);
    // What is higher than the plate, and how deep squares and letters go.
    for (const PrintBox& box : print.boxes) {
        const double low = box.min_mm.z(), high = box.max_mm.z();
        const bool known = (low == 0 && (high == 3 || high == 0.6)) || (low == 3 && (high == 3.5 || high == 4.5)) ||
                           (low == 1.5 && high == 3.5) || (low == 3.5 - 0.6 && high == 3.5);
        CHECK(known);
    }
}

TEST_CASE("The marker is whole for every printer, and each resin lies raised in its square", "[slow]") {
    TemporaryFolder folder;
    Progress progress;
    for (const PrinterProfile& printer : list_printers()) {
        CAPTURE(printer.id);
        MarkerJob job;
        job.out = (folder.path() / printer.id).string();
        job.printer = printer.id;
        (void)run_marker_job(job, progress);
        io::VerifyRules rules;
        rules.most_colours = std::uint32_t(printer.max_colours);
        rules.least_layers = std::uint32_t(printer.min_layers);
        rules.pitch_um = {printer.pitch_um.x(), printer.pitch_um.y(), printer.pitch_um.z()};
        CHECK(io::verify_stack(job.out, rules).passed());
        CHECK(io::verify_stack(fs::path(job.out) / "printer", rules).passed());
        const Marker marker = look_at(job.out);
        const double voxel_mm3 = printer.pitch_um.prod() * 1e-9;
        for (std::size_t m = 1; m < marker.voxels.size(); ++m)
            CHECK(double(marker.voxels[m]) * voxel_mm3 > 6 * 6 * 2 * 0.6);  // but for its letter and edges
        // Squares of 6 mm from (23, 13) on, in rows of four: their lower edges are free of letters.
        for (std::size_t m = 1; m < marker.voxels.size(); ++m) {
            const std::size_t x = 23 + 7 * ((m - 1) % 4), y = 13 - 7 * ((m - 1) / 4);
            CHECK(marker.above[y][x + 2] == m);
            CHECK(marker.top[y][x + 2] > marker.top[1][30]);  // than the plate
        }
    }
}

TEST_CASE("The marker looks like itself in one way only, from above and from below") {
    TemporaryFolder folder;
    Progress progress;
    MarkerJob job;
    job.out = (folder.path() / "m").string();
    (void)run_marker_job(job, progress);
    const Marker marker = look_at(job.out);
    CHECK(marker.width_mm == Approx(52).margin(0.05));
    CHECK(marker.depth_mm == Approx(32).margin(0.05));
    const io::Material black = 4, white = 5;  // C, M, Y, K, W
    CHECK(all_ways(marker.above).size() == 8);
    CHECK(all_ways(signs_of(marker.above, white)).size() == 8);  // not by its outline alone
    CHECK(all_ways(signs_of(marker.below, white)).size() == 8);
    // The tower stands where x and y begin, and is the highest.
    for (std::size_t y = 0; y < edge; ++y)
        for (std::size_t x = 0; x < edge; ++x) CHECK((marker.top[y][x] == marker.layers - 1) == (x < 5 && y < 5));
    // F: stroke on the left, bars at the top and in the middle, the lower one shorter.
    for (std::size_t y = 10; y < 28; ++y) CHECK(marker.above[y][9] == black);
    CHECK(marker.above[26][18] == black);
    CHECK(marker.above[18][15] == black);
    CHECK(marker.above[18][18] == white);
    CHECK(marker.above[13][15] == white);
    // BOTTOM is read from below: its B, whose back is straight, ends at the right as seen from above.
    for (std::size_t y = 10; y < 17; ++y) CHECK(marker.below[y][43] == black);
    CHECK(marker.below[11][39] == black);  // the belly of the B, to the left of its back
    CHECK(marker.below[13][39] == white);  // between its bellies
    CHECK(marker.above[12][43] != black);
    std::size_t letters_above = 0;
    for (std::size_t x = 9; x < 44; ++x) letters_above += marker.below[13][x] == black;
    CHECK(letters_above > 6);
}

TEST_CASE("A printer that mirrors gets the marker mirrored back") {
    TemporaryFolder folder;
    Progress progress;
    PrinterProfile printer = find_printer("stratasys-j750-hm");
    const BoxPrint print = marker_boxes({"C", "K", "W"}, printer);
    (void)print_boxes(print, printer, folder.path() / "plain", {}, false, progress);
    printer.orientation.flip_x = true;
    (void)print_boxes(print, printer, folder.path() / "mirrored", {}, false, progress);
    const io::StackReader plain(folder.path() / "plain"), mirrored(folder.path() / "mirrored");
    REQUIRE(plain.layers() == mirrored.layers());
    const auto palette = plain.palette();
    const auto row_of = [](std::span<const io::Run> runs, bool backward) {
        std::vector<io::Material> row;
        for (const io::Run run : runs) row.insert(row.end(), run.length, io::Material(run.material));
        if (backward) std::reverse(row.begin(), row.end());
        return row;
    };
    for (std::uint32_t k = 0; k < plain.layers(); k += 10) {
        const io::LayerRuns a = plain.read(k, palette), b = mirrored.read(k, palette);
        for (std::uint32_t y = 0; y < a.rows(); ++y) CHECK(row_of(a.row(y), false) == row_of(b.row(y), true));
    }
    // The page's picture is of the print as it will lie, and the same for both.
    const auto picture_of = [](const fs::path& out) {
        const std::string page = text_of(out / "printer/HOW-TO-PRINT.html");
        const std::size_t at = page.find("base64,");
        REQUIRE(at != std::string::npos);
        return page.substr(at, page.find('"', at) - at);
    };
    CHECK(picture_of(folder.path() / "plain") == picture_of(folder.path() / "mirrored"));
    CHECK_THAT(text_of(folder.path() / "mirrored/printer/HOW-TO-PRINT.html"), Contains("columns mirrored (flip_x)"));
}

TEST_CASE("A marker of one resin, of one named twice, or of too many is refused") {
    const PrinterProfile printer = find_printer("generic");
    CHECK_THROWS_WITH(marker_boxes({"W"}, printer), Contains("of 1 resins"));
    CHECK_THROWS_WITH(marker_boxes({"W", "W"}, printer), Contains("'W' is named twice"));
    CHECK_THROWS_AS(marker_boxes({"1", "2", "3", "4", "5", "6", "7", "8", "9"}, printer), InputError);
    CHECK_NOTHROW(marker_boxes({"Agilus", "lilac", "3", "4", "5", "6", "7", "8"}, printer));
    Progress progress;
    MarkerJob job;
    CHECK_THROWS_AS(run_marker_job(job, progress), UsageError);
    TemporaryFolder folder;
    job.out = (folder.path() / "m").string();
    job.printer = "stratasys-j750-hs";
    job.roles = {"C", "M", "Y", "K", "W"};
    CHECK_THROWS_WITH(run_marker_job(job, progress), Contains("carries 3 at once"));
    CHECK_FALSE(fs::exists(job.out));
}
