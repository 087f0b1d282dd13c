// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/device_curves.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

DeviceCurves::DeviceCurves(TextTable& table) {
    std::size_t steps = 0;
    for (const std::string& field : table.names()) {
        const std::size_t last = field.rfind('_');
        const std::string ink = last == std::string::npos ? std::string() : field.substr(last + 1);
        const bool counts = ink == "I";
        if (ink.empty() || (!counts && std::ranges::find(inks_, ink) != inks_.end()))
            table.fail(fmt::format("the field {} is no ink, or is there twice", shown(field)));
        steps += counts ? 1 : 0;
        inks_.push_back(counts ? "" : ink);
    }
    if (steps != 1) table.fail("it needs one field that counts the steps, such as CMYK_I");
    while (table.next()) {
        for (std::size_t k = 0; k < inks_.size(); ++k)
            (inks_[k].empty() ? input_ : printed_[inks_[k]]).push_back(table.number(k));
        if (input_.size() > 1 && !(input_.back() > input_[input_.size() - 2])) table.fail("the steps do not rise");
    }
}

bool DeviceCurves::straight() const {
    constexpr double seen = 1e-4;
    return std::ranges::all_of(printed_, [&](const auto& curve) {
        for (std::size_t k = 0; k < input_.size(); ++k)
            if (std::abs(curve.second[k] - input_[k]) > seen * input_.back()) return false;
        return true;
    });
}

double DeviceCurves::printed(const std::vector<double>& curve, double asked) const {
    const auto above = std::ranges::upper_bound(input_, asked);
    if (above == input_.begin()) return curve.front();
    if (above == input_.end()) return curve.back();
    const auto k = static_cast<std::size_t>(above - input_.begin());
    const double t = (asked - input_[k - 1]) / (input_[k] - input_[k - 1]);
    return curve[k - 1] + t * (curve[k] - curve[k - 1]);
}

void DeviceCurves::apply(ChartReading& reading) const {
    if (empty() || straight()) return;
    std::vector<Patch>& patches = reading.table.patches;
    double largest = 0;
    for (const Patch& patch : patches)
        for (const ResinShare& share : patch.top) {
            largest = std::max(largest, share.fraction);
            if (!printed_.contains(share.role))
                throw InputError(fmt::format(
                    "{}: its CAL table holds the curves of a printer's calibration, through which the chart was "
                    "printed, "
                    "and none of {}, so that nothing says how much of it was; give the chart without its calibration, "
                    "printed anew, or with all curves.",
                    reading.table.source, share.role));
        }
    // Whether shares, and curves, are percent.
    const double whole = largest > 1 ? 100 : 1, top = input_.back() > 2 ? 100 : 1;
    for (Patch& patch : patches)
        for (ResinShare& share : patch.top)
            share.fraction = whole / top * printed(printed_.at(share.role), share.fraction / whole * top);
    reading.behind_curves = true;
    reading.table.notes.push_back(
        fmt::format("{}: was printed through the curves of its CAL table; its inks are taken as they come out of them.",
                    reading.table.source));
}

}  // namespace voxtone::calibration
