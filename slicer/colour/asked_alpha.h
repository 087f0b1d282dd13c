// SPDX-License-Identifier: GPL-3.0-or-later
//
// The translucency alpha that is asked for, what a print's resins show of it (halftone/separation/translucency.h: in a
// wide slab, before the loop), and what is given up where no thickness of them shows as much. 1 means as opaque as they
// go, and gives nothing up.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "halftone/separation/translucency.h"
#include "io/report/report.h"
#include "optics/scene/surface.h"
#include "slicer/part/job_body.h"
#include "slicer/surface/coloured_surface.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// One of a map's three kinds.
struct AlphaMap {
    const char* name;     ///< "alpha asked"
    const char* caption;  ///< with its colours
    /// Linear sRGB of what a place has of its kind.
    Eigen::Vector3f (*colour)(float value);
};
/// In the order of PrintedAlpha::at.
[[nodiscard]] const std::array<AlphaMap, 3>& alpha_maps();

class PrintedAlpha {
public:
    /// Keeps references to all.
    PrintedAlpha(const VisibleSurface& surface, const SurfaceColour& colour, const halftone::Translucency& translucency)
        : surface_(surface), colour_(colour), translucency_(translucency) {}

    /// Asked, shown, given up at a point of a triangle of the mesh.
    [[nodiscard]] Eigen::Vector3f at(std::uint32_t triangle, float u, float v) const;
    /// Over the surface.
    [[nodiscard]] io::ReportTranslucency figures() const;
    /// By name, of more than a hundredth of the surface that gives up what can be seen; empty: there is none.
    [[nodiscard]] std::string warning() const;
    /// The surface in the colours of each map. Keeps references.
    [[nodiscard]] std::vector<ColouredSurface> maps() const;

private:
    struct Samples {
        io::ReportTranslucency figures;
        double most_asked = 0, least_shown = 1;  ///< where much is given up
    };
    [[nodiscard]] Samples samples() const;

    const VisibleSurface& surface_;
    const SurfaceColour& colour_;
    const halftone::Translucency& translucency_;
};

/// Of each map: the means of cells of a prediction, as colours.
[[nodiscard]] std::vector<std::vector<Eigen::Vector3f>> alpha_of_cells(const optics::Surface& cells,
                                                                       const std::array<double, 3>& pitch_mm,
                                                                       const JobBody& body,
                                                                       const halftone::Translucency& translucency);

}  // namespace voxtone::slicer
