// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ways of writing text into other text: base64, mark-up, JSON; and XML read back.
#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/base64.h"
#include "io/files/json_writer.h"
#include "io/files/markup.h"
#include "io/files/xml_reader.h"

using namespace voxtone;
using namespace voxtone::io;

TEST_CASE("Base64 is that of RFC 4648, section 10", "[base64]") {
    const std::vector<std::pair<std::string, std::string>> known{{"", ""},
                                                                 {"f", "Zg=="},
                                                                 {"fo", "Zm8="},
                                                                 {"foo", "Zm9v"},
                                                                 {"foob", "Zm9vYg=="},
                                                                 {"fooba", "Zm9vYmE="},
                                                                 {"foobar", "Zm9vYmFy"}};
    for (const auto& [plain, coded] : known) {
        CHECK(base64({reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size()}) == coded);
        const auto back = base64_bytes(coded);
        CHECK(std::string(reinterpret_cast<const char*>(back.data()), back.size()) == plain);
    }
    CHECK(base64_bytes("Zm9v\r\nYmFy").size() == 6);
    CHECK(base64_bytes("/+8=") == std::vector<std::byte>{std::byte{0xff}, std::byte{0xef}});
}

TEST_CASE("Text cannot end its element or attribute", "[markup]") {
    CHECK(html_text("a < b & \"c\" > 'd'") == "a &lt; b &amp; &quot;c&quot; &gt; &apos;d&apos;");
    CHECK(html_text("\x1b[2J\xff") == "?[2J\xEF\xBF\xBD");
    const std::string any = "\x01 <&>\"' \xff";
    CHECK(XmlReader::decode(markup_text(any)) == any);
}

TEST_CASE("JSON comes out in the order and the lines that were asked for", "[json]") {
    JsonWriter json;
    json.begin_object().add("a", 1).add("b", std::vector<double>{0.1, 3, 1e-9}).add("none", std::vector<double>{});
    json.line().key("list").begin_list();
    for (const char* name : {"x", "y\"\n"}) json.line().begin_object().add("name", name).add("ok", true).end_object();
    json.end_list().add("last", std::uint64_t{1} << 63).add("least", std::int64_t{-1} << 62);
    json.add("nan", std::numeric_limits<double>::quiet_NaN()).end_object();
    CHECK(json.text() ==
          "{\"a\": 1, \"b\": [0.1, 3, 1e-09], \"none\": [],\n \"list\": [\n  {\"name\": \"x\", \"ok\": true},\n"
          "  {\"name\": \"y\\\"\\n\", \"ok\": true}], \"last\": 9223372036854775808, "
          "\"least\": -4611686018427387904, \"nan\": null}");
}

TEST_CASE("Character references in XML", "[xml]") {
    CHECK(XmlReader::decode("a&amp;b&#65;&#x0000042;&lt;&unknown;&apos;") == "a&bAB<&unknown;'");
    CHECK(XmlReader::decode("&#xe9; & &;&") == "\xC3\xA9 & &;&");
    CHECK(XmlReader::decode("&#8364;&#x1F600;&#x10FFFF;") == "\xE2\x82\xAC\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF");
    // What is no character of Unicode, or no number, is no reference.
    for (const char* none : {"&#xD800;", "&#xDFFF;", "&#x110000;", "&#99999999999;", "&#0;", "&#;", "&#x;", "&#12x;",
                             "&#x4G;", "&#-65;", "&# 65;", "&#X41;", "&AMP;"})
        CHECK(XmlReader::decode(none) == none);
    // No reference is as long as that, so it is text.
    CHECK(XmlReader::decode("&0123456789abc;") == "&0123456789abc;");
    // A million of ampersands takes as long as a million of other letters: searched to the end each, it was an hour.
    const std::string ampersands = std::string(1'000'000, '&') + ";";
    CHECK(XmlReader::decode(ampersands).size() == ampersands.size());
}

