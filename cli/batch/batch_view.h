// SPDX-License-Identifier: GPL-3.0-or-later
//
// A batch as it runs: a table that is redrawn in place on a terminal, one line an event elsewhere, one JSON object an
// event for programs:
//   {"event":"job","job":"spot-003","state":"started","attempt":1,"threads":2}
//   {"event":"job","job":"spot-003","state":"failed","attempt":1,"exit_code":3,"seconds":2.1,"message":"..."}
// States are those of JobEvent::Kind.
#pragma once

#include <memory>

#include "cli/program/console.h"
#include "farm/batch/batch_view.h"

namespace voxtone::cli {

/// What suits the options and the terminal.
[[nodiscard]] std::unique_ptr<farm::BatchView> make_batch_view(const ConsoleOptions& options);

}  // namespace voxtone::cli
