// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/options/slice_options.h"

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

TEST_CASE("Layer ranges lie within the print") {
    CHECK(parse_layer_range("", 10).last == 9);
    CHECK(parse_layer_range("3-5", 10).first == 3);
    CHECK(parse_layer_range("7", 10).last == 7);
    CHECK_THROWS_AS(parse_layer_range("5-3", 10), UsageError);
    CHECK_THROWS_AS(parse_layer_range("a-b", 10), UsageError);
    CHECK_THROWS_AS(parse_layer_range("3-10", 10), InputError);
}

TEST_CASE("Rules between values name the key") {
    SliceOptions options;
    options.model = "a.obj";
    options.out = "out";
    CHECK_NOTHROW(validate(options));
    options.depth_mm = 0;
    CHECK_THROWS_WITH(validate(options), Catch::Matchers::Contains("--depth"));
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
    CHECK(options.layered());
    CHECK(options.model == (job.folder.path() / "a.obj").string());
    CHECK(options.profiles == (job.folder.path() / "maps/b.json").string());
    read_job(JobFile(job_json(SliceOptions{})).path(), options);
    CHECK(options.profiles.empty());
    CHECK(failure(R"({"format": "voxtone-job", "version": 1, "arrange": "layers"})")
              .find("none of colour, layered-profile") != std::string::npos);
}

TEST_CASE("Distances from the top are read by role") {
    const auto clear = parse_clear_top({"T=0.2mm", "K=100um"});
    REQUIRE(clear.size() == 2);
    CHECK(clear[0].role == "T");
    CHECK(clear[0].mm == Approx(0.2));
    CHECK(clear[1].mm == Approx(0.1));
    for (const char* bad : {"T", "=0.2mm", "T=", "T=-1mm", "T=deep"})
        CHECK_THROWS_AS(parse_clear_top({bad}), UsageError);
}

TEST_CASE("Rounds of stacks and measured materials are read, and told apart from what is wrong") {
    CHECK(parse_stack_rounds("auto") == -1);
    CHECK(parse_stack_rounds("0") == 0);
    CHECK(parse_stack_rounds("20") == 20);
    for (const char* wrong : {"21", "-1", "", "1.5", "some"}) CHECK_THROWS_AS(parse_stack_rounds(wrong), UsageError);
    const auto files = parse_stack_materials({"W=a/white=1.json", "K=black.json"});
    REQUIRE(files.size() == 2);
    CHECK(files[0].role == "W");
    CHECK(files[0].file == "a/white=1.json");
    for (const char* wrong : {"W", "=a.json", "W="}) CHECK_THROWS_AS(parse_stack_materials({wrong}), UsageError);
    CHECK_THROWS_AS(parse_stack_materials({"W=a.json", "W=b.json"}), UsageError);
}
