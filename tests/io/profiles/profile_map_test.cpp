// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/profile_map.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/png_pixels.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Matchers::Contains;

namespace {

ProfileMap sample(std::size_t clusters, std::uint32_t width = 5, std::uint32_t height = 3) {
    ProfileMap map;
    map.source = "a \"test\"";
    map.channels.wavelengths_nm = {450, 612.5};
    map.width_mm = 2.5;
    map.height_mm = 1.2;
    map.width_px = width;
    map.height_px = height;
    for (std::size_t i = 0; i < std::size_t{width} * height; ++i)
        map.cluster.push_back(static_cast<std::uint16_t>(i * 37 % clusters));
    for (std::size_t k = 0; k < clusters; ++k) {
        auto& target = map.target.emplace_back();
        for (int c = 0; c < 2; ++c) {
            target.push_back({0.1, {}, {}});
            for (int i = 0; i < 6; ++i)
                target.back().light.push_back(1.0 / (1 + i + c) + 1e-3 * static_cast<double>(k));
        }
    }
    return map;
}

void check_same(const ProfileMap& a, const ProfileMap& b) {
    CHECK(a.source == b.source);
    CHECK(a.channels == b.channels);
    CHECK((a.width_mm == b.width_mm && a.height_mm == b.height_mm && a.width_px == b.width_px &&
           a.height_px == b.height_px));
    CHECK(a.cluster == b.cluster);
    REQUIRE(a.target.size() == b.target.size());
    for (std::size_t k = 0; k < a.target.size(); ++k)
        for (std::size_t c = 0; c < a.target[k].size(); ++c) {
            CHECK(a.target[k][c].spacing_mm == b.target[k][c].spacing_mm);
            CHECK(a.target[k][c].light == b.target[k][c].light);
        }
}

}  // namespace

TEST_CASE("A profile map is read back as it was written, in 8 and in 16 bits") {
    const TemporaryFolder folder;
    for (const std::size_t clusters : {1u, 7u, 256u, 300u}) {
        const ProfileMap map = sample(clusters, 31, 20);
        write_profile_map(map, folder.path() / "map.json");
        CHECK(read_whole_file(folder.path() / "map.png", 1 << 20)[24] == (clusters > 256 ? 16 : 8));  // IHDR: bit depth
        check_same(read_profile_map(folder.path() / "map.json"), map);
    }
}

TEST_CASE("A profile map of RGB says so") {
    const TemporaryFolder folder;
    ProfileMap map = sample(2);
    map.channels = {};
    for (auto& target : map.target) target.push_back(target[0]);
    write_profile_map(map, folder.path() / "map.json");
    CHECK_THAT(text_of(folder.path() / "map.json"), Contains("\"rgb\""));
    CHECK(read_profile_map(folder.path() / "map.json").channels.is_rgb());
}

TEST_CASE("A profile map that is cut short at any byte is refused", "[slow]") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "map.json", picture = folder.path() / "map.png";
    write_profile_map(sample(3), file);
    const std::string text = text_of(file);
    for (std::size_t n = 0; n + 2 < text.size(); ++n) {  // the last two bytes are "}\n"
        write_whole_file(file, std::string_view(text).substr(0, n));
        CHECK_THROWS_AS((void)read_profile_map(file), InputError);
    }
    write_whole_file(file, text);
    const auto bytes = read_whole_file(picture, 1 << 20);
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        write_whole_file(picture, std::span(bytes).first(n));
        CHECK_THROWS_AS((void)read_profile_map(file), InputError);
    }
    std::filesystem::remove(picture);
    CHECK_THROWS_AS((void)read_profile_map(file), FileError);
    std::filesystem::remove(file);
    CHECK_THROWS_AS((void)read_profile_map(file), FileError);
}

TEST_CASE("A broken profile map is refused with what is wrong, and where") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "map.json";
    write_profile_map(sample(3), file);
    const std::string text = text_of(file);
    const auto check = [&](const std::string& from, const std::string& to, const std::string& message) {
        std::string broken = text;
        REQUIRE(broken.find(from) != std::string::npos);
        broken.replace(broken.find(from), from.size(), to);
        write_whole_file(file, broken);
        INFO(broken.substr(0, 300));
        CHECK_THROWS_WITH((void)read_profile_map(file), Contains("map") && Contains(message));
    };
    check("profile-map", "profile", "this is no profile map");
    check("\"version\": 1", "\"version\": 2", "`version`");
    check("\"spacing_mm\"", "\"spacing\"", "did you mean 'spacing_mm'");
    check("\"spacing_mm\": 0.1", "\"spacing_mm\": 0", "above 0");
    check("[2.5, 1.2]", "[2.5, 0]", "`size_mm`");
    check("[2.5, 1.2]", "[2.5]", "`size_mm`");
    check("[450, 612.5]", "[450]", "`clusters[0]`");
    check("[450, 612.5]", "[]", "wavelengths");
    check("[450, 612.5]", "\"cmyk\"", "\"rgb\"");
    check("\"map.png\"", "\"../map.png\"", "same folder");
    check("\"map.png\"", "\"..\"", "same folder");
    check("\"map.png\"", "\"\"", "same folder");
    check("[1, 0.5,", "[1, \"0.5\",", "`clusters[0][0]`");
    check("[1, 0.5,", "[1, 1e300,", "`clusters[0][0]`");
    check("[1, 0.5,", "[0.5,", "`clusters[0][1]`: has 6 samples, clusters[0][0] has 5");
    check("[1, 0.5, 0.3333333333333333, 0.25, 0.2, 0.16666666666666666]", "[1, 0.5, 0.3]", "at least 4");
    write_whole_file(file, text);
    const auto picture = read_whole_file(folder.path() / "map.png", 1 << 20);
    write_whole_file(folder.path() / "map.png", png_bytes(Picture8{5, 3, 3, std::vector<std::uint8_t>(45)}));
    CHECK_THROWS_WITH((void)read_profile_map(file), Contains("map.png") && Contains("8-bit RGB") && Contains("grey"));
    write_whole_file(folder.path() / "map.png", picture);
    std::string two = text.substr(0, text.rfind(",\n  [")) + "]}\n";  // without the last cluster
    write_whole_file(file, two);
    CHECK_THROWS_WITH((void)read_profile_map(file), Contains("belongs to cluster 2") && Contains("has 2 clusters"));
}

TEST_CASE("Numbers in a grey PNG are read back as they were written") {
    for (const std::uint16_t most : {std::uint16_t{255}, std::uint16_t{256}, std::uint16_t{65535}}) {
        const std::vector<std::uint16_t> numbers{0, most, 1, 2, 254, static_cast<std::uint16_t>(most / 2)};
        const GreyPicture picture = read_grey_png(number_png_bytes(3, 2, numbers), "picture");
        CHECK((picture.width_px == 3 && picture.height_px == 2));
        CHECK(picture.samples == numbers);
    }
}
