// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a model says of a body's surface, in the form that people want: relative to the white of the same body, with its
// standard error, and as a colour.
//
//   media-relative value = appearance / appearance of the same cell, the whole body being of white resin
//
// channel by channel; colours are made of both appearances first and divided then (optics/colour/observed_colour.h),
// which is the same for R, G, B alone.
//
// Colours of a set with a residual are corrected for the mixture around each place (optics/layered/
// mixture_correction.h); values by channel are the model's own.
//
// Where the model draws random numbers the two appearances are drawn apart and their errors add as for independent
// values: the error of a / w is sqrt(error_a^2 + (a / w)^2 error_w^2) / w.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::slicer {

struct SurfacePrediction {
    optics::Surface surface;
    std::size_t channels = 0;
    std::vector<float> value;           ///< value[cell * channels + channel]: absolute or media-relative
    std::vector<float> standard_error;  ///< same shape; empty where the model draws no random numbers
    std::vector<Eigen::Vector3f> rgb;   ///< per cell, linear sRGB, not clamped
    std::vector<std::string> remarks;   ///< of the model (Appearance::remarks), of the body and of its white twin
};

/// The white that values are relative to.
struct WhiteTwin {
    const optics::ResinVolume* print = nullptr;  ///< what white is there; null: a body all of the white resin
    /// Its appearance in the surface's cells, of a model that draws no random numbers; null: `model` is asked.
    const std::vector<float>* seen = nullptr;
};

/// `white_resin`: index of the white resin for media-relative values; -1: absolute values. Remarks are warned of too.
[[nodiscard]] SurfacePrediction predict_surface(const optics::Scene& scene, optics::Surface surface,
                                                const optics::AppearanceModel& model, int white_resin,
                                                Progress& progress, const WhiteTwin& white = {});

}  // namespace voxtone::slicer
