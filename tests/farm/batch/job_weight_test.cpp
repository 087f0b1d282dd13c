// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_weight.h"

#include <catch2/catch.hpp>

using namespace voxtone::farm;
using namespace voxtone::slicer;

namespace {

constexpr std::uint64_t gib = std::uint64_t{1} << 30;

SliceOptions body_of(double size_mm) {
    SliceOptions options;
    options.model = "nowhere.obj";
    options.size_mm = size_mm;
    return options;
}

std::vector<std::string> words_of(const SliceOptions& options) {
    return {"slice", options.model, "--size", std::to_string(options.size_mm)};
}

JobWeight weight_of(const SliceOptions& options, const JobState* known = nullptr) {
    return weigh(options, words_of(options), known);
}

}  // namespace

TEST_CASE("the bound of a job grows with its surface, and goes where nothing is done there", "[batch]") {
    SliceOptions small = body_of(20);
    CHECK(weight_of(small).bound);
    // 24 cm2 of a box around it in cells of 0.085 mm.
    CHECK(weight_of(small).memory_bytes == Approx(double(gib) + 2e8 + 7800 * 2400 / (0.085 * 0.085)));
    // Four times the cells, of which tiles that wait hold less (prediction_time.h).
    CHECK(weight_of(body_of(40)).memory_bytes == Approx(double(gib) + 1.6e8 + 6400 * 9600 / (0.085 * 0.085)));
    small.iterations = "0";
    CHECK(weight_of(small).memory_bytes > 2 * gib);  // it is predicted
    small.predict = "none";
    CHECK(weight_of(small).memory_bytes == gib);
    small.threads = 3;
    CHECK(weight_of(small).threads == 3);
}

TEST_CASE("of a body of unknown size nothing is said", "[batch]") {
    CHECK(weight_of(body_of(0)).bound);
    CHECK(weight_of(body_of(0)).memory_bytes > (std::uint64_t{1} << 50));
    CHECK_FALSE(weight_of(body_of(0)).is_known());
    CHECK(weight_of(body_of(20)).is_known());
}

TEST_CASE("a job that was done before takes what it took", "[batch]") {
    const SliceOptions options = body_of(40);
    JobState done;
    done.command = words_of(options);
    done.figures.emplace().peak_memory_bytes = 2 * gib;
    CHECK_FALSE(weight_of(options, &done).bound);
    CHECK(weight_of(options, &done).memory_bytes == 5 * gib / 2);
    CHECK(weight_of(body_of(41), &done).bound);
}

TEST_CASE("what the estimate says takes the place of the bound", "[batch]") {
    const JobWeight bound = weight_of(body_of(0));
    const JobWeight weight =
        weigh_by_estimate(bound, R"({"format": "voxtone-estimate", "cpu_seconds": 2.5, "memory_bytes": 1234}})");
    CHECK(weight.memory_bytes == 1234);
    CHECK(weight.cpu_s == 2.5);
    CHECK_FALSE(weight.bound);
    // An estimate that failed is not asked for again.
    for (const char* broken :
         {"", "}", R"({"cpu_seconds": 1, "memory_bytes": -1}})", R"({"cpu_seconds": 1, "memory_bytes": 1})"}) {
        CHECK(weigh_by_estimate(bound, broken).memory_bytes == bound.memory_bytes);
        CHECK_FALSE(weigh_by_estimate(bound, broken).bound);
    }
    CHECK(estimate_words({"slice", "a b.obj", "-o", "out"}) ==
          std::vector<std::string>{"estimate", "a b.obj", "-o", "out", "--quick", "--json"});
}
