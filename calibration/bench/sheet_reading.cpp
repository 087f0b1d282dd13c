// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/sheet_reading.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::calibration {
namespace {

constexpr double least_step = 0.2;    // of a perfect diffuser, from black to white
constexpr double most_blur_mm = 0.2;  // of the camera: more hides what a slab does
constexpr double whitest = 0.999;     // as in setup.json

}  // namespace

optics::EdgeKernels bare_sheet_kernels(const EdgeSetup& setup) {
    optics::EdgeRun run;
    run.assembly = setup.assembly;
    run.assembly.gel = run.assembly.glass = false;
    run.assembly.slab_index = 1;
    run.assembly.slab_roughness = 0;
    run.slab_mm = 1e-3;
    run.sigma_t = 1e-9;
    run.light = optics::light_window(setup.assembly);
    run.paths = 1u << 23;
    return optics::edge_kernels(optics::trace_edge_paths(run), optics::EdgeUnits(run), 0);
}

SheetReading read_sheet(const EdgeStrip& strip, const std::string& name) {
    SheetReading sheet;
    sheet.edge = fit_bare_edge(strip);
    if (sheet.edge.contrast < least_step)
        throw InputError(fmt::format(
            "{}: white is brighter than black by {:.3f} only (a perfect diffuser is 1): no printed edge, or "
            "there is something on it",
            name, sheet.edge.contrast));
    if (sheet.edge.blur_mm > most_blur_mm)
        throw InputError(
            fmt::format("{}: the photograph is blurred: the bare edge spreads over {:.2f} mm (one standard deviation), "
                        "more than what a slab does; focus on the sheet, use a tripod",
                        name, sheet.edge.blur_mm));
    const double end = strip.x_mm.back();
    const Eigen::Vector3d white = side_mean(strip, 0.3 * end, end), black = side_mean(strip, -end, -0.3 * end);
    for (std::size_t c = 0; c < 3; ++c) {
        sheet.seen_white[c] = white[Eigen::Index(c)];
        sheet.seen_black[c] = black[Eigen::Index(c)];
    }
    return sheet;
}

SheetBase base_under_surface(const SheetReading& sheet, const optics::EdgeKernels& kernels) {
    const auto base_of = [&](double seen) {
        double low = 0, high = whitest;
        for (int step = 0; step < 50; ++step) {
            const double R = (low + high) / 2;
            (optics::far_from_edge(kernels, R) < seen ? low : high) = R;
        }
        return (low + high) / 2;
    };
    SheetBase base;
    for (std::size_t c = 0; c < 3; ++c) {
        base.white[c] = base_of(sheet.seen_white[c]);
        base.black[c] = std::max(base_of(sheet.seen_black[c]), 1e-4);
        base.too_bright[c] = base.white[c] > whitest - 1e-9;
    }
    return base;
}

}  // namespace voxtone::calibration
