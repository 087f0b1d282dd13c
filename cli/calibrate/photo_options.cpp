// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/photo_options.h"

#include "cli/program/common_options.h"

namespace voxtone::cli {

void add_corners_option(Verb& command, const char* name, std::vector<double>& corners, const char* help) {
    command.add(name, corners, help, {.unit = "X,Y,...", .separator = ',', .count = {8, 8}});
}

std::optional<std::array<Eigen::Vector2d, 4>> four_points(const std::vector<double>& numbers) {
    if (numbers.empty()) return std::nullopt;
    std::array<Eigen::Vector2d, 4> points;
    for (std::size_t i = 0; i < 4; ++i) points[i] = {numbers[2 * i], numbers[2 * i + 1]};
    return points;
}

void add_coding_option(Verb& command, std::string& coding) {
    command.add("--coding", coding,
                "how samples stand for light; auto: as the file says, else as the checker's greys say",
                {.choices = {"auto", "linear", "srgb"}});
}

io::SampleCoding coding_of(const std::string& word) {
    if (word == "linear") return io::SampleCoding::linear;
    return word == "srgb" ? io::SampleCoding::srgb : io::SampleCoding::unknown;
}

}  // namespace voxtone::cli
