// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_stack_writer.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/layer_digest.h"
#include "io/layers/orient.h"
#include "io/layers/resin_sheet.h"
#include "io/layers/stack_folder.h"
#include "io/layers/volume_vdb.h"
#include "io/printer/printer_folder.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

StackFolder take(std::filesystem::path out, bool overwrite) {
    StackFolder folder(std::move(out));
    if (!overwrite) folder.expect_free();
    return folder;
}

/// Where the bitmaps of a resin lie, under the stack's folder.
fs::path resin_folder(const StackDescription& stack, ResinBitmaps resins, std::size_t resin) {
    if (resins == ResinBitmaps::png8) return fs::path(resin_folder_name) / "indexed";
    std::string role = stack.resins[resin].role;
    for (char& c : role)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
    return fs::path(resin_folder_name) / fmt::format("{:02}-{}", resin + 1, role);
}

StackDescription fit_for(StackDescription stack, const StackOutputs& outputs) {
    if (outputs.gcvf) expect_gcvf(stack);
    return stack;
}

std::optional<std::uint32_t> topmost_from(const StackOutputs& outputs) {
    return outputs.gcvf || outputs.printer_folder ? std::optional<std::uint32_t>(0) : std::nullopt;
}

/// How many bitmaps a layer has besides its own.
std::size_t resin_bitmaps_of(const StackDescription& stack, ResinBitmaps resins) {
    if (resins == ResinBitmaps::none) return 0;
    return resins == ResinBitmaps::png8 ? 1 : stack.resins.size();
}

}  // namespace

StackDescription as_written(StackDescription stack) {
    if (stack.orientation.swap_xy) {
        std::swap(stack.size_px[0], stack.size_px[1]);
        std::swap(stack.pitch_um[0], stack.pitch_um[1]);
        std::swap(stack.spread_mm[0], stack.spread_mm[1]);
    }
    stack.size_mm = stack_size_mm(stack);
    stack.content_sha256.assign(64, '0');  // known at the end
    stack.validate("layer stack");
    return stack;
}

std::vector<fs::path> layer_file_names(const StackDescription& stack, ResinBitmaps resins, std::uint32_t index) {
    std::vector<fs::path> names{stack.layer_path(index)};
    for (std::size_t r = 0; r < resin_bitmaps_of(stack, resins); ++r) {
        names.push_back(resin_folder(stack, resins, r) / names[0].filename());
        if (resins == ResinBitmaps::tiff1) names.back().replace_extension(".tif");
    }
    return names;
}

std::vector<fs::path> printer_files(const StackDescription& stack, const StackOutputs& outputs) {
    const bool with_resins = outputs.resin_bitmaps != ResinBitmaps::none;
    const bool with_layers = outputs.png || !(outputs.gcvf || with_resins);
    std::vector<fs::path> files;
    if (outputs.gcvf) files.emplace_back(gcvf_name);
    for (std::uint32_t k = 0; k < stack.layers && (with_layers || with_resins); ++k) {
        std::vector<fs::path> names = layer_file_names(stack, outputs.resin_bitmaps, k);
        files.insert(files.end(), names.begin() + (with_layers ? 0 : 1), names.end());
    }
    return files;
}

StackDescription with_contents(StackDescription stack, const WrittenLayers& layers, ResinBitmaps resins) {
    if (resins == ResinBitmaps::png1) stack.resin_pixels = ResinPixels::white;
    if (resins == ResinBitmaps::tiff1) stack.resin_pixels = ResinPixels::black;
    for (std::size_t r = 0; r < stack.resins.size(); ++r) {
        stack.resins[r].voxels = layers.voxels[r + 1];
        stack.resins[r].ml = millilitres(layers.voxels[r + 1], stack.pitch_um);
    }
    stack.content_sha256 = content_sha256(stack.size_px[0], stack.size_px[1], layers.digests);
    return stack;
}

void write_stack_texts(const fs::path& folder, const StackDescription& stack) {
    write_staged_file(folder / sheet_text_name, resin_sheet_text(stack));
    write_staged_file(folder / sheet_page_name, resin_sheet_html(stack));
    write_staged_file(folder / manifest_name, manifest_text(stack));
}

LayerFiles::LayerFiles(fs::path folder, const StackDescription& stack, ResinBitmaps resins,
                       std::optional<std::uint32_t> topmost_from)
    : folder_(std::move(folder)),
      stack_(stack),
      resins_(resins),
      encoder_(stack_.palette(), {stack_.pitch_um[0], stack_.pitch_um[1]}) {
    VOXTONE_EXPECT(stack_.pattern.starts_with("layers/slice_"));
    if (topmost_from) {
        topmost_.emplace(stack_.size_px[0], stack_.size_px[1]);
        topmost_from_ = *topmost_from;
    }
    layers_.digests.resize(stack_.layers);
    layers_.file_bytes.resize(stack_.layers);
    for (const fs::path& name : layer_file_names(stack_, resins_, 0)) {
        const fs::path into = (folder_ / name).parent_path();
        std::error_code error;
        fs::create_directories(into, error);
        if (error) throw FileError(fmt::format("{}: cannot be created ({})", into.string(), error.message()));
    }
}

