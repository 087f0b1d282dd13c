// SPDX-License-Identifier: GPL-3.0-or-later
#include "stroke_font.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace voxtone::loop_benchmark {
namespace {

/// Strokes apart by blanks, corners of a stroke as pairs: x 0 to 6, y as a letter, a = -2 below the baseline c.
const std::map<char, std::string>& glyphs() {
    static const std::map<char, std::string> table{
        {'a', "4h4c 4g3h1h0g0d1c3c4d"},
        {'b', "0j0c 0d1c3c4d4g3h1h0g"},
        {'c', "4g3h1h0g0d1c3c4d"},
        {'d', "4j4c 4d3c1c0d0g1h3h4g"},
        {'e', "0f4f4g3h1h0g0d1c3c4d"},
        {'f', "1c1i2j3j 0h3h"},
        {'g', "4h4b3a1a0b 4g3h1h0g0d1c3c4d"},
        {'h', "0j0c 0g1h3h4g4c"},
        {'i', "1h1c 1j1j"},
        {'j', "2h2b1a0a 2j2j"},
        {'k', "0j0c 4h0e 1f4c"},
        {'l', "1j1c"},
        {'m', "0h0c 0g1h2h3g3c 3g4h5h6g6c"},
        {'n', "0h0c 0g1h3h4g4c"},
        {'o', "1h3h4g4d3c1c0d0g1h"},
        {'p', "0h0a 0g1h3h4g4d3c1c0d"},
        {'q', "4h4a 4g3h1h0g0d1c3c4d"},
        {'r', "0h0c 0f1h3h"},
        {'s', "4g3h1h0g1f3f4e4d3c1c0d"},
        {'t', "1j1d2c3c 0h3h"},
        {'u', "0h0d1c3c4d 4h4c"},
        {'v', "0h2c4h"},
        {'w', "0h1c3g5c6h"},
        {'x', "0h4c 4h0c"},
        {'y', "0h2c 4h1a0a"},
        {'z', "0h4h0c4c"},
        {'0', "1j3j4i4d3c1c0d0i1j"},
        {'1', "0i2j2c"},
        {'2', "0i1j3j4i4g0c4c"},
        {'3', "0j4j2g3g4f4d3c1c0d"},
        {'4', "3c3j0e4e"},
        {'5', "4j0j0g3g4f4d3c1c0d"},
        {'6', "4i3j1j0i0d1c3c4d4f3g1g0f"},
        {'7', "0j4j1c"},
        {'8', "1j3j4i4h3g1g0h0i1j 1g0f0d1c3c4d4f3g"},
        {'9', "0d1c3c4d4i3j1j0i0h1g3g4h"},
        {'A', "0c2j4c 1e3e"},
        {'P', "0c0j3j4i4h3g0g"},
        {'S', "4i3j1j0i0h1g3g4f4d3c1c0d"},
        {'.', "1c1c"},
        {',', "1c0b"},
        {'-', "1f3f"},
    };
    return table;
}

constexpr double em_units = 10, line_units = 0.95, between_units = 1.7, blank_units = 2.6;

struct Point {
    double x, y;
};

/// Cuts corners that turn by 50 degrees or less, twice (Chaikin): octagons become round, right angles stay.
std::vector<Point> rounded(std::vector<Point> line) {
    for (int pass = 0; pass < 2; ++pass) {
        std::vector<Point> next;
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (i == 0 || i + 1 == line.size()) {
                next.push_back(line[i]);
                continue;
            }
            const Point &a = line[i - 1], &b = line[i], &c = line[i + 1];
            const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - b.x, vy = c.y - b.y;
            const double cosine = (ux * vx + uy * vy) / (std::hypot(ux, uy) * std::hypot(vx, vy));
            if (cosine < 0.64 || cosine > 0.9999) {
                next.push_back(b);
                continue;
            }
            next.push_back({b.x - 0.3 * ux, b.y - 0.3 * uy});
            next.push_back({b.x + 0.3 * vx, b.y + 0.3 * vy});
        }
        line = std::move(next);
    }
    return line;
}

double distance(const Stroke& s, double x, double y) {
    const double dx = s.x1 - s.x0, dy = s.y1 - s.y0, length2 = dx * dx + dy * dy;
    const double t = length2 > 0 ? std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / length2, 0.0, 1.0) : 0.0;
    return std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy);
}

}  // namespace

double add_text(std::vector<Stroke>& strokes, const std::string& text, double x, double y, double point_size) {
    const double unit = point_size * mm_per_point / em_units;
    for (const char c : text) {
        const auto found = glyphs().find(c);
        if (found == glyphs().end()) {
            x += (blank_units + between_units) * unit;
            continue;
        }
        const std::string& path = found->second;
        int width = 0;
        std::vector<Point> line;
        const auto draw = [&] {
            const std::vector<Point> round = rounded(std::move(line));
            for (std::size_t i = 0; i + 1 < round.size(); ++i)
                strokes.push_back({round[i].x, round[i].y, round[i + 1].x, round[i + 1].y, line_units * unit});
            line.clear();
        };
        for (std::size_t i = 0; i < path.size();) {
            if (path[i] == ' ') {
                draw();
                ++i;
                continue;
            }
            width = std::max(width, path[i] - '0');
            line.push_back({x + (path[i] - '0') * unit, y + (path[i + 1] - 'c') * unit});
            i += 2;
        }
        draw();
        x += (width + between_units) * unit;
    }
    return x;
}

std::vector<float> draw_strokes(const std::vector<Stroke>& strokes, double width_mm, double height_mm,
                                double px_per_mm) {
    constexpr int samples = 4;
    const double per_mm = px_per_mm * samples;
    const int columns = static_cast<int>(std::lround(width_mm * px_per_mm)) * samples,
              rows = static_cast<int>(std::lround(height_mm * px_per_mm)) * samples;
    std::vector<char> ink(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    for (const Stroke& s : strokes) {
        const double r = s.width / 2;
        const int left = std::max(0, static_cast<int>((std::min(s.x0, s.x1) - r) * per_mm)),
                  right = std::min(columns - 1, static_cast<int>((std::max(s.x0, s.x1) + r) * per_mm)),
                  top = std::max(0, static_cast<int>((height_mm - std::max(s.y0, s.y1) - r) * per_mm)),
                  bottom = std::min(rows - 1, static_cast<int>((height_mm - std::min(s.y0, s.y1) + r) * per_mm));
        for (int j = top; j <= bottom; ++j)
            for (int i = left; i <= right; ++i)
                if (distance(s, (i + 0.5) / per_mm, height_mm - (j + 0.5) / per_mm) <= r)
                    ink[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)] =
                        1;
    }
    const int w = columns / samples, h = rows / samples;
    std::vector<float> coverage(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            if (ink[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)])
                coverage[static_cast<std::size_t>(j / samples) * static_cast<std::size_t>(w) +
                         static_cast<std::size_t>(i / samples)] += 1.0F / (samples * samples);
    return coverage;
}

}  // namespace voxtone::loop_benchmark
