// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/stack_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/folder_lock.h"
#include "io/disk/open_file.h"
#include "io/disk/part_files.h"
#include "io/files/whole_file.h"
#include "io/layers/manifest.h"
#include "io/printer/printer_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

/// Of a stack, in OUT; the manifest first: without it OUT is no stack.
constexpr std::array stack_names{manifest_name,    layers_name,     resin_folder_name, gcvf_name,          vdb_name,
                                 vdb_numbers_name, sheet_text_name, sheet_page_name,   printer_folder_name};
/// Of these the folders in which nothing else may lie.
constexpr std::array pure_folders{layers_name, resin_folder_name, printer_folder_name};
/// Of jobs, in OUT.
constexpr std::array job_names{unfinished_name, new_name, old_name, lock_name, shards_name, parts_name};
/// In the new stack's folder until it is in place: where its layers come from.
constexpr std::string_view adopted_name = "adopted-from";

/// slice_DIGITS.EXT
bool is_slice(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    if (!name.starts_with("slice_") || dot == std::string::npos || dot == 6) return false;
    return std::all_of(name.begin() + 6, name.begin() + static_cast<std::ptrdiff_t>(dot),
                       [](char c) { return c >= '0' && c <= '9'; }) &&
           (name.substr(dot) == ".png" || name.substr(dot) == ".tif");
}

bool is_there(const fs::path& path) { return fs::exists(fs::symlink_status(path)); }

void check_no_link(const fs::path& path) {
    if (fs::is_symlink(fs::symlink_status(path)))
        throw FileError(
            fmt::format("{}: is a link; layers would be written somewhere else than in the folder you named: "
                        "remove the link or choose another folder",
                        path.string()));
}

void check_folder(const fs::path& out) {
    if (!is_there(out)) return;
    if (!fs::is_directory(out))
        throw FileError(fmt::format("{}: is there and is no folder; name a folder for the stack", out.string()));
    for (const auto name : stack_names) check_no_link(out / name);
    for (const auto name : job_names) check_no_link(out / name);
}

/// The folders that were not there, from the outermost on.
std::vector<fs::path> make_folders(const fs::path& out) {
    std::vector<fs::path> made;
    for (fs::path at = fs::absolute(out).lexically_normal(); !at.empty() && !is_there(at); at = at.parent_path())
        if (at.has_filename()) made.push_back(at);
    std::reverse(made.begin(), made.end());
    fs::create_directories(out);
    return made;
}

/// Within the folder of a stack: a layer, or what a printer's folder has besides.
bool is_of_stack(const fs::path& file) {
    if (is_slice(file.filename().string())) return true;
    return file == fs::path(printer_folder_name) / how_to_print_name ||
           file == fs::path(printer_folder_name) / gcvf_name;
}

/// Calls visit(path within `from`) for all that lies in the folder of an old stack and is nothing of it.
template <class Visit>
void for_each_stranger(const fs::path& from, const fs::path& within, Visit&& visit) {
    if (!fs::is_directory(fs::symlink_status(from / within))) return;
    const std::vector<fs::directory_entry> entries(fs::directory_iterator(from / within), {});
    for (const fs::directory_entry& entry : entries) {
        const fs::path name = entry.path().filename();
        if (fs::is_directory(entry.symlink_status()))
            for_each_stranger(from, within / name, visit);
        else if (!is_of_stack(within / name))
            visit(within / name);
    }
}

/// `wanted`, or where that is taken "wanted-2" and so on.
fs::path free_name(const fs::path& wanted) {
    fs::path name = wanted;
    for (int n = 2; is_there(name); ++n)
        name.replace_filename(fmt::format("{}-{}{}", wanted.stem().string(), n, wanted.extension().string()));
    return name;
}

/// Strangers among an old stack's layers are not ours, and among the new ones they would be printed or refused.
void set_strangers_aside(const fs::path& old, std::string_view name, const fs::path& aside) {
    for_each_stranger(old, name, [&](const fs::path& file) {
        fs::create_directories((aside / file).parent_path());
        fs::rename(old / file, free_name(aside / file));
    });
}

