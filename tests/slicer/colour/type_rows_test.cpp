// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is type: signs, labels, reversed type, along any direction; and what is none: spots, patterns, halftones,
// specks.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "io/lettering/make_code.h"
#include "io/pictures/picture.h"
#include "slicer/colour/type_rows.h"
#include "tests/outcomes.h"
#include "tests/places.h"
#include "tests/slicer/colour/drawn_page.h"

using namespace voxtone;
using namespace voxtone::slicer;
using test::Paint;
using test::SetLine;

namespace {

const Eigen::Vector3f white(1, 1, 1), ink(0.01f, 0.01f, 0.01f), blue(0.02f, 0.05f, 0.3f), red(0.6f, 0.02f, 0.02f),
    cream(0.9f, 0.82f, 0.6f), brown(0.15f, 0.06f, 0.02f);
constexpr double width_mm = 24, height_mm = 15;

struct Inked {
    SetLine line;
    Eigen::Vector3f rgb;
};

Paint lines_on(const Eigen::Vector3f& ground, std::vector<Inked> lines) {
    return [ground, lines = std::move(lines)](double x, double y) {
        Eigen::Vector3f rgb = ground;
        for (const Inked& one : lines) {
            const float share = one.line.at(x, y);
            rgb = (1 - share) * rgb + share * one.rgb;
        }
        return rgb;
    };
}

/// `part`: of the page that is looked at, each way.
std::size_t letters_in(const Paint& paint, double part = 1) {
    return find_type(test::page_of(part * width_mm, part * height_mm, paint)).letters.size();
}

/// Black where `is_ink` says so.
template <class IsInk>
Paint black_where(const IsInk& is_ink) {
    return [=](double x, double y) -> Eigen::Vector3f { return is_ink(x, y) ? ink : white; };
}

double part_of(double x) { return x - std::floor(x); }

/// Discs of these radii anywhere, each a little out of round.
class Specks {
public:
    Specks(std::uint64_t seed, int n, double least_mm, double most_mm) : is_ink_(std::size_t(columns * rows)) {
        for (int i = 0; i < n; ++i) {
            RandomStream random(seed, std::uint64_t(i));
            const double u = random.uniform() * width_mm, v = random.uniform() * height_mm,
                         radius = least_mm + random.uniform() * (most_mm - least_mm), turn = random.uniform() * 6.28,
                         oblong = random.uniform(), far = 1.7 * radius;
            for (int y = at(v - far, rows); y < at(v + far, rows); ++y)
                for (int x = at(u - far, columns); x < at(u + far, columns); ++x) {
                    const double dx = x * edge_mm - u, dy = y * edge_mm - v, angle = std::atan2(dy, dx) + turn;
                    if (std::hypot(dx, dy) <
                        radius * (1 + 0.5 * oblong * std::cos(2 * angle) + 0.2 * std::cos(3 * angle)))
                        is_ink_[std::size_t(y * columns + x)] = 1;
                }
        }
    }
    bool operator()(double x, double y) const {
        return is_ink_[std::size_t(at(y, rows - 1) * columns + at(x, columns - 1))] != 0;
    }

private:
    static constexpr double edge_mm = 0.02;
    static constexpr int columns = int(width_mm / edge_mm), rows = int(height_mm / edge_mm);
    static int at(double mm, int most) { return std::clamp(int(mm / edge_mm), 0, most); }
    std::vector<char> is_ink_;
};

}  // namespace

