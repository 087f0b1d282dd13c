// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/photograph.h"
#include "io/pictures/picture.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <tiffio.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/decoders/jpeg_end.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;

namespace {

/// Smooth, different in every channel, 0.02 to 0.9.
Photograph smooth(std::uint32_t width, std::uint32_t height) {
    Photograph photo{"smooth", width, height, SampleCoding::linear, 16, {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const float u = float(x) / float(width), v = float(y) / float(height);
            photo.pixels.emplace_back(0.02f + 0.8f * u, 0.1f + 0.7f * v, 0.9f - 0.5f * u * v);
        }
    return photo;
}

/// Largest difference of two photographs, `rim` pixels at the edges left out.
double difference(const Photograph& a, const Photograph& b, std::uint32_t rim = 0) {
    REQUIRE(a.width_px == b.width_px);
    REQUIRE(a.height_px == b.height_px);
    double worst = 0;
    for (std::uint32_t y = rim; y + rim < a.height_px; ++y)
        for (std::uint32_t x = rim; x + rim < a.width_px; ++x)
            worst = std::max(worst, double((a.pixels[a.index(x, y)] - b.pixels[b.index(x, y)]).cwiseAbs().maxCoeff()));
    return worst;
}

Photograph written_and_read(const Photograph& photo, const std::string& name, const TemporaryFolder& folder) {
    write_whole_file(folder.path() / name, photograph_bytes(photo, name));
    return read_photograph(folder.path() / name);
}

/// The photograph through the colour filters of a sensor (red, green / green, blue), as a DNG: what a camera keeps.
void write_dng(const Photograph& photo, const std::filesystem::path& file) {
    TIFF* tiff = TIFFOpen(file.c_str(), "w");
    REQUIRE(tiff);
    const std::uint8_t version[4] = {1, 4, 0, 0}, back[4] = {1, 1, 0, 0}, pattern[4] = {0, 1, 1, 2};
    const std::uint16_t two[2] = {2, 2};
    const float matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::uint32_t white = 65535;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, photo.width_px);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, photo.height_px);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CFA);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, photo.height_px);
    TIFFSetField(tiff, TIFFTAG_MAKE, "Test");
    TIFFSetField(tiff, TIFFTAG_MODEL, "Camera");
    TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, "Test Camera");
    TIFFSetField(tiff, TIFFTAG_DNGVERSION, version);
    TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, back);
    TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, two);
    TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, pattern);
    TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
    TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, 21);
    TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, &white);
    std::vector<std::uint16_t> row(photo.width_px);
    for (std::uint32_t y = 0; y < photo.height_px; ++y) {
        for (std::uint32_t x = 0; x < photo.width_px; ++x)
            row[x] = static_cast<std::uint16_t>(65535 * photo.pixels[photo.index(x, y)][pattern[2 * (y % 2) + x % 2]] +
                                                0.5f);
        REQUIRE(TIFFWriteScanline(tiff, row.data(), y, 0) == 1);
    }
    TIFFClose(tiff);
}

}  // namespace

TEST_CASE("photographs come back from PNG, TIFF and EXR as they were written", "[slow]") {
    const TemporaryFolder folder;
    const Photograph photo = smooth(60, 40);
    const Photograph png = written_and_read(photo, "a.png", folder), tiff = written_and_read(photo, "a.tif", folder),
                     exr = written_and_read(photo, "a.exr", folder);
    constexpr double half_code = 0.51 / 65535;
    CHECK(difference(photo, png) < half_code);
    CHECK(png.coding == SampleCoding::linear);
    CHECK(difference(photo, tiff) < half_code);
    CHECK(tiff.coding == SampleCoding::unknown);  // TIFF has no word for it
    CHECK(difference(photo, exr) == 0);
    CHECK(exr.bits == 32);
    CHECK(exr.coding == SampleCoding::linear);
}

TEST_CASE("eight bits are sRGB codes", "[slow]") {
    const TemporaryFolder folder;
    Photograph photo = smooth(60, 40);
    photo.bits = 8;
    Photograph back = written_and_read(photo, "a.png", folder);
    CHECK(back.bits == 8);
    CHECK(back.coding == SampleCoding::srgb);
    CHECK(difference(photo, back) > 0.1);
    make_linear(back);
    CHECK(difference(photo, back) < 0.005);  // half a code where the curve is steepest
    CHECK_THROWS_AS(photograph_bytes(photo, "a.tif"), UsageError);
    CHECK_THROWS_AS(photograph_bytes(photo, "a.jpg"), UsageError);
}

