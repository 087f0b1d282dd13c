// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/zip_reader.h"

#include <zip.h>

#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/read_bytes.h"
#include "io/files/whole_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

std::filesystem::path archive(const TemporaryFolder& folder,
                              const std::vector<std::pair<std::string, std::string>>& parts) {
    const std::filesystem::path file = folder.path() / "x.zip";
    zip_t* const zip = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    REQUIRE(zip);
    for (const auto& [name, bytes] : parts)
        REQUIRE(zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0) >= 0);
    REQUIRE(zip_close(zip) == 0);
    return file;
}

}  // namespace

TEST_CASE("Parts of an archive, from a file and from memory", "[zip]") {
    const TemporaryFolder folder;
    const auto file = archive(folder, {{"a/One.txt", "one"}, {"two", std::string(100'000, '2')}, {"empty", ""}});
    const auto bytes = read_bytes(file, 1 << 20);
    const ZipReader from_file(file), from_memory(bytes, "x.zip");
    for (const ZipReader* zip : {&from_file, &from_memory}) {
        CHECK(zip->names() == std::vector<std::string>{"a/One.txt", "two", "empty"});
        CHECK(zip->find("/a/one.TXT") == std::size_t{0});
        CHECK_FALSE(zip->find("one.txt"));
        CHECK_FALSE(zip->read("three"));
        CHECK(zip->read("two")->size() == 100'000);
        CHECK(zip->read("empty")->empty());
        CHECK(zip->read(0, 3) == std::vector<std::uint8_t>{'o', 'n', 'e'});
        CHECK_THROWS_WITH(zip->read(0, 2), Contains("a/One.txt") && Contains("3 bytes, more than the 2"));
    }
    CHECK_THROWS_AS(ZipReader(folder.path() / "not-there.zip"), FileError);
    write_whole_file(folder.path() / "empty.zip", std::string());
    CHECK_THROWS_WITH(ZipReader(folder.path() / "empty.zip"), Contains("empty.zip: is empty"));
    CHECK_THROWS_AS(ZipReader(std::span(bytes).first(bytes.size() / 2), "cut"), InputError);
}

TEST_CASE("An archive may not declare more than its limits", "[zip]") {
    const TemporaryFolder folder;
    const auto file = archive(folder, {{"a", std::string(600, 'a')}, {"b", std::string(500, 'b')}});
    CHECK_NOTHROW(ZipReader(file, {.total_bytes = 1100}));
    CHECK_THROWS_WITH(ZipReader(file, {.total_bytes = 1099}), Contains("more than 1099 bytes"));
    const ZipReader parts(file, {.part_bytes = 500});
    CHECK(parts.read("b")->size() == 500);
    CHECK_THROWS_AS(parts.read("a"), InputError);
    // 65 MiB of zeros in 65 kB: refused by its ratio, before a byte is unpacked.
    const ZipReader bomb(archive(folder, {{"zeros", std::string(std::size_t{65} << 20, '\0')}}));
    CHECK_THROWS_WITH(bomb.read("zeros"), Contains("200 times its size"));
}

TEST_CASE("A spoilt part is refused", "[zip]") {
    const TemporaryFolder folder;
    const auto file = archive(folder, {{"part", "some text that is stored or packed, and under a checksum"}});
    auto bytes = read_whole_file(file, 1 << 20);
    bytes[30 + 4 + 5] ^= 0x55;  // behind the local header and the name
    write_whole_file(file, bytes);
    const ZipReader zip(file);
    CHECK_THROWS_WITH(zip.read("part"), Contains("part 'part'"));
}

TEST_CASE("A part that is locked, or packed in another way, is refused with a way out", "[zip]") {
    const TemporaryFolder folder;
    const auto file = archive(folder, {{"part", "some text"}});
    const auto bytes = read_whole_file(file, 1 << 20);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t entry = text.find("PK\1\2");
    const auto changed = [&](std::size_t local, std::size_t in_entry, std::uint8_t value) {
        auto other = bytes;
        other[local] = other[entry + in_entry] = value;
        return std::vector<std::byte>(reinterpret_cast<const std::byte*>(other.data()),
                                      reinterpret_cast<const std::byte*>(other.data()) + other.size());
    };
    const auto locked = changed(6, 8, static_cast<std::uint8_t>(bytes[6] | 1)), other = changed(8, 10, 77);
    CHECK_THROWS_WITH(ZipReader(locked, "a.zip").read("part"), Contains("password") && Contains("unpack the archive"));
    CHECK_THROWS_WITH(ZipReader(other, "a.zip").read("part"), Contains("ordinary ZIP"));
}
