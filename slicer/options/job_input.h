// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file that decides what a job makes, by what it holds: its name may change.
#pragma once

#include <string>

namespace voxtone::slicer {

struct JobInput {
    /// The option that names it ("model", "printer"), with a role or the name of a file beside it where it has one:
    /// "laminate-materials:W", "model:textures/skin.png".
    std::string key;
    std::string file;    ///< where it was; empty: it comes with the program
    std::string sha256;  ///< 64 hexadecimal digits; empty: there was no such file
};

}  // namespace voxtone::slicer
