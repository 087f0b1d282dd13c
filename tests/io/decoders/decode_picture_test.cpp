// SPDX-License-Identifier: GPL-3.0-or-later
//
// PNG and JPEG by our way through libpng and libjpeg, held against OpenImageIO's.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <lcms2.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/decoders/decode_image.h"
#include "io/decoders/picture_samples.h"
#include "io/openimageio/decode_other.h"
#include "io/pictures/picture.h"
#include "optics/colour/colour.h"
#include "tests/io/decoders/picture_bytes.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Catch::Contains;
using Eigen::Vector3d;

namespace {

/// Largest difference of any texel, of 1; 2 where sizes differ.
double difference(const DecodedImage& a, const DecodedImage& b) {
    if (a.texels.width_px != b.texels.width_px || a.texels.height_px != b.texels.height_px) return 2;
    double worst = 0;
    for (std::size_t i = 0; i < a.texels.pixels(); ++i) {
        worst = std::max(worst, double(std::abs(a.texels.alpha(i) - b.texels.alpha(i))));
        if (a.texels.alpha(i) > 0)
            worst = std::max(worst, double((a.texels.rgb(i) - b.texels.rgb(i)).cwiseAbs().maxCoeff()));
    }
    return worst;
}

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) text += static_cast<char>(value);
    return text;
}

/// sRGB codes of 255 of a picture of one colour.
Vector3d codes_of(const DecodedImage& image) {
    const Eigen::Vector3f rgb = image.texels.rgb(0);
    return Vector3d(rgb.cast<double>()).unaryExpr([](double v) { return 255 * optics::srgb_encode(v); });
}

DecodedImage decoded(const Bytes& file) { return decode_image(file, "a.png"); }

/// ST 2084: the code of an amount of light.
double pq_code(double nits) {
    const double y = std::pow(nits / 10000, 0.1593017578125);
    return std::pow((0.8359375 + 18.8515625 * y) / (1 + 18.6875 * y), 78.84375);
}

/// A profile of inks that is nothing like the plain rule: black ink is green.
std::vector<std::uint8_t> ink_profile() {
    cmsHPROFILE made = cmsCreateProfilePlaceholder(nullptr);
    cmsSetProfileVersion(made, 2.4);
    cmsSetDeviceClass(made, cmsSigOutputClass);
    cmsSetColorSpace(made, cmsSigCmykData);
    cmsSetPCS(made, cmsSigLabData);
    cmsPipeline* const table = cmsPipelineAlloc(nullptr, 4, 3);
    cmsStage* const stage = cmsStageAllocCLut16bit(nullptr, 2, 4, 3, nullptr);
    cmsStageSampleCLut16bit(
        stage,
        [](const cmsUInt16Number* in, cmsUInt16Number* out, void*) {
            const double k = in[3] / 65535.0;
            const cmsCIELab lab{100 - 40 * k, -60 * k, 40 * k};
            cmsFloat2LabEncodedV2(out, &lab);
            return TRUE;
        },
        nullptr, 0);
    cmsPipelineInsertStage(table, cmsAT_END, stage);
    cmsWriteTag(made, cmsSigAToB0Tag, table);
    cmsWriteTag(made, cmsSigAToB1Tag, table);
    cmsPipelineFree(table);
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(made, nullptr, &size);
    std::vector<std::uint8_t> out(size);
    cmsSaveProfileToMem(made, out.data(), &size);
    cmsCloseProfile(made);
    return out;
}

}  // namespace

TEST_CASE("PNG of every kind has the pixels that OpenImageIO finds in it") {
    const std::map<int, std::vector<int>> bits_of{
        {0, {1, 2, 4, 8, 16}}, {2, {8, 16}}, {3, {1, 2, 4, 8}}, {4, {8, 16}}, {6, {8, 16}}};
    for (const auto& [type, all_bits] : bits_of)
        for (const int bits : all_bits)
            for (const bool interlaced : {false, true})
                for (const bool keyed : {false, true}) {
                    if (keyed && type >= 4) continue;  // those have alpha
                    const Bytes file = png_of_kind({type, bits, interlaced, keyed}, 13, 9);
                    INFO(
                        fmt::format("colour type {}, {} bits, interlaced {}, keyed {}", type, bits, interlaced, keyed));
                    const DecodedImage ours = decoded(file);
                    CHECK(ours.has_alpha == (keyed || type >= 4));
                    CHECK(ours.texels.is_8_bit() == (bits < 16));
                    CHECK(difference(ours, decode_other(file, "png", "a.png", {})) <= 1.01 / 65535);
                }
}

