// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/skin_file.h"

#include <fstream>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::size_t layers = 4;

SavedSkin some_skin(std::size_t cells) {
    SavedSkin skin;
    skin.model = "transport";
    skin.seconds = 12.5;
    skin.surface.cell_voxels = {2, 1, 3};
    skin.surface.cells.resize(cells);
    for (std::size_t c = 0; c < cells; ++c) skin.surface.cells[c].cell = {int(c), 1, 2};
    skin.target.assign(cells, Eigen::Vector3f(0.25f, 0.5f, 1));
    skin.cell_um = {84, 84, 81};
    skin.result.state.steps.resize(3);
    skin.result.state.best = 2;
    skin.result.state.open = skin.result.state.shown = skin.target;
    for (std::size_t i = 0; i < 4 * cells; ++i) skin.result.state.white.push_back(0.5f + 0.001f * float(i));
    skin.result.last_look.assign(cells, Eigen::Vector3f(0.5f, 0.25f, 0.75f));
    skin.result.in_gamut.assign(cells, 1);
    skin.result.why_stopped = "it was asked for";
    skin.result.remarks = {"a remark"};
    skin.mixtures.resize(cells * layers);
    for (std::size_t i = 0; i < skin.mixtures.size(); ++i) skin.mixtures[i].bound.fill(std::uint16_t(i));
    return skin;
}

JobLoopOptions until(std::optional<int> iterations, bool patient = false) {
    JobLoopOptions loop;
    loop.iterations = iterations;
    loop.patient = patient;
    return loop;
}

}  // namespace

TEST_CASE("What the loop came to comes back as it was, for its own job alone", "[loop]") {
    const io::TemporaryFolder folder;
    const auto path = folder.path() / "skin.mixtures";
    const SkinFile file(path, "opened", "job", until(8));
    CHECK_FALSE(file.exists());
    CHECK_THROWS_AS(file.read(layers), FileError);
    const SavedSkin skin = some_skin(30);
    file.write(skin);
    const SavedSkin back = file.read(layers);
    CHECK(back.surface.cells[7].cell == skin.surface.cells[7].cell);
    CHECK(back.target == skin.target);
    CHECK(back.result.state.best == 2);
    CHECK(back.result.remarks == skin.result.remarks);
    CHECK(back.result.state.white == skin.result.state.white);
    CHECK(back.result.last_look == skin.result.last_look);
    REQUIRE(back.mixtures.size() == skin.mixtures.size());
    for (std::size_t i = 0; i < skin.mixtures.size(); ++i) CHECK(back.mixtures[i].bound == skin.mixtures[i].bound);
    CHECK(file.is_of_this_job());

    CHECK_THROWS_AS(file.read(layers + 1), FileError);
    for (const SkinFile& other :
         {SkinFile(path, "opened", "job", until(9)), SkinFile(path, "opened", "another", until(8)),
          SkinFile(path, "unopened", "job", until(8))}) {
        CHECK_FALSE(other.is_of_this_job());
        CHECK_THROWS_AS(other.read(layers), InputError);
    }
    CHECK_NOTHROW(SkinFile::expect_same_job(path, "opened", until(8)));
    CHECK_THROWS_AS(SkinFile::expect_same_job(path, "unopened", until(8)), InputError);

    SavedSkin none;
    none.left_out = "There was too little memory.";
    file.write(none);
    CHECK(file.read(layers).left_out == none.left_out);
}

TEST_CASE("A loop that settled is that of auto and of long, one that had to end is not", "[loop]") {
    const io::TemporaryFolder folder;
    const auto path = folder.path() / "skin.mixtures";
    const auto is_of = [&](const JobLoopOptions& loop) {
        const bool is = SkinFile(path, "opened", "job", loop).is_of_this_job();
        if (is)
            CHECK_NOTHROW(SkinFile::expect_same_job(path, "opened", loop));
        else
            CHECK_THROWS_AS(SkinFile::expect_same_job(path, "opened", loop), InputError);
        return is;
    };
    const JobLoopOptions automatic = until(std::nullopt), patient = until(std::nullopt, true);
    SavedSkin skin = some_skin(5);
    for (const bool settles : {true, false}) {
        skin.result.state.steps.resize(std::size_t(halftone::most_iterations) + (settles ? 0 : 1));
        SkinFile(path, "opened", "job", automatic).write(skin);
        CHECK(is_of(automatic));
        CHECK(is_of(patient) == settles);
        SkinFile(path, "opened", "job", patient).write(skin);
        CHECK(is_of(patient));
        CHECK(is_of(automatic) == settles);
        for (const int limit : {halftone::most_iterations - 1, halftone::most_iterations})
            CHECK_FALSE(is_of(until(limit)));
    }
}

TEST_CASE("What a loop came to whose lists do not fit each other is broken, though its sum is right", "[loop]") {
    const io::TemporaryFolder folder;
    const SkinFile file(folder.path() / "skin.mixtures", "opened", "job", until(8));
    const auto is_read = [&](const std::function<void(SavedSkin&)>& change) {
        SavedSkin skin = some_skin(5);
        change(skin);
        file.write(skin);
        try {
            (void)file.read(layers);
            return true;
        } catch (const FileError&) {
            return false;
        }
    };
    CHECK(is_read([](SavedSkin&) {}));
    CHECK(is_read([](SavedSkin& s) { s.mixtures.clear(); }));
    CHECK(is_read([](SavedSkin& s) { s.result.state.white.clear(); }));
    CHECK(is_read([](SavedSkin& s) { s.result.last_look.clear(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.last_look.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.mixtures.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.state.white.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.target.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.state.open.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.state.shown.pop_back(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.in_gamut.push_back(1); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.state.steps.clear(); }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.result.state.best = 3; }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.surface.cell_voxels[1] = 0; }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.surface.cells[2].cell[1] = -1; }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s.surface.cells[2].cell[1] = 1 << 24; }));
    CHECK(is_read([](SavedSkin& s) { s.surface.cells[2].cell[1] = (1 << 24) - 1; }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s = some_skin(0); }));
    // Of a loop that was left out there are neither cells nor mixtures.
    CHECK_FALSE(is_read([](SavedSkin& s) { s.left_out = "too little memory"; }));
    CHECK_FALSE(is_read([](SavedSkin& s) { s = {}, s.left_out = "too little memory", s.mixtures.resize(1); }));
}

TEST_CASE("A skin file that was cut or changed anywhere is refused", "[loop]") {
    const io::TemporaryFolder folder;
    const auto path = folder.path() / "skin.mixtures";
    const SkinFile file(path, "opened", "job", until(8));
    file.write(some_skin(5));
    const std::string bytes = io::text_of(path);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::ofstream(path, std::ios::binary) << bytes.substr(0, at);
        CHECK_THROWS_AS(file.read(layers), Error);
        std::string changed = bytes;
        changed[at] = char(changed[at] ^ 4);
        std::ofstream(path, std::ios::binary) << changed;
        CHECK_THROWS_AS(file.read(layers), Error);
    }
}
