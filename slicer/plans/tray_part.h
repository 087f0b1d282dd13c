// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tray is made of, as its plan says it (tray_plan.h).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "slicer/options/label_template.h"
#include "slicer/options/slice_options.h"
#include "slicer/plans/part_job.h"
#include "slicer/plans/tray_component.h"

namespace voxtone::slicer {

struct TrayPart {
    std::string name;           ///< no other part of the plan has it; a folder below OUT/parts is called so
    bool has_own_name = false;  ///< the plan gives it
    SliceOptions options;       ///< of the job that it would be alone; of a component without a model
    std::optional<TrayComponent> component;    ///< nothing: a model
    std::optional<PartJob> job;                ///< whose options they are
    int copies = 1;                            ///< >= 1
    std::vector<std::array<double, 3>> at_mm;  ///< lowest corner of each copy's box on the tray; empty: to be arranged
    bool turn = false;      ///< it may be turned by right angles about the vertical where it is arranged
    int priority = 0;       ///< where parts fill the same voxel the higher has it, of equal ones the later in the plan
    bool cuts = false;      ///< leaves air where it would be
    bool first = false;     ///< of several trays it must be on the first
    TemplateValues values;  ///< for labels, by the name that stands in braces
    std::string place;      ///< in the plan, for messages: "tray.json: parts[2]"
};

struct TrayPlan {
    std::string file;
    SliceOptions common;  ///< what all parts begin with, and what is the whole tray's
    std::vector<TrayPart> parts;
    std::vector<std::string> notes;  ///< sentences for the user
    bool loops_elsewhere = false;    ///< of its parts: what they came to must be there
};

}  // namespace voxtone::slicer
