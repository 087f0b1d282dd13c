// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/spot/exposure_merge.h"
#include "calibration/spot/exposure_series.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

Exposure even(double seconds, const Eigen::Vector3f& value, std::uint32_t width = 8, std::uint32_t height = 6) {
    io::Photograph photo{"photo", width, height, io::SampleCoding::linear, 16, {}};
    photo.pixels.assign(std::size_t{width} * height, value);
    return {photo, seconds};
}

Exposure even(double seconds, float value) { return even(seconds, Eigen::Vector3f(value, value, value)); }

std::string fault(ExposureMerge& merge, const Exposure& lit, const Exposure& dark) {
    try {
        merge.add(lit, dark);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Exposures are named with their seconds") {
    CHECK(parse_exposure("a/b.tif").seconds == 0);
    CHECK(parse_exposure("a/b.tif").file == "a/b.tif");
    CHECK(parse_exposure("b.tif@0.5").seconds == 0.5);
    CHECK(parse_exposure("b.tif@0.5").file == "b.tif");
    CHECK(parse_exposure("b@c.tif@1/15").seconds == 1.0 / 15);
    CHECK(parse_exposure("b@c.tif@1/15").file == "b@c.tif");
    for (const char* wrong : {"b.tif@", "b.tif@x", "b.tif@0", "b.tif@-1", "b.tif@1/0", "b.tif@1/", "b.tif@/15",
                              "b.tif@nan", "b.tif@inf", "b.tif@1s", "@1", "b.tif@1/2/3"}) {
        INFO(wrong);
        CHECK_THROWS_AS(parse_exposure(wrong), UsageError);
    }
    CHECK(seconds_text(1.0 / 15) == "1/15 s");
    CHECK(seconds_text(0.0667) == "1/15 s");
    CHECK(seconds_text(0.4) == "0.4 s");
    CHECK(seconds_text(0.3) == "0.3 s");
    CHECK(seconds_text(30) == "30 s");
}

TEST_CASE("An exposure's time comes from the user, else from the file, and is asked for where neither knows",
          "[slow]") {
    const io::TemporaryFolder folder;
    const auto write = [&](const std::string& name, double seconds, int bits = 16) {
        io::Photograph photo = even(1, 0.25f).photograph;
        photo.exposure_s = seconds, photo.bits = bits;
        io::write_whole_file(folder.path() / name, io::photograph_bytes(photo, name));
        return folder.path() / name;
    };
    const auto timed = write("timed.exr", 0.125), silent = write("silent.png", 0), codes = write("codes.png", 0, 8);
    io::PhotographReader reader(std::vector{timed, silent, codes, folder.path() / "none.tif"});
    CHECK(read_exposure({timed, 0}, reader).seconds == 0.125);
    CHECK(read_exposure({timed, 2}, reader).seconds == 2);
    CHECK(read_exposure({silent, 3}, reader).photograph.pixels[5][1] == Approx(0.25).margin(1e-4));
    CHECK_THROWS_WITH(read_exposure({silent, 0}, reader), Contains("silent.png") && Contains("@1/15"));
    CHECK_THROWS_WITH(read_exposure({codes, 1}, reader), Contains("codes.png") && Contains("sRGB"));
    CHECK_THROWS_AS(read_exposure({folder.path() / "none.tif", 1}, reader), FileError);
}

TEST_CASE("Merged light is that of exposures less their dark frames, weighted by their variance") {
    CameraNoise noise{1000, 0.001, 0.9};
    ExposureMerge merge(noise);
    merge.add(even(1, 0.15f), even(1, 0.05f));
    merge.add(even(4, 0.50f), even(4, 0.06f));
    const MergedPicture picture = merge.merged();
    // By hand. The dark frame of the second lies 0.01 above that of the first.
    const double x1 = 0.10, x2 = 0.44 / 4, w1 = 1 / (2e-6 + 0.10 / 1000), w2 = 16 / (2e-6 + (2 * 0.01 + 4 * x1) / 1000);
    for (int c = 0; c < 3; ++c) {
        CHECK(picture.light[7][c] == Approx((w1 * x1 + w2 * x2) / (w1 + w2)).epsilon(1e-5));
        CHECK(picture.weight[7][c] == Approx(w1 + w2).epsilon(1e-4));
    }
    CHECK(picture.exposures[7] == 2);
    CHECK(picture.seconds == std::vector<double>{1, 4});
    CHECK(picture.cut_at_black == 0);
    REQUIRE(picture.step.size() == 1);
    CHECK(picture.step[0] == Approx(1.1).epsilon(1e-4));
}

TEST_CASE("Saturated samples do not count, whichever channel or frame they are of") {
    ExposureMerge merge({20000, 2e-4, 0.95});
    Exposure first = even(1, 0.2f), second = even(4, Eigen::Vector3f(0.5f, 0.96f, 0.5f)), dark = even(4, 0.f);
    first.photograph.pixels[3] = {0.2f, 1.0f, 0.2f};
    dark.photograph.pixels[5] = {0.f, 0.f, 1.f};
    merge.add(first, even(1, 0.f));
    merge.add(second, dark);
    const MergedPicture picture = merge.merged();
    CHECK(picture.light[0][1] == Approx(0.2));  // of the first only
    CHECK(picture.light[0][0] ==
          Approx((1 * 0.2 + 4 * 0.125) / 5).epsilon(1e-3));  // of both; shot noise weighs by time
    CHECK(picture.exposures[0] == 1);
    CHECK(picture.weight[3][1] == 0);  // never
    CHECK(picture.weight[3][0] > 0);
    CHECK(picture.exposures[3] == 0);
    CHECK(picture.cut_at_black == 1);
    CHECK(picture.light[5][2] == Approx(0.2));  // a hot pixel of the dark frame
}

TEST_CASE("Exposures that do not belong together are refused") {
    ExposureMerge merge{CameraNoise{}};
    merge.add(even(1, 0.2f), even(1, 0.f));
    CHECK_THAT(fault(merge, even(2, {0, 0, 0}, 8, 7), even(2, {0, 0, 0}, 8, 7)),
               Contains("8 x 7") && Contains("8 x 6"));
    CHECK_THAT(fault(merge, even(2, 0.f), even(2, {0, 0, 0}, 8, 7)), Contains("dark frame") && Contains("8 x 7"));
    CHECK_THAT(fault(merge, even(2, 0.f), even(1, 0.f)), Contains("2 s") && Contains("1 s") && Contains("same time"));
    CHECK_THAT(fault(merge, even(1, 0.f), even(1, 0.f)), Contains("from short to long"));
    CHECK_THAT(fault(merge, even(0.5, 0.f), even(0.5, 0.f)), Contains("0.5 s") && Contains("from short to long"));
    CHECK(fault(merge, even(2, 0.4f), even(2.01, 0.f)) == "accepted");
}
