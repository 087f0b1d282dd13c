// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/decode_other.h"

#include <array>
#include <bit>
#include <string_view>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tiffio.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/codecs/read_here.h"
#include "io/decoders/decode_image.h"
#include "io/files/read_bytes.h"
#include "io/files/whole_file.h"
#include "io/openimageio/colour_layer.h"
#include "io/openimageio/decode_photograph.h"
#include "io/openimageio/display_window.h"
#include "io/openimageio/psd_facts.h"
#include "io/openimageio/tiff_white.h"
#include "io/pictures/picture.h"
#include "optics/colour/colour.h"
#include "tests/io/decoders/picture_bytes.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Catch::Contains;
using Eigen::Vector3d;

namespace {

DecodedImage decoded(const Bytes& file) { return decode_image(file, "a.tif", {.others = decode_other}); }

Vector3d codes_of(const DecodedImage& image) {
    const std::size_t middle = image.texels.pixels() / 2 + image.texels.width_px / 2;
    return Vector3d(image.texels.rgb(middle).cast<double>()).unaryExpr([](double v) {
        return 255 * optics::srgb_encode(v);
    });
}

bool near(const Vector3d& a, const Vector3d& b, double margin) { return (a - b).cwiseAbs().maxCoeff() < margin; }

/// CIELAB under D50 as one of TIFF's kinds stores it.
std::vector<std::uint16_t> stored(const Vector3d& lab, int photometric, int bits) {
    const bool offset = photometric == PHOTOMETRIC_ICCLAB;
    std::vector<std::uint16_t> values;
    const double white = bits == 8 ? 255 : offset ? 65280 : 65535;
    values.push_back(static_cast<std::uint16_t>(std::lround(lab[0] / 100 * white)));
    for (const double v : {lab[1], lab[2]}) {
        const long number = std::lround(v * (bits == 8 ? 1 : 256)) + (offset ? (bits == 8 ? 128 : 32768) : 0);
        values.push_back(static_cast<std::uint16_t>(number & (bits == 8 ? 0xff : 0xffff)));
    }
    return values;
}

/// Of 32 bits, the least first.
std::string number(std::size_t value) {
    std::string text;
    for (int i = 0; i < 4; ++i) text += static_cast<char>(value >> (8 * i) & 255);
    return text;
}

/// 1 x 1, 32 bits.
std::string bmp_with_masks(const std::vector<std::size_t>& masks, const std::string& pixel) {
    std::string bmp = "BM" + number(126) + number(0) + number(122) + number(108) + number(1) + number(1);
    bmp += number(1 | 32 << 16) + number(3) + number(4) + std::string(16, '\0');
    for (const std::size_t mask : masks) bmp += number(mask);
    bmp.resize(122);
    return bmp + pixel;
}

/// Of 16 or 32 bits, the greatest first.
std::string big(std::size_t value, int bytes = 4) {
    std::string text;
    for (int i = bytes; i-- > 0;) text += static_cast<char>(value >> (8 * i) & 255);
    return text;
}

struct PsdLayer {
    std::vector<int> codes;
    bool hidden = false;
};

/// 2 x 2 pixels of one colour, 8 bits; `merged`: whether image resource 1057 says that there is a merged picture.
std::string psd_of(const std::vector<int>& codes, const std::vector<PsdLayer>& layers, bool merged = true,
                   std::size_t mode = 3) {
    std::string psd = "8BPS" + big(1, 2) + std::string(6, '\0') + big(codes.size(), 2) + big(2) + big(2) + big(8, 2) +
                      big(mode, 2) + big(0);
    const std::string version = big(1) + std::string(1, merged ? '\1' : '\0') + std::string(13, '\0');
    const std::string resources = "8BIM" + big(1057, 2) + big(0, 2) + big(version.size()) + version;
    psd += big(resources.size()) + resources;
    std::string info = big(layers.size(), 2), pixels;
    for (const PsdLayer& layer : layers) {
        info += big(0) + big(0) + big(2) + big(2) + big(layer.codes.size(), 2);
        for (std::size_t c = 0; c < layer.codes.size(); ++c) {
            info += big(c, 2) + big(6);
            pixels += big(0, 2) + std::string(4, static_cast<char>(layer.codes[c]));
        }
        info += "8BIMnorm\xff" + std::string(1, '\0') + std::string(1, layer.hidden ? '\x0a' : '\x08') +
                std::string(1, '\0') + big(12) + big(0) + big(0) + big(0);
    }
    info += pixels;
    psd += layers.empty() ? big(0) : big(info.size() + 8) + big(info.size()) + info + big(0);
    psd += big(0, 2);
    for (const int code : codes) psd += std::string(4, static_cast<char>(code));
    return psd;
}

DecodedImage decoded_psd(const std::string& psd) {
    return decode_image(std::as_bytes(std::span(psd)), "a.psd", {.others = decode_other});
}

/// An OpenEXR of 2 x 1 pixels; each channel has its value.
struct ExrPart {
    std::string name;
    std::vector<std::pair<std::string, float>> channels;
};

DecodedImage decoded_exr(const std::vector<ExrPart>& parts) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "a.exr").string();
    std::vector<OIIO::ImageSpec> specs;
    for (const ExrPart& part : parts) {
        OIIO::ImageSpec& spec = specs.emplace_back(2, 1, int(part.channels.size()), OIIO::TypeDesc::FLOAT);
        spec.channelnames.clear();
        for (const auto& [name, value] : part.channels) spec.channelnames.push_back(name);
        spec.alpha_channel = -1;
        if (!part.name.empty()) spec.attribute("oiio:subimagename", part.name);
    }
    const auto out = OIIO::ImageOutput::create(file);
    REQUIRE((out && out->open(file, int(specs.size()), specs.data())));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::vector<float> pixels;
        for (int x = 0; x < 2; ++x)
            for (const auto& [name, value] : parts[i].channels) pixels.push_back(value);
        if (i > 0) REQUIRE(out->open(file, specs[i], OIIO::ImageOutput::AppendSubimage));
        REQUIRE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    }
    REQUIRE(out->close());
    return decode_image(read_bytes(file, 1 << 24), "a.exr", {.others = decode_other});
}

}  // namespace

