// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shards/merged_stack.h"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <map>
#include <numeric>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "io/disk/disk_space.h"
#include "io/disk/open_file.h"
#include "io/files/whole_file.h"
#include "io/pictures/png_pixels.h"
#include "io/printer/printer_folder.h"
#include "io/shards/shard_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

/// "3,7-9".
std::string ranges_text(const std::vector<std::uint32_t>& numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
        text += text.empty() ? "" : ",";
        text += end - i == 1 ? fmt::format("{}", numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[end - 1]);
        i = end;
    }
    return text;
}

/// How many shards the job was cut into: what most of the records say, of equals the fewest.
std::uint32_t shards_of(const std::vector<ShardNumber>& numbers) {
    std::map<std::uint32_t, std::size_t> count;
    for (const ShardNumber& number : numbers) ++count[number.of];
    const auto whole = std::find_if(count.begin(), count.end(), [](const auto& c) { return c.second == c.first; });
    if (whole != count.end()) return whole->first;
    return std::max_element(count.begin(), count.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
}

std::string again(const ShardRecord& record) {
    return fmt::format("make that shard again: --shard {}, --array={}", shard_text(record.number),
                       record.number.shard - 1 + record.first_task);
}

ShardRecord read_record(const fs::path& out, const ShardNumber& number) {
    const fs::path file = shard_file(out, number);
    try {
        ShardRecord record = read_shard(file);
        if (record.number == number) return record;
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("{}: this record of a shard is broken: remove it and make that shard again "
                        "(--shard {})",
                        error.what(), shard_text(number)));
    }
    throw InputError(fmt::format("{}: is the record of another shard: remove it and make that shard again (--shard {})",
                                 file.string(), shard_text(number)));
}

std::string missing_text(const std::vector<std::uint32_t>& tasks, std::uint32_t of) {
    return fmt::format("{} of {} missing: --array={} makes what is left, then merge again",
                       tasks.size() == 1 ? "one shard" : counted(tasks.size(), "shard"), of, ranges_text(tasks));
}

void expect_all(const fs::path& out, const std::vector<ShardRecord>& records, std::uint32_t of) {
    const std::uint32_t first = records.front().first_task;
    std::vector<std::uint32_t> missing;
    auto record = records.begin();
    for (std::uint32_t shard = 1; shard <= of; ++shard)
        if (record != records.end() && record->number.shard == shard)
            ++record;
        else
            missing.push_back(shard - 1 + first);
    if (missing.empty()) return;
    throw InputError(fmt::format("{}: {}", out.string(), missing_text(missing, of)));
}

void expect_one_job(const fs::path& out, const std::vector<ShardRecord>& records) {
    const ShardRecord& first = records.front();
    for (const ShardRecord& record : records) {
        const auto file = [&](const ShardRecord& of) { return shard_file(out, of.number).filename().string(); };
        if (record.program != first.program)
            throw InputError(fmt::format(
                "{}: {} was made by {} and {} by {}, which may not make the same layers; make the shards of one of "
                "them again",
                shards_folder(out).string(), file(first), first.program, file(record), record.program));
        if (record.job != first.job)
            throw InputError(fmt::format(
                "{}: {} and {} are shards of different jobs (identities {:.12} and {:.12}), whose layers do not go "
                "together; make the shards of one of them again, with --overwrite",
                shards_folder(out).string(), file(first), file(record), first.job, record.job));
        if (record.stack != first.stack || record.resin_bitmaps != first.resin_bitmaps || record.gcvf != first.gcvf ||
            record.png != first.png)
            throw InputError(fmt::format("{}: {} and {} describe different stacks; {}", shards_folder(out).string(),
                                         file(first), file(record), again(record)));
    }
}

void expect_tiles(const fs::path& out, const std::vector<ShardRecord>& records) {
    const StackDescription& stack = records.front().stack;
    std::uint32_t next = stack.first_layer;
    for (const ShardRecord& record : records) {
        if (record.layers == 0) continue;
        if (record.first_layer != next)
            throw InputError(fmt::format("{}: begins with layer {} where layer {} is due; {}",
                                         shard_file(out, record.number).string(), record.first_layer, next,
                                         again(record)));
        next += record.layers;
    }
    if (next != stack.first_layer + stack.layers)
        throw InputError(fmt::format("{}: the shards end before layer {} of {}; make them all again, with --overwrite",
                                     shards_folder(out).string(), next, stack.first_layer + stack.layers));
}

