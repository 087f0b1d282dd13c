// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/kept/input_digests.h"

#include <sys/stat.h>

#include <ctime>
#include <filesystem>
#include <system_error>

#include "io/files/file_digest.h"

namespace voxtone::slicer {

namespace {

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
}

std::string absolute(const std::string& file) {
    std::error_code none;
    return std::filesystem::absolute(file, none).lexically_normal().string();
}

}  // namespace

std::optional<FileStamp> FileStamp::of(const std::string& file) {
    struct stat about {};
    if (::stat(file.c_str(), &about) != 0 || !S_ISREG(about.st_mode)) return std::nullopt;
    return FileStamp{static_cast<std::uint64_t>(about.st_size), static_cast<std::uint64_t>(about.st_ino),
                     nanoseconds(about.st_mtim), nanoseconds(about.st_ctim)};
}

bool FileStamp::settled() const {
    constexpr std::int64_t coarse_ns = 2'000'000'000;
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return changed_ns + coarse_ns < nanoseconds(now);
}

std::string InputDigests::of(const std::string& file, const Progress* progress) {
    const std::string path = absolute(file);
    const std::optional<FileStamp> stamp = FileStamp::of(path);
    if (const auto known = find(path); stamp && known && known->stamp == *stamp) return known->sha256;
    std::string digest = io::file_sha256(path, progress);
    const bool good = stamp && stamp->settled() && FileStamp::of(path) == stamp;
    const std::lock_guard lock(mutex_);
    if (good)
        known_[path] = {*stamp, digest};
    else
        known_.erase(path);
    return digest;
}

void InputDigests::learn(const std::string& file, const KnownDigest& known) {
    const std::lock_guard lock(mutex_);
    known_[absolute(file)] = known;
}

std::optional<KnownDigest> InputDigests::find(const std::string& file) const {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(absolute(file));
    return found == known_.end() ? std::nullopt : std::optional(found->second);
}

InputDigests& input_digests() {
    static InputDigests digests;
    return digests;
}

}  // namespace voxtone::slicer
