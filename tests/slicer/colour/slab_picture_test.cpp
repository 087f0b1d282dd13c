// SPDX-License-Identifier: GPL-3.0-or-later
//
// Letters of a picture that is printed smaller and smaller: the same ones are judged, and ever fewer can be read.
#include "slicer/colour/slab_picture.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "drawn_page.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"
#include "slicer/colour/type_size.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr int columns = 480, rows = 240;

/// `grey_at`: linear, of a pixel, rows from the top.
template <class GreyAt>
io::TexturedMesh slab_with(const GreyAt& grey_at) {
    io::TexelImage image{columns, rows, {}, {}};
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto code = std::uint8_t(std::lround(255 * optics::srgb_encode(double(grey_at(x, y)))));
            image.srgb8.insert(image.srgb8.end(), {code, code, code, 255});
        }
    io::TexturedMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material_of_triangle = {0};
    mesh.corner_uv = {{Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1)}};
    mesh.materials.resize(1);
    mesh.materials[0].texture = std::make_shared<io::Texture>(std::move(image), io::Wrap::clamp, io::Wrap::clamp);
    return mesh;
}

/// The picture as wide as this, asked for cell by cell, and printed as light leaves it that goes 0.2 mm far.
JobPrediction printed(const io::TexturedMesh& mesh, double width_mm) {
    const io::Texture& picture = *mesh.materials[0].texture;
    const auto blurred = [&](double sigma_mm) {
        const float level = float(std::log2(std::max(1.0, 2 * sigma_mm / width_mm * columns)));
        return [&picture, width_mm, level](double x, double y) {
            return picture.sample(float(x / width_mm), float(2 * y / width_mm), level);
        };
    };
    JobPrediction p = test::page_of(width_mm, width_mm / 2, blurred(test::drawn_cell_mm / 2));
    p.predicted.rgb = test::page_of(width_mm, width_mm / 2, blurred(0.2)).target;
    return p;
}

}  // namespace

TEST_CASE("A slab's picture is looked at where it lies upright, and nowhere else") {
    io::TexturedMesh mesh = slab_with([](int, int) { return 0.5; });
    CHECK(upright_picture(&mesh) == mesh.materials[0].texture.get());
    const auto seen_with = [&](const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
        mesh.corner_uv = {{a, b, c}};
        return upright_picture(&mesh) != nullptr;
    };
    CHECK(seen_with({0.2f, 0.1f}, {0.7f, 0.1f}, {0.7f, 0.9f}));  // a part of it
    CHECK_FALSE(seen_with({1, 0}, {0, 0}, {0, 1}));              // mirrored
    CHECK_FALSE(seen_with({0, 1}, {1, 1}, {1, 0}));              // upside down
    CHECK_FALSE(seen_with({0, 0}, {0, 1}, {-1, 1}));             // on its side
    mesh.corner_uv.clear();
    CHECK(upright_picture(&mesh) == nullptr);
    CHECK(upright_picture(nullptr) == nullptr);
}

TEST_CASE("However small a picture is printed, its letters are judged as it was given", "[slow]") {
    // 24 x 12 mm of type of 4 and of 9 pt, which is read at that size.
    const test::SetLine small("Serial 00417-B, lot 9", 4, 1, 2), large("Open 10-18", 9, 1, 7);
    const io::TexturedMesh mesh = slab_with([&](int x, int y) {
        const double at_x = 24 * (x + 0.5) / columns, at_y = 24 * (rows - y - 0.5) / columns;
        return 1 - 0.98f * std::max(small.at(at_x, at_y), large.at(at_x, at_y));
    });
    double least_unread = 1;
    for (const double width_mm : {3.0, 6.0, 12.0, 24.0}) {
        CAPTURE(width_mm);
        const JobPrediction print = printed(mesh, width_mm);
        const auto type = unreadable_type(print, 300, picture_pages(print, &mesh));
        const double unread = type ? double(type->unread) / double(type->letters) : 0;
        CHECK(unread <= least_unread);
        least_unread = unread;
        if (width_mm <= 6) {
            REQUIRE(type);
            CHECK(type->letters >= 20);  // 25
            CHECK(type->unread == type->letters);
            CHECK(type->asked.maxCoeff() < 0.1f);
            CHECK(type->largest_mm == Approx(9 * 0.3528 * width_mm / 24).epsilon(0.15));
        }
        // What is asked for cell by cell is too coarse to be told as type.
        if (width_mm == 3) CHECK_FALSE(unreadable_type(print, 300));
    }
    CHECK(least_unread == 0);
}

