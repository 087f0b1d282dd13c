// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_folder.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/part_files.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

constexpr const char* mark_name = "batch.json";

void expect_mark(const fs::path& out) {
    const io::JsonObject mark = io::JsonObject::read(out / mark_name);
    if (!mark.is_text("format") || mark.text("format") != "voxtone-batch")
        throw InputError(fmt::format("{}: is not of a batch, so nothing is written into its folder; name another",
                                     (out / mark_name).string()));
    if (mark.integer("version", 0, 1000000) != 1)
        throw InputError(fmt::format(
            "{}: a batch of version {} of another program version; this one reads version 1: name another folder, or "
            "go on with the program that began it",
            out.string(), mark.any_text("version")));
}

void expect_free(const fs::path& out) {
    for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
        if (io::is_part_name(entry.path().filename().string())) continue;
        if (fs::exists(out / mark_name)) return;  // another batch has just begun it
        throw InputError(
            fmt::format("{}: holds files ({}) and is no batch's folder, so nothing is written into it; name another or "
                        "an empty one",
                        out.string(), entry.path().filename().string()));
    }
}

void write_mark(const fs::path& out) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-batch").add("version", 1).end_object();
    io::write_whole_file(out / mark_name, json.text() + "\n");
}

}  // namespace

BatchFolder BatchFolder::make(const fs::path& out) {
    try {
        if (fs::exists(out) && !fs::is_directory(out))
            throw FileError(fmt::format("{}: is there and is no folder; name a folder for the batch", out.string()));
        fs::create_directories(out);
        if (!fs::exists(out / mark_name)) {
            expect_free(out);
            write_mark(out);
        }
        expect_mark(out);
        fs::create_directories(out / "batch");
        io::sweep_parts(out);
        io::sweep_parts(out / "batch");
    } catch (const fs::filesystem_error& error) {
        throw FileError(fmt::format("{}: cannot be made ready for a batch ({})", out.string(), error.code().message()));
    }
    return BatchFolder(fs::absolute(out).lexically_normal());
}

BatchFolder BatchFolder::open(const fs::path& out) {
    if (std::error_code none; !fs::exists(out / mark_name, none))
        throw InputError(
            fmt::format("{}: is no folder of a batch ({} is not there); name one that `voxtone batch` made",
                        out.string(), mark_name));
    expect_mark(out);
    return BatchFolder(fs::absolute(out).lexically_normal());
}

fs::path BatchFolder::state_file(const std::string& name) const { return states_folder() / (name + ".json"); }
fs::path BatchFolder::log_file(const std::string& name) const { return states_folder() / (name + ".log"); }
fs::path BatchFolder::picture_file(const std::string& name) const { return states_folder() / (name + ".png"); }

std::optional<JobState> BatchFolder::state_of(const std::string& name) const {
    try {
        JobState state = read_state(state_file(name));
        if (state.name == name) return state;
    } catch (const Error&) {
        // What the job's own folder says decides then.
    }
    return std::nullopt;
}

std::vector<JobState> BatchFolder::states() const {
    std::vector<JobState> all;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(states_folder(), error)) {
        const fs::path& file = entry.path();
        if (file.extension() != ".json" || file.filename().string().starts_with('.')) continue;
        if (auto state = state_of(file.stem().string())) all.push_back(std::move(*state));
    }
    std::sort(all.begin(), all.end(), [](const JobState& a, const JobState& b) {
        return a.number != b.number ? a.number < b.number : a.name < b.name;
    });
    return all;
}

void BatchFolder::publish(const JobState& state) const {
    io::write_whole_file(state_file(state.name), state_json(state));
}

std::unique_ptr<io::FolderLock> BatchFolder::lock(const std::string& name) const {
    return lock_file(name_of_lock(name));
}

std::unique_ptr<io::FolderLock> BatchFolder::lock_summary() const { return lock_file("..summary.lock"); }

std::unique_ptr<io::FolderLock> BatchFolder::lock_file(const std::string& file) const {
    try {
        return std::make_unique<io::FolderLock>(states_folder(), file);
    } catch (const io::FolderHeld&) {
        return nullptr;
    }
}

void BatchFolder::sweep_lock(const std::string& name) const {
    std::error_code none;
    if (fs::exists(states_folder() / name_of_lock(name), none)) (void)lock(name);
}

}  // namespace voxtone::farm
