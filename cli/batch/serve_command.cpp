// SPDX-License-Identifier: GPL-3.0-or-later
//
// The service is of Python (python/voxtone/serve), for which nothing has to be installed but what the package is; this
// verb is its table of options, and becomes it.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/batch/batch_commands.h"
#include "farm/cluster/command_output.h"

namespace voxtone::cli {

namespace {

namespace fs = std::filesystem;

struct ServeArguments {
    std::string folder = "shop", listen = "127.0.0.1";
    std::vector<std::string> hosts, watched, sbatch;
    int port = 8750, jobs = 1;
    double memory_gib = 0, keep_days = 0, keep_size_gib = 0;
    bool browser = true, slurm = false;
};

/// Where the package lies that goes with the running program: in its build's sources, or around it in a wheel. Empty:
/// where Python looks.
fs::path package_beside(const fs::path& program) {
    const fs::path build = program.parent_path().parent_path();
    if (fs::exists(build / "CMakeCache.txt")) return build.parent_path().parent_path() / "python";
    const fs::path package = build.parent_path();
    if (build.filename() == "program" && fs::exists(package / "serve" / "__main__.py")) return package.parent_path();
    return {};
}

void look_first_in(const fs::path& folder) {
    if (folder.empty()) return;
    const char* const others = std::getenv("PYTHONPATH");
    const std::string path = folder.string() + (others && *others ? std::string(":") + others : "");
    setenv("PYTHONPATH", path.c_str(), 1);
}

/// The first that has the package and what it wants. Throws FileError.
std::string find_python() {
    for (const std::string python : {"python3", "/usr/bin/python3"})
        if (farm::run_command(std::vector<std::string>{python, "-c", "import voxtone.serve"}).exit_code == 0)
            return python;
    throw FileError(
        "voxtone serve wants Python 3.9 with numpy and the package voxtone, and no python3 here has them; install "
        "python3-voxtone");
}

std::vector<std::string> words_of(const ServeArguments& arguments) {
    std::vector<std::string> words{"-m", "voxtone.serve", "--folder", arguments.folder, "--listen", arguments.listen};
    for (const std::string& host : arguments.hosts) words.insert(words.end(), {"--host", host});
    for (const std::string& watch : arguments.watched) words.insert(words.end(), {"--watch", watch});
    if (arguments.slurm) words.emplace_back("--slurm");
    for (const std::string& option : arguments.sbatch) words.insert(words.end(), {"--sbatch-option", option});
    words.insert(words.end(), {"--port", std::to_string(arguments.port), "--jobs", std::to_string(arguments.jobs)});
    words.insert(words.end(), {"--memory", fmt::format("{}", arguments.memory_gib)});
    words.insert(words.end(), {"--keep-days", fmt::format("{}", arguments.keep_days)});
    words.insert(words.end(), {"--keep-size", fmt::format("{}", arguments.keep_size_gib)});
    if (!arguments.browser) words.emplace_back("--no-browser");
    return words;
}

[[noreturn]] void become_service(const ServeArguments& arguments) {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    setenv("VOXTONE_PROGRAM", program.c_str(), 1);
    look_first_in(package_beside(program));
    std::vector<std::string> words = words_of(arguments);
    words.insert(words.begin(), find_python());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    throw FileError(fmt::format("{} cannot be run ({}); install python3 again", words[0], std::strerror(errno)));
}

}  // namespace

Verb serve_verb() {
    auto arguments = std::make_shared<ServeArguments>();
    Verb command("serve", "Open a page to work at, with a queue that survives (docs/serve.md)", "--folder shop");
    command.add("--folder", arguments->folder, "where queue and results are kept; made where there is none",
                {.unit = "FOLDER"});
    command.add("--port", arguments->port, "port of the page; 0: any that is free", {.range = {0, 65535}});
    command.add("--listen", arguments->listen,
                "address that is listened at; another than this machine's own is for a proxy with TLS",
                {.unit = "ADDRESS"});
    command.add("--host", arguments->hosts, "name by which browsers may come as well, as a proxy passes it on",
                {.unit = "NAME"});
    command.add("--jobs", arguments->jobs,
                "most jobs at once; a second one begins where memory allows, by the estimates", {.range = {1, 256}});
    command.add("--memory", memory(arguments->memory_gib), "memory for all jobs, GiB; 0: the machine's",
                {.range = {0}});
    command.add("--keep-days", arguments->keep_days,
                "remove jobs that ended so long ago, and say so a day before; 0: keep them",
                {.unit = "DAYS", .range = {0}});
    command.add("--keep-size", memory(arguments->keep_size_gib),
                "remove the oldest that ended where all take more, GiB, and say so a day before; 0: keep them",
                {.range = {0}});
    command.add("--watch", arguments->watched,
                "a queue with a name: models that arrive in the folder are sliced, once they are complete, with the "
                "options of the job file SHOP/watch/NAME.json, where there is one",
                {.unit = "NAME=FOLDER", .one_each = true});
    command.add("--slurm", arguments->slurm,
                "hand jobs to Slurm, as `voxtone batch --slurm` does; the shop lies where all nodes see it");
    command.add("--sbatch-option", arguments->sbatch,
                "with --slurm: an option of sbatch without its dashes, such as partition=long",
                {.unit = "OPTION", .one_each = true});
    command.add("--browser", arguments->browser, "open the page where there is a desktop or not", {.off = true});
    command.run = [arguments]() -> int {
        if (!arguments->sbatch.empty() && !arguments->slurm) throw UsageError("--sbatch-option is for --slurm");
        become_service(*arguments);
    };
    return command;
}

}  // namespace voxtone::cli
