// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/programs/build_identity.h"

extern const char voxtone_build_digest[];  // a file that the build makes

namespace voxtone::io {

std::string program_version() { return VOXTONE_VERSION; }

std::string build_digest() { return voxtone_build_digest; }

std::string build_identity() { return program_version() + " build " + build_digest(); }

}  // namespace voxtone::io
