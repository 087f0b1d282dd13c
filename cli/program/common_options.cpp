// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/common_options.h"

#include <utility>

#include <fmt/format.h>

#include "base/units.h"

namespace voxtone::cli {

CLI::Option* LengthOptions::declare(CLI::App& command, const char* help, Length length) {
    Length& kept = lengths_.emplace_back(std::move(length));
    return command.add_option(kept.name, kept.text, help)->type_name("LENGTH");
}

CLI::Option* LengthOptions::add(CLI::App& command, const char* name, double& mm, const char* help) {
    const auto set = [&mm, what = std::string(name)](const std::string& text) { mm = parse_length_mm(text, what); };
    return declare(command, help, {name, mm == 0 ? std::string("0") : fmt::format("{:g}mm", mm), set})
        ->capture_default_str();
}

CLI::Option* LengthOptions::add_required(CLI::App& command, const char* name, double& mm, const char* help) {
    return add(command, name, mm, help)->default_str({})->required();
}

CLI::Option* LengthOptions::add(CLI::App& command, const char* name, std::optional<double>& mm, const char* help) {
    const auto set = [&mm, what = std::string(name)](const std::string& text) {
        if (!text.empty()) mm = parse_length_mm(text, what);
    };
    return declare(command, help, {name, {}, set});
}

void LengthOptions::read() const {
    for (const Length& length : lengths_) length.set(length.text);
}

void add_run_options(CLI::App& command, RunOptions& options) {
    add_threads_option(command, options.threads);
    add_console_options(command, options.console);
}

int run_on_console(const RunOptions& options, const std::function<JobResult(Progress&)>& work) {
    return run_on_console(options.console, options.threads, [&](Progress& progress) {
        options.lengths.read();
        return work(progress);
    });
}

CLI::Option* add_threads_option(CLI::App& command, int& threads) {
    return command.add_option("--threads", threads, "threads; 0: one per core. The result does not depend on it")
        ->group("Run")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
}

CLI::Option* add_resins_option(CLI::App& command, std::string& resins, const std::string& more, const char* name) {
    return command.add_option(name, resins, "resin set (`voxtone list resins`) or file" + more)
        ->type_name("SET|FILE")
        ->capture_default_str();
}

CLI::Option* add_printer_option(CLI::App& command, std::string& printer) {
    return command.add_option("--printer", printer, "printer (`voxtone list printers`) or file of its profile")
        ->type_name("ID|FILE")
        ->capture_default_str();
}

CLI::Option* add_out_option(CLI::App& command, std::string& out, const char* type, const char* help) {
    return command.add_option("-o,--out", out, help)->type_name(type)->required();
}

CLI::Option* add_overwrite_option(CLI::App& command, bool& overwrite) {
    return command.add_flag("--overwrite", overwrite, "replace files that are there already");
}

void add_stack_folder_options(CLI::App& command, std::string& out, bool& overwrite) {
    add_out_option(command, out, "FOLDER", "output folder");
    command.add_flag("--overwrite", overwrite, "replace a stack that the folder holds; other things in it stay");
}

void add_file_folder_options(CLI::App& command, std::string& out, bool& overwrite, const char* help) {
    add_out_option(command, out, "FOLDER", help);
    add_overwrite_option(command, overwrite);
}

CLI::Option* add_seed_option(CLI::App& command, std::uint64_t& seed, const char* help) {
    return add_count(command, "--seed", seed, help);
}

}  // namespace voxtone::cli
