// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/resin_file.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/optics/colour/split_channels.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

/// vero_opaque in four channels whose weights need all the digits that there are.
optics::ResinSet own_set() {
    optics::ResinSet set = optics::testing::split_set(optics::vero_opaque(), optics::testing::green_twice);
    set.channels = optics::testing::overlapping_channels();
    set.channels.xyz[0][0] += 1e-5 / 3;  // within what a white may be off
    set.resins[0].albedo[3] = 1.0 / 3;
    set.resins[1].eta = 1.48, set.resins[2].g = 1.0 / 3;
    set.relate();
    return set;
}

void check_same(const optics::ResinSet& a, const optics::ResinSet& b) {
    CHECK(a.name == b.name);
    CHECK(a.source == b.source);
    CHECK(a.channels == b.channels);
    CHECK(a.g == b.g);
    CHECK(a.eta == b.eta);
    REQUIRE(a.resins.size() == b.resins.size());
    for (std::size_t r = 0; r < a.resins.size(); ++r) {
        CHECK(a.resins[r].role == b.resins[r].role);
        CHECK(a.resins[r].sigma_t_per_mm == b.resins[r].sigma_t_per_mm);
        CHECK(a.resins[r].albedo == b.resins[r].albedo);
        CHECK(a.resins[r].eta == b.resins[r].eta);
        CHECK(a.resins[r].g == b.resins[r].g);
        CHECK(a.resins[r].similarity == b.resins[r].similarity);
    }
}

// The message of the error that a set's file where one part is another must cause.
std::string fault(const std::string& from, const std::string& to) {
    std::string text = resin_set_text(own_set());
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    try {
        (void)parse_resin_set(text, "FILE");
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("accepted: " << text);
    return {};
}

}  // namespace

TEST_CASE("Resin sets of all kinds of channels written and read again are the same to the last bit") {
    optics::ResinSet spectral = optics::vero_opaque();
    spectral.channels.wavelengths_nm = {450, 550 + 1.0 / 3, 650};
    optics::ResinSet measured = optics::vero_opaque();
    for (const auto illuminant : {optics::Illuminant::d50, optics::Illuminant::d65, optics::Illuminant::a}) {
        measured.channels = optics::colorimetric_channels(illuminant);
        check_same(parse_resin_set(resin_set_text(measured), "text"), measured);
    }
    for (const optics::ResinSet& set : {optics::vero_opaque(), spectral, own_set()}) {
        const std::string text = resin_set_text(set);
        check_same(parse_resin_set(text, "text"), set);
        CHECK(resin_set_text(parse_resin_set(text, "text")) == text);
    }
}

TEST_CASE("A set that was fitted has six digits, so that the last bits of a processor do not show") {
    optics::ResinSet set = own_set();
    set.dot_spread = 0.1234567891234;
    set.measured = {optics::MeasuringGeometry::diffuse_8, 0.0123456789012, 0.987654321987};
    Eigen::MatrixXd centres(2, 5);
    centres << 1.0 / 3, 1.0 / 3, 1.0 / 3, 0, 0, 0, 0, 0, 2.0 / 7, 5.0 / 7;
    Eigen::MatrixX3d weights(2, 3);
    weights << 1.0 / 3, -2.0 / 3e-3, 1.0 / 7e5, 0.1, 0, -1.0 / 9;
    set.residual = {std::vector<double>(5, 1.2 / 7), centres, weights};
    optics::ResinSet other = set;  // as another processor has it
    for (optics::Resin& resin : other.resins)
        for (double& value : resin.sigma_t_per_mm) value *= 1 + 1e-10;
    other.channels.xyz[0][0] *= 1 - 1e-10;
    other.residual = {std::vector<double>(5, 1.2 / 7), centres, weights * (1 + 1e-10)};
    CHECK(resin_set_text(set) != resin_set_text(other));
    const std::string text = resin_set_text(rounded_set(set));
    CHECK(text == resin_set_text(rounded_set(other)));
    CHECK(text == resin_set_text(rounded_set(parse_resin_set(text, "text"))));
    CHECK(rounded_set(set).resins[0].albedo[3] == 0.333333);
    CHECK(rounded_set(set).residual.weights()(0, 1) == -666.667);
    set.resins[1].albedo = {0.999999123456, 0.000123456789, 1, 0};
    CHECK(rounded_set(set).resins[1].albedo == std::vector<double>{0.999999123, 0.000123457, 1, 0});
    CHECK(rounded_set(optics::vero_opaque()).resins[0].albedo == optics::vero_opaque().resins[0].albedo);
}

