// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/plan_table.h"

#include <algorithm>
#include <utility>

#include "io/files/csv_table.h"
#include "io/files/json_writer.h"

namespace voxtone::slicer {

namespace {

bool is_same_word(std::string_view a, std::string_view b) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::ranges::equal(a, b, {}, small, small);
}

}  // namespace

PlanTable plan_table(std::string_view text, std::span<const std::string> keys) {
    io::CsvTable table = io::parse_csv(text);
    PlanTable plan{std::move(table.header), table.header_line, {}, std::move(table.faults)};
    for (std::string& word : plan.header) {
        const auto same = [&](const std::string& key) { return is_same_word(key, word); };
        const auto key = std::ranges::find_if(keys, same);
        if (key != keys.end() && std::ranges::count_if(plan.header, same) == 1) word = *key;
    }
    for (const io::CsvRow& row : table.rows) {
        io::JsonWriter json;
        json.begin_object();
        for (std::size_t i = 0; i < row.cells.size(); ++i)
            if (!row.cells[i].empty()) json.add(plan.header[i], row.cells[i]);
        plan.rows.push_back({row.line, json.end_object().text()});
    }
    return plan;
}

}  // namespace voxtone::slicer
