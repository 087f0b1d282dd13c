// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/fit_job.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "io/files/whole_file.h"
#include "tests/calibration/patches/target_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

TEST_CASE("a fit is refused by the name of the option that is wrong, before a file is read") {
    Progress quiet;
    FitJob job;
    CHECK_THROWS_WITH(run_fit_job(job, quiet), Contains("measured patches"));
    job.patches = "nowhere.csv";
    CHECK_THROWS_WITH(run_fit_job(job, quiet), Contains("--out"));
    job.out = "my.json";
    job.fit.model.g = 1.5;
    CHECK_THROWS_WITH(run_fit_job(job, quiet), Contains("g is 1.5"));
    job.fit.model.g = 0.4;
    job.fit.noise = 0;
    CHECK_THROWS_AS(run_fit_job(job, quiet), InputError);
    job.fit.noise = 0.005;
    CHECK_THROWS_AS(run_fit_job(job, quiet), FileError);  // all is well but the file
}

TEST_CASE("a fit whose check cannot be done leaves no file") {
    const io::TemporaryFolder folder;
    const auto written = [&](const std::string& name, const std::vector<std::string>& roles) {
        PatchTable table = testing::target('A', roles);
        testing::measure(table, optics::vero_opaque(), 0, 1);
        const std::string file = folder.path() / name;
        const std::string text = patch_table_text(table, "made up");
        io::write_whole_file(file, text);
        return file;
    };
    Progress quiet;
    FitJob job;
    job.patches = written("few.csv", {"C"});
    job.check = written("more.csv", {"C", "M"});
    job.out = folder.path() / "set.json";
    job.report = folder.path() / "set.html";
    CHECK_THROWS_WITH(run_fit_job(job, quiet), Contains("M"));
    for (const std::filesystem::path& file : job.outputs()) CHECK_FALSE(std::filesystem::exists(file));
    job.check = job.patches;
    (void)run_fit_job(job, quiet);
    for (const std::filesystem::path& file : job.outputs()) CHECK(std::filesystem::exists(file));
}

TEST_CASE("a fit of laminates has a page, too") {
    const io::TemporaryFolder folder;
    // Yellow upon white, upon a white base: the thicker the deeper.
    std::string text = "# illuminant: D50\nlayers,L,a,b\n\"W 2\",93,-1,3\n\"Y 2\",80,2,88\n";
    for (int k = 1; k <= 10; ++k)
        text += fmt::format("\"Y {}, W 2\",{},{},{}\n", 0.02 * k, 92 - 0.6 * k, -1 - 0.4 * k, 3 + 6 * k);
    FitJob job;
    job.patches = folder.path() / "laminates.csv";
    io::write_whole_file(job.patches, text);
    job.out = folder.path() / "set.json";
    job.report = folder.path() / "set.html";
    job.chart.channels = 3;
    Progress quiet;
    const JobResult result = run_fit_job(job, quiet);
    CHECK_THAT(result.text, Contains("laminates left out of the fit"));
    const auto bytes = io::read_whole_file(job.report, 1 << 24);
    const std::string page(bytes.begin(), bytes.end());
    CHECK_THAT(page, Contains("Laminates that took no part") && Contains("laminates left out of the fit") &&
                         Contains("Y 0.2, W 2") && Contains("Resins by channel"));
}