StackDescription laid_together(const std::vector<ShardRecord>& records) {
    WrittenLayers all;
    for (const ShardRecord& record : records) {
        const WrittenLayers& part = record.written;
        all.digests.insert(all.digests.end(), part.digests.begin(), part.digests.end());
        for (std::size_t m = 0; m < all.voxels.size(); ++m) all.voxels[m] += part.voxels[m];
    }
    return with_contents(records.front().stack, all, records.front().resin_bitmaps);
}

std::string text_in(const fs::path& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    std::error_code none;
    if (!fs::is_regular_file(file, none)) return {};
    const auto bytes = read_whole_file(file, most_bytes);
    return {bytes.begin(), bytes.end()};
}

/// Whether the server knows the name, whatever is remembered of its folder here.
bool is_there(const fs::path& file) {
    const OpenFile opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    return opened || (errno != ENOENT && errno != ESTALE);  // what else is wrong is told by who reads it
}

void wait_for_all(const fs::path& out, const KnownShards& known, const Progress* progress) {
    constexpr std::chrono::milliseconds between(200);
    std::vector<std::uint32_t> late(known.count);  // as tasks of an array from 1
    std::iota(late.begin(), late.end(), 1);
    const Stopwatch waited;
    for (;;) {
        std::erase_if(late, [&](std::uint32_t shard) { return is_there(shard_file(out, {shard, known.count})); });
        if (late.empty()) return;
        if (waited.total() > known.patience_s)
            throw TryAgain(
                fmt::format("{}: {}, though all were to be there; it was waited for them, as a network file "
                            "system may tell of them late",
                            out.string(), missing_text(late, known.count)));
        if (progress) progress->check_cancelled();
        std::this_thread::sleep_for(between);
    }
}

/// The numbers of one job's shards, in their order.
std::vector<ShardNumber> numbers_in(const fs::path& out) {
    std::vector<ShardNumber> numbers = shards_in(out);
    if (numbers.empty())
        throw InputError(
            fmt::format("{}: holds no shards; make them with `voxtone slice ... --shard 1/4 -o {}` and "
                        "so on",
                        out.string(), out.string()));
    const std::uint32_t of = shards_of(numbers);
    std::erase_if(numbers, [&](const ShardNumber& number) { return number.of != of; });
    return numbers;
}

std::vector<ShardNumber> numbers_up_to(std::uint32_t of) {
    std::vector<ShardNumber> numbers;
    for (std::uint32_t shard = 1; shard <= of; ++shard) numbers.push_back({shard, of});
    return numbers;
}

}  // namespace

namespace {

/// From what each shard knows of its layers.
TopmostLayers topmost_of(const fs::path& store, const ShardSet& shards) {
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
    TopmostLayers topmost(shards.stack.size_px[0], shards.stack.size_px[1]);
    for (const ShardRecord& record : shards.records) {
        if (record.layers == 0) continue;
        const fs::path file = store / shard_topmost_name(record.number);
        const auto refuse = [&](const char* what) {
            throw InputError(fmt::format("{}: {}; {}", file.string(), what, again(record)));
        };
        if (!fs::exists(file)) refuse("is not there");
        const GreyPicture picture = read_grey_png(read_whole_file(file, most_bytes), file.string());
        if (picture.width_px != shards.stack.size_px[0] || picture.height_px != shards.stack.size_px[1] ||
            topmost_digest(picture.samples) != record.topmost_digest)
            refuse("is not what the shard's record says");
        topmost.raise(picture.samples);
    }
    return topmost;
}

GcvfPreview preview_in(const fs::path& store) {
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 34;
    return {read_whole_file(store / whole_folder_name / preview_mesh_name, most_bytes),
            read_whole_file(store / whole_folder_name / preview_box_name, most_bytes)};
}

fs::path store_of(const fs::path& out, const ShardSet& shards) {
    return shards_folder(out) / shard_store(shards.job());
}

StackOutputs outputs_of(const ShardSet& shards) {
    const ShardRecord& any = shards.records.front();
    return {.resin_bitmaps = any.resin_bitmaps, .gcvf = any.gcvf, .png = any.png};
}

/// What shards know of the whole, which a page was made of.
void remove_whole(const fs::path& store) {
    std::error_code not_empty;
    fs::remove_all(store / whole_folder_name, not_empty);
    fs::remove(store, not_empty);
}

}  // namespace