TEST_CASE("TIFF of Lab colours, under D50, has neutral greys and the colours that Lab says") {
    // (200, 40, 40) in CIELAB under D50, by colour science's own path: Bradford, then Lab.
    const Vector3d red(200, 40, 40);
    const Vector3d linear = red.unaryExpr([](double v) { return optics::srgb_decode(v / 255); });
    const Vector3d lab = optics::lab_from_xyz(
        optics::adapt_white(optics::xyz_from_linear_srgb(linear), optics::d65_white(), optics::d50_white()),
        optics::d50_white());
    CHECK(near(lab, {44.94, 61.61, 42.51}, 0.1));  // as other programs have it
    for (const int photometric : {PHOTOMETRIC_CIELAB, PHOTOMETRIC_ICCLAB})
        for (const int bits : {8, 16})
            for (const int tile : {0, 16}) {
                INFO(fmt::format("photometric {}, {} bits, tile {}", photometric, bits, tile));
                const DecodedImage image =
                    decoded(tiff_of({{photometric, bits, tile, false, stored(lab, photometric, bits)}}));
                CHECK(near(codes_of(image), red, bits == 8 ? 2 : 0.5));
                const Vector3d grey = codes_of(
                    decoded(tiff_of({{photometric, bits, tile, false, stored({75, 0, 0}, photometric, bits)}})));
                CHECK(grey.maxCoeff() - grey.minCoeff() < 0.5);
                CHECK(grey[0] == Approx(185).margin(1));
            }
}

TEST_CASE("Lab of a TIFF has the white that the file says, and an L* without a sign whatever it says of that") {
    const Vector3d blue(40, 90, 200);
    const Vector3d xyz =
        optics::xyz_from_linear_srgb(blue.unaryExpr([](double v) { return optics::srgb_decode(v / 255); }));
    const Vector3d lab = optics::lab_from_xyz(xyz, optics::d65_white());
    for (const int bits : {8, 16})
        for (const int tile : {0, 16})
            for (const bool is_signed : {false, true}) {
                INFO(fmt::format("{} bits, tile {}, {}", bits, tile, is_signed ? "signed" : "unsigned"));
                TiffPage page{PHOTOMETRIC_CIELAB, bits, tile, false, stored(lab, PHOTOMETRIC_CIELAB, bits)};
                page.is_signed = is_signed;
                page.white = {0.3127f, 0.329f};
                const DecodedImage image = decoded(tiff_of({page}));
                CHECK(near(codes_of(image), blue, bits == 8 ? 3 : 0.5));
                CHECK(image.warnings.empty());
                page.white.clear();
                const DecodedImage unsaid = decoded(tiff_of({page}));  // D50, or libvips' D65
                CHECK(near(codes_of(unsaid), blue, bits == 8 ? 3 : 0.5) == is_signed);
                CHECK(unsaid.warnings.size() == (is_signed ? 1 : 0));
                if (is_signed) CHECK_THAT(unsaid.warnings[0], Contains("libvips") && Contains("[picture-colours]"));
                page.pixel = stored({100, 0, 0}, PHOTOMETRIC_CIELAB, bits);
                CHECK(near(codes_of(decoded(tiff_of({page}))), {255, 255, 255}, 0.5));
            }
    // Of its own page; of a file that is cut short or says nonsense none.
    TiffPage first{PHOTOMETRIC_CIELAB, 8, 0, false, stored(lab, PHOTOMETRIC_CIELAB, 8)}, second = first;
    first.smaller_copy = true;
    second.white = {0.3127f, 0.329f};
    const Bytes file = tiff_of({first, second});
    CHECK(near(codes_of(decoded(file)), blue, 3));
    CHECK_FALSE(tiff_white(file, 0));
    CHECK_FALSE(tiff_white(file, 2));
    const auto white = tiff_white(file, 1);
    REQUIRE(white);
    CHECK((*white)[0] == Approx(0.3127).epsilon(1e-4));
    for (std::size_t length = 0; length < file.size(); ++length) {
        const auto cut = tiff_white(std::span(file).first(length), 1);
        if (cut) CHECK(*cut == *white);
    }
    second.white = {0.9f, 0.0f};
    CHECK_FALSE(tiff_white(tiff_of({second}), 0));
}

