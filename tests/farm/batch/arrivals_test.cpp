// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/arrivals.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <thread>
#include <utility>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "farm/batch/side_names.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
namespace fs = std::filesystem;

namespace {

/// A watched folder, and a clock that goes by hand. Files are looked at after 3 quiet seconds, side files waited
/// for 60.
struct Inbox {
    void append(const std::string& name) const {
        fs::create_directories((folder.path() / name).parent_path());
        std::ofstream(folder.path() / name, std::ios::app) << "x";
    }
    /// What is told then: models, "?" and strays, "..." and models that begin to wait, "!" and those that lack files,
    /// each with the names, "+" and those told again.
    std::string at(double s) {
        now_s = s;
        std::string told;
        const Arrivals::Arrived arrived = arrivals.poll();
        const auto add = [&](const char* what, const fs::path& file, const std::vector<std::string>& names = {}) {
            told += what + file.filename().string();
            for (const std::string& name : names) told += " <" + name + ">";
            told += " ";
        };
        for (const auto& [model, names] : arrived.waits) add("...", model, names);
        for (const fs::path& model : arrived.models)
            add(std::ranges::find(arrived.again, model) == arrived.again.end() ? "" : "+", model);
        for (const auto& [model, names] : arrived.lacks) add("!", model, names);
        for (const fs::path& file : arrived.strays) add("?", file);
        if (!told.empty()) told.pop_back();
        return told;
    }
    /// What a model names, there or not; as the reader finds it.
    std::vector<io::SideFile> side_files(const fs::path& model) {
        ++asked;
        std::vector<io::SideFile> files;
        for (const std::string& name : named[model.filename().string()]) {
            const bool there = fs::exists(folder.path() / name);
            files.push_back({name, there ? std::string(64, 'a') : std::string()});
            if (name.ends_with(".mtl") && !there) break;  // what it names is not known then
        }
        return files;
    }

    io::TemporaryFolder folder;
    double now_s = 0;
    int asked = 0;
    std::map<std::string, std::vector<std::string>> named;  ///< by models
    Arrivals arrivals{folder.path(), {3, 60, [this] { return now_s; }}, [this](const fs::path& model) {
                          return std::optional(side_files(model));
                      }};
};

}  // namespace

TEST_CASE("A model is told once it and the files beside it have been quiet") {
    Inbox inbox;
    CHECK(inbox.at(0).empty());
    inbox.append("a.obj");
    inbox.append(".hidden.obj");
    CHECK(inbox.at(1).empty());
    inbox.append("a.obj");
    CHECK(inbox.at(3).empty());
    CHECK(inbox.at(5.9).empty());
    CHECK(inbox.at(6) == "a.obj");
    CHECK(inbox.at(20).empty());
    inbox.append("b.obj");
    CHECK(inbox.at(21).empty());
    inbox.append("b.png");  // its texture is still on its way
    CHECK(inbox.at(24).empty());
    CHECK(inbox.at(27) == "b.obj");
    inbox.append("a.obj");
    CHECK(inbox.at(28).empty());
    CHECK(inbox.at(31) == "a.obj");
    fs::remove(inbox.folder.path() / "a.obj");
    CHECK(inbox.at(40).empty());
    CHECK_THROWS_AS(Arrivals(inbox.folder.path() / "gone", {3, 60, [] { return 0.0; }}, {}).poll(), FileError);
}

TEST_CASE("A file that is no model is told once, unless a model arrives with it") {
    Inbox inbox;
    inbox.append("a.obj");
    inbox.append("a.mtl");
    inbox.append("skin.png");
    CHECK(inbox.at(0).empty());
    CHECK(inbox.at(4) == "a.obj");  // the others came with it
    inbox.append("photo.png");
    inbox.append("notes.txt");
    inbox.append(".hidden.png");
    CHECK(inbox.at(5).empty());
    CHECK(inbox.at(9) == "?notes.txt ?photo.png");
    CHECK(inbox.at(20).empty());
    inbox.append("photo.png");  // another one
    CHECK(inbox.at(21).empty());
    CHECK(inbox.at(25) == "?photo.png");
}

TEST_CASE("A model waits for the files that it names, one after the other, and is told once they are there") {
    Inbox inbox;
    inbox.named["s.obj"] = {"s.mtl", "tex.png", "textures/more.png"};
    inbox.append("s.obj");
    inbox.append("other.obj");
    CHECK(inbox.at(0).empty());
    CHECK(inbox.at(3) == "...s.obj <s.mtl> other.obj");
    CHECK(inbox.at(15).empty());
    CHECK(inbox.asked == 2);  // nothing has changed
    inbox.append("s.mtl");
    CHECK(inbox.at(15.5).empty());
    CHECK(inbox.at(18.5) == "...s.obj <tex.png> <textures/more.png>");
    inbox.append("tex.png");
    CHECK(inbox.at(50).empty());
    CHECK(inbox.at(53) == "...s.obj <textures/more.png>");
    inbox.append("textures/more.png");  // in a folder of its own, that came too
    CHECK(inbox.at(100).empty());       // each that comes gives the others time
    CHECK(inbox.at(103) == "s.obj");
    CHECK(inbox.at(500).empty());
    const fs::path folder = inbox.folder.path();
    CHECK(inbox.arrivals.beside(folder / "s.obj") ==
          std::vector{folder / "s.mtl", folder / "tex.png", folder / "textures/more.png"});
    CHECK(inbox.arrivals.beside(folder / "other.obj").empty());
}

