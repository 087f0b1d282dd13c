// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lamps by a user's word: a name (optics/colour/lamp.h) or a table of the lamp's spectral power as spectrometers write
// it (io/files/csv_table.h): wavelength in nm, relative power; further columns do not count, a header may stand above.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "optics/colour/lamp.h"
#include "optics/media/resins.h"

namespace voxtone::io {

/// The word of what a screen shows, which is every resin set's own light.
inline constexpr std::string_view usual_lamp = "D65";

/// Throws InputError that names line and rule: two numbers a row, wavelengths that rise, power that is not negative,
/// from 400 to 700 nm at least. `source`: for messages.
[[nodiscard]] optics::LampPower parse_lamp(std::string_view text, const std::string& source);

/// By its name, or from a file. Throws FileError, InputError naming the lamps there are.
[[nodiscard]] optics::LampPower find_lamp(const std::string& name_or_file);

/// The set as it looks under a lamp, which its name says then; as it is under the usual one, or without a word. Throws
/// what `find_lamp` throws.
[[nodiscard]] optics::ResinSet seen_under(optics::ResinSet set, const std::string& lamp);

/// A warning, where that is a guess: the set's channels are no wavelengths.
[[nodiscard]] std::optional<std::string> lamp_doubt(const optics::ResinSet& set, const std::string& lamp);
/// The same of a set by its name or file, which is not looked at under the usual lamp.
[[nodiscard]] std::optional<std::string> lamp_doubt(const std::string& resins, const std::string& lamp);

}  // namespace voxtone::io
