// SPDX-License-Identifier: GPL-3.0-or-later
//
// From where a body was photographed: a pinhole camera, found by the body's outline and its pattern.
//
// From the start that the user gives the camera is moved so far off and aside that area and middle of the outline
// agree; then, from coarse to fine, Gauss-Newton on what is blurred alike in photograph and prediction: the outline,
// and the logarithms of red, green and blue less their surroundings on the body, so that light, exposure and white
// balance do not count. Beyond the outline the body's nearest place tells how the outline moves. Places that stay off
// weigh little (Geman and McClure's weights).
//
// Light and gloss have patterns too: to a part of a cell the camera is found by a prediction that is lit as the
// photograph is (body_light.h), by the pattern alone, the focal length with it.
//
// Needs a pattern, or a body that is not round, within some 25 degrees of the start; a lens that distorts is left in.
#pragma once

#include "calibration/compare/body_picture.h"
#include "calibration/compare/predicted_body.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct PlacedBody {
    BodyCamera camera;
    double correlation = 0;  ///< of the pattern
    double overlap = 0;      ///< of the outlines: what both cover over what one does
};

/// To a cell or so. `photograph`: linear. Throws InputError: another print, another side, a mirrored one, too few
/// pixels.
[[nodiscard]] PlacedBody place_body(const io::Photograph& photograph, const PredictedBody& body);
/// From there to a part of a cell, by the body in colours as they are lit.
[[nodiscard]] BodyCamera refine_place(const io::Photograph& photograph, const PredictedBody& lit, BodyCamera camera);

}  // namespace voxtone::calibration
