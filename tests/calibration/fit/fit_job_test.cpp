// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/fit_job.h"

#include <catch2/catch.hpp>

#include "base/error.h"

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
