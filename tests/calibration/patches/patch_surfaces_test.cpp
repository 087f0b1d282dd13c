// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_surfaces.h"

#include <array>
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_model.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"
#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/scene/sheet.h"
#include "optics/scene/surface.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;
using optics::BareFinish;
using optics::Medium;

namespace {

const Medium cloudy{1.0, 2.0};
constexpr double thin_mm = 0.675;

std::shared_ptr<const PatchSurface> surface(BareFinish finish, double rho, bool gap = false) {
    return std::make_shared<PatchSurface>(PatchSurface{"card", {finish, gap}, {rho}, {}});
}

Patch square(std::shared_ptr<const PatchSurface> on, double mm = thin_mm) {
    Patch patch{{{"C", 1}}, "card", mm, 0, {}, {}, {}};
    patch.on = std::move(on);
    return patch;
}

double seen(const Patch& patch, const Medium& medium, const PatchModelOptions& options = {}) {
    return PatchModel(std::span(&patch, 1), {"C"}, options).rho(std::array{medium}, 0).front();
}

/// rho(45 -> 0) by adding-doubling of a layer upon a kernel.
double by_doubling(const optics::AngularGrid& grid, const Medium& medium, const Eigen::MatrixXd& below) {
    const optics::AddingDoubling solver(grid, PatchModelOptions{}.g, 2 * grid.size());
    return optics::reflectance_factors(grid, solver.over(solver.layer(medium, thin_mm), below))(
        grid.find(1), grid.find(std::numbers::sqrt2 / 2));
}

optics::AngularGrid fine_grid(double eta) {
    return optics::angular_grid(eta, 12, 12, std::array{std::numbers::sqrt2 / 2, 1.0});
}

std::string fault(const std::string& rows) {
    try {
        (void)parse_patches("top,backing,thickness_mm,R,G,B,base_mm\n" + rows, "p.csv");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Upon a diffuser that it wets a layer reflects as by adding-doubling") {
    const optics::AngularGrid grid = fine_grid(1.5);
    const auto diffuser = [&](double albedo) {
        return Eigen::MatrixXd::Constant(grid.size(), grid.size(), albedo).eval();
    };
    for (const double rho : {0.0, 0.04, 0.5, 0.92}) {
        INFO(rho);
        CHECK(seen(square(surface(BareFinish::matt, rho)), cloudy) ==
              Approx(by_doubling(grid, cloudy, diffuser(rho))).margin(2e-6));
        // What is bare under a face is a diffuser of a larger albedo.
        const double bare = optics::reflectance_factors(grid, diffuser(rho))(grid.find(1), grid.find(std::sqrt(0.5)));
        CHECK(seen(square(surface(BareFinish::smooth, bare)), cloudy) ==
              Approx(by_doubling(grid, cloudy, diffuser(rho))).margin(2e-6));
    }
}

TEST_CASE("A smooth surface under next to nothing is what it is bare, a matt one darker") {
    const Medium clear{1e-6, 1e-6};
    for (const double rho : {0.04, 0.4, 0.85}) {
        CHECK(seen(square(surface(BareFinish::smooth, rho), 0.001), clear) == Approx(rho).margin(1e-6));
        CHECK(seen(square(surface(BareFinish::matt, rho), 0.001), clear) < 0.9 * rho);
    }
    // Saunderson of what is brighter than any diffuser under such a face: noise.
    CHECK(seen(square(surface(BareFinish::smooth, 1.2)), cloudy) ==
          seen(square(surface(BareFinish::smooth, 1)), cloudy));
    CHECK(seen(square(surface(BareFinish::smooth, -0.01)), cloudy) ==
          seen(square(surface(BareFinish::matt, 0)), cloudy));
}

TEST_CASE("Upon a mirror a layer reflects as the half of one twice as thick, lit from both sides") {
    const optics::AngularGrid grid = optics::angular_grid_45_0(1.5, 12, 8, 6);
    const optics::AddingDoubling solver(grid, PatchModelOptions{}.g, 40);
    const optics::LayerResponse twice = solver.layer(cloudy, 2 * thin_mm);
    Eigen::MatrixXd R = twice.R_above + twice.D_down;
    R.diagonal().array() += twice.direct / grid.c;
    const double expected = optics::reflectance_factors(grid, R)(grid.find(1), grid.find(std::numbers::sqrt2 / 2));
    CHECK(seen(square(surface(BareFinish::mirror, 1)), cloudy) == Approx(expected).margin(1e-5));
    CHECK(seen(square(surface(BareFinish::mirror, 0)), cloudy) ==
          Approx(seen(square(surface(BareFinish::matt, 0)), cloudy)).margin(1e-12));
    // Air before a black mirror: the face alone throws back.
    CHECK(seen(square(surface(BareFinish::mirror, 0, true)), cloudy) ==
          Approx(seen(square(surface(BareFinish::matt, 0, true)), cloudy)).margin(1e-12));
}

TEST_CASE("Upon a sheet under air a layer reflects as light paths say", "[slow]") {
    optics::ResinSet set = optics::vero_opaque().subset(std::array{std::string("M")});
    const optics::ResinVolume volume = optics::make_resin_volume({1, 1, 1}, {thin_mm, thin_mm, thin_mm},
                                                                 [](int, int, int) { return optics::Material(1); });
    for (const double rho : {0.1, 0.8}) {
        optics::Scene scene{&volume, &set, optics::Backing::sheet, optics::Sides::mirrored};
        scene.sheet = std::make_shared<optics::Sheet>(
            optics::Sheet{3, {1, 1}, {}, {1, 1}, std::vector<float>(3, static_cast<float>(rho))});
        const optics::Surface top = optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::top);
        optics::MonteCarloSummary summary;
        const optics::Appearance paths = optics::MonteCarlo({.paths = 60000}).reflectance_45_0(scene, top, summary);
        PatchModelOptions options;
        options.g = set.g, options.eta = set.eta;
        for (std::size_t c = 0; c < 3; ++c) {
            INFO(rho << " " << c << ": " << paths.value[c] << " +- " << paths.standard_error[c]);
            const double expected =
                seen(square(surface(BareFinish::matt, rho, true)), set.resins[0].medium(c), options);
            CHECK(std::abs(double(paths.value[c]) - expected) < 4 * double(paths.standard_error[c]) + 1e-5);
            // In contact it would be another one, where light gets as far.
            if (c == 2) continue;
            CHECK(std::abs(seen(square(surface(BareFinish::matt, rho)), set.resins[0].medium(c), options) - expected) >
                  4 * double(paths.standard_error[c]));
        }
    }
}

TEST_CASE("The derivatives of squares upon surfaces are those of their reflectance") {
    for (const BareFinish finish : {BareFinish::matt, BareFinish::smooth, BareFinish::mirror})
        for (const bool gap : {false, true}) {
            Patch mixed = square(surface(finish, 0.7, gap));
            mixed.top = {{"C", 0.3}, {"M", 0.7}};
            const PatchModel model(std::span(&mixed, 1), {"C", "M"}, {});
            std::array<Medium, 2> resins{Medium{1, 2}, Medium{0.2, 6}};
            std::array<double, 1> rho{};
            Eigen::MatrixXd by;
            model.evaluate(resins, model.bases(resins, true, 0), rho, by);
            for (std::size_t r = 0; r < 2; ++r)
                for (int s = 0; s < 2; ++s) {
                    double& value = s == 0 ? resins[r].sigma_a : resins[r].sigma_s;
                    const double kept = value, h = 0.003 * kept;
                    value = kept + h;
                    const double above = model.rho(resins, 0).front();
                    value = kept - h;
                    const double below = model.rho(resins, 0).front();
                    value = kept;
                    const double found = by(0, static_cast<Eigen::Index>(2 * r) + s);
                    CHECK(kept * found == Approx(kept * (above - below) / (2 * h)).margin(2e-6));
                    CHECK(std::abs(kept * found) > 1e-3);
                }
        }
}

TEST_CASE("A table names its surfaces in rows of their own, and is written as it was read") {
    const std::string text =
        "top,backing,thickness_mm,R,G,B,R_se,G_se,B_se\n"
        "C,card,0.675,0.1,0.3,0.5,0.01,0.01,0.01\n"
        "bare:smooth,card,0,0.8,0.79,0.7,0.004,0.004,0.004\n"
        "C,foil,0.675,0.1,0.3,0.5,0.01,0.01,0.01\n"
        "bare:mirror+gap,foil,0,0.9,0.9,0.9,0.004,0.004,0.004\n"
        "C,K,0.675,0.05,0.1,0.1,0.01,0.01,0.01\n";
    const PatchTable table = parse_patches(text, "p.csv");
    REQUIRE(table.patches.size() == 3);
    REQUIRE(table.patches[0].on);
    CHECK(table.patches[0].on->kind == optics::KnownSurface{BareFinish::smooth, false});
    CHECK(table.patches[0].on->rho == std::vector{0.8, 0.79, 0.7});
    CHECK(table.patches[1].on->kind == optics::KnownSurface{BareFinish::mirror, true});
    CHECK_FALSE(table.patches[2].on);
    const std::string written = patch_table_text(table);
    CHECK_THAT(written, Contains("bare:mirror+gap,foil,0,0.9,0.9,0.9,0.004"));
    CHECK(patch_table_text(parse_patches(written, "q.csv")) == written);
    PatchTable white = table;
    apply_white_reference(white, 0.5);
    CHECK(white.patches[0].on->rho == std::vector{0.4, 0.395, 0.35});
    CHECK(table.patches[0].on->rho == std::vector{0.8, 0.79, 0.7});
    // As L, a, b as well.
    const PatchTable lab = parse_patches(
        "# illuminant: D50\ntop,backing,thickness_mm,L,a,b\nbare:matt,card,0,100,0,0\nC,card,0.5,50,0,0\n", "l.csv");
    CHECK(lab.patches.front().on->rho[1] == Approx(1));
}

TEST_CASE("What is wrong with a surface is one sentence") {
    CHECK_THAT(fault("bare:shiny,card,0,1,1,1,0\n"), Contains("p.csv: line 2") && Contains("matt, smooth or a mirror"));
    CHECK_THAT(fault("bare:matt,card,0.5,1,1,1,0\n"), Contains("0 for thickness_mm"));
    CHECK_THAT(fault("bare:matt,card,0,1,1,1,0\n"), Contains("bare surfaces alone"));
    CHECK_THAT(fault("bare:matt,card,0,1,1,1,0\nbare:matt,card,0,1,1,0.9,0\n"), Contains("measured already"));
    CHECK_THAT(fault("bare:matt,card,0,1,1,1,0\nbare:smooth,card,0,1,1,1,0\nC,card,1,1,1,1,0\n"),
               Contains("there twice, as matt and as smooth"));
    CHECK_THAT(fault("bare:matt,W,0,1,1,1,0\nW,W,1,1,1,1,0\n"), Contains("W is a resin here"));
    CHECK_THAT(fault("bare:matt,card,0,1,1,1,0\nC,card,1,1,1,1,5\n"), Contains("without a thickness"));
    CHECK_THAT(fault("bare:matt,light,0,1,1,1,0\nC,card,1,1,1,1,0\n"), Contains("bare surface has its name"));
}

TEST_CASE("A set of other channels takes a surface as they see it") {
    PatchTable table = parse_patches(
        "top,backing,thickness_mm,400,500,600,700\nbare:matt,card,0,0.2,0.4,0.8,0.8\nM,card,0.675,0.1,0.1,0.1,0.1\n",
        "s.csv");
    optics::ResinSet spectral = optics::vero_opaque();
    spectral.channels.wavelengths_nm = {390, 450, 600};  // as if
    CHECK(in_channels_of(spectral, table).patches[0].on->rho == std::vector{0.2, 0.30000000000000004, 0.8});
    const PatchTable rgb = in_channels_of(optics::vero_opaque(), table);
    CHECK(rgb.patches[0].on->rho[0] > rgb.patches[0].on->rho[2] + 0.3);
    const PatchTable camera = parse_patches(
        "top,backing,thickness_mm,R,G,B\nbare:matt,card,0,0.2,0.4,0.8\nM,card,0.675,0.1,0.1,0.1\n", "c.csv");
    CHECK_THROWS_WITH(check_resins(spectral, camera, {}), Contains("measure spectra of the bare surface"));
    CHECK(check_resins(optics::vero_opaque(), camera, {}).patches.size() == 1);
    CHECK_THROWS_WITH(PatchModel(camera.patches, {"M"}, {}).rho(std::array{cloudy}), Contains("channel"));
}
