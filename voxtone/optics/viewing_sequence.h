// SPDX-License-Identifier: GPL-3.0-or-later
//
// Predictions on cells of the eye, one after the other: grid, laws and the light of the last one are kept.
//
// The first prediction is a diffusion solve and `sweeps` rounds of sweep and correction (transport.h); each later one starts
// from the light of the one before and takes `next_sweeps`. What changes in between enters with the first sweep, through
// sources and extinctions. A block that gets colour deeper than `colour_mm` makes a new grid; the light is carried over.
//
// Media are those of the halftone (halftone_medium.h) of each cell's voxels, seen from above where the surface looks up and
// from all sides else; where in a cell a resin lies is seen too (seen_medium.h).
#pragma once

#include <memory>
#include <vector>

#include "voxtone/optics/halftone_medium.h"
#include "voxtone/optics/transport.h"
#include "voxtone/optics/viewing_transport.h"

namespace voxtone::optics {

class ViewingSequence final : public AppearanceSequence {
public:
    /// Throws ResourceError where it would need more memory than `options` allow.
    ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options);
    [[nodiscard]] Appearance next(const ResinVolume& volume, const Progress* progress = nullptr) override;
    /// Of viewing_gradient.h. The adjoint light of each channel is kept for the next one: `sweeps` the first time, then `next_sweeps`.
    /// Null where it needs more memory than `options` allow. Contract: there was a prediction.
    [[nodiscard]] std::unique_ptr<const ResinGradient> gradient(std::span<const float> by_value, const Progress* progress = nullptr) override;
    /// Of the predictions so far; times of all, cells of the grid now.
    [[nodiscard]] const TransportSummary& summary() const { return summary_; }

private:
    [[nodiscard]] ViewingTransport::Media media(std::size_t channel) const;
    void make_grid(const Scene& scene, std::span<const std::uint8_t> also);
    void carry_over(const ViewingGrid& from);

    Scene scene_;
    const Surface& surface_;
    TransportOptions options_;
    HalftoneMedium halftone_;
    std::unique_ptr<ViewingGrid> grid_;
    std::unique_ptr<ViewingTransport> transport_;
    ViewingGrid::Seen seen_;
    std::vector<std::uint8_t> also_;
    std::vector<ViewingField> fields_, adjoint_;  ///< per channel
    TransportSummary summary_;
};

}  // namespace voxtone::optics
