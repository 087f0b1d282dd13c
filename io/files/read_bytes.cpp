// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/read_bytes.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "io/disk/open_file.h"
#include "io/files/utf8.h"

namespace voxtone::io {

namespace {

struct CloseBytes {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

std::vector<std::byte> read_bytes(const std::filesystem::path& path, std::uint64_t max_bytes) {
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        throw FileError(fmt::format("{} does not exist; check the path", path.string()));
    if (!std::filesystem::is_regular_file(path, error)) throw FileError(fmt::format("{} is not a file", path.string()));
    const std::unique_ptr<std::FILE, CloseBytes> file(std::fopen(path.c_str(), "rb"));
    if (!file) throw FileError(fmt::format("{} cannot be opened ({})", path.string(), std::strerror(errno)));
    const auto size = size_of_open(fileno(file.get()));
    if (!size) throw FileError(fmt::format("{} cannot be read ({})", path.string(), std::strerror(errno)));
    if (*size > max_bytes)
        throw InputError(fmt::format("{} has {} bytes, more than the {} allowed", path.string(), *size, max_bytes));
    std::vector<std::byte> bytes(static_cast<std::size_t>(*size));
    if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
        throw FileError(fmt::format("{} cannot be read to its end", path.string()));
    return bytes;
}

std::string read_text(const std::filesystem::path& path, std::uint64_t max_bytes) {
    const std::vector<std::byte> bytes = read_bytes(path, max_bytes);
    return text_as_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace voxtone::io
