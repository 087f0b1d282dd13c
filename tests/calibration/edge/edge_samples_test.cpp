// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs and sheet: exact in mm.
#include "calibration/edge/edge_samples_job.h"

#include <regex>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

EdgeSamplesJob job() {
    EdgeSamplesJob job;
    job.roles = {"C", "W"};
    job.allowance_mm = 0.05;
    job.out = "slabs";
    return job;
}

}  // namespace

TEST_CASE("a slab of every resin at every thickness, apart from each other", "[edge]") {
    const EdgeSlabs slabs = edge_slabs(job());
    REQUIRE(slabs.boxes.size() == 4);
    for (const TargetBox& box : slabs.boxes) {
        const Eigen::Vector3d size = box.max_mm - box.min_mm;
        CHECK(size.x() == Approx(40));
        CHECK(size.y() == Approx(40));
        CHECK(box.min_mm.z() == 0);
        for (const TargetBox& other : slabs.boxes) {
            if (&other == &box) continue;
            const bool apart = box.max_mm.x() < other.min_mm.x() || other.max_mm.x() < box.min_mm.x() ||
                               box.max_mm.y() < other.min_mm.y() || other.max_mm.y() < box.min_mm.y();
            CHECK(apart);
        }
    }
    CHECK(slabs.boxes[1].max_mm.z() == Approx(0.55));
    CHECK(slabs.boxes[3].max_mm.z() == Approx(1.05));
    CHECK(slabs.boxes[3].fractions == std::vector<double>{0, 1});
    CHECK(slabs.size_mm.isApprox(Eigen::Vector3d(84, 84, 1.05)));
}

TEST_CASE("the sheet is drawn in mm, its squares alternate", "[edge]") {
    const std::string svg = edge_sheet_svg();
    CHECK_THAT(svg, Contains("width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\""));
    int squares = 0;
    const std::regex square("<rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"20\" height=\"20\"/>");
    for (std::sregex_iterator it(svg.begin(), svg.end(), square), end; it != end; ++it, ++squares) {
        const int column = (std::stoi((*it)[1]) - 35) / 20, row = (std::stoi((*it)[2]) - 30) / 20;
        CHECK((column + row) % 2 == 0);
    }
    CHECK(squares == 39);  // of 7 x 11
    CHECK_THAT(svg, Contains("width=\"100\" height=\"0.4\""));
}

TEST_CASE("slabs that cannot be are refused by option", "[edge]") {
    const auto refused = [](EdgeSamplesJob wrong, const char* why) {
        CHECK_THROWS_WITH(wrong.validate(), Contains(why));
    };
    EdgeSamplesJob wrong = job();
    wrong.roles.clear();
    refused(wrong, "--resins");
    wrong = job();
    wrong.thickness_mm = {0};
    refused(wrong, "--thickness");
    wrong = job();
    wrong.edge_mm = 5;
    refused(wrong, "--size");
    wrong = job();
    wrong.allowance_mm = -1;
    refused(wrong, "--allowance");
}