TEST_CASE("Signs and labels are type: small and large, in colours, reversed, along any direction", "[slow]") {
    std::vector<Inked> sign;
    double y = 14;
    for (const double pt : {9.0, 6.0, 4.5, 3.5, 2.5, 2.0}) {
        y -= 0.4 * pt;
        sign.push_back({SetLine("Open 10 to 18", pt, 1, y), ink});
    }
    // 10 a line: the larger letters of the first are more than a square millimetre each, some of the last touch.
    const FoundType type = find_type(test::page_of(width_mm, height_mm, lines_on(white, sign)));
    CHECK(type.letters.size() >= 30);
    CHECK(std::ranges::min(type.letters, {}, &Letter::line_mm).line_mm < 0.6);
    CHECK(std::ranges::max(type.letters, {}, &Letter::line_mm).line_mm > 1.5);
    for (const char* font : {"DejaVu Sans", "DejaVu Serif", "DejaVu Sans Mono"}) {
        CAPTURE(font);
        CHECK(letters_in(lines_on(white, {{SetLine("Serial 00417-B", 5, 2, 9, 0, font), ink}})) >= 9);
        CHECK(letters_in(lines_on(white, {{SetLine("MUSEUM", 5, 2, 9, 0, font), ink}})) == 6);
    }
    // A paragraph, of which a table is the hardest: figures are of one width.
    for (const char* font : {"DejaVu Sans", "DejaVu Sans Mono"})
        for (const double pt : {2.5, 3.5, 5.0}) {
            CAPTURE(font, pt);
            std::vector<Inked> table;
            for (int line = 0; line < 4; ++line)
                table.push_back({SetLine(std::to_string(83114092 * (line + 3)) + " net", pt, 2,
                                         10 - 1.2 * 0.353 * pt * line, 0, font),
                                 ink});
            CHECK(letters_in(lines_on(white, table)) >= 24);
        }
    CHECK(letters_in(lines_on(white, {{SetLine("small label", 5, 2, 12), red},
                                      {SetLine("in several", 5, 2, 8), blue},
                                      {SetLine("colours", 5, 2, 4), Eigen::Vector3f(0.02f, 0.3f, 0.05f)}})) >= 20);
    CHECK(letters_in(lines_on(
              blue, {{SetLine("white on blue", 6, 2, 10), white}, {SetLine("and below", 4, 2, 5), white}})) >= 16);
    // Stems side by side, as bars are.
    const char* const bold = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";
    CHECK(letters_in(lines_on(white, {{SetLine("Exit 4 mm", 6, 2, 9, 0, bold), ink},
                                      {SetLine("Exit 3 mm", 5, 2, 5, 0, bold), ink}})) >= 14);
    CHECK(letters_in(lines_on(cream, {{SetLine("brown on cream", 5, 2, 9), brown}})) >= 10);
    for (const double degrees : {30.0, 90.0, 180.0, 250.0}) {
        CAPTURE(degrees);
        const double x = 12 - 6 * std::cos(degrees / 57.29578), y0 = 7 - 6 * std::sin(degrees / 57.29578);
        CHECK(letters_in(lines_on(white, {{SetLine("ALONG A LINE", 4.5, x, y0, degrees, "DejaVu Sans"), ink}})) >= 8);
    }
}

TEST_CASE("The size of type is that of its capitals, however it runs") {
    for (const double degrees : {0.0, 90.0, 210.0}) {
        CAPTURE(degrees);
        const JobPrediction page = test::page_of(
            width_mm, height_mm, lines_on(white, {{SetLine("PROOF", 5, 12, 8, degrees, "DejaVu Sans"), ink}}));
        const FoundType type = find_type(page);
        REQUIRE(type.letters.size() >= 4);  // aslant two may touch
        for (const Letter& letter : type.letters) CHECK(letter.line_mm == Approx(0.73 * 5 * 25.4 / 72).margin(0.1));
    }
}

TEST_CASE("The spots of a cow's texture are no type, at any size") {
    const io::Picture cow = io::read_picture(test::source_dir() + "/examples/models/spot/spot_texture.png");
    for (const double edge_mm : {5.0, 8.0, 12.0, 20.0}) {
        CAPTURE(edge_mm);
        const FoundType type = find_type(test::page_of(edge_mm, edge_mm, [&](double x, double y) {
            return cow.texture->sample(float(x / edge_mm), float(y / edge_mm));
        }));
        CHECK(type.letters.empty());
        if (edge_mm < 15) CHECK(type.others.size() > 10);  // smaller than a square millimetre
    }
}

