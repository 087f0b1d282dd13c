// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one has to say of a stack that another program made, for every verb that reads any stack
// (slicer/predict/stack_volume.h).
#pragma once

#include <string>
#include <vector>

namespace voxtone::cli {

class Verb;

/// --resins, --assign, --nearest, --printer, --pitch, under one heading of --help.
void add_foreign_stack_options(Verb& command, std::string& resins, std::vector<std::string>& assign, bool& nearest,
                               std::string& printer, std::string& pitch);

}  // namespace voxtone::cli
