// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/layer_sequence_file.h"

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

LayerSequence jade() {
    LayerSequence sequence;
    sequence.name = "jade \"2\"";
    sequence.source = "a test";
    sequence.resins = "vero-opaque";
    sequence.layers = {{"W", 0.3}, {"K", 0.1}, {"W", 1.0 / 3}};
    return sequence;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

}  // namespace

TEST_CASE("A laminate file comes back as it was written") {
    for (const bool measured : {false, true}) {
        LayerSequence sequence = jade();
        if (measured) {
            sequence.resins.clear();
            sequence.surface = "matched";
            sequence.backing = "black-sheet.json";
            sequence.layers.clear();
        }
        const LayerSequence back = parse_layer_sequence(layer_sequence_text(sequence), "test");
        CHECK(back.name == sequence.name);
        CHECK(back.source == sequence.source);
        CHECK(back.resins == sequence.resins);
        CHECK(back.surface == sequence.surface);
        CHECK(back.backing == sequence.backing);
        REQUIRE(back.layers.size() == sequence.layers.size());
        for (std::size_t i = 0; i < back.layers.size(); ++i) {
            CHECK(back.layers[i].material == sequence.layers[i].material);
            CHECK(back.layers[i].mm == sequence.layers[i].mm);
        }
    }
}

TEST_CASE("A laminate file that is cut short or wrong is refused by key and rule") {
    const std::string text = layer_sequence_text(jade());
    for (std::size_t length = 0; length + 2 < text.size(); ++length)
        CHECK_THROWS_AS((void)parse_layer_sequence(text.substr(0, length), "test"), InputError);
    // What files of earlier versions say.
    CHECK(layer_sequence_text(parse_layer_sequence(replaced(text, "voxtone-laminate", "voxtone-stack"), "x")) == text);
    CHECK_THROWS_WITH((void)parse_layer_sequence(replaced(text, "voxtone-laminate", "voxtone-heap"), "x.json"),
                      Contains("x.json") && Contains("format"));
    CHECK_THROWS_WITH((void)parse_layer_sequence(replaced(text, "\"mm\": 0.1", "\"mm\": 0"), "x.json"), Contains("mm"));
    CHECK_THROWS_WITH((void)parse_layer_sequence(replaced(text, "\"air\"", "\"glass\""), "x.json"),
                      Contains("surface"));
    CHECK_THROWS_WITH((void)parse_layer_sequence(replaced(text, "\"backing\"", "\"bakcing\""), "x.json"),
                      Contains("did you mean 'backing'"));
    CHECK_THROWS_WITH((void)parse_layer_sequence(replaced(text, "\"version\": 1", "\"version\": 2"), "x.json"),
                      Contains("version"));
}

TEST_CASE("Layers are read as a person writes them") {
    CHECK_THROWS_WITH(parse_layers("W 0,3, K 1"), Contains("decimals stand behind a point"));
    const std::vector<SequenceLayer> layers = parse_layers(" W 0.3,K  100um , my.json 1 mm");
    REQUIRE(layers.size() == 3);
    CHECK(layers[0].material == "W");
    CHECK(layers[0].mm == 0.3);
    CHECK(layers[1].mm == Approx(0.1));
    CHECK(layers[2].material == "my.json");
    CHECK(layers[2].mm == 1);
    CHECK(layers_text(layers) == "W 0.3, K 0.1, my.json 1");
    for (const char* bad : {"", "W", "W 0.3,", "W 0.3,,K 1", "W 0", "W -1", "W thick", "W 1 parsec"})
        CHECK_THROWS_AS((void)parse_layers(bad), UsageError);
}
