// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture.h"

#include <fmt/format.h>
#include <lcms2.h>
#include <tiffio.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/codecs/read_here.h"
#include "io/decoders/decode_image.h"
#include "io/decoders/icc_to_srgb.h"
#include "io/openimageio/decode_other.h"
#include "optics/colour/colour.h"
#include "tests/io/files/in_child.h"
#include "tests/io/models/model_samples.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Catch::Contains;
using Eigen::Vector3f;

namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }
bool near(const Vector3f& a, const Vector3f& b, float margin = 2e-3f) { return (a - b).cwiseAbs().maxCoeff() < margin; }

/// TIFF of 3 x 2 RGB pixels, left to right and down 10, 20, ... 60 in red; floats or bytes, with an orientation.
std::string made_tiff(const Folder& folder, int orientation, bool floats, float factor) {
    const std::string path = (folder.path() / "made.tif").string();
    TIFF* file = TIFFOpen(path.c_str(), "w");
    TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 3);
    TIFFSetField(file, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, floats ? 32 : 8);
    TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, floats ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(file, TIFFTAG_ORIENTATION, orientation);
    TIFFSetField(file, TIFFTAG_XRESOLUTION, 100.0);
    TIFFSetField(file, TIFFTAG_YRESOLUTION, 200.0);
    TIFFSetField(file, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
    for (int y = 0; y < 2; ++y) {
        std::vector<float> row;
        for (int x = 0; x < 3; ++x)
            for (int c = 0; c < 3; ++c) row.push_back(c ? 0.0f : float(10 * (3 * y + x + 1)) * factor);
        std::vector<std::uint8_t> bytes(row.begin(), row.end());
        TIFFWriteScanline(file, floats ? static_cast<void*>(row.data()) : bytes.data(), static_cast<std::uint32_t>(y));
    }
    TIFFClose(file);
    return path;
}

}  // namespace

