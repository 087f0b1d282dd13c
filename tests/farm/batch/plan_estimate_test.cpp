// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/plan_estimate.h"

#include <catch2/catch.hpp>

#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

PlannedEstimate job_of(const std::string& name, double ml_c, double ml_w, std::optional<double> price = {}) {
    PlannedEstimate job{name, name + ".obj", {}, {}, 0};
    JobEstimate& e = job.estimate;
    e.size_mm = {10, 20, 30};
    e.layers = 1111;
    e.body_ml = ml_c + ml_w;
    e.resins = {{"C", "Cyan", ml_c, ml_c * 1.2, {}}, {"W", "White", ml_w, ml_w * 1.1, {}}};
    e.price = price;
    e.currency = "EUR";
    e.cpu_s = 200;
    e.seconds = 110;
    e.threads = 2;
    e.memory_bytes = std::uint64_t(ml_w * 1e9);
    e.disk_bytes = 1'000'000;
    e.free_disk_bytes = 5'000'000'000;
    return job;
}

PlannedEstimate broken(const std::string& name) { return {name, name + ".obj", {}, name + ".obj: is no mesh", 3}; }

}  // namespace

TEST_CASE("A plan's estimate is a line a job and what they add up to") {
    const std::vector<PlannedEstimate> jobs{job_of("a", 1, 2, 4.5), job_of("b", 0.5, 3, 5.5), broken("c")};
    const std::string text = plan_estimate_text(jobs), json = plan_estimate_json(jobs);
    INFO(text);
    CHECK_THAT(text, Contains("  a  ") && Contains("10.0 x 20.0 x 30.0 mm") && Contains("1111 layers"));
    CHECK_THAT(text, Contains("  c  cannot be sliced: c.obj: is no mesh\n"));
    CHECK_THAT(text, Contains("all 2 jobs: 6.500 ml\n") && Contains("C   Cyan                 1.500 ml      1.800 g") &&
                         Contains("W   White                5.000 ml") && Contains("cost: 10.00 EUR\n") &&
                         Contains("3 min 40 s one after the other on 2 threads") && Contains("1 job cannot be sliced"));
    CHECK(io::schema_faults("plan-estimate", json) == std::vector<std::string>{});
    CHECK_THAT(json, Contains("\"totals\": {\"estimated\": 2, \"failed\": 1, \"ml\": 6.5, ") &&
                         Contains("\"cpu_seconds\": 400, \"seconds\": 220, \"most_memory_bytes\": 3000000000, "
                                  "\"disk_bytes\": 2000000"));
}

TEST_CASE("What is not known of a job is not left out of the sums without a word") {
    PlannedEstimate layered = job_of("layered", 1, 1);
    layered.estimate.resins.clear();
    PlannedEstimate dollars = job_of("dollars", 1, 1, 7);
    dollars.estimate.currency = "USD";
    const std::vector<PlannedEstimate> jobs{job_of("a", 1, 2, 4.5), layered, dollars};
    const std::string text = plan_estimate_text(jobs);
    INFO(text);
    CHECK_THAT(text, Contains("cost: 4.50 EUR and 7.00 USD, without 1 job whose resins have no price"));
    CHECK_THAT(text, Contains("of 1 job it is not known which resins the layers take"));
    CHECK(io::schema_faults("plan-estimate", plan_estimate_json(jobs)) == std::vector<std::string>{});
    CHECK(io::schema_faults("plan-estimate", plan_estimate_json({broken("a")})) == std::vector<std::string>{});
    CHECK_THAT(plan_estimate_text({broken("a")}), !Contains("all "));
}
