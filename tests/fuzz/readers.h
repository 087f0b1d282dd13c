// SPDX-License-Identifier: GPL-3.0-or-later
//
// All readers of files that come from elsewhere, as functions of bytes: what the fuzzer calls
// (tests/fuzz/fuzz_main.cpp) and what every input that ever failed is read with again (tests/fuzz/regression_test.cpp).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::test {

using Bytes = std::span<const std::uint8_t>;

struct Reader {
    std::string_view name;  ///< also of its folder of seeds in tests/data/fuzz
    void (*read)(Bytes file);
};

[[nodiscard]] std::span<const Reader> all_readers();

/// Reads, and takes every refusal in words for an answer (Error, std::bad_alloc). Another exception is a finding.
void read_or_refuse(const Reader& reader, Bytes file);

}  // namespace voxtone::test
