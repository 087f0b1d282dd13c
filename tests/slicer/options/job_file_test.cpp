// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/job_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/options/option_table.h"
#include "tests/io/files/schema.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/slicer/options/declared_show.h"

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
    for (const OptionSpec& spec : slice_option_table()) {
        INFO(spec.key);
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
    CHECK(back.out == (std::filesystem::current_path() / "out").string());
    CHECK(io::schema_faults("job", job_json(options)) == std::vector<std::string>{});
    CHECK(io::schema_faults("job", job_json({})) == std::vector<std::string>{});
    CHECK(io::schema_faults("job", R"({"format": "voxtone-job", "version": 1, "size": "large"})").size() > 0);
}

TEST_CASE("What a job leaves is seen from its folder, and what was said to that run alone is left out") {
    const io::TemporaryFolder desk;
    const auto at = [&](const std::string& name) { return (desk.path() / name).string(); };
    std::ofstream(at("grey")) << "{}";
    SliceOptions options;
    options.model = at("models/a.obj");
    options.out = at("prints/out");
    options.printer = at("mine.json");
    options.resins = at("grey");
    declare_relics();
    options = with_relic(options, at("prints/out/map.json"));
    find_option("guards")->set(options, "W=" + at("white.json") + ",K=" + at("black.json"));
    options.overwrite = options.resume = true;
    const std::string digest(64, 'a');
    const std::string record = job_record(
        options,
        std::vector<JobInput>{
            {"model", at("models/a.obj"), digest}, {"resins", "", digest}, {"model:b.png", at("models/b.png"), ""}},
        at("prints/out"));
    using Catch::Matchers::Contains;
    CHECK_THAT(record, Contains("\"model\": \"../../models/a.obj\"") && Contains("\"out\": \".\"") &&
                           Contains("\"printer\": \"../../mine.json\"") && Contains("\"resins\": \"../../grey\"") &&
                           Contains("\"bone\": \"./map.json\"") && Contains("W=../../white.json"));
    // Read from another place, where all of it went.
    std::filesystem::create_directories(desk.path() / "far/prints/out");
    std::ofstream(at("far/prints/out/job.json")) << record;
    SliceOptions back;
    read_job(at("far/prints/out/job.json"), back);
    CHECK(back.model == at("far/models/a.obj"));
    CHECK(back.out == at("far/prints/out"));
    CHECK(back.printer == at("far/mine.json"));
    CHECK(back.resins == at("far/grey"));
    CHECK(find_option("bone")->get(back) == at("far/prints/out/map.json"));
    CHECK(find_option("guards")->get(back) == "W=" + at("far/white.json") + ",K=" + at("far/black.json"));
    CHECK_FALSE(back.overwrite);
    CHECK_FALSE(back.resume);
    REQUIRE(back.recorded_inputs.size() == 3);
    CHECK(back.recorded_inputs[0].file == at("far/models/a.obj"));
    CHECK(back.recorded_inputs[0].sha256 == digest);
    CHECK(back.recorded_inputs[1].file.empty());
    CHECK(back.recorded_inputs[2].sha256.empty());
}

TEST_CASE("Words of the program's own are no paths") {
    SliceOptions options;
    const JobFile job(
        R"({"format": "voxtone-job", "version": 1, "printer": "stratasys-j55", "resins": "vero-opaque", "out": "o"})");
    read_job(job.path(), options);
    CHECK(options.printer == "stratasys-j55");
    CHECK(options.resins == "vero-opaque");
    CHECK(options.out == (job.folder.path() / "o").string());
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "inputs": {}})"),
               Catch::Matchers::Contains("inputs"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "inputs": [{"file": "a"}]})"),
               Catch::Matchers::Contains("which 'input'"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "inputs": [{"input": "model", "sha": "a"}]})"),
               Catch::Matchers::Contains("sha256"));
}

