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
