// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/loop_checkpoint.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <type_traits>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"
#include "io/layers/stack_folder.h"

namespace voxtone::slicer {

namespace {

// The file: magic, digest of the job as it was opened, digest of the job with its target, state, what the sequence
// keeps, digest of all before. Native byte order: it is read where it was written.
constexpr std::string_view magic = "voxtone-loop 19\n", any_magic = "voxtone-loop ";  // of any version
constexpr std::size_t digest_size = sizeof(std::uint64_t);
constexpr std::size_t head_size = magic.size() + 2 * digest_size;

/// Hands over the bytes of a state piece by piece.
struct Writer {
    std::function<void(const void*, std::size_t)> raw;
    template <class T>
    void list(std::span<const T> values) {
        const std::uint64_t count = values.size();
        raw(&count, sizeof count);
        raw(values.data(), values.size_bytes());
    }
    template <class T>
    void list(const std::vector<T>& values) {
        list(std::span<const T>(values));
    }
};

struct Reader {
    std::span<const std::uint8_t> bytes;
    bool good = true;
    void raw(void* to, std::size_t size) {
        if (size > bytes.size()) {
            good = false;
            return;
        }
        if (size > 0) std::memcpy(to, bytes.data(), size);
        bytes = bytes.subspan(size);
    }
    template <class T>
    void list(std::vector<T>& values) {
        std::uint64_t count = 0;
        raw(&count, sizeof count);
        if (!good || count > bytes.size() / sizeof(T)) {
            good = false;
            return;
        }
        values.resize(count);
        raw(values.data(), count * sizeof(T));
    }
};

void mixtures_in(Writer& file, const halftone::SkinMixtures& mixtures) {
    const std::array<std::uint64_t, 2> shape{mixtures.layers(), mixtures.resins()};
    file.raw(shape.data(), sizeof shape);
    file.list(mixtures.all());
}

void mixtures_in(Reader& file, halftone::SkinMixtures& mixtures) {
    std::array<std::uint64_t, 2> shape{};
    std::vector<float> fractions;
    file.raw(shape.data(), sizeof shape);
    file.list(fractions);
    if (!file.good || fractions.empty()) return;
    file.good = shape[0] >= 1 && shape[0] <= 64 && shape[1] >= 1 && shape[1] <= halftone::max_resins &&
                fractions.size() % (shape[0] * shape[1]) == 0;
    if (file.good) mixtures = halftone::SkinMixtures(shape[0], shape[1], std::move(fractions));
}

template <class Value>
void value_in(Writer& file, const Value& value) {
    file.raw(&value, sizeof value);
}

void value_in(Reader& file, double& value) { file.raw(&value, sizeof value); }

void value_in(Reader& file, bool& value) {
    std::uint8_t byte = 0;  // a bool may hold nothing but 0 and 1
    file.raw(&byte, sizeof byte);
    value = byte != 0;
}

/// Every part of a state, in the file's order, for reading and writing alike.
template <class File, class State>
void state_in(File& file, State& state) {
    static_assert(std::is_trivially_copyable_v<halftone::LoopStep>);
    auto best = static_cast<std::uint64_t>(state.best);
    file.raw(&best, sizeof best);
    if constexpr (!std::is_const_v<State>) state.best = static_cast<std::size_t>(best);
    file.list(state.steps);
    file.list(state.white);
    file.list(state.control);
    file.list(state.start_control);
    mixtures_in(file, state.best_mixtures);
    mixtures_in(file, state.descent.mixtures);
    file.list(state.descent.momentum);
    file.list(state.descent.scale);
    file.list(state.descent.shared);
    file.list(state.descent.divisor);
    file.list(state.descent.decrease);
    file.list(state.descent.rate);
    mixtures_in(file, state.recent);
    file.list(state.open);
    file.list(state.shown);
    file.list(state.urgency);
    value_in(file, state.saturated_share);
    value_in(file, state.has_gradient);
}

std::uint64_t number_at(std::span<const std::uint8_t> bytes) {
    std::uint64_t number = 0;
    std::memcpy(&number, bytes.data(), sizeof number);
    return number;
}

bool begins_with(std::span<const std::uint8_t> bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::uint64_t digest_of(std::string_view text) {
    return io::xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

FileError broken_file(const std::filesystem::path& file) {
    return FileError(fmt::format(
        "{}: is not whole, or no checkpoint of this program; start without --resume, with --overwrite", file.string()));
}

struct CloseState {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

InputError of_another_job(const std::filesystem::path& file) {
    return InputError(
        fmt::format("{}: belongs to a job with other options, or with inputs (model, textures, resins, printer) "
                    "that held something else, and only the same job goes on with it: give the same options and "
                    "inputs, or begin anew (--overwrite)",
                    file.string()));
}

/// `begin`: as much of the file as there is, up to a head.
void expect_head(const std::filesystem::path& file, std::span<const std::uint8_t> begin) {
    if (begin.size() >= magic.size() && begins_with(begin, any_magic) && !begins_with(begin, magic))
        throw InputError(
            fmt::format("{}: was written by another version of this program; start without --resume, with --overwrite",
                        file.string()));
    if (!begins_with(begin, magic) || begin.size() < head_size) throw broken_file(file);
}

}  // namespace

LoopCheckpoint::LoopCheckpoint(const std::filesystem::path& folder, std::string_view opened_identity,
                               std::string_view loop_identity, std::span<const Eigen::Vector3f> target)
    : file_(folder / io::checkpoint_name), opened_digest_(digest_of(opened_identity)), cells_(target.size()) {
    io::Xxh64 job;
    job.update(loop_identity.data(), loop_identity.size());
    job.update(target.data(), target.size_bytes());
    digest_ = job.digest();
}

void LoopCheckpoint::refuse_loss(const std::filesystem::path& folder, bool resume, bool overwrite) {
    std::error_code none;
    if (resume || overwrite || !std::filesystem::exists(folder / io::checkpoint_name, none)) return;
    throw InputError(fmt::format(
        "{} holds the state of an interrupted appearance loop ({}), which this job would throw away: go on with it "
        "(--resume), or begin anew (--overwrite)",
        folder.string(), io::checkpoint_name));
}

void LoopCheckpoint::expect_same_job(const std::filesystem::path& folder, std::string_view opened_identity) {
    const std::filesystem::path path = folder / io::checkpoint_name;
    std::ifstream file(path, std::ios::binary);
    if (!file) return;  // `read` says what there is to say
    std::vector<std::uint8_t> head(head_size);
    file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    expect_head(path, head);
    if (number_at(std::span(head).subspan(magic.size())) != digest_of(opened_identity)) throw of_another_job(path);
}

std::string LoopCheckpoint::advice(const std::filesystem::path& folder) {
    return fmt::format(
        "the appearance loop is saved in {}: the same command without --overwrite goes on, with --resume --iterations "
        "0 "
        "it prints the best that there is",
        (folder / io::checkpoint_name).string());
}

std::size_t LoopCheckpoint::saved_steps(const std::filesystem::path& folder) {
    // Behind the head stand which step is the best and how many there are (state_in).
    std::vector<std::uint8_t> begin(head_size + 2 * sizeof(std::uint64_t));
    std::ifstream file(folder / io::checkpoint_name, std::ios::binary);
    file.read(reinterpret_cast<char*>(begin.data()), static_cast<std::streamsize>(begin.size()));
    if (!file || !begins_with(begin, magic)) return 0;
    return static_cast<std::size_t>(number_at(std::span(begin).subspan(head_size + sizeof(std::uint64_t))));
}

bool LoopCheckpoint::exists() const {
    std::error_code none;
    return std::filesystem::exists(file_, none);
}

void LoopCheckpoint::hand_over(const Piece& take, const halftone::LoopState& state,
                               const optics::AppearanceSequence& sequence) const {
    Writer file{take};
    take(magic.data(), magic.size());
    take(&opened_digest_, sizeof opened_digest_);
    take(&digest_, sizeof digest_);
    state_in(file, state);
    sequence.write_state([&take](std::span<const std::byte> bytes) { take(bytes.data(), bytes.size()); });
}

void LoopCheckpoint::write(const halftone::LoopState& state, const optics::AppearanceSequence& sequence) const {
    const std::filesystem::path part = io::part_path(file_);
    const std::unique_ptr<std::FILE, CloseState> out(std::fopen(part.c_str(), "wbe"));
    if (!out) io::fail_to_write(file_, "cannot be created", errno);
    int fault = 0;
    const auto write = [&](const void* data, std::size_t more) {
        if (fault == 0 && std::fwrite(data, 1, more, out.get()) != more) fault = errno;
    };
    io::Xxh64 sum;
    const auto put = [&](const void* data, std::size_t more) {
        sum.update(data, more);
        write(data, more);
    };
    hand_over(put, state, sequence);
    const std::uint64_t digest = sum.digest();
    write(&digest, digest_size);
    if (std::fflush(out.get()) != 0 && fault == 0) fault = errno;
    if (fault != 0) {
        std::error_code not_there;
        std::filesystem::remove(part, not_there);
        io::fail_to_write(file_, "could not be written", fault);
    }
    io::finish_part(file_);
}

std::optional<halftone::ResumedLoop> LoopCheckpoint::read(Progress& progress) const {
    if (!std::filesystem::exists(file_)) {
        progress.note("--resume: there is no loop.checkpoint in the output folder; the loop begins at its start");
        return std::nullopt;
    }
    constexpr std::uint64_t most = std::uint64_t{1} << 34;
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file_, most);
    const std::span<const std::uint8_t> all(bytes);
    expect_head(file_, all.first(std::min(all.size(), head_size)));
    if (all.size() < head_size + digest_size) throw broken_file(file_);
    const auto body = all.first(all.size() - digest_size);
    if (io::xxh64(body) != number_at(all.last(digest_size))) throw broken_file(file_);
    if (number_at(all.subspan(magic.size())) != opened_digest_ ||
        number_at(all.subspan(magic.size() + digest_size)) != digest_)
        throw of_another_job(file_);
    halftone::ResumedLoop loop;
    halftone::LoopState& state = loop.state;
    Reader file{body.subspan(head_size)};
    state_in(file, state);
    const auto fits = [&](const auto& list, bool may_lack) {
        return list.size() == cells_ || (may_lack && list.empty());
    };
    const auto descent_fits = [](const halftone::DescentState& d) {
        const std::size_t cells = d.mixtures.cells(), stepped = d.shared.empty() ? 0 : cells,
                          parts = cells == 0 ? 0 : d.mixtures.resins() + 1;
        return d.momentum.size() == d.mixtures.all().size() &&
               (d.shared.empty() || d.shared.size() == d.momentum.size()) && d.scale.size() == cells &&
               d.rate.size() == cells * parts && d.divisor.size() == stepped && d.decrease.size() == stepped * parts;
    };
    const auto best_is_there = [&] {
        switch (state.steps[state.best].method) {
            case halftone::LoopMethod::open_loop:
                break;
            case halftone::LoopMethod::feedback:
                return state.start_control.size() == cells_;
            case halftone::LoopMethod::descent:
                return state.best_mixtures.cells() == cells_;
        }
        return state.best == 0;
    };
    if (!file.good || state.steps.empty() || state.best >= state.steps.size() || !fits(state.control, false) ||
        !fits(state.start_control, true) || !descent_fits(state.descent) ||
        (state.descent.mixtures.cells() != 0 && state.descent.mixtures.cells() != cells_) ||
        (state.recent.cells() != 0 && state.recent.cells() != cells_) || !best_is_there() || !fits(state.open, false) ||
        !fits(state.shown, false))
        throw broken_file(file_);
    const auto rest = std::as_bytes(file.bytes);
    loop.sequence.assign(rest.begin(), rest.end());
    progress.note(fmt::format("--resume: going on after iteration {}", state.steps.back().iteration));
    return loop;
}

void LoopCheckpoint::remove_from(const std::filesystem::path& folder) {
    std::error_code not_there;
    std::filesystem::remove(folder / io::checkpoint_name, not_there);
}

}  // namespace voxtone::slicer