TEST_CASE("JPEG of every kind has the pixels that OpenImageIO finds in it") {
    for (const int components : {1, 3, 4})
        for (const bool progressive : {false, true}) {
            const Bytes file = jpeg_of_kind({.components = components, .progressive = progressive}, 37, 21);
            INFO(fmt::format("{} components, progressive {}", components, progressive));
            const DecodedImage ours = decode_image(file, "a.jpg");
            CHECK(difference(ours, decode_other(file, "jpeg", "a.jpg", {})) < (components == 4 ? 0.011 : 1e-6));
            CHECK(ours.dpi_x == Approx(components == 4 ? 0 : 254));  // JFIF knows no inks
            CHECK(ours.dpi_y == Approx(components == 4 ? 0 : 127));
            CHECK(ours.warnings.size() == (components == 4 ? 1 : 0));
        }
    // Without Adobe's mark 255 is full ink: the same bytes are the negative of the inks.
    const Bytes plain = jpeg_of_kind({.components = -4, .quality = 100}, 16, 16);
    const Bytes inverted = jpeg_of_kind({.components = 4, .quality = 100}, 16, 16);
    CHECK(difference(decode_image(plain, "a.jpg"), decode_image(inverted, "a.jpg")) > 0.2);
}

TEST_CASE("a JPEG that is cut short is refused or whole, wherever it is cut") {
    for (const JpegKind& kind : {JpegKind{.components = 1},
                                 {.components = 3},
                                 {.components = 3, .progressive = true},
                                 {.components = 3, .restart_rows = 1}}) {
        const Bytes file = jpeg_of_kind(kind, 24, 40);
        const DecodedImage whole = decode_image(file, "a.jpg");
        std::size_t read = 0, wrong = 0;
        for (std::size_t length = 1; length < file.size(); ++length) {
            try {
                const DecodedImage part = decode_image(std::span(file).first(length), "a.jpg");
                ++read;
                wrong += difference(part, whole) > 0 || part.warnings.size() != 1;
            } catch (const InputError&) {
            }
        }
        CHECK(wrong == 0);
        CHECK(read >= 1);  // all but the end mark
        CHECK(read <= 3);
    }
}

TEST_CASE("a JPEG without its end mark is read, and that is said") {
    Bytes file = jpeg_of_kind({}, 24, 40);
    file.resize(file.size() - 2);
    const DecodedImage image = decode_image(file, "a.jpg");
    REQUIRE(image.warnings.size() == 1);
    CHECK_THAT(image.warnings[0], Contains("end mark"));
    file.resize(file.size() / 2);
    CHECK_THROWS_WITH(decode_image(file, "a.jpg"), Contains("cut short"));
}

TEST_CASE("a JPEG of a kind that is not read is not called damaged") {
    Bytes file = jpeg_of_kind({}, 16, 16);
    const auto frame = std::ranges::search(file, std::array{std::byte{0xff}, std::byte{0xc0}}).begin();
    *(frame + 1) = std::byte{0xc3};  // lossless
    CHECK_THROWS_WITH(decode_image(file, "a.jpg"), Contains("kind that is not read") && !Contains("damaged"));
    *(frame + 1) = std::byte{0xc1};
    *(frame + 4) = std::byte{12};  // bits
    CHECK_THROWS_WITH(decode_image(file, "a.jpg"), Contains("kind that is not read") && !Contains("damaged"));
}

