// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#define ZX_USE_UTF8 1
#include <ZXing/ReadBarcode.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

#if __has_include(<ZXing/ReaderOptions.h>)
using CodeOptions = ZXing::ReaderOptions;  // its name since ZXing-C++ 2.2
#else
using CodeOptions = ZXing::DecodeHints;
#endif

using ZXing::BarcodeFormat;

constexpr int most_codes = 64;
constexpr double most_pixels = 4e6;

const char* kind_of(BarcodeFormat format) {
    switch (format) {
        case BarcodeFormat::QRCode:
            return "QR code";
        case BarcodeFormat::DataMatrix:
            return "Data Matrix";
        case BarcodeFormat::PDF417:
            return "PDF417";
        default:
            return "bar code";
    }
}

/// By ISO/IEC 15420: of EAN-13 and UPC-A, 2 guards of 3, one of 5 and 12 digits of 7; of EAN-8 8 digits.
int modules_of(BarcodeFormat format) {
    if (format == BarcodeFormat::EAN13 || format == BarcodeFormat::UPCA) return 95;
    return format == BarcodeFormat::EAN8 ? 67 : 0;
}

/// Between the middles of pixels a straight line.
LuminanceRaster enlarged(const LuminanceRaster& from, int times) {
    if (times == 1) return from;
    LuminanceRaster to{times * from.columns, times * from.rows, {}};
    to.grey.reserve(std::size_t(to.columns) * std::size_t(to.rows));
    const auto place = [&](int at, int most) { return std::clamp((at + 0.5) / times - 0.5, 0.0, most - 1.0); };
    const auto grey = [&](int column, int row) {
        return double(from.grey[std::size_t(std::min(row, from.rows - 1)) * std::size_t(from.columns) +
                                std::size_t(std::min(column, from.columns - 1))]);
    };
    for (int row = 0; row < to.rows; ++row)
        for (int column = 0; column < to.columns; ++column) {
            const double x = place(column, from.columns), y = place(row, from.rows);
            const int left = int(x), top = int(y);
            const double u = x - left, v = y - top;
            to.grey.push_back(
                std::uint8_t(std::lround((1 - v) * ((1 - u) * grey(left, top) + u * grey(left + 1, top)) +
                                         v * ((1 - u) * grey(left, top + 1) + u * grey(left + 1, top + 1)))));
        }
    return to;
}

using Box = std::array<double, 4>;  ///< left, top, right, bottom

Box box_of(const ZXing::Result& result) {
    Box box{1e9, 1e9, -1e9, -1e9};
    for (const auto& corner : result.position())
        box = {std::min(box[0], double(corner.x)), std::min(box[1], double(corner.y)),
               std::max(box[2], double(corner.x)), std::max(box[3], double(corner.y))};
    return box;
}

/// `box`: in pixels of a picture so many times as large, whose first row is this one.
void add(std::vector<CodeInPicture>& codes, const ZXing::Result& result, const Box& box, int times, int first_row = 0) {
    if (!result.isValid() || result.isMirrored() || result.bytes().empty()) return;
    // It has no sum: what few stripes say by chance is none.
    constexpr std::size_t least_characters = 4;
    if (result.format() == BarcodeFormat::Code39 && std::size_t(result.bytes().size()) < least_characters) return;
    CodeInPicture code{kind_of(result.format()), {result.bytes().begin(), result.bytes().end()}, {}, 0};
    if (const int modules = modules_of(result.format()); modules > 0) {
        const auto way = result.position()[1] - result.position()[0];
        code.module = std::hypot(way.x, way.y) / modules / times;
    }
    code.box = {box[0] / times, first_row + box[1] / times, box[2] / times, first_row + box[3] / times};
    const auto same = [&](const CodeInPicture& other) {
        return other.kind == code.kind && other.content == code.content && other.box[0] < code.box[2] &&
               code.box[0] < other.box[2] && other.box[1] < code.box[3] && code.box[1] < other.box[3];
    };
    if (std::ranges::none_of(codes, same)) codes.push_back(std::move(code));
}

