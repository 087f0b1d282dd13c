// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/stack_service.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/packed_values.h"
#include "io/layers/topmost_layers.h"
#include "io/programs/build_identity.h"

namespace voxtone::io {

namespace {

constexpr std::string_view kind_of_stack = "layer stack ";
const std::string stack_protocol = std::string(kind_of_stack) + "7, voxtone " + build_identity();

template <class Value, class Plain>
concept is_a = std::is_same_v<std::remove_const_t<Value>, Plain>;

struct PackedHeader {
    std::uint8_t there = 0;
    PngHeader png;
};

/// A layer's runs, row by row.
struct PackedRuns {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<std::uint32_t> runs_of_row;
    std::vector<Run> runs;
};

PackedRuns packed_runs(const LayerRuns& layer) {
    PackedRuns packed{layer.width_px(), layer.height_px(), {}, {}};
    for (std::uint32_t y = 0; y < layer.rows(); ++y) {
        const auto row = layer.row(y);
        packed.runs_of_row.push_back(static_cast<std::uint32_t>(row.size()));
        packed.runs.insert(packed.runs.end(), row.begin(), row.end());
    }
    return packed;
}

void expect_stack(bool holds, const char* what) {
    if (!holds) throw InputError(fmt::format("what the reader of the stack left is no answer: {}", what));
}

LayerRuns checked_runs(const PackedRuns& packed, std::size_t materials) {
    constexpr std::uint32_t most_px = 65535;
    expect_stack(packed.width_px >= 1 && packed.width_px <= most_px && packed.height_px >= 1 &&
                     packed.height_px <= most_px && packed.runs_of_row.size() == packed.height_px,
                 "a layer of an impossible size");
    LayerRuns layer(packed.width_px, packed.height_px);
    std::span<const Run> left = packed.runs;
    for (const std::uint32_t count : packed.runs_of_row) {
        expect_stack(count <= left.size(), "a row without its runs");
        std::uint64_t length = 0;
        for (const Run run : left.first(count)) {
            expect_stack(run.length > 0 && run.material < materials, "a run of no resin");
            length += run.length;
        }
        expect_stack(length == packed.width_px, "a row of another width");
        for (const Run run : left.first(count)) layer.push(run.length, static_cast<Material>(run.material));
        layer.end_row();
        left = left.subspan(count);
    }
    expect_stack(left.empty(), "runs without a row");
    return layer;
}

void check_config(const GcvfConfig& config) {
    expect_stack(config.x_dpi >= 0.1 && config.x_dpi <= 1e6 && config.y_dpi >= 0.1 && config.y_dpi <= 1e6,
                 "a container of an impossible resolution");
    expect_stack(config.width_px >= 1 && config.width_px <= 65535 && config.height_px >= 1 && config.height_px <= 65535,
                 "a container of an impossible size");
    expect_stack(config.materials.size() <= 255, "too many materials");
}

}  // namespace

template <class Stream, is_a<StackResin> Resin>
void describe(Stream& stream, Resin& r) {
    stream(r.name, r.role, r.rgb, r.voxels, r.ml);
}
template <class Stream, is_a<StackMember> Member>
void describe(Stream& stream, Member& m) {
    stream(m.name, m.boxes_mm, m.ml, m.verdict);
}
template <class Stream, is_a<StackDescription> Description>
void describe(Stream& stream, Description& d) {
    stream(d.printer, d.pitch_um, d.size_px, d.layers, d.first_layer, d.size_mm, d.origin_mm, d.pattern,
           d.background_rgb, d.resins, d.orientation.flip_x, d.orientation.flip_y, d.orientation.swap_xy,
           d.resin_pixels, d.members, d.content_sha256);
}
template <class Stream, is_a<StackOrigin> Origin>
void describe(Stream& stream, Origin& o) {
    stream(o.model, o.resins, o.illuminant, o.backing, o.view, o.coat, o.enclose, o.fault);
}
template <class Stream, is_a<GcvfMaterial> Value>
void describe(Stream& stream, Value& m) {
    stream(m.name, m.rgba, m.voxels);
}
template <class Stream, is_a<GcvfConfig> Config>
void describe(Stream& stream, Config& c) {
    stream(c.version, c.bit_depth, c.most_colours, c.semantics, c.x_dpi, c.y_dpi, c.slice_thickness_nm, c.width_px,
           c.height_px, c.start_index, c.slices, c.prefix, c.background, c.materials);
}
template <class Stream, is_a<PackedHeader> Header>
void describe(Stream& stream, Header& h) {
    stream(h.there, h.png.width_px, h.png.height_px, h.png.bit_depth, h.png.colour_type, h.png.interlaced,
           h.png.x_per_metre, h.png.y_per_metre, h.png.colour_chunks);
}
template <class Stream, is_a<ZbufferInspection> Inspection>
void describe(Stream& stream, Inspection& l) {
    stream(l.fault, l.header.width_px, l.header.height_px, l.header.bit_depth, l.header.colour_type, l.digest);
}
template <class Stream, is_a<PackedRuns> Runs>
void describe(Stream& stream, Runs& r) {
    stream(r.width_px, r.height_px, r.runs_of_row, r.runs);
}
template <class Stream, is_a<LayerRequest> Request>
void describe(Stream& stream, Request& r) {
    stream(r.index, r.palette, r.others.transparent, r.others.nearest);
}

namespace {

std::vector<std::byte> pack_listing(const StackListing& listing) {
    PackedWriter writer;
    writer(listing.kind, listing.names, listing.strangers, listing.missing, listing.missing_count);
    if (listing.description) {
        writer(*listing.description, listing.seal, listing.origin, listing.sheet.has_value());
        if (listing.sheet) writer(*listing.sheet);
    }
    if (listing.gcvf) writer(*listing.gcvf, listing.has_zbuffer, listing.preview_bytes);
    if (listing.kind == StackKind::folder) {
        const Orientation o = listing.orientation.value_or(Orientation{});
        writer(listing.orientation.has_value(), o.flip_x, o.flip_y, o.swap_xy);
    }
    return std::move(writer.bytes);
}

std::vector<std::byte> pack_inspection(const LayerInspection& found) {
    PackedWriter writer;
    writer(PackedHeader{found.header.has_value(), found.header.value_or(PngHeader{})}, found.fault, found.scan.colours,
           found.scan.other_pixels, found.scan.runs.has_value());
    if (found.scan.runs) writer(packed_runs(*found.scan.runs));
    return std::move(writer.bytes);
}

LayerInspection inspect(const StackFiles& stack, const LayerRequest& request) {
    LayerInspection found;
    const std::string& name = stack.listing().names[request.index];
    try {
        const auto bytes = stack.bytes(request.index);
        found.header = read_png_header(bytes, name);
        found.scan = scan_layer(bytes, name, request.palette, request.others);
    } catch (const Error& error) {
        found.fault = error.what();
        found.scan = {};
    }
    return found;
}

ZbufferInspection inspect_zbuffer(const StackFiles& stack) {
    const std::string name(zbuffer_name);
    ZbufferInspection found;
    try {
        const auto bytes = stack.zbuffer_bytes();
        found.header = read_png_header(bytes, name);
        found.digest = topmost_digest(read_grey_png(bytes, name).samples);
    } catch (const Error& error) {
        found = {.fault = error.what(), .header = {}};
    }
    return found;
}

/// In the place of a layer's.
constexpr std::uint32_t index_of_zbuffer = 0xffffffff;

}  // namespace

std::vector<std::byte> pack_stack_request(const std::filesystem::path& path) {
    PackedWriter writer;
    writer(stack_protocol, path.string());
    return std::move(writer.bytes);
}

std::vector<std::byte> pack(const LayerRequest& request) { return packed(request); }
std::vector<std::byte> pack_zbuffer_request() { return packed(LayerRequest{.index = index_of_zbuffer, .palette = {}}); }

StackListing unpack_listing(std::span<const std::byte> bytes) {
    PackedReader reader(bytes);
    StackListing listing;
    reader(listing.kind, listing.names, listing.strangers, listing.missing, listing.missing_count);
    expect_stack(listing.kind <= StackKind::gcvf, "a stack of an unknown kind");
    expect_stack(listing.names.size() <= 1'000'000, "an impossible number of layers");
    expect_stack(listing.missing_count >= listing.missing.size(), "layers are missing and are not counted");
    const std::uint64_t layers = listing.names.size() + listing.missing_count;
    if (listing.kind == StackKind::voxtone) {
        bool has_sheet = false;
        reader(listing.description.emplace(), listing.seal, listing.origin, has_sheet);
        if (has_sheet) reader(listing.sheet.emplace());
        expect_stack(listing.seal <= ManifestSeal::broken, "a manifest's seal of an unknown kind");
        expect_stack(layers == listing.description->layers, "layers that are not those of the manifest");
        listing.description->validate("what the reader of the stack left");
    }
    if (listing.kind == StackKind::gcvf) {
        reader(listing.gcvf.emplace(), listing.has_zbuffer, listing.preview_bytes);
        expect_stack(layers == listing.gcvf->slices, "layers that are not those of the container");
        check_config(*listing.gcvf);
    }
    if (listing.kind == StackKind::folder) {
        bool is_said = false;
        Orientation o;
        reader(is_said, o.flip_x, o.flip_y, o.swap_xy);
        if (is_said) listing.orientation = o;
    }
    reader.expect_end();
    return listing;
}

LayerInspection unpack_inspection(std::span<const std::byte> bytes, std::size_t materials) {
    PackedReader reader(bytes);
    LayerInspection found;
    PackedHeader header;
    bool has_runs = false;
    reader(header, found.fault, found.scan.colours, found.scan.other_pixels, has_runs);
    if (header.there) found.header = found.scan.header = header.png;
    expect_stack(header.there || !found.fault.empty(), "a layer without a header");
    expect_stack(found.scan.colours.size() <= LayerScan::most_colours, "too many colours");
    if (has_runs) {
        PackedRuns runs;
        reader(runs);
        found.scan.runs = checked_runs(runs, std::min<std::size_t>(materials, max_materials));
    }
    reader.expect_end();
    return found;
}

ZbufferInspection unpack_zbuffer(std::span<const std::byte> bytes) { return unpacked<ZbufferInspection>(bytes); }

bool StackService::serves(std::span<const std::byte> request) const {
    if (stack_) return true;
    std::string asked;
    PackedReader{request}(asked);
    return asked.starts_with(kind_of_stack);
}

std::vector<std::byte> StackService::answer(std::span<const std::byte> request) {
    if (!stack_) {
        PackedReader reader(request);
        std::string asked, path;
        reader(asked, path);
        if (asked != stack_protocol)
            throw ResourceError(fmt::format(
                "voxtone-read is of another version ({}) than the program that asks it ({}); install voxtone "
                "again",
                stack_protocol, asked));
        stack_ = std::make_unique<const StackFiles>(path);
        return pack_listing(stack_->listing());
    }
    const auto layer = unpacked<LayerRequest>(request);
    if (layer.index == index_of_zbuffer && stack_->listing().has_zbuffer) return packed(inspect_zbuffer(*stack_));
    if (layer.index >= stack_->listing().names.size()) throw InputError("a layer was asked for that is not there");
    return pack_inspection(inspect(*stack_, layer));
}

}  // namespace voxtone::io
