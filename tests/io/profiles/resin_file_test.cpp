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
