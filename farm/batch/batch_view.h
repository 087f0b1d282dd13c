// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a batch tells of its jobs while it runs: to a terminal, a log or a program (cli/batch/batch_view.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace voxtone::farm {

struct JobEvent {
    enum class Kind {
        started,
        done,
        unchanged,  ///< was done before, and nothing has changed since
        failed,     ///< for good
        again,      ///< did not end well, and is tried again
        stopped,    ///< on request, to go on another time
        elsewhere,  ///< another batch works on it
        warned,     ///< something beside the job: its state was not written, its --after failed
    };
    Kind kind;
    std::string name;
    std::string message = {};  ///< why
    int exit_code = 0;
    int attempt = 0;
    int threads = 0;     ///< of a started job
    double seconds = 0;  ///< that the attempt took
};

/// A model that has become complete in a watched folder (arrivals.h).
struct ArrivedModel {
    std::string model;
    std::vector<std::string> beside;  ///< files of the folder that it names, and that are there
    bool again = false;               ///< it arrived before, and these have changed since
};

struct BatchSnapshot {
    struct Running {
        std::string name;
        double seconds = 0;
        std::string says;  ///< the last line of its log
    };
    std::size_t jobs = 0, done = 0, unchanged = 0, failed = 0;  ///< `unchanged` are among those done
    std::vector<Running> running;
    [[nodiscard]] std::size_t left() const { return jobs - done - failed - running.size(); }
};

class BatchView {
public:
    virtual ~BatchView() = default;
    virtual void notify(const JobEvent& event) = 0;
    virtual void arrived(const ArrivedModel&) {}
    /// Whether `show` wants to be called; asked many times a second.
    virtual bool wants_snapshot() { return false; }
    virtual void show(const BatchSnapshot&) {}
};

}  // namespace voxtone::farm