/// Edges where they are steepest, as scanners of bars look for them: with 1.5 times what a Gaussian of 2.5 pixels takes
/// away. Bars that light has run into each other are read so by zbar 0.23, and by ZXing not without it.
LuminanceRaster sharpened(const LuminanceRaster& from) {
    constexpr double sigma = 2.5, more = 1.5;
    constexpr int reach = 8;
    std::array<double, 2 * reach + 1> kernel{};
    double all = 0;
    for (int d = -reach; d <= reach; ++d)
        all += kernel[std::size_t(d + reach)] = std::exp(-d * d / (2 * sigma * sigma));
    const auto at = [&](const auto& values, int column, int row) {
        return double(values[std::size_t(std::clamp(row, 0, from.rows - 1)) * std::size_t(from.columns) +
                             std::size_t(std::clamp(column, 0, from.columns - 1))]);
    };
    std::vector<float> across(from.grey.size());
    LuminanceRaster to = from;
    for (const bool along : {true, false})
        for (int row = 0; row < from.rows; ++row)
            for (int column = 0; column < from.columns; ++column) {
                double sum = 0;
                for (int d = -reach; d <= reach; ++d)
                    sum += kernel[std::size_t(d + reach)] / all *
                           (along ? at(from.grey, column + d, row) : at(across, column, row + d));
                const std::size_t i = std::size_t(row) * std::size_t(from.columns) + std::size_t(column);
                if (along)
                    across[i] = float(sum);
                else
                    to.grey[i] = std::uint8_t(std::lround(
                        std::clamp(double(from.grey[i]) + more * (double(from.grey[i]) - sum), 0.0, 255.0)));
            }
    return to;
}

/// From lines across bars to the ends of them: as far as each further line looks like those. Bars that lie aslant keep
/// the box of the lines.
Box bars_at(const LuminanceRaster& picture, const Box& lines, bool upright) {
    constexpr double alike = 0.5;  // correlation: paper has none, digits below them little; chosen, not measured
    const int along = upright ? 0 : 1, across = 1 - along, most = upright ? picture.rows : picture.columns,
              first = std::max(0, int(lines[std::size_t(along)])),
              last = std::min((upright ? picture.columns : picture.rows) - 1, int(lines[std::size_t(along + 2)]));
    if (last - first < 2) return lines;
    const auto line_at = [&](int at) {
        std::vector<double> line;
        for (int i = first; i <= last; ++i)
            line.push_back(double(picture.grey[std::size_t(upright ? at : i) * std::size_t(picture.columns) +
                                               std::size_t(upright ? i : at)]));
        const double mean = std::accumulate(line.begin(), line.end(), 0.0) / double(line.size());
        for (double& grey : line) grey -= mean;
        return line;
    };
    const int middle = std::clamp(int((lines[std::size_t(across)] + lines[std::size_t(across + 2)]) / 2), 0, most - 1);
    const std::vector<double> wanted = line_at(middle);
    const auto is_alike = [&](int at) {
        const std::vector<double> line = line_at(at);
        const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
            return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
        };
        return product(line, wanted) > alike * std::sqrt(product(line, line) * product(wanted, wanted));
    };
    int low = middle, high = middle;
    while (low > 0 && is_alike(low - 1)) --low;
    while (high + 1 < most && is_alike(high + 1)) ++high;
    Box box = lines;
    box[std::size_t(across)] = low, box[std::size_t(across + 2)] = high + 1;
    return box;
}

