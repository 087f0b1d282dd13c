// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_commands.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include <fmt/core.h>

#include "base/error.h"
#include "farm/cluster/command_output.h"

namespace voxtone::farm {

namespace {

/// What may go another time: a controller that is away or busy, and limits that fall as jobs end.
bool is_temporary(const std::string& reason) {
    constexpr std::array<std::string_view, 6> signs{"contact", "timed out",    "temporarily",
                                                    "onnect",  "submit limit", "MaxSubmit"};
    return std::any_of(signs.begin(), signs.end(),
                       [&](std::string_view sign) { return reason.find(sign) != std::string::npos; });
}

[[noreturn]] void refuse(const char* program, const CommandOutput& said) {
    if (said.exit_code == CommandOutput::no_such_program)
        throw FileError(
            fmt::format("{} is not on this machine, so nothing is submitted: run this where Slurm's commands are, or "
                        "look at the scripts with --dry-run",
                        program));
    const std::string reason = said.reason();
    if (reason.find("configuration source") != std::string::npos)
        throw FileError(
            fmt::format("Slurm's commands are here but find no cluster, so nothing is submitted: is there a slurm.conf "
                        "(SLURM_CONF)? {} says: {}",
                        program, reason));
    throw TryAgain(fmt::format("Slurm does not answer, so nothing is submitted; try again when it does ({} says: {})",
                               program, reason));
}

/// "1-02:03:04", "2:03:04", "3:04"; nothing: "UNLIMITED" and its like.
std::optional<double> duration_s(const std::string& text) {
    int days = 0, hours = 0, minutes = 0, seconds = 0;
    const bool has_days = std::sscanf(text.c_str(), "%d-%d:%d:%d", &days, &hours, &minutes, &seconds) == 4;
    if (!has_days) days = 0;
    const bool has_hours = has_days || std::sscanf(text.c_str(), "%d:%d:%d", &hours, &minutes, &seconds) == 3;
    if (!has_hours) hours = 0;
    if (!has_hours && std::sscanf(text.c_str(), "%d:%d", &minutes, &seconds) != 2) return std::nullopt;
    return ((days * 24.0 + hours) * 60 + minutes) * 60 + seconds;
}

std::string variable(const char* name) {
    const char* const text = std::getenv(name);
    return text ? text : "";
}

std::string first_line(const std::string& text) { return text.substr(0, text.find_first_of("\r\n")); }

}  // namespace

SlurmConfig slurm_config() {
    const std::array<std::string, 3> arguments{"scontrol", "show", "config"};
    const CommandOutput said = run_command(arguments);
    if (said.exit_code != 0) refuse("scontrol", said);
    SlurmConfig config;
    std::istringstream lines(said.out);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("MaxArraySize")) continue;
        const std::size_t digits = line.find_first_of("0123456789");
        if (digits != std::string::npos)
            std::from_chars(line.data() + digits, line.data() + line.size(), config.max_array_size);
    }
    return config;
}

SlurmQueue slurm_queue() {
    const std::array<std::string, 4> arguments{"squeue", "--me", "--noheader", "--format=%F %t %r"};
    const CommandOutput said = run_command(arguments);
    if (said.exit_code != 0) refuse("squeue", said);
    SlurmQueue queue;
    std::istringstream lines(said.out);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string number, state, reason;
        if (!(words >> number)) continue;
        queue.numbers.insert(number);
        words >> state >> reason;  // "JobHeldUser", "JobHeldAdmin", "launch_failed_requeued_held"
        if (state == "SE" || reason.find("Held") != std::string::npos || reason.find("held") != std::string::npos)
            queue.held[number] = reason == "None" ? "" : reason;
    }
    return queue;
}

bool ended_out_of_memory(const std::string& number) {
    const std::array<std::string, 5> arguments{"scontrol", "--oneliner", "show", "job", number};
    const CommandOutput said = run_command(arguments);
    return said.exit_code == 0 && said.out.find("JobState=OUT_OF_MEMORY") != std::string::npos;
}

std::string submit_to_slurm(std::span<const std::string> arguments) {
    std::vector<std::string> all{"sbatch", "--parsable"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandOutput said = run_command(all);
    if (said.exit_code == CommandOutput::no_such_program) refuse("sbatch", said);
    if (said.exit_code != 0) {
        const std::string reason = said.reason();
        if (is_temporary(reason)) throw TryAgain(fmt::format("sbatch cannot take it now: {}", reason));
        throw InputError(fmt::format("sbatch refuses it: {}", reason));
    }
    const std::string line = first_line(said.out), number = line.substr(0, line.find(';'));  // NUMBER[;CLUSTER]
    if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos)
        throw InputError(fmt::format("sbatch says no job's number but '{}'", first_line(said.out)));
    return number;
}

void cancel_in_slurm(const std::vector<std::string>& numbers) {
    constexpr std::size_t most_at_once = 1000;
    for (std::size_t begin = 0; begin < numbers.size(); begin += most_at_once) {
        const std::size_t end = std::min(begin + most_at_once, numbers.size());
        std::vector<std::string> arguments{"scancel", "--quiet"};
        arguments.insert(arguments.end(), numbers.begin() + std::ptrdiff_t(begin),
                         numbers.begin() + std::ptrdiff_t(end));
        (void)run_command(arguments);
    }
}

SlurmAllocation own_slurm_allocation() {
    const std::string array = variable("SLURM_ARRAY_JOB_ID"), task = variable("SLURM_ARRAY_TASK_ID");
    const int restarts = std::atoi(variable("SLURM_RESTART_COUNT").c_str());
    // A task's own number may be the whole array's too.
    if (!array.empty() && !task.empty()) return {array, array + "_" + task, restarts};
    const std::string job = variable("SLURM_JOB_ID");
    return {job, job, restarts};
}

std::optional<SlurmTime> slurm_time(const std::string& task) {
    const std::array<std::string, 4> arguments{"squeue", "--noheader", "--format=%L %l", "--jobs=" + task};
    const CommandOutput said = run_command(arguments);
    if (said.exit_code != 0) return std::nullopt;
    std::istringstream words(said.out);
    std::string left, limit;
    words >> left >> limit;
    const auto left_s = duration_s(left), limit_s = duration_s(limit);
    if (!left_s || !limit_s) return std::nullopt;
    return SlurmTime{*left_s, *limit_s};
}

bool is_taken_out_of_slurm(const std::string& task) {
    const std::array<std::string, 4> arguments{"squeue", "--noheader", "--format=%t %L", "--jobs=" + task};
    const CommandOutput said = run_command(arguments);
    std::istringstream words(said.out);
    std::string state, left;
    words >> state >> left;
    return said.exit_code == 0 && state == "CG" && duration_s(left).value_or(1) > 0;  // completing
}

bool requeue_in_slurm(const std::string& task) {
    const std::array<std::string, 3> arguments{"scontrol", "requeue", task};
    return run_command(arguments).exit_code == 0;
}

}  // namespace voxtone::farm
