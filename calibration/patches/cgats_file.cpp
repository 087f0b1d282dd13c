// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cgats_file.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/device_curves.h"
#include "calibration/tables/cgats_text.h"

namespace voxtone::calibration {

namespace {

constexpr std::string_view calibration_kind = "CAL";

void refuse_expected_colours(const CgatsText& table) {
    const bool first = table.kind().starts_with("CTI1"), second = table.kind().starts_with("CTI2");
    // targen's guess of the paper's colour, which stays where a file has lost its first line.
    const bool guessed = !table.kind().starts_with("CTI3") && std::ranges::any_of(table.words(), [](const auto& w) {
        return w.first == "APPROX_WHITE_POINT";
    });
    if (first || second || guessed)
        table.fail(fmt::format(
            "is a chart of Argyll's that is to be printed ({}): its colours are what is expected of it, and "
            "nobody has measured them; print it, measure it, and give the .ti3",
            first    ? "CTI1, a .ti1"
            : second ? "CTI2, a .ti2"
                     : "APPROX_WHITE_POINT"));
}

}  // namespace

ChartReading read_cgats(std::string_view text, const std::string& source, ColumnWords words) {
    CgatsText file(text, source);
    ChartReading reading;
    reading.table.source = source;
    DeviceCurves curves;
    bool found = false;
    std::string fault;  // of the first table that cannot be used
    while (file.next_table(found ? calibration_kind : "")) {
        refuse_expected_colours(file);
        if (file.kind() == calibration_kind) {
            curves = DeviceCurves(file);
            continue;
        }
        words.device = file.device();
        std::optional<ChartColumns> columns;
        try {
            columns = chart_columns(file.names(), file.where(), words);
        } catch (const InputError& error) {
            if (fault.empty()) fault = error.what();
        }
        if (columns)
            take_rows(file, *columns, reading);
        else
            while (file.next()) {
            }
        found = columns.has_value();
    }
    if (found) {
        curves.apply(reading);
        return reading;
    }
    if (!fault.empty()) throw InputError(fault);
    if (!curves.empty())
        throw InputError(
            fmt::format("{}: holds the curves of a printer's calibration (CAL) and no measurement; give the chart that "
                        "was measured (.ti3).",
                        source));
    throw InputError(fmt::format(
        "{}: has no BEGIN_DATA, so that it holds no measurement or is cut short; export it again.", source));
}

}  // namespace voxtone::calibration
