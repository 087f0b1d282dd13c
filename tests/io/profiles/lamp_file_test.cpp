// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/lamp_file.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/profiles/resin_file.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

std::string table_of_a(const std::string& header, char separator, char point) {
    const optics::LampPower a = optics::known_lamp("A").value();
    std::string text = header;
    for (std::size_t k = 0; k < a.size(); ++k) {
        std::string row = std::to_string(380 + 5 * k) + separator + std::to_string(a[k]) + "\n";
        for (char& c : row)
            if (c == '.') c = point;
        text += row;
    }
    return text;
}

}  // namespace

TEST_CASE("A lamp's table is read with a header and without, with points and with commas") {
    const optics::LampPower a = optics::known_lamp("A").value();
    for (const std::string& text :
         {table_of_a("", ',', '.'), table_of_a("nm,power\n", ',', '.'), table_of_a("# my LED\nnm;W\n", ';', ',')}) {
        const optics::LampPower power = parse_lamp(text, "lamp.csv");
        for (std::size_t k = 0; k < a.size(); ++k) CHECK(power[k] == Approx(a[k]).epsilon(1e-5));
    }
}

TEST_CASE("What is no lamp is refused in a sentence") {
    const auto refused = [](const std::string& text, const std::string& why) {
        CAPTURE(text);
        CHECK_THROWS_WITH(parse_lamp(text, "lamp.csv"), Contains("lamp.csv") && Contains(why));
    };
    refused("", "known nowhere");
    refused("nm,power\n", "known nowhere");
    refused("nm,power\n400,1\n690,1\n", "from 400 to 690 nm");
    refused("nm,power\n400,1\n700,lots\n", "line 3 is not two numbers");
    refused("nm,power\n400,1\n400,1\n700,1\n", "line 3 has 400 nm");
    refused("nm,power\n400,1\n500,-1\n700,1\n", "line 3 has the power -1");
    refused("nm,power\n380,1\n400,0\n700,0\n", "is 0: a print is black");
    refused("power\n1\n2\n", "is not two numbers");
    CHECK_THROWS_WITH(find_lamp("F99"), Contains("--illuminant F99") && Contains("LED-B3") && Contains("2700K"));
}

TEST_CASE("A set says under which lamp it is seen, and is a guess where it has no wavelengths") {
    const optics::ResinSet set = find_resin_set("vero-opaque");
    for (const char* usual : {"", "D65"}) {
        CHECK(seen_under(set, usual).channels == set.channels);
        CHECK(seen_under(set, usual).name == set.name);
        CHECK_FALSE(lamp_doubt(set, usual));
    }
    CHECK(seen_under(set, "F11").name == "vero-opaque under F11");
    CHECK(seen_under(set, "F11").channels.is_own());
    CHECK_THAT(lamp_doubt(set, "F11").value(), Contains("R, G, B") && Contains("[guessed-light]"));
    optics::ResinSet spectral = set;
    spectral.channels.wavelengths_nm = {450, 550, 610};
    CHECK_FALSE(lamp_doubt(spectral, "F11"));
    CHECK(seen_under(spectral, "F11").channels.size() == 3);
}
