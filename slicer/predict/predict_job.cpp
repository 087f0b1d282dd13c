// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/predict_job.h"

#include <filesystem>
#include <vector>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "io/disk/output_files.h"
#include "io/layers/stack_folder.h"

namespace voxtone::slicer {

PredictedStack predict_from_above(const PredictOptions& options, PredictFigures& figures, Progress& progress) {
    ResolvedPrediction job = resolve_without_files(options);
    job.only_from_above = true;
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    return predict_stack(job, figures, progress);
}

PredictedStack predict_slab_or_body(const PredictOptions& options, PredictFigures& figures, Progress& progress) {
    const ResolvedPrediction job = resolve_without_files(options);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    return predict_stack(job, figures, progress);
}

PredictResult run_predict_job(const PredictOptions& options, Progress& progress) {
    const ResolvedPrediction job = resolve(options);
    const std::vector<std::filesystem::path> files(options.files.begin(), options.files.end());
    io::expect_apart_from_layers(options.stack, files);
    io::expect_outputs(files, options.overwrite);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    PredictFigures figures;
    const PredictedStack predicted = predict_stack(job, figures, progress);
    const Stopwatch watch;
    progress.begin_stage("write", 0);
    write_prediction(job, predicted, figures, progress);
    progress.end_stage();
    figures.write_s = watch.total();
    add_means(predicted.prediction, figures);
    return describe(job, predicted, figures);
}

}  // namespace voxtone::slicer