TEST_CASE("a channel of a TIFF whose meaning is not said is left aside, said, and known for transparency") {
    for (const int bits : {8, 16}) {
        const auto scaled = [&](std::vector<std::uint16_t> pixel) {
            for (std::uint16_t& v : pixel) v = static_cast<std::uint16_t>(bits == 16 ? v * 257 : v);
            return pixel;
        };
        TiffPage page{.bits = bits, .pixel = scaled({200, 40, 40, 128})};
        const DecodedImage plain = decoded(tiff_of({page}));
        CHECK(near(codes_of(plain), {200, 40, 40}, 0.5));
        CHECK_FALSE(plain.has_alpha);
        REQUIRE(plain.warnings.size() == 1);
        CHECK_THAT(plain.warnings[0], Contains("does not say what it means") && Contains("[several-pictures]") &&
                                          !Contains("transparency"));
        page.second = scaled({0, 0, 0, 0});
        CHECK_THAT(decoded(tiff_of({page})).warnings.at(0), Contains("transparency") && Contains("PNG"));
        page.second = scaled({1, 0, 0, 0});
        CHECK_THAT(decoded(tiff_of({page})).warnings.at(0), !Contains("transparency"));
        page.extra = EXTRASAMPLE_UNASSALPHA;
        CHECK(decoded(tiff_of({page})).has_alpha);
        CHECK(decoded(tiff_of({page})).warnings.empty());
        page = {.bits = bits, .pixel = scaled({200, 40, 40, 128, 1})};
        CHECK(near(codes_of(decoded(tiff_of({page}))), {200, 40, 40}, 0.5));
        CHECK_THAT(decoded(tiff_of({page})).warnings.at(0), Contains("5 channels; red, green, blue were taken"));
    }
    // Grey, and such a channel.
    TiffPage grey{.photometric = PHOTOMETRIC_MINISBLACK, .pixel = {90, 7}};
    const DecodedImage image = decoded(tiff_of({grey}));
    CHECK(near(codes_of(image), {90, 90, 90}, 0.5));
    CHECK_FALSE(image.has_alpha);
    CHECK_THAT(image.warnings.at(0), Contains("[several-pictures]"));
}