TEST_CASE("a camera's raw file gives what its sensor counted", "[slow]") {
    const TemporaryFolder folder;
    const Photograph photo = smooth(128, 96);
    write_dng(photo, folder.path() / "a.dng");
    const Photograph raw = read_photograph(folder.path() / "a.dng");
    CHECK(raw.coding == SampleCoding::linear);
    CHECK(difference(photo, raw, 4) < 0.006);  // colours between the filters are interpolated
}

TEST_CASE("what is no photograph is refused", "[slow]") {
    const TemporaryFolder folder;
    CHECK_THROWS_AS(read_photograph(folder.path() / "nothing.tif"), FileError);
    CHECK_THROWS_AS(read_photograph(folder.path()), FileError);
    write_whole_file(folder.path() / "text.tif", "no picture");
    CHECK_THROWS_AS(read_photograph(folder.path() / "text.tif"), InputError);
    const std::vector<std::uint8_t> whole = photograph_bytes(smooth(30, 20), "a.png");
    for (std::size_t cut = 0; cut + 20 < whole.size(); cut += whole.size() / 12) {
        write_whole_file(folder.path() / "cut.png", std::span(whole).first(cut));
        CHECK_THROWS_AS(read_photograph(folder.path() / "cut.png"), InputError);
    }
}

TEST_CASE("many photographs are read by one program, and by another after one that was refused") {
    const TemporaryFolder folder;
    std::vector<std::filesystem::path> files;
    for (const char* name : {"a.png", "b.tif", "bad.tif", "c.exr"}) {
        files.push_back(folder.path() / name);
        write_whole_file(files.back(), photograph_bytes(smooth(30 + std::uint32_t(files.size()), 20), name));
    }
    write_whole_file(files[2], "no picture");
    // Of this thread, as the system knows them.
    const auto children = [] {
        std::ifstream in("/proc/self/task/" + std::to_string(::gettid()) + "/children");
        std::string pids;
        std::getline(in, pids);
        return pids;
    };
    PhotographReader reader(files);
    CHECK(reader.read(files[0]).width_px == 31);
    const std::string first = children();
    CHECK_FALSE(first.empty());
    CHECK(reader.read(files[1]).width_px == 32);
    CHECK(reader.read(files[0]).pixels == read_photograph(files[0]).pixels);
    CHECK(children() == first);
    CHECK_THROWS_WITH(reader.read(files[2]), Catch::Matchers::Contains("bad.tif"));
    CHECK_THROWS_AS(reader.read(folder.path() / "nothing.png"), FileError);
    CHECK(reader.read(files[3]).width_px == 34);
    CHECK(children() != first);
}

TEST_CASE("a TIFF that was cut short or damaged is refused, and not black where its rows are missing", "[slow]") {
    const TemporaryFolder folder;
    const std::vector<std::uint8_t> whole = photograph_bytes(smooth(200, 300), "a.tif");
    write_whole_file(folder.path() / "whole.tif", whole);
    CHECK(read_photograph(folder.path() / "whole.tif").pixels.size() == 200 * 300);
    for (const double part : {0.3, 0.6, 0.9, 0.99}) {
        CAPTURE(part);
        write_whole_file(folder.path() / "cut.tif", std::span(whole).first(std::size_t(part * double(whole.size()))));
        CHECK_THROWS_AS(read_photograph(folder.path() / "cut.tif"), InputError);
        CHECK_THROWS_AS(read_picture(folder.path() / "cut.tif"), InputError);
        std::vector<std::uint8_t> damaged = whole;
        for (std::size_t k = 0; k < 500; ++k) damaged[std::size_t(part * 0.9 * double(whole.size())) + k] ^= 0x5a;
        write_whole_file(folder.path() / "damaged.tif", damaged);
        CHECK_THROWS_AS(read_photograph(folder.path() / "damaged.tif"), InputError);
        CHECK_THROWS_AS(read_picture(folder.path() / "damaged.tif"), InputError);
    }
}

