// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/batch/arrivals.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("A model is told once it and the files beside it have been quiet") {
    const io::TemporaryFolder folder;
    const auto append = [&](const char* name) { std::ofstream(folder.path() / name, std::ios::app) << "x"; };
    double now_s = 0;
    Arrivals arrivals(folder.path(), 3, [&] { return now_s; });
    const auto look_at = [&](double s) {
        now_s = s;
        std::string names;
        for (const auto& model : arrivals.poll().models) names += model.filename().string() + " ";
        return names;
    };
    CHECK(look_at(0).empty());
    append("a.obj");
    append(".hidden.obj");
    CHECK(look_at(1).empty());
    append("a.obj");
    CHECK(look_at(3).empty());
    CHECK(look_at(5.9).empty());
    CHECK(look_at(6) == "a.obj ");
    CHECK(look_at(20).empty());
    append("b.obj");
    CHECK(look_at(21).empty());
    append("b.png");  // its texture is still on its way
    CHECK(look_at(24).empty());
    CHECK(look_at(27) == "b.obj ");
    append("a.obj");
    CHECK(look_at(28).empty());
    CHECK(look_at(31) == "a.obj ");
    std::filesystem::remove(folder.path() / "a.obj");
    CHECK(look_at(40).empty());
    CHECK_THROWS_AS(Arrivals(folder.path() / "gone", 3, [] { return 0.0; }).poll(), FileError);
}

TEST_CASE("A file that is no model is told once, unless a model arrives with it") {
    const io::TemporaryFolder folder;
    const auto append = [&](const char* name) { std::ofstream(folder.path() / name, std::ios::app) << "x"; };
    double now_s = 0;
    Arrivals arrivals(folder.path(), 3, [&] { return now_s; });
    const auto strays_at = [&](double s) {
        now_s = s;
        std::string names;
        for (const auto& file : arrivals.poll().strays) names += file.filename().string() + " ";
        return names;
    };
    append("a.obj");
    append("a.mtl");
    append("skin.png");
    CHECK(strays_at(0).empty());
    CHECK(strays_at(4).empty());  // they came with a.obj
    append("photo.png");
    append("scene.dae");
    append(".hidden.png");
    CHECK(strays_at(5).empty());
    CHECK(strays_at(9) == "photo.png scene.dae ");
    CHECK(strays_at(20).empty());
    append("photo.png");  // another one
    CHECK(strays_at(21).empty());
    CHECK(strays_at(25) == "photo.png ");
}