TEST_CASE("of an OpenEXR's layers red, green, blue and alpha of one are taken") {
    using Names = std::vector<std::string>;
    const auto taken = [](const Names& names, const std::string& part = {}) {
        const auto layer = find_colour_layer(names, part);
        return layer ? fmt::format("{}:{},{},{},{}", layer->name, layer->channels[0], layer->channels[1],
                                   layer->channels[2], layer->channels[3])
                     : std::string("none");
    };
    CHECK(taken({"R", "G", "B"}) == ":0,1,2,-1");
    CHECK(taken({"A", "B", "G", "R"}) == ":3,2,1,0");
    CHECK(taken({"AO.R", "AO.G", "AO.B", "Combined.R", "Combined.G", "Combined.B", "Combined.A"}) ==
          "Combined:3,4,5,6");
    CHECK(taken({"V.AO.R", "V.AO.G", "V.AO.B", "V.Combined.A", "V.Combined.B", "V.Combined.G", "V.Combined.R"}) ==
          "V.Combined:6,5,4,3");
    CHECK(taken({"AO.R", "AO.G", "AO.B", "R", "G", "B"}) == ":3,4,5,-1");
    CHECK(taken({"depth.Z", "N.X", "N.Y", "N.Z", "C.red", "C.green", "C.blue"}) == "C:4,5,6,-1");
    CHECK(taken({"a.R", "a.G", "b.R", "b.G", "b.B"}) == "b:2,3,4,-1");
    CHECK(taken({"Y", "A"}) == ":0,0,0,1");
    CHECK(taken({"Z"}) == ":0,0,0,-1");
    CHECK(taken({"R", "G", "B"}, "Combined") == "Combined:0,1,2,-1");
    for (const Names& none : {Names{"X", "Y", "Z"}, Names{"N.X", "N.Y", "N.Z", "Z"}, Names{"R", "G"}, Names{}})
        CHECK(taken(none) == "none");

    const DecodedImage image = decoded_exr({{"",
                                             {{"AO.R", 0.1f},
                                              {"AO.G", 0.1f},
                                              {"AO.B", 0.1f},
                                              {"Combined.R", 0.5f},
                                              {"Combined.G", 0.25f},
                                              {"Combined.B", 0.125f},
                                              {"Combined.A", 1}}}});
    CHECK((image.texels.rgb(0) - Eigen::Vector3f(0.5f, 0.25f, 0.125f)).norm() < 1e-3f);
    CHECK_FALSE(image.has_alpha);
    REQUIRE(image.warnings.size() == 1);
    CHECK_THAT(image.warnings[0],
               Contains("AO") && Contains("colours of Combined were taken") && Contains("[several-pictures]"));
    const DecodedImage deep = decoded_exr({{"", {{"B", 0.125f}, {"G", 0.25f}, {"R", 0.5f}, {"Z", 3}}}});
    CHECK((deep.texels.rgb(1) - Eigen::Vector3f(0.5f, 0.25f, 0.125f)).norm() < 1e-3f);
    CHECK_THAT(deep.warnings.at(0), Contains("4 channels"));
    const DecodedImage parts = decoded_exr({{"depth", {{"Z", 3}}},
                                            {"AO", {{"R", 0.1f}, {"G", 0.1f}, {"B", 0.1f}}},
                                            {"Combined", {{"R", 0.5f}, {"G", 0.25f}, {"B", 0.125f}}}});
    CHECK((parts.texels.rgb(0) - Eigen::Vector3f(0.5f, 0.25f, 0.125f)).norm() < 1e-3f);
    CHECK_THAT(parts.warnings.at(0), Contains("3 layers (depth, AO, Combined)"));
    CHECK_THROWS_WITH(decoded_exr({{"", {{"N.X", 1}, {"N.Y", 1}, {"N.Z", 1}}}}),
                      Contains("N.X") && Contains("no layer"));
}

TEST_CASE("TIFF of inks is taken as inks, whatever channels follow them") {
    const std::vector<std::uint16_t> inks{55, 215, 215, 0};  // (200, 40, 40) by the plain rule
    for (std::size_t further = 0; further < 3; ++further)
        for (const int bits : {8, 16}) {
            std::vector<std::uint16_t> pixel = inks;
            pixel.insert(pixel.end(), further, 215);
            if (bits == 16)
                for (std::uint16_t& sample : pixel) sample = static_cast<std::uint16_t>(sample * 257);
            const DecodedImage image = decoded(tiff_of({{PHOTOMETRIC_SEPARATED, bits, 0, false, pixel}}));
            INFO(fmt::format("{} channels, {} bits", pixel.size(), bits));
            CHECK(near(codes_of(image), {200, 40, 40}, 1));
            CHECK_FALSE(image.has_alpha);
            REQUIRE(image.warnings.size() == (further ? 2 : 1));
            if (further) CHECK_THAT(image.warnings[0], Contains(fmt::format("{} channels", further)));
        }
    const std::vector<std::uint16_t> two{55, 215};
    CHECK_THROWS_WITH(decoded(tiff_of({{PHOTOMETRIC_SEPARATED, 8, 0, false, two}})), Contains("2 inks"));
}

TEST_CASE("TIFF of floating point is linear light, and refused where its numbers have 64 bits") {
    const TiffPage page{.bits = 32, .pixel = {30000, 20000, 10000}};
    CHECK((decoded(tiff_of({page})).texels.rgb(0) - Eigen::Vector3f(30000, 20000, 10000) / 65535).norm() < 1e-4f);
    for (const int tile : {0, 16})
        CHECK_THROWS_WITH(decoded(tiff_of({{.bits = 64, .tile = tile, .pixel = page.pixel}})),
                          Contains("64-bit") && Contains("32 bits"));
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "photograph.tif";
    const Bytes wide = tiff_of({{.bits = 64, .pixel = page.pixel}});
    write_whole_file(file, std::string_view(reinterpret_cast<const char*>(wide.data()), wide.size()));
    CHECK_THROWS_WITH(decode_photograph(file), Contains("64-bit"));
}

