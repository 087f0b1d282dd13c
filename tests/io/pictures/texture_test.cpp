// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/texture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "io/models/fill_gutters.h"
#include "io/models/texel_coverage.h"
#include "optics/colour/colour.h"

using namespace voxtone::io;
using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

TexelImage image8(std::uint32_t width, std::uint32_t height, const auto& colour) {
    TexelImage image{width, height, std::vector<std::uint8_t>(4 * std::size_t{width} * height), {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::array<int, 3> rgb = colour(x, y);
            for (int c = 0; c < 3; ++c)
                image.srgb8[4 * (std::size_t{y} * width + x) + c] = static_cast<std::uint8_t>(rgb[c]);
            image.srgb8[4 * (std::size_t{y} * width + x) + 3] = 255;
        }
    return image;
}

TexelImage noise(std::uint32_t width, std::uint32_t height) {
    return image8(width, height, [&](std::uint32_t x, std::uint32_t y) {
        voxtone::RandomStream random(7, std::uint64_t{y} * width + x);
        return std::array{int(random.bits() & 255), int(random.bits() & 255), int(random.bits() & 255)};
    });
}

float linear(int code) { return static_cast<float>(voxtone::optics::srgb_decode(code / 255.0)); }

/// By the definition, all in memory: weights of an average along one side.
std::vector<float> weights_of(std::uint32_t i, std::uint32_t size) {
    if (size == 1) return {1};
    if (size % 2 == 0) return {0.5f, 0.5f};
    const auto k = static_cast<float>(size / 2), all = static_cast<float>(size), at = static_cast<float>(i);
    return {(k - at) / all, k / all, (at + 1) / all};
}

/// Linear light of a level, three values a texel, from that of the one above.
std::vector<float> level_below(const std::vector<float>& above, std::uint32_t width, std::uint32_t height) {
    std::vector<float> below;
    for (std::uint32_t y = 0; y < std::max(height / 2, 1u); ++y) {
        std::vector<float> mean(3 * std::size_t{width}, 0.0f);
        const std::vector<float> rows = weights_of(y, height);
        for (std::size_t j = 0; j < rows.size(); ++j)
            for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += rows[j] * above[(2 * y + j) * mean.size() + i];
        for (std::uint32_t x = 0; x < std::max(width / 2, 1u); ++x) {
            const std::vector<float> columns = weights_of(x, width);
            for (std::size_t c = 0; c < 3; ++c) {
                float sum = 0;
                for (std::size_t i = 0; i < columns.size(); ++i) sum += columns[i] * mean[3 * (2 * x + i) + c];
                below.push_back(sum);
            }
        }
    }
    return below;
}

}  // namespace

TEST_CASE("levels hold to the bit what the averages of unrounded ones are, in three values a texel") {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 7u}, {9u, 1u}, {64u, 32u}, {67u, 301u}, {2u, 130u}})
        for (const bool deep : {false, true}) {
            INFO(width << " x " << height << (deep ? ", 16 bits" : ", 8 bits"));
            TexelImage image = noise(width, height);
            if (deep) {
                for (const std::uint8_t code : image.srgb8)
                    image.linear16.push_back(static_cast<std::uint16_t>(code * 251 + 13));
                image.srgb8.clear();
            }
            std::vector<float> linear;
            for (std::size_t i = 0; i < image.pixels(); ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    linear.push_back(deep ? static_cast<float>(image.linear16[4 * i + c]) / 65535.0f
                                          : srgb8_to_linear()[image.srgb8[4 * i + c]]);
            const MipPyramid pyramid(image);
            std::size_t wrong = 0, at = 0;
            for (const MipPyramid::Level& level : pyramid.levels()) {
                CHECK(level.first == at / 3);
                for (const float value : linear) {
                    if (deep)
                        wrong += pyramid.texels().linear16[at++] !=
                                 static_cast<std::uint16_t>(std::clamp(value, 0.0f, 1.0f) * 65535.0f + 0.5f);
                    else
                        wrong += pyramid.texels().srgb8[at++] != linear_to_srgb8(value);
                }
                linear = level_below(linear, level.width, level.height);
            }
            CHECK(wrong == 0);
            CHECK(pyramid.texels().count() == at / 3);
            CHECK(pyramid.is_8_bit() != deep);
        }
}

