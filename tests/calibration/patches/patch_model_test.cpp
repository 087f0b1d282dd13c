// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_model.h"

#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "target_samples.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using optics::Medium;

namespace {

std::vector<Medium> media(const optics::ResinSet& set, std::size_t channel) {
    std::vector<Medium> result;
    for (const auto& resin : set.resins) result.push_back(resin.medium(channel));
    return result;
}

const std::vector<std::string> roles{"C", "M", "Y", "K", "W"};

}  // namespace

TEST_CASE("The patches of target B reflect as in the reference") {
    std::ifstream file(test::test_data() + "/reference/directional.json");
    const auto values = nlohmann::json::parse(file).at("values");
    const PatchTable table = target('B', {"C", "M", "Y"});
    const PatchModel model(table.patches, roles, {});
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto rho = model.rho(media(optics::vero_opaque(), c));
        for (std::size_t p = 0; p < rho.size(); ++p) {
            std::string name;
            for (const ResinShare& share : table.patches[p].top) {
                name += share.role;
                if (share.fraction < 1) name += std::to_string(static_cast<int>(std::lround(100 * share.fraction)));
            }
            const std::string& backing = table.patches[p].backing;
            const std::string key = name == backing ? "inf:" + name : name + "/" + backing;
            INFO(key);
            REQUIRE(values.contains(key));
            worst = std::max(worst, std::abs(rho[p] - values.at(key).at("rho_ref")[c].get<double>()));
        }
    }
    INFO(worst);
    CHECK(worst < 1e-6);
}

TEST_CASE("A white base of 5 mm upon black is darker than one without end, as in the reference") {
    PatchTable table;
    table.patches = {{{{"W", 1}}, "W", 0.675, 5 - 0.675, {}, {}, {}}, {{{"W", 1}}, "W", 0.675, 0, {}, {}, {}}};
    const PatchModel model(table.patches, {"W"}, {});
    const auto rho = model.rho(std::vector{optics::vero_opaque().resins[4].medium(0)});
    CHECK(rho[0] == Approx(0.77663967).margin(1e-6));
    CHECK(rho[1] == Approx(0.80632).margin(1e-5));
    PatchModelOptions air;
    air.under = UnderBase::air;
    const auto held = PatchModel(table.patches, {"W"}, air).rho(std::vector{optics::vero_opaque().resins[4].medium(0)});
    CHECK(held[0] > rho[0] + 1e-3);  // total reflection at the lower surface
    CHECK(held[1] == rho[1]);
}

TEST_CASE("The derivatives of all patches by all resins are those of their reflectance, ideal and halftoned") {
    for (const bool halftone : {false, true})
        for (const double base_mm : {0.0, 4.0}) {
            PatchModelOptions options;
            if (halftone) options.pitch_mm = {0.0423, 0.0847, 0.027};
            const PatchTable table = target('B', {"C", "M", "Y"}, "W", "K", base_mm);
            const PatchModel model(table.patches, roles, options);
            std::vector<Medium> resins = media(optics::vero_opaque(), 2);
            std::vector<double> rho(table.patches.size());
            Eigen::MatrixXd by_resin;
            model.evaluate(resins, model.bases(resins, true), rho, by_resin);
            CHECK(rho == model.rho(resins));
            double worst = 0, largest = 0;
            for (std::size_t r = 0; r < resins.size(); ++r)
                for (int s = 0; s < 2; ++s) {
                    double& value = s == 0 ? resins[r].sigma_a : resins[r].sigma_s;
                    const double kept = value, h = 0.005 * kept;
                    value = kept + h;
                    const auto above = model.rho(resins);
                    value = kept - h;
                    const auto below = model.rho(resins);
                    value = kept;
                    for (std::size_t p = 0; p < rho.size(); ++p) {
                        const double expected = (above[p] - below[p]) / (2 * h);
                        const double found =
                            by_resin(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(2 * r) + s);
                        worst = std::max(worst, kept * std::abs(found - expected));
                        largest = std::max(largest, kept * std::abs(found));
                    }
                }
            INFO(worst << " of " << largest);
            CHECK(worst < 3e-6);
            CHECK(largest > 0.05);
        }
}

TEST_CASE("The derivative of patches by the voxels' chord is that of their reflectance by the dot spread") {
    PatchModelOptions options;
    options.pitch_mm = {0.0423, 0.0847, 0.027}, options.dot_spread = 0.3;
    const PatchTable table = target('B', {"C", "M", "Y"});
    const std::vector<Medium> resins = media(optics::vero_opaque(), 0);
    const PatchModel model(table.patches, roles, options);
    std::vector<double> rho(table.patches.size());
    Eigen::MatrixXd by;
    model.evaluate(resins, model.bases(resins, true), rho, by);
    const double h = 1e-3;
    const auto moved = [&](double step) {
        PatchModelOptions other = options;
        other.dot_spread += step;
        return PatchModel(table.patches, roles, other).rho(resins);
    };
    const std::vector<double> above = moved(h), below = moved(-h);
    double largest = 0;
    for (std::size_t p = 0; p < rho.size(); ++p) {
        const double slope = -by(static_cast<Eigen::Index>(p), by.cols() - 1) / (1 - options.dot_spread);
        CHECK(slope == Approx((above[p] - below[p]) / (2 * h)).margin(1e-6));
        largest = std::max(largest, std::abs(slope));
    }
    CHECK(largest > 0.01);
}

TEST_CASE("Where the pitch is known a mixture is the halftone's medium, a pure resin itself") {
    const optics::ResinSet set = optics::vero_opaque();
    PatchModelOptions options;
    options.pitch_mm = {0.0423, 0.0847, 0.027};
    PatchTable table;
    table.patches = {{{{"W", 0.5}, {"Y", 0.5}}, "W", 0.675, 0, {}, {}, {}}, {{{"Y", 1}}, "W", 0.675, 0, {}, {}, {}}};
    const auto rho = PatchModel(table.patches, roles, options).rho(media(set, 2));
    const Medium mixed = optics::EffectiveMedium(set, options.pitch_mm, optics::SeenFrom::above, random_dither)(
        std::vector{0.0, 0.0, 0.5, 0.0, 0.5}, 2);
    const auto plan = patch_plan(options);
    const optics::OrdinateBase white(*plan, set.resins[4].medium(2), false);
    CHECK(rho[0] == Approx(optics::OrdinateLayer(*plan, mixed, 0.675, false).upon(white).rho).margin(1e-12));
    const auto ideal = PatchModel(table.patches, roles, {}).rho(media(set, 2));
    CHECK(rho[0] > 1.02 * ideal[0]);  // light finds its way between the dots
    CHECK(rho[1] == ideal[1]);
}
