// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_identity.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "io/files/file_digest.h"
#include "io/profiles/resin_file.h"
#include "slicer/options/job_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

namespace fs = std::filesystem;

/// A folder with a model, and jobs about it.
struct Desk {
    Desk() {
        write("model.obj", "v 0 0 0\n");
        write("skin.png", "red");
    }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder.path() / name).parent_path());
        std::ofstream(folder.path() / name) << text;
    }
    [[nodiscard]] std::string operator/(const std::string& name) const { return (folder.path() / name).string(); }
    [[nodiscard]] SliceOptions options() const {
        SliceOptions options;
        options.model = *this / "model.obj";
        options.out = *this / "out";
        options.overwrite = true;  // a lone job.json makes no stack of a folder
        return options;
    }
    [[nodiscard]] JobIdentity identity(const SliceOptions& options) const {
        const std::string skin = io::file_sha256(fs::path(options.model).parent_path() / "skin.png");
        return identify(open_job(options), std::vector<io::SideFile>{{"skin.png", skin}});
    }
    /// As `slice` leaves it.
    void leave_record(const SliceOptions& options) const {
        write("out/job.json", job_record(options, identity(options).inputs, *this / "out"));
    }
    io::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("What a job depends on is listed by its names, each once") {
    const Desk desk;
    SliceOptions options = desk.options();
    options.texture = desk / "skin.png";
    const std::vector<io::SideFile> files{{"zebra.png", "aa"}, {"ant.png", "bb"}, {"zebra.png", "aa"}};
    const std::vector<JobInput> inputs = identify(open_job(options), files).inputs;
    std::vector<std::string> keys;
    for (const JobInput& input : inputs) keys.push_back(input.key);
    CHECK(keys.size() >= 4);
    CHECK(std::is_sorted(keys.begin(), keys.end()));
    CHECK(std::adjacent_find(keys.begin(), keys.end()) == keys.end());
}

TEST_CASE("What a texture, a backing and a decal hold makes another job, as the model does") {
    const Desk desk;
    const auto another_by = [&](const char* file, const auto& name) {
        SliceOptions options = desk.options();
        name(options, desk / file);
        desk.write(file, "one");
        const std::string before = desk.identity(options).job;
        CHECK(desk.identity(options).job == before);
        CHECK(before != desk.identity(desk.options()).job);
        desk.write(file, "two");
        return desk.identity(options).job != before;
    };
    CHECK(another_by("bark.png", [](SliceOptions& o, const std::string& file) { o.texture = file; }));
    CHECK(another_by("model.obj", [](SliceOptions& o, const std::string& file) { o.model = file, o.depth_mm = 0.9; }));
    CHECK(another_by("logo.png",
                     [](SliceOptions& o, const std::string& file) { o.decals = {file + "; place=top; size=5mm"}; }));
}

TEST_CASE("A job is its options and what its inputs hold, not where they lie") {
    const Desk desk;
    const SliceOptions options = desk.options();
    const JobIdentity identity = desk.identity(options);
    const auto same = [&](const SliceOptions& other) { return desk.identity(other).job == identity.job; };
    CHECK(identity.job.size() == 64);
    CHECK(identity.loop != identity.job);

    SliceOptions other = options;
    other.out = desk / "elsewhere";
    other.threads = 3;
    other.memory_gib = 2;
    other.overwrite = other.resume = true;
    CHECK(same(other));
    desk.write("copy/another name.obj", "v 0 0 0\n");
    desk.write("copy/skin.png", "red");
    other.model = desk / "copy/another name.obj";
    CHECK(same(other));
    other.resins = desk / "mine.json";
    desk.write("mine.json", std::string(io::known_resin_set_text("j750-vivid").value()));
    CHECK(same(other));

    // What is in the files counts ...
    desk.write("copy/skin.png", "blue");
    CHECK_FALSE(same(other));
    desk.write("copy/skin.png", "red");
    desk.write("mine.json", std::string(io::known_resin_set_text("j750-vivid").value()) + "\n");
    CHECK_FALSE(same(other));
    // ... and what the options say.
    for (const auto& change : std::initializer_list<void (*)(SliceOptions&)>{
             [](SliceOptions& o) { o.size_mm = 7; }, [](SliceOptions& o) { o.depth_mm = 0.5; },
             [](SliceOptions& o) { o.flip_x = true; }, [](SliceOptions& o) { o.iterations.assign(1, '3'); },
             [](SliceOptions& o) { o.predict = "none"; }}) {
        SliceOptions changed = options;
        change(changed);
        CHECK_FALSE(same(changed));
    }
}

TEST_CASE("All who ask for a job's identity in a run ask one memo of what its inputs hold") {
    const Desk desk;
    const SliceOptions options = desk.options();
    desk.leave_record(options);
    const OpenedJob job = open_job(options);
    CHECK(is_same_job(desk / "out", job));
    // Nobody reads the model again while it is the very file.
    io::file_digests().learn(options.model, {*io::FileStamp::of(options.model), std::string(64, 'f')});
    CHECK(desk.identity(options).inputs[0].sha256 == std::string(64, 'f'));
    CHECK(io::file_sha256(options.model) == std::string(64, 'f'));
    CHECK_FALSE(is_same_job(desk / "out", job));
    CHECK(opened_loop_identity(job) == desk.identity(options).opened_loop);
    desk.write("model.obj", "v 0 0 1\n");
    CHECK(desk.identity(options).inputs[0].sha256 == io::file_sha256(options.model));
}

