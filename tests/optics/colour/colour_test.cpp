// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/colour.h"

#include <algorithm>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/colour/spectral_colour.h"
#include "tests/optics/reference.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;
using Eigen::Vector3d;

namespace {

double difference(const Vector3d& a, const Vector3d& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("CIEDE2000 gives Sharma's 34 pairs in both orders") {
    const auto& pairs = reference("ciede2000_sharma34.json").at("pairs");
    REQUIRE(pairs.size() == 34);
    for (const auto& pair : pairs) {
        const Vector3d lab_1 = vector_of(pair.at("lab1")), lab_2 = vector_of(pair.at("lab2"));
        const double published = pair.at("dE00");  // four decimals
        CHECK(ciede2000(lab_1, lab_2) == Approx(published).margin(6e-5).epsilon(0));
        CHECK(ciede2000(lab_2, lab_1) == Approx(published).margin(6e-5).epsilon(0));
    }
}

TEST_CASE("sRGB's matrix and curve are those of the standard") {
    const auto& srgb = reference("srgb.json");
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
            const double published = srgb.at("RGB_to_XYZ_IEC_4digit")[row][column];
            const double computed = srgb.at("RGB_to_XYZ_from_primaries")[row][column];
            CHECK(xyz_from_linear_srgb_matrix()(i, j) == Approx(computed).margin(1e-12));
            CHECK(xyz_from_linear_srgb_matrix()(i, j) == Approx(published).margin(5e-5));
        }
    }
    CHECK(difference(xyz_from_linear_srgb({1, 1, 1}), d65_white()) < 1e-14);
    CHECK(difference(d65_white(), vector_of(srgb.at("white_XYZ").at("D65_from_xy"))) < 1e-14);
    CHECK(srgb_decode(0.04045) == Approx(0.04045 / 12.92));
    CHECK(srgb_decode(0.5) == Approx(std::pow(0.555 / 1.055, 2.4)));
    CHECK(srgb_decode(1) == 1);
    for (int k = -255; k <= 510; ++k) CHECK(srgb_encode(srgb_decode(k / 255.0)) == Approx(k / 255.0).margin(1e-7));
}

TEST_CASE("Colours survive the way to Lab, XYZ and Oklab and back") {
    RandomStream random(5, 6);
    for (int trial = 0; trial < 1000; ++trial) {
        const auto coordinate = [&] { return 1.4 * random.uniform() - 0.2; };
        const Vector3d rgb(coordinate(), coordinate(), coordinate());
        CHECK(difference(linear_srgb_from_lab(lab_from_linear_srgb(rgb)), rgb) < 1e-12);
        CHECK(difference(linear_srgb_from_xyz(xyz_from_linear_srgb(rgb)), rgb) < 1e-12);
        CHECK(difference(linear_srgb_from_oklab(oklab_from_linear_srgb(rgb)), rgb) < 1e-12);
    }
    CHECK(difference(lab_from_linear_srgb({1, 1, 1}), {100, 0, 0}) < 1e-10);
    CHECK(difference(lab_from_linear_srgb({0, 0, 0}), {0, 0, 0}) < 1e-10);
    // Ottosson's table of 2020: XYZ (0.950, 1, 1.089) has Oklab (1, 0, 0), to three digits.
    CHECK(difference(oklab_from_linear_srgb(linear_srgb_from_xyz({0.950, 1, 1.089})), {1, 0, 0}) < 1e-3);
    // The same table: XYZ (0, 1, 0) has (0.922, -0.671, 0.263).
    CHECK(difference(oklab_from_linear_srgb(linear_srgb_from_xyz({0, 1, 0})), {0.922, -0.671, 0.263}) < 1e-3);
}

