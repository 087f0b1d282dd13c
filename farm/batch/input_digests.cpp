// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/input_digests.h"

#include <sys/stat.h>

#include <ctime>

#include "io/files/file_digest.h"

namespace voxtone::farm {

namespace {

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
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
    const std::optional<FileStamp> stamp = FileStamp::of(file);
    const auto found = known_.find(file);
    if (stamp && found != known_.end() && found->second.stamp == *stamp) return found->second.sha256;
    std::string digest = io::file_sha256(file, progress);
    if (stamp && stamp->settled() && FileStamp::of(file) == stamp)
        known_[file] = {*stamp, digest};
    else
        known_.erase(file);
    return digest;
}

std::optional<KnownDigest> InputDigests::find(const std::string& file) const {
    const auto found = known_.find(file);
    return found == known_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace voxtone::farm
