// SPDX-License-Identifier: GPL-3.0-or-later
//
// A code as modules, dark and light.
#pragma once

#include <cstdint>
#include <vector>

namespace voxtone::io {

enum class CodeKind : std::uint8_t { qr, data_matrix, gs1_data_matrix, gs1_qr, gs1_128 };

struct CodeSymbol {
    int columns = 0, rows = 0;  ///< of bars: as many rows as make them high enough
    std::vector<bool> dark;     ///< rows from the top
    int quiet_columns = 0;      ///< free on the left and on the right, or readers do not find it
    int quiet_rows = 0;         ///< free above and below
    bool is_bars = false;       ///< one row of bars; else a matrix
};

}  // namespace voxtone::io
