// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/psd_facts.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace voxtone::io {

namespace {

/// Big-endian; past the end 0.
std::uint32_t big_endian_number(std::span<const std::byte> file, std::size_t at, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
        value = value << 8 | (at + i < file.size() ? std::to_integer<std::uint32_t>(file[at + i]) : 0);
    return value;
}

/// Of image resources ('8BIM', a number, a name with its length, a length, what is said) what one says, `least` bytes
/// or more; empty: it is not there.
std::span<const std::byte> resource(std::span<const std::byte> file, std::size_t at, std::size_t end,
                                    std::uint32_t wanted, std::size_t least) {
    while (at + 12 <= end && end <= file.size()) {
        const std::uint32_t kind = big_endian_number(file, at + 4, 2);
        const std::size_t name_bytes = std::size_t{big_endian_number(file, at + 6, 1)} + 1;
        at += 6 + name_bytes + name_bytes % 2;
        const std::size_t bytes = big_endian_number(file, at, 4);
        at += 4;
        if (kind == wanted && bytes >= least && at + least <= end) return file.subspan(at, least);
        at += bytes + bytes % 2;
    }
    return {};
}

/// Layer records, one behind the other; `long_bytes`: of lengths that are longer in large files (PSB).
std::vector<bool> hidden_layers(std::span<const std::byte> file, std::size_t at, std::size_t long_bytes) {
    constexpr std::uint32_t flag_hidden = 2;
    std::vector<bool> hidden;
    const int layers =
        std::abs(int{static_cast<std::int16_t>(big_endian_number(file, at, 2))});  // below 0: there is alpha, too
    at += 2;
    for (int i = 0; i < layers && at + 18 < file.size(); ++i) {
        const std::size_t channels = big_endian_number(file, at + 16, 2);
        at += 18 + channels * (2 + long_bytes) + 8;  // behind '8BIM' and how it is blended
        const bool opaque = big_endian_number(file, at, 1) > 0;
        hidden.push_back(!opaque || (big_endian_number(file, at + 2, 1) & flag_hidden) != 0);
        at += 8 + std::size_t{big_endian_number(file, at + 4, 4)};
    }
    return hidden;
}

constexpr std::size_t mode_at = 24, head_bytes = 26;

/// Where image resources stand, behind their length; behind the palette, which has a length, too.
std::size_t resources_at(std::span<const std::byte> file) {
    return head_bytes + 4 + std::size_t{big_endian_number(file, head_bytes, 4)} + 4;
}
std::size_t end_of_resources(std::span<const std::byte> file) {
    const std::size_t at = resources_at(file);
    return at + std::size_t{big_endian_number(file, at - 4, 4)};
}

}  // namespace

PsdFacts psd_facts(std::span<const std::byte> file) {
    constexpr std::uint32_t cmyk = 4, large = 2, version_info = 1057;
    const std::size_t long_bytes = big_endian_number(file, 4, 2) == large ? 8 : 4;
    PsdFacts facts{.is_cmyk = big_endian_number(file, mode_at, 2) == cmyk};
    const std::size_t resources = resources_at(file), layers = end_of_resources(file);
    const auto version = resource(file, resources, layers, version_info, 5);
    facts.says_unmerged = !version.empty() && version[4] == std::byte{0};
    if (layers < file.size()) facts.hidden = hidden_layers(file, layers + 2 * long_bytes, long_bytes);
    return facts;
}

std::vector<std::byte> with_transparent_index(std::span<const std::byte> file) {
    constexpr std::uint32_t indexed = 2, transparent_index = 1047;
    const std::size_t at = resources_at(file), end = end_of_resources(file);
    if (big_endian_number(file, mode_at, 2) != indexed || end > file.size() ||
        !resource(file, at, end, transparent_index, 2).empty())
        return {};
    static constexpr std::array<std::uint8_t, 14> none{
        '8', 'B', 'I', 'M', transparent_index >> 8, transparent_index & 0xff, 0, 0, 0, 0, 0, 2, 1, 0};
    std::vector<std::byte> told(file.begin(), file.end());
    const std::size_t bytes = end - at + none.size();
    for (std::size_t i = 0; i < 4; ++i) told[at - 1 - i] = static_cast<std::byte>(bytes >> (8 * i) & 0xff);
    const auto* const first = reinterpret_cast<const std::byte*>(none.data());
    told.insert(told.begin() + static_cast<std::ptrdiff_t>(at), first, first + none.size());
    return told;
}

}  // namespace voxtone::io
