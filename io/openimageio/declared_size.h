// SPDX-License-Identifier: GPL-3.0-or-later
//
// What some libraries take memory for before they tell how large it is.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// A GIF's canvas, the attributes of an OpenEXR header. Throws InputError where they are larger than the picture may
/// be, or than its file is.
void check_declared_size(std::span<const std::byte> bytes, const std::string& format, const std::string& name,
                         const DecodeOptions& options);

}  // namespace voxtone::io
