// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that a job leaves, read by libpng and OpenEXR.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace voxtone::test {

struct Numbers {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> of;  ///< rows from the top, by channel
    std::string comment;
};
Numbers read_numbers(const std::string& file);

/// R, G, B.
std::vector<std::uint8_t> read_codes(const std::string& file);

/// IEC 61966-2-1, in [0, 255].
double code_of(double light);

}  // namespace voxtone::test
