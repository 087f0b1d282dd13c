// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/output_folder.h"

#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/io/layers/stack_samples.h"
#include "tests/said_progress.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

/// A model, jobs of it, and a folder to make them in.
struct OutputDesk {
    OutputDesk() { io::write_whole_file(folder.path() / "model.obj", std::string("v 0 0 0\n")); }

    [[nodiscard]] OpenedJob job(double size_mm) const {
        SliceOptions options;
        options.model = (folder.path() / "model.obj").string();
        options.out = out.string();
        options.size_mm = size_mm;
        return open_job(options);
    }
    /// As a job or its shards leave it.
    void leave_record(const fs::path& where, const OpenedJob& of) const {
        fs::create_directories(where);
        io::write_whole_file(where / job_file_name, job_record(of.options.raw, identify(of, {}).inputs, where));
    }
    void leave_stack(const OpenedJob& of) const {
        (void)io::write_sample_stack(out, 3);
        leave_record(out, of);
    }
    void ask(const OpenedJob& of, const Replacing& how = {}) {
        expect_replaceable(of, take_output(out, {io::shards_name}, progress), how, progress);
    }

    io::TemporaryFolder folder;
    fs::path out = folder.path() / "out";
    test::SaidProgress progress;
};

}  // namespace

TEST_CASE("A job replaces its own stack, and another's where it may") {
    OutputDesk desk;
    const OpenedJob mine = desk.job(3), other = desk.job(4);
    CHECK_NOTHROW(desk.ask(mine));
    desk.leave_stack(mine);
    CHECK_NOTHROW(desk.ask(mine));
    CHECK_THROWS_WITH(desk.ask(other), Contains("--overwrite"));
    CHECK_NOTHROW(desk.ask(other, {.overwrite = true}));
    CHECK_NOTHROW(desk.ask(other, {.goes_on = true}));
    io::write_whole_file(desk.out / "layers/mine.txt", std::string("notes"));
    desk.ask(mine);
    CHECK_THAT(desk.progress.warnings(), Contains("mine.txt") && Contains("[strange-files]"));
}

TEST_CASE("Shards of another job are asked for after its stack, and before a printer's folder") {
    OutputDesk desk;
    const OpenedJob mine = desk.job(3), other = desk.job(4);
    const fs::path printer = desk.folder.path() / "printer";
    fs::create_directory(printer);
    io::write_whole_file(printer / "letter.txt", std::string("dear"));
    desk.leave_record(desk.out / io::shards_name, other);
    CHECK_NOTHROW(desk.ask(other));
    CHECK_THROWS_WITH(desk.ask(mine, {.for_printer = printer}), Contains("shards of another job"));
    CHECK_THROWS_WITH(desk.ask(mine, {.goes_on = true}), Contains("shards of another job"));
    CHECK_THROWS_WITH(desk.ask(other, {.for_printer = printer}), Contains("--for-printer"));
    CHECK_NOTHROW(desk.ask(mine, {.overwrite = true}));
    desk.leave_stack(other);
    CHECK_THROWS_WITH(desk.ask(mine), !Contains("shards of another job"));
}

TEST_CASE("What was said of a job is said again while its stack is there, whole") {
    OutputDesk desk;
    const OpenedJob mine = desk.job(3), other = desk.job(4);
    const auto said = [&](const OpenedJob& of) {
        return said_before(of, take_output(desk.out, {}, desk.progress), "report.json", desk.progress);
    };
    CHECK_FALSE(said(mine));
    desk.leave_stack(mine);
    CHECK_FALSE(said(mine));
    io::write_whole_file(desk.out / "report.json", std::string("{}"));
    CHECK(said(mine) == "{}");
    CHECK_FALSE(said(other));
    fs::remove(desk.out / io::manifest_name);
    CHECK_FALSE(said(mine));
}
