// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print whose surface shows how light spreads: laminates under each point (job_layers.h). It has no appearance
// loop and no prediction.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scattering/print/job_layers.h"
#include "scattering/print/layers_report.h"
#include "slicer/colour/print_parts.h"
#include "slicer/look/upright_cut.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/print.h"

namespace voxtone::scattering {

class LayeredPrint final : public slicer::Print {
public:
    /// Searches the laminates. Keeps references to all but the map.
    LayeredPrint(const slicer::OpenedJob& job, const LayeredOptions& options, const io::ProfileMap& map,
                 const slicer::JobBody& body, Progress& progress);

    void prepare(Progress& progress) override;
    void rearrange(Progress&) override {}
    [[nodiscard]] JobResult keep_loop() const override { return {}; }
    [[nodiscard]] std::unique_ptr<const slicer::LayerSource> layers() const override;
    void expect_layers(const slicer::LayerRange& range) override;
    void take_layer(int k, const io::LayerRuns& layer) override;
    /// Writes the closed surfaces of its layers, where they were asked for, and traces a whole slab for the report.
    void evaluate(const io::StackDescription& stack, Progress& progress) override;
    [[nodiscard]] std::vector<io::ReportStage> stages_before_layers() const override;
    [[nodiscard]] std::vector<io::ReportStage> stages_after_layers() const override;
    void add_to(io::Report& report) const override;
    void draw(io::Report& report, Progress& progress) const override;
    [[nodiscard]] std::string summary(const io::Report& report) const override;
    [[nodiscard]] std::string written_text() const override;

private:
    const slicer::OpenedJob& job_;
    const LayeredOptions& options_;
    const slicer::JobBody& body_;
    std::unique_ptr<const JobLayers> layers_;
    slicer::PrintParts parts_;
    std::optional<slicer::UprightCut> cut_;  ///< for the report
    std::vector<SurfaceFile> surfaces_;
    double surfaces_s_ = 0;
    std::optional<io::ReportSection> spread_;  ///< as it was traced
    double spread_s_ = 0;
};

}  // namespace voxtone::scattering
