// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/surface_prediction.h"

#include <cmath>

#include "base/contracts.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/mixture_correction.h"

namespace voxtone::slicer {

namespace {

std::vector<Eigen::Vector3f> colours_of(const SurfacePrediction& prediction, const optics::Channels& channels,
                                        const std::vector<float>* white) {
    const optics::ObservedColour<float> observed(channels);
    VOXTONE_ENSURE(observed.channels() == prediction.channels);
    std::vector<Eigen::Vector3f> rgb(prediction.surface.cells.size());
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const std::size_t at = i * prediction.channels;
        const float* value = prediction.value.data() + at;
        rgb[i] = white ? observed.relative(value, white->data() + at) : observed.absolute(value);
    }
    return rgb;
}

/// Divides by the white of the same place. A place without any light (nothing white can do about it) is 0.
void make_relative(SurfacePrediction& prediction, const optics::Appearance& white) {
    VOXTONE_ENSURE(white.value.size() == prediction.value.size());
    for (std::size_t i = 0; i < white.value.size(); ++i) {
        const float w = white.value[i];
        const float relative = w > 0 ? prediction.value[i] / w : 0;
        if (!prediction.standard_error.empty())
            prediction.standard_error[i] =
                w > 0 ? std::hypot(prediction.standard_error[i], relative * white.standard_error[i]) / w : 0;
        prediction.value[i] = relative;
    }
}

}  // namespace

SurfacePrediction predict_surface(const optics::Scene& scene, optics::Surface surface,
                                  const optics::AppearanceModel& model, int white_resin, Progress& progress,
                                  const WhiteTwin& white) {
    SurfacePrediction prediction;
    prediction.surface = std::move(surface);
    optics::TwinAppearances seen;
    if (white_resin < 0 || white.seen) {
        seen.body = model.predict(scene, prediction.surface, &progress);
        if (white.seen) seen.twin.value = *white.seen;
    } else {
        optics::ResinVolume all_white;
        if (!white.print) all_white = optics::all_of(*scene.volume, static_cast<optics::Material>(white_resin + 1));
        seen = model.predict_with_twin(scene, prediction.surface, white.print ? *white.print : all_white, &progress);
    }
    VOXTONE_EXPECT(!white.seen || seen.body.standard_error.empty());
    prediction.channels = seen.body.channels;
    prediction.value = std::move(seen.body.value);
    prediction.standard_error = std::move(seen.body.standard_error);
    prediction.remarks = std::move(seen.body.remarks);
    VOXTONE_ENSURE(prediction.value.size() == prediction.surface.cells.size() * prediction.channels);
    prediction.rgb = colours_of(prediction, scene.resins->channels, white_resin >= 0 ? &seen.twin.value : nullptr);
    if (white_resin >= 0) {
        make_relative(prediction, seen.twin);
        for (const std::string& remark : seen.twin.remarks)
            prediction.remarks.push_back("of the white that colours refer to: " + remark);
    }
    const optics::MixtureCorrection correction(*scene.resins, white_resin);
    if (correction.any())
        optics::correct_colours(correction.of_surface(*scene.volume, prediction.surface, &progress), prediction.rgb);
    for (const std::string& remark : prediction.remarks) progress.warn(remark);
    return prediction;
}

}  // namespace voxtone::slicer
