// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins without a white and a black of their own, fitted by squares upon a card that is half white and half black. The
// truth is adding-doubling, which knows nothing of modes and admittances.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/fit/resin_fit.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_surfaces.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"
#include "tests/calibration/patches/target_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> colours{"C", "M", "Y"};
constexpr double white_albedo = 0.9, black_albedo = 0.04;

/// rho of a layer upon a base, a resin or a diffuser of this albedo.
class Doubling {
public:
    explicit Doubling(const optics::ResinSet& set)
        : set_(set),
          grid_(optics::angular_grid(set.eta, 8, 8, std::array{std::numbers::sqrt2 / 2, 1.0})),
          solver_(grid_, set.g, 32) {}
    [[nodiscard]] double seen(const Eigen::MatrixXd& R) const {
        return optics::reflectance_factors(grid_, R)(grid_.find(1), grid_.find(std::numbers::sqrt2 / 2));
    }
    [[nodiscard]] Eigen::MatrixXd diffuser(double albedo) const {
        return Eigen::MatrixXd::Constant(grid_.size(), grid_.size(), albedo);
    }
    [[nodiscard]] Eigen::MatrixXd resin(const std::string& role, std::size_t c) const {
        return solver_.half_space(medium(role, c));
    }
    [[nodiscard]] double square(const PatchMixture& top, double mm, std::size_t c, const Eigen::MatrixXd& base) const {
        optics::Medium mixed{};
        for (const ResinShare& share : top) {
            const optics::Medium part = medium(share.role, c);
            mixed.sigma_a += share.fraction * part.sigma_a, mixed.sigma_s += share.fraction * part.sigma_s;
        }
        return seen(solver_.over(solver_.layer(mixed, mm), base));
    }

private:
    [[nodiscard]] optics::Medium medium(const std::string& role, std::size_t c) const {
        return set_.resins[static_cast<std::size_t>(set_.find(role))].medium(c);
    }
    const optics::ResinSet& set_;
    optics::AngularGrid grid_;
    optics::AddingDoubling solver_;
};

const std::vector<double> thin{0.054, 0.135, 0.405};  // without a resin that dilutes them colours hide what is below

/// What the squares of a table reflect upon their albedos, with noise.
void measure_squares(PatchTable& table, const std::function<Eigen::MatrixXd(const Patch&, std::size_t)>& base,
                     const Doubling& by, double noise, std::uint64_t seed) {
    table.channels = optics::vero_opaque().channels;
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) {
            Patch& patch = table.patches[p];
            patch.rho.push_back(by.square(patch.top, patch.thickness_mm, c, base(patch, c)) +
                                noise * normal(seed, p * 1000 + c));
        }
}

std::shared_ptr<const PatchSurface> half_of_card(bool dark, const Doubling& by) {
    const double bare = by.seen(by.diffuser(dark ? black_albedo : white_albedo));
    return std::make_shared<PatchSurface>(
        PatchSurface{dark ? "black" : "white", {optics::BareFinish::smooth, false}, {bare, bare, bare}, {}});
}

void measure_on_card(PatchTable& table, const Doubling& by, double noise, std::uint64_t seed) {
    table.source = "card";
    measure_squares(
        table,
        [&](const Patch& patch, std::size_t) {
            return by.diffuser(patch.backing == "black" ? black_albedo : white_albedo);
        },
        by, noise, seed);
}

/// Pure squares of C, M and Y upon the two halves of a card.
PatchTable on_card(double noise, std::uint64_t seed, const std::vector<double>& thicknesses = thin) {
    const optics::ResinSet truth = optics::vero_opaque();
    const Doubling by(truth);
    PatchTable table;
    for (const bool dark : {false, true}) {
        const auto half = half_of_card(dark, by);
        for (const std::string& role : colours)
            for (const double mm : thicknesses) {
                table.patches.push_back({{{role, 1}}, half->name, mm, 0, {}, {}, {}});
                table.patches.back().on = half;
            }
    }
    measure_on_card(table, by, noise, seed);
    return table;
}

