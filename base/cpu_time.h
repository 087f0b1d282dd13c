// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace voxtone {

/// Seconds that processors have worked for this process since it began, summed over its threads, and for the programs
/// that it has run to their end.
[[nodiscard]] double cpu_seconds();

}  // namespace voxtone