TEST_CASE("Dots, halftones, ticks, checks and bricks are patterns and no type", "[slow]") {
    for (const double pitch : {0.5, 0.8, 1.4}) {
        CAPTURE(pitch);
        for (const double degrees : {0.0, 15.0, 45.0}) {
            CAPTURE(degrees);
            const double c = std::cos(degrees / 57.29578), s = std::sin(degrees / 57.29578);
            const auto from_dot = [=](double x, double y) {
                return std::hypot(part_of((c * x + s * y) / pitch) - 0.5, part_of((c * y - s * x) / pitch) - 0.5);
            };
            CHECK(letters_in(black_where([&](double x, double y) { return from_dot(x, y) < 0.3; }), 0.5) == 0);
            CHECK(letters_in(
                      black_where([&](double x, double y) { return from_dot(x, y) < 0.15 + 0.25 * 2 * x / width_mm; }),
                      0.5) == 0);
        }
        CHECK(letters_in(
                  black_where([&](double x, double y) { return part_of(x / pitch) < 0.3 && part_of(y / 2.5) < 0.5; }),
                  0.5) == 0);
        // Some of 0.4 mm touch, as cells fall.
        CHECK(letters_in(black_where([&](double x, double y) {
                             return (part_of(x / pitch) < 0.5) != (part_of(y / pitch) < 0.5);
                         }),
                         0.5) == 0);
        CHECK(letters_in(black_where([&](double x, double y) {
                             const double row = std::floor(y / pitch);
                             return part_of(y / pitch) > 0.25 && part_of(x / (2 * pitch) + 0.5 * row) > 0.15;
                         }),
                         0.5) == 0);
        // Crosses: as slender as letters, but all the same.
        CHECK(letters_in(black_where([&](double x, double y) {
                             const double u = std::abs(part_of(x / pitch) - 0.5),
                                          v = std::abs(part_of(y / pitch) - 0.5);
                             return std::min(u, v) < 0.1 && std::max(u, v) < 0.35;
                         }),
                         0.5) == 0);
    }
}

namespace {

/// Rows of groups of bars, of one width or each group finer than the one before.
class BarGroups {
public:
    BarGroups(double widest_mm, double finer, int of_a_group, double length_mm, double degrees)
        : c_(std::cos(degrees / 57.29578)), s_(std::sin(degrees / 57.29578)), length_mm_(length_mm) {
        double x = 0.3;
        for (double w = widest_mm; x < 20 && w > 0.04; w *= finer, x += 2 * w)
            for (int n = 0; n < of_a_group; ++n, x += 2 * w) bars_.push_back({x, x + w});
    }
    bool operator()(double x, double y) const {
        const double along = c_ * x + s_ * y, up = c_ * y - s_ * x, row = std::floor(up / (1.4 * length_mm_));
        // None is cut by the page's edge to less than six cells, but aslant.
        return up - 1.4 * length_mm_ * row < length_mm_ && 1.4 * length_mm_ * (row + 1) < page_mm &&
               std::ranges::any_of(bars_, [&](const auto& bar) { return along > bar[0] && along < bar[1]; });
    }

private:
    static constexpr double page_mm = 0.4 * height_mm;
    double c_, s_, length_mm_;
    std::vector<std::array<double, 2>> bars_;
};

}  // namespace

TEST_CASE("The bars of a resolution chart are no type: in threes, in rows, of any width, aslant", "[slow]") {
    for (const double width : {0.4, 0.2, 0.12})
        for (const double finer : {0.8, 1.0})
            for (const int of_a_group : {3, 7, 60})
                for (const double length : {0.7, 1.5, 3.3})
                    for (const double degrees : {0.0, 7.0, 90.0}) {
                        CAPTURE(width, finer, of_a_group, length, degrees);
                        CHECK(letters_in(black_where(BarGroups(width, finer, of_a_group, length, degrees)), 0.4) == 0);
                    }
}

