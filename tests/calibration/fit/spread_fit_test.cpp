// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/spread_fit.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/resins/checker_contrast.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

constexpr double column_mm = 25.4 / 600, row_mm = 25.4 / 300;

/// Yellow and white, seen in blue by benchmarks/calibration/target/square_tracer (300,000 paths, no header of the
/// program), their cells blurred by Gaussians of 0.06 mm along x and 0.04 mm along y.
PatchTable traced_checkers() {
    constexpr int cells[] = {1, 2, 4, 8, 16};
    constexpr double along_x[] = {0.03588, 0.03601, 0.04429, 0.07713, 0.12144},
                     along_y[] = {0.03752, 0.05321, 0.08592, 0.12141, 0.14488};
    PatchTable table;
    table.source = "traced";
    for (std::size_t k = 0; k < 5; ++k) {
        for (const bool is_x : {true, false}) {
            Patch patch{{{"W", 0.5}, {"Y", 0.5}}, is_x ? "W" : "K", 0.675, 4.995, {}, {}, {}};
            patch.rho = {0.5, 0.5, is_x ? along_x[k] : along_y[k]};
            patch.error = {0.001, 0.001, 0.001};
            patch.cell_mm =
                is_x ? std::array{cells[k] * column_mm, 8 * row_mm} : std::array{16 * column_mm, cells[k] * row_mm};
            table.patches.push_back(patch);
        }
    }
    return table;
}

}  // namespace

TEST_CASE("checkers of another tracer tell how far resin ran along x and along y", "[slow]") {
    const SpreadFit fit = fit_spread(traced_checkers(), optics::vero_opaque(), 0.005, {}, 2000);
    CAPTURE(fit.mm[0], fit.error[0], fit.mm[1], fit.error[1], fit.chi2);
    CHECK(fit.is_told());
    CHECK(std::abs(fit.mm[0] / 0.06 - 1) < 0.15);
    CHECK(std::abs(fit.mm[1] / 0.04 - 1) < 0.15);
    CHECK(fit.freedom == 8);  // blue alone tells yellow from white
    for (const double error : fit.error) CHECK((error > 0.0002 && error < 0.01));
}

TEST_CASE("dense yellow in blue tells more beside white than black does, which lets light far") {
    const optics::ResinSet set = optics::vero_opaque();
    const auto told = [&](const char* role, std::size_t channel) {
        const auto medium = [&](const char* r) { return set.resins[std::size_t(set.find(r))].medium(channel); };
        return checker_contrast(medium("W"), medium(role), set.g).per_mm;
    };
    CHECK(told("Y", 2) > 1.5 * told("C", 0));
    CHECK(told("C", 0) > 1.5 * told("K", 1));
    CHECK(told("W", 2) == Approx(0).margin(1e-9));
}

TEST_CASE("what is not known of resins is in the errors of spread", "[slow]") {
    const auto coordinates = static_cast<Eigen::Index>(2 * optics::vero_opaque().resins.size());
    const ResinCovariance errors(3, 0.1 * Eigen::MatrixXd::Identity(coordinates, coordinates));
    const SpreadFit known = fit_spread(traced_checkers(), optics::vero_opaque(), 0.005, {}, 3000),
                    fit = fit_spread(traced_checkers(), optics::vero_opaque(), 0.005, errors, 3000);
    for (const std::size_t axis : {0, 1}) {
        CAPTURE(axis, known.mm[axis], known.error[axis], fit.mm[axis], fit.error[axis]);
        CHECK(fit.error[axis] > known.error[axis]);
        CHECK(std::abs(fit.mm[axis] - (axis == 0 ? 0.06 : 0.04)) < 2 * fit.error[axis]);
    }
}

TEST_CASE("checkers that no square explains are refused by name") {
    PatchTable table = traced_checkers();
    table.patches[3].top = {{"W", 0.5}, {"Z", 0.5}};
    CHECK_THROWS_WITH(fit_spread(table, optics::vero_opaque(), 0.005, {}, 2),
                      Contains("Z") && Contains("0.677 x 0.169 mm"));
    optics::ResinSet alike = optics::vero_opaque();
    alike.resins[2] = alike.resins[4], alike.resins[2].role = "Y";
    CHECK_THROWS_WITH(fit_spread(traced_checkers(), alike, 0.005, {}, 2), Contains("too much alike"));
}

TEST_CASE("a table of squares keeps its checkers apart from what tells resins") {
    const PatchTable table = traced_checkers();
    const PatchTable back = parse_patches(patch_table_text(table), "again.csv");
    REQUIRE(back.patches.size() == 10);
    CHECK(back.patches[0].cell_mm[0] == Approx(column_mm).epsilon(1e-5));
    CHECK(back.patches[1].cell_mm[1] == Approx(row_mm).epsilon(1e-5));
    const std::string head = "top,backing,thickness_mm,R,G,B,cell_x_mm,cell_y_mm\n";
    const auto refused = [&](const std::string& row, const std::string& why) {
        CHECK_THROWS_WITH(parse_patches(head + row, "t.csv"), Contains(why));
    };
    refused("W:30+Y:70,W,0.675,0.5,0.5,0.5,0.1,0.1\n", "as much of one resin");
    refused("W:50+Y:50,W,0.675,0.5,0.5,0.5,0.1,0\n", "expected 0.001 to 10 mm");
    CHECK_THROWS_WITH(parse_patches("top,backing,thickness_mm,R,G,B,cell_x_mm\nW,W,1,0.5,0.5,0.5,0\n", "t.csv"),
                      Contains("belong together"));
}
