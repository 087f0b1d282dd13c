// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_program.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/core.h>
#include <png.h>

#include "base/warning.h"
#include "tests/places.h"

namespace voxtone::test {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

namespace {

/// Whatever a test runs: a warning ends with its name (base/warning.h).
void expect_names(const std::string& err) {
    bool open = false;  // a name of a file may break its line
    std::stringstream lines(err);
    for (std::string line; std::getline(lines, line);) {
        const bool begins = line.find("warning: ") != std::string::npos;
        if (begins && open) break;
        open = (begins || open) && message_name(line).empty();
    }
    if (open) throw std::runtime_error("a warning without a name: " + err);
}

/// `meanwhile(child, stdout)` is called while it runs.
template <class Meanwhile>
Outcome run(const std::string& arguments, Meanwhile&& meanwhile) {
    const Folder folder("outcome");
    const std::string command =
        fmt::format("exec {} {} >'{}' 2>'{}'", program(), arguments, folder / "out", folder / "err");
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    meanwhile(child, folder / "out");
    int status = 0;
    waitpid(child, &status, 0);
    Outcome outcome;
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.out = read_file(folder / "out");
    outcome.err = read_file(folder / "err");
    expect_names(outcome.err);
    return outcome;
}

}  // namespace

int run_shell(const std::string& command) {
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool is_here(const std::string& program) { return run_shell("command -v " + program + " >/dev/null 2>&1") == 0; }

Outcome run_program(const std::string& arguments) {
    return run(arguments, [](pid_t, const std::string&) {});
}

/// Of a program that is waited for; it ends a test that would hang, long before ctest ends the program of all tests.
constexpr std::chrono::seconds longest_silence{300};

Outcome run_and_signal(const std::string& arguments, const std::string& said, int signal) {
    return run(arguments, [&](pid_t child, const std::string& out) {
        siginfo_t ended{};
        const auto began = std::chrono::steady_clock::now();
        while (read_file(out).find(said) == std::string::npos) {
            if (std::chrono::steady_clock::now() - began > longest_silence) {
                kill(child, SIGKILL);
                waitpid(child, nullptr, 0);
                throw std::runtime_error(fmt::format("'{}' did not say '{}' in {} s", arguments, said,
                                                     std::chrono::seconds(longest_silence).count()));
            }
            if (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid != 0)
                return;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        kill(child, signal);
    });
}

Folder::Folder(const std::string& name) {
    std::string pattern = (fs::temp_directory_path() / ("voxtone-" + name + "-")).string().append(6, 'X');
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path_ = pattern;
}

Folder::~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void Folder::write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
}

Bitmap read_png(const std::string& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&image, path.c_str())) throw std::runtime_error(path + ": " + image.message);
    image.format = PNG_FORMAT_RGBA;
    Bitmap bitmap{static_cast<int>(image.width), static_cast<int>(image.height), {}};
    bitmap.pixels.resize(std::size_t(image.width) * image.height);
    if (!png_image_finish_read(&image, nullptr, bitmap.pixels.data(), 0, nullptr))
        throw std::runtime_error(path + ": " + image.message);
    return bitmap;
}

std::vector<std::pair<std::string, std::string>> read_tree(const fs::path& folder) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files.emplace_back(fs::relative(entry.path(), folder).string(), read_file(entry.path()));
    std::sort(files.begin(), files.end());
    return files;
}

namespace {

std::string box_obj(std::array<double, 3> low, std::array<double, 3> high, int first_vertex) {
    std::string text;
    for (int corner = 0; corner < 8; ++corner)
        text += fmt::format("v {} {} {}\n", corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                            corner & 4 ? high[2] : low[2]);
    for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                          std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
        text += fmt::format("f {} {} {} {}\n", f[0] + first_vertex, f[1] + first_vertex, f[2] + first_vertex,
                            f[3] + first_vertex);
    return text;
}

std::string two_colour_box_obj(std::array<double, 3> size, const char* left, const char* right) {
    std::string text;
    for (int corner = 0; corner < 8; ++corner)
        text += fmt::format("v {} {} {} {}\n", corner & 1 ? size[0] : 0, corner & 2 ? size[1] : 0,
                            corner & 4 ? size[2] : 0, corner & 1 ? right : left);
    const std::string box = box_obj({0, 0, 0}, {1, 1, 1}, 1);
    return text + box.substr(box.find("f "));
}

}  // namespace

std::string marker_obj() { return box_obj({0, 0, 0}, {6, 3, 2}, 1) + box_obj({0, 0, 1}, {2, 1, 5}, 9); }

std::string ramp_box_obj(double x, double y, double z) { return two_colour_box_obj({x, y, z}, "0.6 0 0", "0 0.5 0"); }

std::string soft_box_obj(double x, double y, double z) {
    return two_colour_box_obj({x, y, z}, "0.7 0.45 0.45", "0.45 0.6 0.45");
}

std::string lenient_printer() {
    return R"({"format": "voxtone-printer", "version": 1, "name": "any", "pitch_um": [42.333333, 84.666667, 27]})";
}

}  // namespace voxtone::test
