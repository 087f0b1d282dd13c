// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/refit.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "calibration/compare/refit_job.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

optics::ResinSet two_inks() {
    optics::ResinSet set;
    set.name = "two";
    set.resins = {{"Cyan", "C", {9, 4, 3}, {0.2, 0.7, 0.9}}, {"White", "W", {10, 11, 12}, {0.99, 0.995, 0.99}}};
    return set;
}

/// A print of regions whose colours move with resins as they like; printed with values that are `off` those of the set,
/// in the order of PrintRegion::by_value, under a lamp at one side and with a cast.
RegionSheet sheet_of(const Eigen::VectorXd& off, std::uint64_t seed, const Eigen::Vector3d& gain = {1.2, 1.0, 0.9}) {
    RegionSheet sheet{"out/" + std::to_string(seed), false, two_inks(), {}};
    RandomStream random(seed, 0);
    for (int i = 0; i < 120; ++i) {
        PrintRegion region;
        region.place = {2 * random.uniform() - 1, 2 * random.uniform() - 1};
        region.by_value = Eigen::Matrix3Xd::Zero(3, 12);
        for (Eigen::Index k = 0; k < 3; ++k) {
            region.predicted[k] = 0.1 + 0.8 * random.uniform();
            for (Eigen::Index r = 0; r < 2; ++r)  // a channel moves its own colour
                for (Eigen::Index part = 0; part < 2; ++part)
                    region.by_value(k, 2 * (3 * r + k) + part) = -0.4 * region.predicted[k] * random.uniform();
        }
        region.printed = (region.predicted + region.by_value * off).cwiseProduct(gain) * (1 + 0.1 * region.place.x());
        sheet.regions.push_back(region);
    }
    return sheet;
}

/// Cyan's extinction by `cyan` in all channels, white's absorption by `white`.
Eigen::VectorXd off_by(double cyan, double white) {
    Eigen::VectorXd off = Eigen::VectorXd::Zero(12);
    for (Eigen::Index c = 0; c < 3; ++c) off[2 * c] = cyan, off[2 * (3 + c) + 1] = white;
    return off;
}

}  // namespace

TEST_CASE("resins that prints were not predicted by are found, whatever the exposure, the cast and the lamp") {
    const std::vector<RegionSheet> sheets{sheet_of(off_by(0.1, -0.08), 1),
                                          sheet_of(off_by(0.1, -0.08), 2, {0.7, 1, 1.1}),
                                          sheet_of(off_by(0.1, -0.08), 3)};
    const Refit refit = refit_resins(sheets, two_inks());
    CHECK(refit.resins[0].extinction == Approx(0.1).margin(0.01));
    CHECK(refit.resins[0].absorption == Approx(0).margin(0.01));
    CHECK(refit.resins[1].absorption == Approx(-0.08).margin(0.01));
    CHECK(refit.set.resins[0].sigma_t_per_mm[1] == Approx(4 * std::exp(0.1)).epsilon(0.01));
    const double albedo = refit.set.resins[1].albedo[0];
    CHECK((1 - albedo) / albedo == Approx(0.01 / 0.99 * std::exp(-0.08)).epsilon(0.02));
    CHECK(refit.after < 0.2 * refit.before);
    REQUIRE(refit.left_out);
    CHECK(*refit.left_out < 0.3 * refit.before);
}

TEST_CASE("a print that says nothing leaves the set as it was, with the error that it had") {
    RegionSheet sheet = sheet_of(off_by(0.1, 0), 1);
    for (PrintRegion& region : sheet.regions) region.by_value.leftCols(6).setZero();
    const Refit refit = refit_resins({&sheet, 1}, two_inks());
    CHECK(refit.resins[0].extinction == Approx(0).margin(1e-9));
    CHECK(refit.resins[0].extinction_error == Approx(std::sqrt(0.12 * 0.12 + 0.06 * 0.06 / 3)).epsilon(1e-6));
    CHECK(refit.resins[1].extinction_error < 0.05);
    CHECK_FALSE(refit.left_out);
}

