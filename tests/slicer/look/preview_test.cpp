// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/preview.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

struct Body {
    std::vector<Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vector3f> rgb;  // per triangle
    [[nodiscard]] ColouredSurface surface() const {
        return {positions, triangles, [this](std::uint32_t t, float, float) { return rgb[t]; }};
    }
    void add_box(const Vector3d& low, const Vector3d& high, const Vector3f& colour) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (int i = 0; i < 8; ++i)
            positions.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
        for (const auto& quad :
             {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
            for (const auto& corners : {std::array{0, 1, 2}, {0, 2, 3}}) {
                triangles.push_back({first + std::uint32_t(quad[std::size_t(corners[0])]),
                                     first + std::uint32_t(quad[std::size_t(corners[1])]),
                                     first + std::uint32_t(quad[std::size_t(corners[2])])});
                rgb.push_back(colour);
            }
    }
};

/// Grey cube about the origin, with a red box on +x, a green one on +y, a blue one on +z.
Body marker() {
    Body body;
    body.add_box(Vector3d(-2, -2, -2), Vector3d(2, 2, 2), {0.3f, 0.3f, 0.3f});
    body.add_box(Vector3d(2, -1, -1), Vector3d(4, 1, 1), {1, 0, 0});
    body.add_box(Vector3d(-1, 2, -1), Vector3d(1, 4, 1), {0, 1, 0});
    body.add_box(Vector3d(-1, -1, 2), Vector3d(1, 1, 4), {0, 0, 1});
    return body;
}

/// Mean position (right, up; from the middle, in pixels) of the pixels that show this channel alone; none: NaN.
Vector2d place_of(const io::LinearPicture& picture, int channel) {
    Vector2d sum(0, 0);
    double weight = 0;
    for (std::uint32_t y = 0; y < picture.height_px; ++y)
        for (std::uint32_t x = 0; x < picture.width_px; ++x) {
            const Vector4f& pixel = picture.pixels[std::size_t{y} * picture.width_px + x];
            if (pixel[3] < 1 || pixel[channel] < 0.9f || pixel[(channel + 1) % 3] > 0.1f) continue;
            sum += Vector2d(x + 0.5 - picture.width_px / 2.0, picture.height_px / 2.0 - y - 0.5);
            ++weight;
        }
    return sum / weight;
}

std::vector<Preview> render(const ColouredSurface& surface, View view, const PreviewOptions& options) {
    return render_views(surface, std::span(&view, 1), options);
}

double covered_px(const io::LinearPicture& picture) {
    double sum = 0;
    for (const Vector4f& pixel : picture.pixels) sum += pixel[3];
    return sum;
}

}  // namespace

TEST_CASE("Lit views tell faces apart that plain ones show alike") {
    Body body;
    body.add_box(Vector3d(0, 0, 0), Vector3d(4, 2, 2), {0.5f, 0.5f, 0.5f});
    body.add_box(Vector3d(4, 0, 0), Vector3d(8, 2, 2), {0.5f, 0.5f, 0.5f});
    for (auto& p : body.positions) p = Eigen::AngleAxisd(0.5, Vector3d::UnitX()) * p;
    PreviewOptions options;
    const auto shades = [&](bool lit) {
        options.lit = lit;
        const Preview front = render(body.surface(), View::front, options).front();
        float low = 1, high = 0;
        for (const Vector4f& pixel : front.picture.pixels)
            if (pixel[3] == 1) low = std::min(low, pixel[0]), high = std::max(high, pixel[0]);
        return std::array{low, high};
    };
    CHECK(shades(false) == std::array{0.5f, 0.5f});
    CHECK(shades(true)[0] >= 0.5f * 0.6f);
    CHECK(shades(true)[1] - shades(true)[0] > 0.05f);
}