TEST_CASE("gutters of tall pictures take the nearest used texel") {
    for (const auto& [w, h] : {std::pair{5, 100}, {40, 65}, {1, 64}}) {
        const auto width = static_cast<std::uint32_t>(w), height = static_cast<std::uint32_t>(h);
        TexelImage image = noise(width, height);
        const TexelImage before = image;
        TexelCoverage coverage(width, height);
        for (const float v : {0.02f, 0.4f, 0.97f}) {
            const Vector2f point(0.6f - 0.5f * v, v);
            coverage.add({point, point, point}, Wrap::clamp, Wrap::clamp);
        }
        REQUIRE(coverage.count_used() == 3);
        fill_gutters(image, coverage);
        std::size_t wrong = 0;
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                int best = 1 << 20;
                std::vector<std::size_t> nearest;
                for (int j = 0; j < h; ++j)
                    for (int i = 0; i < w; ++i) {
                        const auto texel = std::size_t(j * w + i);
                        const int d = (i - x) * (i - x) + (j - y) * (j - y);
                        if (!coverage.used(texel) || d > best) continue;
                        if (d < best) nearest.clear();
                        best = d;
                        nearest.push_back(texel);
                    }
                bool found = false;
                for (const std::size_t texel : nearest)
                    found |=
                        std::equal(image.srgb8.begin() + 4 * (y * w + x), image.srgb8.begin() + 4 * (y * w + x) + 4,
                                   before.srgb8.begin() + std::ptrdiff_t(4 * texel));
                wrong += !found;
            }
        CHECK(wrong == 0);
    }
}

