// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contracts: our own voice, for mistakes in this code. A broken contract is a bug and ends the program with exit
// code 1. Cheap contracts stay on in release builds; `VOXTONE_DEBUG_EXPECT` is for those inside hot loops.
#pragma once

#include <stdexcept>

namespace voxtone {

class ContractViolation : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

[[noreturn]] void contract_violated(const char* kind, const char* condition, const char* file, int line);

}  // namespace voxtone

/// What the caller owes.
#define VOXTONE_EXPECT(condition) \
    (static_cast<bool>(condition) ? void(0) : ::voxtone::contract_violated("expected", #condition, __FILE__, __LINE__))
/// What this code promises.
#define VOXTONE_ENSURE(condition) \
    (static_cast<bool>(condition) ? void(0) : ::voxtone::contract_violated("promised", #condition, __FILE__, __LINE__))

#ifdef NDEBUG
#define VOXTONE_DEBUG_EXPECT(condition) void(0)
#else
#define VOXTONE_DEBUG_EXPECT(condition) VOXTONE_EXPECT(condition)
#endif
