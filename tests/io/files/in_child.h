// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work that may crash, in a forked child: for tests that read many damaged files in one process.
#pragma once

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/files/isolate.h"

namespace voxtone::test {

struct ChildDied : std::runtime_error {
    using runtime_error::runtime_error;
};

/// What the work gives, at most 1 MiB. Throws ChildDied when it crashed, threw, or took more than 20 s or 1 GiB.
inline std::vector<std::byte> in_child(const std::function<std::vector<std::byte>()>& work) {
    constexpr std::size_t most = std::size_t{1} << 20;
    struct Shared {
        std::size_t size;
        std::byte bytes[most];
    };
    void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory to share with a child");
    auto* const shared = static_cast<Shared*>(memory);
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);
        if (!io::built_with_address_sanitizer()) {
            constexpr rlim_t data = rlim_t{1} << 30;
            const rlimit limit{data, data};
            setrlimit(RLIMIT_DATA, &limit);
            if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(1);  // which libpng may fill
        }
        try {
            const std::vector<std::byte> bytes = work();
            if (bytes.size() > most) _exit(1);
            std::copy(bytes.begin(), bytes.end(), shared->bytes);
            shared->size = bytes.size();
        } catch (...) {
            _exit(1);
        }
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    const std::vector<std::byte> bytes(shared->bytes, shared->bytes + shared->size);
    munmap(memory, sizeof(Shared));
    if (child < 0 || status != 0) throw ChildDied("the child ended with status " + std::to_string(status));
    return bytes;
}

}  // namespace voxtone::test