TEST_CASE("Every view shows its side, the right way round") {
    struct Expected {
        View view;
        int right, up,
            towards;  // channel of the box on the picture's right (negative: left), up (down), nearest (hidden)
    };
    // 1, 2, 3: the boxes on +x, +y, +z.
    for (const auto& [view, right, up, towards] : {Expected{View::front, 1, 3, -2},
                                                   {View::back, -1, 3, 2},
                                                   {View::right, 2, 3, 1},
                                                   {View::left, -2, 3, -1},
                                                   {View::top, 1, 2, 3},
                                                   {View::bottom, 1, -2, -3}}) {
        INFO(view_name(view));
        const Preview preview = render(marker().surface(), view, {10, 2, 3}).front();
        const auto side = [&](int box, int axis) {
            const double place = place_of(preview.picture, std::abs(box) - 1)[axis];
            const double other = place_of(preview.picture, std::abs(box) - 1)[1 - axis];
            CHECK(std::abs(place) > 10);
            CHECK(std::abs(place) > std::abs(other));
            return (place > 0) == (box > 0);
        };
        CHECK(side(right, 0));
        CHECK(side(up, 1));
        const Vector2d nearest = place_of(preview.picture, std::abs(towards) - 1);
        if (towards > 0)
            CHECK(nearest.norm() < 20);
        else
            CHECK(std::isnan(nearest.x()));
        const Eigen::Matrix3d axes = view_axes(view);
        CHECK((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-15);
        CHECK(axes.determinant() == Approx(1));
    }
    // From the front, the right and above: red right, blue up, green hidden behind.
    const Preview preview = render(marker().surface(), View::three_quarter, {10, 2, 3}).front();
    const Eigen::Matrix3d axes = view_axes(View::three_quarter);
    CHECK(axes.row(2).dot(Vector3d(1, -1, 1)) > 0);
    CHECK(axes.row(1).dot(Vector3d::UnitZ()) > 0.7);
    CHECK(axes.determinant() == Approx(1));
}

TEST_CASE("Pictures are true to scale") {
    // 12 x 7 mm seen from above, turned by an angle so that no edge lies along the samples.
    Body body;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix();
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {12.0, 0.0}, {12.0, 7.0}, {0.0, 7.0}})
        body.positions.push_back(turn * Vector3d(x, y, 5));
    body.triangles = {{0, 1, 2}, {0, 3, 2}};  // the second is seen from behind
    body.rgb = {{1, 1, 1}, {1, 1, 1}};
    for (const double scale : {3.0, 10.0, 23.7})
        for (const int samples : {1, 2, 4}) {
            const Preview preview = render(body.surface(), View::top, {scale, samples, 2}).front();
            // A sample is right unless the outline runs through its square: at most 2 per sample width and axis.
            const double sample_mm = 1 / (scale * samples), outline_mm = 2 * (12 + 7);
            CHECK(std::abs(covered_px(preview.picture) / (scale * scale) - 84) < outline_mm * sample_mm);
            const double width_mm = 12 * std::cos(0.3) + 7 * std::sin(0.3);
            CHECK(preview.picture.width_px == std::uint32_t(std::ceil(width_mm * scale)) + 4);
        }
}

TEST_CASE("The fitting scale fills the picture and no more", "[slow]") {
    const Body body = marker();
    for (const int longest_px : {100, 333, 1000}) {
        PreviewOptions options;
        options.px_per_mm = fitting_scale(body.surface(), all_views(), longest_px, options);
        std::uint32_t longest = 0;
        for (const Preview& preview : render_views(body.surface(), all_views(), options))
            longest = std::max({longest, preview.picture.width_px, preview.picture.height_px});
        CHECK(longest == std::uint32_t(longest_px));
    }
}

