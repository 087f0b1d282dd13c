// SPDX-License-Identifier: GPL-3.0-or-later
//
// One body, from a model or a picture, as a print of its own: the plate of one part (plate.h). Of its shards the first
// reads, repairs and separates, and keeps that for the others (prepared_body.h); shards that begin before it has done
// so do it too. The appearance loop is never repeated (part/skin_file.h).
#pragma once

#include <memory>

#include "slicer/options/slice_options.h"
#include "slicer/print/plate.h"

namespace voxtone::slicer {

/// Opens the job. A shard of it where `requested` says so.
[[nodiscard]] std::unique_ptr<Plate> body_plate(const SliceOptions& requested, Progress& progress);

}  // namespace voxtone::slicer