void move_all(const fs::path& from, const fs::path& to) {
    const std::vector<fs::directory_entry> entries(fs::directory_iterator(from), {});
    for (const fs::directory_entry& entry : entries)
        if (const fs::path name = entry.path().filename(); name != manifest_name && name != adopted_name)
            fs::rename(entry.path(), to / name);
    if (is_there(from / manifest_name)) fs::rename(from / manifest_name, to / manifest_name);
}

void retire(const fs::path& out, std::string_view name) {
    if (is_there(out / name)) fs::rename(out / name, out / old_name / name);
}

bool is_plain_name(std::string_view name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    });
}

/// Moves what the new stack has adopted; what was moved before a kill is there no more.
void move_adopted(const fs::path& out) {
    std::ifstream file(out / new_name / adopted_name);
    std::string name;
    if (!std::getline(file, name) || !is_plain_name(name)) return;
    const fs::path from = out / shards_name / name;
    for (const auto part : {layers_name, resin_folder_name})
        if (is_there(from / part)) fs::rename(from / part, out / part);
}

/// Step 3 of the swap.
void put_new_in_place(const fs::path& out) {
    move_adopted(out);
    move_all(out / new_name, out);
    sync_folder(out);
    fs::remove(out / new_name / adopted_name);
    for (const auto name : pure_folders) set_strangers_aside(out / old_name, name, out / aside_name);
    fs::remove_all(out / old_name);
    fs::remove(out / new_name);  // last: as long as it is there, an old stack beside it is not to be put back
}

/// Ends what a killed job began, and throws its unfinished stack away.
void recover(const fs::path& out) {
    if (is_there(out / new_name)) {
        put_new_in_place(out);
    } else if (is_there(out / old_name)) {
        move_all(out / old_name, out);
        fs::remove(out / old_name);
    }
    fs::remove_all(out / unfinished_name);
    sweep_parts(out);
}

std::string stack_in_words(const fs::path& out) {
    try {
        const StackDescription stack = read_manifest(out / manifest_name);
        return fmt::format("a stack of {} layers for {}", stack.layers, stack.printer);
    } catch (const Error&) {
        return "a manifest.json that is not of a voxtone stack";
    }
}

[[noreturn]] void refuse_folder(const fs::path& out, const char* what, const fs::filesystem_error& error) {
    const int code = error.code().value();
    if (code == ENOSPC || code == EDQUOT || code == EXDEV) fail_to_write(out, what, code);
    const fs::path& at = error.path1();
    const std::string where = at.empty() || at == out ? "" : at.string() + ": ";
    throw FileError(fmt::format("{}: {} ({}{})", out.string(), what, where, error.code().message()));
}

constexpr const char* not_ready = "cannot be made ready for a stack";

}  // namespace

struct StackFolder::Held {
    fs::path out;
    std::vector<std::string_view> companions;
    std::vector<fs::path> made;  // folders; they go again if nothing came of the job
    std::optional<FolderLock> lock;
    bool begun = false;

    ~Held() {
        try {
            if (begun) recover(out);
        } catch (const fs::filesystem_error&) {
            // The next job tries again.
        }
        lock.reset();
        std::error_code not_empty;
        for (auto folder = made.rbegin(); folder != made.rend(); ++folder) fs::remove(*folder, not_empty);
    }
};

void expect_apart_from_layers(const fs::path& stack, const std::vector<fs::path>& files) {
    const fs::path folder = stack.filename() == manifest_name ? stack.parent_path() : stack;
    std::error_code none;
    std::vector<fs::path> pure;
    if (fs::is_directory(folder / layers_name, none))
        for (const auto name : pure_folders) pure.push_back(folder / name);
    else if (fs::is_directory(folder, none))
        pure.push_back(folder);
    for (const fs::path& file : files) {
        const fs::path parent = file.has_parent_path() ? file.parent_path() : fs::path(".");
        if (std::ranges::any_of(pure, [&](const fs::path& one) { return fs::equivalent(one, parent, none); }))
            throw InputError(
                fmt::format("{}: would lie among the layers of {}, where nothing else may be; name another folder",
                            file.string(), stack.string()));
    }
}

