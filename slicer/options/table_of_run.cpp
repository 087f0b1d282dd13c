// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_run.h"

#include <algorithm>
#include <cmath>

#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Job = ResolvedJob;

constexpr double gib = 1 << 30;

std::vector<OptionSpec> reading_entries() {
    const std::string group = "Limits of reading";
    return {
        {.key = "read-memory",
         .metavar = "GIB",
         .group = group,
         .help = "most memory for the program that reads the model and its pictures; 0: half of the machine's, 8 at "
                 "most",
         .member = &O::read_memory_gib,
         .decides = Decides::work,
         .rule =
             [](const O& o) {
                 return unless(o.read_memory_gib >= 0 && o.read_memory_gib <= 1e6,
                               "must be above 0 GiB, or 0 for half of the machine's");
             },
         .resolve =
             [](const O& o, Job& job) {
                 if (o.read_memory_gib > 0)
                     job.reading.memory_bytes = static_cast<std::uint64_t>(o.read_memory_gib * gib);
                 job.reading.more = "--read-memory, --read-time";
             }},
        plain(&O::read_time_s, at(&Job::reading, &io::ReadOptions::timeout_s),
              {.key = "read-time",
               .metavar = "S",
               .group = group,
               .help = "most time of the processor for it, s",
               .decides = Decides::work,
               .rule =
                   [](const O& o) {
                       return unless(o.read_time_s > 0 && o.read_time_s <= 1e6, "must be above 0 and at most 1e6 s");
                   }}),
        {.key = "read-size",
         .metavar = "GIB",
         .group = group,
         .help = "largest file that is read; also what all parts of a 3MF or FBX may unpack to",
         .member = &O::read_size_gib,
         .decides = Decides::work,
         .rule =
             [](const O& o) {
                 return unless(o.read_size_gib > 0 && o.read_size_gib <= 1024, "must be above 0 and at most 1024 GiB");
             },
         .resolve =
             [](const O& o, Job& job) {
                 job.reading.max_file_bytes = job.reading.max_unpacked_bytes =
                     static_cast<std::uint64_t>(o.read_size_gib * gib);
             }},
        {.key = "read-pixels",
         .metavar = "MP",
         .group = group,
         .help = "largest picture or texture, million pixels; 268.4 are 16384 x 16384",
         .member = &O::read_megapixels,
         .decides = Decides::work,
         .rule =
             [](const O& o) {
                 return unless(o.read_megapixels > 0 && o.read_megapixels <= 4294,
                               "must be above 0 and at most 4294 million");
             },
         .resolve =
             [](const O& o, Job& job) {
                 job.reading.max_pixels =
                     static_cast<std::uint64_t>(std::max(1.0, std::round(o.read_megapixels * 1e6)));
             }},
    };
}

constexpr std::string_view sliced_whole = "only goes with --show colour: other prints are sliced whole";

std::vector<OptionSpec> parts_entries() {
    const std::string group = "Run";
    return {
        {.key = "shard",
         .metavar = "I/N",
         .group = group,
         .help = "make part I of N of the layers, 1 to N, cut by equal work; `voxtone merge OUT` lays them together; "
                 "auto or no value: as SLURM_ARRAY_TASK_ID, _MIN and _COUNT say; empty: all",
         .bare = "auto",
         .member = &O::shard,
         .decides = Decides::this_run,
         .rule =
             [](const O& o) {
                 if (!o.shard.empty() && !shows_colours(o)) return sliced_whole;
                 return unless(o.shard.empty() || o.until == name_of(Until::end),
                               "a shard makes layers, and --until loop none");
             },
         .resolve =
             [](const O& o, Job& job) {
                 job.sharded = !o.shard.empty();
                 job.shard = parse_shard(o.shard);
             }},
        choice(
            &O::until, at(&Job::until),
            {.key = "until",
             .metavar = "WHERE",
             .group = group,
             .help = "loop: stop after the appearance loop and keep what it came to in OUT/skin.mixtures (or "
                     "--mixtures FILE), for shards and other jobs of the body; end: go on to the end",
             .decides = Decides::this_run,
             .rule =
                 [](const O& o) { return unless(shows_colours(o) || o.until == name_of(Until::end), sliced_whole); }}),
    };
}

std::vector<OptionSpec> machine_entries() {
    const std::string group = "Run";
    return {
        plain(&O::strict, at(&Job::strict),
              {.key = "strict",
               .group = group,
               .help = "do not print what needs a look first: stop with exit code 3 where colours of the model are "
                       "lost, or where it would come out all white though it has colours; leave with exit code 6 where "
                       "the finished print will not look as asked (--verdict-bad)",
               .decides = Decides::work}),
        {.key = "memory",
         .metavar = "GIB",
         .group = "Prediction",
         .help =
             "most memory for the loop and the prediction; what of a loop does not fit waits on disk, one that needs "
             "more all the same ends the job, a prediction is left out; decides no bit; 0: half of the machine's",
         .member = &O::memory_gib,
         .decides = Decides::work,
         .rule =
             [](const O& o) {
                 return unless(o.memory_gib >= 0 && o.memory_gib <= most_memory_gib,
                               "must be above 0 GiB, or 0 for half of the machine's");
             },
         .resolve = [](const O& o, Job& job) { job.prediction.memory_bytes = memory_budget(o.memory_gib); }},
        plain(&O::threads, at(&Job::threads),
              {.key = "threads",
               .metavar = "N",
               .group = group,
               .help = "threads; 0: one per core. The result does not depend on it",
               .decides = Decides::this_run,
               .rule = [](const O& o) { return unless(o.threads >= 0 && o.threads <= 1024, "must be 0 to 1024"); }}),
        plain(&O::seed, at(&Job::seed),
              {.key = "seed",
               .metavar = "N",
               .group = group,
               .help = "seed of what is random: --screen error-diffusion, --predict monte-carlo, other prints than of "
                       "colours (--show)",
               .idle = {[](const O& o, bool) {
                   const bool by_chance = !shows_colours(o) || o.screen == name_of(ScreenKind::error_diffusion) ||
                                          o.predict == name_of(PredictionModel::monte_carlo);
                   return unless(by_chance,
                                 "nothing is random with --screen blue-noise, unless --predict is monte-carlo: leave "
                                 "it out");
               }}}),
    };
}

}  // namespace

std::vector<OptionSpec> table_of_run() {
    std::vector<OptionSpec> table;
    for (const std::vector<OptionSpec>& part : {reading_entries(), parts_entries(), machine_entries()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

}  // namespace voxtone::slicer
