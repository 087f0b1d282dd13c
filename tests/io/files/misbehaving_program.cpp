// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does what its request says, which is nothing good: the far end of isolate_test.cpp.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/files/isolate_protocol.h"
#include "io/files/serve_isolated.h"
#include "tests/io/files/taken_program.h"

namespace {

using namespace voxtone;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(const std::string& text) {
    const auto* const first = reinterpret_cast<const std::byte*>(text.data());
    return {first, first + text.size()};
}

Bytes numbered(std::size_t size) {
    Bytes made(size);
    for (std::size_t i = 0; i < size; ++i) made[i] = static_cast<std::byte>(i * 7);
    return made;
}

std::string open_files() {
    std::string open;
    for (int fd = 0; fd < 64; ++fd)
        if (fd != io::isolation::request_fd && fd != io::isolation::result_fd && fd != io::isolation::line_fd &&
            lseek(fd, 0, SEEK_CUR) >= 0)
            open += std::to_string(fd) + " ";
    return open;
}

[[noreturn]] void leave_garbage(std::size_t size) {
    const std::string garbage(size, '\x7e');
    [[maybe_unused]] const auto written = write(io::isolation::result_fd, garbage.data(), garbage.size());
    _exit(0);
}

/// Says that there is an answer, where there is none.
[[noreturn]] void answer_nonsense() {
    const std::string garbage(40, '\x7e');
    [[maybe_unused]] auto written = write(io::isolation::result_fd, garbage.data(), garbage.size());
    written = write(io::isolation::line_fd, "x", 1);
    for (;;) pause();
}

Bytes misbehave(std::span<const std::byte> request) {
    const std::string wish(reinterpret_cast<const char*>(request.data()), request.size());
    if (wish.starts_with("make ")) return numbered(std::stoul(wish.substr(5)));
    if (wish == "echo nothing") return {};
    if (wish == "input error") throw InputError("line 7 is wrong");
    if (wish == "file error") throw FileError("gone");
    if (wish == "resource error") throw ResourceError("full");
    if (wish == "exception") throw std::runtime_error("a library says so");
    if (wish == "die") std::raise(SIGSEGV);
    if (wish == "die of memory") std::raise(SIGKILL);  // as the kernel ends who takes too much
    if (wish == "abort") std::abort();
    if (wish == "leave") _exit(3);
    if (wish == "leave garbage") leave_garbage(40);
    if (wish == "leave a byte") leave_garbage(1);
    if (wish == "leave nonsense") answer_nonsense();
    if (wish == "open files") return bytes_of(open_files());
    if (wish == "pause")
        for (;;) pause();
    if (wish == "spin")
        for (std::atomic<int> i = 0;; ++i) {
        }
    if (wish == "hoard") {
        std::vector<Bytes> hoard;
        for (;;) hoard.emplace_back(std::size_t{8} << 20);
    }
    if (wish == "chatter")
        for (int i = 0; i < 100000; ++i) {
            std::puts("nobody listens");
            std::fputs("nobody listens\n", stderr);
        }
    if (wish.starts_with("ask ")) {
        const Bytes reply = io::ask_starter(bytes_of(wish.substr(4)));
        const Bytes again = io::ask_starter(reply);
        return again;
    }
    if (const std::string outcome = test::attempt(wish); !outcome.empty()) return bytes_of(outcome);
    return bytes_of(wish);
}

}  // namespace

int main() {
    io::serve_isolated([](std::span<const std::byte> wish) { return io::packing_of(misbehave(wish)); });
    return 2;
}
