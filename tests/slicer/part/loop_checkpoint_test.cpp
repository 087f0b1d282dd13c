// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "slicer/part/loop_checkpoint.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

halftone::LoopState some_state(std::size_t cells) {
    halftone::LoopState state;
    state.steps.resize(3);
    state.steps[1].method = halftone::LoopMethod::descent;
    state.steps[1].seen.mean = 1.25;
    state.white.assign(3 * cells, 0.875f);
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
    state.descent.decrease.assign(6 * cells, 1.5f);  // five resins and the own part
    state.descent.rate[1] = 0.125f;
    state.urgency = {1, 2.25f};
    state.saturated_share = 0.125;
    state.has_gradient = false;
    return state;
}

/// A sequence that keeps so many bytes from prediction to prediction.
class Keeps final : public optics::AppearanceSequence {
public:
    explicit Keeps(std::size_t bytes = 5) : kept(bytes, std::byte{7}) {}
    [[nodiscard]] optics::Appearance next(const optics::ResinVolume&, const Progress*) override { return {}; }
    void write_state(const StateSink& sink) const override { sink(kept); }
    std::vector<std::byte> kept;
};

void save(const LoopCheckpoint& checkpoint, const halftone::LoopState& state) { checkpoint.write(state, Keeps()); }

const std::string a_job(64, 'a'), another_job(64, 'b'), opened_job(64, 'c');

}  // namespace

TEST_CASE("A loop's state comes back as it was", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path(), opened_job, a_job, target);
    Progress quiet;
    CHECK_FALSE(checkpoint.read(quiet));
    const halftone::LoopState state = some_state(6);
    save(checkpoint, state);
    const auto loop = checkpoint.read(quiet);
    REQUIRE(loop);
    CHECK(loop->sequence == Keeps().kept);
    const halftone::LoopState* const back = &loop->state;
    CHECK(back->saturated_share == 0.125);
    CHECK_FALSE(back->has_gradient);
    CHECK(back->best == 1);
    CHECK(back->steps[1].seen.mean == 1.25);
    CHECK(back->white == state.white);
    CHECK(back->control == state.control);
    CHECK(back->start_control == state.start_control);
    CHECK(std::ranges::equal(back->best_mixtures.all(), state.best_mixtures.all()));
    CHECK(std::ranges::equal(back->descent.mixtures.all(), state.descent.mixtures.all()));
    CHECK(std::ranges::equal(back->recent.all(), state.recent.all()));
    CHECK(back->descent.momentum == state.descent.momentum);
    CHECK(back->descent.shared == state.descent.shared);
    CHECK(back->descent.divisor == state.descent.divisor);
    CHECK(back->descent.decrease == state.descent.decrease);
    CHECK(back->descent.rate == state.descent.rate);
    CHECK_FALSE(std::filesystem::exists(folder.path() / ".loop.checkpoint.part"));
    LoopCheckpoint::remove_from(folder.path());
    CHECK_FALSE(checkpoint.read(quiet));
}

TEST_CASE("How far a saved loop is can be told from its file's beginning, whosever it is", "[loop]") {
    const io::TemporaryFolder folder;
    CHECK(LoopCheckpoint::saved_steps(folder.path()) == 0);
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path(), opened_job, a_job, target);
    halftone::LoopState state = some_state(6);
    save(checkpoint, state);
    CHECK(LoopCheckpoint::saved_steps(folder.path()) == 3);
    state.steps.resize(7);
    save(checkpoint, state);
    CHECK(LoopCheckpoint::saved_steps(folder.path()) == 7);
    CHECK(LoopCheckpoint::advice(folder.path()).find(checkpoint.file().string()) != std::string::npos);
    std::ofstream(checkpoint.file()) << "voxtone-loop 1\n" << std::string(100, 'x');
    CHECK(LoopCheckpoint::saved_steps(folder.path()) == 0);
    std::ofstream(checkpoint.file()) << "short";
    CHECK(LoopCheckpoint::saved_steps(folder.path()) == 0);
}