TEST_CASE("A photograph's profile says what its codes are, where it is asked for") {
    const TemporaryFolder folder;
    const auto read = [&](const TiffPage& page, bool by_profile) {
        const std::filesystem::path file = folder.path() / "photograph.tif";
        const Bytes bytes = tiff_of({page});
        write_whole_file(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        return decode_photograph(file, by_profile);
    };
    const auto is = [](const Photograph& photo, const Eigen::Vector3f& codes) {
        return (photo.pixels.at(7) - codes / 65535).cwiseAbs().maxCoeff() < 2e-3f;
    };
    TiffPage page{.bits = 16, .pixel = {60000, 20000, 10000}};
    CHECK(is(read(page, true), {60000, 20000, 10000}));
    page.profile = swapped_profile();  // its red is sRGB's blue
    const Photograph said = read(page, true), stored = read(page, false);
    CHECK(is(said, {10000, 20000, 60000}));
    CHECK(said.coding == SampleCoding::srgb);
    CHECK(is(stored, {60000, 20000, 10000}));
    CHECK(stored.coding == SampleCoding::unknown);
    // The green of Display P3 has less than no red and blue of sRGB.
    Photograph wide = read({.bits = 16, .pixel = {0, 65535, 0}, .profile = display_p3_profile()}, true);
    make_linear(wide);
    CHECK((wide.pixels.at(7) - Eigen::Vector3f(-0.2249f, 1.0420f, -0.0786f)).cwiseAbs().maxCoeff() < 2e-3f);
    page.profile.resize(100);  // broken: as if there were none
    CHECK(is(read(page, true), {60000, 20000, 10000}));
}

TEST_CASE("floating point that is no light is refused, though its black is black") {
    const auto read = [](std::initializer_list<float> greys) {
        std::string pfm("Pf\n" + std::to_string(greys.size()) + " 1\n-1.0\n");
        for (const float value : greys) {
            const auto bits = std::bit_cast<std::array<char, 4>>(value);
            pfm.append(bits.begin(), bits.end());
        }
        return decode_image(std::as_bytes(std::span(pfm)), "a.pfm", {.others = decode_other});
    };
    CHECK_THROWS_WITH(read({0, 0, 197.4f, 40.5f}), Contains("nearly every sample that is not 0") &&
                                                       Contains("0 to 197.4") && Contains("divide its samples"));
    CHECK_NOTHROW(read({0, 0, 8.5f}));  // a lamp in the dark
    CHECK_THROWS_WITH(read({1.5f, 8.5f}), Contains("1 or more"));
    CHECK_NOTHROW(read({0, 0.5f, 8.5f}));  // light, with a lamp in it
    CHECK_NOTHROW(read({0, 1, 1}));
}

TEST_CASE("whole numbers of 32 bits are codes of as many bits as they need") {
    const auto read = [](double white, OIIO::TypeDesc type) {
        const TemporaryFolder folder;
        const std::string file = (folder.path() / "a.tif").string();
        const auto out = OIIO::ImageOutput::create(file);
        REQUIRE((out && out->open(file, OIIO::ImageSpec(2, 1, 3, type))));
        std::vector<std::uint32_t> pixels;
        for (const double share : {200 / 255.0, 40 / 255.0, 40 / 255.0, 1.0, 1.0, 1.0})
            pixels.push_back(static_cast<std::uint32_t>(share * white + 0.5));
        REQUIRE(out->write_image(type, pixels.data()));
        REQUIRE(out->close());
        return decoded(read_bytes(file, 1 << 24));
    };
    const auto first = [](const DecodedImage& image) {
        return Vector3d(
            image.texels.rgb(0).cast<double>().unaryExpr([](double v) { return 255 * optics::srgb_encode(v); }));
    };
    for (const double white : {255.0, 65535.0, 4294967295.0}) {
        const DecodedImage image = read(white, OIIO::TypeDesc::UINT32);
        CHECK(near(first(image), {200, 40, 40}, 0.5));
        CHECK(image.warnings.empty() == (white > 65535));
        if (white <= 65535) CHECK_THAT(image.warnings.at(0), Contains("of 32 bits") && Contains("[colour-range]"));
    }
    CHECK(near(first(read(2147483647.0, OIIO::TypeDesc::INT32)), {200, 40, 40}, 0.5));
    CHECK(near(first(read(255, OIIO::TypeDesc::INT32)), {200, 40, 40}, 0.5));
}

TEST_CASE("floating point with a profile is coded as the profile says") {
    TiffPage page{.bits = 32, .pixel = {200 * 257, 40 * 257, 40 * 257}};
    page.profile = swapped_profile();
    const DecodedImage image = decoded(tiff_of({page}));
    CHECK(near(codes_of(image), {40, 40, 200}, 2));
    CHECK(image.warnings.empty());
    page.profile.assign(200, 7);
    const DecodedImage broken = decoded(tiff_of({page}));
    CHECK(near(codes_of(broken), {200, 40, 40}, 0.5));
    REQUIRE(broken.warnings.size() == 1);
    CHECK_THAT(broken.warnings[0], Contains("ICC profile is broken"));
}

TEST_CASE("pages are said, and smaller copies are passed over") {
    const TiffPage red{.pixel = {200, 40, 40}}, blue{.pixel = {40, 60, 200}};
    TiffPage thumbnail{.pixel = {1, 2, 3}};
    thumbnail.smaller_copy = true;
    CHECK(near(codes_of(decoded(tiff_of({red, blue}))), {200, 40, 40}, 0.5));
    CHECK_THAT(decoded(tiff_of({red, blue})).warnings.at(0), Contains("2 pages"));
    for (const auto& pages : {std::vector{thumbnail, blue}, std::vector{thumbnail, thumbnail, blue, thumbnail},
                              std::vector{blue, thumbnail}}) {
        const DecodedImage image = decoded(tiff_of(pages));
        CHECK(near(codes_of(image), {40, 60, 200}, 0.5));
        CHECK(image.texels.width_px == 20);
        CHECK(image.warnings.empty());
    }
    CHECK(decoded(tiff_of({thumbnail})).texels.width_px == 10);
    CHECK_THAT(decoded(tiff_of({thumbnail})).warnings.at(0), Contains("smaller copy"));
    // A page of another kind than the thumbnail's.
    const TiffPage lab{PHOTOMETRIC_CIELAB, 8, 0, false, stored({75, 0, 0}, PHOTOMETRIC_CIELAB, 8)};
    CHECK(near(codes_of(decoded(tiff_of({thumbnail, lab}))), {185, 185, 185}, 2));
}

TEST_CASE("PSD is read as the picture of all its layers") {
    // Its head, no palette, resources or layers, then red, green and blue, not packed (Photoshop file formats).
    std::string psd("8BPS\0\1\0\0\0\0\0\0\0\3\0\0\0\2\0\0\0\2\0\x8\0\3", 26);
    psd.append(14, '\0').append(4, '\xc8').append(8, '\x28');
    const DecodedImage image = decode_image(std::as_bytes(std::span(psd)), "a.psd", {.others = decode_other});
    CHECK(near(codes_of(image), {200, 40, 40}, 0.5));
    CHECK(image.warnings.empty());
}

TEST_CASE("PSD of layers without a picture of all of them is lost colour, and one of inks is taken as inks") {
    const PsdLayer red{{200, 40, 40}}, blue{{40, 60, 200}, true};
    const DecodedImage lost = decoded_psd(psd_of({0, 0, 0}, {red, blue}));
    CHECK_THAT(lost.lost_colour, Contains("a.psd") && Contains("LOST"));
    CHECK(decoded_psd(psd_of({255, 255, 255}, {red})).lost_colour == lost.lost_colour);
    CHECK(decoded_psd(psd_of({255, 255, 255}, {}, false)).lost_colour == lost.lost_colour);
    // What is hidden is not missed, nor is a picture of one colour one that is lost.
    CHECK(decoded_psd(psd_of({200, 40, 40}, {red, blue})).lost_colour.empty());
    CHECK(decoded_psd(psd_of({255, 255, 255}, {blue})).lost_colour.empty());
    CHECK(decoded_psd(psd_of({200, 40, 40}, {red})).warnings.empty());
    const Picture picture = finish_picture(lost, "a.psd");
    CHECK(picture.lost_colour == lost.lost_colour);
    CHECK_THAT(picture.warnings.at(0), Contains("[lost-colour]"));
    const TemporaryFolder folder;
    write_whole_file(folder.path() / "t.psd", psd_of({0, 0, 0}, {red}));
    write_whole_file(folder.path() / "a.mtl", std::string("newmtl m\nmap_Kd t.psd\n"));
    write_whole_file(folder.path() / "a.obj", std::string("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
                                                          "vt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"));
    CHECK_THAT(read_model_here(folder.path() / "a.obj", {}, decode_other).lost_colour, Contains("t.psd"));

    const DecodedImage inks = decoded_psd(psd_of({200, 40, 40, 255}, {}, true, 4));  // what is left of the paper
    CHECK(near(codes_of(inks), {200, 40, 40}, 1));
    REQUIRE(inks.warnings.size() == 1);
    CHECK_THAT(inks.warnings[0], Contains("CMYK") && Contains("no profile") && Contains("[picture-colours]"));

    // Its pixels are index 7: in each of the three lists of 256 that stand behind the head.
    std::string indexed = psd_of({7}, {}, true, 2);
    std::string palette(768, '\0');
    palette[7] = '\xc8', palette[256 + 7] = palette[512 + 7] = '\x28';
    indexed.replace(26, 4, big(palette.size()) + palette);
    CHECK(near(codes_of(decoded_psd(indexed)), {200, 40, 40}, 0.5));
    CHECK(decoded_psd(indexed).warnings.empty());
    CHECK_FALSE(decoded_psd(indexed).has_alpha);
    const std::string clear = "8BIM" + big(1047, 2) + big(0, 2) + big(2) + big(7, 2);
    const std::size_t resources = 26 + 4 + palette.size();
    indexed.replace(resources, 4, big(clear.size() + 30));
    indexed.insert(resources + 4, clear);
    CHECK(decoded_psd(indexed).has_alpha);

    const std::string whole = psd_of({0, 0, 0}, {red, blue}, false);
    const PsdFacts facts = psd_facts(std::as_bytes(std::span(whole)));
    CHECK(facts.says_unmerged);
    CHECK(facts.hidden == std::vector{false, true});
    for (std::size_t length = 0; length < whole.size(); ++length)
        CHECK(psd_facts(std::as_bytes(std::span(whole)).first(length)).hidden.size() <= 2);
}

TEST_CASE("what a GIF leaves transparent is transparent") {
    // 2 x 1, two colours, of which one is transparent; then clear, 0, 1, end in codes of 3 bits.
    std::string gif("GIF89a\2\0\1\0\x80\0\0\xc8\x28\x28\x28\x3c\xc8", 19);
    gif.append("\x21\xf9\4\1\0\0\1\0", 8).append("\x2c\0\0\0\0\2\0\1\0\0\2\2\x44\x0a\0\x3b", 16);
    const auto read = [&] { return decode_image(std::as_bytes(std::span(gif)), "a.gif", {.others = decode_other}); };
    const DecodedImage image = read();
    CHECK(image.has_alpha);
    CHECK(image.texels.alpha(0) == 1);
    CHECK(image.texels.alpha(1) == 0);
    gif[22] = 0;  // no colour is transparent
    CHECK_FALSE(read().has_alpha);
}

TEST_CASE("BMP says how large it is printed") {
    // 1 x 1, 24 bits, 7874 and 3937 pixels a metre
    std::string bmp("BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0\0\0\0\0\4\0\0\0", 38);
    bmp += std::string("\xc2\x1e\0\0\x61\x0f\0\0\0\0\0\0\0\0\0\0\x28\x28\xc8\0", 20);
    const DecodedImage image = decode_image(std::as_bytes(std::span(bmp)), "a.bmp", {.others = decode_other});
    CHECK(near(codes_of(image), {200, 40, 40}, 0.5));
    CHECK(image.dpi_x == Approx(200).epsilon(1e-3));
    CHECK(image.dpi_y == Approx(100).epsilon(1e-3));
}

TEST_CASE("BMP says by masks which byte is which colour") {
    const auto read = [](const std::vector<std::size_t>& masks, const std::string& pixel) {
        const std::string file = bmp_with_masks(masks, pixel);
        return decode_image(std::as_bytes(std::span(file)), "a.bmp", {.others = decode_other});
    };
    const std::string rgba("\xc8\x28\x3c\xff"), abgr("\xff\x3c\x28\xc8"), bgra("\x3c\x28\xc8\xff");
    for (const DecodedImage& image :
         {read({0xff, 0xff00, 0xff0000, 0xff000000}, rgba), read({0xff000000, 0xff0000, 0xff00, 0xff}, abgr),
          read({0xff0000, 0xff00, 0xff, 0xff000000}, bgra), read({0xff, 0xff00, 0xff0000, 0}, "\xc8\x28\x3c\x01")}) {
        CHECK(near(codes_of(image), {200, 40, 60}, 0.5));
        CHECK_FALSE(image.has_alpha);
    }
    const DecodedImage half = read({0xff, 0xff00, 0xff0000, 0xff000000}, "\xc8\x28\x3c\x80");
    CHECK(half.texels.alpha(0) == Approx(128 / 255.0).margin(1e-3));
    CHECK(near(codes_of(half), {200, 40, 60}, 0.5));  // not multiplied by alpha
    CHECK_THROWS_WITH(read({0x3ff, 0xffc00, 0x3ff00000, 0}, rgba), Contains("not 8 bits each"));
}

TEST_CASE("The fourth byte of a BMP without masks is alpha, or nothing where all are zero") {
    const auto read = [](const std::string& pixels) {
        std::string bmp = "BM" + number(70) + number(0) + number(54) + number(40) + number(2) + number(2);
        bmp += number(1 | 32 << 16) + std::string(24, '\0') + pixels + pixels;
        return decode_image(std::as_bytes(std::span(bmp)), "a.bmp", {.others = decode_other});
    };
    const DecodedImage filled = read(std::string("\x3c\x28\xc8\0\x3c\x28\xc8\0", 8)),
                       clear = read(std::string("\x3c\x28\xc8\x40\x3c\x28\xc8\0", 8));
    CHECK_FALSE(filled.has_alpha);
    CHECK(near(codes_of(filled), {200, 40, 60}, 0.5));
    CHECK(clear.texels.alpha(0) == Approx(64 / 255.0).margin(1e-3));
    CHECK(clear.texels.alpha(1) == 0);
    CHECK(near(codes_of(clear), {200, 40, 60}, 0.5));
}

TEST_CASE("PFM is linear light, and Radiance's gamma of 2.2 is coded as sRGB is") {
    std::string pfm("PF\n1 1\n-1.0\n");
    for (const float value : {0.5f, 0.25f, 0.125f}) {
        const auto bits = std::bit_cast<std::array<char, 4>>(value);
        pfm.append(bits.begin(), bits.end());
    }
    const auto read = [](const std::string& file) {
        return decode_image(std::as_bytes(std::span(file)), "a.picture", {.others = decode_other});
    };
    CHECK((read(pfm).texels.rgb(0) - Eigen::Vector3f(0.5f, 0.25f, 0.125f)).norm() < 1e-4f);
    CHECK(read(pfm).warnings.empty());
    std::string hdr("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nGAMMA=2.2\n\n-Y 1 +X 1\n");
    const DecodedImage coded = read(hdr + "\x80\x80\x80\x80");
    CHECK(codes_of(coded)[0] == Approx(127.5).margin(1));
    REQUIRE(coded.warnings.size() == 1);
    CHECK_THAT(coded.warnings[0], Contains("sRGB's curve"));
}

TEST_CASE("whole files of kinds that are not read are not called damaged") {
    std::string psd("8BPS\0\1\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\2\0\x8\0\x8", 26);  // duotone
    psd.append(16, '\0');
    CHECK_THROWS_WITH(decode_image(std::as_bytes(std::span(psd)), "a", {.others = decode_other}), !Contains("\n"));
    for (const std::string& file : {psd, std::string("P1\n2 2\n0110\n")})
        CHECK_THROWS_WITH(decode_image(std::as_bytes(std::span(file)), "a", {.others = decode_other}),
                          Contains("of a kind that is not read") && !Contains("()"));
}

TEST_CASE("OpenEXR shows its display window, and nothing where it has no pixels or beyond") {
    const TemporaryFolder folder;
    const auto read = [&](const PixelWindow& data, const PixelWindow& display, int channels) {
        const std::string file = (folder.path() / "a.exr").string();
        OIIO::ImageSpec spec(int(data.width), int(data.height), channels, OIIO::TypeDesc::FLOAT);
        spec.x = int(data.x);
        spec.y = int(data.y);
        spec.full_x = int(display.x);
        spec.full_y = int(display.y);
        spec.full_width = int(display.width);
        spec.full_height = int(display.height);
        const std::vector<float> ones(std::size_t(channels) * data.pixels(), 1.0f);
        const auto out = OIIO::ImageOutput::create(file);
        REQUIRE((out && out->open(file, spec) && out->write_image(OIIO::TypeDesc::FLOAT, ones.data()) && out->close()));
        return decode_image(read_bytes(file, 1 << 24), "a.exr", {.others = decode_other});
    };
    for (const int channels : {3, 4}) {
        const DecodedImage part = read({2, 1, 2, 1}, {0, 0, 5, 3}, channels);
        CHECK(part.texels.width_px == 5);
        CHECK(part.texels.height_px == 3);
        CHECK(part.has_alpha == (channels == 4));
        for (std::size_t i = 0; i < 15; ++i) CHECK(part.texels.rgb(i).x() == (i == 7 || i == 8 ? 1 : 0));
    }
    const DecodedImage shown = read({-2, -1, 6, 6}, {0, 0, 3, 2}, 3);
    CHECK(shown.texels.pixels() == 6);
    CHECK(shown.texels.rgb(5).x() == 1);
}

TEST_CASE("TGA is known by its name, in quotes or not, and by its foot") {
    // 1 x 1, 24 bits, no palette: blue, green, red
    const std::string head("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0\x28\x28\xc8", 21);
    const std::string foot("\0\0\0\0\0\0\0\0TRUEVISION-XFILE.", 26);
    const auto read = [](const std::string& text, const std::string& name) {
        return decode_image(std::as_bytes(std::span(text)), name, {.others = decode_other});
    };
    for (const char* name : {"a.tga", "'a.tga'", "A.TGA"}) CHECK(near(codes_of(read(head, name)), {200, 40, 40}, 0.5));
    CHECK(near(codes_of(read(head + foot, "image 3")), {200, 40, 40}, 0.5));
    CHECK_THROWS_WITH(read(head, "image 3"), Contains("known kind"));
}
