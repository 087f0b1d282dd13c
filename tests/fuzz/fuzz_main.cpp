// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-fuzz: libFuzzer around one of our readers, named by the environment variable VOXTONE_READER; run by
// tools/fuzz.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/readers.h"

namespace {

const voxtone::test::Reader& chosen() {
    const char* const name = std::getenv("VOXTONE_READER");
    for (const auto& reader : voxtone::test::all_readers())
        if (name && reader.name == name) return reader;
    std::fputs("VOXTONE_READER is to be one of:", stderr);
    for (const auto& reader : voxtone::test::all_readers()) std::fprintf(stderr, " %s", reader.name.data());
    std::fputs("\n", stderr);
    std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const voxtone::test::Reader& reader = chosen();
    voxtone::test::read_or_refuse(reader, {data, size});
    return 0;
}
