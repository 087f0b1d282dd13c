// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/meshopt_stream.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "base/error.h"
#include "base/printable.h"

namespace voxtone::io {

namespace {

/// How a stream begins: the kind in the upper half of its first byte, the version in the lower.
constexpr unsigned kind_of_vertices = 0xa, kind_of_triangles = 0xe, kind_of_indices = 0xd;

enum class Mode { attributes, triangles, indices };

Mode mode_of(const std::string& mode) {
    if (mode == "ATTRIBUTES") return Mode::attributes;
    if (mode == "TRIANGLES") return Mode::triangles;
    if (mode == "INDICES") return Mode::indices;
    throw InputError(fmt::format("it has the unknown mode '{}'", printable(mode)));
}

unsigned kind_of(Mode mode) {
    return mode == Mode::attributes ? kind_of_vertices : mode == Mode::triangles ? kind_of_triangles : kind_of_indices;
}

void check_shape(const MeshoptStream& s, Mode mode) {
    constexpr std::int64_t longest_stride = 256;
    const bool fits = mode == Mode::attributes ? s.stride > 0 && s.stride <= longest_stride && s.stride % 4 == 0
                                               : s.stride == 2 || s.stride == 4;
    if (!fits) throw InputError(fmt::format("elements of {} bytes are not for its mode {}", s.stride, s.mode));
    if (s.count < 0 || (mode == Mode::triangles && s.count % 3 != 0))
        throw InputError(fmt::format("it declares {} elements", s.count));
}

/// A byte of a stream stands for some 250 elements at most.
void check_count(const MeshoptStream& s, std::uint64_t most_bytes) {
    constexpr std::uint64_t most_a_byte = 256;
    const auto count = static_cast<std::uint64_t>(s.count), stride = static_cast<std::uint64_t>(s.stride);
    if (count / most_a_byte > s.bytes.size())
        throw InputError(
            fmt::format("it declares {} elements, more than its {} bytes can hold", s.count, s.bytes.size()));
    if (count > most_bytes / stride)
        throw InputError(fmt::format("it declares {} elements of {} bytes, more than the {} bytes that may be unpacked",
                                     s.count, s.stride, most_bytes));
}

using Filter = void (*)(void* buffer, std::size_t count, std::size_t stride);

/// Null: none is to be applied. What the library does not know is told in `newer`.
Filter filter_of(const MeshoptStream& s, Mode mode, std::string& newer) {
    if (s.filter == "NONE" || s.filter.empty()) return nullptr;
    if (mode != Mode::attributes)
        throw InputError(fmt::format("the filter {} is not for its mode {}", printable(s.filter), s.mode));
    Filter filter = nullptr;
    bool fits = false;
    if (s.filter == "OCTAHEDRAL") {
        filter = meshopt_decodeFilterOct;
        fits = s.stride == 4 || s.stride == 8;
    } else if (s.filter == "QUATERNION") {
        filter = meshopt_decodeFilterQuat;
        fits = s.stride == 8;
    } else if (s.filter == "EXPONENTIAL") {
        filter = meshopt_decodeFilterExp;
        fits = true;
    } else {
        newer = fmt::format("the filter {}", printable(s.filter));
        return nullptr;
    }
    if (!fits) throw InputError(fmt::format("elements of {} bytes are not for its filter {}", s.stride, s.filter));
    return filter;
}

int decode(const MeshoptStream& s, Mode mode, std::vector<std::byte>& to) {
    const auto* const from = reinterpret_cast<const unsigned char*>(s.bytes.data());
    const auto count = static_cast<std::size_t>(s.count), stride = static_cast<std::size_t>(s.stride);
    switch (mode) {
        case Mode::attributes:
            return meshopt_decodeVertexBuffer(to.data(), count, stride, from, s.bytes.size());
        case Mode::triangles:
            return meshopt_decodeIndexBuffer(to.data(), count, stride, from, s.bytes.size());
        default:
            return meshopt_decodeIndexSequence(to.data(), count, stride, from, s.bytes.size());
    }
}

}  // namespace

MeshoptResult decode_meshopt(const MeshoptStream& stream, std::uint64_t most_bytes) {
    const Mode mode = mode_of(stream.mode);
    check_shape(stream, mode);
    check_count(stream, most_bytes);
    MeshoptResult result;
    const Filter filter = filter_of(stream, mode, result.newer);
    if (!result.newer.empty()) return result;
    result.bytes.resize(static_cast<std::size_t>(stream.count) * static_cast<std::size_t>(stream.stride));
    constexpr int wrong_head = -1;
    if (const int status = decode(stream, mode, result.bytes); status != 0) {
        const unsigned first = stream.bytes.empty() ? 0 : std::to_integer<unsigned>(stream.bytes[0]);
        if (status != wrong_head || first >> 4 != kind_of(mode)) throw InputError("it is damaged or cut short");
        result.newer = fmt::format("version {} of its coding", first & 0xf);
        return result;
    }
    if (filter && stream.count > 0)
        filter(result.bytes.data(), static_cast<std::size_t>(stream.count), static_cast<std::size_t>(stream.stride));
    return result;
}

}  // namespace voxtone::io
