// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/profile_file.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

ProfileFile layer() {
    ProfileFile file{"Vero\"White", "measured, R at 3 mm", {}, {}};
    for (int c = 0; c < 3; ++c)
        file.by_channel.push_back({3,
                                   {0.05, {0.1, 1.0 / 3, -0.001, c * 0.1}, 0.2, {}},
                                   {0.044, {2.5, 1, 0.5, 0.25, 1e-7 * c}, 0.7, {0.1, 0.05, 0.01, 0.002, 1e-8}}});
    return file;
}

ProfileFile target() {
    ProfileFile file{"wanted", "", {{450, 550.5}}, {}};
    for (int c = 0; c < 2; ++c) file.by_channel.push_back({0, {}, {0.1, {4, 3, 2, 1.0 + c}}});
    return file;
}

ProfileFile own_channels() {
    ProfileFile file = target();
    file.channels = optics::colorimetric_channels(optics::Illuminant::a);
    file.by_channel.push_back(file.by_channel[0]);
    return file;
}

void check_same(const optics::RadialSamples& a, const optics::RadialSamples& b) {
    CHECK(a.spacing_mm == b.spacing_mm);
    CHECK(a.light == b.light);
    CHECK(a.error == b.error);
    CHECK(a.total == b.total);
}

void check_same(const ProfileFile& a, const ProfileFile& b) {
    CHECK(a.name == b.name);
    CHECK(a.source == b.source);
    CHECK(a.channels == b.channels);
    CHECK(a.is_target() == b.is_target());
    REQUIRE(a.by_channel.size() == b.by_channel.size());
    for (std::size_t c = 0; c < a.by_channel.size(); ++c) {
        CHECK(a.by_channel[c].thickness_mm == b.by_channel[c].thickness_mm);
        check_same(a.by_channel[c].R, b.by_channel[c].R);
        check_same(a.by_channel[c].T, b.by_channel[c].T);
    }
}

// The message of the error that the text must cause.
std::string fault(const std::string& text) {
    try {
        (void)parse_profile(text, "FILE");
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("accepted: " << text);
    return {};
}

// A layer's file where one part is another.
std::string changed(const ProfileFile& file, const std::string& from, const std::string& to) {
    std::string text = profile_text(file);
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("Profiles written and read again are the same") {
    for (const ProfileFile& file : {layer(), target(), own_channels()})
        check_same(parse_profile(profile_text(file), "text"), file);
    CHECK(target().is_target());
    CHECK_FALSE(layer().is_target());
    const TemporaryFolder folder;
    write_whole_file(folder.path() / "w.json", profile_text(layer()));
    check_same(read_profile(folder.path() / "w.json"), layer());
    CHECK_THROWS_AS(read_profile(folder.path() / "not-there.json"), FileError);
}

TEST_CASE("Profiles that are faulty name file, key and rule") {
    const auto bad = [](const std::string& from, const std::string& to) { return fault(changed(layer(), from, to)); };
    CHECK_THAT(bad("voxtone-profile", "voxtone-resins"), Contains("FILE") && Contains("format"));
    CHECK_THAT(bad("\"version\": 1", "\"version\": 2"), Contains("version"));
    CHECK_THAT(bad("\"name\"", "\"nam\""), Contains("nam") && Contains("'name'"));
    CHECK_THAT(bad("\"rgb\"", "\"cmyk\""), Contains("`channels`") && Contains("cmyk") && Contains("wavelengths"));
    CHECK_THAT(bad("\"rgb\"", "[]"), Contains("`channels`") && Contains("has 0 wavelengths"));
    CHECK_THAT(bad("\"rgb\"", "[450, 550, 550]"), Contains("`channels`") && Contains("rise"));
    CHECK_THAT(bad("\"rgb\"", "[450, 550]"), Contains("`R.light`") && Contains("3 entries, expected 2"));
    const std::string own = R"({"kind": "own", "illuminant": "D65", "xyz": [[0.5, 0.5, 0.5], [0.4, 0.5, 0.5]]})";
    CHECK_THAT(bad("\"rgb\"", own), Contains("`channels.xyz`") && Contains("to X sum to 0.9") && Contains("white"));
    CHECK_THAT(bad("\"channels\": \"rgb\", ", ""), Contains("`channels`") && Contains("missing"));
    CHECK_THAT(bad("\"thickness_mm\": 3", "\"thickness_mm\": 0"), Contains("`thickness_mm`") && Contains("is 0"));
    CHECK_THAT(bad(", \"thickness_mm\": 3", ""), Contains("`thickness_mm`") && Contains("missing"));
    CHECK_THAT(bad("0.044", "-0.044"), Contains("`R.spacing_mm`") && Contains("-0.044"));
    CHECK_THAT(bad("0.7, 0.7, 0.7", "0.7, 1.7, 0.7"), Contains("`R.total`") && Contains("1.7"));
    CHECK_THAT(bad("0.7, 0.7, 0.7", "0.7, 0.7"), Contains("`R.total`") && Contains("2 entries, expected 3"));
    CHECK_THAT(bad("2.5, 1,", "2.5,"), Contains("`R.light`") && Contains("4 samples") && Contains("5 in another"));
    CHECK_THAT(bad("2.5, 1, 0.5, 0.25, 0]", "2.5, 1, 0.5]"), Contains("`R.light`") && Contains("at least 4"));
    CHECK_THAT(bad("2.5, 1,", "2.5, \"x\","), Contains("`R.light[0]`") && Contains("\"x\""));
    CHECK_THAT(bad("2.5, 1,", "2.5, null,"), Contains("`R.light[0]`") && Contains("null"));
    CHECK_THAT(bad("2.5, 1,", "2.5, 1e999,"), Contains("FILE") && Contains("too large"));
    CHECK_THAT(bad("[2.5, 1, 0.5, 0.25, 0]", "2.5"), Contains("`R.light[0]`") && Contains("list"));
    CHECK_THAT(bad("0.1, 0.05, 0.01", "0.1, -0.05, 0.01"), Contains("`R.error[0]`") && Contains("-0.05"));
    CHECK_THAT(bad("0.1, 0.05, 0.01", "0.1, 0.05"), Contains("`R.error`") && Contains("4 values for 5"));
    CHECK_THAT(bad("\"R\"", "\"r\""), Contains("unknown key 'r'"));
    const auto bad_target = [](const std::string& from, const std::string& to) {
        return fault(changed(target(), from, to));
    };
    CHECK_THAT(bad_target("\n \"R\"", " \"thickness_mm\": 1,\n \"R\""), Contains("`T`") && Contains("missing"));
}

TEST_CASE("No cut or damaged profile does more than throw an InputError") {
    const std::string text = profile_text(layer());
    for (std::size_t n = 0; n + 2 < text.size(); ++n)
        CHECK_THROWS_AS(parse_profile(text.substr(0, n), "cut"), InputError);
    for (std::size_t at = 0; at < text.size(); ++at)
        for (const char c : {'\0', ',', '"', '[', '}', '-', '9', '\xff'}) {
            std::string damaged = text;
            damaged[at] = c;
            try {
                (void)parse_profile(damaged, "damaged");
            } catch (const InputError&) {
            }
        }
}
