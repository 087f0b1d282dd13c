// SPDX-License-Identifier: GPL-3.0-or-later
//
// Comma-separated values (RFC 4180) with a header, as spreadsheets export them: cells in double quotes may hold commas,
// line breaks and doubled quotes; a byte order mark and either kind of line break are understood. Beyond that, blank
// lines and lines that begin with '#' are skipped, and blanks around a cell without quotes are not its own.
// Why our own: Debian 12 has no CSV library that tells on which line a cell stands.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::slicer {

struct CsvRow {
    std::size_t line = 0;  ///< on which it begins, 1 for the first of the file
    std::vector<std::string> cells;
};

/// What of the text could be understood, and one sentence for each line that could not: "line 4: ...".
struct CsvTable {
    std::vector<std::string> header;
    std::vector<CsvRow> rows;  ///< each as long as the header
    std::vector<std::string> faults;
};

[[nodiscard]] CsvTable parse_csv(std::string_view text);

}  // namespace voxtone::slicer