TEST_CASE("The picture agrees with rays through every sample") {
    // Forty random triangles through each other, seen from the front at one sample a pixel.
    Body body;
    RandomStream random(11, 0);
    for (std::uint32_t t = 0; t < 40; ++t) {
        for (int c = 0; c < 3; ++c)
            body.positions.emplace_back(10 * random.uniform(), 10 * random.uniform(), 10 * random.uniform());
        body.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        body.rgb.emplace_back(float(t) / 64, 0.5f, 0.5f);
    }
    const Preview preview = render(body.surface(), View::front, {9, 1, 0}).front();
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : body.positions) box.extend(p);
    std::size_t wrong = 0, seen = 0;
    for (std::uint32_t y = 0; y < preview.picture.height_px; ++y)
        for (std::uint32_t x = 0; x < preview.picture.width_px; ++x) {
            const double px = box.center().x() + (x + 0.5 - preview.picture.width_px / 2.0) / 9;
            const double pz = box.center().z() - (y + 0.5 - preview.picture.height_px / 2.0) / 9;
            double nearest = std::numeric_limits<double>::infinity();
            float expected = -1;
            for (const auto& t : body.triangles) {
                const Vector3d &a = body.positions[t[0]], ab = body.positions[t[1]] - a, ac = body.positions[t[2]] - a;
                Eigen::Matrix2d m;
                m << ab.x(), ac.x(), ab.z(), ac.z();
                const Vector2d uv = m.inverse() * Vector2d(px - a.x(), pz - a.z());
                if (uv.x() < 0 || uv.y() < 0 || uv.sum() > 1) continue;
                const double depth = a.y() + uv.x() * ab.y() + uv.y() * ac.y();
                if (depth < nearest) {
                    nearest = depth;
                    expected = body.rgb[std::size_t(&t - body.triangles.data())].x();
                }
            }
            const Vector4f& pixel = preview.picture.pixels[std::size_t{y} * preview.picture.width_px + x];
            wrong += (pixel[3] > 0 ? pixel[0] : -1) != expected;
            seen += expected >= 0;
        }
    CHECK(seen > 4000);
    CHECK(wrong == 0);
}

TEST_CASE("No light falls through between neighbours") {
    // A square in a fan of thin triangles round an inner point, seen from above.
    Body body;
    body.positions.emplace_back(3.123456, 6.54321, 0);
    for (int side = 0; side < 4; ++side)
        for (int i = 0; i < 50; ++i) {
            const double s = i / 5.0;
            body.positions.push_back(side == 0   ? Vector3d(s, 0, 0)
                                     : side == 1 ? Vector3d(10, s, 0)
                                     : side == 2 ? Vector3d(10 - s, 10, 0)
                                                 : Vector3d(0, 10 - s, 0));
        }
    for (std::uint32_t i = 0; i < 200; ++i) body.triangles.push_back({0, 1 + i, 1 + (i + 1) % 200});
    body.rgb.assign(200, {1, 1, 1});
    for (const double scale : {8.0, 9.1, 10.0}) {
        const Preview preview = render(body.surface(), View::top, {scale, 4, 0}).front();
        std::size_t holes = 0;
        for (std::uint32_t y = 1; y + 1 < preview.picture.height_px; ++y)
            for (std::uint32_t x = 1; x + 1 < preview.picture.width_px; ++x)
                holes += preview.picture.pixels[std::size_t{y} * preview.picture.width_px + x][3] < 1;
        CHECK(holes == 0);
    }
}

TEST_CASE("A pixel is the mean of its colours in linear light") {
    // Colour runs from black to white over 10 mm; ten pixels.
    Body body;
    body.positions = {{0, 0, 0}, {10, 0, 0}, {0, 0, 10}};
    body.triangles = {{0, 1, 2}};
    ColouredSurface surface = body.surface();
    surface.colour = [](std::uint32_t, float u, float) { return Vector3f(u, 1 - u, 0.25f); };
    const Preview preview = render(surface, View::front, {1, 4, 0}).front();
    REQUIRE(preview.picture.width_px == 10);
    for (std::uint32_t x = 0; x < 9; ++x) {
        const Vector4f& pixel = preview.picture.pixels[9 * 10 + x];
        CHECK(pixel[3] == 1);
        CHECK(pixel[0] == Approx((x + 0.5) / 10).margin(1e-6));
        CHECK(pixel[1] == Approx(1 - (x + 0.5) / 10).margin(1e-6));
        CHECK(pixel[2] == 0.25f);
    }
}

