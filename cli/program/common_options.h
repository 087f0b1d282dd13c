// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that verbs share, each declared once: how it is called, what it is checked against, what `--help` says of it.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/program/console.h"

namespace voxtone::cli {

/// Lengths as a user writes them, "60mm" or "2.5in" (base/units.h). They stay text until the verb runs, so that a wrong
/// one is told as all errors of the verb are, with --json too. Lives as long as the command that it adds options to.
class LengthOptions {
public:
    LengthOptions() = default;
    LengthOptions(const LengthOptions&) = delete;
    LengthOptions& operator=(const LengthOptions&) = delete;

    /// `--help` shows the number that is there as the default.
    CLI::Option* add(CLI::App& command, const char* name, double& mm, const char* help);
    /// Must be given.
    CLI::Option* add_required(CLI::App& command, const char* name, double& mm, const char* help);
    /// Not given or empty: nothing.
    CLI::Option* add(CLI::App& command, const char* name, std::optional<double>& mm, const char* help);

    /// Sets the numbers. Throws UsageError that names the option.
    void read() const;

private:
    struct Length {
        std::string name, text;
        std::function<void(const std::string& text)> set;
    };
    CLI::Option* declare(CLI::App& command, const char* help, Length length);
    std::deque<Length> lengths_;  // a deque: CLI11 keeps references to the texts
};

/// How a verb runs, and the lengths among its options.
struct RunOptions {
    ConsoleOptions console;
    int threads = 0;
    LengthOptions lengths;
};
/// --threads, --json, --quiet.
void add_run_options(CLI::App& command, RunOptions& options);
/// `work` finds the lengths set.
int run_on_console(const RunOptions& options, const std::function<JobResult(Progress&)>& work);

/// `--threads`, [0, 1024].
CLI::Option* add_threads_option(CLI::App& command, int& threads);

/// `more` goes on with the sentence: ", RGB". `name`: of a positional argument, or another option. `--help` shows the
/// set that is there as the default.
CLI::Option* add_resins_option(CLI::App& command, std::string& resins, const std::string& more = {},
                               const char* name = "--resins");
/// `--printer` as id or file.
CLI::Option* add_printer_option(CLI::App& command, std::string& printer);
/// `-o,--out`, required; `type`: FILE or FOLDER.
CLI::Option* add_out_option(CLI::App& command, std::string& out, const char* type, const char* help);
/// `--overwrite`, of a verb that writes files.
CLI::Option* add_overwrite_option(CLI::App& command, bool& overwrite);
/// `-o,--out` for a laminate, and `--overwrite`.
void add_stack_folder_options(CLI::App& command, std::string& out, bool& overwrite);
/// The same for files in a folder that may hold others.
void add_file_folder_options(CLI::App& command, std::string& out, bool& overwrite, const char* help);
CLI::Option* add_seed_option(CLI::App& command, std::uint64_t& seed, const char* help);

/// A plain value with its default.
template <class Value>
CLI::Option* add_value(CLI::App& command, const char* name, Value& value, const char* help) {
    return command.add_option(name, value, help)->capture_default_str();
}
/// What takes units as lengths do: memory ("2GiB"; a bare number is in GiB, kept so) and times ("2min"; s).
/// base/units.h.
CLI::Option* add_memory(CLI::App& command, const char* name, double& gib, const char* help);
CLI::Option* add_time(CLI::App& command, const char* name, double& seconds, const char* help);
/// One that counts something.
template <class Value>
CLI::Option* add_count(CLI::App& command, const char* name, Value& value, const char* help) {
    return add_value(command, name, value, help)->type_name("N");
}

}  // namespace voxtone::cli
