// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints in a row before a camera, and, if wanted, their target at the right end.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "optics/camera/camera_scene.h"
#include "slicer/proof/proof_options.h"
#include "slicer/proof/proof_print.h"
#include "slicer/proof/sheet_behind.h"

namespace voxtone::slicer {

/// Does not move once made: its parts refer to each other.
struct ProofScene {
    std::vector<std::unique_ptr<const ProofPrint>> prints;
    std::vector<std::unique_ptr<const DiffuseMesh>> target;
    std::vector<std::unique_ptr<const SheetBehind>> sheets;  ///< by print, where something lies behind it
    std::vector<optics::Sky> skies;                          ///< by lamp
    optics::CameraScene camera;                              ///< under the first

    [[nodiscard]] const optics::Channels& channels() const { return prints.front()->stack.resins.channels; }
};

/// Throws FileError, InputError, ResourceError, Cancelled.
[[nodiscard]] std::unique_ptr<const ProofScene> make_proof_scene(const ResolvedProof& job, Progress& progress);

}  // namespace voxtone::slicer
