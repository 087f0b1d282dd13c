// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/deflate.h"

#include <algorithm>

#include <zlib.h>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::io {

std::vector<std::byte> deflated(std::span<const std::byte> bytes, int level) {
    uLongf size = compressBound(bytes.size());
    std::vector<std::byte> out(size);
    const int result = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), level);
    VOXTONE_ENSURE(result == Z_OK);
    out.resize(size);
    return out;
}

std::vector<std::byte> inflated(std::span<const std::byte> bytes, std::size_t size) {
    constexpr std::size_t most_ratio = 1032;  // of zlib's format
    if (size / most_ratio > bytes.size()) throw InputError("holds fewer bytes than it says");
    std::vector<std::byte> out(size);
    uLongf given = size;
    const int result = uncompress(reinterpret_cast<Bytef*>(out.data()), &given,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (result != Z_OK || given != size) throw InputError("holds other bytes than it says");
    return out;
}

std::vector<std::byte> inflated_up_to(std::span<const std::byte> bytes, std::size_t most) {
    for (std::size_t size = std::min(most, 4 * bytes.size() + 1024);; size = std::min(most, 4 * size)) {
        std::vector<std::byte> out(size);
        uLongf given = size;
        const int result = uncompress(reinterpret_cast<Bytef*>(out.data()), &given,
                                      reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
        if (result == Z_OK) {
            out.resize(given);
            return out;
        }
        if (result != Z_BUF_ERROR) throw InputError("is damaged");
        if (size == most) throw InputError("is cut short, or larger than it may be");
    }
}

}  // namespace voxtone::io
