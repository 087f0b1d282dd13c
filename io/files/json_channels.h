// SPDX-License-Identifier: GPL-3.0-or-later
//
// Channels in a JSON file: "rgb" or a list of rising wavelengths in nm, [450, 550, ...].
#pragma once

#include <string_view>

#include "voxtone/io/files/json_object.h"
#include "voxtone/io/files/json_writer.h"
#include "voxtone/optics/media/resins.h"

namespace voxtone::io {

/// Throws InputError; at most 256 wavelengths from 1 to 1e5 nm.
[[nodiscard]] optics::Channels json_channels(const JsonObject& json, std::string_view key);
void write_channels(JsonWriter& json, const optics::Channels& channels);

}  // namespace voxtone::io
