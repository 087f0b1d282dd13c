// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layers/layer_stack_writer.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/layers/layer_digest.h"
#include "voxtone/io/layers/orient.h"
#include "voxtone/io/layers/resin_sheet.h"
#include "voxtone/io/layers/stack_folder.h"
#include "voxtone/io/layers/volume_vdb.h"

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

StackFolder take(std::filesystem::path out, bool overwrite) {
    StackFolder folder(std::move(out));
    if (!overwrite) folder.expect_free();
    return folder;
}

}  // namespace

StackOutputs outputs_for(std::span<const LayerFormat> formats) {
    StackOutputs outputs;
    for (const LayerFormat format : formats) switch (format) {
            case LayerFormat::png:
                break;
            case LayerFormat::gcvf:
                outputs.gcvf = true;
                break;
            case LayerFormat::tiff:
                outputs.resin_bitmaps = ResinBitmaps::tiff1;
                break;
            case LayerFormat::png1:
                outputs.resin_bitmaps = ResinBitmaps::png1;
                break;
            case LayerFormat::vdb:
                outputs.vdb = true;
                break;
        }
    return outputs;
}

LayerStackWriter::LayerStackWriter(std::filesystem::path out, StackDescription description, StackOutputs outputs,
                                   bool overwrite)
    : LayerStackWriter(take(std::move(out), overwrite), std::move(description), outputs) {}

LayerStackWriter::LayerStackWriter(StackFolder folder, StackDescription description, StackOutputs outputs)
    : folder_(std::move(folder)),
      stack_(as_written(std::move(description))),
      outputs_(outputs),
      encoder_(stack_.palette(), {stack_.pitch_um[0], stack_.pitch_um[1]}),
      digests_(stack_.layers),
      written_(stack_.layers) {
    VOXTONE_EXPECT(stack_.pattern.starts_with("layers/slice_"));
    out_ = folder_.begin();
    if (outputs_.resin_bitmaps == ResinBitmaps::none) return;
    for (std::size_t r = 0; r < stack_.resins.size(); ++r) {
        std::error_code error;
        std::filesystem::create_directories(resin_folder(r), error);
        if (error)
            throw FileError(fmt::format("{}: cannot be created ({})", resin_folder(r).string(), error.message()));
    }
}

void LayerStackWriter::write(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(index < stack_.layers);
    {
        const std::lock_guard lock(mutex_);
        VOXTONE_EXPECT(!written_[index]);
    }
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
    write_staged_file(out_ / stack_.layer_path(index), png);
    if (outputs_.resin_bitmaps != ResinBitmaps::none) write_resin_bitmaps(index, layer);

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

void LayerStackWriter::write_resin_bitmaps(std::uint32_t index, const LayerRuns& layer) const {
    const std::array<double, 2> pitch = {stack_.pitch_um[0], stack_.pitch_um[1]};
    const auto name = std::filesystem::path(stack_.layer_path(index)).filename();
    if (outputs_.resin_bitmaps == ResinBitmaps::png8) {
        write_staged_file(resin_folder(0) / name, encode_png8(layer, encoder_.palette(), pitch));
        return;
    }
    for (std::size_t r = 0; r < stack_.resins.size(); ++r) {
        const auto material = static_cast<Material>(r + 1);
        if (outputs_.resin_bitmaps == ResinBitmaps::png1)
            write_staged_file(resin_folder(r) / name, encode_png1(layer, material, pitch));
        else
            write_staged_file((resin_folder(r) / name).replace_extension(".tif"), encode_tiff1(layer, material, pitch));
    }
}

std::filesystem::path LayerStackWriter::resin_folder(std::size_t resin) const {
    if (outputs_.resin_bitmaps == ResinBitmaps::png8) return out_ / resin_folder_name / "indexed";
    std::string role = stack_.resins[resin].role;
    for (char& c : role)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
    return out_ / resin_folder_name / fmt::format("{:02}-{}", resin + 1, role);
}

void LayerStackWriter::add_file(std::string_view name, std::string_view text) const {
    write_staged_file(out_ / name, text);
}

const StackDescription& LayerStackWriter::finish(const PreviewMesh& preview, Progress* progress) {
    const std::lock_guard lock(mutex_);
    VOXTONE_EXPECT(std::find(written_.begin(), written_.end(), false) == written_.end());
    for (std::size_t r = 0; r < stack_.resins.size(); ++r) {
        stack_.resins[r].voxels = voxels_[r + 1];
        stack_.resins[r].ml = millilitres(voxels_[r + 1], stack_.pitch_um);
    }
    stack_.content_sha256 = content_sha256(stack_.size_px[0], stack_.size_px[1], digests_);
    write_staged_file(out_ / sheet_text_name, resin_sheet_text(stack_));
    write_staged_file(out_ / sheet_page_name, resin_sheet_html(stack_));
    if (outputs_.gcvf) write_gcvf(out_ / gcvf_name, stack_, out_, preview, progress);
    if (outputs_.vdb) write_volume_vdb(out_ / vdb_name, stack_, out_, progress);
    write_staged_file(out_ / manifest_name, manifest_text(stack_));
    folder_.publish();
    return stack_;
}

std::uint64_t LayerStackWriter::bytes_written() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace voxtone::io
