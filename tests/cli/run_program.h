// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs the real program, as a user would, and looks at what it says and leaves.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::test {

struct Outcome {
    int exit_code = -1;
    std::string out, err;
};

/// Exit code of a line for the shell; -1 where a signal ended it.
int run_shell(const std::string& command);
/// Whether the shell finds such a program.
bool is_here(const std::string& program);

/// `arguments` as a shell reads them.
Outcome run_program(const std::string& arguments);
/// Sends the signal once the program has said `said` on stdout: an event of --json. It ends before that at its own
/// risk. Throws where it neither says so nor ends within five minutes; it is killed then.
Outcome run_and_signal(const std::string& arguments, const std::string& said, int signal);

/// An empty folder of its own for this test, removed at the end.
class Folder {
public:
    explicit Folder(const std::string& name);
    ~Folder();
    [[nodiscard]] std::filesystem::path path() const { return path_; }
    [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    void write(const std::string& name, const std::string& bytes) const;

private:
    std::filesystem::path path_;
};

/// A PNG as RGBA pixels, row by row from the top.
struct Bitmap {
    int width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 4>> pixels;
    [[nodiscard]] std::array<std::uint8_t, 4> at(int x, int y) const {
        return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    }
};
[[nodiscard]] Bitmap read_png(const std::string& path);

[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Files below a folder with their contents, by relative name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> read_tree(const std::filesystem::path& folder);

/// OBJ of an L-shaped asymmetric marker in mm: a 6 x 3 x 2 base with a 2 x 1 x 3 tower on the corner x, y in [0, 2] x
/// [0, 1].
[[nodiscard]] std::string marker_obj();

/// OBJ of a box [0, x] x [0, y] x [0, z] whose vertex colours run from red at x = 0 to green at x.
[[nodiscard]] std::string ramp_box_obj(double x, double y, double z);

/// The same from rose to sage: colours that the usual resins reach, which are separated in half the time.
[[nodiscard]] std::string soft_box_obj(double x, double y, double z);

/// JSON of a printer that refuses nothing, of a pitch whose screen is built in: another pitch's takes each job seconds.
[[nodiscard]] std::string lenient_printer();

}  // namespace voxtone::test
