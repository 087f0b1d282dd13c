// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shards/shard_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <exception>
#include <regex>
#include <set>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/folder_lock.h"
#include "io/disk/open_file.h"
#include "io/disk/part_files.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t store_digits = 16;

constexpr std::string_view prepared_ending = ".prepared";

/// Layers of a job, or its body.
bool is_store(const std::string& name) {
    const std::size_t digits = std::min(name.find_first_not_of("0123456789abcdef"), name.size());
    return digits == store_digits && (name.size() == digits || name.substr(digits) == prepared_ending);
}

/// Of a record's file name.
std::optional<ShardNumber> number_in(const std::string& name) {
    static const std::regex form(R"((\d{4,6})-of-(\d{4,6})\.json)");
    std::smatch match;
    if (!std::regex_match(name, match, form)) return std::nullopt;
    const ShardNumber number{std::uint32_t(std::stoul(match[1])), std::uint32_t(std::stoul(match[2]))};
    if (number.shard < 1 || number.shard > number.of || number.of > ShardNumber::most) return std::nullopt;
    return number;
}

void check_folder(const fs::path& out) {
    if (fs::exists(out) && !fs::is_directory(out))
        throw FileError(fmt::format("{}: is there and is no folder; name a folder for the stack", out.string()));
    if (fs::is_symlink(fs::symlink_status(shards_folder(out))))
        throw FileError(
            fmt::format("{}: is a link; layers would be written somewhere else than in the folder you "
                        "named: remove the link or choose another folder",
                        shards_folder(out).string()));
}

[[noreturn]] void refuse(const fs::path& folder, const char* what, const fs::filesystem_error& error) {
    const int code = error.code().value();
    if (code == ENOSPC || code == EDQUOT || code == EXDEV) fail_to_write(folder, what, code);
    throw FileError(fmt::format("{}: {} ({})", folder.string(), what, error.code().message()));
}

/// Layers that nobody makes any more go with their folder. One without a lock is just being made.
void sweep_if_dead(const fs::path& staging) {
    if (std::error_code none; !fs::exists(staging / lock_name, none)) return;
    try {
        const FolderLock lock(staging);
        fs::remove_all(staging);
    } catch (const std::exception&) {
        // Of a living shard, or just being removed by its maker (fs::filesystem_error) or by another who sweeps.
    }
}

}  // namespace

fs::path shards_folder(const fs::path& out) { return out / shards_name; }

fs::path shard_file(const fs::path& out, const ShardNumber& number) {
    return shards_folder(out) / (shard_name(number) + ".json");
}

std::string shard_store(std::string_view job) { return std::string(job.substr(0, store_digits)); }

fs::path shard_topmost_name(const ShardNumber& number) {
    return fs::path(whole_folder_name) / (shard_name(number) + ".png");
}

fs::path prepared_file(const fs::path& out, std::string_view job) {
    return shards_folder(out) / (shard_store(job) + std::string(prepared_ending));
}

std::vector<ShardNumber> shards_in(const fs::path& out) {
    std::vector<ShardNumber> numbers;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(shards_folder(out), none))
        if (const auto number = number_in(entry.path().filename().string())) numbers.push_back(*number);
    std::sort(numbers.begin(), numbers.end(), [](const ShardNumber& a, const ShardNumber& b) {
        return std::pair(a.of, a.shard) < std::pair(b.of, b.shard);
    });
    return numbers;
}

std::optional<fs::path> missing_file(const ShardRecord& record, const fs::path& stack) {
    StackDescription part = record.stack;
    part.first_layer = record.first_layer;
    for (std::uint32_t k = 0; k < record.layers; ++k) {
        const std::vector<fs::path> names = layer_file_names(part, record.resin_bitmaps, k);
        const auto& bytes = record.written.file_bytes[k];
        for (std::size_t f = 0; f < names.size(); ++f) {
            std::error_code none;
            const std::uintmax_t size = fs::file_size(stack / names[f], none);
            if (none || f >= bytes.size() || size != bytes[f]) return names[f];
        }
    }
    return std::nullopt;
}

