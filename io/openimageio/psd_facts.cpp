// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/psd_facts.h"

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

/// Image resources: '8BIM', a number, a name with its length, a length, what is said.
bool says_unmerged(std::span<const std::byte> file, std::size_t at, std::size_t end) {
    constexpr std::uint32_t version_info = 1057;
    while (at + 12 <= end && end <= file.size()) {
        const std::uint32_t kind = big_endian_number(file, at + 4, 2);
        const std::size_t name_bytes = std::size_t{big_endian_number(file, at + 6, 1)} + 1;
        at += 6 + name_bytes + name_bytes % 2;
        const std::size_t bytes = big_endian_number(file, at, 4);
        at += 4;
        if (kind == version_info && bytes >= 5 && at + 5 <= end) return big_endian_number(file, at + 4, 1) == 0;
        at += bytes + bytes % 2;
    }
    return false;
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

}  // namespace

PsdFacts psd_facts(std::span<const std::byte> file) {
    constexpr std::size_t mode_at = 24, head_bytes = 26;
    constexpr std::uint32_t cmyk = 4, large = 2;
    const std::size_t long_bytes = big_endian_number(file, 4, 2) == large ? 8 : 4;
    PsdFacts facts{.is_cmyk = big_endian_number(file, mode_at, 2) == cmyk};
    const std::size_t resources = head_bytes + 4 + std::size_t{big_endian_number(file, head_bytes, 4)};  // and palette
    const std::size_t layers = resources + 4 + std::size_t{big_endian_number(file, resources, 4)};
    facts.says_unmerged = says_unmerged(file, resources + 4, layers);
    if (layers < file.size()) facts.hidden = hidden_layers(file, layers + 2 * long_bytes, long_bytes);
    return facts;
}

}  // namespace voxtone::io