TEST_CASE("What does not come in time is done without, and done again when it comes") {
    Inbox inbox;
    inbox.named["s.obj"] = {"s.mtl", "tex.png"};
    inbox.append("s.obj");
    inbox.append("s.mtl");
    CHECK(inbox.at(0).empty());
    CHECK(inbox.at(3) == "...s.obj <tex.png>");
    CHECK(inbox.at(62).empty());
    CHECK(inbox.at(63) == "s.obj !s.obj <tex.png>");
    inbox.append("photo.png");  // another's
    CHECK(inbox.at(70).empty());
    CHECK(inbox.at(73) == "?photo.png");
    inbox.append("tex.png");
    CHECK(inbox.at(80).empty());
    CHECK(inbox.at(83) == "+s.obj");
    CHECK(inbox.at(200).empty());
}

TEST_CASE("A side file that changes after the print has it made again, one that goes has not") {
    Inbox inbox;
    inbox.named["s.obj"] = {"s.mtl", "tex.png"};
    for (const char* file : {"s.obj", "s.mtl", "tex.png", "photo.png"}) inbox.append(file);
    CHECK(inbox.at(0).empty());
    CHECK(inbox.at(3) == "s.obj");
    inbox.append("tex.png");
    CHECK(inbox.at(10).empty());
    CHECK(inbox.at(13) == "+s.obj");
    inbox.append("photo.png");  // nobody's
    CHECK(inbox.at(20).empty());
    CHECK(inbox.at(23) == "?photo.png");
    fs::remove(inbox.folder.path() / "tex.png");  // who printed it tidies up
    CHECK(inbox.at(30).empty());
    fs::remove(inbox.folder.path() / "s.mtl");
    CHECK(inbox.at(40).empty());
    inbox.append("photo.png");
    CHECK(inbox.at(45).empty());
    CHECK(inbox.at(48) == "?photo.png");
    inbox.append("s.mtl");  // another
    CHECK(inbox.at(50).empty());
    CHECK(inbox.at(53) == "...s.obj <tex.png>");
    inbox.append("tex.png");
    CHECK(inbox.at(60).empty());
    CHECK(inbox.at(63) == "+s.obj");
}

TEST_CASE("Where nobody is to wait a model is told at once, with what it lacks") {
    Inbox inbox;
    inbox.named["s.obj"] = {"C:\\Users\\me\\tex.png", "../out.png", "/etc/passwd"};
    inbox.arrivals = Arrivals(inbox.folder.path(), {3, 0, [&] { return inbox.now_s; }},
                              [&](const fs::path& model) { return std::optional(inbox.side_files(model)); });
    inbox.append("s.obj");
    CHECK(inbox.at(0).empty());
    CHECK(inbox.at(3) == "s.obj !s.obj <C:\\Users\\me\\tex.png> <../out.png>");
}

TEST_CASE("While names are read a model is not told, nor what may be its texture, and what comes meanwhile counts") {
    const io::TemporaryFolder folder;
    const auto append = [&](const char* name) { std::ofstream(folder.path() / name, std::ios::app) << "x"; };
    double now_s = 0;
    bool is_read = false, was_there = false;
    Arrivals arrivals(folder.path(), {3, 60, [&] { return now_s; }},
                      [&](const fs::path&) -> std::optional<std::vector<io::SideFile>> {
                          if (!std::exchange(is_read, true)) was_there = fs::exists(folder.path() / "tex.png");
                          if (now_s < 20) return std::nullopt;
                          is_read = false;
                          return std::vector<io::SideFile>{{"tex.png", was_there ? "a" : ""}};
                      });
    append("s.obj");
    (void)arrivals.poll();
    now_s = 3;
    CHECK(arrivals.poll().is_reading);
    append("tex.png");  // came when it had been looked for
    now_s = 5;
    (void)arrivals.poll();
    now_s = 8;
    const auto reading = arrivals.poll();
    CHECK(reading.is_reading);
    CHECK(reading.strays.empty());
    now_s = 20;
    CHECK(arrivals.poll().waits.size() == 1);
    now_s = 21;
    CHECK(arrivals.poll().models.size() == 1);
}

TEST_CASE("Names are read by another thread, one model at a time, and what cannot be read names nothing") {
    std::vector<std::string> read;
    SideNames names([&](const fs::path& model) -> std::vector<io::SideFile> {
        read.push_back(model.string());
        if (model == "bad.obj") throw InputError("bad");
        return {{model.string() + ".mtl", ""}};
    });
    const auto wait_for = [&](const char* model) {
        for (;;) {
            if (auto found = names.of(model)) return *found;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    };
    CHECK_FALSE(names.of("a.obj"));
    const auto a = wait_for("a.obj");
    REQUIRE(a.size() == 1);
    CHECK(a[0].name == "a.obj.mtl");
    CHECK(wait_for("bad.obj").empty());
    CHECK(wait_for("b.obj").size() == 1);
    (void)names.of("gone.obj");  // nobody asks for it again
    CHECK(wait_for("a.obj").size() == 1);
    CHECK(read == std::vector<std::string>{"a.obj", "bad.obj", "b.obj", "gone.obj", "a.obj"});
}

TEST_CASE("An archive is a model") {
    Inbox inbox;
    CHECK(inbox.at(0).empty());
    inbox.append("c.zip");
    CHECK(inbox.at(1).empty());
    CHECK(inbox.at(4) == "c.zip");
}
