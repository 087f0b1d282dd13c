// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers without another source: XYZ, Bradford and CIELAB of a numpy script over the tables in tests/data/reference,
// which shares nothing with the program.
#include "optics/colour/lamp.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "optics/colour/colour.h"
#include "tests/optics/colour/split_channels.h"
#include "tests/places.h"

namespace voxtone::optics {
namespace {

std::vector<double> nodes() {
    std::vector<double> nm;
    for (std::size_t k = 0; k < lamp_samples; ++k) nm.push_back(lamp_first_nm + lamp_step_nm * double(k));
    return nm;
}

LampPower lamp(const char* name) { return known_lamp(name).value(); }

Eigen::Vector3d lab_seen(const Channels& channels, const Eigen::VectorXd& rho) {
    return lab_from_linear_srgb(linear_srgb_weights(channels) * rho);
}

}  // namespace

TEST_CASE("Lamps by name have the chromaticities that the CIE gives them") {
    struct Published {
        const char* name;
        double x, y;  // CIE 15:2018, Tables 9.1, 10.1 and 12.2
    };
    for (const auto& [name, x, y] :
         {Published{"A", 0.44758, 0.40745}, Published{"D50", 0.34567, 0.35851}, Published{"D65", 0.31272, 0.32903},
          Published{"F2", 0.3721, 0.3751}, Published{"F11", 0.3805, 0.3769}, Published{"LED-B1", 0.4560, 0.4078},
          Published{"led-b3", 0.3756, 0.3723}}) {
        CAPTURE(name);
        const Eigen::Vector3d xyz = xyz_weights(nodes(), lamp(name)).rowwise().sum();
        CHECK(xyz.y() == Approx(1));
        CHECK(xyz.x() / xyz.sum() == Approx(x).margin(1e-4));
        CHECK(xyz.y() / xyz.sum() == Approx(y).margin(1e-4));
    }
    CHECK(lamp_names().size() == 7);
    for (const char* word : {"", "F3", "2700", "K", "100K", "2e6K", "nanK", "2700K "}) {
        CAPTURE(word);
        CHECK_FALSE(known_lamp(word));
    }
}

TEST_CASE("A black body of 2856 K is illuminant A") {
    const LampPower body = lamp("2856K"), a = lamp("A");
    for (std::size_t k = 0; k < lamp_samples; ++k) CHECK(body[k] == Approx(a[k]).epsilon(1e-3));
}

TEST_CASE(
    "A lamp's table keeps its numbers at 5 nm, the power of its lines where it is finer, and is linear where coarser") {
    const LampPower f11 = lamp("F11");
    const LampPower same = sampled_lamp(nodes(), f11);
    for (std::size_t k = 0; k < lamp_samples; ++k) CHECK(same[k] == Approx(f11[k]).epsilon(1e-12));

    std::vector<double> nm, power;
    for (int i = 380; i <= 780; ++i) nm.push_back(i), power.push_back(i == 547 ? 10 : 1);
    const LampPower line = sampled_lamp(nm, power);
    double sum = 0;
    for (const double p : line) sum += lamp_step_nm * (p - 1);
    CHECK(sum == Approx(9));  // 9 more over 1 nm
    CHECK(line[33] - 1 == Approx(9.0 / 5 * 3 / 5));
    CHECK(line[34] - 1 == Approx(9.0 / 5 * 2 / 5));

    const LampPower coarse = sampled_lamp(std::vector<double>{390, 590, 790}, std::vector<double>{0, 100, 0});
    CHECK(coarse[0] == 0);  // not known
    CHECK(coarse[12] == Approx(25));
    CHECK(coarse[42] == Approx(100));
    CHECK(coarse[80] == Approx(5));
}

TEST_CASE("Spectra that are nearly grey by day part under lamps, as far as a computation by others says") {
    struct Seen {
        const char* lamp;
        std::array<double, 3> crest, trough;
    };
    const Channels spectral{nodes()};
    Eigen::VectorXd wave = Eigen::VectorXd::Zero(Eigen::Index{lamp_samples});
    for (Eigen::Index k = 0; k < wave.size(); ++k) wave[k] = 0.3 * std::sin(2 * std::numbers::pi * double(k) / 20);
    for (const Seen& seen : {Seen{"D65", {75.237, 1.254, 11.835}, {76.887, -1.217, -9.950}},
                             Seen{"2700K", {75.056, 8.213, 9.126}, {77.060, -8.195, -7.849}},
                             Seen{"F11", {72.101, 30.986, 6.471}, {79.722, -30.672, -5.092}}}) {
        CAPTURE(seen.lamp);
        const Channels under = seen_under(spectral, lamp(seen.lamp));
        const auto check = [&](const Eigen::VectorXd& rho, const std::array<double, 3>& lab) {
            CHECK((lab_seen(under, rho) - Eigen::Vector3d(lab[0], lab[1], lab[2])).cwiseAbs().maxCoeff() < 0.01);
        };
        check(0.5 + wave.array(), seen.crest);
        check(0.5 - wave.array(), seen.trough);
    }
}

TEST_CASE("White is white under any lamp, and under D65 nothing changes") {
    const Channels spectral{{400, 450, 520, 560, 610, 700}};
    for (const Channels& channels : {spectral, Channels{}, testing::split_channels(testing::green_twice)})
        for (const char* name : {"A", "D65", "F11", "1000K"}) {
            CAPTURE(name, channels_text(channels));
            const Channels under = seen_under(channels, lamp(name));
            CHECK(under.size() == channels.size());
            CHECK_FALSE(fault_of(under));
            CHECK((linear_srgb_weights(under).rowwise().sum() - Eigen::Vector3d::Ones()).norm() < 1e-9);
        }
    for (const Channels& channels : {spectral, Channels{}})
        CHECK((linear_srgb_weights(seen_under(channels, lamp("D65"))) - linear_srgb_weights(channels)).norm() < 1e-4);
}

TEST_CASE("What is guessed of a colour under another lamp is nearer than the colour as it was, for measured spectra") {
    const auto file = nlohmann::json::parse(
        std::ifstream(test::source_dir() + "/tests/data/reference/colorchecker24_spectra_ohta.json"));
    struct Off {
        const char* lamp;
        double guessed, as_it_was;  // mean CIEDE2000 of the 24 patches
    };
    for (const Off& wanted : {Off{"A", 1.17, 1.56}, Off{"F2", 1.30, 3.61}, Off{"F11", 1.29, 2.23},
                              Off{"LED-B1", 1.32, 2.10}, Off{"LED-B3", 0.68, 1.70}}) {
        CAPTURE(wanted.lamp);
        const LampPower power = lamp(wanted.lamp);
        const Eigen::Matrix3Xd by_day = xyz_weights(nodes(), Illuminant::d50), by_lamp = xyz_weights(nodes(), power);
        const Eigen::Vector3d day = by_day.rowwise().sum(), white = by_lamp.rowwise().sum();
        const Eigen::Matrix3d guess = guessed_colours(Illuminant::d50, power);
        CHECK((guess * day - white).norm() < 1e-9);
        double guessed = 0, as_it_was = 0;
        for (const auto& patch : file.at("patches")) {
            const auto rho = patch.at("reflectance").get<std::vector<double>>();
            const Eigen::Map<const Eigen::VectorXd> spectrum(rho.data(), Eigen::Index(rho.size()));
            const auto lab = [](const Eigen::Vector3d& xyz, const Eigen::Vector3d& from) {
                return lab_from_xyz(adapt_white(xyz, from, d65_white()));
            };
            const Eigen::Vector3d truth = lab(by_lamp * spectrum, white);
            guessed += ciede2000(lab(guess * (by_day * spectrum), white), truth) / 24;
            as_it_was += ciede2000(lab(by_day * spectrum, day), truth) / 24;
        }
        CHECK(guessed == Approx(wanted.guessed).margin(0.01));
        CHECK(as_it_was == Approx(wanted.as_it_was).margin(0.01));
    }
}

}  // namespace voxtone::optics
