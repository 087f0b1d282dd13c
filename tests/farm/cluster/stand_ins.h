// SPDX-License-Identifier: GPL-3.0-or-later
//
// Programs that stand in for Slurm's, and the environment that Slurm gives its tasks.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "tests/io/files/temporary_folder.h"

namespace voxtone::farm {

/// A variable of the environment for a while; nothing: it is not set.
class Variable {
public:
    Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
        if (const char* const old = std::getenv(name)) old_ = old;
        set(value);
    }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;
    ~Variable() { set(old_); }

private:
    void set(const std::optional<std::string>& value) const {
        if (value)
            setenv(name_, value->c_str(), 1);
        else
            unsetenv(name_);
    }
    const char* name_;
    std::optional<std::string> old_;
};

/// A folder of programs that PATH leads to, before the shell's own.
class StandIns {
public:
    /// A script; $AT is the folder.
    void program(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = folder_.path() / name;
        std::ofstream(file) << "#!/bin/sh\nAT='" << folder_.path().string() << "'\n" << text << "\n";
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
    [[nodiscard]] std::string text(const std::string& name) const {
        std::ifstream in(at(name));
        return {std::istreambuf_iterator<char>(in), {}};
    }

private:
    io::TemporaryFolder folder_;
    Variable path_{"PATH", folder_.path().string() + ":/usr/bin:/bin"};
};

/// What Slurm tells a task of itself; empty: what it would not.
class SlurmEnvironment {
public:
    SlurmEnvironment(std::optional<std::string> job, std::optional<std::string> array, std::optional<std::string> task,
                     std::optional<std::string> restarts = {})
        : job_("SLURM_JOB_ID", std::move(job)),
          array_("SLURM_ARRAY_JOB_ID", std::move(array)),
          task_("SLURM_ARRAY_TASK_ID", std::move(task)),
          restarts_("SLURM_RESTART_COUNT", std::move(restarts)) {}

private:
    Variable job_, array_, task_, restarts_;
};

}  // namespace voxtone::farm
