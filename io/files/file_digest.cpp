// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/file_digest.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/sha256.h"

namespace voxtone::io {

std::string file_sha256(const std::filesystem::path& file, const Progress* progress) {
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

}  // namespace voxtone::io