TEST_CASE("Lab has the slope that differences show, and CIEDE2000 the metric") {
    RandomStream random(7, 8);
    constexpr double h = 1e-6;
    for (int trial = 0; trial < 500; ++trial) {
        const Vector3d rgb(random.uniform(), random.uniform(), random.uniform());
        const Eigen::Matrix3d slope = lab_derivative(rgb);
        for (int c = 0; c < 3; ++c) {
            Vector3d more = rgb, less = rgb;
            more[c] += h * rgb[c];
            less[c] -= h * rgb[c];
            const Vector3d by_difference = (lab_from_linear_srgb(more) - lab_from_linear_srgb(less)) / (2 * h * rgb[c]);
            CHECK(difference(slope.col(c), by_difference) < 1e-4 * (1 + slope.col(c).norm()));
        }
        const Vector3d lab = lab_from_linear_srgb(rgb);
        const Vector3d d = 0.01 * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        CHECK((ciede2000_metric(lab) * d).norm() == Approx(ciede2000(lab - 0.5 * d, lab + 0.5 * d)).epsilon(1e-3));
    }
    // Below the cube root's end.
    CHECK(difference(lab_derivative({1e-4, 1e-4, 1e-4}) * Vector3d(1e-4, 1e-4, 1e-4),
                     lab_from_linear_srgb({1e-4, 1e-4, 1e-4})) < 1e-9);
}

TEST_CASE("The ColorChecker goes from Lab D50 to sRGB") {
    for (const auto& patch : reference("colorchecker24.json").at("patches")) {
        for (const std::string when : {"before", "after"}) {
            const Vector3d lab = vector_of(patch.at("lab_D50_" + when + "_nov2014"));
            const Vector3d rgb =
                linear_srgb_from_xyz(adapt_white(xyz_from_lab(lab, d50_white()), d50_white(), d65_white()));
            CHECK(difference(rgb, vector_of(patch.at("srgb_linear_" + when + "_nov2014"))) < 1e-6);
        }
    }
}

TEST_CASE("Spectra become XYZ and Lab under D50 and D65") {
    const auto& table = reference("colorchecker24_spectra_ohta.json");
    const std::vector<double> wavelengths = table.at("wavelength_nm");
    for (const auto& patch : table.at("patches")) {
        const std::vector<double> reflectance = patch.at("reflectance");
        for (const auto& [name, illuminant] : {std::pair{"D50", Illuminant::d50}, std::pair{"D65", Illuminant::d65}}) {
            const Vector3d xyz = xyz_from_spectrum(wavelengths, reflectance, illuminant);
            CHECK(difference(xyz, vector_of(patch.at(std::string("XYZ_") + name))) < 1e-6);
            const Vector3d lab = lab_from_xyz(xyz, spectral_white(illuminant));
            CHECK(difference(lab, vector_of(patch.at(std::string("Lab_") + name))) < 1e-4);
        }
    }
    const auto& white = reference("illuminants_5nm.json").at("check_white_XYZ_5nm_sum_380_780_Y100");
    CHECK(difference(100 * spectral_white(Illuminant::d65), vector_of(white.at("D65"))) < 1e-9);
    CHECK(difference(100 * spectral_white(Illuminant::d50), vector_of(white.at("D50"))) < 1e-9);
    CHECK(difference(100 * spectral_white(Illuminant::a), vector_of(white.at("A"))) < 1e-9);
}

TEST_CASE("Coarse spectra are read as straight lines between their wavelengths") {
    const std::vector<double> coarse{400, 500, 700}, values{0.2, 0.6, 0.1};
    std::vector<double> fine, drawn;
    for (double nm = 380; nm <= 780; nm += 5) {
        fine.push_back(nm);
        drawn.push_back(nm <= 400   ? 0.2
                        : nm <= 500 ? 0.2 + 0.4 * (nm - 400) / 100
                        : nm <= 700 ? 0.6 - 0.5 * (nm - 500) / 200
                                    : 0.1);
    }
    CHECK(difference(xyz_from_spectrum(coarse, values, Illuminant::d65),
                     xyz_from_spectrum(fine, drawn, Illuminant::d65)) < 1e-14);
}

TEST_CASE("A summary of differences interpolates its percentiles") {
    std::vector<double> values;
    for (int k = 20; k >= 0; --k) values.push_back(k);
    const DifferenceSummary summary = summarize(values);
    CHECK(summary.count == 21);
    CHECK(summary.mean == Approx(10));
    CHECK(summary.median == Approx(10));
    CHECK(summary.percentile_95 == Approx(19));
    CHECK(summary.max == 20);
    CHECK(summarize(std::vector<double>{1, 2}).median == Approx(1.5));
    CHECK(summarize(std::vector<double>{}).count == 0);
}
