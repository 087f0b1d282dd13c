// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the page of a fit of edges draws (edge_report.h): profiles, gradients, neighbours in the dictionary, slabs as
// the camera saw them, maps of the distance. Everything is added to a section.
#pragma once

#include <array>
#include <vector>

#include "calibration/edge/edge_fit.h"
#include "calibration/edge/edge_similarity.h"
#include "io/report/report.h"

namespace voxtone::calibration {

/// Marks from 0 for an axis.
[[nodiscard]] std::vector<double> plot_marks(double most);

/// Of one resin.
class EdgePlots {
public:
    EdgePlots(const EdgeFit& fit, const EdgeResinFit& resin, const std::vector<EdgeProfile>& profiles,
              const EdgeProfileTable& table, const EdgeFitOptions& options);

    /// Measured and fitted, all slabs of a channel in one plot (the paper's Fig. 7); their gradients; the fit between
    /// the records of the paper's grid that lie next to it (Figs. 3, 5 and 7), its caption with their distances.
    void add_profiles(io::ReportSection& section) const;
    /// Slabs in colour, measured above simulated (Fig. 2).
    void add_strips(io::ReportSection& section) const;

private:
    struct Channel {
        std::vector<EdgeObservation> seen;
        std::vector<double> thickness_mm;  ///< of `seen`
    };
    [[nodiscard]] EdgeObjective objective(std::size_t channel) const;
    [[nodiscard]] io::ReportDrawing profiles(std::size_t channel) const;
    [[nodiscard]] io::ReportDrawing gradients(std::size_t channel) const;
    [[nodiscard]] io::ReportDrawing neighbours(std::size_t channel) const;

    const EdgeFit& fit_;
    const EdgeResinFit& resin_;
    const EdgeProfileTable& table_;
    const EdgeFitOptions& options_;
    std::array<Channel, 3> channels_;
};

/// Extinctions of the best fits at every g beside those that similarity predicts, and how far each g is away; nothing
/// where only one g was tried.
void add_similarity_curves(const EdgeResinFit& resin, io::ReportSection& section);

/// Distance over (1 - albedo, extinction) for each g: minimum as a cross (red where the resin was fitted), similar
/// medium as a ring, the way of similar media over all g as a dashed line (Fig. 9).
void add_similarity_maps(const EdgeSimilarity& similarity, const EdgeFit& fit, std::size_t resin,
                         io::ReportSection& section);

}  // namespace voxtone::calibration
