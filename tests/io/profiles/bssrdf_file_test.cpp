// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/bssrdf_file.h"

#include <cstring>
#include <limits>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

BssrdfFile sample() {
    BssrdfFile data;
    data.source = "made \"up\"";
    data.channels.wavelengths_nm = {480, 620};
    data.responses = {3, 2, 1, 0.25, {}};
    for (int c = 0; c < 2; ++c) {
        optics::ChannelResponses channel;
        channel.noise = 0.001 * (c + 1);
        for (int i = 0; i < 6; ++i) channel.total.push_back(0.1f * static_cast<float>(i + c));
        for (int i = 0; i < 18; ++i) channel.pairs.push_back(1.0f / static_cast<float>(i + c + 1));
        data.responses.channels.push_back(channel);
    }
    return data;
}

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file) { return read_whole_file(file, 1 << 20); }

}  // namespace

TEST_CASE("A data set of scattering is read back as it was written, laid out as documented") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "set.bssrdf";
    const BssrdfFile data = sample();
    write_bssrdf(data, file);
    const BssrdfFile back = read_bssrdf(file);
    CHECK(back.source == data.source);
    CHECK(back.channels == data.channels);
    CHECK((back.responses.width == 3 && back.responses.height == 2 && back.responses.radius == 1));
    CHECK(back.responses.pitch_mm == 0.25);
    for (std::size_t c = 0; c < 2; ++c) {
        CHECK(back.responses.channels[c].noise == data.responses.channels[c].noise);
        CHECK(back.responses.channels[c].total == data.responses.channels[c].total);
        CHECK(back.responses.channels[c].pairs == data.responses.channels[c].pairs);
    }
    const auto bytes = bytes_of(file);
    CHECK(std::memcmp(bytes.data(), "VTBSSRDF", 8) == 0);
    const std::size_t header = bytes[8] + 256u * bytes[9];
    CHECK(bytes.size() == 12 + header + bssrdf_bytes(2, 3, 2, 1));
    CHECK(bssrdf_bytes(2, 3, 2, 1) == 4 * 2 * 6 * (1 + 3));
    float second_total = 0, first_pair = 0;
    std::memcpy(&second_total, bytes.data() + 12 + header + 4, 4);
    std::memcpy(&first_pair, bytes.data() + 12 + header + 24, 4);
    CHECK(second_total == 0.1f);
    CHECK(first_pair == 1.0f);
    CHECK(bssrdf_bytes(3, 256, 256, 10) == 125829120);
}

TEST_CASE("A data set that is cut short at any byte, or longer than it says, is refused") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "set.bssrdf";
    write_bssrdf(sample(), file);
    auto bytes = bytes_of(file);
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        write_whole_file(file, std::span(bytes).first(n));
        CHECK_THROWS_AS((void)read_bssrdf(file), InputError);
    }
    bytes.push_back(0);
    write_whole_file(file, bytes);
    CHECK_THROWS_WITH((void)read_bssrdf(file), Contains("behind its header"));
    CHECK_THROWS_AS((void)read_bssrdf(folder.path() / "none"), FileError);
}

TEST_CASE("A broken data set is refused with what is wrong, and where") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "set.bssrdf";
    write_bssrdf(sample(), file);
    const auto bytes = bytes_of(file);
    const std::string whole(bytes.begin(), bytes.end());
    const auto check = [&](const std::string& from, const std::string& to, const std::string& message) {
        std::string broken = whole;
        REQUIRE(from.size() == to.size());
        REQUIRE(broken.find(from) != std::string::npos);
        broken.replace(broken.find(from), from.size(), to);
        write_whole_file(file, broken);
        CHECK_THROWS_WITH((void)read_bssrdf(file), Contains("set.bssrdf") && Contains(message));
    };
    check("VTBSSRDF", "VTBSSRDX", "no data set of scattering");
    check("voxtone-bssrdf", "voxtone-bssrdX", "`format`");
    check("\"version\": 1", "\"version\": 2", "`version`");
    check("[3, 2]", "[0, 2]", "`points`");
    check("[3, 2]", "[2, 2]", "behind its header");
    check("[3, 2]", "[3, 9]", "behind its header");
    check("\"pitch_mm\": 0.25", "\"pitch_mm\": 0.00", "`pitch_mm`");
    check("\"radius\": 1", "\"radius\": 0", "`radius`");
    check("\"noise\": [0.001", "\"noise\": [-.001", "no valid JSON");
    check("\"noise\": [0.001, 0.002]", "\"noise\": [0.0010000000]", "`noise`");
    check("\"source\"", "\"sourze\"", "did you mean 'source'");

    const auto with_value = [&](std::size_t from_end, float value) {
        auto broken = bytes;
        std::memcpy(broken.data() + broken.size() - 4 * from_end, &value, 4);
        write_whole_file(file, broken);
    };
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -0.1f}) {
        with_value(1, bad);
        CHECK_THROWS_WITH((void)read_bssrdf(file), Contains("light of channel 1, picture 2, point 5"));
    }
    with_value(24, 1.1f);
    CHECK_THROWS_WITH((void)read_bssrdf(file), Contains("a total of channel 1, picture 0, point 0"));
}
