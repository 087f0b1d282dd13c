// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_stack_writer.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <map>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "io/disk/folder_lock.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_digest.h"
#include "io/layers/orient.h"
#include "io/layers/stack_folder.h"
#include "io/layers/stack_reader.h"
#include "io/layers/verify.h"
#include "layer_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr std::array<double, 6> weights = {3, 1, 1, 1, 1, 5};

StackDescription description(std::uint32_t layers) {
    StackDescription stack;
    stack.printer = "stratasys-j750-hm";
    stack.pitch_um = {42.333333, 84.666667, 27};
    stack.size_px = {70, 40};
    stack.layers = layers;
    stack.resins = {{"VeroCyan", "C", {0, 174, 239}},
                    {"VeroMagenta", "M", {236, 0, 140}},
                    {"VeroYellow", "Y", {255, 242, 0}},
                    {"VeroBlack", "K", {40, 40, 40}},
                    {"VeroWhite", "W", {220, 222, 216}}};
    return stack;
}

LayerRuns layer_of(std::uint32_t index) {
    RandomStream random(11, index);
    return random_layer(random, 70, 40, weights, 0.05, 0.3);
}

/// All files but the lock, which says since when it is held.
std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename() != lock_name)
            result[fs::relative(entry.path(), folder).string()] = text_of(entry.path());
    return result;
}

/// The pixels of a layer, row by row.
std::vector<Material> pixels(const LayerRuns& layer) {
    std::vector<Material> result;
    for (std::uint32_t y = 0; y < layer.rows(); ++y)
        for (const Run run : layer.row(y)) result.insert(result.end(), run.length, static_cast<Material>(run.material));
    return result;
}

}  // namespace

TEST_CASE("a stack has its files, counts and digest", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "new" / "stack";
    LayerStackWriter writer(out, description(31));
    CHECK_FALSE(fs::exists(out / "manifest.json"));
    std::array<std::uint64_t, 6> voxels{};
    std::vector<std::uint64_t> digests;
    for (std::uint32_t k = 0; k < 31; ++k) {
        const auto layer = layer_of(k);
        for (const auto m : pixels(layer)) ++voxels[m];
        digests.push_back(layer_digest(layer));
        writer.write(k, layer);
    }
    CHECK_FALSE(fs::exists(out / "manifest.json"));
    const auto& stack = writer.finish();
    CHECK(read_manifest(out / "manifest.json") == stack);
    for (std::size_t r = 0; r < 5; ++r) {
        CHECK(stack.resins[r].voxels == voxels[r + 1]);
        CHECK(stack.resins[r].ml ==
              Approx(static_cast<double>(voxels[r + 1]) * 0.042333333 * 0.084666667 * 0.027 * 1e-3));
    }
    CHECK(stack.content_sha256 == content_sha256(70, 40, digests));
    const auto files = contents(out);
    CHECK(files.size() == 31 + 3);
    CHECK(files.count("layers/slice_00000.png") == 1);
    CHECK(files.count("layers/slice_00030.png") == 1);
    CHECK_THAT(files.at("resin-assignment.txt"), Contains("VeroYellow") && Contains("255 242 0"));
    CHECK_THAT(files.at("resin-assignment.html"), Contains("#fff200"));
}

TEST_CASE("the same bytes in any order and for any number of threads", "[stack]") {
    TemporaryFolder folder;
    auto run = [&](const std::string& name, std::size_t threads, bool backwards) {
        const ThreadLimit limit(threads);
        LayerStackWriter writer(folder.path() / name, description(40));
        parallel_for(0, 40, 1, [&](std::size_t i) {
            const auto k = static_cast<std::uint32_t>(backwards ? 39 - i : i);
            writer.write(k, layer_of(k));
        });
        (void)writer.finish();
        return contents(folder.path() / name);
    };
    const auto one = run("one", 1, false);
    CHECK(run("two", 2, false) == one);
    CHECK(run("back", 2, true) == one);
}

TEST_CASE("parts of a stack lie together like the whole", "[stack]") {
    TemporaryFolder folder;
    auto whole = description(40);
    LayerStackWriter all(folder.path() / "all", whole);
    for (std::uint32_t k = 0; k < 40; ++k) all.write(k, layer_of(k));
    (void)all.finish();
    auto part = description(15);
    part.first_layer = 25;
    LayerStackWriter some(folder.path() / "some", part);
    for (std::uint32_t k = 0; k < 15; ++k) some.write(k, layer_of(25 + k));
    (void)some.finish();
    const auto files = contents(folder.path() / "all"), part_files = contents(folder.path() / "some");
    for (std::uint32_t k = 25; k < 40; ++k) {
        const auto name = whole.layer_path(k);
        CHECK(part_files.at(name) == files.at(name));
    }
}

