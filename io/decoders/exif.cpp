// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/exif.h"

#include <cstddef>

namespace voxtone::io {

namespace {

/// Numbers of either byte order; what lies outside of the block is 0.
class ExifBlock {
public:
    explicit ExifBlock(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    [[nodiscard]] bool has(std::size_t at, std::size_t count) const {
        return at <= bytes_.size() && bytes_.size() - at >= count;
    }
    [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t count) const {
        std::uint32_t value = 0;
        if (!has(at, count)) return 0;
        for (std::size_t i = 0; i < count; ++i)
            value = value << 8 | bytes_[at + (bytes_[0] == 'I' ? count - 1 - i : i)];
        return value;
    }
    [[nodiscard]] double rational(std::size_t at) const {
        const double below = number(at + 4, 4);
        return below > 0 ? number(at, 4) / below : 0;
    }

private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace

ExifFacts exif_facts(std::span<const std::uint8_t> exif) {
    constexpr std::size_t entry_bytes = 12, value_at = 8;
    enum Tag { orientation = 0x0112, x_resolution = 0x011a, y_resolution = 0x011b, resolution_unit = 0x0128 };
    const ExifBlock block(exif);
    ExifFacts facts;
    double per_inch = 1;  // the unit where none is said
    const std::size_t directory = block.number(4, 4);
    const std::size_t entries = block.number(directory, 2);
    for (std::size_t i = 0; i < entries && block.has(directory + 2 + i * entry_bytes, entry_bytes); ++i) {
        const std::size_t entry = directory + 2 + i * entry_bytes, value = entry + value_at;
        switch (block.number(entry, 2)) {
            case orientation:
                facts.orientation = static_cast<int>(block.number(value, 2));
                break;
            case x_resolution:
                facts.dpi_x = block.rational(block.number(value, 4));
                break;
            case y_resolution:
                facts.dpi_y = block.rational(block.number(value, 4));
                break;
            case resolution_unit:
                per_inch = block.number(value, 2) == 3 ? 2.54 : block.number(value, 2) == 2 ? 1 : 0;
                break;
            default:
                break;
        }
    }
    facts.dpi_x *= per_inch;
    facts.dpi_y *= per_inch;
    if (facts.orientation < 1 || facts.orientation > 8) facts.orientation = 1;
    return facts;
}

}  // namespace voxtone::io
