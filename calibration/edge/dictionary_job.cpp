// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/dictionary_job.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/process_usage.h"
#include "base/warning.h"
#include "calibration/edge/dictionary_file.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t estimate_every = 20;
constexpr std::uint32_t few_paths = 2048, many_paths = 32768;

std::string partial_name(const DictionaryJob& job) { return job.out + ".partial"; }

EdgeGrid grid_of(const DictionaryJob& job) {
    EdgeGrid grid = job.grid;
    if (grid.sigma_t.empty()) grid.sigma_t = paper_extinctions();
    return grid;
}

// What an earlier start left, if it was of the same dictionary; else nothing. Runs of another one took hours too: they
// are replaced where that was asked for.
EdgeDictionary begun(const DictionaryJob& job, const EdgeSetup& setup, Progress& progress) {
    EdgeDictionary fresh{setup, grid_of(job), {}};
    fresh.records.resize(fresh.grid.runs());
    if (!fs::exists(partial_name(job))) return fresh;
    EdgeDictionary left = read_dictionary(partial_name(job), true);
    if (left.grid == fresh.grid && edge_setup_text(left.setup) == edge_setup_text(setup)) return left;
    if (!job.overwrite)
        throw InputError(fmt::format(
            "{} has runs of another grid or setup; give the options that it was begun with to go on with it, another "
            "--out, or --overwrite to replace it",
            partial_name(job)));
    progress.warn(named_warning(
        "other-grid", fmt::format("{} is of another grid or setup; its runs are replaced", partial_name(job))));
    return fresh;
}

class PartialFile {
public:
    PartialFile(const std::string& name, const EdgeDictionary& begun) : name_(name) {
        io::write_whole_file(name, dictionary_bytes(begun));
        file_.open(name, std::ios::binary | std::ios::app);
    }
    void add(std::size_t run, const EdgeRecord& record) {
        const std::vector<std::uint8_t> bytes = dictionary_record(run, record);
        file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        file_.flush();
        if (!file_) throw FileError(fmt::format("{} cannot be written; is the disk full?", name_));
    }

private:
    std::string name_;
    std::ofstream file_;
};

double largest_noise(const EdgeDictionary& dictionary) {
    double most = 0;
    for (const EdgeRecord& record : dictionary.records)
        for (const double noise : record.noise) most = std::max(most, noise);
    return most;
}

double median_noise(const EdgeDictionary& dictionary) {
    std::vector<double> all;
    for (const EdgeRecord& record : dictionary.records) all.insert(all.end(), record.noise.begin(), record.noise.end());
    return optics::median(std::move(all));
}

JobResult result_of(const DictionaryJob& job, const EdgeDictionary& dictionary, std::size_t traced,
                    double cpu_seconds) {
    const std::size_t missing = missing_runs(dictionary).size(), runs = dictionary.records.size();
    const std::uint64_t bytes = fs::file_size(job.out);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-edge-dictionary").add("version", 1);
    json.add("dictionary", job.out).add("runs", runs).add("missing", missing).add("traced", traced);
    json.add("bytes", bytes).add("cpu_seconds", cpu_seconds).add("median_noise", median_noise(dictionary));
    json.add("largest_noise", largest_noise(dictionary)).end_object();
    std::string text = fmt::format(
        "{}: {} of {} runs ({} traced now in {:.0f} core seconds), {:.1f} MB; noise of a profile: median {:.2g}, "
        "largest "
        "{:.2g}\n",
        job.out, runs - missing, runs, traced, cpu_seconds, static_cast<double>(bytes) / 1e6, median_noise(dictionary),
        largest_noise(dictionary));
    if (missing > 0) text += "Put the shards together with --merge before they are used.\n";
    return {json.text(), text};
}

