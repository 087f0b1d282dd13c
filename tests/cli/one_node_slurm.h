// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Slurm of its own for a test: controller and one node on this machine, with keys, ports and files of their own, run
// by whoever runs the test, and no service of the system. All of its processes end with this object, and with the test
// program however that ends.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "run_program.h"

namespace voxtone::test {

class OneNodeSlurm {
public:
    /// What of Slurm or MUNGE is not on this machine; empty: all is.
    [[nodiscard]] static std::string what_is_missing();

    /// Sets SLURM_CONF for this process and all that it starts. Throws std::runtime_error where the node does not come
    /// up.
    OneNodeSlurm();
    OneNodeSlurm(const OneNodeSlurm&) = delete;
    OneNodeSlurm& operator=(const OneNodeSlurm&) = delete;
    ~OneNodeSlurm();

    /// The node's daemon, those of its tasks and all that they run are gone at once, as in a power cut; returns when
    /// the controller has noticed.
    void crash_node();
    void start_node();

    /// What a command for the shell says on stdout.
    [[nodiscard]] static std::string ask(const std::string& command);
    /// False where that is not so after four minutes, many times what an idle machine takes.
    [[nodiscard]] static bool wait_until(const std::function<bool()>& so);
    [[nodiscard]] static bool queue_empties();

    /// For a test that failed.
    [[nodiscard]] std::string logs() const;

private:
    [[nodiscard]] pid_t start(const std::string& program, const std::vector<std::string>& words, const char* log);
    void stop_all();

    Folder folder_;
    pid_t munge_ = -1, controller_ = -1, node_ = -1;
};

}  // namespace voxtone::test
