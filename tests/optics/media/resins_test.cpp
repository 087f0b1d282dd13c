// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/resins.h"

#include <array>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::optics;
using Catch::Matchers::Contains;

TEST_CASE("A resin's extinction splits into absorption and scattering") {
    const ResinSet set = vero_opaque();
    const Medium cyan = set.resins[0].medium(1);  // 4.5/mm, albedo 0.7
    CHECK(cyan.sigma_s == Approx(3.15));
    CHECK(cyan.sigma_a == Approx(1.35));
    CHECK(cyan.sigma_t() == Approx(4.5));
    CHECK(cyan.albedo() == Approx(0.7));
    CHECK(Medium{}.albedo() == 1.0);
}

TEST_CASE("A mixture averages absorption and scattering, not albedo") {
    const ResinSet set = vero_opaque();
    const Medium mixture = set.mix(std::array{0.25, 0.0, 0.0, 0.0, 0.75}, 0);
    CHECK(mixture.sigma_s == Approx(0.25 * 9.0 * 0.05 + 0.75 * 6.0 * 0.9991));
    CHECK(mixture.sigma_a == Approx(0.25 * 9.0 * 0.95 + 0.75 * 6.0 * 0.0009));
}

TEST_CASE("Resins are found by role and chosen in the order asked for") {
    const ResinSet set = vero_opaque();
    CHECK(set.find("W") == 4);
    CHECK(set.find("w") == 4);
    CHECK(set.find("VeroWhite") == -1);
    const ResinSet chosen = set.subset(std::vector<std::string>{"W", "C"});
    REQUIRE(chosen.resins.size() == 2);
    CHECK(chosen.resins[0].name == "VeroWhite");
    CHECK(chosen.resins[1].name == "VeroCyan");
    CHECK_THROWS_WITH(set.subset(std::vector<std::string>{"W", "T"}), Contains("\"T\"") && Contains("C, M, Y, K, W"));
    CHECK_THROWS_AS(set.subset(std::vector<std::string>{"W", "W"}), InputError);
}

TEST_CASE("A set that breaks a rule is refused by name, value and rule") {
    CHECK_NOTHROW(vero_opaque().validate());
    const auto refused = [](const std::function<void(ResinSet&)>& spoil) {
        ResinSet set = vero_opaque();
        spoil(set);
        try {
            set.validate();
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    CHECK_THAT(refused([](ResinSet& set) { set.resins[1].albedo[2] = 1.2; }),
               Contains("Resin M") && Contains("channel B") && Contains("1.2") && Contains("between 0 and 1"));
    CHECK_THAT(refused([](ResinSet& set) { set.resins[3].sigma_t_per_mm[0] = -1; }),
               Contains("Resin K") && Contains("-1"));
    CHECK_THAT(refused([](ResinSet& set) { set.resins[0].albedo.pop_back(); }),
               Contains("Resin C") && Contains("2 values"));
    CHECK_THAT(refused([](ResinSet& set) { set.resins[2].role = set.resins[4].role; }),
               Contains("VeroYellow") && Contains("VeroWhite"));
    CHECK_THAT(refused([](ResinSet& set) { set.g = 1; }), Contains("g is 1"));
    CHECK_THAT(refused([](ResinSet& set) { set.eta = 0.9; }), Contains("eta is 0.9"));
    CHECK_THAT(refused([](ResinSet& set) { set.channels.wavelengths_nm = {500, 450}; }), Contains("450 nm"));
    CHECK_THAT(refused([](ResinSet& set) { set.resins.clear(); }), Contains("no resins"));
}
