// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/report_picture.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "io/pictures/png_pixels.h"

using namespace voxtone::io;

namespace {

Picture8 grey(std::uint8_t code) {
    Picture8 picture{40, 20, 4, std::vector<std::uint8_t>(40 * 20 * 4, code)};
    for (std::size_t i = 3; i < picture.codes.size(); i += 4) picture.codes[i] = 255;
    return picture;
}

/// The code of the middle pixel of what is shown of a report.
int shown(const Report& report, std::uint32_t most_px) {
    const ReportPicture* const picture = shown_picture(report);
    if (!picture) return -1;
    const std::vector<std::uint8_t> small = small_picture_png(picture->file, most_px);
    int code = -1;
    const PngHeader header = read_png(
        small, "it", [&](std::uint32_t, std::span<const std::uint8_t> rgba) { code = rgba[rgba.size() / 8 * 4]; });
    CHECK(std::max(header.width_px, header.height_px) <= most_px);
    return code;
}

}  // namespace

TEST_CASE("A report's print is shown small, not its target, a difference or another print") {
    Report report;
    CHECK(shown(report, 16) == -1);
    report.views = {{"top", {report_picture("target", grey(40), 1)}}, {"front", {report_picture("f", grey(1), 1)}}};
    CHECK(std::abs(shown(report, 16) - 40) <= 1);
    report.views[0].pictures.push_back(report_picture("predicted", grey(120), 1));
    CHECK(std::abs(shown(report, 16) - 120) <= 1);
    report.views[0].pictures.push_back(report_picture("difference", grey(200), 1));
    report.views[0].pictures.push_back(report_picture("open loop", grey(250), 1));
    CHECK(std::abs(shown(report, 16) - 120) <= 1);
    report.views[0].pictures[1] = {"predicted", png_bytes(grey(90)), 40, 20, 1};  // it may be of either kind
    CHECK(shown(report, 64) == 90);
}
