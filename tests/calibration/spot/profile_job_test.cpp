// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/profile_job.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/rehearsal/profile_simulation_job.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

ProfileSide side(double albedo) {
    return {{{"lit.exr", 1}}, {{"dark.exr", 1}}, Eigen::Vector3d::Constant(albedo), 0.04};
}

}  // namespace

TEST_CASE("a measurement of a profile is refused by the name of what is wrong, before a file is read") {
    Progress quiet;
    ProfileJob job;
    CHECK_THROWS_WITH(run_profile_job(job, quiet), Contains("--reflection"));
    job.reflection = side(0.6);
    CHECK_THROWS_AS(run_profile_job(job, quiet), FileError);  // all is well but the files
    job.thickness_mm = 3;
    CHECK_THROWS_WITH(run_profile_job(job, quiet), Contains("--transmission and --thickness"));
    job.transmission = side(0.6);
    CHECK_THROWS_AS(run_profile_job(job, quiet), InputError);  // more light comes out than went in
    job.transmission.total.reset();
    CHECK_THROWS_WITH(run_profile_job(job, quiet), Contains("--transmittance"));
    job.transmission.total = Eigen::Vector3d::Constant(0.3);
    job.thickness_mm = 0;
    CHECK_THROWS_WITH(run_profile_job(job, quiet), Contains("--thickness"));
    job.thickness_mm = 3;
    job.reflection.mm_per_px = 0;
    CHECK_THROWS_WITH(run_profile_job(job, quiet), Contains("--mm-per-px"));
}

TEST_CASE("a simulation of a profile is refused by the name of the option that is wrong") {
    Progress quiet;
    ProfileSimulationJob job;
    job.resins = "vero-opaque";
    job.role = "W";
    CHECK_THROWS_WITH(run_profile_simulation(job, quiet), Contains("--thickness"));
    job.thickness_mm = 1;
    job.camera.size_px = 10;
    CHECK_THROWS_AS(run_profile_simulation(job, quiet), InputError);
}