TEST_CASE("Colours finer than a pixel are averaged when asked for") {
    // Stripes of a quarter of a pixel, black and white in turn.
    Body body;
    body.positions = {{0, 0, 0}, {10, 0, 0}, {0, 0, 10}};
    body.triangles = {{0, 1, 2}};
    ColouredSurface surface = body.surface();
    surface.colour = [](std::uint32_t, float u, float) -> Vector3f {
        return Vector3f::Constant(int(u * 40) % 2 ? 1.0f : 0.0f);
    };
    PreviewOptions options{1, 4, 0};
    options.colour_per_sample = true;
    const Preview preview = render(surface, View::front, options).front();
    for (std::uint32_t x = 0; x < 9; ++x) CHECK(preview.picture.pixels[9 * 10 + x] == Vector4f(0.5f, 0.5f, 0.5f, 1));
    options.colour_per_sample = false;
    CHECK(render(surface, View::front, options).front().picture.pixels[90][0] != 0.5f);
}

TEST_CASE("Only the three-quarter view is lit") {
    const Body body = marker();
    for (const Preview& preview : render_views(body.surface(), all_views(), {8, 2, 2})) {
        float least = 1, most = 0;
        for (const Vector4f& pixel : preview.picture.pixels)
            if (pixel[3] == 1 && std::abs(pixel[0] - pixel[1]) < 1e-6f && std::abs(pixel[0] - pixel[2]) < 1e-6f) {
                least = std::min(least, pixel[0]);
                most = std::max(most, pixel[0]);
            }
        INFO(view_name(preview.view));
        if (preview.view == View::three_quarter) {
            CHECK(least >= 0.6f * 0.3f - 1e-6f);
            CHECK(most <= 0.3f);
            CHECK(most - least > 0.02f);
        } else {
            CHECK(least == 0.3f);
            CHECK(most == 0.3f);
        }
    }
}

TEST_CASE("Pictures carry the same bits for any number of threads") {
    const Body body = marker();
    std::vector<std::vector<Preview>> runs;
    for (const std::size_t threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        runs.push_back(render_views(body.surface(), all_views(), {13.7, 3, 1}));
    }
    for (std::size_t v = 0; v < all_views().size(); ++v) {
        CHECK(runs[0][v].picture.pixels == runs[1][v].picture.pixels);
        CHECK(runs[0][v].picture.pixels == runs[2][v].picture.pixels);
    }
}

TEST_CASE("Surfaces of one mesh are drawn as each is alone") {
    const Body body = marker();
    Body other = body;
    for (std::size_t t = 0; t < other.rgb.size(); ++t) other.rgb[t] = Vector3f::Constant(0.01f * float(t));
    const ColouredSurface first = body.surface();
    const std::array surfaces{first, ColouredSurface{first.positions_mm, first.triangles, other.surface().colour}};
    const PreviewOptions options{13.7, 3, 1, true};
    const auto drawn = render_views(surfaces, all_views(), options);
    REQUIRE(drawn.size() == 2);
    for (std::size_t s = 0; s < 2; ++s) {
        const std::vector<Preview> alone = render_views(surfaces[s], all_views(), options);
        for (std::size_t v = 0; v < all_views().size(); ++v) {
            CHECK(drawn[s][v].view == alone[v].view);
            CHECK(drawn[s][v].picture.pixels == alone[v].picture.pixels);
        }
    }
    CHECK(drawn[0][0].picture.pixels != drawn[1][0].picture.pixels);
}

TEST_CASE("Nothing, slivers and too much") {
    Body body;
    CHECK(covered_px(render(body.surface(), View::front, {}).front().picture) == 0);
    CHECK(fitting_scale(body.surface(), all_views(), 100) == 1);
    body.positions = {{0, 0, 0}, {5, 0, 5}, {10, 0, 10}};
    body.triangles = {{0, 1, 2}, {0, 0, 1}};
    body.rgb.assign(2, {1, 1, 1});
    CHECK(covered_px(render(body.surface(), View::front, {}).front().picture) == 0);
    CHECK_THROWS_AS(render(body.surface(), View::front, {1000, 1, 0}), InputError);
    Progress progress;
    progress.cancel();
    CHECK_THROWS_AS(render_views(marker().surface(), all_views(), {}, &progress), Cancelled);
}