TEST_CASE("Nothing is looked for in a photograph, nor where the print is as fine as its picture") {
    const io::TexturedMesh waves = slab_with([](int x, int y) {
        return float(0.5 + 0.2 * std::sin(0.11 * x + 0.05 * y) + 0.2 * std::cos(0.07 * y - 0.03 * x));
    });
    CHECK(picture_pages(printed(waves, 6), &waves).empty());
    const io::TexturedMesh page = slab_with([](int x, int) { return x < 100 ? 0.0f : 1.0f; });
    CHECK(picture_pages(printed(page, 6), &page).size() > 3);
    CHECK(picture_pages(printed(page, 42), &page).empty());
    CHECK(picture_pages(printed(page, 6), nullptr).empty());
    for (const PicturePage& fine : picture_pages(printed(page, 6), &page)) {
        CHECK(fine.page.cell_um[0] == Approx(1e3 * test::drawn_cell_mm).epsilon(0.05));
        CHECK(fine.page.target.size() == fine.page.predicted.rgb.size());
        CHECK(fine.page.seen.regions.size() == 2);
    }
}

TEST_CASE("What the picture has beside its cut was not asked for, and is not lost") {
    const io::TexturedMesh mesh = slab_with([](int x, int) { return x < 160 && x % 4 < 2 ? 0.0f : 0.9f; });
    const JobPrediction whole = printed(mesh, 12);
    REQUIRE(lost_lines(whole, picture_pages(whole, &mesh)));
    JobPrediction cut;
    cut.cell_um = whole.cell_um, cut.predicted.surface.cell_voxels = whole.predicted.surface.cell_voxels;
    for (std::size_t i = 0; i < whole.target.size(); ++i) {
        const optics::SurfaceCell& cell = whole.predicted.surface.cells[i];
        // One corner keeps the frame as it is.
        if (cell.centre_mm[0] < 4.2f && (cell.centre_mm[0] > 0.3f || cell.centre_mm[1] > 0.3f)) continue;
        cut.predicted.surface.cells.push_back(cell);
        cut.target.push_back(Eigen::Vector3f::Constant(0.9f)), cut.predicted.rgb.push_back(cut.target.back());
    }
    cut.seen.regions = halftone::colour_regions(cut.predicted.surface, cut.target);
    CHECK_FALSE(lost_lines(cut, picture_pages(cut, &mesh)));
}

TEST_CASE("Of a word of three letters that is gone it is said that it is lost") {
    const test::SetLine word("No 7", 6, 2, 2);
    const io::TexturedMesh mesh = slab_with(
        [&](int x, int y) { return 1 - 0.98f * word.at(24 * (x + 0.5) / columns, 24 * (rows - y - 0.5) / columns); });
    const JobPrediction gone = printed(mesh, 6), there = printed(mesh, 48);
    CHECK_FALSE(unreadable_type(gone, 300, picture_pages(gone, &mesh)));
    const auto lost = lost_lines(gone, picture_pages(gone, &mesh));
    REQUIRE(lost);
    CHECK(lost->kept < 0.3);
    CHECK(lost->asked.maxCoeff() < 0.4f);
    for (const std::uint32_t cell : lost->cells) CHECK(gone.predicted.surface.cells[cell].centre_mm[0] < 2);
    CHECK_FALSE(lost_lines(there, picture_pages(there, &mesh)));
}
