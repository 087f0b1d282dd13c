// SPDX-License-Identifier: GPL-3.0-or-later
//
// A verb of the program, one file each: parse, call, print. It adds its sub-command and returns what to run when it was
// chosen; the number that this gives back is the exit code.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace voxtone::cli {

using Command = std::function<int()>;

}  // namespace voxtone::cli