/// Target B, white and black resin among its colours, upon the card.
PatchTable target_on_card(double noise, std::uint64_t seed) {
    const optics::ResinSet truth = optics::vero_opaque();
    const Doubling by(truth);
    PatchTable table = target('B', colours);
    const std::array halves{half_of_card(false, by), half_of_card(true, by)};
    for (Patch& patch : table.patches) patch.on = halves[patch.backing == "K"], patch.backing = patch.on->name;
    measure_on_card(table, by, noise, seed);
    return table;
}

/// Target B upon white and black resin.
PatchTable on_resin(double noise, std::uint64_t seed) {
    const optics::ResinSet truth = optics::vero_opaque();
    const Doubling by(truth);
    PatchTable table = target('B', colours);
    measure_squares(
        table, [&](const Patch& patch, std::size_t c) { return by.resin(patch.backing, c); }, by, noise, seed);
    return table;
}

/// Mean CIEDE2000 of thin mixtures of two colours on a grey card, as the set has them: none of them was fitted.
double error_of_unseen(const optics::ResinSet& set) {
    const optics::ResinSet truth = optics::vero_opaque();
    const Doubling by(truth);
    constexpr double grey_albedo = 0.6;
    const double bare = by.seen(by.diffuser(grey_albedo));
    PatchTable table;
    table.channels = truth.channels;
    const auto grey = std::make_shared<PatchSurface>(
        PatchSurface{"grey", {optics::BareFinish::smooth, false}, {bare, bare, bare}, {}});
    for (const PatchMixture& top :
         {PatchMixture{{"C", 0.5}, {"M", 0.5}}, PatchMixture{{"C", 0.5}, {"Y", 0.5}},
          PatchMixture{{"M", 0.5}, {"Y", 0.5}}, PatchMixture{{"C", 1}}, PatchMixture{{"M", 1}}, PatchMixture{{"Y", 1}}})
        for (const double mm : {0.1, 0.3}) {
            Patch patch{top, "grey", mm, 0, {}, {}, {}};
            patch.on = grey;
            for (std::size_t c = 0; c < 3; ++c) patch.rho.push_back(by.square(top, mm, c, by.diffuser(grey_albedo)));
            table.patches.push_back(patch);
        }
    return check_resins(set, table, {}).differences.mean;
}

std::string fault(const PatchTable& table) {
    try {
        (void)fit_resins(table, {});
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Squares upon a card tell resins exactly, without white and black resin") {
    const ResinFit fit = fit_resins(on_card(0, 1), {});
    REQUIRE(fit.set.resins.size() == 3);
    INFO(error_of_unseen(fit.set));
    CHECK(error_of_unseen(fit.set) < 0.02);
    // What is taken for matt is not.
    PatchTable wrong = on_card(0, 1);
    change_surfaces(wrong, [](PatchSurface& surface) { surface.kind.finish = optics::BareFinish::matt; });
    CHECK(error_of_unseen(fit_resins(wrong, {}).set) > 1);
}

TEST_CASE("With noise a card tells resins as well as white and black resin do", "[slow]") {
    double pure = 0, card = 0, resin = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        pure += error_of_unseen(fit_resins(on_card(0.005, seed), {}).set) / 6;
        card += error_of_unseen(fit_resins(target_on_card(0.005, seed), {}).set) / 6;
        resin += error_of_unseen(fit_resins(on_resin(0.005, seed), {}).set) / 6;
    }
    INFO(card << " on a card, " << resin << " on resin, " << pure << " by thin pure squares on a card");
    CHECK(card < 1.1 * resin);
    CHECK(pure < 1.1 * resin);
    CHECK(resin > 0.1);
}

TEST_CASE("One surface tells resins by two thicknesses, and says so where there is one") {
    PatchTable table = on_card(0, 1);
    std::erase_if(table.patches, [](const Patch& patch) { return patch.backing == "black"; });
    const ResinFit fit = fit_resins(table, {});
    INFO(error_of_unseen(fit.set));
    CHECK(error_of_unseen(fit.set) < 0.1);
    std::erase_if(table.patches, [](const Patch& patch) { return patch.thickness_mm > 0.1; });
    CHECK_THAT(fault(table), Contains("all patches lie on white"));
}

TEST_CASE("Surfaces without contrast are refused") {
    PatchTable table = on_card(0, 1, {0.2});
    change_surfaces(table, [](PatchSurface& surface) { surface.rho.assign(3, 0.5); });
    CHECK_THAT(fault(table), Contains("no contrast"));
}
