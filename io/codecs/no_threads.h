// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace voxtone::io {

/// OpenImageIO works in the calling thread alone from now on: every thread of a pool would take address space from the
/// budget of the program that reads.
void use_no_threads();

}  // namespace voxtone::io
