// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/common_options.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
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

namespace {

/// Its text becomes what `parse` makes of it, before the parser takes it for a number.
CLI::Option* in_units(CLI::Option* option, double (*parse)(std::string_view, std::string_view)) {
    const std::string name = option->get_name();
    const auto convert = [=](std::string& text) {
        try {
            text = fmt::format("{}", parse(text, name));
        } catch (const UsageError& error) {
            return std::string(error.what()).substr(name.size() + 2);  // the parser names the option itself
        }
        return std::string();
    };
    return option->transform(CLI::Validator(convert, ""));
}

}  // namespace

CLI::Option* add_memory(CLI::App& command, const char* name, double& gib, const char* help) {
    return in_units(add_value(command, name, gib, help)->type_name("GIB"), parse_memory_gib);
}

CLI::Option* add_time(CLI::App& command, const char* name, double& seconds, const char* help) {
    return in_units(add_value(command, name, seconds, help)->type_name("S"), parse_time_s);
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