JobResult merge(const DictionaryJob& job) {
    EdgeDictionary all = read_dictionary(job.merge.front());
    for (std::size_t k = 1; k < job.merge.size(); ++k) {
        EdgeDictionary more = read_dictionary(job.merge[k]);
        if (!(more.grid == all.grid) || edge_setup_text(more.setup) != edge_setup_text(all.setup))
            throw InputError(
                fmt::format("{} is of another grid or setup than {}; only shards of one dictionary can be "
                            "put together.",
                            job.merge[k], job.merge.front()));
        for (std::size_t run = 0; run < all.records.size(); ++run)
            if (all.records[run].kernels.empty()) all.records[run] = std::move(more.records[run]);
    }
    io::write_whole_file(job.out, dictionary_bytes(all));
    return result_of(job, all, 0, 0);
}

// Core seconds of a sample of the runs, each with so many paths.
double sampled_seconds(const EdgeSetup& setup, EdgeGrid grid, std::uint32_t paths, Progress& progress) {
    grid.paths = paths;
    const double before = cpu_seconds();
    for (std::size_t run = (estimate_every - 1) / 2 % grid.runs(); run < grid.runs(); run += estimate_every) {
        static_cast<void>(edge_record(setup, grid, run, &progress));
        progress.advance();
    }
    return cpu_seconds() - before;
}

// A run costs what its paths cost, and what solving for its noise costs, which is the same for any number of paths: two
// samples tell both.
JobResult estimate(const DictionaryJob& job, const EdgeSetup& setup, Progress& progress) {
    const EdgeGrid grid = grid_of(job);
    const std::size_t sampled = (grid.runs() + estimate_every - 1) / estimate_every;
    progress.begin_stage("sample", 2 * sampled, "runs");
    const double few = sampled_seconds(setup, grid, few_paths, progress),
                 many = sampled_seconds(setup, grid, many_paths, progress);
    progress.end_stage();
    const double per_path = std::max(0.0, many - few) / (many_paths - few_paths),
                 fixed = std::max(0.0, few - per_path * few_paths);
    const double whole =
        (fixed + per_path * grid.paths) * static_cast<double>(grid.runs()) / static_cast<double>(sampled);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-edge-dictionary-estimate").add("version", 1);
    json.add("runs", grid.runs()).add("sampled", sampled).add("core_seconds", whole).end_object();
    return {json.text(),
            fmt::format("{} runs of {} paths: about {:.0f} core seconds ({:.2f} core hours), from {} runs of "
                        "{} and {} paths\n",
                        grid.runs(), grid.paths, whole, whole / 3600, sampled, few_paths, many_paths)};
}

}  // namespace

void DictionaryJob::validate() const {
    if (out.empty() && !estimate) throw UsageError("--out is missing: the dictionary to write");
    if (shards < 1 || shard < 1 || shard > shards)
        throw UsageError(fmt::format("--shard: {}/{}; expected K/N with K from 1 to N", shard, shards));
    if (merge.empty()) calibration::validate(grid_of(*this));
}

JobResult run_dictionary_job(const DictionaryJob& job, Progress& progress) {
    job.validate();
    const EdgeSetup setup = read_edge_setup(job.setup);
    if (job.estimate) return estimate(job, setup, progress);
    io::expect_outputs({job.out}, job.overwrite);
    if (!job.merge.empty()) return merge(job);
    EdgeDictionary dictionary = begun(job, setup, progress);
    std::vector<std::size_t> todo;
    for (const std::size_t run : missing_runs(dictionary))
        if (run % job.shards == job.shard - 1) todo.push_back(run);
    PartialFile partial(partial_name(job), dictionary);
    const double before = cpu_seconds();
    progress.begin_stage("paths", todo.size(), "runs");
    for (const std::size_t run : todo) {
        dictionary.records[run] = edge_record(setup, dictionary.grid, run, &progress);
        partial.add(run, dictionary.records[run]);
        progress.advance();
    }
    progress.end_stage();
    io::write_whole_file(job.out, dictionary_bytes(dictionary));
    std::error_code ignored;
    fs::remove(partial_name(job), ignored);
    return result_of(job, dictionary, todo.size(), cpu_seconds() - before);
}

}  // namespace voxtone::calibration
