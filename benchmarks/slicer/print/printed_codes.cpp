// SPDX-License-Identifier: GPL-3.0-or-later
#include "printed_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#define ZX_USE_UTF8 1
#include <ZXing/BitMatrix.h>
#include <ZXing/MultiFormatWriter.h>
#include <ZXing/ReadBarcode.h>
#include <fmt/core.h>

#include "optics/colour/colour.h"

namespace voxtone::loop_benchmark {

namespace {

ZXing::BarcodeFormat format_of(const PrintedCode& code) {
    return code.square ? ZXing::BarcodeFormat::QRCode : ZXing::BarcodeFormat::Code128;
}

PrintedCode code_of(bool square, double module_mm, double x, double y) {
    PrintedCode code{square, fmt::format("V{:02.0f}", 100 * module_mm), module_mm, x, y, 0, 1.4, {}};
    ZXing::MultiFormatWriter writer(format_of(code));
    writer.setMargin(0);
    const ZXing::BitMatrix matrix = writer.encode(code.text, 0, 0);
    for (int row = 0; row < (square ? matrix.height() : 1); ++row) {
        code.dark.emplace_back();
        for (int column = 0; column < matrix.width(); ++column) code.dark.back().push_back(matrix.get(column, row));
    }
    code.width = module_mm * matrix.width();
    if (square) code.height = module_mm * matrix.height();
    return code;
}

using Light = std::function<double(double x, double y)>;  // by cells

/// `finer` pixels a cell between (x0, y0) and (x1, y1), sRGB, in a white margin: what a camera would hand to a decoder.
bool is_read(const PrintedCode& code, const Light& light, std::array<double, 4> box, int finer, ZXing::Binarizer how) {
    const auto [x0, y0, x1, y1] = box;
    const int margin = 10 * finer, width = static_cast<int>((x1 - x0) * finer) + 2 * margin,
              height = static_cast<int>((y1 - y0) * finer) + 2 * margin;
    std::vector<std::uint8_t> grey(static_cast<std::size_t>(width * height), 255);
    for (int j = margin; j < height - margin; ++j)
        for (int i = margin; i < width - margin; ++i) {
            const double x = x0 + (i - margin) / double(finer), y = y1 - (j - margin) / double(finer);
            grey[static_cast<std::size_t>(j * width + i)] =
                static_cast<std::uint8_t>(std::lround(255 * optics::srgb_encode(std::clamp(light(x, y), 0.0, 1.0))));
        }
    ZXing::DecodeHints hints;
    hints.setFormats(format_of(code)).setTryHarder(true).setBinarizer(how);
    const ZXing::Result result = ZXing::ReadBarcode({grey.data(), width, height, ZXing::ImageFormat::Lum}, hints);
    return result.isValid() && result.text() == code.text;
}

/// By either of the decoder's ways to tell black from white, from one of several distances: a person tries, too.
bool is_read(const PrintedCode& code, const Judgement& page, const Colours& print) {
    const double cell_mm = std::sqrt(static_cast<double>(page.surface.cells[0].area_mm2)), quiet = 4 * code.module_mm;
    const auto columns = static_cast<int>(page.columns), rows = static_cast<int>(page.rows);
    const auto cells = [&](double mm, int most) { return std::clamp(mm / cell_mm - 0.5, 0.0, most - 1.0); };
    const double beside = code.square ? quiet : 0;
    const std::array<double, 4> box{cells(code.x - quiet, columns), cells(code.y - beside, rows),
                                    cells(code.x + code.width + quiet, columns),
                                    cells(code.y + code.height + beside, rows)};
    const Light light = [&](double x, double y) {
        const int left = std::min(static_cast<int>(x), columns - 2), low = std::min(static_cast<int>(y), rows - 2);
        const double u = x - left, v = y - low;
        const auto at = [&](int a, int b) {
            return static_cast<double>(
                Eigen::Vector3f(0.2126F, 0.7152F, 0.0722F).dot(print[static_cast<std::size_t>(b * columns + a)]));
        };
        return (1 - v) * ((1 - u) * at(left, low) + u * at(left + 1, low)) +
               v * ((1 - u) * at(left, low + 1) + u * at(left + 1, low + 1));
    };
    for (const int finer : {1, 2, 3, 4, 6})
        for (const ZXing::Binarizer how : {ZXing::Binarizer::LocalAverage, ZXing::Binarizer::GlobalHistogram})
            if (is_read(code, light, box, finer, how)) return true;
    return false;
}

}  // namespace

std::vector<PrintedCode> printed_codes() {
    return {code_of(true, 0.2, 0.9, 6.8), code_of(true, 0.3, 6.1, 6.8),   code_of(true, 0.4, 13.2, 6.8),
            code_of(false, 0.2, 4, 5),    code_of(false, 0.25, 2.5, 2.9), code_of(false, 0.3, 0.8, 0.8)};
}

ReadCodes read_codes(const Judgement& page, const Colours& print) {
    const std::vector<PrintedCode> codes = printed_codes();
    ReadCodes smallest;
    for (const bool square : {true, false}) {
        double& mm = square ? smallest.square_mm : smallest.bars_mm;
        for (auto code = codes.rbegin(); code != codes.rend(); ++code) {
            if (code->square != square) continue;
            if (!is_read(*code, page, print)) break;
            mm = code->module_mm;
        }
    }
    return smallest;
}

}  // namespace voxtone::loop_benchmark
