// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/io/files/temporary_folder.h"
#include "voxtone/base/error.h"
#include "voxtone/slicer/job/loop_checkpoint.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

halftone::LoopState some_state(std::size_t cells) {
    halftone::LoopState state;
    state.steps.resize(3);
    state.steps[1].seen.mean = 1.25;
    state.best = 1;
    for (auto* list : {&state.control, &state.open, &state.shown, &state.start_control})
        for (std::size_t i = 0; i < cells; ++i) list->push_back(Eigen::Vector3f(float(i), 0.5f, -1));
    state.best_mixtures = halftone::SkinMixtures(cells, 4, 5);
    for (std::size_t at = 0; at < state.best_mixtures.all().size(); at += 5) state.best_mixtures.all()[at] = 0.25f;
    for (std::size_t at = 2; at < state.best_mixtures.all().size(); at += 5) state.best_mixtures.all()[at] = 0.75f;
    state.descent = halftone::begin_descent(state.best_mixtures, {});
    state.descent.momentum[3] = 0.125f;
    state.recent = state.best_mixtures;
    state.recent.all()[2] = 0.375f;
    state.descent.shared.assign(state.descent.momentum.size(), 0.25f);
    state.descent.divisor.assign(cells, 2.5f);
    state.descent.fall.assign(6 * cells, 1.5f);  // five resins and the own part
    state.descent.rate[1] = 0.125f;
    return state;
}

}  // namespace

TEST_CASE("A loop's state comes back as it was", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const SliceOptions options;
    const LoopCheckpoint checkpoint(folder.path(), options, target);
    Progress quiet;
    CHECK_FALSE(checkpoint.read(quiet));
    const halftone::LoopState state = some_state(6);
    checkpoint.write(state);
    const auto back = checkpoint.read(quiet);
    REQUIRE(back);
    CHECK(back->best == 1);
    CHECK(back->steps[1].seen.mean == 1.25);
    CHECK(back->control == state.control);
    CHECK(back->start_control == state.start_control);
    CHECK(std::ranges::equal(back->best_mixtures.all(), state.best_mixtures.all()));
    CHECK(std::ranges::equal(back->descent.mixtures.all(), state.descent.mixtures.all()));
    CHECK(std::ranges::equal(back->recent.all(), state.recent.all()));
    CHECK(back->descent.momentum == state.descent.momentum);
    CHECK(back->descent.shared == state.descent.shared);
    CHECK(back->descent.divisor == state.descent.divisor);
    CHECK(back->descent.fall == state.descent.fall);
    CHECK(back->descent.rate == state.descent.rate);
    CHECK_FALSE(std::filesystem::exists(folder.path() / ".loop.checkpoint.part"));
    checkpoint.remove();
    CHECK_FALSE(checkpoint.read(quiet));
}

TEST_CASE("A state of another job or a broken file is refused; free options do not matter", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    Progress quiet;
    SliceOptions options;
    LoopCheckpoint(folder.path(), options, target).write(some_state(6));

    SliceOptions other = options;
    other.threads = 3;
    other.iterations.assign(1, '9');  // a literal here trips a warning of GCC 12
    other.resume = true;
    CHECK(LoopCheckpoint(folder.path(), other, target).read(quiet));
    other.depth_mm = 0.5;
    CHECK_THROWS_AS(LoopCheckpoint(folder.path(), other, target).read(quiet), InputError);
    auto moved = target;
    moved[2].x() = 0.25f;
    CHECK_THROWS_AS(LoopCheckpoint(folder.path(), options, moved).read(quiet), InputError);

    // Cut anywhere, or with one byte changed, it is no checkpoint.
    const std::filesystem::path file = folder.path() / "loop.checkpoint";
    const auto size = std::filesystem::file_size(file);
    std::string bytes(size, '\0');
    std::ifstream(file, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(size));
    const auto write = [&](const std::string& content) {
        std::ofstream(file, std::ios::binary | std::ios::trunc)
            .write(content.data(), static_cast<std::streamsize>(content.size()));
    };
    for (std::size_t cut = 0; cut < size; cut += 37) {
        write(std::string(bytes.data(), cut));
        CHECK_THROWS_AS(LoopCheckpoint(folder.path(), options, target).read(quiet), FileError);
    }
    for (std::size_t at = 0; at < size; at += 101) {
        std::string spoiled = bytes;
        spoiled[at] = static_cast<char>(spoiled[at] ^ 0x40);
        write(spoiled);
        CHECK_THROWS(LoopCheckpoint(folder.path(), options, target).read(quiet));
    }
    std::string older = bytes;
    older.replace(0, 15, "voxtone-loop 5\n");
    write(older);
    CHECK_THROWS_WITH(LoopCheckpoint(folder.path(), options, target).read(quiet),
                      Catch::Contains("another version of this program; remove it and start without --resume"));
}
