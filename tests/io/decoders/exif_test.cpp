// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/exif.h"

#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone::io;

namespace {

/// A block of one directory, as CIPA DC-008 has it: byte order, 42, where the directory is, entries, values behind it.
class Block {
public:
    Block(bool little, std::uint32_t entries, std::uint32_t gap = 0) : little_(little) {
        bytes_ = little ? std::vector<std::uint8_t>{'I', 'I'} : std::vector<std::uint8_t>{'M', 'M'};
        put(42, 2), put(8 + gap, 4);
        bytes_.resize(bytes_.size() + gap);
        put(entries, 2);
        values_at_ = static_cast<std::uint32_t>(bytes_.size()) + 12 * entries + 4;
    }
    Block& of_short(std::uint32_t tag, std::uint32_t value) {
        put(tag, 2), put(3, 2), put(1, 4), put(value, 2), put(0, 2);
        return *this;
    }
    Block& of_rational(std::uint32_t tag, std::uint32_t above, std::uint32_t below) {
        put(tag, 2), put(5, 2), put(1, 4), put(values_at_ + static_cast<std::uint32_t>(4 * values_.size()), 4);
        values_.push_back(above), values_.push_back(below);
        return *this;
    }
    std::vector<std::uint8_t> bytes() {
        put(0, 4);  // no further directory
        for (const std::uint32_t value : values_) put(value, 4);
        return bytes_;
    }

private:
    void put(std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bytes_.push_back(std::uint8_t(value >> 8 * (little_ ? i : count - 1 - i)));
    }
    bool little_;
    std::uint32_t values_at_ = 0;
    std::vector<std::uint8_t> bytes_;
    std::vector<std::uint32_t> values_;
};

constexpr std::uint32_t orientation = 0x0112, x_resolution = 0x011a, y_resolution = 0x011b, resolution_unit = 0x0128;

}  // namespace

TEST_CASE("Exif of either byte order says how a picture is turned and how fine it is", "[decoders]") {
    for (const bool little : {false, true})
        for (const std::uint32_t gap : {0u, 14u}) {
            CAPTURE(little, gap);
            const ExifFacts facts = exif_facts(Block(little, 4, gap)
                                                   .of_short(orientation, 6)
                                                   .of_rational(x_resolution, 600, 2)
                                                   .of_rational(y_resolution, 1000, 3)
                                                   .of_short(resolution_unit, 2)
                                                   .bytes());
            CHECK(facts.orientation == 6);
            CHECK(facts.dpi_x == 300);
            CHECK(facts.dpi_y == Approx(1000.0 / 3));
        }
}

TEST_CASE("Exif's resolution has the unit that is said, inches where none is", "[decoders]") {
    const auto dpi_x = [](std::uint32_t unit) {
        return exif_facts(Block(true, 2).of_rational(x_resolution, 100, 1).of_short(resolution_unit, unit).bytes())
            .dpi_x;
    };
    CHECK(dpi_x(2) == 100);
    CHECK(dpi_x(3) == Approx(254));
    CHECK(dpi_x(1) == 0);  // no length
    CHECK(dpi_x(4) == 0);
    CHECK(exif_facts(Block(true, 1).of_rational(y_resolution, 72, 1).bytes()).dpi_y == 72);
    CHECK(exif_facts(Block(true, 1).of_rational(x_resolution, 72, 0).bytes()).dpi_x == 0);
}

TEST_CASE("What Exif cannot say, or what is cut off, changes nothing", "[decoders]") {
    for (const std::uint32_t odd : {0u, 9u, 65535u})
        CHECK(exif_facts(Block(false, 1).of_short(orientation, odd).bytes()).orientation == 1);
    for (const std::uint32_t known : {1u, 8u})
        CHECK(exif_facts(Block(false, 1).of_short(orientation, known).bytes()).orientation == int(known));
    CHECK(exif_facts(Block(false, 1).of_short(0x0132, 5).bytes()).orientation == 1);  // another tag
    for (const bool little : {false, true}) {
        const std::vector<std::uint8_t> whole =
            Block(little, 2).of_short(orientation, 3).of_rational(x_resolution, 300, 1).bytes();
        for (std::size_t length = 0; length < whole.size(); ++length) {
            // In memory of its own, where reading beyond the end is noticed.
            const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + std::ptrdiff_t(length));
            const ExifFacts facts = exif_facts(cut);
            CHECK(facts.orientation == (length < 22 ? 1 : 3));
            CHECK(facts.dpi_x == 0);
        }
        CHECK(exif_facts(whole).dpi_x == 300);
    }
}
