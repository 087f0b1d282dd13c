// SPDX-License-Identifier: GPL-3.0-or-later
//
// A verb that is a family of steps (`voxtone laminate search`): exactly one of them is chosen.
#pragma once

#include <functional>
#include <vector>

#include "cli/program/command.h"

namespace voxtone::cli {

/// How a step adds its sub-command and says what to run.
using AddStep = std::function<Command(CLI::App& verb)>;

/// Adds the steps in this order; what is given back runs the chosen one.
Command add_steps(CLI::App& verb, const std::vector<AddStep>& steps);

}  // namespace voxtone::cli
