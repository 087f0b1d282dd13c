// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/photo_job.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/rehearsal/photo_simulation_job.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

TEST_CASE("a measurement of photographs is refused by the name of what is wrong, before a file is read") {
    Progress quiet;
    PhotoJob job;
    job.target = "nowhere.json";
    CHECK_THROWS_WITH(run_photo_job(job, quiet), Contains("no photograph"));
    job.photos = {"a.png"};
    job.measure.inner = 0.95;
    CHECK_THROWS_WITH(run_photo_job(job, quiet), Contains("--inner") && Contains("0.95"));
    job.measure.inner = 0.6;
    job.measure.corners.emplace();
    CHECK_THROWS_AS(run_photo_job(job, quiet), FileError);  // all is well but the file
    job.photos = {"a.png", "b.png"};
    CHECK_THROWS_WITH(run_photo_job(job, quiet), Contains("one by one"));
}

TEST_CASE("a simulation of a photograph is refused by the name of the option that is wrong") {
    Progress quiet;
    PhotoSimulationJob job;
    job.target = "nowhere.json";
    job.photo.width_px = 10;
    CHECK_THROWS_AS(run_photo_simulation(job, quiet), InputError);
    job.photo.width_px = 1500;
    CHECK_THROWS_AS(run_photo_simulation(job, quiet), FileError);
}
