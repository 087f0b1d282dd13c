// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/read_bytes.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::io {

std::vector<std::byte> read_bytes(const std::filesystem::path& path, std::uint64_t max_bytes) {
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        throw FileError(fmt::format("{} does not exist; check the path", path.string()));
    if (!std::filesystem::is_regular_file(path, error)) throw FileError(fmt::format("{} is not a file", path.string()));
    std::ifstream file(path, std::ios::binary);
    if (!file) throw FileError(fmt::format("{} cannot be opened ({})", path.string(), std::strerror(errno)));
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw FileError(fmt::format("{} cannot be read ({})", path.string(), error.message()));
    if (size > max_bytes)
        throw InputError(fmt::format("{} has {} bytes, more than the {} allowed", path.string(), size, max_bytes));
    std::vector<std::byte> bytes(size);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(file.gcount()) != size)
        throw FileError(fmt::format("{} cannot be read to its end", path.string()));
    return bytes;
}

}  // namespace voxtone::io
