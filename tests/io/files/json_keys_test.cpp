// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_keys.h"

#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone::io;

namespace {
const std::vector<std::string> keys{"pitch_um", "printer", "layers", "size"};
}

TEST_CASE("A slip of the keyboard names the key that was meant") {
    CHECK(nearest_name("pich_um", keys) == "pitch_um");  // a letter left out
    CHECK(nearest_name("pirnter", keys) == "printer");   // two letters swapped
    CHECK(nearest_name("layerss", keys) == "layers");    // one too many
    CHECK(nearest_name("pitch", keys) == "pitch_um");    // its unit forgotten
    CHECK(nearest_name("siza", keys) == "size");         // a wrong one
    CHECK(unknown_key_message("pich_um", keys) == "unknown key 'pich_um'; did you mean 'pitch_um'?");
}

TEST_CASE("A key like no other names them all, and a monster is cut") {
    CHECK(nearest_name("quux", keys).empty());
    // Half of the shorter word is another word.
    const std::vector<std::string> words{"out", "copies", "turn"};
    CHECK(nearest_name("count", words).empty());
    CHECK(nearest_name("pitch", words).empty());
    CHECK(nearest_name("tune", words).empty());
    CHECK(nearest_name("copys", words) == "copies");
    CHECK(nearest_name("uot", words) == "out");
    CHECK(unknown_key_message("quux", keys) == "unknown key 'quux'; known keys are pitch_um, printer, layers, size");
    CHECK(unknown_key_message(std::string(1'000'000, 'x'), keys).size() < 200);
    CHECK(nearest_name("", keys).empty());
}
