// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_order.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/chart/chart_data.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_fit.h"
#include "calibration/chart/observer_start.h"

namespace voxtone::calibration {

namespace {

// Mean CIEDE2000. Real charts in their own order are fitted to 2 by three channels, shuffled ones to 15 and more.
constexpr double surely_right = 6;
constexpr double surely_better = 0.5;  // of the own order's error
constexpr Eigen::Index order_channels = 3;

using Place = std::array<int, 2>;

struct Order {
    std::string_view name;
    Place (*of)(const Place& place, const Place& size);  ///< where the colour was measured that stands at a place
};

constexpr std::array<Order, 4> orders{{{"turned by 180 degrees",
                                        [](const Place& p, const Place& s) {
                                            return Place{s[0] + 1 - p[0], s[1] + 1 - p[1]};
                                        }},
                                       {"mirrored, left for right",
                                        [](const Place& p, const Place& s) {
                                            return Place{p[0], s[1] + 1 - p[1]};
                                        }},
                                       {"mirrored, top for bottom",
                                        [](const Place& p, const Place& s) {
                                            return Place{s[0] + 1 - p[0], p[1]};
                                        }},
                                       {"column by column instead of row by row", [](const Place& p, const Place& s) {
                                            const int index = (p[1] - 1) * s[0] + p[0] -
                                                              1;  // the place of a patch in a walk down the columns
                                            return Place{index / s[1] + 1, index % s[1] + 1};
                                        }}}};

double error_of(const PatchTable& table, const ChartFitOptions& options) {
    const ChartData data = chart_data(table);
    if (data.mixtures() <= data.resins()) return 0;
    const ObserverModel model(data.resins(), white_resin(data), order_channels,
                              {.g = options.g, .eta = options.eta, .geometry = options.geometry});
    const ObserverFit fit = fit_observer(data, model, observer_start(data, order_channels));
    return optics::summarize(root_differences(fit.roots, data.roots)).mean;
}

// The table with the colours that an order gives its patches; nothing where one was not measured.
std::optional<PatchTable> in_order(const PatchTable& table, const Order& order, const Place& size,
                                   const std::map<Place, std::size_t>& at) {
    PatchTable other = table;
    for (Patch& patch : other.patches) {
        const auto measured = at.find(order.of({patch.row, patch.column}, size));
        if (measured == at.end()) return std::nullopt;
        patch.rho = table.patches[measured->second].rho;
    }
    return other;
}

}  // namespace

void expect_order(const PatchTable& table, const ChartFitOptions& options) {
    Place size{0, 0};
    std::map<Place, std::size_t> at;
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        const Patch& patch = table.patches[p];
        if (patch.row < 1 || patch.column < 1 || !at.try_emplace({patch.row, patch.column}, p).second) return;
        size = {std::max(size[0], patch.row), std::max(size[1], patch.column)};
    }
    const double own = error_of(table, options);
    if (own < surely_right) return;
    for (const Order& order : orders) {
        const auto other = in_order(table, order, size, at);
        if (!other) continue;
        const double error = error_of(*other, options);
        if (error > surely_better * own) continue;
        throw InputError(fmt::format(
            "{}: the chart was measured {}: its colours miss those of any resins by {:.1f} CIEDE2000 in the mean as "
            "they stand, and by {:.1f} in that order. Measure it again row by row from the upper left, or sort the "
            "table.",
            table.source, order.name, own, error));
    }
}

}  // namespace voxtone::calibration