TEST_CASE("A state that cannot be written is an error", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    CHECK_THROWS_AS(
        LoopCheckpoint(folder.path() / "not-there", opened_job, a_job, target).write(some_state(6), Keeps()),
        FileError);
}

TEST_CASE("A job that would throw a saved state away is refused, unless it says so", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    CHECK_NOTHROW(LoopCheckpoint::refuse_loss(folder.path(), false, false));
    save(LoopCheckpoint(folder.path(), opened_job, a_job, target), some_state(6));
    CHECK_THROWS_WITH(LoopCheckpoint::refuse_loss(folder.path(), false, false),
                      Catch::Contains("--resume") && Catch::Contains("--overwrite"));
    CHECK_NOTHROW(LoopCheckpoint::refuse_loss(folder.path(), true, false));
    CHECK_NOTHROW(LoopCheckpoint::refuse_loss(folder.path(), false, true));
}

TEST_CASE("A state that cannot be written is said", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path() / "not-there", opened_job, a_job, target);
    CHECK_THROWS_AS(save(checkpoint, some_state(6)), FileError);
}

TEST_CASE("A state that has no room says why, and leaves nothing half-written", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path(), opened_job, a_job, target);
    const std::filesystem::path part = io::part_path(checkpoint.file());
    std::filesystem::create_symlink("/dev/full", part);
    CHECK_THROWS_AS(save(checkpoint, some_state(6)), TryAgain);
    CHECK_FALSE(std::filesystem::is_symlink(part));
    // One that cannot be opened has its own reason, and a full disk is none of them.
    const LoopCheckpoint nowhere(folder.path() / "not-there", opened_job, a_job, target);
    CHECK_THROWS_WITH(save(nowhere, some_state(6)), Catch::Contains("No such file") && !Catch::Contains("disk"));
    CHECK_FALSE(checkpoint.exists());
}

TEST_CASE("What a killed process left of a state goes with the next state, and with the saved loop", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path(), opened_job, a_job, target);
    const auto die_writing = [&] {
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            std::ofstream(io::part_path(checkpoint.file())) << "half";
            _exit(0);
        }
        REQUIRE(waitpid(child, nullptr, 0) == child);
    };
    const auto files = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
    die_writing();
    REQUIRE(files() == 1);
    save(checkpoint, some_state(6));
    CHECK(files() == 1);
    die_writing();
    REQUIRE(files() == 2);
    LoopCheckpoint::remove_from(folder.path());
    CHECK(files() == 0);
}

TEST_CASE("A state of another job or a broken file is refused", "[loop]") {
    const io::TemporaryFolder folder;
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    Progress quiet;
    save(LoopCheckpoint(folder.path(), opened_job, a_job, target), some_state(6));
    CHECK(LoopCheckpoint(folder.path(), opened_job, a_job, target).read(quiet));
    CHECK_THROWS_AS(LoopCheckpoint(folder.path(), opened_job, another_job, target).read(quiet), InputError);
    auto moved = target;
    moved[2].x() = 0.25f;
    CHECK_THROWS_AS(LoopCheckpoint(folder.path(), opened_job, a_job, moved).read(quiet), InputError);

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
        CHECK_THROWS_AS(LoopCheckpoint(folder.path(), opened_job, a_job, target).read(quiet), FileError);
    }
    for (std::size_t at = 0; at < size; at += 101) {
        std::string spoiled = bytes;
        spoiled[at] = static_cast<char>(spoiled[at] ^ 0x40);
        write(spoiled);
        CHECK_THROWS(LoopCheckpoint(folder.path(), opened_job, a_job, target).read(quiet));
    }
    std::string older = bytes;
    older.replace(0, 15, "voxtone-loop 8\n");
    write(older);
    CHECK_THROWS_WITH(LoopCheckpoint(folder.path(), opened_job, a_job, target).read(quiet),
                      Catch::Contains("another version of this program"));
}

