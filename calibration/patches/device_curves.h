// SPDX-License-Identifier: GPL-3.0-or-later
//
// The curves of a printer's calibration, as Argyll's CAL table has them beside a chart: of each ink, what is printed
// where so much is asked for, both from 0 to 1. The inks of such a chart are those before the curves; its colours are
// those of what was printed.
//
//   CMYK_I CMYK_C CMYK_M CMYK_Y CMYK_K
//   0.5    0.66   0.64   0.66   0.6
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibration/patches/chart_reading.h"
#include "calibration/tables/text_table.h"

namespace voxtone::calibration {

class DeviceCurves {
public:
    DeviceCurves() = default;
    /// Takes all rows. Throws InputError: no column that counts the steps, one that is no ink, what is no number, steps
    /// that do not rise.
    explicit DeviceCurves(TextTable& table);
    [[nodiscard]] bool empty() const { return input_.empty(); }

    /// The inks of a chart as they were printed, with a note; straight curves change nothing. Throws InputError where
    /// an ink of the chart has no curve.
    void apply(ChartReading& reading) const;

private:
    [[nodiscard]] bool straight() const;
    [[nodiscard]] double printed(const std::vector<double>& curve, double asked) const;

    std::vector<std::string> inks_;  ///< by field; empty: the steps
    std::vector<double> input_;
    std::map<std::string, std::vector<double>> printed_;
};

}  // namespace voxtone::calibration