TEST_CASE("A wrong job file is refused with file, key and what to try") {
    using Catch::Matchers::Contains;
    CHECK_THAT(failure("{\n\n"), Contains("line 3: this is no valid JSON") && Contains("--dump-default"));
    CHECK_THAT(failure("[]"), Contains("expected a JSON object") && Contains("--dump-default"));
    CHECK_THAT(failure("{}"), Contains("not a job file"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 2})"), Contains("version 2"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "sise": "60mm"})"),
               Contains("sise") && Contains("'size'"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "count": 3})"), Contains("copies are a tray's"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "size": "big"})"),
               Contains("big") && Contains("size"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "screen": "lines"})"), Contains("blue-noise"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "load": [1]})"), Contains("load"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "load": ["C", "C"]})"), Contains("twice"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "size": {"mm": 60}})"), Contains("size"));
    // The line is that of the key, wherever it stands.
    const std::string begin = "{\"format\": \"voxtone-job\",\n \"version\": 1,\n\n";
    CHECK_THAT(failure(begin + "\"sise\": \"60mm\"}"), Contains("job.json: line 4: unknown key 'sise'"));
    CHECK_THAT(failure(begin + "\"load\": [\"C\",\n 1]}"), Contains("line 4: key `load`"));
    CHECK_THAT(failure(begin + "\"screen\": \"lines\"}"), Contains("line 4: key `screen`"));
    CHECK_THAT(failure(begin + "\"inputs\": [{\"input\": \"a\"},\n{\"input\": 7}]}"),
               Contains("line 5: key `inputs[1].input`"));
    SliceOptions options;
    CHECK_THROWS_AS(read_job("/nowhere/job.json", options), FileError);
}

TEST_CASE("The key of an option is its name") {
    declare_relics();
    SliceOptions options;
    const JobFile job(
        R"({"format": "voxtone-job", "version": 1, "model": "a.obj", "show": "relic", "bone": "maps/b.json"})");
    read_job(job.path(), options);
    CHECK(options.show == "relic");
    CHECK(options.named.back() == "bone");
    CHECK(std::find(options.named.begin(), options.named.end(), "show") != options.named.end());
    CHECK(options.model == (job.folder.path() / "a.obj").string());
    CHECK(find_option("bone")->get(options) == (job.folder.path() / "maps/b.json").string());
    read_job(JobFile(R"({"format": "voxtone-job", "version": 1, "show": "colour", "bone": ""})").path(), options);
    CHECK(options.other.empty());
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "show": "layers"})"),
               Catch::Matchers::Contains("none of colour, relic"));
    read_job(JobFile(R"({"format": "voxtone-job", "version": 1, "arrange": "stacked"})").path(), options);
    CHECK(options.arrange == "stacked");
    CHECK(options.show == SliceOptions{}.show);
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "arrange": "colour"})"),
               Catch::Matchers::Contains("--arrange: 'colour' is none of none, plate, stacked"));
    CHECK_THAT(failure(R"({"format": "voxtone-job", "version": 1, "layout": "none"})"),
               Catch::Matchers::Contains("unknown key 'layout'"));
}

TEST_CASE("A job file's quality is what it stands for, and what the file says beside it wins") {
    const auto read = [](const std::string& keys) {
        SliceOptions options;
        read_job(JobFile(R"({"format": "voxtone-job", "version": 1)" + keys + "}").path(), options);
        return options;
    };
    const SliceOptions draft = read(R"(, "quality": "draft")");
    CHECK(draft.iterations == "0");
    CHECK(draft.predict == "none");
    CHECK(read(R"(, "iterations": "3", "quality": "draft")").iterations == "3");
    CHECK(read(R"(, "iterations": "3", "quality": "draft")").predict == "none");
    // A complete file names every default: these say nothing.
    CHECK(read(R"(, "quality": "draft", "iterations": "auto")").iterations == "0");
    CHECK(io::schema_faults("job", R"({"format": "voxtone-job", "version": 1, "quality": "draft"})").empty());
    // What is written are the options that it stands for.
    CHECK(job_json(draft).find("quality") == std::string::npos);
    SliceOptions back;
    read_job(JobFile(job_json(draft)).path(), back);
    CHECK(back.iterations == "0");
    CHECK(back.predict == "none");
}
