// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print on its way through a job: all that depends on what its surface is to show, colours (colour_print.h) or
// something else (other_print.h). What is common to both: print/body_plate.h.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/layers/layer_runs.h"
#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "slicer/layers/layer_source.h"
#include "slicer/options/option_values.h"
#include "slicer/part/colour_recipes.h"

namespace voxtone::slicer {

/// The phases of a job, each called once and in this order. Complete when it is made: `layers` could print it at once.
class Print {
public:
    Print() = default;
    Print(const Print&) = delete;
    Print& operator=(const Print&) = delete;
    virtual ~Print() = default;

    /// The last that may refuse the job for what its options say: nothing in the output folder is touched yet.
    virtual void prepare(Progress& progress) = 0;
    /// What its colours are made with, once it is prepared; nothing where it shows none.
    [[nodiscard]] virtual std::optional<ColourRecipes> made_with() const { return std::nullopt; }
    /// Looks at the print and rearranges its resins, for hours if need be. The output folder is ready.
    virtual void rearrange(Progress& progress) = 0;
    /// Keeps what came of that for other jobs of this body, and says so: one JSON object, and a line for a person.
    [[nodiscard]] virtual JobResult keep_loop() const = 0;

    /// Its layers, as it is now.
    [[nodiscard]] virtual std::unique_ptr<const LayerSource> layers() const = 0;
    /// These layers will be made.
    virtual void expect_layers(const LayerRange& range) = 0;
    /// A layer as it is written; from any thread.
    virtual void take_layer(int k, const io::LayerRuns& layer) = 0;

    /// Once the stack is whole: predicts what it looks like, or writes what else was asked for.
    virtual void evaluate(const io::StackDescription& stack, Progress& progress) = 0;

    /// Where the time went, before layers were made and after.
    [[nodiscard]] virtual std::vector<io::ReportStage> stages_before_layers() const = 0;
    [[nodiscard]] virtual std::vector<io::ReportStage> stages_after_layers() const = 0;
    /// Figures, warnings and sections of its own; no pictures of the surface.
    virtual void add_to(io::Report& report) const = 0;
    /// Draws its surface, as asked for and as it will be, into the report; writes pictures or meshes beside it.
    virtual void draw(io::Report& report, Progress& progress) const = 0;
    /// Its surface as the viewer has it, in about so many bytes of a page; nothing where there is none to show.
    [[nodiscard]] virtual std::optional<io::ViewerSurface> viewer_surface(std::size_t /*bytes*/,
                                                                          Progress& /*progress*/) const {
        return std::nullopt;
    }
    /// Lets go of what it was seen to look like, once all that has been told.
    virtual void forget_looks() {}
    /// Lines for a person: how well it shows what was asked for, ...
    [[nodiscard]] virtual std::string summary(const io::Report& report) const = 0;
    /// ... and what was written besides the stack.
    [[nodiscard]] virtual std::string written_text() const = 0;
};

}  // namespace voxtone::slicer
