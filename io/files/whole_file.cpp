// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/error.h"

namespace voxtone::io {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail(const std::filesystem::path& file, const char* what, int error) {
    throw FileError(fmt::format("{}: {} ({})", file.string(), what, std::strerror(error)));
}

}  // namespace

std::filesystem::path part_path(const std::filesystem::path& file) {
    return file.parent_path() / fmt::format(".{}.part", file.filename().string());
}

void write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
    const auto part = part_path(file);
    File out(std::fopen(part.c_str(), "wb"));
    if (!out) fail(file, "cannot be created; is the folder there, writable and not full?", errno);
    std::setvbuf(out.get(), nullptr, _IONBF, 0);
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size();
    const int write_error = errno;
    const bool closed = std::fclose(out.release()) == 0;
    if (!written || !closed) {
        std::remove(part.c_str());
        fail(file, "could not be written; is the disk full?", written ? errno : write_error);
    }
    finish_part(file);
}

void write_whole_file(const std::filesystem::path& file, std::string_view text) {
    write_whole_file(file, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void finish_part(const std::filesystem::path& file) {
    std::error_code error;
    std::filesystem::rename(part_path(file), file, error);
    if (error) {
        std::error_code ignored;
        std::filesystem::remove(part_path(file), ignored);
        throw FileError(fmt::format("{}: could not be put in place ({})", file.string(), error.message()));
    }
}

std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& file, std::uint64_t most) {
    File in(std::fopen(file.c_str(), "rb"));
    if (!in) fail(file, "cannot be opened for reading", errno);
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    if (error) throw FileError(fmt::format("{}: is no file that can be read ({})", file.string(), error.message()));
    if (size > most)
        throw FileError(fmt::format("{}: has {} bytes, more than the {} that a file of this kind may have",
                                    file.string(), size, most));
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
    if (std::fread(bytes.data(), 1, bytes.size(), in.get()) != bytes.size())
        fail(file, "could not be read to its end", std::ferror(in.get()) ? errno : EIO);
    return bytes;
}

}  // namespace voxtone::io