TEST_CASE("pictures") {
    const Folder folder;
    SECTION("PNG of 8 and 16 bits, with its resolution") {
        for (const bool deep : {false, true}) {
            const Picture picture =
                read_picture_here(folder.write({{"a.png", png(2, 1, {255, 128, 0, 255, 10, 20, 30, 255}, deep)}}));
            CHECK(picture.width_px == 2);
            CHECK(picture.height_px == 1);
            CHECK(picture.dpi_x == Approx(300).margin(0.01));
            CHECK(picture.warnings.empty());
            const auto linear = [](int code) { return static_cast<float>(optics::srgb_decode(code / 255.0)); };
            CHECK(near(picture.texture->sample(0.25f, 0.5f), {1, linear(128), 0}, 2e-5f));
            CHECK(near(picture.texture->sample(0.75f, 0.5f), {linear(10), linear(20), linear(30)}, 2e-5f));
        }
    }
    SECTION("alpha is straight, and composed over white") {
        for (const bool deep : {false, true}) {
            const Picture picture = read_picture_here(folder.write({{"a.png", png(1, 1, {255, 0, 0, 51}, deep)}}));
            CHECK(near(picture.texture->sample(0.5f, 0.5f), {1, 0.8f, 0.8f}, 4e-3f));
            REQUIRE(picture.warnings.size() == 1);
            CHECK_THAT(picture.warnings[0], Contains("white"));
        }
    }
    SECTION("floats are linear, too bright ones are said") {
        const Picture picture = read_picture_here(made_tiff(folder, 1, true, 0.01f), {}, decode_other);
        CHECK(near(picture.texture->sample(0.5f / 3, 0.75f), {0.1f, 0, 0}, 2e-5f));
        CHECK(picture.dpi_x == Approx(254));
        CHECK(picture.dpi_y == Approx(508));
        const Picture bright = read_picture_here(made_tiff(folder, 1, true, 0.1f), {}, decode_other);
        CHECK(near(bright.texture->sample(0.5f, 0.25f), {1, 0, 0}));
        REQUIRE(bright.warnings.size() == 1);
        CHECK_THAT(bright.warnings[0], Contains("clamped"));
    }
    SECTION("all eight orientations come out upright") {
        // Upright, the pixel of value 10 sits in this corner of the picture, 20 beside it along the file's rows.
        struct Case {
            int orientation;
            bool wide;
            int x10, y10, x20, y20;
        };
        for (const Case& c : {Case{1, true, 0, 0, 1, 0},
                              {2, true, 2, 0, 1, 0},
                              {3, true, 2, 1, 1, 1},
                              {4, true, 0, 1, 1, 1},
                              {5, false, 0, 0, 0, 1},
                              {6, false, 1, 0, 1, 1},
                              {7, false, 1, 2, 1, 1},
                              {8, false, 0, 2, 0, 1}}) {
            const Picture picture = read_picture_here(made_tiff(folder, c.orientation, true, 0.01f), {}, decode_other);
            CHECK(picture.width_px == (c.wide ? 3 : 2));
            const auto at = [&](int x, int y) {
                return picture.texture
                    ->sample((float(x) + 0.5f) / float(picture.width_px),
                             1 - (float(y) + 0.5f) / float(picture.height_px))
                    .x();
            };
            INFO("orientation " << c.orientation);
            CHECK(at(c.x10, c.y10) == Approx(0.1).margin(1e-4));
            CHECK(at(c.x20, c.y20) == Approx(0.2).margin(1e-4));
        }
    }
    SECTION("ICC profiles: sRGB is left alone, a wider one is converted, a broken one is said") {
        const auto profile = [](double gamma, const cmsCIExyYTRIPLE& primaries) {
            cmsCIExyY white{0.3127, 0.3290, 1};
            cmsToneCurve* curve = cmsBuildGamma(nullptr, gamma);
            cmsToneCurve* curves[3] = {curve, curve, curve};
            cmsHPROFILE made = cmsCreateRGBProfile(&white, &primaries, curves);
            cmsUInt32Number size = 0;
            cmsSaveProfileToMem(made, nullptr, &size);
            std::vector<std::uint8_t> bytes(size);
            cmsSaveProfileToMem(made, bytes.data(), &size);
            cmsCloseProfile(made);
            cmsFreeToneCurve(curve);
            return bytes;
        };
        const cmsCIExyYTRIPLE srgb{{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}},
            adobe{{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}};
        std::vector<std::uint8_t> pixel{100, 150, 200, 77};
        // A gamma of 1 on sRGB's primaries: the code is the light.
        CHECK(convert_icc_to_srgb(profile(1, srgb), std::span(pixel)).empty());
        for (int c = 0; c < 3; ++c)
            CHECK(std::abs(pixel[std::size_t(c)] - 255 * optics::srgb_encode((100 + 50 * c) / 255.0)) <= 1.0);
        CHECK(pixel[3] == 77);
        // Green of a wider space is beyond sRGB, grey is the same grey.
        std::vector<std::uint16_t> deep{0, 40000, 0, 1, 30000, 30000, 30000, 2};
        CHECK(convert_icc_to_srgb(profile(2.2, adobe), std::span(deep)).empty());
        // No light of the wider space's green is sRGB's red; its green is the same light, encoded by sRGB's curve.
        CHECK(deep[0] == 0);
        CHECK(std::abs(deep[1] - 65535 * optics::srgb_encode(std::pow(40000 / 65535.0, 2.2))) <= 40);
        CHECK(std::abs(deep[4] - deep[5]) <= 2);
        CHECK(deep[7] == 2);
        // Dark colours of a gamma that is not sRGB's: from 16 bits to half a step of a thousandth.
        for (int code = 0; code <= 65535; code += 257) {
            std::vector<std::uint16_t> dark{std::uint16_t(code), std::uint16_t(code / 2), 0, 3};
            CHECK(convert_icc_to_srgb(profile(1.8, srgb), std::span(dark)).empty());
            for (const std::size_t c : {0, 1}) {
                const double light = std::pow((c == 0 ? code : code / 2) / 65535.0, 1.8);
                CHECK(std::abs(dark[c] - 65535 * optics::srgb_encode(light)) <= 33);
            }
        }
        std::vector<std::uint8_t> same{1, 2, 3, 4};
        CHECK_THAT(convert_icc_to_srgb(std::vector<std::uint8_t>(200, 7), std::span(same)), Contains("broken"));
        CHECK(same == std::vector<std::uint8_t>{1, 2, 3, 4});
    }
    SECTION("bombs and damage") {
        std::string bomb = png(1, 1, {1, 2, 3, 4});
        // IHDR: width and height big-endian at 16 and 20, checksum at 29
        const std::string header("\0\0\xff\xff\0\0\xff\xff", 8);
        bomb.replace(16, 8, header);
        std::uint32_t crc = 0xffffffffu;
        for (std::size_t i = 12; i < 29; ++i) {
            crc ^= static_cast<unsigned char>(bomb[i]);
            for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
        }
        crc = ~crc;
        for (int k = 0; k < 4; ++k) bomb[std::size_t(29 + k)] = static_cast<char>(crc >> (24 - 8 * k));
        CHECK_THROWS_WITH(decode_image(bytes_of(bomb), "bomb.png"), Contains("65535 x 65535"));
        CHECK_THROWS_WITH(decode_image(bytes_of(four_colours()), "a.png", {.max_pixels = 3}), Contains("2 x 2"));
        // A GIF's canvas of 17 GB, for which memory would be taken before its size is told.
        CHECK_THROWS_WITH(decode_image(bytes_of("GIF89a\xff\xff\xff\xff" + std::string(5, '\0')), "bomb.gif",
                                       {.others = decode_other}),
                          Contains("65535 x 65535"));
        // An attribute of 2 GB in a file of 20 bytes, for which OpenEXR would take memory.
        CHECK_THROWS_WITH(decode_image(bytes_of(std::string("\x76\x2f\x31\x01\2\0\0\0a\0int\0\xff\xff\xff\x7f", 18)),
                                       "bomb.exr", {.others = decode_other}),
                          Contains("18 bytes"));
        CHECK_THROWS_WITH(decode_image(bytes_of("nonsense"), "a.png"), Contains("known kind"));
        CHECK_THROWS_AS(read_picture_here(folder.path() / "gone.png"), FileError);
        const std::string whole = png(9, 9, std::vector<std::uint8_t>(9 * 9 * 4, 200));
        // All in one child, whose standard error libpng may fill. The last chunk, IEND, is empty.
        const std::vector<std::byte> refused = test::in_child([&] {
            std::vector<std::byte> outcome;
            for (std::size_t length = 0; length < whole.size() - 12; ++length) {
                try {
                    (void)decode_image(bytes_of(whole.substr(0, length)), "cut.png");
                    outcome.push_back(std::byte{0});
                } catch (const InputError&) {
                    outcome.push_back(std::byte{1});
                }
            }
            return outcome;
        });
        CHECK(refused.size() == whole.size() - 12);
        CHECK(std::count(refused.begin(), refused.end(), std::byte{0}) == 0);
    }
}
