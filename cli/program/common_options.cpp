// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/common_options.h"

#include "slicer/options/option_values.h"

namespace voxtone::cli {

void add_run_options(Verb& verb, RunOptions& options) {
    add_threads_option(verb, options.threads);
    add_console_options(verb, options.console);
}

int run_on_console(const RunOptions& options, const std::function<JobResult(Progress&)>& work) {
    return run_on_console(options.console, options.threads, work);
}

void add_threads_option(Verb& verb, int& threads) {
    verb.add("--threads", threads, "threads; 0: one per core. The result does not depend on it",
             {.range = {0, 1024}, .group = "Run"});
}

namespace {

void add_resin_set(Verb& verb, const char* names, std::string& resins, const std::string& more, bool required) {
    verb.add(names, resins, "resin set (`voxtone list resins`) or file" + more,
             {.unit = "SET|FILE", .required = required});
}

}  // namespace

void add_resins_option(Verb& verb, std::string& resins, const std::string& more) {
    add_resin_set(verb, "--resins", resins, more, false);
}

void add_resins(Verb& verb, std::string& resins, const std::string& more) {
    add_resin_set(verb, "resins", resins, more, true);
}

void add_illuminant_option(Verb& verb, std::string& illuminant) {
    verb.add("--illuminant", illuminant,
             std::string(slicer::illuminant_words) + ", and are a guess without; empty: that of the job",
             {.unit = "LAMP|FILE"});
}

void add_printer_option(Verb& verb, std::string& printer) {
    verb.add("--printer", printer, "printer (`voxtone list printers`) or file of its profile", {.unit = "ID|FILE"});
}

void add_out_option(Verb& verb, std::string& out, const char* unit, const char* help, bool required) {
    verb.add("-o,--out", out, help, {.unit = unit, .required = required});
}

void add_overwrite_option(Verb& verb, bool& overwrite) {
    verb.add("--overwrite", overwrite, "replace files that are there already");
}

void add_stack_folder_options(Verb& verb, std::string& out, bool& overwrite) {
    add_out_option(verb, out, "FOLDER", "output folder");
    verb.add("--overwrite", overwrite, "replace a stack that the folder holds; other things in it stay");
}

void add_file_folder_options(Verb& verb, std::string& out, bool& overwrite, const char* help) {
    add_out_option(verb, out, "FOLDER", help);
    add_overwrite_option(verb, overwrite);
}

}  // namespace voxtone::cli
