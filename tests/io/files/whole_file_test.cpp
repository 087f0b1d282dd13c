// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/whole_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/disk/folder_lock.h"
#include "io/disk/open_file.h"
#include "io/files/read_bytes.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// What is asked of the system while one lives: "sync FILE" and "rename FROM TO", by names without folders; and whether
/// syncing fails.
struct SystemCalls {
    explicit SystemCalls(bool fail = false) : syncs_fail(fail) { watching = this; }
    ~SystemCalls() { watching = nullptr; }
    SystemCalls(const SystemCalls&) = delete;
    SystemCalls& operator=(const SystemCalls&) = delete;

    bool syncs_fail;
    std::vector<std::string> made;
    static SystemCalls* watching;
};
SystemCalls* SystemCalls::watching = nullptr;

}  // namespace

// In the place of the C library's, in this program.
extern "C" int fsync(int file) {
    if (SystemCalls* const calls = SystemCalls::watching) {
        std::error_code error;
        calls->made.push_back("sync " +
                              fs::read_symlink(fmt::format("/proc/self/fd/{}", file), error).filename().string());
        if (calls->syncs_fail) return errno = EIO, -1;
    }
    return static_cast<int>(syscall(SYS_fsync, file));
}

extern "C" int rename(const char* from, const char* to) noexcept {
    if (SystemCalls* const calls = SystemCalls::watching)
        calls->made.push_back("rename " + fs::path(from).filename().string() + " " + fs::path(to).filename().string());
    return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace {

/// What happens as soon as the next file is open.
std::function<void()> after_open;

}  // namespace

extern "C" std::FILE* fopen(const char* path, const char* mode) {
    const int file = open(path, *mode == 'r' ? O_RDONLY : O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0) return nullptr;
    if (const auto what = std::exchange(after_open, nullptr)) what();
    return fdopen(file, mode);
}

namespace {

std::ptrdiff_t files_in(const fs::path& folder) { return std::distance(fs::directory_iterator(folder), {}); }

/// Writes of this process stop at so many bytes, with an error instead of a signal.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

/// The number of a process that is no more.
pid_t ended_process() {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    REQUIRE(child > 0);
    REQUIRE(waitpid(child, nullptr, 0) == child);
    return child;
}

}  // namespace

TEST_CASE("a file that cannot be written to its end leaves the old one and nothing else", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "notes.txt";
    write_whole_file(file, std::string_view("old"));
    {
        const FileSizeLimit limit(1000);
        CHECK_THROWS_AS(write_whole_file(file, std::string(5000, 'x')), FileError);
    }
    CHECK(text_of(file) == "old");
    CHECK(files_in(folder.path()) == 1);
    write_whole_file(file, std::string_view("new"));
    CHECK(text_of(file) == "new");
    CHECK(files_in(folder.path()) == 1);
}

TEST_CASE("a file is synced before it is renamed, and its folder behind that", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "state.json";
    const std::string part = part_path(file).filename().string(), place = folder.path().filename().string();
    const std::vector<std::string> in_turn{"sync " + part, "rename " + part + " state.json", "sync " + place};
    {
        const SystemCalls calls;
        write_whole_file(file, std::string_view("new"));
        CHECK(calls.made == in_turn);
    }
    std::ofstream(part_path(file)) << "newer";
    const SystemCalls calls;
    finish_part(file);
    CHECK(calls.made == in_turn);
    CHECK(text_of(file) == "newer");
}

TEST_CASE("what the disk did not take is an error, and the old file stays", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "state.json";
    write_whole_file(file, std::string_view("old"));
    std::vector<std::string> made;
    {
        const SystemCalls calls(true);
        CHECK_THROWS_AS(write_whole_file(file, std::string_view("new")), FileError);
        std::ofstream(part_path(file)) << "newer";
        CHECK_THROWS_AS(finish_part(file), FileError);
        made = calls.made;
    }
    CHECK(made.size() == 2);  // nothing was renamed
    CHECK(text_of(file) == "old");
    CHECK(files_in(folder.path()) == 1);
}

TEST_CASE("temporary names say whose they are, and what a killed job left is swept", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    const auto name_of = [&](const std::string& of, const std::string& space, pid_t process, std::uint64_t start) {
        return folder.path() / fmt::format(".{}.{}.{}-{}-{}.part", of, host_name(), space, process, start);
    };
    const std::string here = process_space(), container = here == "00000000" ? "11111111" : "00000000";
    CHECK(part_path(file) == name_of("a.png", here, getpid(), start_of_process(getpid())));
    const pid_t first = ended_process();
    pid_t second = ended_process();
    while (second == first) second = ended_process();
    const fs::path dead = name_of("a.png", here, first, 1), later = name_of("a.png", here, 1, start_of_process(1) + 1),
                   left = name_of("a.png", container, 1, 1);
    const fs::path locked = name_of("a.png", here, second, 1), living = name_of("a.png", here, 1, start_of_process(1)),
                   container_s = name_of("a.png", container, 1, 2), other = name_of("b.png", here, first, 1),
                   elsewhere = folder.path() / fmt::format(".a.png.another-host.{}-{}-1.part", here, first);
    for (const fs::path& part : {dead, later, left, locked, living, container_s, other, elsewhere})
        std::ofstream(part) << "half";
    fs::last_write_time(left, fs::file_time_type::clock::now() - std::chrono::hours(2));
    const OpenFile held(::open(locked.c_str(), O_RDWR | O_CLOEXEC));
    REQUIRE(flock(held.get(), LOCK_EX | LOCK_NB) == 0);
    write_whole_file(file, std::string_view("whole"));
    for (const fs::path& swept : {dead, later, left}) CHECK_FALSE(fs::exists(swept));
    for (const fs::path& kept : {locked, living, container_s, elsewhere, other, file}) CHECK(fs::exists(kept));
}

TEST_CASE("what a process left that has ended is swept, though nobody has asked how it ended", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        std::ofstream(part_path(file)) << "half";
        _exit(0);
    }
    siginfo_t about{};
    REQUIRE(waitid(P_PID, id_t(child), &about, WEXITED | WNOWAIT) == 0);
    CHECK(start_of_process(child) == 0);
    CHECK(files_in(folder.path()) == 1);
    write_whole_file(file, std::string_view("whole"));
    CHECK(files_in(folder.path()) == 1);
    REQUIRE(waitpid(child, nullptr, 0) == child);
}