TEST_CASE("Exif turns a JPEG and gives its resolution, in either byte order") {
    std::string little("Exif\0\0", 6), big = little;
    little += bytes({'I', 'I', 42, 0, 8, 0, 0, 0, 3, 0});
    little += bytes({0x12, 1, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0});
    little += bytes({0x1a, 1, 5, 0, 1, 0, 0, 0, 50, 0, 0, 0});
    little += bytes({0x28, 1, 3, 0, 1, 0, 0, 0, 3, 0, 0, 0});
    little += bytes({0, 0, 0, 0, 200, 0, 0, 0, 2, 0, 0, 0});
    big += bytes({'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1});
    big += bytes({1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0});
    for (const std::string& exif : {little, big}) {
        const Bytes file = jpeg_of_kind({.app1 = {exif.begin(), exif.end()}}, 24, 40);
        const DecodedImage lying = decode_image(file, "a.jpg");
        const DecodedImage upright = decode_image(file, "a.jpg", {.turn_upright = true});
        CHECK(lying.texels.width_px == 24);
        CHECK(upright.texels.width_px == 40);
        CHECK(difference(upright, decode_other(file, "jpeg", "a.jpg", {.turn_upright = true})) < 1e-6);
        if (exif == little) CHECK(lying.dpi_x == Approx(254));
    }
    for (std::size_t length = 0; length < little.size(); ++length)  // cut blocks say nothing, and are not read behind
        CHECK_NOTHROW(decode_image(
            jpeg_of_kind({.app1 = {little.begin(), little.begin() + std::ptrdiff_t(length)}}, 8, 8), "a.jpg"));
}

TEST_CASE("CMYK goes through its profile") {
    const Bytes file = jpeg_of_kind({.components = 4, .profile = ink_profile()}, 16, 16);
    const DecodedImage image = decode_image(file, "a.jpg");
    CHECK(image.warnings.empty());
    // Cyan, magenta and yellow do nothing in it, and black makes green: no pixel is red or blue.
    double least_lead = 1, most_lead = 0;
    for (std::size_t i = 0; i < image.texels.pixels(); ++i) {
        const Eigen::Vector3f rgb = image.texels.rgb(i);
        least_lead = std::min(least_lead, double(rgb.y() - std::max(rgb.x(), rgb.z())));
        most_lead = std::max(most_lead, double(rgb.y() - rgb.x()));
    }
    CHECK(least_lead > -0.02);
    CHECK(most_lead > 0.3);
    const Bytes broken = jpeg_of_kind({.components = 4, .profile = std::vector<std::uint8_t>(200, 7)}, 16, 16);
    const DecodedImage rough = decode_image(broken, "a.jpg");
    REQUIRE(rough.warnings.size() == 1);
    CHECK_THAT(rough.warnings[0], Contains("CMYK") && Contains("rough"));
}

TEST_CASE("PNG says by numbers what its samples mean") {
    const auto near = [](const Vector3d& a, const Vector3d& b) { return (a - b).cwiseAbs().maxCoeff() < 0.6; };
    SECTION("Display P3: sRGB's red as Apple gives it") {
        const DecodedImage image =
            decoded(png_of_colour(Vector3d(0.91749, 0.20029, 0.13856) * 65535, {{"cICP", bytes({12, 13, 0, 1})}}));
        CHECK(near(codes_of(image), {255, 0, 0}));
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("Display P3"));
    }
    SECTION("BT.2020: sRGB's red by the matrix of BT.2087") {
        const Vector3d red =
            Vector3d(0.6274, 0.0691, 0.0164).unaryExpr([](double v) { return optics::srgb_encode(v); });
        CHECK(near(codes_of(decoded(png_of_colour(red * 65535, {{"cICP", bytes({9, 13, 0, 1})}}))), {255, 0, 0}));
    }
    SECTION("PQ: 203 cd/m2 is white, half of it is half the light, more is clamped and said") {
        const std::vector<PngChunk> pq{{"cICP", bytes({9, 16, 0, 1})}};
        const auto grey = [&](double nits) {
            return decoded(png_of_colour(Vector3d::Constant(pq_code(nits) * 65535), pq));
        };
        CHECK(near(codes_of(grey(202.9)), {255, 255, 255}));
        CHECK(grey(101.5).texels.rgb(0).x() == Approx(0.5).margin(2e-3));
        CHECK(grey(202.9).warnings.size() == 1);
        REQUIRE(grey(1000).warnings.size() == 2);
        CHECK_THAT(grey(1000).warnings[1], Contains("4 pixels") && Contains("203"));
    }
    SECTION("HLG: 75 % is white, 38 % is what BT.2408 says of an 18 % grey card") {
        const std::vector<PngChunk> hlg{{"cICP", bytes({9, 18, 0, 1})}};
        const auto grey = [&](double code) { return decoded(png_of_colour(Vector3d::Constant(code * 65535), hlg)); };
        CHECK(grey(0.75).texels.rgb(0).x() == Approx(1).margin(0.01));
        CHECK(grey(0.38).texels.rgb(0).x() == Approx(26.0 / 203).margin(0.01));
    }
    SECTION("gAMA and cHRM, which go behind cICP and sRGB") {
        const PngChunk linear{"gAMA", bytes({0, 1, 0x86, 0xa0})};
        const std::vector<PngChunk> both{{"cICP", bytes({1, 13, 0, 1})}, linear};
        const Vector3d codes(30000, 30000, 30000);
        CHECK(decoded(png_of_colour(codes, {linear})).texels.rgb(0).x() == Approx(30000 / 65535.0).margin(1e-4));
        CHECK(near(codes_of(decoded(png_of_colour(codes, both))), codes / 257));
        CHECK(near(codes_of(decoded(png_of_colour(codes, {{"sRGB", bytes({0})}, linear}))), codes / 257));
        // Adobe RGB's primaries: its green is beyond sRGB.
        const auto number = [](int v) { return bytes({v >> 24, v >> 16 & 255, v >> 8 & 255, v & 255}); };
        std::string chromaticities;
        for (const int v : {31270, 32900, 64000, 33000, 21000, 71000, 15000, 6000}) chromaticities += number(v);
        const DecodedImage wide =
            decoded(png_of_colour({0, 40000, 0}, {{"gAMA", number(45455)}, {"cHRM", chromaticities}}));
        CHECK(wide.texels.rgb(0).x() == 0);
        CHECK(wide.warnings.size() == 1);
        const DecodedImage dark = decoded(png_of_colour(codes, {{"gAMA", number(100000 / 3)}}));
        CHECK(near(codes_of(dark), codes / 257));
        REQUIRE(dark.warnings.size() == 1);
        CHECK_THAT(dark.warnings[0], Contains("gamma of 3") && Contains("sRGB"));
    }
    SECTION("the range of video") {
        const Vector3d codes(16 * 257, 235 * 257, 125.5 * 257);
        const DecodedImage image = decoded(png_of_colour(codes, {{"cICP", bytes({1, 13, 0, 0})}}));
        CHECK(near(codes_of(image), {0, 255, 127.5}));
    }
    SECTION("glTF has them ignored") {
        const Bytes file = png_of_colour({30000, 20000, 10000}, {{"cICP", bytes({9, 16, 0, 1})}});
        const DecodedImage image = decode_image(file, "a.png", {.use_profile = false});
        CHECK(near(codes_of(image), Vector3d(30000, 20000, 10000) / 257));
        CHECK(image.warnings.empty());
    }
    SECTION("numbers that nobody knows are taken as sRGB, and said") {
        const DecodedImage image = decoded(png_of_colour({30000, 20000, 10000}, {{"cICP", bytes({77, 99, 0, 1})}}));
        CHECK(near(codes_of(image), Vector3d(30000, 20000, 10000) / 257));
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("77") && Contains("99"));
    }
    SECTION("an animation is said") {
        const DecodedImage image =
            decoded(png_of_colour({30000, 20000, 10000}, {{"acTL", bytes({0, 0, 0, 7, 0, 0, 0, 0})}}));
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("7 frames"));
    }
}

