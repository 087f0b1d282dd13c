// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shards/merged_stack.h"

#include <fstream>
#include <map>
#include <thread>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/shards/shard_folder.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/io/layers/stack_samples.h"

using namespace voxtone;
using namespace voxtone::io;
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t all_layers = 9;
const std::string a_job(64, 'a');

ShardRecord make_shard(const fs::path& out, const ShardNumber& number, std::uint32_t first, std::uint32_t layers,
                       const std::string& program = "voxtone test") {
    ShardRecord record;
    record.number = number;
    record.program = program;
    record.job = a_job;
    record.host = "here";
    record.stack = as_written(sample_description(all_layers));
    record.resin_bitmaps = ResinBitmaps::png1;
    record.first_layer = first;
    record.layers = layers;
    ShardFolder folder(out, number);
    if (layers > 0) {
        StackDescription part = record.stack;
        part.first_layer = first;
        part.layers = layers;
        LayerFiles files(folder.staging(), part, record.resin_bitmaps);
        for (std::uint32_t k = 0; k < layers; ++k) files.write(k, sample_layer(first + k));
        record.written = files.written();
    }
    folder.claim("{}\n");
    folder.publish(record);
    return record;
}

void make_three(const fs::path& out) {
    make_shard(out, {3, 3}, 4, 5);
    make_shard(out, {1, 3}, 0, 4);
    make_shard(out, {2, 3}, 4, 0);
}

void merge(const fs::path& out) {
    const ShardSet shards = read_shards(out);
    expect_files(out, shards);
    StackFolder folder(out, {job_file_name});
    merge_shards(folder, shards, "{}\n");
}

/// What is published, without the records.
std::map<std::string, std::string> tree(const fs::path& out) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(out))
        if (const std::string name = fs::relative(entry.path(), out).string();
            entry.is_regular_file() && !name.starts_with("shards") && name != job_file_name)
            files[name] = text_of(entry.path());
    return files;
}

}  // namespace

TEST_CASE("Shards laid together are the stack that one writer makes", "[shards]") {
    const TemporaryFolder folder;
    StackOutputs outputs;
    outputs.resin_bitmaps = ResinBitmaps::png1;
    (void)write_sample_stack(folder.path() / "whole", all_layers, outputs);
    const fs::path out = folder.path() / "out";
    make_three(out);
    CHECK_FALSE(is_merged(out, read_shards(out)));
    merge(out);
    CHECK(tree(out) == tree(folder.path() / "whole"));
    CHECK(is_merged(out, read_shards(out)));
    fs::resize_file(out / "layers/slice_00003.png", 5);
    CHECK_FALSE(is_merged(out, read_shards(out)));
}

TEST_CASE("Shards of two builds of the program are not laid together", "[shards]") {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    make_shard(out, {1, 2}, 0, 4);
    make_shard(out, {2, 2}, 4, 5, "voxtone other");
    CHECK_THROWS_WITH(read_shards(out), Catch::Contains("voxtone test") && Catch::Contains("voxtone other"));
}

TEST_CASE("A merge that was killed in the swap is brought to an end, or undone, by who comes next", "[shards]") {
    const TemporaryFolder folder;
    StackOutputs outputs;
    outputs.resin_bitmaps = ResinBitmaps::png1;
    (void)write_sample_stack(folder.path() / "whole", all_layers, outputs);
    const auto whole = tree(folder.path() / "whole");
    const std::string store = "shards/" + shard_store(a_job);
    // How far it came: made what is new; and put it aside; and moved the layers; and one more.
    for (int step = 0; step < 4; ++step) {
        INFO(step);
        const fs::path out = folder.path() / std::to_string(step);
        make_three(out);
        const ShardSet shards = read_shards(out);
        {
            StackFolder held(out);
            const fs::path unfinished = held.begin();
            held.adopt(shard_store(a_job));
            write_stack_texts(unfinished, shards.stack);
            if (step > 0) fs::rename(unfinished, out / new_name);
            if (step > 1) fs::rename(out / store / "layers", out / "layers");
            if (step > 2) fs::rename(out / new_name / sheet_text_name, out / sheet_text_name);
        }
        StackFolder next(out);
        CHECK_FALSE(fs::exists(out / new_name));
        CHECK(next.holds_stack() == (step > 0));
        if (step == 0) {
            expect_files(out, shards);
            merge_shards(next, shards, "{}\n");
        }
        CHECK(tree(out).size() >= whole.size());
        for (const auto& [name, bytes] : whole) CHECK(tree(out)[name] == bytes);
    }
}