TEST_CASE("two containers with one host name and one process number write under two names", "[whole-file]") {
    // Another start of process 1, and the same process number in another space.
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png", mine = part_path(file);
    std::string of_another = mine.filename().string();
    of_another.replace(of_another.find(process_space()), process_space().size(), "0123abcd");
    std::ofstream(folder.path() / of_another) << "half";
    write_whole_file(file, std::string_view("whole"));
    CHECK(text_of(file) == "whole");
    CHECK(text_of(folder.path() / of_another) == "half");
}

TEST_CASE("two writers of one process number do not write into one file", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    std::ofstream(part_path(file)) << "half";
    const OpenFile held(::open(part_path(file).c_str(), O_RDWR | O_CLOEXEC));
    REQUIRE(flock(held.get(), LOCK_EX | LOCK_NB) == 0);
    CHECK_THROWS_AS(write_whole_file(file, std::string_view("whole")), TryAgain);
    CHECK(text_of(part_path(file)) == "half");
}

TEST_CASE("a staged file is never in the place of another", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "slice_00000.png";
    write_staged_file(file, std::string_view("first"));
    CHECK_THROWS_AS(write_staged_file(file, std::string_view("second")), Error);
    CHECK(text_of(file) == "first");
}

TEST_CASE("a file is read up to the size that it may have, and no byte more", "[whole-file]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.json";
    write_whole_file(file, std::string(1000, 'x'));
    CHECK(read_whole_file(file, 1000) == std::vector<std::uint8_t>(1000, 'x'));
    CHECK_THROWS_WITH(read_whole_file(file, 999), Contains("a.json") && Contains("1000 bytes, more than the 999"));
    write_whole_file(file, std::string_view());
    CHECK(read_whole_file(file, 0).empty());
    CHECK_THROWS_AS(read_whole_file(folder.path() / "none.json", 1000), FileError);
}

TEST_CASE("A file is as long as what was opened, whatever has its name by then") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.json";
    const auto swapped = [&](std::size_t was, std::size_t becomes) {
        write_whole_file(file, std::string(was, 'x'));
        after_open = [file, becomes] { write_whole_file(file, std::string(becomes, 'y')); };
    };
    for (const std::size_t becomes : {10, 5000}) {
        swapped(1000, becomes);
        CHECK(read_whole_file(file, 1000) == std::vector<std::uint8_t>(1000, 'x'));
        swapped(1000, becomes);
        CHECK(read_bytes(file, 1000) == std::vector<std::byte>(1000, std::byte{'x'}));
    }
    CHECK_THROWS_WITH(read_whole_file(folder.path(), 1000), Contains("is no file that can be read (Is a directory)"));
    CHECK_THROWS_AS(read_bytes(folder.path(), 1000), FileError);
}
