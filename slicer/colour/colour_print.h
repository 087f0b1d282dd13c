// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print whose surface shows the model's colours: separation, screen, appearance loop, prediction.
#pragma once

#include <memory>
#include <optional>

#include "slicer/colour/colour_report.h"
#include "slicer/colour/job_loop.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/colour/night_prediction.h"
#include "slicer/colour/print_parts.h"
#include "slicer/layers/skin_source.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/job_plan.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/print.h"

namespace voxtone::slicer {

class ColourPrint final : public Print {
public:
    /// Separates the colours. Keeps references to all but progress.
    ColourPrint(const OpenedJob& job, const JobBody& body, const JobIdentity& identity, const JobPlan& plan,
                Progress& progress);

    /// Takes what an earlier job of this body found, or sets the appearance loop up, and reads the checkpoint to go on
    /// from where that was asked for. Throws InputError where the loop is for another job to run and has not run,
    /// ResourceError where it takes more memory than is allowed.
    void prepare(Progress& progress) override;
    [[nodiscard]] std::optional<ColourRecipes> made_with() const override;
    /// Runs the loop. Throws ResourceError where memory does not suffice.
    void rearrange(Progress& progress) override;
    [[nodiscard]] JobResult keep_loop() const override;
    [[nodiscard]] std::unique_ptr<const LayerSource> layers() const override;
    void expect_layers(const LayerRange& range) override;
    void take_layer(int k, const io::LayerRuns& layer) override;
    /// Predicts the print; where memory does not suffice, not, with a warning.
    void evaluate(const io::StackDescription& stack, Progress& progress) override;
    [[nodiscard]] std::vector<io::ReportStage> stages_before_layers() const override;
    [[nodiscard]] std::vector<io::ReportStage> stages_after_layers() const override;
    void add_to(io::Report& report) const override;
    void draw(io::Report& report, Progress& progress) const override;
    [[nodiscard]] std::optional<io::ViewerSurface> viewer_surface(std::size_t bytes, Progress& progress) const override;
    void forget_looks() override { prediction_.reset(); }
    [[nodiscard]] std::string summary(const io::Report& report) const override;
    [[nodiscard]] std::string written_text() const override { return {}; }

private:
    [[nodiscard]] ColourReport drawn() const;
    /// The loop as it is set up, and where it goes on.
    struct PreparedLoop {
        std::unique_ptr<const LoopProblem> problem;
        LoopCheckpoint checkpoint;
        std::optional<halftone::ResumedLoop> before;
    };

    [[nodiscard]] SkinFile skin_file() const;
    [[nodiscard]] bool may_loop() const;
    /// False where nothing is there that this job may take.
    bool take_saved_loop(Progress& progress);
    void print_loop();
    /// Its white is what the job's model would see of it too.
    [[nodiscard]] bool sees_as_the_loop() const;
    /// Of cells that came from a file.
    void find_faces(JobPrediction& prediction, const Progress& progress) const;
    [[nodiscard]] JobPrediction predict(optics::ResinVolume volume, Progress& progress) const;

    const OpenedJob& job_;
    const JobBody& body_;
    const JobIdentity& identity_;
    double separation_s_ = 0, loop_s_ = 0;
    std::unique_ptr<const JobColour> colour_;
    PrintParts parts_;
    const JobPlan& plan_;
    std::optional<NightPrediction> night_;  ///< where the slab has one, and is predicted
    std::string alpha_warning_;             ///< empty: there is none
    std::string why_no_loop_;               ///< a sentence, or empty where none is due
    std::optional<PreparedLoop> prepared_;  ///< until it has run
    std::optional<JobLoop> loop_;           ///< nothing: the open loop is printed
    bool foreign_skin_ = false;             ///< of another job, to be removed once the stack is whole
    std::optional<SkinSource> skin_;        ///< nothing: the open loop was best
    PredictionPlan prediction_plan_;
    std::optional<JobVolume> volume_;  ///< while layers are made that will be predicted
    std::optional<JobPrediction> prediction_;
};

}  // namespace voxtone::slicer
