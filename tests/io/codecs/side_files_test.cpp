// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/side_files.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"

namespace fs = std::filesystem;
using voxtone::io::SideFiles;

TEST_CASE("files named by a model are looked up beside it and nowhere else") {
    const voxtone::io::TemporaryFolder folder;
    const fs::path root = folder.path();
    fs::create_directories(root / "model" / "Textures");
    for (const char* name : {"outside.png", "model/skin.png", "model/Textures/Wood Plank.JPG", "model/ü.png"})
        std::ofstream(root / name) << "x";
    SideFiles files(root / "model" / "thing.obj");

    SECTION("plain, Windows and nested names") {
        CHECK(files.find("skin.png") == root / "model/skin.png");
        CHECK(files.find(".\\skin.png") == root / "model/skin.png");
        CHECK(files.find("Textures\\Wood Plank.JPG") == root / "model/Textures/Wood Plank.JPG");
        CHECK(files.find("ü.png"));
        CHECK(files.warnings().empty());
    }
    SECTION("other upper and lower case is taken with one warning") {
        CHECK(files.find("textures/wood plank.jpg") == root / "model/Textures/Wood Plank.JPG");
        CHECK(files.find("textures/wood plank.jpg"));
        REQUIRE(files.warnings().size() == 1);
        CHECK(files.warnings()[0].find("Wood Plank.JPG") != std::string::npos);
    }
    SECTION("however accents are written, in any case, in UTF-8 or Windows-1252") {
        const auto put = [&](const std::string& name) { std::ofstream(root / "model" / name) << "x"; };
        put("Bl\xc3\xa4tter.png");  // ä as one letter
        put("He\xcc\x81lice.png");  // é as e and an accent
        put("Stra\xdf"
            "e.png");  // ß of Windows-1252
        for (const char* name : {"Bla\xcc\x88tter.png", "BL\xc3\x84TTER.PNG", "Bl\xe4tter.png"})
            CHECK(files.find(name) == root / "model/Bl\xc3\xa4tter.png");
        for (const char* name : {"H\xc3\xa9lice.png", "H\xe9lice.png", "H\xc3\x89LICE.png", "H%C3%A9lice.png"})
            CHECK(files.find(name) == root / "model/He\xcc\x81lice.png");
        CHECK(files.find("Stra\xc3\x9f"
                         "e.png") == root /
                                         "model/Stra\xdf"
                                         "e.png");
        CHECK(files.warnings().size() == 9);
        CHECK_FALSE(files.find("Blatter.png"));  // another word
    }
    SECTION("what begins with a dot is not looked at") {
        std::ofstream(root / "model" / ".key") << "x";
        CHECK_FALSE(files.find(".key"));
        CHECK_FALSE(files.find("./.key"));
        CHECK_FALSE(files.find(".KEY"));
    }
    SECTION("names that leave the folder are not followed") {
        CHECK_FALSE(files.find("../outside.png"));
        CHECK_FALSE(files.find("Textures/../../outside.png"));
        CHECK_FALSE(files.find((root / "outside.png").string()));
        CHECK_FALSE(files.find("/etc/passwd"));
        CHECK_FALSE(files.find("file:///etc/passwd"));
        CHECK(files.warnings().empty());
        CHECK(files.find("C:\\Users\\me\\skin.png") == root / "model/skin.png");
        CHECK(files.find("../model/skin.png") == root / "model/skin.png");
        CHECK(files.warnings().size() == 2);
    }
    SECTION("a folder that was laid flat, and a mark behind the name") {
        CHECK(files.find("gone/skin.png") == root / "model/skin.png");
        CHECK(files.find("gone\\deep\\SKIN.PNG") == root / "model/skin.png");
        CHECK(files.find("Textures/skin.png") == root / "model/skin.png");
        CHECK(files.find("skin.png;") == root / "model/skin.png");
        CHECK(files.find("gone/skin.png ;") == root / "model/skin.png");
        REQUIRE(files.warnings().size() == 5);
        CHECK(files.warnings()[0].find("'gone/skin.png', which is not there; 'skin.png' beside the model") !=
              std::string::npos);
        CHECK_FALSE(files.find("gone/Wood Plank.JPG"));  // lies in a folder of its own
        CHECK_FALSE(files.find("gone/outside.png"));
        CHECK_FALSE(files.find(";"));
        CHECK_FALSE(files.find("gone/;"));
    }
    SECTION("what was asked of a web server is no part of a name") {
        CHECK(files.find("skin.png?v=2") == root / "model/skin.png");
        CHECK(files.find("https://example.com/a/skin.png?sig=1%2F2&x=a/b") == root / "model/skin.png");
        CHECK_FALSE(files.find("?v=2"));
        std::ofstream(root / "model/skin.png?v=3") << "x";
        CHECK(files.find("skin.png?v=3") == root / "model/skin.png?v=3");
    }
    SECTION("nothing is no file") {
        CHECK_FALSE(files.find(""));
        CHECK_FALSE(files.find("."));
        CHECK_FALSE(files.find(".."));
        CHECK_FALSE(files.find("Textures"));
        CHECK_FALSE(files.find(std::string_view("skin.png\0.jpg", 13)));
    }
    CHECK(voxtone::io::decode_uri("Wood%20Plank.JPG%2") == "Wood Plank.JPG%2");
}
