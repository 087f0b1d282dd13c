// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/submission.h"

#include <catch2/catch.hpp>

#include "farm/batch/batch_folder.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Words = std::vector<std::string>;

namespace {

Submission submission_of(const std::vector<Words>& numbers) {
    Submission submission{"a job", "2026-11-26T12:00:00Z", 17, true, {}, 3};
    for (const Words& of_stage : numbers)
        submission.stages.push_back({TaskStage::layers, {"slice", "caf\xE9.obj"}, 4, of_stage});
    return submission;
}

}  // namespace

TEST_CASE("All tasks of a chain have ended when its last stage has, and every part of a cut array") {
    CHECK(submission_of({{"1"}, {"2"}, {"3"}}).ends() == Words{"3"});
    CHECK(submission_of({{"1"}, {"2", "3"}, {"4"}}).ends() == Words{"2", "3", "4"});
    CHECK(submission_of({{"1"}}).ends() == Words{"1"});
    CHECK(submission_of({}).ends().empty());
    CHECK(submission_of({{"1"}, {"2", "3"}, {"4"}}).numbers() == Words{"1", "2", "3", "4"});
}

TEST_CASE("A submission read back is the same, and what waits for all has a place of its own") {
    const io::TemporaryFolder folder;
    const BatchFolder batch = BatchFolder::make(folder.path() / "out");
    const SubmissionFolder files(batch);
    CHECK_FALSE(files.read("a job"));
    CHECK_FALSE(files.read_closing());
    Submission written = submission_of({{"1"}, {"2", "3"}});
    written.stages[0].memory_bytes = 4096;
    written.stages[0].is_starved = written.stages[1].is_raised = true;
    files.write(written);
    files.write_closing({"9", 1'795'427'256'528'554'634});
    const auto read = files.read("a job");
    REQUIRE(read);
    CHECK(submission_json(*read) == submission_json(written));
    CHECK(read->jobs == 3);
    CHECK(read->stages[0].memory_bytes == 4096);
    CHECK(read->stages[0].is_starved);
    CHECK_FALSE(read->stages[1].is_starved);
    CHECK(read->stages[1].is_raised);
    CHECK(read->stages[0].arguments[1] == "caf\xE9.obj");
    REQUIRE(files.read_closing());
    CHECK(files.read_closing()->number == "9");
    CHECK(files.read_closing()->since_ns == 1'795'427'256'528'554'634);
    CHECK(files.all().size() == 1);
}
