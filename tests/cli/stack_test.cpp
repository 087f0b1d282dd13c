// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/pictures/picture_writer.h"
#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

nlohmann::json manifest(const Folder& folder) { return nlohmann::json::parse(read_file(folder / "out/manifest.json")); }

std::string layer_path(const Folder& folder, int k) { return folder / fmt::format("out/layers/slice_{:05d}.png", k); }

/// Columns and rows of the pixels that are not background: first and past the last.
struct Box {
    int left = 1 << 30, right = 0, top = 1 << 30, bottom = 0;
};
Box printed(const Bitmap& bitmap) {
    Box box;
    for (int y = 0; y < bitmap.height; ++y)
        for (int x = 0; x < bitmap.width; ++x)
            if (const auto p = bitmap.at(x, y); p[0] || p[1] || p[2])
                box = {std::min(box.left, x), std::max(box.right, x + 1), std::min(box.top, y),
                       std::max(box.bottom, y + 1)};
    return box;
}

}  // namespace

TEST_CASE("An asymmetric marker proves every axis and mirror") {
    const Folder folder("marker");
    folder.write("marker.obj", marker_obj());
    // Base 6 x 3 x 2 mm; tower 2 x 1 mm on the corner of small x, small y, up to z = 5 mm. J750: 42.33 x 84.67 x 27 um.
    struct Case {
        const char* options;
        bool left, bottom;  ///< where the tower stands in the bitmap
        bool swapped = false;
    };
    // x and y are exchanged before anything is mirrored.
    for (const Case& c : {Case{"", true, true}, Case{"--flip-x", false, true}, Case{"--flip-y", true, false},
                          Case{"--flip-x --flip-y", false, false}, Case{"--rotate z180", false, false},
                          Case{"--swap-xy", true, true, true}, Case{"--swap-xy --flip-x", false, true, true},
                          Case{"--swap-xy --flip-y", true, false, true}}) {
        INFO(c.options);
        REQUIRE(run_program(fmt::format("slice --quiet --no-report --iterations 0 --overwrite {} {} -o {}",
                                        folder / "marker.obj", c.options, folder / "out"))
                    .exit_code == 0);
        const auto description = manifest(folder);
        // 6 / 0.0423333 = 141.7, 3 / 0.0846667 = 35.4; the other way round both are 70.9.
        CHECK(description["size_px"] == (c.swapped ? nlohmann::json({71, 71}) : nlohmann::json({142, 35})));
        CHECK(description["layers"] == 185);  // 5 / 0.027 = 185.2
        const Box base = printed(read_png(layer_path(folder, 10)));
        CHECK(base.right - base.left >= (c.swapped ? 70 : 141));
        CHECK(base.bottom - base.top >= (c.swapped ? 70 : 35));
        const Bitmap top = read_png(layer_path(folder, 180));
        const Box tower = printed(top);
        CHECK(std::abs(tower.right - tower.left - (c.swapped ? 1 : 2) / (25.4 / 600)) <= 1);
        CHECK(std::abs(tower.bottom - tower.top - (c.swapped ? 2 : 1) / (25.4 / 300)) <= 1);
        CHECK((tower.left <= 1) == c.left);
        CHECK((tower.right >= top.width - 1) == !c.left);
        CHECK((tower.bottom >= top.height - 1) == c.bottom);  // small y is the last row
        CHECK((tower.top <= 1) == !c.bottom);
    }
}