TEST_CASE("pixels have the shape that a file says, also where it says no size, and are turned with the picture") {
    const auto png_with = [](const std::string& said) {
        return decoded(png_of_colour({30000, 20000, 10000}, {{"pHYs", said}}));
    };
    CHECK(png_with(bytes({0, 0, 0, 2, 0, 0, 0, 1, 0})).pixel_aspect == Approx(2));
    CHECK(png_with(bytes({0, 0, 0, 2, 0, 0, 0, 1, 0})).dpi_x == 0);
    CHECK(png_with(bytes({0, 0, 0, 10, 0, 0, 0, 40, 1})).pixel_aspect == Approx(0.25));
    CHECK(png_with(bytes({0, 0, 0, 2, 0, 0, 0, 0, 0})).pixel_aspect == 1);
    Bytes jpeg = jpeg_of_kind({}, 16, 16);
    CHECK(decode_image(jpeg, "a.jpg").pixel_aspect == Approx(2));
    jpeg[13] = std::byte{0};  // JFIF's unit
    CHECK(decode_image(jpeg, "a.jpg").pixel_aspect == Approx(2));
    CHECK(decode_image(jpeg, "a.jpg").dpi_x == 0);
    PictureSamples turned{.width_px = 2, .height_px = 1, .bytes = std::vector<std::uint8_t>(8), .pixel_aspect = 2};
    turned.orientation = 6;
    CHECK(to_texels(turned, "a", {.turn_upright = true}).pixel_aspect == Approx(0.5));
    const DecodedImage tiff =
        decode_image(tiff_of({{.pixel = {200, 40, 40}, .pixel_aspect = 2}}), "a.tif", {.others = decode_other});
    CHECK(tiff.pixel_aspect == Approx(2));
    CHECK(tiff.dpi_x == 0);
}

