// SPDX-License-Identifier: GPL-3.0-or-later
//
// Channels in a JSON file: "rgb", a list of rising wavelengths in nm, [450, 550, ...], or channels of a printer's own
// (optics/colour/channels.h) as an object with their weights to XYZ, a row a channel:
//
//   {"kind": "own", "illuminant": "D50", "xyz": [[0.5, 0.4, 0], ...]}
#pragma once

#include <string_view>

#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "optics/colour/channels.h"

namespace voxtone::io {

/// Throws InputError; at most 256 wavelengths from 1 to 1e5 nm, or 32 channels of their own.
[[nodiscard]] optics::Channels json_channels(const JsonObject& json, std::string_view key);
void write_channels(JsonWriter& json, const optics::Channels& channels);

/// The object of channels of a printer's own. Throws InputError.
[[nodiscard]] optics::Channels json_own_channels(const JsonObject& json);
void write_own_channels(JsonWriter& json, const optics::Channels& channels);

}  // namespace voxtone::io