void remove_shards(const fs::path& out) {
    try {
        for (const ShardNumber& number : shards_in(out)) fs::remove(shard_file(out, number));
        fs::remove(shards_folder(out) / job_file_name);
        std::error_code none;
        const std::vector<fs::directory_entry> entries(fs::directory_iterator(shards_folder(out), none), {});
        for (const fs::directory_entry& entry : entries)
            if (is_store(entry.path().filename().string())) fs::remove_all(entry.path());
    } catch (const fs::filesystem_error& error) {
        refuse(shards_folder(out), "shards of another job cannot be removed", error);
    }
}

void sweep_shards(const fs::path& out) {
    std::error_code none;
    const std::vector<fs::directory_entry> entries(fs::directory_iterator(shards_folder(out), none), {});
    for (const fs::directory_entry& entry : entries)
        if (is_part_name(entry.path().filename().string()) && fs::is_directory(entry.symlink_status(none)))
            sweep_if_dead(entry.path());
    sweep_parts(shards_folder(out));
}

struct ShardFolder::Held {
    fs::path out, staging;
    std::optional<FolderLock> lock;

    Held(fs::path of, const ShardNumber& number) : out(std::move(of)) {
        check_folder(out);
        staging = shards_folder(out) / part_name(shard_name(number));
        fs::create_directories(shards_folder(out));
        sweep_shards(out);
        // Another shard may just look whether this folder's maker lives, and remove it before it is locked.
        constexpr int tries = 50;
        constexpr std::chrono::milliseconds between(10);
        for (int attempt = 1; !lock; ++attempt) {
            fs::create_directories(staging);
            try {
                lock.emplace(staging);
            } catch (const Error&) {
                if (attempt == tries) throw;
                std::this_thread::sleep_for(between);
            }
        }
    }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    ~Held() {
        std::error_code ignored;
        fs::remove_all(staging, ignored);
        lock.reset();
        fs::remove(shards_folder(out), ignored);  // what is not empty stays
        fs::remove(out, ignored);
    }
};

ShardFolder::ShardFolder(fs::path out, const ShardNumber& number) {
    const fs::path folder = out;
    try {
        held_ = std::make_unique<Held>(std::move(out), number);
    } catch (const fs::filesystem_error& error) {
        refuse(folder, "cannot be made ready for a shard", error);
    }
}

ShardFolder::~ShardFolder() = default;

const fs::path& ShardFolder::staging() const { return held_->staging; }

void ShardFolder::claim(std::string_view job_file) {
    write_whole_file(shards_folder(held_->out) / job_file_name, job_file);
}

void ShardFolder::publish(const ShardRecord& record) {
    const fs::path& out = held_->out;
    const fs::path store = shards_folder(out) / shard_store(record.job);
    try {
        sync_file_system(held_->staging);
        StackDescription part = record.stack;
        part.first_layer = record.first_layer;
        std::set<fs::path> folders;
        for (std::uint32_t k = 0; k < record.layers; ++k)
            for (const fs::path& name : layer_file_names(part, record.resin_bitmaps, k)) {
                const fs::path to = store / name;
                if (folders.insert(to.parent_path()).second) fs::create_directories(to.parent_path());
                fs::rename(held_->staging / name, to);
            }
        for (const fs::path& name : {shard_topmost_name(record.number), fs::path(whole_folder_name) / preview_mesh_name,
                                     fs::path(whole_folder_name) / preview_box_name}) {
            if (!fs::exists(held_->staging / name)) continue;
            if (folders.insert((store / name).parent_path()).second)
                fs::create_directories((store / name).parent_path());
            fs::rename(held_->staging / name, store / name);
        }
        for (const fs::path& folder : folders) sync_folder(folder);
    } catch (const fs::filesystem_error& error) {
        refuse(shards_folder(out), "the shard's layers cannot be put in place", error);
    }
    write_whole_file(shard_file(out, record.number), shard_json(record));
}

}  // namespace voxtone::io
