// SPDX-License-Identifier: GPL-3.0-or-later
//
// One prediction from a layer stack to pictures or meshes of what a person will see.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/slicer/options/model_choice.h"

namespace voxtone::slicer {

/// Texts stay as the user wrote them until `validate` or the job reads them.
struct PredictOptions {
    std::string stack;
    std::vector<std::string> files;  ///< .png, .exr: a slab from above; .png, .glb, .ply: a body
    std::string model = model_names()[0];
    double cell_mm = 0.085;  ///< of the viewing grid; in [0.01, 5]
    ModelOptions quality;
    std::string backing =
        "auto";  ///< black, white, none; auto: what the job said; else black under slabs, none under bodies
    std::string view = "auto";        ///< top, body; auto: top for pictures and flat boxes
    bool absolute = false;            ///< instead of relative to the white resin
    std::string resins;               ///< set or file; empty: that of the job, else vero-opaque
    std::string printer, pitch;       ///< of foreign stacks
    std::vector<std::string> assign;  ///< "#rrggbb=ROLE", of foreign stacks
    double memory_gib = 0;            ///< 0: half of the machine's
    int threads = 0;                  ///< 0: one per core
};

/// Throws UsageError naming option, value and rule.
void validate(const PredictOptions& options);

struct PredictResult {
    std::string json;  ///< one JSON object, "format": "voxtone-prediction"
    std::string text;  ///< a few lines for a person
};

/// Throws Error (with its exit code); then none of the files was written, or those that were are whole.
PredictResult run_predict_job(const PredictOptions& options, Progress& progress);

}  // namespace voxtone::slicer
