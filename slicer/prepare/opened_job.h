// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job before its model is read: options, printer, resins. What is wrong with any of them is said
// here, before time is spent.
#pragma once

#include <memory>
#include <vector>

#include "io/layers/layer_stack_writer.h"
#include "slicer/options/resolved_job.h"
#include "slicer/prepare/job_body.h"
#include "slicer/prepare/job_colour.h"
#include "slicer/prepare/other_print.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

struct OpenedJob {
    ResolvedJob options;
    PrinterProfile printer;
    LoadedResins resins;
    std::shared_ptr<const OtherPrint> other;  ///< null: the surface shows colours
    std::string why_these_resins;             ///< where they were chosen for the model (resin_choice.h)

    /// Loads these instead. What was asked for stays as it was: the same job chooses the same again.
    void load(const std::vector<std::string>& roles);

    /// Background and resins, as the bitmaps colour them.
    [[nodiscard]] std::vector<io::Rgb> palette() const;
    /// What is written: the formats asked for, or the printer's.
    [[nodiscard]] io::StackOutputs outputs() const;
    /// The layers of this range as they will be written.
    [[nodiscard]] io::StackDescription describe(const VoxelGrid& grid, const LayerRange& range) const;
};

/// Changes nothing on disk. Throws UsageError, InputError,
/// FileError.
[[nodiscard]] OpenedJob open_job(const SliceOptions& asked);

}  // namespace voxtone::slicer
