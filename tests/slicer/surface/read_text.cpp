// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/slicer/surface/read_text.h"

#include <cmath>
#include <vector>

#include "io/lettering/font_file.h"
#include "io/lettering/set_text.h"

namespace voxtone::test {

namespace {

/// Share of ink in the picture's pixel (x, y).
double ink_in(const io::Coverage& ink, const TextPlace& place, double pixel_mm, int x, int y) {
    const auto from = [&](int pixel, double start) {
        return int(std::floor((pixel * pixel_mm - start) / ink.pixel_mm));
    };
    double sum = 0;
    int count = 0;
    for (int b = from(y, place.top_mm); b < from(y + 1, place.top_mm); ++b)
        for (int a = from(x, place.left_mm); a < from(x + 1, place.left_mm); ++a, ++count)
            if (a >= 0 && b >= 0 && a < ink.width_px && b < ink.height_px) sum += ink.at(a, b) / 255.0;
    return count > 0 ? sum / count : 0;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / double(a.size()), mean_b += b[i] / double(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += (a[i] - mean_a) * (b[i] - mean_b);
        aa += (a[i] - mean_a) * (a[i] - mean_a);
        bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : -1;
}

}  // namespace

std::string read_text(const GreyPicture& picture, double pixel_mm, const TextPlace& place, const std::string& text,
                      const std::string& alphabet, bool dark) {
    const auto font = io::find_font(place.font);
    const double width_mm = io::set_text(text, font, place.em_mm).width_mm();
    // The brackets are mirrored: of their two cells half of what is ink lies in each.
    const double two = io::set_text("[]", font, place.em_mm).width_mm();
    const double advance = text.size() > 2 ? (width_mm - two) / double(text.size() - 2) : width_mm;
    std::string read(1, text.front());
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
        const double left = place.left_mm + two / 2 + double(i - 1) * advance;
        const int x0 = int(std::floor(left / pixel_mm)), x1 = int(std::ceil((left + advance) / pixel_mm));
        const int y0 = int(std::floor(place.top_mm / pixel_mm)),
                  y1 = int(std::ceil((place.top_mm + 1.2 * place.em_mm) / pixel_mm));
        std::vector<double> seen;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x)
                seen.push_back(x >= 0 && y >= 0 && x < picture.width && y < picture.height
                                   ? (dark ? -picture.at(x, y) : picture.at(x, y))
                                   : 0.0);
        char best = '?';
        double most = -2;
        for (const char letter : alphabet) {
            std::string tried = text;
            tried[i] = letter;
            const io::Coverage ink = io::set_text(tried, font, place.em_mm);
            std::vector<double> expected;
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) expected.push_back(ink_in(ink, place, pixel_mm, x, y));
            if (const double now = correlation(seen, expected); now > most) most = now, best = letter;
        }
        read += best;
    }
    return read + text.back();
}

}  // namespace voxtone::test
