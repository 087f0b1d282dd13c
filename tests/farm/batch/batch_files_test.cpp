// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a batch keeps on disk: states, digests of inputs, the summary.
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/batch_status.h"
#include "farm/batch/batch_summary.h"
#include "io/files/file_digest.h"
#include "tests/io/files/schema.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

JobState new_state(const std::string& name) {
    JobState state;
    state.name = name;
    return state;
}

JobState full_state() {
    JobState state = new_state("a <b> & \"c\"");
    state.number = 7;
    state.phase = JobPhase::done;
    state.command = {"slice", "/m/a b.obj", "--size", "40mm"};
    state.program = "0.2.0 build 0123456789abcdef";
    state.folder_is_ours = true;
    state.attempts = 2;
    state.threads = 4;
    state.expected_cpu_s = 12.5;
    state.runner = JobRunner{"host", 12, 345, "2026-11-23T09:12:31Z"};
    state.finished = "2026-11-23T09:12:41Z";
    state.inputs = {{"/m/a b.obj", {{10, 11, 1'795'427'256'528'554'634, 13}, std::string(64, 'a')}}};
    state.figures =
        StackFigures{std::string(64, 'b'), "generic", {1.5, 2, 3}, 40, 1000, {{"C", 0.25}, {"W", 1}}, "good", 1.25,
                     {"=1+1", "<script>"}, 2.5,       100,         200};
    state.after = AfterState{true, 7};
    return state;
}

}  // namespace

TEST_CASE("A state read back is the same state, and what its schema says") {
    const io::TemporaryFolder folder;
    const fs::path file = folder.path() / "state.json";
    JobState odd = full_state();  // names of files hold any bytes
    odd.command[1] = odd.inputs[0].first = "/m/caf\xE9.obj";
    for (const JobState& state : {full_state(), new_state("x"), odd}) {
        const std::string text = state_json(state);
        CHECK(io::schema_faults("batch-job", text) == std::vector<std::string>{});
        std::ofstream(file) << text;
        CHECK(state_json(read_state(file)) == text);
        CHECK(read_state(file).command == state.command);
        CHECK(read_state(file).inputs.size() == state.inputs.size());
    }
    CHECK(read_state(file).inputs[0].first == "/m/caf\xE9.obj");
}

TEST_CASE("A state that is cut short or of another version is none") {
    const io::TemporaryFolder out;
    const BatchFolder batch = BatchFolder::make(out.path());
    JobState state = full_state();
    state.name = "job";
    const std::string text = state_json(state);
    for (std::size_t size = 0; size + 2 < text.size(); size += 3) {
        std::ofstream(batch.state_file("job")) << text.substr(0, size);
        CHECK_FALSE(batch.state_of("job"));
    }
    std::string newer = text;
    newer.replace(newer.find("\"version\": 1"), 12, "\"version\": 2");
    std::ofstream(batch.state_file("job")) << newer;
    CHECK_FALSE(batch.state_of("job"));
    std::ofstream(batch.state_file("job")) << text;
    CHECK(batch.state_of("job"));
    CHECK_FALSE(batch.state_of("other"));
}

TEST_CASE("A digest is that of the file as it is now") {
    const io::TemporaryFolder folder;
    const std::string file = (folder.path() / "a").string();
    io::FileDigests digests;
    CHECK(digests.of(file).empty());
    std::ofstream(file) << "one";
    const std::string one = digests.of(file);
    CHECK(one == io::file_sha256(file));
    CHECK_FALSE(digests.find(file));  // too young to be known for good
    std::ofstream(file) << "two";     // of the same size
    CHECK(digests.of(file) == io::file_sha256(file));
    // What is known of a file counts as long as its stamp is the same, and no longer.
    digests.learn(file, {*io::FileStamp::of(file), "known"});
    CHECK(digests.of(file) == "known");
    const auto time = fs::last_write_time(file);
    std::ofstream(file) << "six";
    fs::last_write_time(file, time);
    CHECK(digests.of(file) == io::file_sha256(file));
}

TEST_CASE("The summary holds no text that a browser or a spreadsheet would run") {
    const io::TemporaryFolder out;
    const BatchFolder batch = BatchFolder::make(out.path());
    JobState failed = new_state("=cmd");
    failed.phase = JobPhase::failed;
    failed.message = "a,\"b\"\nc <i>";
    const std::vector<JobState> states{full_state(), failed};
    const std::string page = batch_html(batch, states), csv = batch_csv(states);
    CHECK_THAT(page, !Contains("<script") && !Contains("<b>") && !Contains("<i>") && Contains("a &lt;b&gt;"));
    CHECK_THAT(page, Contains("default-src 'none'") && Contains("1.2") && Contains("0.25"));
    CHECK_THAT(csv,
               Contains("\"a <b> & \"\"c\"\"\",done,,generic,1.500,2.000,3.000,40,1.2500,0.2500,1.0000,1.250,good,2"));
    CHECK_THAT(csv, Contains("'=cmd,failed,\"a,\"\"b\"\"\nc <i>\","));
}

TEST_CASE("A status says when the rest will be done, to people and to programs") {
    const io::TemporaryFolder out;
    const BatchFolder batch = BatchFolder::make(out.path());
    JobState done = full_state(), runs = new_state("b"), waits = new_state("c");
    done.name = "a";
    done.finished = utc_now();
    done.threads = 2;
    runs.phase = JobPhase::running;
    runs.runner = JobRunner{"another-host", 1, 1, utc_now()};
    for (const JobState& state : {done, runs, waits}) batch.publish(state);
    const JobResult status = batch_status(out.path());
    CHECK_THAT(status.text, Contains("3 jobs, 1 done, 1 running, 1 queued; the rest, 2 jobs, in "));
    CHECK_THAT(status.json, Contains("\"rest\": {\"jobs\": 2, \"measured_jobs\": 1, \"seconds\": ") &&
                                Contains("\"least_seconds\": ") && Contains("\"most_seconds\": "));
    CHECK_THAT(batch_html(batch, batch.states()), Contains("<dt>The rest in</dt>"));
    runs.phase = JobPhase::failed;
    runs.runner.reset();
    waits.phase = JobPhase::failed;
    for (const JobState& state : {runs, waits}) batch.publish(state);
    CHECK_THAT(batch_status(out.path()).text, !Contains("the rest"));
    CHECK_THAT(batch_html(batch, batch.states()), !Contains("The rest in"));
}
