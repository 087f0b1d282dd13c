// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace voxtone::io {

/// OpenImageIO works in the calling thread alone from now on: every thread of a pool would take address space from the
/// budget of the program that reads.
void use_no_threads();

/// Ends the threads that libraries started when they were loaded, as far as they can be asked to: OpenImageIO's pool,
/// and that of the log of the reader of DICOM pictures. Before walls are raised, which hold for one thread.
void end_threads();

}  // namespace voxtone::io
