// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/serve_isolated.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "voxtone/base/error.h"
#include "voxtone/io/files/isolate_protocol.h"

namespace voxtone::io {

namespace {

using namespace isolation;

std::uint64_t mapped_bytes() {
    std::uint64_t pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
        unsigned long long value = 0;
        if (std::fscanf(file, "%llu", &value) == 1) pages = value;
        std::fclose(file);
    }
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

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

void leave(Outcome outcome, int code, const void* data, std::size_t size) {
    const unsigned char head[head_bytes] = {static_cast<unsigned char>(outcome), static_cast<unsigned char>(code)};
    if (write_all(result_fd, head, head_bytes) && write_all(result_fd, data, size)) return;
    const unsigned char full[head_bytes] = {static_cast<unsigned char>(Outcome::no_memory), 0};  // the file ran out
    if (ftruncate(result_fd, 0) == 0 && lseek(result_fd, 0, SEEK_SET) == 0) write_all(result_fd, full, head_bytes);
}

void limit_memory(std::uint64_t bytes) {
    rlimit limit{};
    if (bytes == 0 || getrlimit(RLIMIT_AS, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max = std::min<rlim_t>(limit.rlim_max, mapped_bytes() + bytes);
    setrlimit(RLIMIT_AS, &limit);
}

/// The walls that stand only once the libraries are loaded; a filter of system calls has its place here.
void confine(const RequestHead& head) { limit_memory(head.memory_bytes); }

/// Nothing when there is none: the program was not started by `IsolatedProgram`.
bool read_request(RequestHead& head, std::vector<std::byte>& request) {
    struct stat about {};
    if (fstat(request_fd, &about) != 0 || !S_ISREG(about.st_mode)) return false;
    if (static_cast<std::uint64_t>(about.st_size) < sizeof head || !read_all(request_fd, &head, sizeof head))
        return false;
    request.resize(static_cast<std::size_t>(about.st_size) - sizeof head);
    return read_all(request_fd, request.data(), request.size());
}

}  // namespace

void serve_isolated(const std::function<std::vector<std::byte>(std::span<const std::byte>)>& work) {
    RequestHead head{};
    std::vector<std::byte> request;
    if (!read_request(head, request)) return;
    confine(head);
    try {
        const std::vector<std::byte> bytes = work(request);
        leave(Outcome::result, 0, bytes.data(), bytes.size());
    } catch (const Error& error) {
        leave(Outcome::error, static_cast<int>(error.exit_code()), error.what(), std::strlen(error.what()));
    } catch (const std::bad_alloc&) {
        leave(Outcome::no_memory, 0, nullptr, 0);
    } catch (const std::exception& error) {
        leave(Outcome::unknown, 0, error.what(), std::strlen(error.what()));
    } catch (...) {
        leave(Outcome::unknown, 0, nullptr, 0);
    }
    _exit(0);  // past the destructors of a hundred libraries
}

}  // namespace voxtone::io
