// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scattering of one channel, luminance: what a grey camera measures, and what Hasan et al. 2010, Sec. 8.3, print of
// data in RGB. As channels of their own it is one whose weights are white: all that it shows is grey.
#pragma once

#include "io/profiles/bssrdf_file.h"
#include "io/profiles/profile_map.h"

namespace voxtone::scattering {

[[nodiscard]] optics::Channels luminance_channel();
[[nodiscard]] bool is_luminance(const optics::Channels& channels);

/// Luminance (CIE Y, 1 of a perfect diffuser) of data of several channels. `noise` is that of channels that are equally
/// bright.
[[nodiscard]] io::BssrdfFile luminance_of(const io::BssrdfFile& data);

/// A map of luminance asks the same of every channel; others ask what they say.
[[nodiscard]] io::ProfileMap asked_of(const optics::Channels& channels, io::ProfileMap map);
/// The same of data.
[[nodiscard]] io::BssrdfFile asked_of(const optics::Channels& channels, io::BssrdfFile data);

}  // namespace voxtone::scattering
