// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/options/job_file.h"

#include <fstream>
#include <set>

#include <catch2/catch.hpp>

#include "tests/io/files/schema.h"
#include "tests/io/files/temporary_folder.h"
#include "voxtone/base/error.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// A job file of its own, as test cases may run beside each other.
struct JobFile {
    explicit JobFile(const std::string& text) { std::ofstream(path()) << text; }
    [[nodiscard]] std::string path() const { return (folder.path() / "job.json").string(); }

    io::TemporaryFolder folder;
};

std::string failure(const std::string& text) {
    SliceOptions options;
    const JobFile job(text);
    try {
        read_job(job.path(), options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Every option says and takes its own value") {
    std::set<std::string> keys;
    for (const OptionSpec& spec : slice_option_table()) {
        INFO(spec.key);
        CHECK(keys.insert(spec.key).second);
        CHECK_FALSE(spec.help.empty());
        SliceOptions options;
        const std::string value = spec.get(options);
        if (!value.empty()) CHECK_NOTHROW(spec.set(options, value));
        CHECK(spec.get(options) == value);
    }
}

TEST_CASE("A dumped job read back is the same job") {
    SliceOptions options;
    options.model = "/models/a \"quoted\" name.obj";
    options.out = "out";
    options.size_mm = 60.25;
    options.load = {"C", "W", "K"};
    options.keep_thin = false;
    options.formats = {"png", "gcvf"};
    options.seed = 123456789012345;
    SliceOptions back;
    read_job(JobFile(job_json(options)).path(), back);
    CHECK(job_json(back) == job_json(options));
    CHECK(io::schema_faults("job", job_json(options)) == std::vector<std::string>{});
    CHECK(io::schema_faults("job", job_json({})) == std::vector<std::string>{});
    CHECK(io::schema_faults("job", R"({"format": "voxtone-job", "version": 1, "size": "large"})").size() > 0);
}

TEST_CASE("A wrong job file is refused with file, key and what to try") {
    using Catch::Matchers::Contains;
    CHECK_THAT(failure("{"), Contains("not valid JSON"));
    CHECK_THAT(failure("[]"), Contains("not a job file"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 2})"), Contains("version 2"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "sise": "60mm"})"),
               Contains("sise") && Contains("'size'"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "size": "big"})"),
               Contains("big") && Contains("size"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "screen": "lines"})"), Contains("blue-noise"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "load": [1]})"), Contains("load"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "load": ["C", "C"]})"), Contains("twice"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "size": {"mm": 60}})"), Contains("size"));
    SliceOptions options;
    CHECK_THROWS_AS(read_job("/nowhere/job.json", options), FileError);
}

TEST_CASE("On the command line --model is what is arranged, in a job file `model` is the mesh") {
    std::set<std::string> names;
    for (const OptionSpec& spec : slice_option_table()) {
        INFO(spec.option);
        CHECK(names.insert(spec.option).second);
        if (spec.option == "model") CHECK(spec.key == "arrange");
        if (spec.key == "model") CHECK(spec.option == "mesh");
    }
    SliceOptions options;
    const JobFile job(
        R"({"format": "voxtone-job", "version": 1, "model": "a.obj", "arrange": "layered-profile", "profiles": "maps/b.json"})");
    read_job(job.path(), options);
    CHECK(options.arrange == "layered-profile");
    CHECK(options.model == (job.folder.path() / "a.obj").string());
    CHECK(options.profiles == (job.folder.path() / "maps/b.json").string());
    read_job(JobFile(job_json(SliceOptions{})).path(), options);
    CHECK(options.profiles.empty());
    CHECK(failure(R"({"format": "voxtone-job", "version": 1, "arrange": "layers"})")
              .find("none of colour, layered-profile") != std::string::npos);
}
