// SPDX-License-Identifier: GPL-3.0-or-later
//
// One photograph of a body, and its prediction as that photograph would show it: both cell by cell of a window of the
// picture around the body, as a flat print's are, so that all that is found of flat prints is found of bodies.
//
// A cell counts where all of it sees the body, not aslant (66 degrees), away from outlines by what a flat print's edge
// is left out by, in light, off highlights. Light and veil are taken out (body_light.h).
#pragma once

#include "calibration/compare/predicted_body.h"
#include "calibration/compare/predicted_print.h"
#include "calibration/compare/print_reading.h"

namespace voxtone::calibration {

struct BodyReading {
    PredictedPrint print;
    PrintReading reading;
};

/// Throws InputError that names the photograph, what is wrong and what to try.
[[nodiscard]] BodyReading read_body(io::Photograph photograph, const PredictedBody& body, io::SampleCoding coding);

}  // namespace voxtone::calibration
