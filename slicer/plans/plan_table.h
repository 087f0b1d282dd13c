// SPDX-License-Identifier: GPL-3.0-or-later
//
// Plans as tables (io/files/csv_table.h): a line for each part or job, whose cells are what an object of a plan has
// under the words of the header. A word that is a key but for capital letters ("Model", as spreadsheets have it) is
// that key; a cell that is empty is as if it were not there.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::slicer {

struct PlanTableRow {
    std::size_t line = 0;  ///< on which it begins
    std::string json;      ///< one object
};

struct PlanTable {
    std::vector<std::string> header;
    std::size_t header_line = 0;
    std::vector<PlanTableRow> rows;
    std::vector<std::string> faults;  ///< of lines that are no row: "line 4: ..."
};

/// `keys`: of the plan.
[[nodiscard]] PlanTable plan_table(std::string_view text, std::span<const std::string> keys);

}  // namespace voxtone::slicer
