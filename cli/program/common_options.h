// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that verbs share, each declared once.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "cli/program/console.h"
#include "cli/program/verb.h"

namespace voxtone::cli {

/// How a verb runs.
struct RunOptions {
    ConsoleOptions console;
    int threads = 0;
};
/// --threads, --json, --progress, --quiet.
void add_run_options(Verb& verb, RunOptions& options);
int run_on_console(const RunOptions& options, const std::function<JobResult(Progress&)>& work);

/// `--threads`, [0, 1024].
void add_threads_option(Verb& verb, int& threads);

/// `more` goes on with the sentence: ", RGB".
void add_resins_option(Verb& verb, std::string& resins, const std::string& more = {});
/// A set or file that has to be named, by its place.
void add_resins(Verb& verb, std::string& resins, const std::string& more = {});
/// `--printer` as id or file.
/// --illuminant of what shows a stack.
void add_illuminant_option(Verb& verb, std::string& illuminant);
void add_printer_option(Verb& verb, std::string& printer);
/// `-o,--out`; `unit`: FILE or FOLDER.
void add_out_option(Verb& verb, std::string& out, const char* unit, const char* help, bool required = true);
/// `--overwrite`, of a verb that writes files.
void add_overwrite_option(Verb& verb, bool& overwrite);
/// `-o,--out` for a laminate, and `--overwrite`.
void add_stack_folder_options(Verb& verb, std::string& out, bool& overwrite);
/// The same for files in a folder that may hold others.
void add_file_folder_options(Verb& verb, std::string& out, bool& overwrite, const char* help);

}  // namespace voxtone::cli
