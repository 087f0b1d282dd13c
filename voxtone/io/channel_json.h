// SPDX-License-Identifier: GPL-3.0-or-later
//
// Channels as files of profiles and of data sets write them: "rgb", or a list of wavelengths in nm.
#pragma once

#include <string>

#include "voxtone/io/json_object.h"
#include "voxtone/optics/resins.h"

namespace voxtone::io {

/// The value of the key `channels`. Throws InputError; at most 256 wavelengths from 1 to 1e5 nm.
[[nodiscard]] optics::Channels channels_of(const JsonObject& json);
/// That value.
[[nodiscard]] std::string channels_json(const optics::Channels& channels);

}  // namespace voxtone::io
