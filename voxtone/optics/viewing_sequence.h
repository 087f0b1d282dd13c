// SPDX-License-Identifier: GPL-3.0-or-later
//
// Predictions on cells of the eye, one after the other: grid, laws and the light of the last one are kept.
//
// The first prediction is a diffusion solve and `sweeps` rounds of sweep and correction (transport.h); each later one starts
// from the light of the one before and takes `next_sweeps`. What changes in between enters with the first sweep, through
// sources and extinctions. A block that gets colour deeper than `colour_mm` makes a new grid; the light is carried over.
//
// Where in a cell a resin lies is seen too: light falls off as exp(-kappa s) on its way in and out, kappa^2 = 3 sigma_a (sigma_a +
// (1 - g) sigma_s) of the cell's mean. So the layers of a cell across the way to the nearest surface are weighed by
// exp(-1.6 kappa s). It takes a quarter off the error of photographs (docs/benchmarks.md).
//
// Media are those of the halftone (halftone_medium.h) of each cell's voxels, seen from above where the surface looks up and
// from all sides else.
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
    /// Of the predictions so far; times of all, cells of the grid now.
    [[nodiscard]] const TransportSummary& summary() const { return summary_; }

private:
    [[nodiscard]] Medium seen_medium(const ViewingGrid::Mixture& mixture, const HalftoneMedium& halftone, const ResinSet& resins,
                                     std::size_t channel) const;
    void make_grid(const Scene& scene, std::span<const std::uint8_t> also);
    void carry_over(const ViewingGrid& from);

    Scene scene_;
    const Surface& surface_;
    TransportOptions options_;
    bool from_above_ = true;
    std::unique_ptr<ViewingGrid> grid_;
    std::unique_ptr<ViewingTransport> transport_;
    ViewingGrid::Seen seen_;
    std::vector<std::uint8_t> also_;
    std::vector<ViewingField> fields_;
    TransportSummary summary_;
};

}  // namespace voxtone::optics
