// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/whole_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/open_file.h"
#include "io/disk/part_files.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

void remove_quietly(const fs::path& file) {
    std::error_code ignored;
    fs::remove(file, ignored);
}

OpenFile open_new(const fs::path& path, const fs::path& named) {
    OpenFile out(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!out && errno == EEXIST)
        throw TryAgain(fmt::format("{}: another job is writing it ({} is there); try again when that is done",
                                   named.string(), path.string()));
    if (!out) fail_to_write(named, "cannot be created; is its folder there and writable?", errno);
    return out;
}

/// False with errno set where it could not.
bool write_all(int out, std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(out, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
}

void write_new_file(const fs::path& path, const fs::path& named, std::span<const std::uint8_t> bytes, bool sync) {
    OpenFile out = open_new(path, named);
    if (sync) (void)flock(out.get(), LOCK_EX | LOCK_NB);  // where locks are not known, nobody sweeps either
    if (write_all(out.get(), bytes) && (!sync || fsync(out.get()) == 0) && out.close()) return;
    const int error = errno;
    remove_quietly(path);
    fail_to_write(named, "could not be written", error);
}

void put_in_place(const fs::path& file) {
    std::error_code error;
    fs::rename(part_path(file), file, error);
    if (error) {
        remove_quietly(part_path(file));
        throw FileError(fmt::format("{}: could not be put in place ({})", file.string(), error.message()));
    }
    sync_folder(file.parent_path());
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

fs::path part_path(const fs::path& file) { return file.parent_path() / part_name(file); }

void write_whole_file(const fs::path& file, std::span<const std::uint8_t> bytes) {
    sweep_parts_of(file);
    write_new_file(part_path(file), file, bytes, true);
    put_in_place(file);
}

void write_whole_file(const fs::path& file, std::string_view text) { write_whole_file(file, bytes_of(text)); }

void write_staged_file(const fs::path& file, std::span<const std::uint8_t> bytes) {
    write_new_file(file, file, bytes, false);
}

void write_staged_file(const fs::path& file, std::string_view text) { write_staged_file(file, bytes_of(text)); }

void finish_part(const fs::path& file) {
    const fs::path part = part_path(file);
    const OpenFile written(::open(part.c_str(), O_RDONLY | O_CLOEXEC));
    if (!written || fsync(written.get()) != 0) {
        const int error = errno;
        remove_quietly(part);
        fail_to_write(file, "could not be written", error);
    }
    put_in_place(file);
}

std::vector<std::uint8_t> read_whole_file(const fs::path& file, std::uint64_t most) {
    const File in(std::fopen(file.c_str(), "rb"));
    const auto fail = [&](const char* what, int error) {
        throw FileError(fmt::format("{}: {} ({})", file.string(), what, std::strerror(error)));
    };
    if (!in) fail("cannot be opened for reading", errno);
    const auto size = size_of_open(fileno(in.get()));
    if (!size) fail("is no file that can be read", errno);
    if (*size > most)
        throw FileError(fmt::format("{}: has {} bytes, more than the {} that a file of this kind may have",
                                    file.string(), *size, most));
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(*size));
    if (std::fread(bytes.data(), 1, bytes.size(), in.get()) != bytes.size())
        fail("could not be read to its end", std::ferror(in.get()) ? errno : EIO);
    return bytes;
}

}  // namespace voxtone::io
