// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/tiff_white.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace voxtone::io {

namespace {

/// Numbers of a TIFF in its order of bytes; past the end 0.
class TiffNumbers {
public:
    explicit TiffNumbers(std::span<const std::byte> file)
        : file_(file),
          big_endian_(!file.empty() && file[0] == std::byte{'M'}),
          wide_(at(2, 2) == 43),  // BigTIFF: places and counts have 64 bits
          place_bytes_(wide_ ? 8 : 4) {}

    [[nodiscard]] std::uint64_t at(std::uint64_t place, std::size_t bytes) const {
        std::uint64_t value = 0;
        if (place > file_.size() || bytes > file_.size() - place) return 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | std::to_integer<std::uint64_t>(file_[place + (big_endian_ ? i : bytes - 1 - i)]);
        return value;
    }
    [[nodiscard]] std::size_t entry_bytes() const { return wide_ ? 20 : 12; }
    [[nodiscard]] std::uint64_t first_page() const { return at(wide_ ? 8 : 4, place_bytes_); }
    [[nodiscard]] std::uint64_t entries(std::uint64_t page) const { return at(page, wide_ ? 8 : 2); }
    [[nodiscard]] std::uint64_t first_entry(std::uint64_t page) const { return page + (wide_ ? 8 : 2); }
    [[nodiscard]] std::uint64_t next_page(std::uint64_t page) const {
        return at(first_entry(page) + entries(page) * entry_bytes(), place_bytes_);
    }
    /// Number `index` of an entry of fractions or floating point; not a number where it is of another type.
    [[nodiscard]] double value(std::uint64_t entry, std::uint64_t index) const {
        enum Type { rational = 5, single = 11, wide = 12 };
        const std::uint64_t type = at(entry + 2, 2), count = at(entry + 4, place_bytes_);
        const std::uint64_t bytes = type == single ? 4 : 8, here = entry + 4 + place_bytes_;
        const std::uint64_t from = count * bytes <= place_bytes_ ? here : at(here, place_bytes_);
        const std::uint64_t place = from + index * bytes;
        if (index >= count || count > 2) return std::nan("");
        if (type == rational) return double(at(place, 4)) / double(at(place + 4, 4));
        if (type == single) return double(std::bit_cast<float>(static_cast<std::uint32_t>(at(place, 4))));
        return type == wide ? std::bit_cast<double>(at(place, 8)) : std::nan("");
    }

private:
    std::span<const std::byte> file_;
    bool big_endian_, wide_;
    std::size_t place_bytes_;
};

}  // namespace

std::optional<std::array<double, 2>> tiff_white(std::span<const std::byte> file, int page) {
    constexpr std::uint64_t white_point = 318, most_entries = 4096;
    const TiffNumbers numbers(file);
    std::uint64_t place = numbers.first_page();
    for (int i = 0; i < page && place != 0; ++i) place = numbers.next_page(place);
    if (place == 0 || numbers.entries(place) > most_entries) return std::nullopt;
    for (std::uint64_t i = 0; i < numbers.entries(place); ++i) {
        const std::uint64_t entry = numbers.first_entry(place) + i * numbers.entry_bytes();
        if (numbers.at(entry, 2) != white_point) continue;
        const double x = numbers.value(entry, 0), y = numbers.value(entry, 1);
        constexpr double least = 0.05;  // of a white's chromaticity
        if (x >= least && y >= least && x + y <= 1 - least) return std::array{x, y};
    }
    return std::nullopt;
}

}  // namespace voxtone::io
