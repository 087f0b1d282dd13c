// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a person sees of a volume of resins: the question that every forward model answers.
//
// Appearance of a surface cell, per channel: flux that leaves through its part of the refractive surface / flux that
// entered there; the first reflection left out; exactly 1 for a body that absorbs nothing. Media-relative values divide
// by the appearance of the same body all of white resin at the same place.
//
// What is taken for granted. The surface is smooth and refracts by Fresnel's equations, unpolarised, with one index for
// all resins; there are no surfaces between resins. Light comes from all sides and is seen from all sides (flux / flux,
// bi-hemispherical). Colours of Vero slabs relative to white differ from those seen at 45:0 by CIEDE2000 0.78 (1.14 at
// most), and by 0.75 (1.26) where the index is 0.05 off (tests/optics/layered/assumptions_test.cpp); what roughness
// does is in no model here. More: docs/predict.md. A model may answer a little below 0 in the dark.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/scene.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// What a model says of a surface: value[cell * channels + channel].
struct Appearance {
    std::size_t channels = 0;
    std::vector<float> value;
    std::vector<float> standard_error;  ///< one sigma, same shape; empty where the model draws no random numbers
    std::vector<std::string> remarks;   ///< what a reader of these values should know: sentences without a full stop
};

/// Derivative of a function F of the appearance with respect to what voxels are filled with.
class ResinGradient {
public:
    virtual ~ResinGradient() = default;
    /// d F / d (fraction of a resin in a voxel), all fractions taken as free: a change that keeps their sum, resin a
    /// for resin b, is a difference of two. 0 outside the cells that light is followed through. May be asked from
    /// several threads.
    [[nodiscard]] virtual float at(const std::array<int, 3>& voxel, std::size_t resin) const = 0;
    /// The same of the first out.size() resins: cheaper than one by one.
    virtual void all_at(const std::array<int, 3>& voxel, std::span<float> out) const {
        for (std::size_t resin = 0; resin < out.size(); ++resin) out[resin] = at(voxel, resin);
    }
};

/// One model asked again and again about bodies of one shape, of which only the resins change: what an appearance loop
/// does.
class AppearanceSequence {
public:
    virtual ~AppearanceSequence() = default;

    /// Hands over, piece by piece, all that the next prediction and gradient take from those before: with it a sequence
    /// of the same scene goes on to the same bits. Nothing where each prediction is made anew. Bytes of this machine.
    using StateSink = std::function<void(std::span<const std::byte>)>;
    virtual void write_state(const StateSink& /*sink*/) const {}
    /// Before the first prediction. False, with the sequence of no use any more, where the bytes are not such a state.
    [[nodiscard]] virtual bool read_state(std::span<const std::byte> state) { return state.empty(); }
    /// `volume` has the size, pitch and air of the scene's that the sequence was made for, and lives until the next
    /// prediction.
    [[nodiscard]] virtual Appearance next(const ResinVolume& volume, const Progress* progress = nullptr) = 0;
    /// Of a volume that is nothing like those to come, as the white twin is: what the shape costs is kept, its light is
    /// no place to start from. Before the first prediction.
    [[nodiscard]] virtual Appearance twin(const ResinVolume& volume, const Progress* progress = nullptr) {
        return next(volume, progress);
    }
    /// The print that is kept in the end, after all others: as a prediction that stands alone shows it, where `next`
    /// has left something out that does not help to choose. Nothing may follow.
    [[nodiscard]] virtual Appearance last(const ResinVolume& volume, const Progress* progress = nullptr) {
        return next(volume, progress);
    }
    /// Takes the derivatives of the voxels in a box; they are good during the call.
    using GradientVisitor = std::function<void(const ResinGradient&, const VoxelBox&)>;
    /// At the last prediction, of a function F with these d F / d value (as Appearance::value): handed over box by box,
    /// which together hold every voxel once. False, and nothing visited, where the model has none. Throws
    /// ResourceError.
    [[nodiscard]] virtual bool gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                                        const Progress* progress = nullptr);
};

/// Of a body and of its twin: a volume of the same shape in other resins, as the white one that colours refer to.
struct TwinAppearances {
    Appearance body, twin;
};

class AppearanceModel {
public:
    virtual ~AppearanceModel() = default;
    /// Appearance of every cell of the surface in every channel of the scene's resins. Throws InputError for a material
    /// without a resin, ResourceError where it would need more memory than allowed, Cancelled.
    [[nodiscard]] virtual Appearance predict(const Scene& scene, const Surface& surface,
                                             const Progress* progress = nullptr) const = 0;
    /// Both, `twin` with the size, pitch and air of the scene's volume; what they share may be found once. Random
    /// numbers are others for each.
    [[nodiscard]] virtual TwinAppearances predict_with_twin(const Scene& scene, const Surface& surface,
                                                            const ResinVolume& twin,
                                                            const Progress* progress = nullptr) const;
    /// Predictions of volumes of the scene's shape, one after the other; what they share may be kept between them. The
    /// default predicts each anew. Scene, surface and model must outlive the sequence. Throws Cancelled.
    [[nodiscard]] virtual std::unique_ptr<AppearanceSequence> sequence(const Scene& scene, const Surface& surface,
                                                                       const Progress* progress = nullptr) const;
};

}  // namespace voxtone::optics
