// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/sandbox.h"

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/disk/files_beside.h"
#include "io/files/file_reader.h"
#include "io/files/isolate.h"
#include "tests/io/files/taken_program.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// The program that does what it is asked, allowed to read one folder.
class Taken {
public:
    explicit Taken(const fs::path& readable, const fs::path& listable = {})
        : Taken(std::vector{readable.string()}, {listable.string()}) {}
    Taken(const std::vector<std::string>& readable, const std::vector<std::string>& listable, bool threads = false)
        : program_("a.obj", test::misbehaving_program(), {},
                   {.memory_bytes = built_with_address_sanitizer() ? 0 : std::uint64_t{256} << 20,
                    .readable = readable,
                    .listable = listable,
                    .threads = threads}) {
        (void)program_.result();
    }
    std::string answer(const std::string& wish) {
        program_.post_request(std::as_bytes(std::span(wish)));
        const auto bytes = program_.result();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    /// Skips the test where this system has no such wall.
    bool lacks(MissingWall wall, const char* means) const {
        if (!(program_.missing_walls() & wall)) return false;
        test::skip(std::string("no ") + means + " on this system");
        return true;
    }

private:
    IsolatedProgram program_;
};

struct Files {
    TemporaryFolder folder;
    fs::path inside = folder.path() / "inside", beside = folder.path() / "beside";
    Files() {
        fs::create_directories(inside / "deep");
        fs::create_directories(beside);
        for (const auto& file : {inside / "a.obj", inside / "deep" / "b.png", beside / "secret"})
            std::ofstream(file) << "contents";
        fs::create_symlink(beside / "secret", inside / "leads-out");
    }
};

/// Those wishes of `tried` that are done in a process without walls: the others prove nothing here.
bool done_without_walls(const std::string& wish) {
    const pid_t child = fork();
    if (child == 0) _exit(test::attempt(wish) == "done" ? 1 : 0);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

}  // namespace

TEST_CASE("a taken reader can change no file", "[sandbox]") {
    Files files;
    Taken taken(files.inside);
    if (taken.lacks(no_call_filter, "seccomp")) return;
    int proven = 0;
    for (const char* what : test::attempts_on_files) {
        const fs::path file = files.inside / "a.obj";
        const std::string wish = what + (" " + file.string());
        INFO(what);
        CHECK_THAT(taken.answer(wish), Contains("refused"));
        CHECK(fs::file_size(file) == 8);
        CHECK_FALSE(fs::exists(file.string() + ".new"));
        proven += done_without_walls(wish);
        fs::remove_all(file.string() + ".new");
        std::ofstream(file) << "contents";
    }
    CHECK(proven >= 9);  // of 15; some need rights that not every machine gives
}

TEST_CASE("a taken reader reaches nothing else", "[sandbox]") {
    Files files;
    Taken taken(files.inside);
    if (taken.lacks(no_call_filter, "seccomp")) return;
    int proven = 0;
    for (const char* what : test::attempts) {
        INFO(what);
        CHECK_THAT(taken.answer(what), Contains("refused"));
        // Without walls one ends the test and the other stops it.
        if (what != std::string("exec") && what != std::string("trace")) proven += done_without_walls(what);
    }
    CHECK(proven >= 11);
    CHECK(taken.answer("flags of a descriptor") == "done");  // which libraries need
}

TEST_CASE("a reader that may start threads gets these and nothing else, and they stand behind its walls", "[sandbox]") {
    Files files;
    Taken taken({files.inside.string()}, {}, true);
    if (taken.lacks(no_call_filter, "seccomp")) return;
    for (const std::string what : test::attempts) {
        INFO(what);
        CHECK_THAT(taken.answer(what), Contains(what == "thread" ? "done" : "refused"));
    }
    CHECK(taken.answer("read in a thread " + (files.inside / "a.obj").string()) == "done");
    if (taken.lacks(no_file_filter, "Landlock")) return;
    CHECK_THAT(taken.answer("read in a thread " + (files.beside / "secret").string()), Contains("refused"));
    CHECK_THAT(Taken(files.inside).answer("read in a thread " + (files.inside / "a.obj").string()),
               Contains("refused"));
}

TEST_CASE("a reader reads what it was given and nothing else", "[sandbox]") {
    Files files;
    Taken taken(files.inside);
    CHECK(taken.answer("read " + (files.inside / "a.obj").string()) == "done");
    CHECK(taken.answer("read " + (files.inside / "deep" / "b.png").string()) == "done");
    CHECK(taken.answer("list " + files.inside.string()) == "done");
    if (taken.lacks(no_file_filter, "Landlock")) return;
    for (const fs::path& path : {files.beside / "secret", files.inside / "leads-out", fs::path("/etc/passwd"),
                                 fs::path("/proc/self/environ"), files.inside / ".." / "beside" / "secret"}) {
        INFO(path.string());
        CHECK_THAT(taken.answer("read " + path.string()), Contains("refused"));
    }
    CHECK_THAT(taken.answer("list " + files.beside.string()), Contains("refused"));
    CHECK_THAT(taken.answer("list /"), Contains("refused"));
}

TEST_CASE("a call that is newer than the walls is not there, and one that is refused is refused", "[sandbox]") {
    Files files;
    Taken taken(files.inside);
    if (taken.lacks(no_call_filter, "seccomp")) return;
    CHECK_THAT(taken.answer("new call"), Contains("not implemented"));
    CHECK_THAT(taken.answer("io ring"), Contains("not implemented"));
    CHECK_THAT(taken.answer("connect"), Contains("not permitted"));
}

TEST_CASE("a folder can be given to be listed and not read", "[sandbox]") {
    Files files;
    Taken taken(files.inside / "a.obj", files.inside);
    CHECK(taken.answer("list " + files.inside.string()) == "done");
    CHECK(taken.answer("read " + (files.inside / "a.obj").string()) == "done");
    if (taken.lacks(no_file_filter, "Landlock")) return;
    CHECK_THAT(taken.answer("read " + (files.inside / "deep" / "b.png").string()), Contains("refused"));
    CHECK_THAT(taken.answer("list " + files.beside.string()), Contains("refused"));
}

TEST_CASE("what lies beside a model and below is given, and nothing that a link leads out to", "[sandbox]") {
    Files files;
    fs::create_directories(files.inside / "deep" / ".keys");
    fs::create_directories(files.inside / "deep" / "deeper");
    for (const char* name : {"deep/.secret", "deep/.keys/id", ".hidden", "deep/deeper/c.png", "b.mtl"})
        std::ofstream(files.inside / name) << "contents";
    fs::create_symlink(files.beside, files.inside / "folder-out");
    fs::create_symlink(files.beside / "secret", files.inside / "deep" / "deep-out");
    fs::create_symlink(files.inside / "deep" / ".secret", files.inside / "to-hidden");
    fs::create_symlink("deep/b.png", files.inside / "to-inside.png");
    fs::create_symlink("itself", files.inside / "itself");

    std::vector<std::string> names = files_beside(files.inside);
    const fs::path top = fs::canonical(files.inside);
    for (std::string& name : names) name = fs::path(name).lexically_relative(top).string();
    CHECK(names == std::vector<std::string>{"a.obj", "b.mtl", "deep/b.png", "deep/b.png", "deep/deeper/c.png"});
    CHECK(files_beside(files.inside, {.depth = 1}).size() == 4);
    CHECK(files_beside(files.inside, {.files = 2}).size() == 2);
    CHECK(files_beside(files.folder.path() / "nowhere").empty());

    Taken taken(files_beside(files.inside), {files.inside.string()});
    for (const char* name : {"a.obj", "deep/b.png", "deep/deeper/c.png", "to-inside.png"})
        CHECK(taken.answer("read " + (files.inside / name).string()) == "done");
    if (taken.lacks(no_file_filter, "Landlock")) return;
    for (const char* name :
         {"leads-out", "folder-out/secret", "deep/deep-out", "to-hidden", "deep/.secret", "deep/.keys/id", ".hidden"}) {
        INFO(name);
        CHECK_THAT(taken.answer("read " + (files.inside / name).string()), Contains("refused"));
    }
}

TEST_CASE("one file alone can be given", "[sandbox]") {
    Files files;
    Taken taken(files.inside / "a.obj");
    CHECK(taken.answer("read " + (files.inside / "a.obj").string()) == "done");
    if (taken.lacks(no_file_filter, "Landlock")) return;
    CHECK_THAT(taken.answer("read " + (files.inside / "deep" / "b.png").string()), Contains("refused"));
}

TEST_CASE("missing walls are told once a run, each", "[sandbox]") {
    ToldWalls told;
    CHECK(told.note(0).empty());
    CHECK_THAT(told.note(no_file_filter), Contains("Landlock"));
    CHECK(told.note(no_file_filter).empty());
    CHECK_THAT(told.note(no_call_filter | no_file_filter), Contains("seccomp") && !Contains("Landlock"));
    CHECK(told.note(no_call_filter | no_file_filter).empty());
}

TEST_CASE("missing walls are told in words", "[sandbox]") {
    CHECK(missing_walls_note(0).empty());
    CHECK_THAT(missing_walls_note(no_call_filter), Contains("seccomp") && !Contains("Landlock"));
    CHECK_THAT(missing_walls_note(no_file_filter), Contains("Landlock") && !Contains("seccomp"));
    CHECK_THAT(missing_walls_note(no_call_filter | no_file_filter), Contains("seccomp and Landlock"));
}

TEST_CASE("who reads through programs that lack a wall is warned once a run", "[sandbox]") {
    const std::string wish = "ask a";
    std::vector<std::string> warnings;
    for (int file = 0; file < 2; ++file) {
        IsolatedProgram program("a.obj", test::misbehaving_program(), std::as_bytes(std::span(wish)),
                                {.memory_bytes = built_with_address_sanitizer() ? 0 : std::uint64_t{256} << 20});
        // One that it asks in its turn, as voxtone-read asks voxtone-read-pictures.
        program.answer_by([](std::span<const std::byte> question, const Progress*, std::uint8_t& missing) {
            missing |= no_file_filter;
            return std::vector<std::byte>(question.begin(), question.end());
        });
        (void)read_guarded(program, nullptr, warnings);
    }
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], Contains("Landlock") && Contains("[less-guarded]"));
}