void expect_free_for_stack(const fs::path& out) {
    if (is_there(out / manifest_name))
        throw InputError(fmt::format(
            "{}: holds {} already, which would be replaced: name another folder, or allow it with --overwrite",
            out.string(), stack_in_words(out)));
    if (!is_there(out)) return;
    constexpr std::array kept{lock_name, checkpoint_name, skin_name, shards_name, parts_name, models_name};
    for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
        const std::string name = entry.path().filename().string();
        // Half-written ones are of another host, or of a living job.
        if (std::find(kept.begin(), kept.end(), name) == kept.end() && !is_part_name(name))
            throw InputError(
                fmt::format("{}: is not empty and holds no voxtone stack; files in it ({}) could be replaced: name "
                            "another folder, or allow it with --overwrite",
                            out.string(), name));
    }
}

StackFolder::StackFolder(fs::path out, std::vector<std::string_view> companions) : held_(std::make_unique<Held>()) {
    held_->out = std::move(out);
    held_->companions = std::move(companions);
    try {
        check_folder(held_->out);
        held_->made = make_folders(held_->out);
        held_->lock.emplace(held_->out);
        recover(held_->out);
    } catch (const fs::filesystem_error& error) {
        refuse_folder(held_->out, not_ready, error);
    }
}

StackFolder::StackFolder(StackFolder&&) noexcept = default;
StackFolder::~StackFolder() = default;

const fs::path& StackFolder::path() const { return held_->out; }

const std::string& StackFolder::doubt() const { return held_->lock->doubt(); }

bool StackFolder::holds_stack() const { return is_there(held_->out / manifest_name); }

std::string StackFolder::strangers_note() const {
    std::string first;
    std::size_t count = 0;
    for (const auto name : pure_folders)
        for_each_stranger(held_->out, name, [&](const fs::path& file) {
            if (count++ == 0) first = file.string();
        });
    if (count == 0) return {};
    return fmt::format("{}: {}{} {} no layer, and would be taken for one beside the new layers: {} moved to {}",
                       held_->out.string(), first, count > 1 ? fmt::format(" and {} more", count - 1) : "",
                       count > 1 ? "are" : "is", count > 1 ? "they are" : "it is", (held_->out / aside_name).string());
}

void StackFolder::expect_free() const { expect_free_for_stack(held_->out); }

fs::path StackFolder::begin() {
    VOXTONE_EXPECT(!held_->begun);
    const fs::path folder = held_->out / unfinished_name;
    try {
        held_->begun = true;
        fs::create_directories(folder / layers_name);
    } catch (const fs::filesystem_error& error) {
        refuse_folder(held_->out, not_ready, error);
    }
    return folder;
}

void StackFolder::adopt(std::string_view name) {
    VOXTONE_EXPECT(held_->begun && is_plain_name(name));
    const fs::path folder = held_->out / unfinished_name;
    write_staged_file(folder / adopted_name, name);
    std::error_code not_empty;
    fs::remove(folder / layers_name, not_empty);
}

void StackFolder::publish() {
    const fs::path& out = held_->out;
    try {
        sync_file_system(out);
        fs::create_directory(out / old_name);
        for (const auto name : stack_names) retire(out, name);
        for (const auto name : held_->companions) retire(out, name);
        fs::rename(out / unfinished_name, out / new_name);
        sync_folder(out);
        put_new_in_place(out);
    } catch (const fs::filesystem_error& error) {
        refuse_folder(out, "the new stack cannot be put in place", error);
    }
    held_->begun = false;
    held_->made.clear();
}

}  // namespace voxtone::io
