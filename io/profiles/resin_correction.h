// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a resin set keeps of the measurement that it was fitted to, as keys of its JSON:
//
//   "dot_spread": s, "measured": {"geometry": "45/0" | "d/8", "surface": share, "gain": factor},
//   "residual": {"lengths": [...], "centres": [[shares], ...], "weights": [[X, Y, Z], ...]}
#pragma once

#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "optics/media/resins.h"

namespace voxtone::io {

/// Reads those keys that are there. `set` has its resins. Throws InputError.
void read_correction(const JsonObject& json, optics::ResinSet& set);
/// Writes those that say more than nothing.
void write_correction(JsonWriter& json, const optics::ResinSet& set);

}  // namespace voxtone::io
