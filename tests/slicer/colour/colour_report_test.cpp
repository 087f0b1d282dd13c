// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/colour_report.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("What models remark of the chosen print and of its prediction are warnings of the report") {
    std::optional<JobLoop> loop;
    std::optional<JobPrediction> prediction;
    io::Report report;
    report.warnings = {"of the file"};
    add_remarks(loop, prediction, report);
    CHECK(report.warnings == std::vector<std::string>{"of the file"});
    loop.emplace().result.remarks = {"the light was clipped"};
    prediction.emplace().predicted.remarks = {"a solve was left open", "of the white: the same"};
    add_remarks(loop, prediction, report);
    CHECK(report.warnings == std::vector<std::string>{"of the file", "the light was clipped", "a solve was left open",
                                                      "of the white: the same"});
}
