// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/channels.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "optics/colour/colour.h"
#include "optics/media/resins.h"

namespace voxtone::optics {
namespace {

Channels four_channels() {
    const Eigen::Vector3d white = d50_white();
    Channels channels;
    channels.xyz = {
        {0.6 * white.x(), 0.2, -0.01}, {0.3 * white.x(), 0.5, 0.05}, {-0.1 * white.x(), 0.25, 0.1}, {0, 0.05, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) sum += channels.xyz[c][k];
        channels.xyz[3][k] = white[static_cast<Eigen::Index>(k)] - sum;
    }
    return channels;
}

}  // namespace

TEST_CASE("R, G, B, wavelengths and channels of a printer's own are three kinds of one thing") {
    const Channels rgb, spectral{{450, 550, 650}}, own = four_channels();
    CHECK((rgb.is_rgb() && !rgb.is_spectral() && !rgb.is_own()));
    CHECK((!spectral.is_rgb() && spectral.is_spectral() && !spectral.is_own()));
    CHECK((!own.is_rgb() && !own.is_spectral() && own.is_own()));
    CHECK(rgb.size() == 3);
    CHECK(spectral.size() == 3);
    CHECK(own.size() == 4);
    CHECK(channel_name(rgb, 2) == "B");
    CHECK(channel_name(spectral, 1) == "550 nm");
    CHECK(channel_name(own, 3) == "channel 4");
    CHECK(channels_text(own) == "4 channels of their own");
    CHECK(linear_srgb_weights(rgb) == Eigen::Matrix3d::Identity());
}

TEST_CASE("A perfect diffuser is white through any channels") {
    for (const Channels& channels : {Channels{}, Channels{{450, 500, 550, 650}}, four_channels(),
                                     colorimetric_channels(Illuminant::d50), colorimetric_channels(Illuminant::a)}) {
        CAPTURE(channels_text(channels));
        const Eigen::Vector3d white = linear_srgb_weights(channels).rowwise().sum();
        CHECK((white - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff() < 1e-12);
        CHECK((d65_weights(channels).rowwise().sum() - d65_white()).cwiseAbs().maxCoeff() < 1e-12);
    }
}

TEST_CASE("XYZ as channels are the colours that they measure") {
    const Eigen::Vector3d lab(40, 35, -50), xyz = xyz_from_lab(lab, d50_white());
    const Eigen::Vector3d rho = xyz.cwiseQuotient(d50_white());
    const Eigen::Vector3d rgb = linear_srgb_weights(colorimetric_channels(Illuminant::d50)) * rho;
    const Eigen::Vector3d back = adapt_white(xyz_from_linear_srgb(rgb), d65_white(), d50_white());
    CHECK((lab_from_xyz(back, d50_white()) - lab).norm() < 1e-9);
}

TEST_CASE("A set whose channels do not sum to white, or are too many, is refused") {
    ResinSet set = vero_opaque();
    set.channels = four_channels();
    for (Resin& resin : set.resins) resin.sigma_t_per_mm.push_back(1), resin.albedo.push_back(0.5);
    CHECK_NOTHROW(set.validate());
    set.channels.xyz[1][2] += 1e-3;
    CHECK_THROWS_WITH(set.validate(), Catch::Contains("weights to Z sum to") && Catch::Contains("must be white"));
    set.channels.xyz.assign(257, {0, 0, 0});
    CHECK_THROWS_WITH(set.validate(), Catch::Contains("257 channels") && Catch::Contains("at most 256"));
}

TEST_CASE("Wide channels are ROMM RGB: sRGB lies inside, and white is white") {
    const Channels& wide = wide_channels();
    CHECK_FALSE(fault_of(wide));
    const Eigen::Matrix3d to_wide = Eigen::Matrix3d(linear_srgb_weights(wide)).inverse();
    // What others publish of sRGB in ROMM RGB, three decimals.
    Eigen::Matrix3d published;
    published << 0.529, 0.330, 0.141, 0.098, 0.873, 0.028, 0.017, 0.118, 0.865;
    CHECK((to_wide - published).cwiseAbs().maxCoeff() < 1e-3);
    CHECK((to_wide * Eigen::Vector3d::Ones() - Eigen::Vector3d::Ones()).norm() < 1e-4);
    CHECK(channels_text(wide) == "3 channels of their own");
}

}  // namespace voxtone::optics