TEST_CASE("texture samples") {
    SECTION("texel centres give the texels, bottom left is (0, 0)") {
        const TexelImage image = noise(5, 3);
        const Texture texture(image, Wrap::repeat, Wrap::repeat);
        for (std::uint32_t y = 0; y < 3; ++y)
            for (std::uint32_t x = 0; x < 5; ++x) {
                const Vector3f rgb =
                    texture.sample((static_cast<float>(x) + 0.5f) / 5, 1 - (static_cast<float>(y) + 0.5f) / 3);
                for (int c = 0; c < 3; ++c)
                    CHECK(std::abs(rgb[c] - linear(image.srgb8[4 * (y * 5 + x) + c])) <
                          0x1p-17 + 1e-6);  // 16-bit storage
            }
    }
    SECTION("bilinear in linear light, against the formula") {
        const Texture texture(image8(2, 1,
                                     [](auto x, auto) {
                                         return std::array{x ? 255 : 0, x ? 0 : 255, 64};
                                     }),
                              Wrap::clamp, Wrap::clamp);
        const Vector3f rgb = texture.sample(0.25f + 0.3f * 0.5f, 0.5f);  // 0.3 of the way between the centres
        CHECK(rgb.x() == Approx(0.3f));
        CHECK(rgb.y() == Approx(0.7f));
        CHECK(rgb.z() == Approx(linear(64)).margin(8e-6));  // half a step of 16-bit storage
    }
    SECTION("wrap modes") {
        const TexelImage image = image8(4, 1, [](auto x, auto) { return std::array{int(x) * 80, 0, 0}; });
        const auto at = [&](Wrap wrap, float u) { return Texture(image, wrap, Wrap::clamp).sample(u, 0.5f).x(); };
        CHECK(at(Wrap::repeat, 1.125f) == Approx(linear(0)).margin(1e-6));
        CHECK(at(Wrap::repeat, -0.125f) == Approx(linear(240)));
        CHECK(at(Wrap::repeat, 0.0f) == Approx((linear(0) + linear(240)) / 2));  // between the last and the first
        CHECK(at(Wrap::mirror, 1.125f) == Approx(linear(240)));
        CHECK(at(Wrap::mirror, -0.375f) == Approx(linear(80)).margin(8e-6));
        CHECK(at(Wrap::mirror, 2.125f) == Approx(linear(0)).margin(1e-6));
        CHECK(at(Wrap::clamp, 7.0f) == Approx(linear(240)));
        CHECK(at(Wrap::clamp, 0.0f) == Approx(linear(0)).margin(1e-6));
        CHECK(at(Wrap::decal, 0.875f) == Approx(linear(240)));
        CHECK(Texture(image, Wrap::decal, Wrap::clamp).sample(1.01f, 0.5f) == Vector3f(1, 1, 1));
    }
    SECTION("nearest keeps the texels of pixel art apart") {
        const Texture texture(image8(2, 1,
                                     [](auto x, auto) {
                                         return std::array{x ? 255 : 0, 0, 0};
                                     }),
                              Wrap::clamp, Wrap::clamp, true);
        CHECK(texture.sample(0.49f, 0.5f, -1).x() == 0);
        CHECK(texture.sample(0.51f, 0.5f, 0.4f).x() == 1);
        CHECK(texture.sample(0.49f, 0.5f, 1).x() == Approx(0.5f).margin(0.005));
    }
    SECTION("every level has the mean of the picture, odd sizes too") {
        for (const auto& [w, h] : {std::pair{64u, 64u}, {37u, 53u}, {1u, 19u}, {130u, 3u}}) {
            const TexelImage image = noise(w, h);
            Eigen::Vector3d mean = Eigen::Vector3d::Zero();
            for (std::size_t i = 0; i < image.pixels(); ++i)
                mean += image.rgb(i).cast<double>() / double(image.pixels());
            const Texture texture(image, Wrap::clamp, Wrap::clamp);
            const Vector3f top = texture.sample(0.3f, 0.6f, 99);
            // half a code of 255, in light: the slope of the curve is below 2.3
            for (int c = 0; c < 3; ++c) CHECK(std::abs(top[c] - mean[c]) < 0.5 / 255 * 2.3);
        }
    }
    SECTION("levels blend, and the middle of a checkerboard is half the light") {
        const Texture texture(image8(64, 64,
                                     [](auto x, auto y) {
                                         return (x + y) % 2 ? std::array{255, 255, 255} : std::array{0, 0, 0};
                                     }),
                              Wrap::repeat, Wrap::repeat);
        CHECK(texture.sample(0.4f, 0.7f, 1).x() == Approx(0.5).margin(0.005));
        const float fine = texture.sample(0.4f, 0.7f, 0).x(), coarse = texture.sample(0.4f, 0.7f, 1).x();
        CHECK(texture.sample(0.4f, 0.7f, 0.25f).x() == Approx(0.75f * fine + 0.25f * coarse));
    }
    SECTION("deep pictures keep what 8 bits would lose") {
        TexelImage image{2, 2, {}, std::vector<std::uint16_t>(16, 65535)};
        for (std::size_t i = 0; i < 4; ++i) image.linear16[4 * i] = static_cast<std::uint16_t>(1000 + i);
        const Texture texture(image, Wrap::clamp, Wrap::clamp);
        CHECK(texture.sample(0.25f, 0.75f).x() == Approx(1000 / 65535.0));
        CHECK(texture.sample(0.75f, 0.25f).x() == Approx(1003 / 65535.0));
        CHECK(texture.sample(0.5f, 0.5f, 1).x() * 65535 == Approx(1001.5).margin(0.51));
    }
    SECTION("coordinates and levels from hell") {
        const Texture texture(noise(7, 5), Wrap::repeat, Wrap::mirror);
        constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
        for (const float u :
             {0.0f, 1.0f, -1.0f, 1e30f, -1e30f, inf, -inf, nan, 3.9e6f, -3.9e6f, std::nextafter(1.0f, 0.0f), -1e-9f})
            for (const float lod : {0.0f, -5.0f, 0.5f, 1.999f, 50.0f, inf, -inf, nan})
                for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp, Wrap::decal}) {
                    const Texture other(noise(7, 5), wrap, wrap);
                    const Vector3f rgb = other.sample(u, 1 - u, lod);
                    CHECK((rgb.allFinite() && rgb.minCoeff() >= 0 && rgb.maxCoeff() <= 1));
                }
    }
    SECTION("level of detail of a triangle") {
        const Texture texture(noise(128, 64), Wrap::repeat, Wrap::repeat);
        const std::array<Vector2f, 3> uv{Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)};
        // 128 texels over 16 mm and 64 over 16 mm: 8 and 4 texels a mm. At 0.5 mm: 4 texels in the worse direction.
        const Eigen::Vector3d a(1, 2, 3), x = Eigen::Vector3d(1, 1, 0).normalized() * 16, y(0, 0, 16);
        CHECK(texture.lod(uv, {a, a + x, a + y}, 0.5) == Approx(2).margin(1e-5));
        CHECK(texture.lod(uv, {a, a + x, a + y}, 0.0625) == Approx(-1).margin(1e-5));
        CHECK(texture.lod(uv, {a, a + x, a + 0.25 * y}, 0.5) == Approx(3).margin(1e-5));
        CHECK(texture.lod(uv, {a, a, a}, 0.5) == 0);
        CHECK(texture.lod({uv[0], uv[0], uv[0]}, {a, a + x, a + y}, 0.5) <= 0);
    }
    SECTION("codes and light there and back") {
        for (int code = 0; code < 256; ++code) CHECK(linear_to_srgb8(linear(code)) == code);
        for (double code = 0.01; code < 1; code += 0.001)
            CHECK(std::abs(linear_to_srgb8(static_cast<float>(voxtone::optics::srgb_decode(code))) - code * 255) <
                  0.5005);
        CHECK(linear_to_srgb8(std::numeric_limits<float>::quiet_NaN()) == 0);
        CHECK(linear_to_srgb8(2.0f) == 255);
        CHECK(linear_to_srgb8(-1.0f) == 0);
    }
}

