// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/photo_overlay.h"

#include <fmt/format.h>

#include "calibration/photo/overlay.h"

namespace voxtone::calibration {

io::Picture8 photo_overlay(const PhotoMeasurement& m, const CheckerChart& chart, int longest_px) {
    constexpr OverlayColour green{0, 200, 0}, red{230, 30, 30}, blue{40, 110, 255}, white{255, 255, 255}, black{};
    constexpr double dirty = 0.15, dark = 0.25;
    Overlay overlay(m.photograph, m.model, longest_px);
    for (std::size_t s = 0; s < m.squares.size(); ++s) {
        overlay.box(m.view.place, m.square_areas[s], m.squares[s].rejected > dirty ? red : green);
        overlay.text(m.squares[s].middle_px, fmt::format("{}", s + 1), m.rho[s].mean() < dark ? white : black);
    }
    for (const Area& area : m.frame_areas) overlay.box(m.view.place, area, blue);
    for (int row = 0; row < chart.rows; ++row)
        for (int column = 0; column < chart.columns; ++column)
            overlay.box(m.checker.place, checker_area(column, row), white);
    return overlay.picture();
}

}  // namespace voxtone::calibration