TEST_CASE("A mirrored print is that of the model that was mirrored by hand, with its texture") {
    const Folder folder("mirrored");
    // A box of which each side shows another part of a picture of many colours that the resins reach.
    std::vector<std::uint8_t> rgb;
    for (unsigned n = 0; n < 3 * 32 * 32; ++n)
        rgb.push_back(std::uint8_t(120 + ((n / 3 / 4 * 2654435761u) >> (8 * (n % 3) + 4)) % 80));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = image.height = 32;
    image.format = PNG_FORMAT_RGB;
    REQUIRE(png_image_write_to_file(&image, (folder / "skin.png").c_str(), 0, rgb.data(), 0, nullptr));
    folder.write("skin.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd skin.png\n");
    // Corners by three bits, sides counter-clockwise from outside; each corner of each side has a place of its own.
    const std::array<std::array<int, 4>, 6> sides{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    const auto write = [&](const std::string& name, bool x, bool y) {
        std::string text = "mtllib skin.mtl\nusemtl skin\n";
        for (int c = 0; c < 8; ++c)
            text += fmt::format("v {} {} {}\n", (x ? -1 : 1) * (c & 1 ? 3 : 0), (y ? -1 : 1) * (c & 2 ? 2 : 0),
                                c & 4 ? 1.5 : 0);
        for (int side = 0; side < 6; ++side)
            for (int corner = 0; corner < 4; ++corner)
                text += fmt::format("vt {:.3f} {:.3f}\n", 0.1 + 0.13 * side + 0.05 * (corner % 3),
                                    0.1 + 0.2 * corner + 0.05 * (side % 3));
        // A mirror turns each triangle over.
        for (int side = 0; side < 6; ++side)
            for (const auto& half : x != y ? std::array{std::array{0, 2, 1}, std::array{0, 3, 2}}
                                           : std::array{std::array{0, 1, 2}, std::array{0, 2, 3}}) {
                text += "f";
                for (const int corner : half)
                    text +=
                        fmt::format(" {}/{}", sides[std::size_t(side)][std::size_t(corner)] + 1, 4 * side + corner + 1);
                text += "\n";
            }
        folder.write(name, text);
    };
    const auto layers = [&](const std::string& arguments) {
        REQUIRE(run_program(fmt::format("slice --quiet --no-report --iterations 0 --overwrite {} -o {}", arguments,
                                        folder / "out"))
                    .exit_code == 0);
        std::map<std::string, std::string> files;
        for (auto& [name, bytes] : read_tree(folder / "out"))
            if (name.ends_with(".png")) files.emplace(name, std::move(bytes));
        CHECK(files.size() > 50);
        return files;
    };
    write("box.obj", false, false);
    const auto plain = layers(folder / "box.obj");
    for (const auto& [x, y] : {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
        CAPTURE(x, y);
        write("by-hand.obj", x, y);
        const auto asked =
            layers(fmt::format("{}{}{}", folder / "box.obj", x ? " --flip-x" : "", y ? " --flip-y" : ""));
        CHECK(asked == layers(folder / "by-hand.obj"));
        CHECK(asked != plain);
    }
}

TEST_CASE("Colour goes where the model has it, and counts agree with the bitmaps") {
    const Folder folder("ramp");
    folder.write("box.obj", ramp_box_obj(8, 6, 4));
    REQUIRE(run_program(
                fmt::format("slice --quiet --no-report --iterations 0 {} -o {}", folder / "box.obj", folder / "out"))
                .exit_code == 0);
    const auto description = manifest(folder);
    std::map<std::array<std::uint8_t, 3>, std::string> role_of;
    std::map<std::string, std::uint64_t> said, counted;
    for (const auto& resin : description["resins"]) {
        role_of[resin["rgb"]] = resin["role"];
        said[resin["role"]] = resin["voxels"];
    }
    std::map<std::string, std::array<std::uint64_t, 2>> half;  // in the left and right half of the surface layer
    const int layers = description["layers"];
    bool opaque = true;
    int stray = 0;
    for (int k = 0; k < layers; ++k) {
        const Bitmap bitmap = read_png(layer_path(folder, k));
        for (int y = 0; y < bitmap.height; ++y)
            for (int x = 0; x < bitmap.width; ++x) {
                const auto p = bitmap.at(x, y);
                opaque = opaque && p[3] == 255;
                if (!p[0] && !p[1] && !p[2]) continue;
                const auto role = role_of.find({p[0], p[1], p[2]});
                if (role == role_of.end()) {
                    ++stray;
                    continue;
                }
                ++counted[role->second];
                if (k == layers - 5) ++half[role->second][std::size_t(x >= bitmap.width / 2)];
            }
    }
    CHECK(opaque);
    CHECK(stray == 0);
    for (const auto& [role, voxels] : said) CHECK(counted[role] == voxels);
    // The volume: 8 x 6 x 4 mm.
    std::uint64_t all = 0;
    for (const auto& [role, voxels] : counted) all += voxels;
    CHECK(double(all) * 25.4 / 600 * 25.4 / 300 * 0.027 == Approx(8 * 6 * 4).epsilon(0.01));
    // Red on the left needs magenta and no cyan; green on the right the other way round.
    CHECK(half["M"][0] > 4 * half["M"][1]);
    CHECK(half["C"][1] > 4 * half["C"][0]);
    CHECK(run_program("verify " + (folder / "out")).exit_code == 0);
}

TEST_CASE("verify finds what was spoiled, by name, with exit code 6") {
    const Folder folder("spoil");
    folder.write("marker.obj", marker_obj());
    const std::string slice = fmt::format("slice --quiet --no-report --iterations 0 --overwrite {} -o {}",
                                          folder / "marker.obj", folder / "out");
    REQUIRE(run_program(slice).exit_code == 0);
    REQUIRE(run_program("verify " + (folder / "out")).exit_code == 0);

    std::filesystem::remove(layer_path(folder, 20));
    const Outcome gap = run_program("verify " + (folder / "out"));
    CHECK(gap.exit_code == 6);
    CHECK_THAT(gap.out + gap.err, Catch::Matchers::Contains("slice_00020"));

    std::filesystem::copy_file(layer_path(folder, 150), layer_path(folder, 20));  // of the tower, not of the base
    CHECK(run_program("verify " + (folder / "out")).exit_code ==
          6);  // right in form, wrong in content: counts or hash tell

    REQUIRE(run_program(slice).exit_code == 0);
    std::filesystem::resize_file(layer_path(folder, 30), 100);
    const Outcome cut = run_program("verify " + (folder / "out"));
    CHECK(cut.exit_code == 6);
    CHECK_THAT(cut.out + cut.err, Catch::Matchers::Contains("slice_00030"));
    CHECK(run_program("verify " + (folder / "nothing")).exit_code == 4);

    REQUIRE(run_program(slice).exit_code == 0);
    CHECK_THAT(run_program("verify " + (folder / "out")).out,
               Catch::Matchers::Contains("checked for stratasys-j750-hm"));
    std::string manifest_text = read_file(folder.path() / "out/manifest.json");
    const std::size_t printer = manifest_text.find("stratasys-j750-hm");
    folder.write("out/manifest.json", manifest_text.replace(printer, 17, "foo"));
    const Outcome unknown = run_program("verify " + (folder / "out"));
    CHECK(unknown.exit_code == 6);
    CHECK_THAT(unknown.out + unknown.err, Catch::Matchers::Contains("'foo', is not known here"));
    folder.write("out/manifest.json", "{");
    CHECK(run_program("verify " + (folder / "out")).exit_code == 6);
    std::filesystem::remove(folder.path() / "out/manifest.json");
    const Outcome without = run_program("verify " + (folder / "out"));
    CHECK(without.exit_code == 6);
    CHECK_THAT(without.out + without.err, Catch::Matchers::Contains("no manifest.json"));
}

TEST_CASE("A picture becomes a slab with its colours on top, upright") {
    const Folder folder("picture");
    const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";
    REQUIRE(run_program(fmt::format("slice --quiet --iterations 0 {} --width 6mm --thickness 2mm -o {}", picture,
                                    folder / "out"))
                .exit_code == 0);
    const auto description = manifest(folder);
    CHECK(description["size_px"] == nlohmann::json({142, 71}));  // 6 mm at 600 and 300 dpi
    CHECK(description["layers"] == 74);                          // 2 mm / 27 um: 74.1
    CHECK(std::filesystem::exists(folder / "out/report.html"));
    CHECK(std::filesystem::exists(folder / "out/target.png"));
    CHECK(std::filesystem::exists(folder / "out/predicted.png"));
    // The bottom millimetre is core.
    const Bitmap bottom = read_png(layer_path(folder, 3));
    CHECK(std::count(bottom.pixels.begin(), bottom.pixels.end(), bottom.pixels.front()) ==
          std::ptrdiff_t(bottom.pixels.size()));
}

TEST_CASE("Of a cut-out it is told where a neck is thinner than the printer's maker asks for") {
    const Folder folder("neck");
    // Two squares of 8 mm, 4 mm apart, at 0.1 mm a pixel.
    const auto told_of = [&](int neck_px) {
        voxtone::io::Picture8 codes{200, 80, 4, {}};
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 200; ++x) {
                const bool is_ink = x < 80 || x >= 120 || (y >= 10 && y < 10 + neck_px);
                codes.codes.insert(codes.codes.end(), {200, 90, 40, std::uint8_t(is_ink ? 255 : 0)});
            }
        const auto bytes = voxtone::io::png_bytes(codes);
        folder.write("neck.png", std::string(bytes.begin(), bytes.end()));
        const Outcome outcome =
            run_program("estimate --quick --cut-out --width 20mm --thickness 2mm " + (folder / "neck.png"));
        CHECK(outcome.exit_code == 0);
        return outcome.out + outcome.err;
    };
    using Catch::Matchers::Contains;
    CHECK_THAT(told_of(5), Contains("0.5 mm over") && Contains(" mm above (10.0, 6.8, 1.0 mm)") &&
                               Contains("[fragile]") && Contains("wider in the picture"));
    CHECK_THAT(told_of(9), !Contains("[fragile]"));
}

TEST_CASE("A picture with alpha is cut to shape, and printed, estimated and looked at so") {
    const Folder folder("cut-out");
    // A ring of blue around a hole; what is transparent is red below.
    const auto picture = [&](const std::string& name, double inner, double outer) {
        voxtone::io::Picture8 codes{60, 60, 4, {}};
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 60; ++x) {
                const double r = std::hypot(x - 29.5, y - 29.5);
                const bool ink = r < outer && r > inner;
                const std::array<std::uint8_t, 4> pixel{std::uint8_t(ink ? 40 : 255), std::uint8_t(ink ? 90 : 0),
                                                        std::uint8_t(ink ? 200 : 0), std::uint8_t(ink ? 255 : 0)};
                codes.codes.insert(codes.codes.end(), pixel.begin(), pixel.end());
            }
        const auto bytes = voxtone::io::png_bytes(codes);
        folder.write(name, std::string(bytes.begin(), bytes.end()));
        return folder / name;
    };
    const std::string ring = picture("ring.png", 12, 24), body = ring + " --cut-out --width 6mm --thickness 1.5mm ";
    const Outcome made = run_program("slice --iterations 0 --predict transport " + body + "-o " + folder / "out");
    INFO(made.err);
    REQUIRE(made.exit_code == 0);
    CHECK_THAT(made.err, Catch::Matchers::Contains("cut to shape: 1 piece with 1 hole"));
    // The ring, and not its picture, is 6 mm wide: 142 columns.
    const auto description = manifest(folder);
    CHECK(description["size_px"] == nlohmann::json({142, 71}));
    const Bitmap top = read_png(layer_path(folder, 50));
    const auto is_air = [&](int x, int y) { return top.at(x, y) == std::array<std::uint8_t, 4>{0, 0, 0, 255}; };
    CHECK((is_air(2, 1) && is_air(139, 69) && is_air(71, 35)));  // corners and hole
    CHECK_FALSE((is_air(71, 9) || is_air(20, 35)));
    const double mm3 = 3.14159265 * (3 * 3 - 1.5 * 1.5) * 1.5;
    double ml = 0;
    for (const auto& resin : description["resins"]) ml += double(resin["ml"]);
    CHECK(1000 * ml == Approx(mm3).epsilon(0.03));
    CHECK_THAT(run_program("estimate " + body).out, Catch::Matchers::Contains(fmt::format("{:.3f} ml", ml)));
    // Blue to its rim: no red shines through it.
    const auto report = nlohmann::json::parse(read_file(folder.path() / "out/report.json"));
    CHECK_THAT(report["verdict"]["regions"].dump(), !Catch::Matchers::Contains("red"));
    REQUIRE(run_program("proof " + folder / "out" + " --spp 2 --size 64x48 --with-target -o " + folder / "proof.png")
                .exit_code == 0);
    const auto refused = [&](const std::string& words, const char* why) {
        const Outcome outcome =
            run_program("slice --quiet --iterations 0 --predict none " + words + " -o " + folder / "no");
        CHECK(outcome.exit_code != 0);
        CHECK_THAT(outcome.err, Catch::Matchers::Contains(why));
        CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
        CHECK_FALSE(std::filesystem::exists(folder / "no"));
    };
    refused(picture("none.png", 70, 80) + " --cut-out --width 6mm", "transparent all over");
    refused(picture("all.png", -1, 80) + " --cut-out --width 6mm", "no transparent pixels");
    folder.write("marker.obj", marker_obj());
    refused(folder / "marker.obj" + " --cut-out", "it is for pictures");
}