TEST_CASE("texels that no triangle uses") {
    SECTION("a triangle uses the texels whose centres it covers") {
        TexelCoverage coverage(8, 8);
        coverage.add({Vector2f(0, 0), Vector2f(0.5f, 0), Vector2f(0, 0.5f)}, Wrap::clamp, Wrap::clamp);
        for (std::uint32_t y = 0; y < 8; ++y)
            for (std::uint32_t x = 0; x < 8; ++x) {
                const double u = (x + 0.5) / 8, v = 1 - (y + 0.5) / 8;
                CHECK(coverage.used(y * 8 + x) == (u + v <= 0.5));
            }
    }
    SECTION("points and slivers use what they touch") {
        TexelCoverage coverage(16, 16);
        coverage.add({Vector2f(0.1f, 0.9f), Vector2f(0.1f, 0.9f), Vector2f(0.1f, 0.9f)}, Wrap::repeat, Wrap::repeat);
        CHECK(coverage.count_used() == 1);
        CHECK(coverage.used(1 * 16 + 1));
        coverage.add({Vector2f(0.01f, 0.51f), Vector2f(0.99f, 0.51f), Vector2f(0.5f, 0.515f)}, Wrap::repeat,
                     Wrap::repeat);
        CHECK(coverage.count_used() == 17);
    }
    SECTION("tiles wrap, as does what is mirrored or clamped") {
        const std::array<Vector2f, 3> out{Vector2f(1.0f, 0.25f), Vector2f(1.5f, 0.25f), Vector2f(1.0f, 0.75f)};
        const auto used = [&](Wrap wrap, double u, double v) {
            TexelCoverage coverage(32, 32);
            coverage.add(out, wrap, wrap);
            return coverage.used(static_cast<std::size_t>((1 - v) * 32) * 32 + static_cast<std::size_t>(u * 32));
        };
        CHECK(used(Wrap::repeat, 0.1, 0.3));
        CHECK_FALSE(used(Wrap::repeat, 0.9, 0.3));
        CHECK(used(Wrap::mirror, 0.9, 0.3));
        CHECK_FALSE(used(Wrap::mirror, 0.1, 0.3));
        CHECK(used(Wrap::clamp, 0.99, 0.3));
        CHECK_FALSE(used(Wrap::decal, 0.99, 0.3));
        TexelCoverage coverage(32, 32);
        coverage.add({Vector2f(-50, 0), Vector2f(50, 0), Vector2f(0, 40)}, Wrap::repeat, Wrap::repeat);
        CHECK(coverage.count_used() == 1024);
    }
    SECTION("gutters take the nearest used texel, against brute force") {
        TexelImage image = noise(23, 17);
        const TexelImage before = image;
        TexelCoverage coverage(23, 17);
        coverage.add({Vector2f(0.1f, 0.1f), Vector2f(0.5f, 0.2f), Vector2f(0.2f, 0.6f)}, Wrap::clamp, Wrap::clamp);
        coverage.add({Vector2f(0.9f, 0.95f), Vector2f(0.9f, 0.95f), Vector2f(0.9f, 0.95f)}, Wrap::clamp, Wrap::clamp);
        REQUIRE(coverage.count_used() > 10);
        REQUIRE(coverage.count_used() < 100);
        fill_gutters(image, coverage);
        for (int y = 0; y < 17; ++y)
            for (int x = 0; x < 23; ++x) {
                int best = 1 << 20;
                bool found = false;
                for (int pass = 0; pass < 2; ++pass)
                    for (int j = 0; j < 17; ++j)
                        for (int i = 0; i < 23; ++i) {
                            if (!coverage.used(std::size_t(j * 23 + i))) continue;
                            const int d = (i - x) * (i - x) + (j - y) * (j - y);
                            if (pass == 0) best = std::min(best, d);
                            if (pass == 1 && d == best)
                                found |= std::equal(image.srgb8.begin() + 4 * (y * 23 + x),
                                                    image.srgb8.begin() + 4 * (y * 23 + x) + 4,
                                                    before.srgb8.begin() + 4 * (j * 23 + i));
                        }
                CHECK(found);
            }
    }
    SECTION("nothing used: nothing changes") {
        TexelImage image = noise(9, 9);
        const TexelImage before = image;
        fill_gutters(image, TexelCoverage(9, 9));
        CHECK(image.srgb8 == before.srgb8);
    }
    SECTION("no dark seams: an atlas of islands on black keeps their colours at every level that separates them") {
        // Irregular islands as a scan has them, painted where a texel's centre lies in the island, without any margin.
        std::vector<std::array<Vector2f, 3>> islands;
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
                voxtone::RandomStream random(3, std::uint64_t(4 * j + i));
                const auto corner = [&](double x, double y) {
                    return Vector2f(float(x + 0.06 * random.uniform()), float(y + 0.06 * random.uniform()));
                };
                const double x = i / 4.0 + 0.01, y = j / 4.0 + 0.01;
                islands.push_back({corner(x, y), corner(x + 0.16, y), corner(x + 0.05, y + 0.16)});
            }
        const auto colour = [](std::size_t island) {
            return std::array{int(120 + 8 * island), int(250 - 8 * island), 200};
        };
        TexelImage image = image8(256, 256, [](auto, auto) { return std::array{0, 0, 0}; });
        TexelCoverage coverage(256, 256);
        for (std::size_t k = 0; k < islands.size(); ++k) {
            TexelCoverage one(256, 256);
            one.add(islands[k], Wrap::repeat, Wrap::repeat);
            for (std::size_t i = 0; i < image.pixels(); ++i)
                if (one.used(i))
                    for (int c = 0; c < 3; ++c) image.srgb8[4 * i + c] = static_cast<std::uint8_t>(colour(k)[c]);
            coverage.add(islands[k], Wrap::repeat, Wrap::repeat);
        }
        const Texture raw(image, Wrap::repeat, Wrap::repeat);
        fill_gutters(image, coverage);
        const Texture filled(image, Wrap::repeat, Wrap::repeat);
        double worst = 0, worst_raw = 0;
        for (std::size_t k = 0; k < islands.size(); ++k) {
            const Vector3f want(linear(colour(k)[0]), linear(colour(k)[1]), linear(colour(k)[2]));
            for (int step = 0; step <= 60; ++step)
                for (int edge = 0; edge < 3; ++edge)
                    for (const float lod : {0.0f, 0.5f, 1.0f, 1.7f}) {
                        const float t = float(step) / 60;
                        const Vector2f uv = (1 - t) * islands[k][edge] + t * islands[k][(edge + 1) % 3];
                        worst =
                            std::max(worst, double((filled.sample(uv.x(), uv.y(), lod) - want).cwiseAbs().maxCoeff()));
                        worst_raw =
                            std::max(worst_raw, double((raw.sample(uv.x(), uv.y(), lod) - want).cwiseAbs().maxCoeff()));
                    }
        }
        INFO("worst distance from the island's colour " << worst << ", without filling " << worst_raw);
        CHECK(worst < 0.5 / 255 * 2.3);  // the rounding of a level to codes
        CHECK(worst_raw > 0.3);          // what the filling is for
    }
}
