// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/verify.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_digest.h"
#include "io/layers/png_layer_encoder.h"
#include "io/layers/stack_folder.h"
#include "io/layers/topmost_layers.h"
#include "io/pictures/picture_series.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

/// Names the first faults of every rule and counts the others.
class FaultList {
public:
    FaultList(StackReport& report, std::size_t most_named) : report_(report), most_named_(most_named) {}

    void add(const StackFault& fault) {
        ++report_.fault_count;
        if (++counts_[fault.rule] <= most_named_) report_.faults.push_back(fault);
    }
    /// More of a rule that were not even told by name.
    void count(const std::string& rule, std::uint64_t more) {
        report_.fault_count += more;
        counts_[rule] += more;
    }
    /// Causes first: `rules` is in their order.
    void close() {
        const auto rank = [](const StackFault& fault) {
            return std::find(rules.begin(), rules.end(), fault.rule) - rules.begin();
        };
        std::stable_sort(report_.faults.begin(), report_.faults.end(),
                         [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
        for (const auto& [rule, count] : counts_)
            if (count > most_named_) {
                const auto last = std::find_if(report_.faults.rbegin(), report_.faults.rend(),
                                               [&name = rule](const auto& f) { return f.rule == name; });
                report_.faults.insert(last.base(), {rule, "", fmt::format("and {} more", count - most_named_), ""});
            }
    }

private:
    static constexpr std::array<std::string_view, 20> rules{
        "unfinished", "container", "manifest",    "no-layers", "missing-layer", "unreadable", "stranger",
        "numbering",  "size",      "colour-type", "alpha",     "stray-colour",  "colours",    "resolution",
        "few-layers", "empty",     "digest",      "count",     "zbuffer",       "sheet"};
    StackReport& report_;
    std::size_t most_named_;
    std::map<std::string, std::uint64_t> counts_;
};

/// What a message says behind the name that it begins with.
std::string without_name(const std::string& message, const std::string& name) {
    return message.starts_with(name + ": ") ? message.substr(name.size() + 2) : message;
}

struct LayerResult {
    std::vector<StackFault> faults;
    std::vector<ColourCount> colours;
    std::uint64_t other_pixels = 0;
    std::optional<PngHeader> header;
    std::optional<std::uint64_t> digest;
    bool empty = false;
};

std::string shown(const Rgba& c) {
    return c[3] == 255 ? fmt::format("{} {} {}", c[0], c[1], c[2])
                       : fmt::format("{} {} {} alpha {}", c[0], c[1], c[2], c[3]);
}

/// What the stack says of itself, in one form for manifests and containers.
struct Announced {
    std::optional<std::array<std::uint32_t, 2>> size_px;
    std::optional<std::array<double, 3>> pitch_um;
    std::vector<Rgb> palette;           // empty: nothing is announced
    std::vector<std::uint64_t> voxels;  // per resin
    std::vector<std::string> names;
    Rgb background{};
};

Announced announced(const StackReader& reader) {
    Announced result;
    if (const auto& stack = reader.description()) {
        result.size_px = stack->size_px;
        result.pitch_um = stack->pitch_um;
        result.palette = stack->palette();
        result.background = stack->background_rgb;
        for (const auto& resin : stack->resins) {
            result.voxels.push_back(resin.voxels);
            result.names.push_back(resin.name);
        }
    } else if (const auto& config = reader.gcvf()) {
        result.size_px = {config->width_px, config->height_px};
        result.pitch_um = {25400 / config->x_dpi, 25400 / config->y_dpi,
                           static_cast<double>(config->slice_thickness_nm) / 1000};
        result.background = {config->background[0], config->background[1], config->background[2]};
        if (config->materials.size() < max_materials) {
            result.palette.push_back(result.background);
            for (const auto& material : config->materials) {
                result.palette.push_back({material.rgba[0], material.rgba[1], material.rgba[2]});
                result.voxels.push_back(material.voxels);
                result.names.push_back(material.name);
            }
        }
    }
    return result;
}

LayerResult check_layer(const StackReader& reader, std::uint32_t index, const Announced& stack,
                        TopmostLayers* topmost) {
    LayerResult result;
    const std::string& name = reader.layer_name(index);
    try {
        LayerInspection found = reader.inspect(index, stack.palette);
        result.header = found.header;
        if (found.header && (found.header->bit_depth != 8 || result.header->colour_type != 6))
            result.faults.push_back({"colour-type", name, fmt::format("is {}", png_kind(*result.header)),
                                     "save it as 8-bit RGBA (colour type 6); the printer's software refuses others"});
        if (!found.fault.empty()) throw InputError(found.fault);
        LayerScan& scan = found.scan;
        result.colours = std::move(scan.colours);
        result.other_pixels = scan.other_pixels;
        if (scan.runs) result.digest = layer_digest(*scan.runs);
        if (topmost && scan.runs && topmost->fits(*scan.runs)) topmost->add(index, *scan.runs);
        result.empty = result.other_pixels == 0 && result.colours.size() == 1 &&
                       std::equal(stack.background.begin(), stack.background.end(), result.colours[0].rgba.begin());
        for (const auto& colour : result.colours) {
            if (colour.rgba[3] != 255)
                result.faults.push_back(
                    {"alpha", name,
                     fmt::format("{} pixels have alpha {} instead of 255, the first at ({}, {})", colour.pixels,
                                 colour.rgba[3], colour.first_x, colour.first_y),
                     "make every pixel opaque; antialiasing and transparency are colours of their own there"});
            else if (!stack.palette.empty() &&
                     std::find(stack.palette.begin(), stack.palette.end(),
                               Rgb{colour.rgba[0], colour.rgba[1], colour.rgba[2]}) == stack.palette.end())
                result.faults.push_back(
                    {"stray-colour", name,
                     fmt::format("{} pixels have the colour {}, which stands for no resin, the first at ({}, {})",
                                 colour.pixels, shown(colour.rgba), colour.first_x, colour.first_y),
                     "give them a resin's colour; one stray colour is enough to be refused (\"too many colors\")"});
        }
    } catch (const InputError& error) {
        result.faults.push_back({"unreadable", name, without_name(error.what(), name), "slice again or copy it again"});
    }
    return result;
}

/// Names that are not of one form; those of a container are not padded.
void check_digits(const StackReader& reader, FaultList& faults) {
    std::map<int, std::vector<std::string>> of_width;
    for (std::uint32_t k = 0; k < reader.layers(); ++k)
        if (const auto name = parse_slice_name(reader.layer_name(k)))
            of_width[name->digits].push_back(reader.layer_name(k));
    if (of_width.size() < 2 || reader.kind() == StackReader::Kind::gcvf) return;
    const auto usual = std::ranges::max_element(of_width, {}, [](const auto& width) { return width.second.size(); });
    for (const auto& [digits, names] : of_width)
        if (digits != usual->first)
            faults.add({"numbering", names.front(),
                        fmt::format("{} {} where most have {}",
                                    names.size() == 1 ? "has" : fmt::format("and {} more have", names.size() - 1),
                                    counted(static_cast<std::uint64_t>(digits), "digit"),
                                    counted(static_cast<std::uint64_t>(usual->first), "digit")),
                        "pad all numbers with zeros to the same width; sorted by name the layers are out of order "
                        "otherwise"});
}

/// Of names that do not end in their numbers: heights, parts of names.
void check_gaps_of_other_numbers(const StackReader& reader, FaultList& faults) {
    std::vector<std::string> names;
    for (std::uint32_t k = 0; k < reader.layers(); ++k) names.push_back(reader.layer_name(k));
    if (reader.kind() != StackReader::Kind::folder ||
        std::ranges::all_of(names, [](const std::string& name) { return parse_slice_name(name).has_value(); }))
        return;
    for (const std::string& gap : series_gaps(names)) faults.add({"missing-layer", "", gap, ""});
}

void check_names(const StackReader& reader, FaultList& faults) {
    constexpr const char* plain_names = "name layers like slice_00000.png, the lowest first";
    std::optional<SliceName> before;
    for (std::uint32_t k = 0; k < reader.layers(); ++k) {
        const std::string& layer = reader.layer_name(k);
        const auto name = parse_slice_name(layer);
        if (!name)
            faults.add({"numbering", layer, "does not end in its number", plain_names});
        else if (before && name->stem != before->stem)
            faults.add({"numbering", layer,
                        fmt::format("begins otherwise than the layer before it, '{}'", before->stem), plain_names});
        else if (before && name->number == before->number)
            faults.add({"numbering", layer, fmt::format("number {} is there twice", name->number),
                        "remove the layer that does not belong"});
        else if (before && name->number < before->number)
            faults.add({"numbering", layer,
                        fmt::format("has a number below 0, and comes behind '{}{}'", before->stem, before->number),
                        plain_names});
        else if (before && name->number != before->number + 1)
            faults.add({"numbering", layer,
                        fmt::format("follows number {}: {} missing between them", before->number,
                                    counted(name->number - before->number - 1, "number")),
                        "add the missing layers or number them without gaps"});
        if (name) before = name;
    }
    check_digits(reader, faults);
    check_gaps_of_other_numbers(reader, faults);
}

/// What all layers say together, in their order, so that the report does not depend on the threads.
struct StackSummary {
    const StackReader& reader;
    Announced announced;
    std::string name;  ///< of the stack, for faults
    std::vector<LayerResult> layers{};
    std::array<std::uint32_t, 2> resolution{};  ///< pixels per metre as they should be
    std::map<Rgba, std::size_t> place{};        ///< colour -> index into the report's colours
    bool too_many_colours = false;
    std::optional<TopmostLayers> topmost{};  ///< of a container whose Zbuffer.png can be compared

    [[nodiscard]] const PngHeader* first_header() const {
        for (const LayerResult& layer : layers)
            if (layer.header) return &*layer.header;
        return nullptr;
    }
};

void check_parts(const StackSummary& stack, FaultList& faults) {
    const StackReader& reader = stack.reader;
    for (const auto& name : reader.missing())
        faults.add({"missing-layer", name, "is announced and not there", "slice again or copy the whole folder"});
    if (reader.missing_count() > reader.missing().size())
        faults.count("missing-layer", reader.missing_count() - reader.missing().size());
    for (const auto& name : reader.strangers()) {
        const bool leads_out =
            name.find("..") != std::string::npos || name.starts_with('/') || name.find('\\') != std::string::npos;
        faults.add(
            {"stranger", name,
             leads_out ? "is no part of a stack, and its path leads out of the folder" : "is no part of the stack",
             leads_out ? "do not unpack this container" : "remove it: nothing else may lie beside the layers"});
    }
}

void check_least_layers(const StackSummary& stack, std::uint32_t least, FaultList& faults) {
    // Those that are missing are named elsewhere.
    const std::uint64_t layers = stack.reader.layers() + stack.reader.missing_count();
    if (layers < least)
        faults.add({"few-layers", stack.name, "has " + counted(layers, "layer"),
                    fmt::format("the printer's software wants at least {}: print something higher, and all of its "
                                "layers if these are a part",
                                least)});
}

void keep_topmost(StackSummary& stack) {
    const auto& size_px = stack.announced.size_px;
    if (stack.reader.has_zbuffer() && size_px && stack.reader.layers() <= TopmostLayers::most_layers &&
        std::uint64_t{(*size_px)[0]} * (*size_px)[1] <= most_png_pixels)
        stack.topmost.emplace((*size_px)[0], (*size_px)[1]);
}

void look_at_layers(StackSummary& stack, Progress* progress) {
    const std::uint32_t layers = stack.reader.layers();
    if (progress) progress->begin_stage("verify", layers, "layers");
    stack.layers.resize(layers);
    keep_topmost(stack);
    parallel_for(
        0, layers, 1,
        [&](std::size_t k) {
            stack.layers[k] = check_layer(stack.reader, static_cast<std::uint32_t>(k), stack.announced,
                                          stack.topmost ? &*stack.topmost : nullptr);
            if (progress) progress->advance();
        },
        progress);
    if (progress) progress->end_stage();
}

std::array<std::uint32_t, 2> size_of(const StackSummary& stack) {
    if (stack.announced.size_px) return *stack.announced.size_px;
    const PngHeader* const header = stack.first_header();
    return header ? std::array{header->width_px, header->height_px} : std::array<std::uint32_t, 2>{};
}

std::array<std::uint32_t, 2> resolution_of(const StackSummary& stack, const VerifyRules& rules) {
    if (const auto& pitch_um = rules.pitch_um ? rules.pitch_um : stack.announced.pitch_um)
        return pixels_per_metre({(*pitch_um)[0], (*pitch_um)[1]});
    const PngHeader* const header = stack.first_header();
    return header ? std::array{header->x_per_metre, header->y_per_metre} : std::array<std::uint32_t, 2>{};
}

void check_pitch(const StackSummary& stack, const VerifyRules& rules, StackReport& report, FaultList& faults) {
    if (!rules.pitch_um) return;
    const std::array<double, 3>& wanted = *rules.pitch_um;
    if (!stack.announced.pitch_um) {
        report.notes.push_back(fmt::format(
            "bitmaps do not say how thick a layer is: that they were made for layers of {:g} um was not checked",
            wanted[2]));
        return;
    }
    const std::array<double, 3>& said = *stack.announced.pitch_um;
    if (pixels_per_metre({said[0], said[1]}) != stack.resolution)
        faults.add({"resolution", stack.name, fmt::format("is made for pixels of {:.3f} x {:.3f} um", said[0], said[1]),
                    fmt::format("this printer has {:.3f} x {:.3f} um: slice for it", wanted[0], wanted[1])});
    // The printer repeats or skips layers of another pitch. A GCVF says it in whole nanometres.
    constexpr double rounding_um = 0.00051;
    if (std::abs(said[2] - wanted[2]) > rounding_um)
        faults.add({"resolution", stack.name, fmt::format("is made for layers of {:g} um", said[2]),
                    fmt::format("this printer has {:g} um: slice for it", wanted[2])});
}

void check_header(const PngHeader& header, const std::string& layer, const std::array<std::uint32_t, 2>& size_px,
                  const std::array<std::uint32_t, 2>& resolution, FaultList& faults) {
    if (header.width_px != size_px[0] || header.height_px != size_px[1])
        faults.add(
            {"size", layer,
             fmt::format("is {} x {} px, the stack {} x {}", header.width_px, header.height_px, size_px[0], size_px[1]),
             "make all layers of one size"});
    // One dot per metre off is rounding: writers disagree on how to round 600 dpi.
    const auto off = [](std::uint32_t a, std::uint32_t b) { return a > b + 1 || b > a + 1; };
    if (!off(header.x_per_metre, resolution[0]) && !off(header.y_per_metre, resolution[1])) return;
    const bool swapped = !off(header.x_per_metre, resolution[1]) && !off(header.y_per_metre, resolution[0]);
    faults.add({"resolution", layer,
                header.x_per_metre == 0
                    ? std::string("does not say its resolution (pHYs)")
                    : fmt::format("says {:.1f} x {:.1f} dpi", header.x_per_metre * 0.0254, header.y_per_metre * 0.0254),
                fmt::format("it should be {:.1f} x {:.1f} dpi{}", resolution[0] * 0.0254, resolution[1] * 0.0254,
                            swapped ? "; columns and rows are swapped" : "")});
}

void check_layers(const StackSummary& stack, const StackReport& report, FaultList& faults) {
    for (std::uint32_t k = 0; k < stack.reader.layers(); ++k) {
        const LayerResult& layer = stack.layers[k];
        for (const auto& fault : layer.faults) faults.add(fault);
        if (layer.header)
            check_header(*layer.header, stack.reader.layer_name(k), report.size_px, stack.resolution, faults);
    }
}

void count_colours(StackSummary& stack, StackReport& report) {
    for (const LayerResult& layer : stack.layers) {
        for (const auto& colour : layer.colours) {
            const auto [found, is_new] = stack.place.emplace(colour.rgba, report.colours.size());
            if (is_new && report.colours.size() >= LayerScan::most_colours) {
                stack.place.erase(found);
                stack.too_many_colours = true;
                continue;
            }
            if (is_new) report.colours.push_back({colour.rgba, 0, colour.first_x, colour.first_y});
            report.colours[found->second].pixels += colour.pixels;
        }
        stack.too_many_colours |= layer.other_pixels > 0;
        report.empty_layers += layer.empty;
    }
}

void check_colours(const StackSummary& stack, std::uint32_t most, const StackReport& report, FaultList& faults) {
    const Rgb& nothing = stack.announced.background;
    std::size_t colours = 0;
    for (const auto& colour : report.colours)
        colours += !(colour.rgba[3] == 255 && std::equal(nothing.begin(), nothing.end(), colour.rgba.begin()));
    if (colours > most || stack.too_many_colours)
        faults.add(
            {"colours", stack.name,
             fmt::format("has {}{} colours besides the background", stack.too_many_colours ? "more than " : "",
                         colours),
             fmt::format("one colour is one resin, and {} fit: use fewer resins, and no antialiasing or lossy pictures",
                         most)});
}

void check_empty(const StackSummary& stack, StackReport& report, FaultList& faults) {
    const std::uint32_t layers = stack.reader.layers();
    if (layers == 0) return;
    if (report.empty_layers == layers)
        faults.add({"empty", stack.name, "has no printed pixel in any layer", "nothing would be printed: slice again"});
    else if (report.empty_layers > 0)
        report.notes.push_back(fmt::format("{} of {} layers are empty (background only)", report.empty_layers, layers));
}

/// What layers say of their colours, which are numbers of resins and no colours.
void note_colour_chunks(const StackSummary& stack, StackReport& report) {
    std::uint64_t layers = 0;
    std::uint32_t first = 0;
    for (std::uint32_t k = stack.reader.layers(); k-- > 0;)
        if (const auto& header = stack.layers[k].header; header && !header->colour_chunks.empty()) {
            ++layers;
            first = k;
        }
    if (layers > 0)
        report.notes.push_back(fmt::format(
            "{} of {} layers say what their colours mean ({} in {}); whether the printer's software converts them, "
            "which "
            "would make other colours of them, is not known: save them without a profile",
            layers, stack.reader.layers(), stack.layers[first].header->colour_chunks, stack.reader.layer_name(first)));
}

/// Whether every announced layer was read, and all of its colours are resins: only then can counts and digests agree.
bool all_layers_known(const StackSummary& stack) {
    return stack.reader.missing_count() == 0 && std::all_of(stack.layers.begin(), stack.layers.end(),
                                                            [](const LayerResult& l) { return l.digest.has_value(); });
}

void check_counts(const StackSummary& stack, const StackReport& report, FaultList& faults) {
    const Announced& said = stack.announced;
    for (std::size_t r = 0; r < said.voxels.size(); ++r) {
        const Rgb& c = said.palette[r + 1];
        const auto found = stack.place.find({c[0], c[1], c[2], 255});
        const std::uint64_t count = found == stack.place.end() ? 0 : report.colours[found->second].pixels;
        if (count != said.voxels[r])
            faults.add({"count", said.names[r],
                        fmt::format("{} voxels were found and {} are announced", count, said.voxels[r]),
                        "layers were changed after slicing: slice again"});
    }
}

void check_digest(const StackSummary& stack, StackReport& report, FaultList& faults) {
    std::vector<std::uint64_t> digests;
    for (const LayerResult& layer : stack.layers) digests.push_back(*layer.digest);
    report.content_sha256 = content_sha256(report.size_px[0], report.size_px[1], digests);
    if (stack.reader.description() && report.content_sha256 != stack.reader.description()->content_sha256)
        faults.add({"digest", stack.name, "holds other pixels than the manifest's content_sha256 says",
                    "layers were changed, swapped or reordered after slicing: slice again"});
}

/// Whether a container is of the known kind, and has all its parts.
void check_container(const StackReader& reader, FaultList& faults) {
    if (!reader.gcvf()) return;
    for (const std::string& unknown : unknown_in(*reader.gcvf()))
        faults.add({"container", "ConfigFile.xml", unknown,
                    "the printer's software may refuse it or take its layers for something else: slice again"});
    const auto check_part = [&](std::size_t part, bool whole, const char* kind) {
        const std::uint64_t bytes = reader.preview_bytes()[part];
        if (whole) return;
        faults.add({"container", std::string(preview_names[part]),
                    bytes == 0 ? "is missing or empty, which every known GCVF has"
                               : fmt::format("has {}, which is no {}", counted(bytes, "byte"), kind),
                    "slice again or copy it again"});
    };
    constexpr std::uint64_t stl_head = 84, stl_triangle = 50, box = 6 * sizeof(float);
    const auto [mesh_bytes, box_bytes] = reader.preview_bytes();
    check_part(0, mesh_bytes >= stl_head && (mesh_bytes - stl_head) % stl_triangle == 0, "binary STL");
    check_part(1, box_bytes == box, "box of six 32-bit numbers");
}

/// What is on top of each column, as a container says it besides.
void check_zbuffer(const StackSummary& stack, StackReport& report, FaultList& faults) {
    if (stack.reader.kind() != StackReader::Kind::gcvf) return;
    const std::string name(zbuffer_name);
    const std::optional<ZbufferInspection> found = stack.reader.zbuffer();
    if (!found) {
        report.notes.push_back(name +
                               " is not in it, which the vendor's utility writes; whether it is asked for when "
                               "a GCVF is read is not known");
        return;
    }
    const auto fault = [&](const std::string& what) { faults.add({"zbuffer", name, what, "slice again"}); };
    const PngHeader& header = found->header;
    if (!found->fault.empty())
        fault(without_name(found->fault, name));
    else if (header.bit_depth != 16 || header.colour_type != 0)
        fault(fmt::format("is {}, where the vendor's utility writes 16-bit grey", png_kind(header)));
    else if (header.width_px != report.size_px[0] || header.height_px != report.size_px[1])
        fault(fmt::format("is {} x {} px, the layers {} x {}", header.width_px, header.height_px, report.size_px[0],
                          report.size_px[1]));
    else if (stack.topmost && all_layers_known(stack) && found->digest != stack.topmost->digest())
        fault("does not hold the number of the topmost filled layer of every column");
}

/// Counts and digest, which follow from the layers.
void check_contents(const StackSummary& stack, StackReport& report, FaultList& faults) {
    if (stack.announced.palette.empty()) return;
    if (!all_layers_known(stack)) {
        report.notes.emplace_back(
            "voxel counts and digest were not compared: not every layer is there, can be read and has resins' colours "
            "only");
        return;
    }
    check_counts(stack, report, faults);
    check_digest(stack, report, faults);
}

/// The digest over the manifest binds names and roles to colours: nothing else sees two resins that changed places.
void check_seal(ManifestSeal seal, StackReport& report, FaultList& faults) {
    switch (seal) {
        case ManifestSeal::whole:
            return;
        case ManifestSeal::none:
            report.notes.emplace_back(
                "the manifest has no digest of its own (manifest_sha256): that its names and roles of resins belong to "
                "their colours was not checked");
            return;
        case ManifestSeal::broken:
            faults.add({"manifest", std::string(manifest_name), "was changed after it was written (manifest_sha256)",
                        "do not load resins by its names and roles; copy the original or slice again"});
    }
}

/// The sheet in the operator's hand: a line for each resin with its role and the code of its colour.
void check_sheet(const std::string& text, const StackDescription& stack, FaultList& faults) {
    for (const StackResin& resin : stack.resins) {
        const std::string code = fmt::format("#{:02x}{:02x}{:02x}", resin.rgb[0], resin.rgb[1], resin.rgb[2]);
        const std::size_t at = text.find(code);
        const std::size_t begin = at == std::string::npos ? 0 : text.rfind('\n', at) + 1;
        if (at == std::string::npos || !text.substr(begin, at - begin).starts_with(resin.name + " "))
            faults.add({"sheet", std::string(sheet_text_name),
                        fmt::format("does not say that {} is {}, as the manifest does", code, resin.name),
                        "assign resins by the manifest, or slice again"});
    }
}

/// There is no stack to look into.
StackReport unopened(const fs::path& path, const std::string& why) {
    StackReport report;
    const bool is_folder = fs::is_directory(path);
    const auto rule = !is_folder ? path.filename() == fs::path(manifest_name) ? "manifest" : "container"
                      : fs::exists(path / manifest_name)   ? "manifest"
                      : fs::exists(path / unfinished_name) ? "unfinished"
                      : fs::is_directory(path / "layers")  ? "manifest"
                                                           : "no-layers";
    report.faults.push_back({rule, path.string(), without_name(why, path.string()), ""});
    report.fault_count = 1;
    return report;
}

/// All checks, in an order that does not matter: `FaultList::close` sorts.
StackReport verify_opened(const fs::path& path, const StackReader& reader, const VerifyRules& rules,
                          Progress* progress) {
    StackSummary stack{.reader = reader, .announced = announced(reader), .name = path.filename().string()};
    StackReport report;
    report.kind = reader.kind();
    report.layers = reader.layers();
    if (std::string note = reader.untold_note(); !note.empty()) report.notes.push_back(std::move(note));
    FaultList faults(report, rules.most_named);
    if (reader.kind() == StackReader::Kind::voxtone) {
        check_seal(reader.seal(), report, faults);
        if (reader.sheet()) check_sheet(*reader.sheet(), *reader.description(), faults);
    }
    check_container(reader, faults);
    check_parts(stack, faults);
    check_names(reader, faults);
    check_least_layers(stack, rules.least_layers, faults);
    look_at_layers(stack, progress);
    report.size_px = size_of(stack);
    stack.resolution = resolution_of(stack, rules);
    check_pitch(stack, rules, report, faults);
    check_layers(stack, report, faults);
    count_colours(stack, report);
    check_colours(stack, rules.most_colours, report, faults);
    check_empty(stack, report, faults);
    note_colour_chunks(stack, report);
    check_contents(stack, report, faults);
    check_zbuffer(stack, report, faults);
    faults.close();
    return report;
}

}  // namespace

StackReport verify_stack(const fs::path& path, const VerifyRules& rules, Progress* progress) {
    return verify_stack(
        path, [&](const std::string&) { return rules; }, progress);
}

StackReport verify_stack(const fs::path& path, const RulesOfPrinter& rules_of, Progress* progress) {
    std::optional<StackReader> reader;
    StackReport report;
    try {
        reader.emplace(path);
    } catch (const InputError& error) {
        report = unopened(path, error.what());
    }
    const VerifyRules rules = rules_of(reader && reader->description() ? reader->description()->printer : "");
    if (reader) report = verify_opened(path, *reader, rules, progress);
    report.printer = rules.printer;
    report.notes.insert(report.notes.end(), rules.notes.begin(), rules.notes.end());
    return report;
}

std::string report_text(const StackReport& report) {
    const char* kind = report.kind == StackReader::Kind::voxtone ? "voxtone stack"
                       : report.kind == StackReader::Kind::gcvf  ? "GCVF container"
                                                                 : "folder of layers";
    std::string text;
    if (report.layers > 0)
        text = fmt::format("{}: {} of {} x {} px, {}; checked for {}\n", kind, counted(report.layers, "layer"),
                           report.size_px[0], report.size_px[1], counted(report.colours.size(), "colour"),
                           report.printer.empty() ? "what printers of this kind usually take" : report.printer);
    for (const auto& note : report.notes) text += fmt::format("note: {}\n", note);
    for (const auto& fault : report.faults) {
        text += fmt::format("fault [{}] {}{}{}", fault.rule, fault.where, fault.where.empty() ? "" : ": ", fault.what);
        text += fault.remedy.empty() ? "\n" : fmt::format("; {}\n", fault.remedy);
    }
    return text + (report.passed() ? "passed" : counted(report.fault_count, "fault")) + "\n";
}

}  // namespace voxtone::io
