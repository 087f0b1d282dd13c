// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/stack_volume.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/units.h"
#include "base/warning.h"
#include "io/layers/orient.h"
#include "io/layers/stack_reader.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture_series.h"
#include "io/profiles/lamp_file.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "slicer/layers/layer_volume.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_values.h"
#include "slicer/options/option_words.h"
#include "slicer/predict/foreign_body.h"
#include "slicer/predict/part_in_tray.h"
#include "slicer/predict/swapped_colours.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

namespace {

constexpr const char* no_material = "none";

/// A colour of the bitmaps and what it stands for.
struct NamedColour {
    io::Rgb rgb{};
    std::string name;  ///< role or name of a resin; `no_material`
    std::string told;  ///< for messages: how the stack calls it
};

/// What is printed: the resins of the volume and the material of each colour of the palette.
struct Assignment {
    std::vector<io::Rgb> palette;
    MaterialTable material_of{};
    optics::ResinSet resins;
    int white = -1;
};

std::string in_lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// By role first, then by name, in any case of letters.
int find_resin(const optics::ResinSet& set, const std::string& name) {
    if (const int found = set.find(name); found >= 0) return found;
    for (std::size_t r = 0; r < set.resins.size(); ++r)
        if (in_lower_case(set.resins[r].name) == in_lower_case(name) ||
            in_lower_case(set.resins[r].role) == in_lower_case(name))
            return static_cast<int>(r);
    return -1;
}

std::string roles_of(const optics::ResinSet& set) {
    std::vector<std::string> roles;
    for (const optics::Resin& resin : set.resins) roles.push_back(resin.role);
    return fmt::format("{}", fmt::join(roles, ", "));
}

Assignment assign(const std::vector<NamedColour>& colours, const optics::ResinSet& set, const std::string& stack) {
    if (colours.size() > std::size_t{io::max_materials})
        throw InputError(
            fmt::format("{}: {} colours, but a stack has at most {} with its background; leave out those that do not "
                        "occur",
                        stack, colours.size(), io::max_materials));
    Assignment result;
    std::vector<std::string> roles;
    const auto material = [&](const std::string& role) {
        const auto found = std::find(roles.begin(), roles.end(), role);
        const auto index = static_cast<optics::Material>(found - roles.begin() + 1);
        if (found == roles.end()) roles.push_back(role);
        return index;
    };
    for (const NamedColour& colour : colours) {
        if (std::find(result.palette.begin(), result.palette.end(), colour.rgb) != result.palette.end())
            throw InputError(
                fmt::format("{}: the colour {} stands for two things, the second is {}; give each colour one resin",
                            stack, hex_code(colour.rgb), colour.told));
        result.palette.push_back(colour.rgb);
        if (colour.name == no_material) continue;
        const int resin = find_resin(set, colour.name);
        if (resin < 0)
            throw InputError(
                fmt::format("{}: {} has no optical data in the resin set '{}', which has {}: without its absorption "
                            "and scattering nothing can be "
                            "predicted; name a set that has it with --resins",
                            stack, colour.told, set.name, roles_of(set)));
        result.material_of[result.palette.size() - 1] = material(set.resins[static_cast<std::size_t>(resin)].role);
    }
    if (set.find("W") >= 0) result.white = material("W") - 1;
    result.resins = set.subset(roles);
    return result;
}

optics::ResinSet resin_set(const StackVolumeOptions& options, const std::string& of_job) {
    if (!options.resins.empty()) return io::find_resin_set(options.resins);
    try {
        return io::find_resin_set(of_job);
    } catch (const Error& error) {
        throw InputError(
            fmt::format("{}: the resin set that the job was made with cannot be used ({}); name one with --resins",
                        options.stack, error.what()));
    }
}

optics::ResinSet under_lamp(const optics::ResinSet& set, const std::string& lamp, Progress& progress) {
    optics::ResinSet seen = io::seen_under(set, lamp);
    if (const auto doubt = io::lamp_doubt(set, lamp)) progress.warn(*doubt);
    return seen;
}

void expect_all_layers(const io::StackReader& stack, const std::string& name) {
    if (stack.missing_count() > 0)
        throw InputError(fmt::format(
            "{}: {} layers are missing, the first is {}: a body with gaps would be predicted; `voxtone verify` "
            "lists them",
            name, stack.missing_count(), stack.missing().front()));
}

[[noreturn]] void refuse_size(const std::string& layer, std::uint32_t width, std::uint32_t height,
                              const std::array<int, 2>& size) {
    throw InputError(fmt::format("{}: {} x {} px, but the stack has {} x {}; `voxtone verify` lists every such layer",
                                 layer, width, height, size[0], size[1]));
}

/// That of a printer, as far as it is known here.
std::string set_of_printer(const std::string& printer) {
    try {
        if (std::string set = find_printer(printer).default_resins; !set.empty()) return set;
    } catch (const Error&) {  // a profile of somebody's own, elsewhere
    }
    return optics::vero_opaque().name;
}

/// Where its inputs are named from.
std::filesystem::path folder_of_job(const std::filesystem::path& stack) {
    return stack.filename() == io::manifest_name ? stack.parent_path() : stack;
}

/// The resin set that the job of a stack names, seen from here; or that of its printer, which is said unless the user
/// names one.
std::string set_of(const io::StackReader& stack, const StackVolumeOptions& options, Progress& progress) {
    const io::StackOrigin& origin = stack.origin();
    const std::filesystem::path path = options.stack;
    if (!origin.resins.empty()) return input_named_in(folder_of_job(path), origin.resins);
    std::string set = set_of_printer(stack.description()->printer);
    if (options.resins.empty())
        progress.warn(named_warning(
            "changed-input",
            fmt::format("{}: {}; that of its printer {} is taken, '{}'; name another with --resins", options.stack,
                        origin.fault.empty() ? std::string("no job.json says of which resin set it was made")
                                             : "of which resin set it was made cannot be read: " + origin.fault,
                        stack.description()->printer, set)));
    return set;
}

void warn_of_seal(const io::StackReader& stack, const std::string& name, Progress& progress) {
    if (stack.seal() == io::ManifestSeal::broken)
        progress.warn(named_warning(
            "changed-input", fmt::format("{}: its {} was changed after it was written, and may name the wrong resins: "
                                         "slice it again",
                                         name, io::manifest_name)));
}

/// Bitmaps beside the layers that a manifest or container announces.
void warn_of_more_layers(const io::StackReader& stack, const std::string& name, Progress& progress) {
    std::vector<std::string> more;
    for (const std::string& stranger : stack.strangers())
        if (io::parse_slice_name(stranger)) more.push_back(stranger);
    if (more.empty()) return;
    progress.warn(named_warning(
        "strange-files",
        fmt::format("{}: {} beside its layers {} left out, for nothing announces {}: {}; `voxtone verify` "
                    "lists all",
                    name, counted(more.size(), "bitmap"), more.size() == 1 ? "is" : "are",
                    more.size() == 1 ? "it" : "them", more.front())));
}

/// Layers that are not there, and files that may be some.
void warn_of_series(const io::StackReader& stack, const std::string& name, Progress& progress) {
    if (stack.kind() != io::StackReader::Kind::folder) return warn_of_more_layers(stack, name, progress);
    std::vector<std::string> layers;
    for (std::uint32_t k = 0; k < stack.layers(); ++k) layers.push_back(stack.layer_name(k));
    for (const std::string& gap : io::series_gaps(layers))
        progress.warn(named_warning("missing-layers", name + ": " + gap));
    for (const std::string& doubt : io::series_doubts(layers, stack.strangers()))
        progress.warn(named_warning("strange-files", name + ": " + doubt));
}

void report_assignment(const StackVolumeOptions& options, const Assignment& assignment, const LayerWindow& window,
                       const std::array<double, 3>& pitch_mm, std::uint64_t solid_voxels, bool of_picture) {
    if (!options.before_reading) return;
    options.before_reading(
        {window.size, pitch_mm, solid_voxels, assignment.resins.name, assignment.white >= 0, of_picture});
}

/// As the manifest counts them; no more than there is room for.
std::uint64_t printed_voxels(const io::StackDescription& stack) {
    std::uint64_t left = std::uint64_t{stack.size_px[0]} * stack.size_px[1] * stack.layers, sum = 0;
    for (const io::StackResin& resin : stack.resins) {
        const std::uint64_t more = std::min(resin.voxels, left);
        sum += more;
        left -= more;
    }
    return sum;
}

/// Throws InputError where the part of a tray lies beyond its layers.
LayerWindow window_in(const LayerWindow& whole, const std::optional<LayerWindow>& part, const std::string& name) {
    if (!part) return whole;
    for (std::size_t a = 0; a < 3; ++a)
        if (part->corner[a] + part->size[a] > whole.size[a])
            throw InputError(
                fmt::format("{}: tray.json places it beyond the tray's layers; make the tray again", name));
    return *part;
}

/// How many layers of a length there may be.
int most_layers(const std::string& length, double pitch_mm) {
    return length.empty() ? 0 : static_cast<int>(std::ceil(parse_length_mm(length, "coat") / pitch_mm));
}

/// Some layers of a volume made of one material, or of nothing; the others as they are in `volume`, where it is there.
class LayersOf final : public optics::BlockRemake {
public:
    LayersOf(const std::array<int, 2>& range, optics::Material material, const optics::ResinVolume* volume)
        : range_(range), material_(material), volume_(volume) {}
    [[nodiscard]] bool touches(const std::array<int, 3>& block) const override {
        return volume_ || (block[2] * edge < range_[1] && (block[2] + 1) * edge > range_[0]);
    }
    void remake(const std::array<int, 3>& block, std::span<optics::Material> voxels) const override {
        if (volume_) volume_->copy_box({block[0] * edge, block[1] * edge, block[2] * edge}, {edge, edge, edge}, voxels);
        for (int z = 0; z < edge; ++z) {
            const int k = block[2] * edge + z;
            if (k < range_[0] || k >= range_[1]) continue;
            for (optics::Material& voxel : voxels.subspan(std::size_t(z) * edge * edge, std::size_t(edge) * edge))
                if (voxel != optics::air) voxel = material_;
        }
    }

private:
    static constexpr int edge = optics::ResinVolume::block_edge;
    std::array<int, 2> range_;
    optics::Material material_;
    const optics::ResinVolume* volume_;
};

/// A picture's stack as it is looked at: bare of the layers of clear resin on top of it. They, and those under it, are
/// as many as the job's lengths say and nothing else is in.
void look_below_coat(const io::StackOrigin& origin, StackVolume& stack) {
    if (stack.clear < 0) return;
    const auto size = stack.volume.size();
    const std::size_t plane = std::size_t(size[0]) * std::size_t(size[1]);
    std::vector<optics::Material> layer(plane);
    const auto is_clear = [&](int k) {
        stack.volume.copy_box({0, 0, k}, {size[0], size[1], 1}, layer);
        return std::ranges::all_of(layer, [&](optics::Material m) { return m == optics::air || m == stack.clear + 1; });
    };
    const double pitch_mm = stack.volume.pitch_mm()[2];
    const int under = most_layers(origin.enclose, pitch_mm), over = under + most_layers(origin.coat, pitch_mm);
    while (stack.clear_layers < std::min(under, size[2]) && is_clear(stack.clear_layers)) ++stack.clear_layers;
    int top = size[2];
    while (top > std::max(stack.clear_layers, size[2] - over) && is_clear(top - 1)) --top;
    if (top == size[2] || top == stack.clear_layers) return;
    const LayersOf bare({top, size[2]}, optics::air, &stack.volume);
    stack.volume = optics::remade(stack.volume, static_cast<optics::Material>(stack.clear + 1), &bare, nullptr);
}

StackVolume read_own(const io::StackReader& stack, const StackVolumeOptions& options,
                     const std::optional<LayerWindow>& part, Progress& progress) {
    if (!options.assign.empty() || options.nearest || options.pitch_mm || !options.printer.empty())
        throw UsageError(
            fmt::format("{}: has a manifest that says what its colours and sizes are; leave --assign, "
                        "--nearest, --pitch and --printer out",
                        options.stack));
    const io::StackDescription& description = *stack.description();
    expect_all_layers(stack, options.stack);
    warn_of_series(stack, options.stack, progress);
    warn_of_seal(stack, options.stack, progress);
    StackVolume result;
    const io::StackOrigin& origin = stack.origin();
    result.of_picture = !origin.model.empty() && model_kind(origin.model) == ModelKind::picture;
    if (result.of_picture && !origin.backing.empty())
        result.backing = parse_backing("backing", input_named_in(folder_of_job(options.stack), origin.backing));
    if (result.of_picture) result.from_behind = origin.view == name_of(PictureView::through);
    std::vector<NamedColour> colours{{description.background_rgb, no_material, "the background"}};
    for (const io::StackResin& resin : description.resins)
        // A resin that is loaded and not used needs no data.
        colours.push_back({resin.rgb, resin.voxels > 0 ? resin.role : no_material,
                           fmt::format("resin {} (role {})", resin.name, resin.role)});
    result.illuminant = options.illuminant.empty() ? input_named_in(folder_of_job(options.stack), origin.illuminant)
                                                   : options.illuminant;
    Assignment assignment =
        assign(colours, under_lamp(resin_set(options, set_of(stack, options, progress)), result.illuminant, progress),
               options.stack);

    std::array<int, 2> size{static_cast<int>(description.size_px[0]), static_cast<int>(description.size_px[1])};
    const std::array<int, 2> size_px = size;
    std::array<double, 3> pitch_mm{};
    for (std::size_t a = 0; a < 3; ++a) pitch_mm[a] = description.pitch_um[a] * 1e-3;
    if (description.orientation.swap_xy) {
        std::swap(size[0], size[1]);
        std::swap(pitch_mm[0], pitch_mm[1]);
    }
    result.spread_mm = description.spread_mm;
    if (description.orientation.swap_xy) std::swap(result.spread_mm[0], result.spread_mm[1]);
    const LayerWindow window =
        window_in({{}, {size[0], size[1], static_cast<int>(description.layers)}}, part, options.stack);
    const std::uint64_t room =
        std::uint64_t(window.size[0]) * std::uint64_t(window.size[1]) * std::uint64_t(window.size[2]);
    report_assignment(options, assignment, window, pitch_mm, std::min(room, printed_voxels(description)),
                      result.of_picture);
    LayerVolume volume(window, pitch_mm, assignment.material_of, options.memory_bytes);
    progress.begin_stage("read layers", static_cast<std::uint64_t>(window.size[2]), "layers");
    parallel_for(
        static_cast<std::size_t>(window.corner[2]), static_cast<std::size_t>(window.corner[2] + window.size[2]), 1,
        [&](std::size_t k) {
            const auto index = static_cast<std::uint32_t>(k);
            io::LayerRuns layer = stack.read(index, assignment.palette);
            if (static_cast<int>(layer.width_px()) != size_px[0] || static_cast<int>(layer.height_px()) != size_px[1])
                refuse_size(stack.layer_name(index), layer.width_px(), layer.height_px(), size_px);
            volume.add(static_cast<int>(k), io::as_sliced(std::move(layer), description.orientation));
            progress.advance();
        },
        &progress);
    progress.end_stage();
    result.volume = volume.finish();
    result.resins = std::move(assignment.resins);
    result.white = assignment.white;
    result.clear = result.resins.find("T");
    if (result.of_picture && options.below_coat) look_below_coat(origin, result);
    result.corner_mm = description.origin_mm;
    result.corner_mm[2] += description.first_layer * pitch_mm[2];
    for (std::size_t a = 0; a < 3; ++a) result.corner_mm[a] += window.corner[a] * pitch_mm[a];
    return result;
}

/// The usual names of a container's materials, or that of a resin in the set.
std::string role_of_gcvf_material(const std::string& name, const optics::ResinSet& set) {
    if (const std::string_view role = io::role_of_gcvf_material(name); !role.empty()) return std::string(role);
    return find_resin(set, name) >= 0 ? name : "";
}

std::vector<NamedColour> foreign_colours(const io::StackReader& stack, const StackVolumeOptions& options,
                                         const optics::ResinSet& set) {
    std::vector<NamedColour> colours;
    for (const ColourAssignment& told : options.assign)
        colours.push_back({told.rgb, told.role, fmt::format("the resin '{}' of --assign", told.role)});
    const auto add = [&](const io::Rgb& rgb, const std::string& name, const std::string& told) {
        if (std::none_of(colours.begin(), colours.end(), [&](const NamedColour& c) { return c.rgb == rgb; }))
            colours.push_back({rgb, name, told});
    };
    io::Rgb background{};
    if (stack.gcvf())
        background = {stack.gcvf()->background[0], stack.gcvf()->background[1], stack.gcvf()->background[2]};
    add(background, no_material, "the background");
    if (stack.gcvf()) {
        for (const io::GcvfMaterial& material : stack.gcvf()->materials) {
            const std::string role = role_of_gcvf_material(material.name, set);
            const io::Rgb rgb{material.rgba[0], material.rgba[1], material.rgba[2]};
            if (!role.empty()) {
                add(rgb, role, fmt::format("material {}", material.name));
            } else if (material.voxels > 0 && std::none_of(colours.begin(), colours.end(),
                                                           [&](const NamedColour& c) { return c.rgb == rgb; })) {
                throw InputError(fmt::format(
                    "{}: nothing is known of its material '{}'; say which resin of the set '{}' it is ({}): --assign "
                    "\"{}=W\"",
                    options.stack, material.name, set.name, roles_of(set), hex_code(rgb)));
            }
        }
    }
    return colours;
}

std::array<double, 3> foreign_pitch_mm(const io::StackReader& stack, const StackVolumeOptions& options,
                                       const std::optional<PrinterProfile>& printer) {
    if (options.pitch_mm) return *options.pitch_mm;
    if (printer) {
        const Eigen::Vector3d pitch = printer->pitch_um * 1e-3;
        return {pitch.x(), pitch.y(), pitch.z()};
    }
    if (stack.gcvf()) {
        const io::GcvfConfig& config = *stack.gcvf();
        if (config.x_dpi > 0 && config.y_dpi > 0 && config.slice_thickness_nm > 0)
            return {mm_per_inch / config.x_dpi, mm_per_inch / config.y_dpi, double(config.slice_thickness_nm) * 1e-6};
    }
    throw InputError(fmt::format(
        "{}: nothing says how large its voxels are, and light spreads in millimetres; give --printer (`voxtone list "
        "printers`) or --pitch \"42.33,84.67,27um\" (columns, rows, layers)",
        options.stack));
}

std::string orientation_text(const io::Orientation& o) {
    std::string text;
    const auto add = [&](bool holds, const char* what) {
        if (holds) text += (text.empty() ? "" : ", ") + std::string(what);
    };
    add(o.swap_xy, "rows and columns exchanged");
    add(o.flip_x, "columns mirrored");
    add(o.flip_y, "rows mirrored");
    return text;
}

/// How the bitmaps lie, and what is printed with their pixels.
struct BitmapFrame {
    std::array<double, 3> pitch_mm{};   ///< along the model's x, y, z
    std::array<double, 2> spread_mm{};  ///< of the printer, along x and y
    io::Orientation orientation;
    optics::ResinSet resins;
    std::string family;                  ///< of the resins' cartridges
    std::vector<Cartridges> cartridges;  ///< of the printer
};

/// The printer that was named mirrors what it prints, so its bitmaps are mirrored; without one what their slicer says.
BitmapFrame foreign_frame(const io::StackReader& stack, const StackVolumeOptions& options, Progress& progress) {
    std::optional<PrinterProfile> printer;
    if (!options.printer.empty()) printer = find_printer(options.printer);
    BitmapFrame frame;
    frame.pitch_mm = foreign_pitch_mm(stack, options, printer);
    if (printer) frame.spread_mm = printer->sliced_spread_mm();
    if (const std::string set = !options.resins.empty() ? options.resins
                                : printer               ? printer->default_resins
                                                        : "";
        !set.empty())
        frame.resins = io::find_resin_set(set), frame.family = io::resin_family(set);
    else
        frame.resins = optics::vero_opaque(), frame.family = io::resin_family(frame.resins.name);
    frame.resins = under_lamp(frame.resins, options.illuminant, progress);
    if (printer)
        frame.orientation = printer->orientation, frame.cartridges = printer->cartridges;
    else if (stack.orientation() && *stack.orientation() != io::Orientation{}) {
        frame.orientation = *stack.orientation();
        progress.note(
            fmt::format("{}: the slicer's settings beside the layers say how they lie ({}): the body is taken as it "
                        "was sliced, and "
                        "not as the panel shows it; copy the layers alone elsewhere to have them as they lie",
                        options.stack, orientation_text(frame.orientation)));
    }
    if (frame.orientation.swap_xy) std::swap(frame.pitch_mm[0], frame.pitch_mm[1]);
    return frame;
}

/// A printer's computer, and HOW-TO-PRINT, call a resin by its cartridge ("VeroYL-V"): its role, where the set is of
/// that family. Another family's is left for what refuses it: it would be predicted as a resin that it is not. Without
/// a printer all that are known by such names are looked through.
void take_cartridge_names(const BitmapFrame& frame, StackVolumeOptions& options) {
    std::vector<Cartridges> cartridges = frame.cartridges;
    if (cartridges.empty())
        for (const PrinterProfile& printer : list_printers())
            cartridges.insert(cartridges.end(), printer.cartridges.begin(), printer.cartridges.end());
    for (ColourAssignment& told : options.assign) {
        if (told.role == no_material || find_resin(frame.resins, told.role) >= 0) continue;
        const std::string name = in_lower_case(told.role);
        for (const Cartridges& some : cartridges) {
            if (!frame.family.empty() && some.family != frame.family) continue;
            const auto found = std::ranges::find_if(
                some.names, [&](const auto& named) { return in_lower_case(named.second) == name; });
            if (found == some.names.end()) continue;
            told.role = found->first;
            break;
        }
    }
}

void warn_of_swaps(const StackVolumeOptions& options, const optics::ResinSet& set, Progress& progress) {
    std::vector<ToldColour> told;
    for (const ColourAssignment& colour : options.assign)
        if (const int resin = find_resin(set, colour.role); resin >= 0)
            told.push_back({colour.rgb, colour.role, set.resins[static_cast<std::size_t>(resin)].role});
    for (const std::string& doubt : swapped_colours(told))
        progress.warn(named_warning("assigned-colours", "--assign " + doubt));
}

void warn_of_absent(const StackVolumeOptions& options, const ForeignBody& body, Progress& progress) {
    for (const ColourAssignment& told : options.assign)
        if (body.pixels_of(told.rgb) == 0)
            progress.warn(
                named_warning("assigned-colours",
                              fmt::format("--assign \"{}={}\": no pixel of {} has this colour; is it the right one?",
                                          hex_code(told.rgb), told.role, options.stack)));
}

/// Transparent pixels are one more material, which is none.
PixelMaterials with_transparent(const Assignment& assignment) {
    PixelMaterials materials{assignment.palette, assignment.material_of, {}};
    std::size_t none = materials.palette.size();
    if (none == std::size_t{io::max_materials})
        none = static_cast<std::size_t>(std::ranges::find(materials.material_of, optics::air) -
                                        materials.material_of.begin());
    if (none < std::size_t{io::max_materials}) materials.others.transparent = static_cast<io::Material>(none);
    return materials;
}

/// Where transparent pixels are the background black is no longer that: a resin that nobody told would be air. With
/// --nearest what is black may be an edge that was nearest to nothing.
void expect_told_black(const ForeignBody& body, const StackVolumeOptions& options, const ForeignStack& foreign) {
    constexpr io::Rgb black{};
    const std::uint64_t pixels = body.pixels_of(black);
    const std::size_t transparent = body.materials.others.transparent;
    if (foreign.nearest || foreign.layers.gcvf() || pixels == 0 || transparent >= body.pixels.size() ||
        body.pixels[transparent] == 0 ||
        std::ranges::any_of(options.assign, [&](const ColourAssignment& told) { return told.rgb == black; }))
        return;
    if (transparent < body.materials.palette.size()) return;  // numbered as another colour is that stands for nothing
    throw InputError(fmt::format(
        "{}: has {} of {} amid a transparent background, and nothing says what they are: --assign \"{}={}\" (or "
        "another "
        "of {}, none)",
        options.stack, counted(pixels, "pixel"), hex_code(black), hex_code(black), foreign.role, foreign.roles));
}

StackVolume read_foreign(const io::StackReader& stack, StackVolumeOptions options, Progress& progress) {
    expect_all_layers(stack, options.stack);
    const BitmapFrame frame = foreign_frame(stack, options, progress);
    take_cartridge_names(frame, options);
    const std::array<double, 3>& pitch_mm = frame.pitch_mm;
    const optics::ResinSet& set = frame.resins;
    Assignment assignment = assign(foreign_colours(stack, options, set), set, options.stack);
    warn_of_swaps(options, set, progress);
    warn_of_series(stack, options.stack, progress);
    const ForeignStack foreign{.layers = stack,
                               .name = options.stack,
                               .orientation = frame.orientation,
                               .resin_set = set.name,
                               .roles = roles_of(set),
                               .role = set.find("W") >= 0 ? "W" : set.resins.front().role,
                               .any_assigned = stack.gcvf() || !options.assign.empty(),
                               .nearest = options.nearest};
    const ForeignBody body = find_foreign_body(foreign, with_transparent(assignment), progress);
    expect_told_black(body, options, foreign);
    warn_of_absent(options, body, progress);
    const LayerWindow& window = body.window;
    report_assignment(options, assignment, window, pitch_mm, body.solid_voxels(), false);
    const PixelMaterials& materials = body.materials;
    LayerVolume volume(window, pitch_mm, materials.material_of, options.memory_bytes);
    progress.begin_stage("read layers", static_cast<std::uint64_t>(window.size[2]), "layers");
    parallel_for(
        static_cast<std::size_t>(window.corner[2]), static_cast<std::size_t>(window.corner[2] + window.size[2]), 1,
        [&](std::size_t k) {
            const auto index = static_cast<std::uint32_t>(k);
            volume.add(static_cast<int>(k),
                       io::as_sliced(stack.read(index, materials.palette, materials.others), frame.orientation));
            progress.advance();
        },
        &progress);
    progress.end_stage();
    StackVolume result;
    result.illuminant = options.illuminant;
    result.volume = volume.finish();
    result.spread_mm = frame.spread_mm;
    result.resins = std::move(assignment.resins);
    result.white = assignment.white;
    for (std::size_t a = 0; a < 3; ++a) result.corner_mm[a] = window.corner[a] * pitch_mm[a];
    return result;
}

}  // namespace

