// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/file_digest.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/sha256.h"

namespace voxtone::io {

namespace {

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
}

std::string absolute(const std::string& file) {
    std::error_code none;
    return std::filesystem::absolute(file, none).lexically_normal().string();
}

/// Piece by piece.
std::string contents_sha256(const std::filesystem::path& file, const Progress* progress) {
    // What is no regular file (a pipe, a device) might never end.
    if (std::error_code none; !std::filesystem::is_regular_file(file, none)) return {};
    std::ifstream in(file, std::ios::binary);
    if (!in) throw FileError(fmt::format("{}: cannot be opened ({})", file.string(), std::strerror(errno)));
    Sha256 digest;
    std::vector<std::uint8_t> piece(std::size_t{1} << 20);
    while (in) {
        if (progress) progress->check_cancelled();
        in.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
        digest.update({piece.data(), static_cast<std::size_t>(in.gcount())});
    }
    if (in.bad()) throw FileError(fmt::format("{}: cannot be read to its end", file.string()));
    return digest.finish();
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

std::string FileDigests::of(const std::string& file, const Progress* progress) {
    const std::string path = absolute(file);
    const std::optional<FileStamp> stamp = FileStamp::of(path);
    if (const auto known = find(path); stamp && known && known->stamp == *stamp) return known->sha256;
    std::string digest = contents_sha256(path, progress);
    const bool good = stamp && stamp->settled() && FileStamp::of(path) == stamp;
    const std::lock_guard lock(mutex_);
    if (good)
        known_[path] = {*stamp, digest};
    else
        known_.erase(path);
    return digest;
}

void FileDigests::learn(const std::string& file, const KnownDigest& known) {
    const std::lock_guard lock(mutex_);
    known_[absolute(file)] = known;
}

std::optional<KnownDigest> FileDigests::find(const std::string& file) const {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(absolute(file));
    return found == known_.end() ? std::nullopt : std::optional(found->second);
}

FileDigests& file_digests() {
    static FileDigests digests;
    return digests;
}

std::string file_sha256(const std::filesystem::path& file, const Progress* progress) {
    return file_digests().of(file.string(), progress);
}

}  // namespace voxtone::io
