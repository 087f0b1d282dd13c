// SPDX-License-Identifier: GPL-3.0-or-later
//
// A projector: a round lamp far away, before it a mask whose image lies sharply on a plane. A ray carries light where
// its direction points into the lamp and its line meets that plane within the image; off the plane the image is as
// blurred as the lamp is wide.
//
// Unit: 1 is the radiance of a white diffuser in the plane, where it is lit.
#pragma once

#include <vector>

#include "optics/camera/sky.h"

namespace voxtone::optics {

enum class BeamShape {
    edge,  ///< what lies to the left of `along`, seen from where the normal points
    slit,  ///< a strip along `along`
    spot,  ///< a disc
};

/// Where an image lies. Unit vectors, `along` square to `normal`. The lamp stands over `along`.
struct BeamPlane {
    Point place{}, normal{0, 0, 1}, along{1, 0, 0};
};

struct BeamKind {
    BeamShape shape = BeamShape::edge;
    double width_mm = 0;  ///< of a slit, diameter of a spot; > 0
    double times = 1;     ///< so many times the unit of light where it is lit; > 0
    // Of the lamp: from the normal, and from its middle to its rim; together below 90. So that a smooth face mirrors
    // none of it to a camera that looks down on it: those of 85 mm see 15 degrees to either side.
    double tilt_deg = 45, half_angle_deg = 30;
};

class Beam {
public:
    /// One image at least. A place that lies in several is lit as in one.
    Beam(const BeamKind& kind, std::vector<BeamPlane> planes);

    [[nodiscard]] const BeamKind& kind() const { return kind_; }
    [[nodiscard]] const std::vector<BeamPlane>& planes() const { return planes_; }
    /// What comes to `from` along a ray that points back to where it came from.
    [[nodiscard]] const Light& radiance(const Point& from, const Point& way) const;
    /// A direction into a lamp, evenly; three numbers in [0, 1). Its density per steradian.
    [[nodiscard]] Point draw(double which, double u, double v) const;
    [[nodiscard]] double density(const Point& way) const;

    /// How far a place of a plane lies outside of its image, mm; below 0 within.
    [[nodiscard]] double outside_mm(const BeamPlane& plane, const Point& at) const;

private:
    [[nodiscard]] bool in_lamp(std::size_t plane, const Point& way) const;

    BeamKind kind_;
    std::vector<BeamPlane> planes_;
    std::vector<Point> lamps_;  ///< towards the middle of each
    double rim_cosine_;
    Light lit_, dark_{};
};

}  // namespace voxtone::optics
