// SPDX-License-Identifier: GPL-3.0-or-later
//
// A condition of the machine stood in the way, not the job and not its files: the same command may succeed later or
// elsewhere. Schedulers are told by the exit code (EX_TEMPFAIL of sysexits.h).
#pragma once

#include <string>

#include "voxtone/base/error.h"

namespace voxtone {

inline constexpr auto exit_try_again = static_cast<ExitCode>(75);

class TryAgain : public Error {
public:
    explicit TryAgain(const std::string& message) : Error(exit_try_again, message) {}
};

}  // namespace voxtone
