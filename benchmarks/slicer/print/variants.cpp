// SPDX-License-Identifier: GPL-3.0-or-later
#include "variants.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/progress.h"
#include "io/files/whole_file.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"
#include "slicer/print/run_print.h"

namespace voxtone::loop_benchmark {
namespace {

double seconds_of(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

double core_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

bool has_option(const std::string& key) {
    const auto table = slicer::slice_option_table();
    return std::any_of(table.begin(), table.end(), [&](const slicer::OptionSpec& s) { return s.key == key; });
}

/// How often the loop rearranged the resins, by the job's report; -1: no loop.
int iterations_made(const nlohmann::json& report) {
    return report.contains("loop") ? static_cast<int>(report.at("loop").at("iterations").size()) - 1 : -1;
}

/// Keeps what the job says on its way: the loop's iterations.
class NotingProgress : public Progress {
public:
    std::vector<std::string> notes;

protected:
    void on_note(const std::string& note) override { notes.push_back(note); }
};

std::string text_of(const std::filesystem::path& file) {
    const auto bytes = io::read_whole_file(file, std::uint64_t{1} << 26);
    return {bytes.begin(), bytes.end()};
}

}  // namespace

std::vector<Variant> variants(const OptionSet& loop) {
    std::vector<Variant> v;
    if (has_option("iterations")) {
        v = {{"open loop", {{"iterations", "0"}}}, {"loop", {}}};
    } else {  // a stand-in of the same shape
        v = {{"open loop", {{"depth", "1mm"}}}, {"depth 0.4 mm", {{"depth", "0.4mm"}}}};
    }
    v.back().set.insert(v.back().set.end(), loop.begin(), loop.end());
    return v;
}

void set_options(const OptionSet& set, slicer::SliceOptions& options) {
    const auto table = slicer::slice_option_table();
    for (const auto& [key, value] : set) {
        const auto spec =
            std::find_if(table.begin(), table.end(), [&, k = key](const slicer::OptionSpec& s) { return s.key == k; });
        if (spec == table.end()) throw UsageError(fmt::format("slice has no option --{}", key));
        spec->set(options, value);
    }
}

OptionSet parse_set(const std::vector<std::string>& texts) {
    OptionSet set;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) throw UsageError(fmt::format("{}: give KEY=VALUE", text));
        set.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    return set;
}

Print make_print(const slicer::SliceOptions& wanted, bool reuse) {
    Print print;
    print.options = wanted;
    print.options.predict = "none";
    const std::filesystem::path folder = wanted.out, done = folder / "benchmark.json";
    const std::string job = slicer::job_json(print.options);
    if (reuse && std::filesystem::exists(done)) {
        const auto json = nlohmann::json::parse(text_of(done));
        if (json.at("job") == nlohmann::json::parse(job)) {
            print.seconds = json.at("seconds");
            print.core_seconds = json.at("core_seconds");
            print.iterations = json.at("iterations");
            return print;
        }
    }
    std::filesystem::remove_all(folder);
    NotingProgress progress;
    const auto start = std::chrono::steady_clock::now();
    const double cores_before = core_seconds();
    const JobResult result = slicer::run_print({print.options}, progress);
    print.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print.core_seconds = core_seconds() - cores_before;
    print.iterations = iterations_made(nlohmann::json::parse(result.json));
    const nlohmann::json record{{"job", nlohmann::json::parse(job)},
                                {"seconds", print.seconds},
                                {"core_seconds", print.core_seconds},
                                {"iterations", print.iterations},
                                {"notes", progress.notes}};
    io::write_whole_file(done, record.dump(1));
    return print;
}

}  // namespace voxtone::loop_benchmark
