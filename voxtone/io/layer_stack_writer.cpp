// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layer_stack_writer.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/io/orient.h"
#include "voxtone/io/resin_sheet.h"
#include "voxtone/io/sha256.h"
#include "voxtone/io/stack_folder.h"
#include "voxtone/io/whole_file.h"

namespace voxtone::io {
namespace {

/// The stack as sliced, turned into the stack as written.
StackDescription as_written(StackDescription stack) {
    if (stack.orientation.swap_xy) {
        std::swap(stack.size_px[0], stack.size_px[1]);
        std::swap(stack.pitch_um[0], stack.pitch_um[1]);
    }
    stack.size_mm = stack_size_mm(stack);
    stack.content_sha256.assign(64, '0');  // known at the end
    stack.validate("layer stack");
    return stack;
}

}  // namespace

LayerStackWriter::LayerStackWriter(std::filesystem::path out, StackDescription description, StackOutputs outputs,
                                   bool overwrite)
    : out_(std::move(out)),
      stack_(as_written(std::move(description))),
      outputs_(outputs),
      encoder_(stack_.palette(), {stack_.pitch_um[0], stack_.pitch_um[1]}),
      digests_(stack_.layers),
      written_(stack_.layers) {
    VOXTONE_EXPECT(stack_.pattern.starts_with("layers/slice_"));
    prepare_stack_folder(out_, overwrite);
}

void LayerStackWriter::write(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(index < stack_.layers);
    const Orientation& orientation = stack_.orientation;
    if (orientation != Orientation{}) {
        write_oriented(index, oriented(layer, orientation));
    } else {
        write_oriented(index, layer);
    }
}

void LayerStackWriter::write_oriented(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(layer.width_px() == stack_.size_px[0] && layer.height_px() == stack_.size_px[1]);
    const auto png = encoder_.encode(layer);
    write_whole_file(out_ / stack_.layer_path(index), png);

    std::array<std::uint64_t, max_materials> voxels{};
    for (std::uint32_t y = 0; y < layer.rows(); ++y)
        for (const Run run : layer.row(y)) voxels[run.material] += run.length;
    const std::uint64_t digest = layer_digest(layer);

    const std::lock_guard lock(mutex_);
    VOXTONE_EXPECT(!written_[index]);
    written_[index] = true;
    digests_[index] = digest;
    for (std::size_t m = 0; m < voxels.size(); ++m) voxels_[m] += voxels[m];
    bytes_ += png.size();
}

const StackDescription& LayerStackWriter::finish(const PreviewMesh&, Progress*) {
    const std::lock_guard lock(mutex_);
    VOXTONE_EXPECT(std::find(written_.begin(), written_.end(), false) == written_.end());
    for (std::size_t r = 0; r < stack_.resins.size(); ++r) {
        stack_.resins[r].voxels = voxels_[r + 1];
        stack_.resins[r].ml = millilitres(voxels_[r + 1], stack_.pitch_um);
    }
    stack_.content_sha256 = content_sha256(stack_.size_px[0], stack_.size_px[1], digests_);
    write_whole_file(out_ / sheet_text_name, resin_sheet_text(stack_));
    write_whole_file(out_ / sheet_page_name, resin_sheet_html(stack_));
    write_whole_file(out_ / manifest_name, manifest_text(stack_));
    std::error_code ignored;
    std::filesystem::remove(out_ / unfinished_name, ignored);
    return stack_;
}

std::uint64_t LayerStackWriter::bytes_written() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace voxtone::io
