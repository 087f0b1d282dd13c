// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace voxtone::io {

/// A file beside a model that the model names: a texture, a material library, a buffer.
struct SideFile {
    std::string name;    ///< relative to the model's folder; as the model has it where there is no such file
    std::string sha256;  ///< of the bytes that were read; empty: it was not there
};

}  // namespace voxtone::io
