// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ctrl-C stops cleanly: while it lives, the first SIGINT or SIGTERM asks the work to stop (`Progress::cancel`), so that
// no half-written file is left; the second ends the program at once. A signal that was ignored at the start (nohup)
// stays so.
#pragma once

#include "voxtone/base/progress.h"

namespace voxtone {

/// One at a time in a program.
class CancelOnSignal {
public:
    explicit CancelOnSignal(Progress& progress);
    CancelOnSignal(const CancelOnSignal&) = delete;
    CancelOnSignal& operator=(const CancelOnSignal&) = delete;
    ~CancelOnSignal();
};

}  // namespace voxtone