TEST_CASE("Elements lie in one another so deep and no deeper", "[xml]") {
    const auto nested = [](std::size_t depth) {
        std::string text;
        for (std::size_t n = 0; n < depth; ++n) text += "<a>";
        for (std::size_t n = 0; n < depth; ++n) text += "</a>";
        XmlReader xml(text, "FILE");
        std::size_t deepest = 0;
        while (xml.next() != XmlReader::Event::finished) deepest = std::max(deepest, xml.depth());
        return deepest;
    };
    CHECK(nested(256) == 256);
    CHECK_THROWS_WITH(nested(257), Catch::Contains("nested too deep"));
}

TEST_CASE("An element's text ends at the next mark", "[xml]") {
    XmlReader xml("<a> one <b/>two<c>&lt;3</c></a>", "FILE");
    REQUIRE(xml.next() == XmlReader::Event::start);
    CHECK(xml.text() == " one ");
    REQUIRE(xml.next() == XmlReader::Event::start);
    CHECK(xml.text().empty());
    REQUIRE(xml.next() == XmlReader::Event::end);
    REQUIRE(xml.next() == XmlReader::Event::start);
    CHECK(XmlReader::decode(xml.text()) == "<3");
    XmlReader open("<a>cut", "FILE");
    REQUIRE(open.next() == XmlReader::Event::start);
    CHECK(open.text() == "cut");
    CHECK_THROWS_AS(open.next(), InputError);
}

TEST_CASE("A prefix means what the nearest element around it declares", "[xml]") {
    XmlReader xml(R"(<a xmlns="urn:1" xmlns:p="urn:2"><p:b xmlns:p='urn:3' x="0" p:x="1" q:x="2" xmlns:q="urn:4">)"
                  R"(<b xmlns="urn:5"/></p:b><p:c q:y="3" p:y="4" xmlnsx="n"/><q:d/><a xmlns=""/></a>)",
                  "FILE");
    std::string elements, attributes;
    for (XmlReader::Event event; (event = xml.next()) != XmlReader::Event::finished;) {
        elements += (event == XmlReader::Event::start ? " " : " /") + std::string(xml.name()) + "=" +
                    std::string(xml.namespace_uri());
        if (event != XmlReader::Event::start) continue;
        for (const auto& [key, value] : xml.attributes())
            if (!key.starts_with("xmlns"))
                attributes += " " + std::string(value) + "=" + std::string(xml.attribute_namespace(key));
    }
    CHECK(elements == " a=urn:1 b=urn:3 b=urn:5 /b=urn:5 /b=urn:3 c=urn:2 /c=urn:2 d=q /d=q a= /a= /a=urn:1");
    CHECK(attributes == " 0=urn:3 1=urn:3 2=urn:4 3=q 4=urn:2");

    // Whoever asks for a value gets what it means, once.
    XmlReader coded(R"(<m:color xmlns:m="urn:a&amp;b" color="&#35;C8&#x32;828" name="&amp;lt;"/>)", "FILE");
    REQUIRE(coded.next() == XmlReader::Event::start);
    CHECK(coded.attribute("color") == "#C82828");
    CHECK(coded.attribute("name") == "&lt;");
    CHECK(coded.namespace_uri() == "urn:a&b");

    // An attribute of another namespace is not the element's; one of the element's is.
    XmlReader named(R"(<a xmlns="urn:1" xmlns:p="urn:2" xmlns:o="urn:1" p:x="1" o:y="2" z="3"/>)", "FILE");
    REQUIRE(named.next() == XmlReader::Event::start);
    CHECK(named.attribute("x").data() == nullptr);
    CHECK(named.attribute("y") == "2");
    CHECK(named.attribute("z") == "3");

    // Each name is looked for in all of them.
    std::string many = "<a";
    for (int n = 0; n < 1000; ++n) many += " xmlns:p" + std::to_string(n) + "='u'";
    XmlReader hostile(many += "/>", "FILE");
    CHECK_THROWS_WITH(hostile.next(), Catch::Contains("more than 256 namespaces"));
}