TEST_CASE("Words whose letters touch are type, dark on light and light on dark", "[slow]") {
    const Eigen::Vector3f dim(0.1f, 0.1f, 0.1f);
    for (const auto& [ground, of] : {std::tuple{white, ink}, {ink, white}, {ink, dim}, {ink, cream}, {blue, cream}})
        for (const char* font : {"DejaVu Sans", "DejaVu Serif", "DejaVu Sans Mono"})
            for (const double largest_pt : {2.2, 3.3, 4.5}) {
                CAPTURE(of, font, largest_pt);
                std::vector<Inked> card;
                double y = 6;
                for (double pt = largest_pt; pt > 0.45 * largest_pt; pt *= 0.73) {
                    y -= 0.5 * pt;
                    card.push_back({SetLine("Open 10 to 18", pt, 0.5, y, 0, font), of});
                }
                // Ten letters a line, of which those below 2 pt hang together as words.
                CHECK(letters_in(lines_on(ground, card), 0.4) >= 5 * card.size());
            }
}

TEST_CASE("Specks that lie anyhow are no type, however many they are", "[slow]") {
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
        for (const auto& [n, least, most] :
             {std::tuple{60, 0.2, 0.4}, {300, 0.1, 0.35}, {900, 0.1, 0.2}, {120, 0.3, 0.55}}) {
            CAPTURE(seed, n);
            const std::size_t found = letters_in(black_where(Specks(seed, n, least, most)));
            CHECK(found == 0);
        }
}

TEST_CASE("A code is no type") {
    for (const io::CodeKind kind : {io::CodeKind::qr, io::CodeKind::data_matrix})
        for (const double module_mm : {0.2, 0.35, 0.5}) {
            CAPTURE(int(kind), module_mm);
            const io::CodeSymbol code = io::make_code(kind, "https://example.org/a-part/00417");
            CHECK(letters_in(black_where([&](double x, double y) {
                      const int i = int(std::floor((x - 2) / module_mm)),
                                j = code.rows - 1 - int(std::floor((y - 2) / module_mm));
                      return i >= 0 && j >= 0 && i < code.columns && j < code.rows &&
                             code.dark[std::size_t(j * code.columns + i)];
                  })) == 0);
        }
}

TEST_CASE("Type on a body is type: on a box's front, and around a bottle") {
    const SetLine large("LABEL 2026", 5, 1, 4, 0, "DejaVu Sans"), small("contents", 3, 1, 2, 0, "DejaVu Sans");
    const auto label = [&](double x, double y) -> Eigen::Vector3f {
        const float share = std::max(large.at(x, y), small.at(x, y));
        return (1 - share) * white + share * ink;
    };
    const auto letters_on = [&](const auto& is_solid, const auto& paint) {
        const FoundType type = find_type(test::body_of({16, 16, 8}, is_solid, paint));
        const double side = std::sqrt(2.0);
        for (const Letter& letter : type.letters) CHECK((letter.line_mm > 0.5 && letter.line_mm < side));
        return type.letters.size();
    };
    CHECK(letters_on([](double, double y, double) { return y > 4; },
                     [&](double x, double y, double z) { return y < 4.1 ? label(x, z) : white; }) >= 14);
    // Around a cylinder of 14 mm, whose front is at x = 8, y = 1: by the length of the arc.
    CHECK(letters_on([](double x, double y, double) { return std::hypot(x - 8, y - 8) < 7; },
                     [&](double x, double y, double z) { return label(7 + 7 * std::atan2(x - 8, 8 - y), z); }) >= 14);
    // Spots all over it are none.
    const Specks specks(7, 200, 0.2, 0.4);
    CHECK(letters_on([](double x, double y, double) { return std::hypot(x - 8, y - 8) < 7; },
                     [&](double x, double y, double z) -> Eigen::Vector3f {
                         return specks(7 + 7 * std::atan2(x - 8, 8 - y), z) ? ink : white;
                     }) == 0);
}
