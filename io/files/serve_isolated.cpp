// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/serve_isolated.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <optional>

#include "base/error.h"
#include "io/files/isolate_protocol.h"
#include "io/files/sandbox.h"

namespace voxtone::io {

namespace {

using namespace isolation;

using Work = std::function<Packing(std::span<const std::byte>)>;

std::uint8_t missing_walls = 0;

bool write_all(int fd, const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = write(fd, at, std::min<std::size_t>(size, std::size_t{1} << 30));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        at += written;
        size -= static_cast<std::size_t>(written);
    }
    return true;
}

bool read_all(int fd, void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
        const ssize_t got = read(fd, at, size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

bool begin_answer(Outcome outcome, int code) {
    const unsigned char head[head_bytes] = {static_cast<unsigned char>(outcome), static_cast<unsigned char>(code),
                                            missing_walls};
    return ftruncate(result_fd, 0) == 0 && lseek(result_fd, 0, SEEK_SET) == 0 && write_all(result_fd, head, head_bytes);
}

bool write_answer(Outcome outcome, int code, const void* data, std::size_t size) {
    return begin_answer(outcome, code) && write_all(result_fd, data, size);
}

/// Writes what is dropped then: whole pages of it go back to the system piece by piece, for the file takes as much.
bool write_and_drop(const void* data, std::size_t size) {
    static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    constexpr std::size_t piece = std::size_t{16} << 20;
    auto* at = static_cast<char*>(const_cast<void*>(data));
    for (std::size_t done = 0; done < size; done += piece) {
        const std::size_t now = std::min(piece, size - done);
        if (!write_all(result_fd, at + done, now)) return false;
        void* begin = at + done;
        std::size_t space = now;
        if (now > page && std::align(page, page, begin, space)) madvise(begin, space / page * page, MADV_DONTNEED);
    }
    return true;
}

/// Leaves a result; where the file runs out, the word for it.
void write_result(const Packing& result) {
    bool good = begin_answer(Outcome::result, 0);
    PackedWriter writer([&](const void* data, std::size_t size) { good = good && write_and_drop(data, size); });
    if (good) result(writer);
    if (!good) write_answer(Outcome::no_memory, 0, nullptr, 0);
}

void say_answered() {
    const char byte = 1;
    write_all(line_fd, &byte, 1);
}

void write_or_tell(Outcome outcome, int code, const void* data, std::size_t size) {
    if (!write_answer(outcome, code, data, size)) write_answer(Outcome::no_memory, 0, nullptr, 0);  // the file ran out
}

/// Leaves an answer and says so.
void leave(Outcome outcome, int code = 0, const void* data = nullptr, std::size_t size = 0) {
    write_or_tell(outcome, code, data, size);
    say_answered();
}

void leave(Outcome outcome, int code, const char* text) { leave(outcome, code, text, std::strlen(text)); }

/// Waits for a request. Nothing when no more is to come.
std::optional<std::vector<std::byte>> next_request() {
    char byte = 0;
    struct stat about {};
    if (!read_all(line_fd, &byte, 1) || fstat(request_fd, &about) != 0 || lseek(request_fd, 0, SEEK_SET) != 0)
        return std::nullopt;
    std::vector<std::byte> request(static_cast<std::size_t>(about.st_size));
    if (!read_all(request_fd, request.data(), request.size())) return std::nullopt;
    return request;
}

void answer_one(const Work& work, std::span<const std::byte> request) {
    try {
        write_result(work(request));
        say_answered();
    } catch (const Error& error) {
        leave(Outcome::error, static_cast<int>(error.exit_code()), error.what());
    } catch (const std::bad_alloc&) {
        leave(Outcome::no_memory, memory_was_limited_outside());
    } catch (const std::exception& error) {
        leave(Outcome::unknown, 0, error.what());
    } catch (...) {
        leave(Outcome::unknown);
    }
}

bool was_started_by_hand() {
    struct stat about {};
    return fstat(request_fd, &about) != 0 || !S_ISREG(about.st_mode);
}

}  // namespace

std::vector<std::byte> ask_starter(std::span<const std::byte> question) {
    leave(Outcome::question, 0, question.data(), question.size());
    const auto bytes = next_request();
    if (!bytes) _exit(0);  // nobody waits for this any more
    auto reply = unpacked<Reply>(*bytes);
    if (!reply.refusal.empty()) throw InputError(reply.refusal);
    return std::move(reply.answer);
}

void serve_isolated(const Work& work) {
    if (was_started_by_hand()) return;
    if (const auto first = next_request()) {
        const auto orders = unpacked<Orders>(*first);
        missing_walls = raise_walls({orders.readable, orders.listable},
                                    {orders.memory_bytes, head_bytes + orders.result_bytes, orders.threads});
        answer_one(work, orders.request);
        while (const auto request = next_request()) answer_one(work, *request);
    }
    _exit(0);  // past the destructors of a hundred libraries
}

}  // namespace voxtone::io