/// One by one, each painted over once it is read: asked for several at once, or at scales of its own, ZXing 1.4.0
/// aborts over some pages.
void add_bars(std::vector<CodeInPicture>& codes, LuminanceRaster picture, int times, CodeOptions hints) {
    hints.setTryDownscale(false).setMaxNumberOfSymbols(1);
    for (int n = 0; n < most_codes; ++n) {
        const ZXing::Results found =
            ZXing::ReadBarcodes({picture.grey.data(), picture.columns, picture.rows, ZXing::ImageFormat::Lum}, hints);
        if (found.empty()) return;
        const auto& corners = found.front().position();
        const auto way = corners[1] - corners[0];
        const Box box = bars_at(picture, box_of(found.front()), std::abs(way.x) >= std::abs(way.y));
        add(codes, found.front(), box, times);
        const int top = std::max(0, int(box[1])), bottom = std::min(picture.rows, int(box[3]) + 1),
                  left = std::max(0, int(box[0])), right = std::min(picture.columns, int(box[2]) + 1);
        if (top >= bottom || left >= right) return;
        for (int row = top; row < bottom; ++row)
            std::fill_n(picture.grey.begin() + std::ptrdiff_t(row) * picture.columns + left, right - left,
                        std::uint8_t{255});
    }
}

/// ZXing 1.4.0 finds a Data Matrix half way up a picture alone
/// (findings/zxing-data-matrix-place.sh): it is shown strips of the picture, one below the other.
void add_from_strips(std::vector<CodeInPicture>& codes, const LuminanceRaster& picture) {
    constexpr int least_rows = 24, in_a_strip = 4;
    CodeOptions hints;
    hints.setFormats(BarcodeFormat::DataMatrix).setTryHarder(true).setMaxNumberOfSymbols(most_codes);
    for (int part = 1; part <= 8 && picture.rows / part >= least_rows; part *= 2) {
        const int rows = picture.rows / part, step = std::max(1, rows / in_a_strip);
        for (int first = 0; first + rows <= picture.rows; first += step)
            for (const ZXing::Result& result :
                 ZXing::ReadBarcodes({picture.grey.data() + std::size_t(first) * std::size_t(picture.columns),
                                      picture.columns, rows, ZXing::ImageFormat::Lum},
                                     hints))
                add(codes, result, box_of(result), 1, first);
    }
}

}  // namespace

std::vector<CodeInPicture> decode_codes(const LuminanceRaster& picture, int most_times) {
    if (picture.columns < 1 || picture.rows < 1 || double(picture.columns) * picture.rows > 1e9 ||
        picture.grey.size() != std::size_t(picture.columns) * std::size_t(picture.rows))
        throw InputError("a picture whose codes are to be read is not of its size");
    CodeOptions areas, bars;
    areas.setFormats(BarcodeFormat::QRCode | BarcodeFormat::DataMatrix | BarcodeFormat::PDF417);
    bars.setFormats(BarcodeFormat::Code128 | BarcodeFormat::Code39 | BarcodeFormat::EAN13 | BarcodeFormat::EAN8 |
                    BarcodeFormat::UPCA);
    areas.setTryHarder(true).setMaxNumberOfSymbols(most_codes);
    bars.setTryHarder(true);
    std::vector<CodeInPicture> codes;
    for (const int times : {1, 2, 3, 4, 6}) {
        if (times > most_times) break;
        if (times > 1 && double(times) * times * picture.columns * picture.rows > most_pixels) break;
        const LuminanceRaster larger = enlarged(picture, times);
        for (const ZXing::Binarizer how : {ZXing::Binarizer::LocalAverage, ZXing::Binarizer::GlobalHistogram}) {
            for (const ZXing::Result& result :
                 ZXing::ReadBarcodes({larger.grey.data(), larger.columns, larger.rows, ZXing::ImageFormat::Lum},
                                     areas.setBinarizer(how)))
                add(codes, result, box_of(result), times);
            add_bars(codes, larger, times, bars.setBinarizer(how));
        }
    }
    if (most_times > 1)
        for (const LuminanceRaster clear = sharpened(picture); const int times : {2, 4}) {
            if (double(times) * times * picture.columns * picture.rows > most_pixels) break;
            add_bars(codes, enlarged(clear, times), times, bars);
        }
    add_from_strips(codes, picture);
    return codes;
}

}  // namespace voxtone::io
