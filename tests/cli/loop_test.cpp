// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <filesystem>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "voxtone/slicer/job/slice_job.h"

using namespace voxtone;
using namespace voxtone::test;

namespace {

const std::string picture = std::string(VOXTONE_SOURCE_DIR) + "/examples/models/spot/spot_texture.png";

nlohmann::json json_of(const std::string& file) { return nlohmann::json::parse(read_file(file)); }

/// Asks the work to stop after so many predictions of the loop.
class StopsAfter final : public Progress {
public:
    explicit StopsAfter(int predictions) : predictions_(predictions) {}

private:
    void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
        in_loop_ = name == "appearance loop";
    }
    void on_advance(std::uint64_t done) override {
        if (in_loop_ && static_cast<int>(done) == predictions_) cancel();
    }
    int predictions_;
    bool in_loop_ = false;
};

slicer::SliceOptions small_slab(const Folder& folder, const std::string& out) {
    slicer::SliceOptions options;
    options.model = picture;
    options.out = folder / out;
    options.width_mm = 2.4;
    options.thickness_mm = 1;
    options.iterations.assign(1, '5');  // a literal here trips a warning of GCC 12
    options.report = false;
    return options;
}

}  // namespace

TEST_CASE(
    "The loop lowers the error, reports it and leaves a stack that verifies, the same for any number of threads") {
    const Folder folder("loop");
    std::string digest;
    for (const int threads : {1, 5}) {
        const std::string out = folder / fmt::format("out{}", threads);
        REQUIRE(
            run_program(fmt::format("slice --quiet --iterations 4 --threads {} {} --width 2.4mm --thickness 1mm -o {}",
                                    threads, picture, out))
                .exit_code == 0);
        CHECK(run_program("verify --quiet " + out).exit_code == 0);
        const nlohmann::json report = json_of(out + "/report.json"), loop = report.at("loop");
        REQUIRE(loop.at("iterations").size() == 5);
        const int best = loop.at("best");
        REQUIRE(best > 0);
        CHECK(loop["iterations"][std::size_t(best)]["seen_de2000"]["mean"].get<double>() <
              0.97 * loop["iterations"][0]["seen_de2000"]["mean"].get<double>());
        CHECK(std::filesystem::exists(out + "/open-loop.png"));
        CHECK_FALSE(std::filesystem::exists(out + "/loop.checkpoint"));
        const std::string content = json_of(out + "/manifest.json").at("content_sha256");
        if (digest.empty()) digest = content;
        CHECK(content == digest);
    }
}

TEST_CASE("Without iterations the open loop is printed, and nothing is said of a loop") {
    const Folder folder("no-loop");
    REQUIRE(run_program(fmt::format("slice --quiet --iterations 0 {} --width 2.4mm --thickness 1mm -o {}", picture,
                                    folder / "out"))
                .exit_code == 0);
    CHECK_FALSE(json_of(folder / "out/report.json").contains("loop"));
    CHECK(run_program(fmt::format("slice --iterations -1 {} --width 2mm -o {}", picture, folder / "other")).exit_code ==
          2);
    CHECK(run_program(fmt::format("slice --iterations often {} --width 2mm -o {}", picture, folder / "other"))
              .exit_code == 2);
}

// The predictor keeps its light from print to print and a resumed loop starts without it: nearly the same print, not
// the same bits.
TEST_CASE("A stopped loop leaves a whole stack, and --resume goes on where it was") {
    const Folder folder("resume");
    Progress quiet;
    (void)slicer::run_slice_job(small_slab(folder, "whole"), quiet);
    StopsAfter stops(3);
    (void)slicer::run_slice_job(small_slab(folder, "stopped"), stops);
    CHECK(run_program("verify --quiet " + (folder / "stopped")).exit_code == 0);
    REQUIRE(std::filesystem::exists(folder / "stopped/loop.checkpoint"));
    slicer::SliceOptions other = small_slab(folder, "stopped");
    other.resume = true;
    other.depth_mm = 0.5;
    CHECK_THROWS_AS(slicer::run_slice_job(other, quiet), InputError);
    CHECK(run_program("verify --quiet " + (folder / "stopped")).exit_code == 0);  // refused, and nothing is lost
    slicer::SliceOptions resumed = small_slab(folder, "stopped");
    resumed.resume = true;
    (void)slicer::run_slice_job(resumed, quiet);
    CHECK(run_program("verify --quiet " + (folder / "stopped")).exit_code == 0);
    const auto iterations = [&](const std::string& out) {
        return json_of((folder / out) + "/report.json").at("loop").at("iterations");
    };
    const nlohmann::json whole = iterations("whole"), gone_on = iterations("stopped");
    REQUIRE(gone_on.size() == whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const double there = whole[i]["seen_de2000"]["mean"], here = gone_on[i]["seen_de2000"]["mean"];
        CHECK(here == Approx(there).epsilon(i < 3 ? 1e-9 : 0.05));
    }
    CHECK_FALSE(std::filesystem::exists(folder / "stopped/loop.checkpoint"));
}

TEST_CASE("Where there is nothing to rearrange the job says so and goes on") {
    const Folder folder("nothing");
    const auto loop_of = [&](const std::string& arguments) {
        const std::string out = folder / "out";
        const Outcome outcome = run_program(fmt::format("slice --overwrite --iterations 2 {} -o {}", arguments, out));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        CHECK(run_program("verify --quiet " + out).exit_code == 0);
        return json_of(out + "/report.json").contains("loop");
    };
    const std::string slab = picture + " --width 2mm --thickness 1mm ";
    CHECK_FALSE(loop_of(slab + "--load W"));
    // Without white, without black: the core stands in for white.
    CHECK(loop_of(slab + "--load C,M,Y,K --core Y"));
    CHECK(loop_of(slab + "--load C,M,Y,W"));
    // A wall thinner than two voxels, of one colour.
    folder.write("wall.obj", ramp_box_obj(2, 0.1, 1.5));
    CHECK(loop_of((folder / "wall.obj") + " --resins vero-opaque"));
    folder.write("marker.obj", marker_obj());
    CHECK(loop_of((folder / "marker.obj") + " --size 2mm"));
}
