// SPDX-License-Identifier: GPL-3.0-or-later
//
// A surface that spreads light as data say, seen through a coloured skin: R(x_i, x_o) sqrt(t(x_i) t(x_o)), t the colour
// that a picture has there in linear sRGB. Its local profiles are t P(x, r) (local_profiles.h): white leaves them as
// they are, a grey darkens, a colour dyes, and how far light goes stays what it was.
#pragma once

#include "io/pictures/texture.h"
#include "io/profiles/bssrdf_file.h"

namespace voxtone::scattering {

/// The picture is stretched over the points. Data of one channel become red, green and blue. Throws InputError for
/// data of other channels.
[[nodiscard]] io::BssrdfFile tinted(io::BssrdfFile data, const io::Texture& picture);

}  // namespace voxtone::scattering
