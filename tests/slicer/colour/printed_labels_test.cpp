// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels read in what is predicted of their print: all letters, some, none; codes.
#include "slicer/colour/printed_labels.h"

#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "drawn_page.h"
#include "slicer/surface/mark_shape.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// On a page of 20 x 8 mm, its lower left corner at 2, 2 mm of the page, which lies at 5, 5, 0 of the model.
struct Marked {
    explicit Marked(const MarkOptions& options) : mark{options}, shape(shape_of(options, {})) {
        io::Decal& decal = decals.emplace_back();
        decal.width_mm = shape.width_mm, decal.height_mm = shape.height_mm;
        decal.corner_mm = {7, 7, 1};
        decal.first_hit = {2, 2, std::vector<float>(4, 0.83f)};  // two cells are 0.17 mm
        decal.picture = coloured(shape, &black, std::nullopt);
    }
    [[nodiscard]] float ink_at(double x, double y) const {
        const int column = int(std::floor((x - 2) / shape.ink.pixel_mm)),
                  row = shape.ink.height_px - 1 - int(std::floor((y - 2) / shape.ink.pixel_mm));
        if (column < 0 || row < 0 || column >= shape.ink.width_px || row >= shape.ink.height_px) return 0;
        return float(shape.ink.at(column, row)) / 255;
    }
    /// `ground`: linear, at x, y of the page; `kept`: of the ink.
    template <class Ground>
    [[nodiscard]] PrintedLabel printed(const Ground& ground, float kept = 1) const {
        const JobPrediction page = test::page_of(20, 8, [&](double x, double y) {
            const float below = ground(x);
            return Eigen::Vector3f::Constant(below - kept * ink_at(x, y) * (below - 0.02f));
        });
        const auto labels = printed_labels(page, mark, decals, {5, 5, 0}, 300);
        REQUIRE(labels.size() == 1);
        return labels[0];
    }
    std::vector<MarkOptions> mark;
    std::vector<io::Decal> decals;
    MarkShape shape;
    Eigen::Vector3f black = Eigen::Vector3f::Zero();
};

MarkOptions text_mark(const std::string& text, double size_mm) {
    MarkOptions mark;
    mark.text = text, mark.size_mm = size_mm, mark.font = io::default_font;
    return mark;
}

}  // namespace

TEST_CASE("A serial number is read letter by letter: each of them has to stand out from what it lies on") {
    const auto white = [](double) { return 0.9f; };
    const Marked label(text_mark("Aji-17", 2));
    const PrintedLabel whole = label.printed(white);
    CHECK(whole.is_read);
    CHECK((whole.letters == 5 && whole.unread == 0));  // dots belong to j and i, and a dash is none
    CHECK(whole.contrast > 0.7);
    for (const std::uint32_t cell : whole.cells) CHECK(cell < 235u * 94u);
    // The spot of a cow below its end.
    const PrintedLabel spotted =
        label.printed([&](double x) { return x > 2 + 0.75 * label.shape.width_mm ? 0.02f : 0.9f; });
    CHECK_FALSE(spotted.is_read);
    CHECK((spotted.unread >= 1 && spotted.unread <= 2));
    const PrintedLabel gone = label.printed(white, 0.1f);
    CHECK(gone.unread == gone.letters);
    CHECK_FALSE(Marked(text_mark("A-17", 0.5)).printed(white).is_read);  // for its size
}

TEST_CASE("A code on a body is read by what it says") {
    MarkOptions mark;
    mark.kind = MarkKind::data_matrix, mark.text = "A-1-01", mark.size_mm = 5;
    const Marked code(mark);
    CHECK(code.printed([](double) { return 0.9f; }).is_read);
    CHECK_FALSE(code.printed([](double) { return 0.9f; }, 0.02f).is_read);
}

TEST_CASE("Marks that are raised, uncoloured or pictures are not looked for") {
    MarkOptions mark = text_mark("A-17", 2);
    const Marked label(mark);
    const JobPrediction page = test::page_of(20, 8, [](double, double) { return Eigen::Vector3f::Constant(0.9f); });
    const auto found = [&](const MarkOptions& options) {
        return printed_labels(page, std::vector{options}, label.decals, {5, 5, 0}, 300).size();
    };
    CHECK(found(mark) == 1);
    mark.relief_voxels = 3;
    CHECK(found(mark) == 0);
    mark.relief_voxels = 0, mark.ink = MarkInk::none;
    CHECK(found(mark) == 0);
    mark.ink = MarkInk::contrast, mark.kind = MarkKind::picture;
    CHECK(found(mark) == 0);
}
