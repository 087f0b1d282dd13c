// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/readers.h"
#include "tests/places.h"

#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

namespace fs = std::filesystem;
using namespace voxtone::test;

namespace {

std::vector<std::uint8_t> contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("every seed and every input that ever failed is read or refused", "[fuzz]") {
    for (const Reader& reader : all_readers()) {
        const fs::path folder = fs::path(test_data()) / "fuzz" / reader.name;
        if (!fs::exists(folder)) continue;
        for (const auto& file : fs::directory_iterator(folder)) {
            INFO(file.path().string());
            CHECK_NOTHROW(read_or_refuse(reader, contents(file.path())));
        }
    }
}

TEST_CASE("the seeds that are called good are read, so that the fuzzer starts behind the first check", "[fuzz]") {
    int good = 0;
    for (const Reader& reader : all_readers()) {
        const fs::path folder = fs::path(test_data()) / "fuzz" / reader.name;
        if (!fs::exists(folder)) continue;
        for (const auto& file : fs::directory_iterator(folder)) {
            if (!file.path().filename().string().starts_with("good")) continue;
            INFO(file.path().string());
            CHECK_NOTHROW(reader.read(contents(file.path())));
            ++good;
        }
    }
    CHECK(good >= 12);
}
