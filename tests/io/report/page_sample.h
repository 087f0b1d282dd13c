// SPDX-License-Identifier: GPL-3.0-or-later
//
// Report pages whose every place is known.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "io/files/deflate.h"
#include "io/pictures/picture_writer.h"
#include "io/report/report_html.h"

namespace voxtone::test::page_sample {

inline constexpr double side_mm = 10;
inline constexpr io::Rgb target{200, 40, 30}, open_loop{30, 160, 40}, print{40, 60, 210};

/// A report with all its parts but the viewer.
inline io::Report report(const std::string& title) {
    io::Report report;
    report.title = title;
    report.program_version = "0.0.0";
    report.printer_id = "sample";
    report.printer_name = "a printer of samples";
    report.pitch_um = {100, 100, 50};
    report.size_mm = {side_mm, side_mm, side_mm};
    report.size_px = {100, 100, 200};
    report.resins = {{"Cyan", "C", "", {0, 150, 200}, 1000, 1.5}, {"White", "W", "", {220, 222, 216}, 9000, 13.5}};
    report.warnings.assign(
        7, "a warning in words that is about as long as those that there are, with what to do about it");
    report.stages = {{"layers", 1}};
    report.verdict = io::ReportVerdict{
        .level = io::VerdictLevel::fair,
        .sentence = "It will look much as asked.",
        .seen_mean = 3.0,
        .seen_p95 = 6.0,
        .reach_mean = std::nullopt,
        .viewing_distance_mm = 300,
        .good_up_to = 2.5,
        .bad_above = 5,
        .off_share = 0.3,
        .causes = {{"thin walls", 1.0}},
        .advice = {{"print it larger (--size 20mm): then about 2.0", "--size 20mm", "seen_de2000", 3.0, 2.0}},
        .seen_histogram = {{0, 0.5}, {1, 0.3}, {2, 0.2}}};
    const io::Picture8 pixels{40, 40, 4, std::vector<std::uint8_t>(40 * 40 * 4, 200)};
    const io::ReportPicture picture{"target", io::png_bytes(pixels), 40, 40, 4};
    report.views.clear();
    for (const char* side : {"three-quarter", "front", "right", "back", "left", "top", "bottom"})
        report.views.push_back({side, {picture, picture, picture, picture}});
    report.layers = {{0, 0.025, picture}, {100, 5.025, picture}};
    report.job = {{"model", title}};
    return report;
}

inline io::ViewerLook look(const char* name, const io::Rgb& rgb, std::size_t places) {
    io::ViewerLook look{name, name, {}};
    for (std::size_t i = 0; i < places; ++i) look.rgb.insert(look.rgb.end(), rgb.begin(), rgb.end());
    return look;
}

/// A ball of 8 mm in the middle of the box, in rings: seen differences rise by 0.1 from the lowest ring to the highest.
inline io::ViewerSurface ball(int rings) {
    io::ViewerSurface s;
    s.low_mm = {1, 1, 1};
    s.high_mm = {9, 9, 9};
    s.place_mm = 8 * std::numbers::pi / 2 / rings;
    const int around = 2 * rings;
    const auto code = [](double x) { return std::uint16_t(std::lround(65535 * (x + 1) / 2)); };
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < around; ++j) {
            const double polar = std::numbers::pi * (1 - double(i) / rings), turn = 2 * std::numbers::pi * j / around;
            for (const double x : {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)})
                s.positions.push_back(code(x));
            s.seen.push_back(std::uint8_t(std::min(255, i)));
            s.single.push_back(std::uint8_t(std::min(255, 2 * i)));
        }
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const auto at = [&](int ring, int place) { return std::uint32_t(ring * around + place % around); };
            for (const std::uint32_t corner :
                 {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)})
                s.triangles.push_back(corner);
        }
    const std::size_t places = s.seen.size();
    s.looks = {look("target", target, places), look("open loop", open_loop, places), look("print", print, places)};
    s.note = "A ball.";
    return s;
}

/// The same ball in voxels of 0.1 x 0.1 x 0.05 mm: white, its outermost millimetre cyan above the middle; every second
/// along x and z.
inline io::ViewerVoxels ball_voxels() {
    io::ViewerVoxels v;
    v.size = {100, 100, 200};
    v.pitch_mm = {0.1, 0.1, 0.05};
    v.step = {2, 1, 2};
    v.layer_file = "layers/slice_%05d.png";
    const auto layer_of = [&](std::uint32_t k, std::uint32_t step) {
        const std::uint32_t columns = 100 / step, row_bytes = (columns + 1) / 2;
        std::vector<std::byte> bytes(std::size_t{row_bytes} * 100);
        for (std::uint32_t row = 0; row < 100; ++row)
            for (std::uint32_t column = 0; column < columns; ++column) {
                const double x = (column * step + 0.5) * 0.1 - 5, y = (99 - row + 0.5) * 0.1 - 5,
                             z = (k + 0.5) * 0.05 - 5;
                const double r = std::hypot(x, y, z);
                const int material = r > 4 ? 0 : r > 3 && z > 0 ? 1 : 2;
                bytes[row * row_bytes + column / 2] |= std::byte(material << (column % 2 ? 4 : 0));
            }
        return io::ViewerLayer{k, io::deflated(bytes, 6)};
    };
    for (std::uint32_t k = 0; k < 200; k += 2) v.layers.push_back(layer_of(k, 2));
    v.whole = {layer_of(101, 1)};
    return v;
}

inline io::Report body(int rings = 60) {
    io::Report report = page_sample::report("a ball");
    report.viewer.surface = ball(rings);
    report.viewer.voxels = ball_voxels();
    report.viewer.viewing_distance_mm = 300;
    report.viewer.worst = {{{5, 5, 9}, {0, 0, 1}, 12.3, target, print, "thin walls, 0.4 mm", "make it thicker"},
                           {{9, 5, 5}, {1, 0, 0}, 7.5, target, print, "colours out of the resins' reach", "load K"}};
    return report;
}

inline constexpr std::uint32_t columns = 40, rows = 20;

/// Codes of a pixel of the picture, all different.
inline io::Rgb picture_target(std::uint32_t column, std::uint32_t row) {
    return {std::uint8_t(5 * column), std::uint8_t(10 * row), 77};
}
inline io::Rgb picture_print(std::uint32_t column, std::uint32_t row) {
    return {std::uint8_t(5 * column + 20), std::uint8_t(10 * row + 30), 99};
}

/// 10 x 5 mm; one corner is not covered.
inline io::Report picture() {
    io::Report report = page_sample::report("a picture");
    io::ViewerSurface s;
    s.size_px = {columns, rows};
    s.low_mm = {0, 0, 0};
    s.high_mm = {10, 5, 2};
    s.place_mm = 0.25;
    s.looks = {{"target", "", {}}, {"print", "", {}}};
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const io::Rgb a = picture_target(column, row), b = picture_print(column, row);
            s.looks[0].rgb.insert(s.looks[0].rgb.end(), a.begin(), a.end());
            s.looks[1].rgb.insert(s.looks[1].rgb.end(), b.begin(), b.end());
            s.seen.push_back(std::uint8_t(column + row));
            s.single.push_back(std::uint8_t(2 * column + row));
            s.covered.push_back(column == 0 && row == 0 ? 0 : 1);
        }
    report.viewer.surface = s;
    report.viewer.viewing_distance_mm = 300;
    return report;
}

}  // namespace voxtone::test::page_sample
