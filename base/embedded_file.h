// SPDX-License-Identifier: GPL-3.0-or-later
//
// A data file that was put into the program when it was built (cmake/embed.cmake), so that a lone binary works.
#pragma once

#include <string_view>

namespace voxtone {

struct EmbeddedFile {
    std::string_view name;  ///< the file's name without folder and extension
    std::string_view text;
};

}  // namespace voxtone
