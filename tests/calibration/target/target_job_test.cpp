// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_job.h"

#include <filesystem>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "calibration/target/target_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

struct Warnings final : Progress {
    std::string all;
    void on_warning(const std::string& message) override { all += message + '\n'; }
};

TargetJob job_in(const std::filesystem::path& folder) {
    TargetJob job;
    job.layout.layout = TargetLayout::a;
    job.layout.roles = {"K", "W"};
    job.layout.printer = "imagined";
    job.layout.pitch_um = {42, 84, 27};
    job.display_rgb = {{0, 0, 0}, {255, 255, 255}};
    job.out = folder.string();
    return job;
}

}  // namespace

TEST_CASE("a target is printed by whoever is asked to, then described and drawn beside the layers") {
    const io::TemporaryFolder folder;
    Warnings warnings;
    std::size_t printed = 0;
    const auto print = [&](const std::vector<TargetBox>& boxes, const Eigen::Vector3d& size_mm, Progress&) {
        printed = boxes.size();
        CHECK((boxes.front().max_mm.array() <= size_mm.array() + 1e-9).all());
        io::StackDescription stack;
        stack.layers = 210;
        return stack;
    };
    const JobResult result = run_target_job(job_in(folder.path()), print, warnings);
    const Target target = read_target(folder.path() / "target.json");
    CHECK(printed == target_boxes(target).size());
    CHECK(target.printer == "imagined");
    CHECK(std::filesystem::exists(folder.path() / "target.png"));
    CHECK(nlohmann::json::parse(result.json).at("layers") == 210);
    CHECK_THAT(warnings.all, Contains("may not be opaque") && Contains("[thin-base]"));  // no resins are known
}

TEST_CASE("a target is refused by the name of what is wrong, before anything is printed") {
    Warnings warnings;
    const auto print = [](const std::vector<TargetBox>&, const Eigen::Vector3d&, Progress&) -> io::StackDescription {
        FAIL("printed");
        return {};
    };
    TargetJob job = job_in({});
    CHECK_THROWS_WITH(run_target_job(job, print, warnings), Contains("--out"));
    job.out = "out";
    job.layout.roles = {"K"};
    CHECK_THROWS_WITH(run_target_job(job, print, warnings), Contains("--resins"));
    job.layout.roles = {"K", "W"};
    job.resin_set = "vero-nothing";
    CHECK_THROWS_WITH(run_target_job(job, print, warnings), Contains("vero-nothing"));
}

TEST_CASE("a chart of thin mixtures holds those of the paper on both halves, none of them pure") {
    const io::TemporaryFolder folder;
    TargetJob job;
    job.layout.roles = {"C", "M", "Y", "K", "W"};
    job.layout.pitch_um = {42.333333, 84.666667, 27};
    job.display_rgb.assign(5, {128, 128, 128});
    job.out = folder.path();
    job.thin = 121;
    Progress quiet;
    const PrintBoxes print = [](const auto&, const Eigen::Vector3d&, Progress&) { return io::StackDescription{}; };
    (void)run_target_job(job, print, quiet);
    const Target target = read_target(folder.path() / "target.json");
    CHECK(target.layout == "mixtures");
    REQUIRE(target.squares.size() == 242);
    for (const TargetSquare& square : target.squares) {
        CHECK(square.top.size() > 1);
        for (const ResinShare& share : square.top)
            CHECK(5 * share.fraction == Approx(std::round(5 * share.fraction)).margin(1e-6));
    }
    job.thin = 30;
    (void)run_target_job(job, print, quiet);
    CHECK(read_target(folder.path() / "target.json").squares.size() == 60);
    job.thin = 1;
    CHECK_THROWS_WITH(run_target_job(job, print, quiet), Contains("--patches 1"));
}