TEST_CASE("A record of a shard of a large print, whose viewer's layers fill 70 MiB, is read again", "[shards]") {
    const TemporaryFolder folder;
    ShardRecord record = make_shard(folder.path(), {1, 2}, 0, 4);
    record.viewer.whole.push_back({2, std::vector<std::byte>(std::size_t{53} << 20, std::byte{'x'})});
    const fs::path file = shard_file(folder.path(), record.number);
    std::ofstream(file, std::ios::trunc) << shard_json(record);
    REQUIRE(fs::file_size(file) > JsonObject::usual_bytes);
    const ShardRecord again = read_shard(file);
    REQUIRE(again.viewer.whole.size() == 1);
    CHECK(again.viewer.whole[0].deflated == record.viewer.whole[0].deflated);
}

TEST_CASE("A record is what it was, and tells whether it was changed", "[shards]") {
    const TemporaryFolder folder;
    const ShardRecord record = make_shard(folder.path(), {2, 12}, 4, 3);
    const fs::path file = shard_file(folder.path(), record.number);
    CHECK(file.filename() == "0002-of-0012.json");
    const std::string text = text_of(file);
    CHECK(shard_json(read_shard(file)) == text);
    // Every cut and a change of any number is seen.
    for (std::size_t size = 0; size < text.size() - 2; size += 17) {
        std::ofstream(file, std::ios::trunc) << text.substr(0, size);
        CHECK_THROWS_AS(read_shard(file), InputError);
    }
    for (std::size_t at = text.find("\"digests\""); at < text.find("\"figures\""); ++at)
        if (text[at] >= '0' && text[at] <= '9') {
            std::string changed = text;
            changed[at] = text[at] == '7' ? '8' : '7';
            std::ofstream(file, std::ios::trunc) << changed;
            CHECK_THROWS_AS(read_shard(file), InputError);
        }
}

TEST_CASE("What is missing is named as a scheduler takes it", "[shards]") {
    const TemporaryFolder folder;
    for (const std::uint32_t i : {1u, 2u, 4u, 5u, 6u, 10u}) make_shard(folder.path(), {i, 10}, i - 1, 1);
    CHECK_THROWS_WITH(read_shards(folder.path()), Catch::Matchers::Contains("4 shards of 10 missing: --array=3,7-9 "));
}

TEST_CASE("Ranges that leave a gap or lie over one another are refused", "[shards]") {
    for (const std::uint32_t second : {3u, 5u}) {
        const TemporaryFolder folder;
        make_shard(folder.path(), {1, 2}, 0, 4);
        make_shard(folder.path(), {2, 2}, second, all_layers - second);
        CHECK_THROWS_WITH(read_shards(folder.path()), Catch::Matchers::Contains("where layer 4 is due"));
    }
    const TemporaryFolder folder;
    make_shard(folder.path(), {1, 1}, 0, 4);
    CHECK_THROWS_WITH(read_shards(folder.path()), Catch::Matchers::Contains("the shards end before layer"));
}

TEST_CASE("Where the number of shards is known each is asked for by name, and a late one is waited for", "[shards]") {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "out", late = shard_file(out, {2, 3});
    make_three(out);
    fs::rename(late, folder.path() / "late.json");
    CHECK_THROWS_AS(read_shards(out), InputError);
    try {
        (void)read_shards(out, {3, 0});
        FAIL("it was not missed");
    } catch (const TryAgain& error) {
        CHECK_THAT(error.what(), Catch::Contains("--array=2 ") && Catch::Contains("late"));
    }
    constexpr double long_s = 300;
    std::thread maker([&] { fs::rename(folder.path() / "late.json", late); });
    const ShardSet shards = read_shards(out, {3, long_s});
    maker.join();
    CHECK(shards.records.size() == 3);
    // Nobody is asked to wait who was asked to stop.
    fs::remove(late);
    Progress stopped;
    stopped.cancel();
    CHECK_THROWS_AS(read_shards(out, {3, long_s}, &stopped), Cancelled);
    // Records of another cut are none of these.
    CHECK_THROWS_AS(read_shards(out, {4, 0}), TryAgain);
}
