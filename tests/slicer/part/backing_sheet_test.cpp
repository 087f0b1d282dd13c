// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/backing_sheet.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

const optics::Channels rgb{};

}  // namespace

TEST_CASE("A colour is the reflectance of R, G and B, and of other channels what looks like it", "[backing]") {
    const std::array<double, 3> colour{0.6, 0.3, 0.45};
    CHECK(reflectance_of(colour, rgb) == std::vector<double>{0.6, 0.3, 0.45});
    for (const optics::Channels& channels :
         {optics::wide_channels(), optics::colorimetric_channels(optics::Illuminant::d50)}) {
        const std::vector<double> found = reflectance_of(colour, channels);
        const Eigen::Vector3d seen = optics::linear_srgb_weights(channels) *
                                     Eigen::Map<const Eigen::VectorXd>(found.data(), Eigen::Index(found.size()));
        for (int c = 0; c < 3; ++c) CHECK(seen[c] == Approx(colour[std::size_t(c)]).margin(1e-6));
        for (const double grey : reflectance_of({0.4, 0.4, 0.4}, channels)) CHECK(grey == Approx(0.4).margin(1e-3));
    }
}

TEST_CASE("A checker begins black at the slab's corner", "[backing]") {
    const auto sheet = sheet_under(parse_backing("backing", "checker:2mm"), {7, 3}, rgb);
    REQUIRE(sheet);
    CHECK(sheet->at(1, 1, 0) == 0);
    CHECK(sheet->at(3, 1, 1) == 1);
    CHECK(sheet->at(3, 2.5, 1) == 0);
    CHECK(sheet->at(6.9, 0.5, 2) == 1);
    CHECK_FALSE(sheet_under(optics::Backing::white, {7, 3}, rgb));
}

TEST_CASE("A picture under a slab has the slab's shape, its top at the largest y", "[backing]") {
    const io::TemporaryFolder folder;
    const auto file = folder.path() / "desk.png";
    io::write_whole_file(file, io::png_bytes({2, 2, 3, {255, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255}}));
    const BackingChoice desk = parse_backing("backing", file.string());
    const auto sheet = sheet_under(desk, {10, 10}, rgb);
    CHECK(sheet->at(2, 9, 0) > 0.9f);
    CHECK(sheet->at(2, 9, 2) < 0.1f);
    CHECK(sheet->at(2, 1, 2) > 0.9f);
    CHECK_THROWS_WITH(sheet_under(desk, {12, 10}, rgb), Contains("2 x 2 px") && Contains("1.200 times"));
    CHECK_THROWS_AS(sheet_under(parse_backing("backing", "not-there.png"), {10, 10}, rgb), Error);
}