std::array<double, 3> parse_pitch_mm(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    if (parts.size() != 3)
        throw UsageError(
            fmt::format("--pitch: '{}' is not three lengths (columns, rows, layers) such as 42.33,84.67,27um", text));
    const auto unit_at = [](const std::string& part) {
        return std::min(part.find_last_of("0123456789.") + 1, part.size());
    };
    const std::string unit = parts[2].substr(unit_at(parts[2]));
    std::array<double, 3> pitch{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (unit_at(parts[a]) == parts[a].size()) parts[a] += unit;
        pitch[a] = parse_length_mm(parts[a], "--pitch");
        if (unit.empty() && pitch[a] > 1)
            throw UsageError(
                fmt::format("--pitch: '{}' has no unit, and {} mm is no voxel; if these are um, add um: "
                            "--pitch {}um",
                            text, parts[a], text));
        if (!(pitch[a] >= 1e-3 && pitch[a] <= 1))
            throw UsageError(fmt::format("--pitch: '{}' is {:g} mm; a voxel is 0.001 to 1 mm wide", text, pitch[a]));
    }
    return pitch;
}

ColourAssignment parse_assignment(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string colour = text.substr(0, std::min(equals, text.size()));
    std::uint32_t code = 0;
    const bool is_colour = colour.size() == 7 && colour[0] == '#';
    const auto [rest, status] =
        std::from_chars(colour.data() + (is_colour ? 1 : 0), colour.data() + colour.size(), code, 16);
    if (!is_colour || status != std::errc{} || rest != colour.data() + colour.size() || equals == std::string::npos ||
        equals + 1 == text.size())
        throw UsageError(
            fmt::format("--assign: '{}' is not of the form #rrggbb=ROLE, such as #00aeef=C (or =none)", text));
    return {
        {static_cast<std::uint8_t>(code >> 16), static_cast<std::uint8_t>(code >> 8), static_cast<std::uint8_t>(code)},
        text.substr(equals + 1)};
}

StackVolume read_stack_volume(const StackVolumeOptions& asked, Progress& progress) {
    const std::optional<PartInTray> part = find_part_in_tray(asked.stack);
    const io::StackReader stack(part ? part->stack : asked.stack);
    StackVolumeOptions options = asked;
    if (options.illuminant.empty()) options.illuminant = part ? part->illuminant : lamp_of_parts(asked.stack);
    StackVolume read = stack.kind() != io::StackReader::Kind::voxtone
                           ? read_foreign(stack, options, progress)
                           : read_own(stack, options, part ? std::optional(part->window) : std::nullopt, progress);
    if (read.illuminant.empty()) read.illuminant = io::usual_lamp;
    return read;
}

std::optional<optics::ResinVolume> white_print(const StackVolume& stack) {
    if (stack.clear_layers == 0) return std::nullopt;
    const LayersOf clear({0, stack.clear_layers}, static_cast<optics::Material>(stack.clear + 1), nullptr);
    return optics::remade(stack.volume, static_cast<optics::Material>(stack.white + 1), &clear, nullptr);
}

}  // namespace voxtone::slicer