TEST_CASE("A model in an archive is the archive's file and the name behind it") {
    const Desk desk;
    desk.write("a.zip", "PK");
    SliceOptions options = desk.options();
    const auto job_of = [&](const std::string& model) {
        options.model = desk / model;
        return identify(open_job(options), {});
    };
    const JobIdentity whole = job_of("a.zip"), part = job_of("a.zip/x/b.obj"), other = job_of("a.zip/x/c.obj");
    for (const JobIdentity* identity : {&whole, &part, &other}) {
        CHECK(identity->inputs[0].key == "model");
        CHECK(identity->inputs[0].file == desk / "a.zip");
        CHECK(identity->inputs[0].sha256 == io::file_sha256(desk / "a.zip"));
    }
    CHECK(part.job != other.job);
    CHECK(part.loop != other.loop);
    desk.write("moved.zip", "PK");
    CHECK(job_of("moved.zip/x/b.obj").job == part.job);
}

TEST_CASE("The state of a loop serves jobs that differ only in what comes after it") {
    const Desk desk;
    const SliceOptions options = desk.options();
    SliceOptions other = options;
    other.iterations.assign(1, '3');
    other.predict = "none";
    other.report = false;
    CHECK(desk.identity(other).loop == desk.identity(options).loop);
    other.depth_mm = 0.5;
    CHECK(desk.identity(other).loop != desk.identity(options).loop);
}

TEST_CASE("A folder's job.json tells whether its stack is of this very job") {
    const Desk desk;
    const SliceOptions options = desk.options();
    const auto same = [&](const SliceOptions& asked) { return is_same_job(desk / "out", open_job(asked)); };
    CHECK_FALSE(same(options));
    desk.leave_record(options);
    CHECK(same(options));
    // The record moves with its folder and the model; paths in it stay good.
    fs::create_directory(desk / "moved");
    for (const char* const name : {"out", "model.obj", "skin.png"})
        fs::rename(desk / name, fs::path(desk / "moved") / name);
    SliceOptions recorded;
    read_job(desk / "moved/out/job.json", recorded);
    CHECK(recorded.model == desk / "moved/model.obj");
    CHECK(recorded.out == desk / "moved/out");
    recorded.overwrite = true;
    CHECK(is_same_job(desk / "moved/out", open_job(recorded)));

    desk.write("moved/skin.png", "blue");
    CHECK_FALSE(is_same_job(desk / "moved/out", open_job(recorded)));
    desk.write("moved/skin.png", "red");
    recorded.size_mm = 7;
    CHECK_FALSE(is_same_job(desk / "moved/out", open_job(recorded)));
    desk.write("moved/out/job.json", "{");
    CHECK_FALSE(is_same_job(desk / "moved/out", open_job(recorded)));
}

TEST_CASE("A file that was missing makes no job the same: it may have come since") {
    const Desk desk;
    const SliceOptions options = desk.options();
    const OpenedJob job = open_job(options);
    const JobIdentity identity = identify(job, std::vector<io::SideFile>{{"lost.png", ""}});
    desk.write("out/job.json", job_record(options, identity.inputs, desk / "out"));
    CHECK_FALSE(is_same_job(desk / "out", job));
}

TEST_CASE("What another build of the program made is no result of this one") {
    const Desk desk;
    const SliceOptions options = desk.options();
    const OpenedJob job = open_job(options);
    JobIdentity identity = desk.identity(options);
    desk.write("out/job.json", job_record(options, identity.inputs, desk / "out"));
    CHECK(is_same_job(desk / "out", job));
    const auto program = std::ranges::find(identity.inputs, std::string("program"), &JobInput::key);
    REQUIRE(program != identity.inputs.end());
    program->sha256.assign(64, '0');
    desk.write("out/job.json", job_record(options, identity.inputs, desk / "out"));
    CHECK_FALSE(is_same_job(desk / "out", job));
    const auto changed = changed_inputs(identity.inputs, desk.identity(options).inputs);
    REQUIRE(changed.size() == 1);
    CHECK_THAT(changed[0], Catch::Contains("another build"));
    std::erase_if(identity.inputs, [](const JobInput& input) { return input.key == "program"; });  // as of old
    desk.write("out/job.json", job_record(options, identity.inputs, desk / "out"));
    CHECK_FALSE(is_same_job(desk / "out", job));
}

TEST_CASE("Inputs that changed since the job file was written are named, others are not") {
    const Desk desk;
    desk.leave_record(desk.options());
    SliceOptions again;
    read_job(desk / "out/job.json", again);
    again.overwrite = true;
    REQUIRE(again.recorded_inputs.size() == 5);  // model, texture, printer, resins, program
    CHECK(changed_inputs(again.recorded_inputs, desk.identity(again).inputs).empty());
    desk.write("skin.png", "blue");
    const auto changed = changed_inputs(again.recorded_inputs, desk.identity(again).inputs);
    REQUIRE(changed.size() == 1);
    CHECK_THAT(changed[0], Catch::Contains("skin.png") && Catch::Contains("SHA-256"));
    // Another model was asked for: nobody is surprised that it is another.
    desk.write("other/model.obj", "v 1 1 1\n");
    desk.write("other/skin.png", "green");
    again.model = desk / "other/model.obj";
    CHECK(changed_inputs(again.recorded_inputs, desk.identity(again).inputs).empty());
}