TEST_CASE("a JPEG ends with a mark that no thumbnail and no code can be taken for") {
    // Start, a segment that holds an end mark, a scan with a stuffed byte and a restart, end; then somebody's bytes.
    const std::vector<int> codes{0xff, 0xd8, 0xff, 0xe1, 0, 4,    0xff, 0xd9, 0xff, 0xda, 0,    3,
                                 9,    0x12, 0xff, 0,    7, 0xff, 0xd0, 0x34, 0xff, 0xff, 0xd9, 5};
    std::vector<std::byte> bytes;
    for (const int code : codes) bytes.push_back(std::byte(code));
    CHECK(jpeg_has_its_end(bytes));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        CHECK(jpeg_has_its_end(std::span(bytes).first(size)) == (size + 1 >= bytes.size()));
}

TEST_CASE("a photograph is turned as EXIF says: its first row and column are which sides of what was seen") {
    enum Side { top, bottom, left, right };
    constexpr std::array<std::pair<Side, Side>, 8> first_row_and_column{{{top, left},
                                                                         {top, right},
                                                                         {bottom, right},
                                                                         {bottom, left},
                                                                         {left, top},
                                                                         {right, top},
                                                                         {right, bottom},
                                                                         {left, bottom}}};
    constexpr std::uint32_t width = 3, height = 2;
    for (std::size_t o = 0; o < first_row_and_column.size(); ++o) {
        const auto [row_side, column_side] = first_row_and_column[o];
        const bool lies = row_side == left || row_side == right;
        Photograph photo;
        photo.width_px = lies ? height : width, photo.height_px = lies ? width : height;
        photo.pixels.resize(std::size_t{width} * height);
        photo.orientation = int(o) + 1;
        const auto along = [&](Side side, std::uint32_t x, std::uint32_t y) {
            return side == top ? y : side == bottom ? height - 1 - y : side == left ? x : width - 1 - x;
        };
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                photo.pixels[photo.index(along(column_side, x, y), along(row_side, x, y))] =
                    Eigen::Vector3f::Constant(float(10 * y + x));
        turn_upright(photo);
        CAPTURE(o + 1);
        CHECK(photo.orientation == 1);
        REQUIRE((photo.width_px == width && photo.height_px == height));
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) CHECK(photo.pixels[photo.index(x, y)].x() == float(10 * y + x));
    }
}

TEST_CASE("the time of exposure and how it is turned are read from EXIF and EXR", "[slow]") {
    const TemporaryFolder folder;
    Photograph photo = smooth(8, 6);
    CHECK(written_and_read(photo, "silent.exr", folder).exposure_s == 0);
    photo.exposure_s = 1.0 / 15;
    CHECK(written_and_read(photo, "timed.exr", folder).exposure_s == Approx(1.0 / 15).epsilon(1e-6));
    CHECK(photograph_bytes(photo, "a.exr") == photograph_bytes(photo, "a.exr"));

    const std::filesystem::path file = folder.path() / "timed.tif";  // as a camera's software leaves it
    TIFF* tiff = TIFFOpen(file.c_str(), "w");
    REQUIRE(tiff);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2u);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1u);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 1u);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, 6);
    TIFFSetField(tiff, TIFFTAG_EXIFIFD, std::uint64_t{0});
    std::uint16_t row[6] = {1, 2, 3, 4, 5, 6};
    REQUIRE(TIFFWriteScanline(tiff, row, 0) == 1);
    REQUIRE(TIFFWriteDirectory(tiff));
    REQUIRE(TIFFCreateEXIFDirectory(tiff) == 0);
    TIFFSetField(tiff, EXIFTAG_EXPOSURETIME, 0.4);
    std::uint64_t at = 0;
    REQUIRE(TIFFWriteCustomDirectory(tiff, &at));
    REQUIRE(TIFFSetDirectory(tiff, 0));
    TIFFSetField(tiff, TIFFTAG_EXIFIFD, at);
    REQUIRE(TIFFRewriteDirectory(tiff));
    TIFFClose(tiff);
    CHECK(read_photograph(file).exposure_s == Approx(0.4).epsilon(1e-6));
    CHECK(read_photograph(file).orientation == 6);
    CHECK(read_photograph(file).width_px == 2);  // as stored
}
