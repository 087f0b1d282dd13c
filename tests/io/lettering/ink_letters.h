// SPDX-License-Identifier: GPL-3.0-or-later
//
// Letters read off the ink of a line, from left to right, by what each looks like alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "io/lettering/set_text.h"

namespace voxtone::test {

/// A rectangle of ink without blank rows and columns around it.
struct InkBox {
    int width = 0, height = 0;
    std::vector<int> ink;
};

inline InkBox ink_box(const io::Coverage& line, int first, int end) {
    int top = line.height_px, bottom = 0;
    for (int y = 0; y < line.height_px; ++y)
        for (int x = first; x < end; ++x)
            if (line.at(x, y) > 0) top = std::min(top, y), bottom = std::max(bottom, y + 1);
    InkBox box{end - first, bottom - top, {}};
    for (int y = top; y < bottom; ++y)
        for (int x = first; x < end; ++x) box.ink.push_back(line.at(x, y));
    return box;
}

/// What is parted by blank columns.
inline std::vector<InkBox> ink_boxes(const io::Coverage& line) {
    std::vector<InkBox> boxes;
    int first = -1;
    for (int x = 0; x <= line.width_px; ++x) {
        bool dark = false;
        for (int y = 0; x < line.width_px && y < line.height_px; ++y) dark = dark || line.at(x, y) > 0;
        if (dark && first < 0) first = x;
        if (!dark && first >= 0) boxes.push_back(ink_box(line, first, x)), first = -1;
    }
    return boxes;
}

/// Mean difference of ink where both lie corner on corner; letters of other sizes are far from each other.
inline double misfit(const InkBox& a, const InkBox& b) {
    constexpr int rounding = 2;
    if (std::abs(a.width - b.width) > rounding || std::abs(a.height - b.height) > rounding) return 1e9;
    const int width = std::min(a.width, b.width), height = std::min(a.height, b.height);
    double sum = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            sum += std::abs(a.ink[std::size_t(y * a.width + x)] - b.ink[std::size_t(y * b.width + x)]);
    return sum / (width * height);
}

/// `alphabet`: letters that stand alone, each of one piece. '?': none of them looks so.
inline std::string letters_in(const io::Coverage& line, const std::vector<std::string>& alphabet,
                              const std::filesystem::path& font, double em_mm) {
    std::string read;
    for (const InkBox& box : ink_boxes(line)) {
        std::string best = "?";
        double least = 60;
        for (const std::string& letter : alphabet) {
            const std::vector<InkBox> alone = ink_boxes(io::set_text(letter, font, em_mm));
            if (alone.size() != 1) continue;
            if (const double now = misfit(box, alone[0]); now < least) least = now, best = letter;
        }
        read += best;
    }
    return read;
}

}  // namespace voxtone::test