TEST_CASE("parts of a PNG that are damaged and left aside are said") {
    const std::vector<PngChunk> parts{{"iCCP", "a" + bytes({0, 0}) + "no deflated profile"},
                                      {"cHRM", std::string(32, '\1')},
                                      {"gAMA", bytes({0, 0, 177, 143})},
                                      {"cICP", bytes({12, 13, 0, 1})},
                                      {"tRNS", bytes({0, 1, 0, 2, 0, 3})},
                                      {"pHYs", bytes({0, 0, 30, 0, 0, 0, 30, 0, 1})},
                                      {"eXIf", "MM" + bytes({0, 42, 0, 0, 0, 8, 0, 0})}};
    for (const PngChunk& part : parts) {
        Bytes file = png_of_colour({30000, 20000, 10000}, {part});
        const auto at = std::ranges::search(file, std::as_bytes(std::span(part.name))).begin();
        *(at + std::ptrdiff_t(4 + part.data.size())) ^= std::byte{1};  // of the check sum
        const DecodedImage image = decoded(file);
        INFO(part.name);
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains(part.name) && Contains("left aside") && Contains("[damaged]"));
    }
    // Whole ones, and one that is damaged behind what says the same, are not.
    CHECK(decoded(png_of_colour({30000, 20000, 10000}, {parts[2], parts[5]})).warnings.empty());
    Bytes file = png_of_colour({30000, 20000, 10000}, {{"sRGB", bytes({0})}, parts[2]});
    *(std::ranges::search(file, std::as_bytes(std::span(parts[2].name))).begin() + 8) ^= std::byte{1};
    CHECK(decoded(file).warnings.empty());
}

TEST_CASE("an ICC profile of a JPEG, of which a piece is missing, is left aside and said") {
    Bytes file = jpeg_of_kind({.profile = swapped_profile()}, 16, 16);
    CHECK(decode_image(file, "a.jpg").warnings.empty());
    const std::string mark("ICC_PROFILE");
    *(std::ranges::search(file, std::as_bytes(std::span(mark))).begin() + 13) = std::byte{2};  // 1 of 2
    const DecodedImage image = decode_image(file, "a.jpg");
    REQUIRE(image.warnings.size() == 1);
    CHECK_THAT(image.warnings[0], Contains("ICC profile") && Contains("[damaged]"));
}

TEST_CASE("primaries may be those of XYZ, which have no brightness, and are refused where they make no colours") {
    const PictureColours xyz{.chromaticities = {1, 0, 0, 1, 0, 0, 0.3127, 0.329}, .curve = PictureCurve::linear};
    REQUIRE(has_usable_primaries(xyz));
    // The white's amounts of X, Y and Z are one each.
    CHECK((ColourConversion(xyz)({1, 1, 1}) - Eigen::Vector3f::Ones()).norm() < 1e-5f);
    const Vector3d grey = optics::xyz_from_linear_srgb({0.2, 0.5, 0.1}), white = optics::d65_white();
    const Eigen::Vector3f samples = grey.cwiseQuotient(white).cast<float>();
    CHECK((ColourConversion(xyz)(samples) - Eigen::Vector3f(0.2f, 0.5f, 0.1f)).norm() < 1e-3f);
    const double none = std::nan("");
    for (const std::array<double, 8>& useless : {std::array<double, 8>{},
                                                 {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3, 0},
                                                 {0.64, 0.33, 0.64, 0.33, 0.15, 0.06, 0.3127, 0.329},
                                                 {none, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329}}) {
        CHECK_FALSE(has_usable_primaries({.chromaticities = useless}));
        PictureSamples picture{.width_px = 1, .height_px = 1, .bytes = {200, 40, 40, 255}};
        picture.colours.chromaticities = useless;
        const DecodedImage image = to_texels(picture, "a.exr", {});
        CHECK((codes_of(image) - Vector3d(200, 40, 40)).norm() < 1);
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("primaries") && Contains("[picture-colours]"));
    }
}

