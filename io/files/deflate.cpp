// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/deflate.h"

#include <algorithm>
#include <memory>

#include <fmt/core.h>
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

std::vector<std::byte> gunzipped(std::span<const std::byte> bytes, std::size_t most) {
    constexpr int with_header = 15 + 16;  // the largest window, and gzip's header (zlib.h)
    constexpr std::size_t chunk = std::size_t{1} << 20;
    z_stream stream{};
    VOXTONE_ENSURE(inflateInit2(&stream, with_header) == Z_OK);
    const std::unique_ptr<z_stream, int (*)(z_stream*)> owner(&stream, &inflateEnd);
    std::vector<std::byte> out;
    for (;;) {
        const std::size_t before = out.size(), given = std::min(bytes.size(), chunk);
        out.resize(before + chunk);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
        stream.avail_in = static_cast<uInt>(given);
        stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
        stream.avail_out = static_cast<uInt>(chunk);
        const int result = inflate(&stream, Z_NO_FLUSH);
        if (result == Z_BUF_ERROR) throw InputError("is cut short");  // there is room: it lacks bytes
        if (result != Z_OK && result != Z_STREAM_END) throw InputError("is damaged");
        bytes = bytes.subspan(given - stream.avail_in);
        out.resize(out.size() - stream.avail_out);
        if (out.size() > most) throw InputError(fmt::format("comes to more than {} bytes", most));
        if (result == Z_STREAM_END) {
            const bool more = bytes.size() > 1 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
            if (!more) return out;
            inflateReset(&stream);
        }
    }
}

}  // namespace voxtone::io