TEST_CASE("a folder with other things in it is left alone", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "photos";
    fs::create_directory(out);
    write_whole_file(out / "holiday.png", std::string_view("precious"));
    CHECK_THROWS_AS(LayerStackWriter(out, description(1)), InputError);
    CHECK(contents(out).size() == 1);
    // A manifest.json of somebody else does not make it ours.
    write_whole_file(out / "manifest.json", std::string_view("{\"name\": \"a web app\"}"));
    CHECK_THROWS_AS(LayerStackWriter(out, description(1)), InputError);
    CHECK(contents(out).at("manifest.json") == "{\"name\": \"a web app\"}");
    {
        LayerStackWriter writer(out, description(1), {}, true);
        writer.write(0, layer_of(0));
        (void)writer.finish();
    }
    CHECK(contents(out).at("holiday.png") == "precious");
    CHECK_THROWS_AS(LayerStackWriter(out / "holiday.png", description(1)), FileError);
}

TEST_CASE("an old stack stays whole until the new one is", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    const auto make = [&](std::uint32_t layers, bool overwrite) {
        LayerStackWriter writer(out, description(layers), {}, overwrite);
        for (std::uint32_t k = 0; k < layers; ++k) writer.write(k, layer_of(k));
        (void)writer.finish();
    };
    make(50, false);
    write_whole_file(out / "notes.txt", std::string_view("mine"));
    write_whole_file(out / "layers" / "remarks.txt", std::string_view("mine too"));
    const auto before = contents(out);
    CHECK_THROWS_WITH(make(31, false), Contains("a stack of 50 layers") && Contains("--overwrite"));
    {
        LayerStackWriter stopped(out, description(31), {}, true);
        for (std::uint32_t k = 0; k < 31; ++k) stopped.write(k, layer_of(k));
        CHECK(read_manifest(out / "manifest.json").layers == 50);
    }
    CHECK(contents(out) == before);
    make(31, true);
    const auto files = contents(out);
    CHECK(files.size() == 31 + 3 + 2);
    CHECK(files.at("notes.txt") == "mine");
    CHECK(files.at("set-aside/layers/remarks.txt") == "mine too");
}

TEST_CASE("a folder that a job made and left without a stack goes again", "[stack]") {
    TemporaryFolder folder;
    { const LayerStackWriter writer(folder.path() / "new" / "stack", description(1)); }
    CHECK_FALSE(fs::exists(folder.path() / "new"));
}

TEST_CASE("a stranger among the layers of an old stack is set aside, and the new stack is good", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    const auto make = [&](bool overwrite) {
        LayerStackWriter writer(out, description(31), {}, overwrite);
        const std::string note = writer.strangers_note();
        for (std::uint32_t k = 0; k < 31; ++k) writer.write(k, layer_of(k));
        (void)writer.finish();
        return note;
    };
    CHECK(make(false).empty());
    for (const char* text : {"first", "second"}) {
        write_whole_file(out / "layers" / "photo.png", std::string_view(text));
        fs::create_directory(out / "layers" / "more");
        write_whole_file(out / "layers" / "more" / "notes.txt", std::string_view("mine"));
        CHECK_THAT(make(true), Contains("layers") && Contains("and 1 more are no layer") && Contains("set-aside"));
        CHECK(verify_stack(out).faults.empty());
    }
    const auto files = contents(out);
    CHECK(files.at("set-aside/layers/photo.png") == "first");
    CHECK(files.at("set-aside/layers/photo-2.png") == "second");
    CHECK(files.at("set-aside/layers/more/notes.txt") == "mine");
    CHECK(make(true).empty());
}

TEST_CASE("a second job hears who holds the folder", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    std::ofstream(folder.path() / "file") << "no folder";
    CHECK_THROWS_WITH(StackFolder(folder.path() / "file" / "out"),
                      Contains("made ready") && Contains("directory") && !Contains("filesystem error"));
    const StackFolder first(out);
    const std::string who = fmt::format("host {}, process {}", host_name(), getpid());
    CHECK_THROWS_AS(StackFolder(out), TryAgain);
    CHECK_THROWS_WITH(StackFolder(out), Contains(who) && Contains("since 20"));
}

TEST_CASE("a job that was killed in the swap is brought to an end by the next", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    const auto make = [&](const fs::path& where, std::uint32_t layers) {
        LayerStackWriter writer(where, description(layers));
        for (std::uint32_t k = 0; k < layers; ++k) writer.write(k, layer_of(k));
        (void)writer.finish();
    };
    make(out, 40);
    const auto before = contents(out);
    fs::create_directory(out / ".voxtone-old");
    SECTION("before the new stack was ready to move: back") {
        make(out / ".voxtone-unfinished", 31);
        fs::rename(out / "manifest.json", out / ".voxtone-old" / "manifest.json");
        fs::rename(out / "layers", out / ".voxtone-old" / "layers");
        { const StackFolder next(out); }
        CHECK(contents(out) == before);
    }
    SECTION("after: forward") {
        make(folder.path() / "new", 31);
        const auto wanted = contents(folder.path() / "new");
        for (const char* name : {"manifest.json", "layers", "resin-assignment.txt", "resin-assignment.html"})
            fs::rename(out / name, out / ".voxtone-old" / name);
        fs::rename(folder.path() / "new", out / ".voxtone-new");
        fs::rename(out / ".voxtone-new" / "layers", out / "layers");  // as far as it came
        CHECK_THROWS_AS(StackReader(out), InputError);
        { const StackFolder next(out); }
        CHECK(contents(out) == wanted);
    }
    SECTION("with the new stack in place, and the old one half removed: forward") {
        make(folder.path() / "older", 31);
        fs::rename(folder.path() / "older" / "layers", out / ".voxtone-old" / "layers");
        fs::create_directory(out / ".voxtone-new");
        { const StackFolder next(out); }
        CHECK(contents(out) == before);
    }
}

