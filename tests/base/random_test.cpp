// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.h"

#include <catch2/catch.hpp>

using namespace voxtone;

TEST_CASE("Philox agrees with the known answers of Salmon et al. 2011") {
    // Known-answer vectors of the authors' Random123 distribution, file kat_vectors, philox4x32 10.
    using Words = std::array<std::uint32_t, 4>;
    CHECK(philox4x32({0, 0, 0, 0}, {0, 0}) == Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
    CHECK(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
          Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    CHECK(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
          Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("A stream is the blocks of its counter one after the other, each word once") {
    const std::uint64_t seed = 0x0123456789abcdef, address = 0xfedcba9876543210;
    RandomStream stream(seed, address, 5);
    for (std::uint32_t n = 0; n < 1000; ++n)
        CHECK(stream.bits() == philox4x32({n / 4, 5, 0x76543210u, 0xfedcba98u}, {0x89abcdefu, 0x01234567u})[n % 4]);
    CHECK(unit_interval(0) == 0);
    CHECK(unit_interval(0x80000000u) == 0.5);
    CHECK(unit_interval(0xffffffffu) < 1);
}

TEST_CASE("A stream is a function of its address and uniform") {
    RandomStream a(7, 42), b(7, 42), other(7, 43);
    double sum = 0, sum_of_squares = 0;
    int equal = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double u = a.uniform();
        CHECK(u == b.uniform());
        equal += u == other.uniform();
        sum += u;
        sum_of_squares += u * u;
    }
    CHECK(equal < 3);  // two streams share a 32-bit value with probability n / 2^32 = 2e-5
    // Five standard deviations of the mean of u (1/sqrt(12 n)) and of u^2 (sqrt(4/45 / n)).
    CHECK(std::abs(sum / n - 0.5) < 5 / std::sqrt(12.0 * n));
    CHECK(std::abs(sum_of_squares / n - 1.0 / 3) < 5 * std::sqrt(4.0 / 45 / n));
}