TEST_CASE("A resin of its own g is to models of one what scatters as far, and a faulty one names resin and rule") {
    const optics::ResinSet set = parse_resin_set(resin_set_text(own_set()), "text");
    CHECK(set.has_own_eta());
    CHECK(set.has_own_g());
    CHECK(set.eta_of(set.resins[1]) == 1.48);
    CHECK(set.eta_of(set.resins[0]) == set.eta);
    const optics::Medium own = set.resins[2].own_medium(0), seen = set.resins[2].medium(0);
    CHECK(seen.sigma_a == own.sigma_a);
    CHECK(seen.sigma_s * (1 - set.g) == Approx(own.sigma_s * (1 - 1.0 / 3)));
    CHECK(set.resins[1].medium(0).sigma_s == set.resins[1].own_medium(0).sigma_s);
    CHECK(resin_set_text(set).find("\"eta\": 1.48") != std::string::npos);
    CHECK(resin_set_text(optics::vero_opaque()).find("\"eta\"") ==
          resin_set_text(optics::vero_opaque()).rfind("\"eta\""));
    CHECK_THAT(fault("1.48", "0.9"), Contains("FILE") && Contains("`resins[1].eta`") && Contains("1 to 10"));
    CHECK_THAT(fault("\"g\": 0.333", "\"g\": 1.333"), Contains("`resins[2].g`") && Contains("-1 to 1"));
    CHECK_THAT(fault("\"g\": 0.3333333333333333", "\"g\": 1"), Contains("Y") && Contains("both excluded"));
}

TEST_CASE("Faulty channels name file, key and rule") {
    CHECK_THAT(fault("\"own\"", "\"mine\""), Contains("FILE") && Contains("`channels.kind`") && Contains("\"own\""));
    CHECK_THAT(fault("\"D50\"", "\"F11\""),
               Contains("`channels.illuminant`") && Contains("F11") && Contains("D50, D65, A"));
    CHECK_THAT(fault("\"D50\"", "\"D65\""), Contains("`channels.xyz`") && Contains("the white of D65 has"));
    CHECK_THAT(fault("\"xyz\"", "\"nm\""), Contains("nm"));
    CHECK_THAT(fault("[0.3, 0.5, 0.05]", "[0.3, 0.5]"), Contains("`channels.xyz[1]`") && Contains("has 2 numbers"));
    CHECK_THAT(fault("[0.3, 0.5, 0.05]", "[0.3, 0.5, 0.0502]"), Contains("weights to Z sum to"));
    CHECK_THAT(fault("[0.3, 0.5, 0.05], ", ""), Contains("sum to"));
    CHECK_THAT(fault("[0.3, 0.5, 0.05]", "[0.15, 0.25, 0.025], [0.15, 0.25, 0.025]"),
               Contains("sigma_t_per_mm") && Contains("4 entries, expected 5"));
    std::string rows;
    for (int c = 0; c < 29; ++c) rows += "[0.01, 0, 0], ";
    CHECK_THAT(fault("[0.3, 0.5, 0.05]", rows + "[0, 0.5, 0.05]"), Contains("33 rows") && Contains("1 to 32"));
    CHECK_THAT(fault("[0.3, 0.5, 0.05]", "[0.3, 2e6, 0.05]"), Contains("`channels.xyz"));
}
