// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/ended_fit.h"

#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "tests/calibration/patches/target_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

Target target_b() {
    TargetOptions options;
    options.roles = {"C", "M", "Y", "K", "W"};
    options.pitch_um = {42.333333, 84.666667, 27};
    return lay_out_target(options);
}

/// As squares without end would be read.
PatchTable endless(const Target& target, UnderBase under, const optics::ResinSet& resins = optics::vero_opaque()) {
    PatchTable table;
    for (const TargetSquare& square : target.squares)
        table.patches.push_back(
            {square.top, square.backing, target.depth_mm(square), target.under_mm(square), {}, {}, {}});
    PatchModelOptions model;
    model.under = under;
    testing::measure(table, resins, 0, 1, model);
    return table;
}

double more_of(const PatchTable& table, const SquareEnds& ends, const std::string& name, std::size_t channel) {
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        if (patch_name(table.patches[p]) == name) return ends.more[p][channel];
    FAIL("no patch " << name);
    return 0;
}

}  // namespace

TEST_CASE("the ends of a target's squares are what light paths make of them") {
    const Target target = target_b();
    const PatchTable table = endless(target, UnderBase::air);
    const SquareEnds ends = square_ends(table, target, optics::vero_opaque(), UnderBase::air);
    // benchmarks/calibration/target/finite-squares, 200,000 paths, which shares no code; standard errors 0.0001 to
    // 0.0016.
    const auto check = [&](const char* name, std::size_t channel, double by_paths, double margin) {
        INFO(name << " in "
                  << "RGB"[channel]);
        CHECK(more_of(table, ends, name, channel) == Approx(by_paths).margin(margin));
    };
    check("Y on W", 0, -0.0185, 0.004);
    check("Y on W", 1, -0.0129, 0.004);
    check("W on W", 0, -0.0143, 0.004);
    check("M:10+W:90 on W", 0, -0.0157, 0.004);
    check("K:10+W:90 on W", 0, 0.0059, 0.001);
    check("C:10+W:90 on W", 0, 0.0033, 0.001);
    check("C:10+W:90 on W", 1, 0.0050, 0.001);
    check("C on W", 1, 0.0015, 0.0005);
    check("W on W", 2, 0.0007, 0.002);
    // Upon black nothing comes from beside.
    CHECK(std::abs(more_of(table, ends, "C:10+W:90 on K", 0)) < 0.0005);
}

TEST_CASE("a fit that knows the target takes the ends of its squares off") {
    const Target target = target_b();
    const optics::ResinSet truth = optics::vero_opaque();
    PatchTable table = endless(target, UnderBase::air);
    const SquareEnds ends = square_ends(table, target, truth, UnderBase::air);
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) table.patches[p].rho[c] += ends.more[p][c];
    FitOptions options;
    options.model.under = UnderBase::air;
    const auto white_off = [&](const ResinFit& fit) {
        return std::abs(fit.set.resins[std::size_t(fit.set.find("W"))].albedo[0] - truth.resins[4].albedo[0]);
    };
    const EndedFit ended = fit_ended_squares(table, target, options);
    CHECK(white_off(ended.fit) < 0.00003);
    CHECK(white_off(fit_resins(table, options)) > 0.0001);
    REQUIRE(ended.most);
    CHECK(*ended.most < -0.01);
    CHECK_THAT(ends_sentence(ended), Contains("taken from the patches") && Contains(" in R"));

    for (Patch& patch : table.patches) patch.top = {{"Q", 1.0}}, patch.thickness_mm += 1;
    CHECK_THROWS_AS(fit_ended_squares(table, target, options), InputError);
}

namespace {

// A target of K, W and clear resin in red and blue, its deep squares by 100,000 light paths of a program that shares no
// code (benchmarks/calibration/target/square_tracer); their standard errors are 0.0014 to 0.0020.
struct ClearTarget {
    Target target;
    optics::ResinSet truth = optics::vero_opaque().subset(std::vector<std::string>{"K", "W"});
    PatchTable table;
    static constexpr double clear[] = {0.004, 0.02};
    ClearTarget() {
        TargetOptions options;
        options.layout = TargetLayout::a;
        options.roles = {"K", "W", "T"};
        options.pitch_um = {42.333333, 84.666667, 27};
        target = lay_out_target(options);
        truth.channels.wavelengths_nm = {450, 650};  // of blue and red
        for (optics::Resin& resin : truth.resins) {
            resin.sigma_t_per_mm = {resin.sigma_t_per_mm[2], resin.sigma_t_per_mm[0]};
            resin.albedo = {resin.albedo[2], resin.albedo[0]};
        }
        truth.resins.push_back({"clear", "T", {clear[1], clear[0]}, {0, 0}});
        table = endless(target, UnderBase::air, truth);
        for (Patch& patch : table.patches) {
            if (patch.thickness_mm > 4)
                patch.rho = patch.thickness_mm < 6 ? std::vector{0.4506, 0.6619} : std::vector{0.3204, 0.5542};
        }
    }
};

}  // namespace

TEST_CASE("the absorption of clear resin is found from deep squares, whose light paths are another program's",
          "[slow]") {
    const ClearTarget read;
    FitOptions options;
    options.model.under = UnderBase::air;
    const auto off = [&](const ResinFit& fit) {
        const std::vector<double>& found = fit.set.resins[std::size_t(fit.set.find("T"))].sigma_t_per_mm;
        return std::array{found[0] / read.clear[1] - 1, found[1] / read.clear[0] - 1};
    };
    const auto plain = off(fit_resins(read.table, options));
    CHECK(std::abs(plain[0]) < 0.05);  // in blue walls hardly count
    CHECK(plain[1] > 0.08);
    // Thin squares, which have no ends here, are left as they are.
    PatchTable table = read.table;
    const LightOfSquares deep = light_of_deep_squares(read.target, read.truth, 6000);
    const SquareEnds ends = square_ends(table, read.target, read.truth, UnderBase::air, deep);
    for (std::size_t p = 0; p < table.patches.size(); ++p)
        for (std::size_t c = 0; c < 2 && table.patches[p].thickness_mm > 4; ++c)
            table.patches[p].rho[c] -= ends.more[p][c];
    const auto known = off(fit_resins(table, options));
    CHECK(std::abs(known[0]) < 0.08);
    CHECK(std::abs(known[1]) < 0.08);
}

TEST_CASE("deep squares of a target have their ends taken off with the others", "[slow]") {
    const ClearTarget read;
    FitOptions options;
    options.model.under = UnderBase::air;
    const EndedFit ended = fit_ended_squares(read.table, read.target, options, nullptr, 300);
    const auto thickness = [](const Patch& patch) { return patch.thickness_mm; };
    const auto deep = std::ranges::max_element(read.table.patches, {}, thickness) - read.table.patches.begin();
    CHECK(ended.table.patches[std::size_t(deep)].rho[1] > read.table.patches[std::size_t(deep)].rho[1]);
    CHECK(ended.fit.set.find("T") >= 0);
}
