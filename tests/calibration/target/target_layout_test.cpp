// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_layout.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/marker_pattern.h"
#include "calibration/target/target_file.h"
#include "tests/calibration/photo/photo_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

std::set<std::string> tops_on(const Target& target, const std::string& backing) {
    std::set<std::string> tops;
    for (const TargetSquare& square : target.squares)
        if (square.backing == backing) tops.insert(mixture_text(square.top));
    return tops;
}

/// Fraction of a role at a point, by the boxes: the last one that holds the point.
double share_at(const std::vector<TargetBox>& boxes, const Eigen::Vector3d& p, std::size_t resin) {
    double share = -1;
    for (const TargetBox& box : boxes)
        if ((p.array() >= box.min_mm.array()).all() && (p.array() < box.max_mm.array()).all())
            share = box.fractions[resin];
    return share;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("layouts hold the squares of the paper upon both halves") {
    const std::set<std::string> a{"C", "M", "Y", "K", "W"};
    std::set<std::string> b = a, c = a;
    b.insert({"K:10+W:90", "K:90+W:10", "C:10+W:90", "M:10+W:90", "W:90+Y:10"});
    c.insert({"K:5+W:95", "K:10+W:90", "K:25+W:75", "K:50+W:50", "K:90+W:10"});
    for (const std::string role : {"C", "M", "Y"})
        for (const int percent : {5, 10, 25, 50})
            c.insert(mixture_text(
                parse_mixture(role + ":" + std::to_string(percent) + "+W:" + std::to_string(100 - percent))));
    for (const std::string backing : {"W", "K"}) {
        CHECK(tops_on(target_of(TargetLayout::a), backing) == a);
        CHECK(tops_on(target_of(TargetLayout::b), backing) == b);
        CHECK(tops_on(target_of(TargetLayout::c), backing) == c);
    }
}

TEST_CASE("targets grow linearly with the resins, from two up") {
    std::vector<std::string> roles{"W", "K"};
    for (int extra = 0; extra < 12; ++extra) {
        CHECK(target_of(TargetLayout::a, roles).squares.size() == 2 * roles.size());
        CHECK(target_of(TargetLayout::b, roles).squares.size() == 2 * (2 * (roles.size() - 2) + 4));
        CHECK(target_of(TargetLayout::c, roles).squares.size() == 2 * (5 * (roles.size() - 2) + 7));
        roles.push_back("spot" + std::to_string(extra));
    }
}

TEST_CASE("grey resins serve as light and dark") {
    TargetOptions options = target_options(TargetLayout::b, {"light-grey", "dark-grey", "C"});
    CHECK_THROWS_WITH(lay_out_target(options), Contains("--light W") && Contains("light-grey"));
    options.light = "light-grey";
    options.dark = "dark-grey";
    CHECK(tops_on(lay_out_target(options), "dark-grey").contains("C:10+light-grey:90"));
    options.dark = "light-grey";
    CHECK_THROWS_AS(lay_out_target(options), InputError);
}

TEST_CASE("thicknesses are whole layers, the base at least what was asked for") {
    TargetOptions options = target_options(TargetLayout::a);
    const Target target = lay_out_target(options);
    CHECK(target.top_mm == Approx(25 * 0.027).margin(1e-12));
    CHECK(target.base_mm == Approx(186 * 0.027).margin(1e-12));
    options.pitch_um[2] = 14;
    CHECK(lay_out_target(options).top_mm == Approx(0.672).margin(1e-12));
}

TEST_CASE("options out of range are refused by name") {
    const auto refused = [](const auto& change, const std::string& word) {
        TargetOptions options = target_options(TargetLayout::b);
        change(options);
        CHECK_THROWS_WITH(lay_out_target(options), Contains(word));
    };
    refused([](TargetOptions& o) { o.square_mm = 0; }, "square");
    refused([](TargetOptions& o) { o.top_mm = -1; }, "top");
    refused([](TargetOptions& o) { o.base_mm = NAN; }, "base");
    refused([](TargetOptions& o) { o.gap_mm = -2; }, "gap");
    refused([](TargetOptions& o) { o.marker_mm = 1; }, "marker");
    refused([](TargetOptions& o) { o.quiet_mm = 0.5; }, "quiet");
    refused([](TargetOptions& o) { o.roles = {"W"}; }, "two resins");
    refused([](TargetOptions& o) { o.roles = {"W", "K", "W"}; }, "twice");
    refused([](TargetOptions& o) { o.roles = {"W", "K", "a+b"}; }, "a+b");
}

TEST_CASE("layout E has every choice of resins once upon each half, as much of each") {
    const Target target = target_of(TargetLayout::e, {"C", "M", "Y", "K", "W"});
    CHECK(target.layout == "E");
    std::set<std::string> on_light, on_dark;
    for (const TargetSquare& square : target.squares) {
        (square.backing == target.light ? on_light : on_dark).insert(mixture_text(square.top));
        for (const ResinShare& share : square.top)
            CHECK(share.fraction == Approx(1.0 / static_cast<double>(square.top.size())));
    }
    CHECK(target.squares.size() == 62);
    CHECK(on_light.size() == 31);
    CHECK(on_light == on_dark);
    CHECK(on_light.contains("C:20+K:20+M:20+W:20+Y:20"));
    const Target back = parse_target(target_text(target), "target.json");
    CHECK(target_text(back) == target_text(target));
    CHECK_THROWS_WITH(target_of(TargetLayout::e, {"A", "B", "C", "D", "E", "K", "W"}), Contains("7 resins"));
}

TEST_CASE("where clear resin is among the resins two deep squares of it lie in the light resin") {
    const Target target = target_of(TargetLayout::b, {"C", "M", "Y", "K", "W", "T"});
    const std::vector<TargetBox> boxes = target_boxes(target);
    std::vector<double> depths;
    for (const TargetSquare& square : target.squares) {
        if (square.depth_mm == 0) continue;
        depths.push_back(square.depth_mm);
        CHECK(mixture_text(square.top) == "T");
        CHECK(square.backing == "W");
        CHECK(square.area.size().x() == Approx(2.7 * square.depth_mm).epsilon(0.01));
        const Eigen::Vector2d middle = square.area.center();
        const double top = target.height_mm(), floor = top - square.depth_mm;
        CHECK(floor > 2.99);
        CHECK(share_at(boxes, {middle.x(), middle.y(), top - 0.01}, 5) == 1);
        CHECK(share_at(boxes, {middle.x(), middle.y(), floor + 0.01}, 5) == 1);
        CHECK(share_at(boxes, {middle.x(), middle.y(), floor - 0.01}, 4) == 1);
        CHECK(square.area.max_mm.y() + 4.99 < target.dark_half.min_mm.y());
        const TargetSquare back = parse_target(target_text(target), "target.json").squares[target.squares.size() - 1];
        CHECK(back.depth_mm == Approx(10).margin(0.02));
    }
    REQUIRE(depths.size() == 2);
    CHECK(depths[0] == Approx(5).margin(0.02));
    CHECK(depths[1] == Approx(10).margin(0.02));
    CHECK(target_of(TargetLayout::a, {"T", "K", "W"}).squares.size() == 8);
    CHECK(target_of(TargetLayout::e, {"T", "K", "W"}).squares.size() == 14);
}

TEST_CASE("strips are checkers of growing cells, along x and along y, on light and on dark") {
    TargetOptions options = target_options(TargetLayout::b);
    options.strips = {{"Y", "W"}, {"K", "W"}};
    const Target target = lay_out_target(options);
    CHECK(target.squares.size() == target_of(TargetLayout::b).squares.size() + 2 * 2 * 27);
    std::set<std::array<int, 2>> on_light, on_dark;
    for (const TargetSquare& square : target.squares)
        if (square.is_checker()) (square.backing == "W" ? on_light : on_dark).insert(square.cell);
    CHECK(on_light.size() == 27);
    for (const std::array<int, 2> cell : {std::array{1, 8}, {2, 8}, {3, 8}, {16, 8}, {16, 1}, {16, 2}, {16, 16}})
        CHECK(on_light.contains(cell));
    CHECK(on_dark == on_light);
    const std::string text = target_text(target);
    CHECK(target_text(parse_target(text, "target.json")) == text);
    CHECK_THROWS_WITH(parse_target(replaced(text, "\"cell\": [1, 8]", "\"cell\": [1.5, 8]"), "t"), Contains("whole"));
    CHECK_THROWS_WITH(parse_target(replaced(text, "\"cell\": [1, 8]", "\"cell\": [0, 8]"), "t"), Contains("cell"));
    std::size_t boxes = 0;
    for (const TargetBox& box : target_boxes(target)) boxes += box.cell[0] > 0;
    CHECK(boxes == 2 * 2 * 27);
}

TEST_CASE("descriptions read back as they were written") {
    for (const TargetLayout layout : {TargetLayout::a, TargetLayout::b, TargetLayout::c}) {
        const Target target = target_of(layout, {"C", "M", "Y", "K", "W", "T"});
        const std::string text = target_text(target);
        const Target back = parse_target(text, "target.json");
        CHECK(target_text(back) == text);
        CHECK(back.squares.size() == target.squares.size());
        CHECK(back.squares[3].top == target.squares[3].top);
        CHECK(back.squares[3].area.min_mm == target.squares[3].area.min_mm);
        CHECK(back.markers[2].id == target.markers[2].id);
        CHECK(back.base_mm == target.base_mm);
    }
}

TEST_CASE("faulty descriptions are refused with the place and the rule") {
    const std::string text = target_text(target_of(TargetLayout::b));
    const auto refused = [&](const std::string& from, const std::string& to, const std::string& word) {
        CHECK_THROWS_WITH(parse_target(replaced(text, from, to), "t.json"), Contains("t.json") && Contains(word));
    };
    refused("voxtone-target", "voxtone-layers", "format");
    refused("\"version\": 1", "\"version\": 2", "version");
    refused("\"base_mm\"", "\"bass_mm\"", "base_mm");
    refused("\"top\": \"M\"", "\"top\": \"Q\"", "square 2");
    refused("K:10+W:90", "K:10+W:80", "top");
    refused("\"backing\": \"W\"", "\"backing\": \"K\"", "square 1");
    refused("\"backing\": \"W\"", "\"backing\": \"M\"", "square 1");
    refused("[14, 50, 24, 60]", "[14, 50, 29, 60]", "overlap");
    refused("[14, 50, 24, 60]", "[14, 50, 24, 600]", "square 1");
    refused("DICT_5X5_1000", "DICT_4X4_50", "dictionary");
    refused("\"dark\": \"K\"", "\"dark\": \"W\"", "dark");
    refused("\"size_mm\": [100, 74]", "\"size_mm\": [90, 74]", "t.json");
    for (std::size_t cut = 0; cut + 2 < text.size(); cut += 7)
        CHECK_THROWS_AS(parse_target(text.substr(0, cut), "cut"), InputError);
}

TEST_CASE("boxes fill every place of a target with what the description says") {
    const Target target = target_of(TargetLayout::c);
    const std::vector<TargetBox> boxes = target_boxes(target);
    const std::size_t K = 3, W = 4;
    for (const TargetSquare& square : target.squares) {
        const Eigen::Vector2d p = square.area.center();
        const double top = target.base_mm + target.top_mm / 2;
        for (std::size_t r = 0; r < target.roles.size(); ++r) {
            double expected = 0;
            for (const ResinShare& share : square.top)
                if (share.role == target.roles[r]) expected = share.fraction;
            CHECK(share_at(boxes, {p.x(), p.y(), top}, r) == expected);
            CHECK(share_at(boxes, {p.x(), p.y(), target.base_mm / 2}, r) ==
                  (target.roles[r] == square.backing ? 1 : 0));
        }
    }
    CHECK(share_at(boxes, {1, 1, 0.1}, W) == 1);
    CHECK(share_at(boxes, {target.size_mm.x() - 0.1, target.size_mm.y() - 0.1, target.base_mm + 0.1}, W) == 1);
    const Area border = target.markers[0].area;  // its outermost cells are dark, on top only
    CHECK(share_at(boxes, {border.min_mm.x() + 0.1, border.min_mm.y() + 0.1, target.base_mm + 0.1}, K) == 1);
    CHECK(share_at(boxes, {border.min_mm.x() + 0.1, border.min_mm.y() + 0.1, target.base_mm - 0.1}, W) == 1);
    for (const TargetBox& box : boxes) {
        double sum = 0;
        for (const double fraction : box.fractions) sum += fraction;
        CHECK(sum == Approx(1).margin(1e-12));
    }
}

TEST_CASE("no marker of a target looks like another one turned or mirrored") {
    const auto moved = [](const std::vector<bool>& cells, int turns, bool mirrored) {
        std::vector<bool> out = cells;
        const auto at = [](int row, int column) { return std::size_t(row * marker_cells + column); };
        if (mirrored)
            for (int r = 0; r < marker_cells; ++r)
                for (int c = 0; c < marker_cells; ++c) out[at(r, c)] = cells[at(r, marker_cells - 1 - c)];
        for (; turns > 0; --turns) {
            const std::vector<bool> before = out;
            for (int r = 0; r < marker_cells; ++r)
                for (int c = 0; c < marker_cells; ++c) out[at(c, marker_cells - 1 - r)] = before[at(r, c)];
        }
        return out;
    };
    for (const TargetLayout layout : {TargetLayout::a, TargetLayout::b, TargetLayout::c}) {
        const Target target = target_of(layout);
        for (const TargetMarker& m : target.markers)
            for (const TargetMarker& n : target.markers)
                for (int turns = 0; turns < 4; ++turns)
                    for (const bool mirrored : {false, true})
                        if (m.id != n.id || turns > 0 || mirrored)
                            CHECK(marker_pattern(m.id) != moved(marker_pattern(n.id), turns, mirrored));
    }
}

TEST_CASE("targets of other content have other markers") {
    std::vector<std::vector<int>> each;
    for (const TargetLayout layout : {TargetLayout::a, TargetLayout::b, TargetLayout::c})
        for (const std::vector<std::string>& roles : {std::vector<std::string>{"W", "K"},
                                                      {"C", "M", "Y", "K", "W"},
                                                      {"C", "M", "Y", "K", "W", "T"},
                                                      {"M", "C", "Y", "K", "W"}}) {
            std::vector<int> numbers;
            for (const TargetMarker& marker : target_of(layout, roles).markers) numbers.push_back(marker.id);
            for (const std::vector<int>& other : each) {
                int shared = 0;
                for (std::size_t m = 0; m < 4; ++m) shared += other[m] == numbers[m];
                CHECK(shared < 3);  // three are enough to find a target by
            }
            each.push_back(numbers);
        }
    const Target once = target_of(TargetLayout::b), again = target_of(TargetLayout::b);
    for (std::size_t m = 0; m < 4; ++m) CHECK(once.markers[m].id == again.markers[m].id);
}