ShardSet read_shards(const fs::path& out, const KnownShards& known, const Progress* progress) {
    if (known.count > 0) wait_for_all(out, known, progress);
    const std::vector<ShardNumber> numbers = known.count > 0 ? numbers_up_to(known.count) : numbers_in(out);
    const std::uint32_t of = numbers.front().of;
    ShardSet set;
    for (const ShardNumber& number : numbers) set.records.push_back(read_record(out, number));
    expect_one_job(out, set.records);
    expect_all(out, set.records, of);
    expect_tiles(out, set.records);
    set.stack = laid_together(set.records);
    return set;
}

bool is_merged(const fs::path& out, const ShardSet& shards) {
    if (text_in(out / manifest_name) != manifest_text(shards.stack)) return false;
    return std::none_of(shards.records.begin(), shards.records.end(),
                        [&](const ShardRecord& record) { return missing_file(record, out); });
}

void expect_files(const fs::path& out, const ShardSet& shards) {
    const fs::path store = store_of(out, shards);
    for (const ShardRecord& record : shards.records)
        if (const auto missing = missing_file(record, store))
            throw InputError(fmt::format("{}: is not there, or not in the size that {} says; {}",
                                         (store / *missing).string(), shard_file(out, record.number).string(),
                                         again(record)));
}

void merge_shards(StackFolder& folder, const ShardSet& shards, std::string_view job_file,
                  const PageOfStack& how_to_print, Progress* progress) {
    const fs::path out = folder.path(), store = store_of(out, shards);
    const StackOutputs outputs = outputs_of(shards);
    std::optional<TopmostLayers> topmost;
    if (outputs.gcvf || how_to_print) topmost.emplace(topmost_of(store, shards));
    const fs::path unfinished = folder.begin();
    folder.adopt(shard_store(shards.job()));
    if (outputs.gcvf) write_gcvf(unfinished / gcvf_name, shards.stack, store, *topmost, preview_in(store), progress);
    write_stack_texts(unfinished, shards.stack);
    write_staged_file(unfinished / job_file_name, job_file);
    if (how_to_print) {
        std::vector<fs::path> files = printer_files(shards.stack, outputs);
        if (outputs.gcvf) {
            std::erase(files, fs::path(gcvf_name));
            link_files(unfinished, std::array{fs::path(gcvf_name)}, unfinished / printer_folder_name, progress);
        }
        make_printer_folder(store, files, unfinished / printer_folder_name, how_to_print(shards.stack, *topmost),
                            progress);
    }
    folder.publish();
    if (how_to_print) remove_whole(store);
}

bool waits_for_page(const fs::path& out, const ShardSet& shards) {
    std::error_code none;
    return fs::exists(store_of(out, shards) / whole_folder_name, none) && !fs::exists(out / printer_folder_name, none);
}

void add_printer_folder(const StackFolder& folder, const ShardSet& shards, const PageOfStack& how_to_print,
                        const Progress* progress) {
    const fs::path out = folder.path(), store = store_of(out, shards), made = part_path(out / printer_folder_name);
    std::error_code error;
    try {
        make_printer_folder(out, printer_files(shards.stack, outputs_of(shards)), made,
                            how_to_print(shards.stack, topmost_of(store, shards)), progress);
        sync_file_system(made);
        fs::rename(made, out / printer_folder_name, error);
        if (error) fail_to_write(out / printer_folder_name, "could not be written", error.value());
    } catch (...) {
        fs::remove_all(made, error);
        throw;
    }
    remove_whole(store);
}

}  // namespace voxtone::io