TEST_CASE("A state whose lists do not fit its cells or each other is broken, though its sum is right", "[loop]") {
    const io::TemporaryFolder folder;
    constexpr std::size_t cells = 6;
    const std::vector<Eigen::Vector3f> target(cells, Eigen::Vector3f::Constant(0.5f));
    const LoopCheckpoint checkpoint(folder.path(), opened_job, a_job, target);
    const auto is_read = [&](const std::function<void(halftone::LoopState&)>& change) {
        halftone::LoopState state = some_state(cells);
        change(state);
        save(checkpoint, state);
        Progress quiet;
        try {
            return checkpoint.read(quiet).has_value();
        } catch (const FileError&) {
            return false;
        }
    };
    using State = halftone::LoopState;
    CHECK(is_read([](State&) {}));
    CHECK_FALSE(is_read([](State& s) { s.best = 3; }));
    CHECK_FALSE(is_read([](State& s) { s.control.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.open.emplace_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.shown.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.start_control.pop_back(); }));
    CHECK(is_read([](State& s) { s.start_control.clear(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.momentum.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.shared.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.scale.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.rate.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.divisor.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.decrease.pop_back(); }));
    CHECK_FALSE(is_read([](State& s) { s.descent.shared.clear(); }));  // which the divisors go with
    CHECK(is_read([](State& s) { s.descent.shared.clear(), s.descent.divisor.clear(), s.descent.decrease.clear(); }));
    CHECK_FALSE(
        is_read([](State& s) { s.descent = halftone::begin_descent(halftone::SkinMixtures(cells - 1, 4, 5), {}); }));
    CHECK_FALSE(is_read([](State& s) { s.recent = halftone::SkinMixtures(cells + 1, 4, 5); }));
    CHECK(is_read([](State& s) { s.recent = {}; }));
    // The best print is there, however it was made.
    CHECK_FALSE(is_read([](State& s) { s.best_mixtures = {}; }));
    CHECK(is_read([](State& s) { s.best_mixtures = {}, s.best = 0; }));
    const auto by_feedback = [](State& s) { s.best_mixtures = {}, s.steps[1].method = halftone::LoopMethod::feedback; };
    CHECK(is_read(by_feedback));
    CHECK_FALSE(is_read([&](State& s) { by_feedback(s), s.start_control.clear(); }));
    CHECK_FALSE(is_read([](State& s) { s.steps[1].method = halftone::LoopMethod::open_loop; }));
}

TEST_CASE("Whose state it is can be told before the model is read", "[loop]") {
    const io::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "loop.checkpoint";
    const auto write = [&](const std::string& content) {
        std::ofstream(file, std::ios::binary | std::ios::trunc)
            .write(content.data(), static_cast<std::streamsize>(content.size()));
    };
    CHECK_NOTHROW(LoopCheckpoint::expect_same_job(folder.path(), opened_job));  // nothing there
    const std::vector<Eigen::Vector3f> target(6, Eigen::Vector3f::Constant(0.5f));
    save(LoopCheckpoint(folder.path(), opened_job, a_job, target), some_state(6));
    CHECK_NOTHROW(LoopCheckpoint::expect_same_job(folder.path(), opened_job));
    CHECK_THROWS_WITH(LoopCheckpoint::expect_same_job(folder.path(), another_job),
                      Catch::Contains("belongs to a job with other options"));
    Progress quiet;
    CHECK_THROWS_AS(LoopCheckpoint(folder.path(), another_job, a_job, target).read(quiet), InputError);
    write("voxtone-loop 8\nwhatever that version had there");
    CHECK_THROWS_WITH(LoopCheckpoint::expect_same_job(folder.path(), opened_job), Catch::Contains("another version"));
    write("voxtone-loop 19\n1234567");
    CHECK_THROWS_AS(LoopCheckpoint::expect_same_job(folder.path(), opened_job), FileError);
    write("");
    CHECK_THROWS_AS(LoopCheckpoint::expect_same_job(folder.path(), opened_job), FileError);
}
