// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/contracts.h"

#include <fmt/core.h>

namespace voxtone {

void contract_violated(const char* kind, const char* condition, const char* file, int line) {
    throw ContractViolation(fmt::format("{}:{}: {} `{}`", file, line, kind, condition));
}

}  // namespace voxtone
