// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many parts in one print (plate.h). Each part is a job of its own as far as its appearance loop, its prediction and
// its report go, in OUT/parts/NAME, where what it came to is kept: a tray that is stopped goes on with the part at
// which it was. Then its layers, as many copies as are wanted, are laid together into one stack in OUT, and in OUT-2
// and so on where there are several trays.
//
// Parts that lie within 2 mm of each other are looked at as one body (joined_parts.h), the others alone. Of shards each
// makes a part of the print's layers, of all parts that reach into them; what the loops of the parts came to must lie
// in OUT/parts (`--until loop`).
#pragma once

#include <memory>

#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/print/plate.h"

namespace voxtone::slicer {

/// `asked.model` is the tray's plan, or `models` are its parts. A part that fails is left out and told of, unless
/// `asked.fail_fast` or a shard is made: all shards must be of the same parts. Its calls throw InputError for parts
/// that do not fit, and with `fail_fast` all that the jobs of the parts throw; OUT holds then what it held before.
[[nodiscard]] std::unique_ptr<Plate> tray_plate(const SliceOptions& asked, const TrayModels& models);

/// Opened as shards ask for it, whose parts are all there or none.
[[nodiscard]] OpenedTray open_shard_of_tray(const SliceOptions& asked);

/// Parts that were looped before, ready to make layers.
void take_loops(PreparedTray& prepared, Progress& progress);

}  // namespace voxtone::slicer
