// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes one job's layer stack into a folder: layers/slice_00000.png ..., the assignment sheet, on request one bitmap
// per resin and layer, a GCVF container and a sparse volume, and manifest.json. Everything appears there at once, when
// it is whole; until then an old stack stays (see stack_folder.h). Nothing is written outside the folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "io/layers/gcvf_writer.h"
#include "io/layers/layer_format.h"
#include "io/layers/layer_runs.h"
#include "io/layers/manifest.h"
#include "io/layers/png_layer_encoder.h"
#include "io/layers/resin_bitmap.h"
#include "io/layers/stack_folder.h"
#include "io/layers/topmost_layers.h"

namespace voxtone::io {

struct StackOutputs {
    /// For RIPs that want one bitmap per resin and layer (png1, tiff1: resins/NN-ROLE/) or indexed ones (png8:
    /// resins/indexed/).
    ResinBitmaps resin_bitmaps = ResinBitmaps::none;
    bool gcvf = false;            ///< OUT/stack.gcvf
    bool vdb = false;             ///< OUT/volume.vdb, OUT/volume-int32.vdb
    bool png = false;             ///< for the printer's folder: the bitmaps, beside another format that a printer takes
    bool printer_folder = false;  ///< OUT/printer (printer_folder.h)
};
/// What these formats ask for. Throws InputError where they are tiff and png1: each is the other's negative.
[[nodiscard]] StackOutputs outputs_for(std::span<const LayerFormat> formats);

/// What a stack says of layers, once they are written.
struct WrittenLayers {
    std::vector<std::uint64_t> digests;                  ///< layer_digest of each
    std::vector<std::vector<std::uint64_t>> file_bytes;  ///< of the files of each, as `layer_file_names` names them
    std::array<std::uint64_t, max_materials> voxels{};   ///< of each material, in all of them
};

/// Files of layer `index` under the stack's folder: its bitmap, then those of resins.
[[nodiscard]] std::vector<std::filesystem::path> layer_file_names(const StackDescription& stack, ResinBitmaps resins,
                                                                  std::uint32_t index);

/// What the printer's computer takes, under the stack's folder: the GCVF, bitmaps of resins, and the layers where they
/// were named, or nothing else is there.
[[nodiscard]] std::vector<std::filesystem::path> printer_files(const StackDescription& stack,
                                                               const StackOutputs& outputs);

/// The stack as sliced, turned into the stack as written. Throws InputError where it cannot be written.
[[nodiscard]] StackDescription as_written(StackDescription stack);
/// With what its layers hold: voxel counts, millilitres, digest, and what its bitmaps of resins mean. `stack` is as
/// written.
[[nodiscard]] StackDescription with_contents(StackDescription stack, const WrittenLayers& layers, ResinBitmaps resins);
/// The manifest and the sheets of resins of a stack whose layers are written. Throws FileError.
void write_stack_texts(const std::filesystem::path& folder, const StackDescription& stack);

/// The bitmaps of layers in a folder that is there, and what a stack will say of them.
class LayerFiles {
public:
    /// `stack`: as written. Makes the folders in it. Throws FileError.
    /// `topmost_from`: what is on top is kept, and the first layer is counted as this one; nothing: it is not.
    LayerFiles(std::filesystem::path folder, const StackDescription& stack, ResinBitmaps resins,
               std::optional<std::uint32_t> topmost_from = std::nullopt);

    /// Layer `index` from the bottom, 0 .. layers - 1, as sliced. Any order, any thread, each layer once; the work is
    /// done on the caller's thread. Throws FileError, TryAgain.
    void write(std::uint32_t index, const LayerRuns& layer);
    /// All layers must have been written.
    [[nodiscard]] WrittenLayers written() const;
    /// Nothing where it was not asked for.
    [[nodiscard]] const TopmostLayers* topmost() const { return topmost_ ? &*topmost_ : nullptr; }
    /// Bytes of the layer bitmaps written so far, without those of resins.
    [[nodiscard]] std::uint64_t bytes_written() const;

private:
    void write_oriented(std::uint32_t index, const LayerRuns& layer);
    [[nodiscard]] std::vector<std::uint8_t> resin_bitmap(const LayerRuns& layer, std::size_t resin) const;

    std::filesystem::path folder_;
    StackDescription stack_;
    ResinBitmaps resins_;
    PngLayerEncoder encoder_;
    std::optional<TopmostLayers> topmost_;
    std::uint32_t topmost_from_ = 0;
    mutable std::mutex mutex_;  // for all below
    WrittenLayers layers_;
};

/// The page of a printer's folder, of the stack as its manifest describes it.
using PageOfStack = std::function<std::string(const StackDescription& stack, const TopmostLayers& topmost)>;

class LayerStackWriter {
public:
    /// `description` is that of the stack as it is sliced: size_px, pitch_um, layers, ... before `orientation`, which
    /// the writer applies. Voxel counts, millilitres, size_mm and the digest are filled in by `finish`. Throws what
    /// `StackFolder::begin` throws, and what `expect_gcvf` does.
    LayerStackWriter(StackFolder folder, StackDescription description, StackOutputs outputs = {});
    /// Into a folder that is taken here and holds nothing, or anything where `overwrite`.
    LayerStackWriter(std::filesystem::path out, StackDescription description, StackOutputs outputs = {},
                     bool overwrite = false);

    /// As StackFolder has it.
    [[nodiscard]] std::string strangers_note() const { return folder_.strangers_note(); }

    /// Layer `index` from the bottom, 0 .. layers - 1, as sliced. Any order, any thread, each layer once; the work is
    /// done on the caller's thread. Throws FileError.
    void write(std::uint32_t index, const LayerRuns& layer);

    /// The bodies that it is of, for its manifest.
    void set_members(std::vector<StackMember> members) { stack_.members = std::move(members); }

    /// A file that appears in OUT with the stack. Throws FileError.
    void add_file(std::string_view name, std::string_view text) const;

    /// Writes the rest and the manifest and puts all in place; all layers must have been written. `how_to_print`: the
    /// page of the printer's folder, asked for where there is to be one. The description as it is in the manifest.
    [[nodiscard]] const StackDescription& finish(const PreviewMesh& preview = {}, Progress* progress = nullptr,
                                                 const PageOfStack& how_to_print = {});

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
    /// Bytes of the layer bitmaps written so far.
    [[nodiscard]] std::uint64_t bytes_written() const;

private:
    StackFolder folder_;
    StackDescription stack_;     // of the bitmaps as they are written
    std::filesystem::path out_;  // where the stack is made
    StackOutputs outputs_;
    LayerFiles files_;
};

}  // namespace voxtone::io
