// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/loop_checkpoint.h"

#include <array>
#include <cstring>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/part_files.h"
#include "io/files/xxh64.h"
#include "io/layers/stack_folder.h"

namespace voxtone::slicer {

namespace {

constexpr ArtefactKind checkpoint_kind{
    "voxtone-loop", 19, "is not whole, or no checkpoint of this program; start without --resume, with --overwrite",
    "belongs to a job with other options, or with inputs (model, textures, resins, printer) that held something else, "
    "and only the same job goes on with it: give the same options and inputs, or begin anew (--overwrite)",
    "was written by another version of this program; start without --resume, with --overwrite"};

Artefact checkpoint_in(const std::filesystem::path& folder) { return {folder / io::checkpoint_name, checkpoint_kind}; }

void mixtures_in(io::PackedWriter& to, const halftone::SkinMixtures& mixtures) {
    to(std::array<std::uint64_t, 2>{mixtures.layers(), mixtures.resins()}, std::uint64_t{mixtures.all().size()});
    to.add(std::as_bytes(mixtures.all()));
}

void mixtures_in(io::PackedReader& from, halftone::SkinMixtures& mixtures) {
    std::array<std::uint64_t, 2> shape{};
    std::vector<float> fractions;
    from(shape, fractions);
    if (fractions.empty()) return;
    if (shape[0] < 1 || shape[0] > 64 || shape[1] < 1 || shape[1] > halftone::max_resins ||
        fractions.size() % (shape[0] * shape[1]) != 0)
        throw InputError("mixtures of no shape");
    mixtures = halftone::SkinMixtures(shape[0], shape[1], std::move(fractions));
}

/// Every part of a state, for reading and writing alike.
template <class Stream, class State>
void state_in(Stream& stream, State& state) {
    static_assert(std::is_trivially_copyable_v<halftone::LoopStep>);
    auto best = std::uint64_t(state.best);
    stream(best);
    if constexpr (!std::is_const_v<State>) state.best = std::size_t(best);
    stream(state.steps, state.white, state.control, state.start_control);
    mixtures_in(stream, state.best_mixtures);
    auto& descent = state.descent;
    mixtures_in(stream, descent.mixtures);
    stream(descent.momentum, descent.scale, descent.shared, descent.divisor, descent.decrease, descent.rate);
    mixtures_in(stream, state.recent);
    stream(state.open, state.shown, state.urgency, state.saturated_share, state.has_gradient);
}

/// What is read goes into lists that are looked up without asking.
bool fits_together(const halftone::LoopState& state, std::size_t cells) {
    const halftone::DescentState& descent = state.descent;
    const auto fits = [&](const auto& list) { return list.size() == cells; };
    const auto may_lack = [&](std::size_t there) { return there == 0 || there == cells; };
    const std::size_t moved = descent.mixtures.cells(), stepped = descent.shared.empty() ? 0 : moved,
                      parts = moved == 0 ? 0 : descent.mixtures.resins() + 1;
    const auto best_is_there = [&] {
        switch (state.steps[state.best].method) {
            case halftone::LoopMethod::open_loop:
                break;
            case halftone::LoopMethod::feedback:
                return fits(state.start_control);
            case halftone::LoopMethod::descent:
                return state.best_mixtures.cells() == cells;
        }
        return state.best == 0;
    };
    return state.best < state.steps.size() && fits(state.control) && may_lack(state.start_control.size()) &&
           descent.momentum.size() == descent.mixtures.all().size() &&
           (descent.shared.empty() || descent.shared.size() == descent.momentum.size()) &&
           descent.scale.size() == moved && descent.rate.size() == moved * parts && descent.divisor.size() == stepped &&
           descent.decrease.size() == stepped * parts && may_lack(moved) && may_lack(state.recent.cells()) &&
           best_is_there() && fits(state.open) && fits(state.shown);
}

}  // namespace

LoopCheckpoint::LoopCheckpoint(const std::filesystem::path& folder, std::string_view opened_identity,
                               std::string_view loop_identity, std::span<const Eigen::Vector3f> target)
    : file_(checkpoint_in(folder)), cells_(target.size()) {
    io::Xxh64 job;
    job.update(loop_identity.data(), loop_identity.size());
    job.update(target.data(), target.size_bytes());
    key_ = {digest_of_text(opened_identity), job.digest()};
}

void LoopCheckpoint::refuse_loss(const std::filesystem::path& folder, bool resume, bool overwrite) {
    if (resume || overwrite || !checkpoint_in(folder).exists()) return;
    throw InputError(fmt::format(
        "{} holds the state of an interrupted appearance loop ({}), which this job would throw away: go on with it "
        "(--resume), or begin anew (--overwrite)",
        folder.string(), io::checkpoint_name));
}

void LoopCheckpoint::expect_same_job(const std::filesystem::path& folder, std::string_view opened_identity) {
    const Artefact file = checkpoint_in(folder);
    if (const auto key = file.key(); key && key->opened != digest_of_text(opened_identity)) file.fail_foreign();
}

std::string LoopCheckpoint::advice(const std::filesystem::path& folder) {
    return fmt::format(
        "the appearance loop is saved in {}: the same command without --overwrite goes on, with --resume --iterations "
        "0 "
        "it prints the best that there is",
        (folder / io::checkpoint_name).string());
}

std::size_t LoopCheckpoint::saved_steps(const std::filesystem::path& folder) {
    // Which step is the best, and how many there are (state_in).
    std::array<std::uint64_t, 2> first{};
    const std::vector<std::byte> begin = checkpoint_in(folder).first_values(sizeof first);
    if (!begin.empty()) std::memcpy(first.data(), begin.data(), sizeof first);
    return std::size_t(first[1]);
}

void LoopCheckpoint::write(const halftone::LoopState& state, const optics::AppearanceSequence& sequence) const {
    file_.write(key_, [&](io::PackedWriter& to) {
        state_in(to, state);
        sequence.write_state([&to](std::span<const std::byte> bytes) { to.add(bytes); });
    });
}

std::optional<halftone::ResumedLoop> LoopCheckpoint::read(Progress& progress) const {
    if (!file_.exists()) {
        progress.note("--resume: there is no loop.checkpoint in the output folder; the loop begins at its start");
        return std::nullopt;
    }
    const Artefact::Content content = file_.read(std::array{key_});
    std::span<const std::byte> rest = content.values;
    io::PackedReader from(rest.size(), [&rest](void* to, std::size_t size) {
        std::memcpy(to, rest.data(), size);
        rest = rest.subspan(size);
    });
    halftone::ResumedLoop loop;
    try {
        state_in(from, loop.state);
    } catch (const InputError&) {
        file_.fail_broken();
    }
    if (!fits_together(loop.state, cells_)) file_.fail_broken();
    loop.sequence.assign(rest.begin(), rest.end());
    progress.note(fmt::format("--resume: going on after iteration {}", loop.state.steps.back().iteration));
    return loop;
}

void LoopCheckpoint::remove_from(const std::filesystem::path& folder) {
    std::error_code not_there;
    std::filesystem::remove(folder / io::checkpoint_name, not_there);
    io::sweep_parts_of(folder / io::checkpoint_name);
}

}  // namespace voxtone::slicer