TEST_CASE("places where a photograph is wrong do not count") {
    RegionSheet sheet = sheet_of(off_by(0.1, 0), 1);
    for (std::size_t i = 0; i < 12; ++i) sheet.regions[i].printed *= 0.6;  // in the shade
    const Refit refit = refit_resins({&sheet, 1}, two_inks());
    CHECK(refit.resins[0].extinction == Approx(0.1).margin(0.015));
}

TEST_CASE("prints that were predicted by a newer set say the same of the first one") {
    optics::ResinSet newer = two_inks();
    for (double& sigma_t : newer.resins[0].sigma_t_per_mm) sigma_t *= std::exp(0.1);
    std::vector<RegionSheet> sheets{sheet_of(off_by(0, 0), 1), sheet_of(off_by(0, 0), 2)};
    for (RegionSheet& sheet : sheets) sheet.set = newer;
    const Refit refit = refit_resins(sheets, two_inks());
    CHECK(refit.resins[0].extinction == Approx(0.1).margin(0.01));
    CHECK(refit.after < 0.2);
}

TEST_CASE("regions are read as they were written, and what is wrong with a file is told") {
    const io::TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path();
    const RegionSheet sheet = sheet_of(off_by(0.1, 0), 1);
    const std::string text = region_sheet_text(sheet);
    io::write_whole_file(folder / "regions.json", text);
    REQUIRE(is_region_sheet(folder / "regions.json"));
    const RegionSheet read = read_region_sheet(folder / "regions.json");
    REQUIRE(read.regions.size() == sheet.regions.size());
    CHECK(read.set.resins[0].sigma_t_per_mm == sheet.set.resins[0].sigma_t_per_mm);
    CHECK((read.regions[7].by_value - sheet.regions[7].by_value).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((read.regions[7].printed - sheet.regions[7].printed).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((read.regions[7].place - sheet.regions[7].place).cwiseAbs().maxCoeff() < 1e-6);
    io::write_whole_file(folder / "cut.json", text.substr(0, text.size() / 2));
    CHECK_THROWS_AS(read_region_sheet(folder / "cut.json"), InputError);
    std::string fewer = text;
    fewer.replace(fewer.find("\"by_value\": [["), 15, "\"by_value\": [[0, ");
    io::write_whole_file(folder / "more.json", fewer);
    CHECK_THROWS_WITH(read_region_sheet(folder / "more.json"), Contains("by_value") && Contains("12 numbers"));
    io::write_whole_file(folder / "patches.csv", "top,backing,thickness_mm,R,G,B\n");
    CHECK_FALSE(is_region_sheet(folder / "patches.csv"));
    CHECK_FALSE(is_region_sheet(folder / "nothing"));
}

TEST_CASE("prints of other resins are not fitted") {
    const RegionSheet sheet = sheet_of(off_by(0.1, 0), 1);
    optics::ResinSet other = two_inks();
    other.resins[0].role = "M";
    CHECK_THROWS_WITH(refit_resins({&sheet, 1}, other), Contains("out/1") && Contains("--prior"));
    RegionSheet empty = sheet;
    empty.regions.clear();
    CHECK_THROWS_WITH(refit_resins({&empty, 1}, two_inks()), Contains("no regions"));
}

TEST_CASE("a set is written with what moved beside it, and doubts are told") {
    const io::TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path();
    io::write_whole_file(folder / "far.json", region_sheet_text(sheet_of(off_by(0.9, 0), 1)));
    io::write_whole_file(folder / "near.json", region_sheet_text(sheet_of(off_by(0.1, 0), 2)));
    const auto refit = [&](const char* sheet, std::string& warnings) {
        RefitJob job;
        job.sheets = {(folder / sheet).string()};
        job.out = (folder / "better.json").string();
        job.overwrite = true;
        test::SaidProgress said;
        const JobResult result = run_refit_job(job, said);
        warnings = said.warnings();
        return result;
    };
    std::string warnings;
    const JobResult near = refit("near.json", warnings);
    CHECK(warnings == "");
    CHECK_THAT(near.text, Contains("Cyan (C): extinction +1") && Contains("better.fit.json"));
    CHECK(io::read_resin_set(folder / "better.json").name == "better");
    (void)refit("far.json", warnings);
    CHECK_THAT(warnings, Contains("Cyan") && Contains("--coding") && Contains("[refit-doubt]"));
}