void LayerFiles::write(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(index < stack_.layers);
    {
        const std::lock_guard lock(mutex_);
        VOXTONE_EXPECT(layers_.file_bytes[index].empty());
    }
    const Orientation& orientation = stack_.orientation;
    if (orientation != Orientation{}) {
        write_oriented(index, oriented(layer, orientation));
    } else {
        write_oriented(index, layer);
    }
}

void LayerFiles::write_oriented(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(layer.width_px() == stack_.size_px[0] && layer.height_px() == stack_.size_px[1]);
    const std::vector<fs::path> names = layer_file_names(stack_, resins_, index);
    std::vector<std::uint64_t> file_bytes;
    for (std::size_t f = 0; f < names.size(); ++f) {
        const auto bytes = f == 0 ? encoder_.encode(layer) : resin_bitmap(layer, f - 1);
        write_staged_file(folder_ / names[f], bytes);
        file_bytes.push_back(bytes.size());
    }
    std::array<std::uint64_t, max_materials> voxels{};
    for (std::uint32_t y = 0; y < layer.rows(); ++y)
        for (const Run run : layer.row(y)) voxels[run.material] += run.length;
    const std::uint64_t digest = layer_digest(layer);
    if (topmost_) topmost_->add(topmost_from_ + index, layer);

    const std::lock_guard lock(mutex_);
    VOXTONE_EXPECT(layers_.file_bytes[index].empty());
    layers_.file_bytes[index] = std::move(file_bytes);
    layers_.digests[index] = digest;
    for (std::size_t m = 0; m < voxels.size(); ++m) layers_.voxels[m] += voxels[m];
}

std::vector<std::uint8_t> LayerFiles::resin_bitmap(const LayerRuns& layer, std::size_t resin) const {
    const std::array<double, 2> pitch = {stack_.pitch_um[0], stack_.pitch_um[1]};
    if (resins_ == ResinBitmaps::png8) return encode_png8(layer, encoder_.palette(), pitch);
    const auto material = static_cast<Material>(resin + 1);
    return resins_ == ResinBitmaps::png1 ? encode_png1(layer, material, pitch) : encode_tiff1(layer, material, pitch);
}

WrittenLayers LayerFiles::written() const {
    const std::lock_guard lock(mutex_);
    for (const auto& files : layers_.file_bytes) VOXTONE_EXPECT(!files.empty());
    return layers_;
}

std::uint64_t LayerFiles::bytes_written() const {
    const std::lock_guard lock(mutex_);
    std::uint64_t bytes = 0;
    for (const auto& files : layers_.file_bytes)
        if (!files.empty()) bytes += files.front();
    return bytes;
}

StackOutputs outputs_for(std::span<const LayerFormat> formats) {
    if (std::ranges::count(formats, LayerFormat::tiff) > 0 && std::ranges::count(formats, LayerFormat::png1) > 0)
        throw InputError(
            "the formats tiff and png1 do not go together: they lie in the same folders, and one is the "
            "other's negative; name one of them");
    StackOutputs outputs;
    for (const LayerFormat format : formats) switch (format) {
            case LayerFormat::png:
                outputs.png = true;
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
      stack_(fit_for(as_written(std::move(description)), outputs)),
      out_(folder_.begin()),
      outputs_(outputs),
      files_(out_, stack_, outputs_.resin_bitmaps, topmost_from(outputs_)) {}

void LayerStackWriter::write(std::uint32_t index, const LayerRuns& layer) { files_.write(index, layer); }

void LayerStackWriter::add_file(std::string_view name, std::string_view text) const {
    write_staged_file(out_ / name, text);
}

const StackDescription& LayerStackWriter::finish(const PreviewMesh& preview, Progress* progress,
                                                 const PageOfStack& how_to_print) {
    VOXTONE_EXPECT(!outputs_.printer_folder || how_to_print);
    stack_ = with_contents(std::move(stack_), files_.written(), outputs_.resin_bitmaps);
    if (outputs_.gcvf)
        write_gcvf(out_ / gcvf_name, stack_, out_, *files_.topmost(), gcvf_preview(stack_, preview), progress);
    if (outputs_.vdb) write_volume_vdb(out_ / vdb_name, out_ / vdb_numbers_name, stack_, out_, progress);
    write_stack_texts(out_, stack_);
    if (outputs_.printer_folder)
        make_printer_folder(out_, printer_files(stack_, outputs_), out_ / printer_folder_name,
                            how_to_print(stack_, *files_.topmost()), progress);
    folder_.publish();
    return stack_;
}

std::uint64_t LayerStackWriter::bytes_written() const { return files_.bytes_written(); }

}  // namespace voxtone::io
