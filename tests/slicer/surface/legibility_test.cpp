// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels read off what the predictor says of their print: text of 6 pt, a QR code and a Data Matrix of 8 mm.
#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>

#include <fmt/core.h>

#include "base/progress.h"
#include "io/files/whole_file.h"
#include "io/lettering/font_file.h"
#include "io/lettering/set_text.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"
#include "slicer/print/run_print.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/outcomes.h"
#include "tests/slicer/surface/read_text.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr double width_mm = 26, height_mm = 17, em_mm = 6 * 25.4 / 72;
const std::string font = "DejaVu Sans Mono:bold",
                  letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";

test::GreyPicture cut(const test::GreyPicture& whole, double x0, double y0, double x1, double y1, double pixel_mm) {
    test::GreyPicture part;
    const auto px = [&](double mm) { return int(std::lround(mm / pixel_mm)); };
    part.width = px(x1) - px(x0);
    part.height = px(y1) - px(y0);
    for (int y = px(y0); y < px(y1); ++y)
        for (int x = px(x0); x < px(x1); ++x) part.pixels.push_back(std::uint8_t(whole.at(x, y)));
    return part;
}

/// The prediction of a slab of one grey with labels on it, from above.
test::GreyPicture predicted(const io::TemporaryFolder& folder, double grey, const std::vector<std::string>& labels) {
    const std::string picture = (folder.path() / "grey.png").string();
    io::Picture8 one{std::uint32_t(width_mm), std::uint32_t(height_mm), 3, {}};
    one.codes.assign(std::size_t{one.width_px} * one.height_px * 3,
                     std::uint8_t(std::lround(255 * optics::srgb_encode(grey))));
    io::write_whole_file(picture, io::png_bytes(one));
    SliceOptions options;
    options.model = picture;
    options.out = (folder.path() / "out").string();
    options.width_mm = width_mm;
    options.thickness_mm = 2;
    options.labels = labels;
    options.iterations.assign(1, '0');  // a literal here trips a warning of GCC 12
    options.predict = "transport";
    Progress quiet;
    (void)run_print({options}, quiet);
    const io::Picture seen = io::read_picture(folder.path() / "out" / "predicted.png");
    test::GreyPicture result{int(seen.width_px), int(seen.height_px), {}};
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x < result.width; ++x) {
            const Eigen::Vector3f rgb = seen.texture->sample((float(x) + 0.5f) / float(result.width),
                                                             1 - (float(y) + 0.5f) / float(result.height));
            result.pixels.push_back(std::uint8_t(
                std::lround(255 * optics::srgb_encode(double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb))))));
        }
    return result;
}

int misread(const std::string& read, const std::string& written) {
    INFO(read << " for " << written);
    REQUIRE(read.size() == written.size());
    int wrong = 0;
    for (std::size_t i = 0; i < read.size(); ++i) wrong += read[i] != written[i];
    return wrong;
}

}  // namespace

TEST_CASE("Text of 6 pt and codes of 8 mm are read from the prediction, on white, grey and black", "[slow]") {
    const std::string text = "[R2D2aegk0857]", upper = "[XKMWNHQBS4931]";
    int wrong = 0;
    for (const double grey : {1.0, 0.2, 0.0}) {
        const io::TemporaryFolder folder;
        const auto at = [&](const std::string& line, double up) {
            return line + fmt::format("; font={}; size=6pt; place=top; at=0,{}", font, up);
        };
        const test::GreyPicture seen =
            predicted(folder, grey,
                      {at(text, 6.6), at(upper, 4.1), "qr=https://a.bc/17; place=top; at=-6.5,-2.9; size=8mm",
                       "datamatrix=VOXTONE-2026-11; place=top; at=6.5,-2.9; size=8mm"});
        const double pixel_mm = width_mm / seen.width;
        const auto read = [&](const std::string& line, double up) {
            const io::Coverage ink = io::set_text(line, io::find_font(font), em_mm);
            const test::TextPlace place{font, em_mm, (width_mm - ink.width_mm()) / 2,
                                        height_mm / 2 - up - ink.height_mm() / 2};
            return test::read_text(seen, pixel_mm, place, line, letters, grey > 0.1);
        };
        INFO("on " << grey);
        wrong += misread(read(text, 6.6), text) + misread(read(upper, 4.1), upper);
        CHECK(test::code_in(cut(seen, 0, 5.8, 13, height_mm, pixel_mm)) == "https://a.bc/17");
        CHECK(test::code_in(cut(seen, 13, 5.8, width_mm, height_mm, pixel_mm)) == "VOXTONE-2026-11");
    }
    // Of 75 letters; the Q on white is taken for an O.
    WANTED(wrong == 0);
    CHECK(wrong <= 1);
}