TEST_CASE("codes in floating point, and 8 bits in 16, are taken as what they are, and said") {
    const auto texels = [](PictureSamples samples) {
        samples.width_px = samples.height_px = 1;
        return to_texels(std::move(samples), "a.exr", {});
    };
    for (const float alpha : {1.0f, 255.0f}) {
        const DecodedImage image = texels({.floats = {200, 40, 0, alpha}});
        CHECK((codes_of(image) - Vector3d(200, 40, 0)).norm() < 0.1);
        CHECK_FALSE(image.has_alpha);
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("whole numbers up to 200") && Contains("[colour-range]"));
    }
    PictureSamples exr{.floats = {128, 128, 128, 1}};
    exr.colours.curve = PictureCurve::linear;
    CHECK((codes_of(texels(exr)) - Vector3d::Constant(128)).norm() < 0.1);
    CHECK(texels({.floats = {128, 0, 0, 127.5f / 255}}).texels.alpha(0) == Approx(0.5).margin(0.003));
    CHECK((codes_of(texels({.floats = {51400, 10280, 257, 1}})) - Vector3d(200, 40, 1)).norm() < 0.1);
    for (const std::uint16_t alpha : {255, 65535}) {
        const DecodedImage image = texels({.words = {200, 40, 0, alpha}});
        CHECK((codes_of(image) - Vector3d(200, 40, 0)).norm() < 0.1);
        CHECK_FALSE(image.has_alpha);
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("8 bits") && Contains("[colour-range]"));
    }
    // As it is, and said that it is black.
    for (const std::uint16_t most : {1, 15, 256, 4095}) {
        const DecodedImage image = texels({.words = {most, 0, 0, 65535}});
        CHECK(image.texels.rgb(0).x() < 0.006f);
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains(fmt::format("above {} of", most)) && Contains("[colour-range]"));
    }
    CHECK_THAT(texels({.bytes = {1, 0, 1, 255}}).warnings.at(0), Contains("above 1 of 255"));
    // Refused: white all over.
    CHECK_THROWS_WITH(texels({.floats = {127.5f, 40.25f, 1, 1}}), Contains("1 to 127.5") && Contains("white all over"));
    CHECK_THROWS_WITH(texels({.floats = {400, 300, 260, 1}}), Contains("white all over"));
}

TEST_CASE("what is dark, bright or black in earnest stays what it is") {
    const auto quiet = [](PictureSamples samples) {
        samples.width_px = samples.height_px = 1;
        return to_texels(std::move(samples), "a.exr", {}).warnings.empty();
    };
    CHECK(quiet({.words = {4096, 0, 0, 65535}}));
    CHECK(quiet({.words = {0, 0, 0, 65535}}));
    CHECK(quiet({.bytes = {0, 0, 0, 255}}));
    CHECK(quiet({.bytes = {2, 0, 0, 255}}));
    const PictureColours linear{.curve = PictureCurve::linear};
    CHECK(quiet({.floats = {1, 0, 1, 1}, .colours = linear}));
    CHECK(quiet({.words = {200, 100, 50, 65535}, .colours = linear}));  // dark, and not coded
    const DecodedImage image =
        to_texels({.width_px = 1, .height_px = 1, .floats = {40, 0.5f, 0, 1}, .colours = linear}, "a.exr", {});
    CHECK((image.texels.rgb(0) - Eigen::Vector3f(1, 0.5f, 0)).norm() < 1e-4f);
    CHECK_THAT(image.warnings.at(0), Contains("outside the range 0 to 1"));
}

TEST_CASE("a picture that is transparent as a whole is opaque") {
    DecodedImage image;
    image.texels.width_px = image.texels.height_px = 1;
    image.texels.srgb8 = {200, 40, 40, 0};
    image.has_alpha = true;
    const Picture picture = finish_picture(image, "a.bmp");
    CHECK(picture.texture->sample(0.5f, 0.5f).y() < 0.1f);
    REQUIRE(picture.warnings.size() == 1);
    CHECK_THAT(picture.warnings[0], Contains("opaque"));
    image.texels.srgb8 = {0, 0, 0, 0};  // nothing there: white
    CHECK(finish_picture(image, "a.bmp").texture->sample(0.5f, 0.5f).y() == Approx(1));
}