TEST_CASE("what a killed job left is swept by the next", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    fs::create_directories(out / ".voxtone-unfinished" / "layers");
    write_whole_file(out / ".voxtone-unfinished" / "layers" / "slice_00000.png", std::string_view("half"));
    write_whole_file(out / ".voxtone-lock", std::string_view("elsewhere 1 1 2020-01-01T00:00:00Z\n"));
    write_staged_file(part_path(out / "loop.checkpoint"), std::string_view("half"));
    LayerStackWriter writer(out, description(1));
    writer.write(0, layer_of(0));
    (void)writer.finish();
    CHECK(contents(out).size() == 1 + 3);
}

TEST_CASE("nothing is written through a link that leads outside", "[stack]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    fs::create_directory(folder.path() / "elsewhere");
    {
        LayerStackWriter writer(out, description(1));
        writer.write(0, layer_of(0));
        (void)writer.finish();
    }
    fs::remove_all(out / "layers");
    fs::create_directory_symlink(folder.path() / "elsewhere", out / "layers");
    CHECK_THROWS_AS(LayerStackWriter(out, description(1), {}, true), FileError);
    CHECK(contents(folder.path() / "elsewhere").empty());
}

TEST_CASE("no result comes to lie among the layers of a stack", "[stack]") {
    const TemporaryFolder folder;
    const fs::path own = folder.path() / "own", foreign = folder.path() / "theirs";
    fs::create_directories(own / "layers");
    fs::create_directories(own / "printer");
    fs::create_directories(foreign);
    for (const fs::path& stack : {own, own / "manifest.json"}) {
        CHECK_NOTHROW(expect_apart_from_layers(stack, {own / "seen.png", folder.path() / "seen.png", "seen.png"}));
        for (const fs::path& within : {own / "layers", own / "printer", own / "layers" / "." / ".." / "layers"})
            CHECK_THROWS_WITH(expect_apart_from_layers(stack, {folder.path() / "a.png", within / "slice_00000.png"}),
                              Contains("among the layers of") && Contains("slice_00000.png"));
    }
    CHECK_THROWS_WITH(expect_apart_from_layers(foreign, {foreign / "seen.png"}), Contains("name another folder"));
    CHECK_NOTHROW(expect_apart_from_layers(foreign, {own / "seen.png"}));
    CHECK_NOTHROW(expect_apart_from_layers(folder.path() / "a.gcvf", {folder.path() / "seen.png"}));
}

TEST_CASE("a stack that lacks a layer is not finished", "[stack]") {
    TemporaryFolder folder;
    LayerStackWriter writer(folder.path() / "stack", description(3));
    writer.write(0, layer_of(0));
    writer.write(2, layer_of(2));
    CHECK_THROWS_AS((void)writer.finish(), ContractViolation);
    CHECK_THROWS_AS(writer.write(2, layer_of(2)), ContractViolation);
    CHECK_FALSE(fs::exists(folder.path() / "stack" / "manifest.json"));
}

TEST_CASE("mirrors and the swap, pixel by pixel", "[orient]") {
    for (std::uint64_t i = 0; i < 40; ++i) {
        RandomStream random(12, i);
        const std::uint32_t w = 1 + draw(random, 200), h = 1 + draw(random, 90);
        const auto layer = random_layer(random, w, h, weights, 0.05, 0.3);
        const auto plain = pixels(layer);
        for (int bits = 0; bits < 8; ++bits) {
            const Orientation o{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
            const auto turned = oriented(layer, o);
            const std::uint32_t w2 = o.swap_xy ? h : w, h2 = o.swap_xy ? w : h;
            REQUIRE(turned.width_px() == w2);
            REQUIRE(turned.height_px() == h2);
            const auto result = pixels(turned);
            for (std::uint32_t y = 0; y < h2; ++y)
                for (std::uint32_t x = 0; x < w2; ++x) {
                    const std::uint32_t u = o.flip_x ? w2 - 1 - x : x, v = o.flip_y ? h2 - 1 - y : y;
                    if (result[y * w2 + x] != plain[o.swap_xy ? u * w + v : v * w + u])
                        FAIL("layer " << i << " bits " << bits);
                }
        }
    }
}

TEST_CASE("a swapped stack says its size and pitch as they lie", "[orient]") {
    TemporaryFolder folder;
    auto sliced = description(1);
    sliced.orientation.swap_xy = true;
    LayerStackWriter writer(folder.path() / "stack", sliced);
    writer.write(0, layer_of(0));
    const auto& stack = writer.finish();
    CHECK(stack.size_px == std::array<std::uint32_t, 2>{40, 70});
    CHECK(stack.pitch_um[0] == 84.666667);
    CHECK(stack.size_mm[0] == Approx(40 * 0.084666667));
}
