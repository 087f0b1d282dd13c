// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_print_job.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "base/warning.h"
#include "io/files/json_writer.h"
#include "io/profiles/resin_file.h"
#include "scattering/design/whole_layers.h"
#include "scattering/jobs/named_laminate.h"
#include "slicer/print/print_boxes.h"

namespace voxtone::scattering {
namespace {

struct Slab {
    std::string name;
    std::vector<io::SequenceLayer> layers;  ///< whole printed layers, top first, with the base
    double left_mm = 0, height_mm = 0;
};

void check(const LaminatePrintJob& job) {
    if (job.laminates.empty())
        throw UsageError(
            "laminate print: no laminate; name laminate files (voxtone-laminate) or layers such as \"W 0.3, K 0.1\"");
    for (const auto& [name, mm] : {std::pair("--width", job.width_mm), {"--depth", job.depth_mm}})
        if (!(mm > 0)) throw UsageError(fmt::format("{}: {:g} mm; a slab needs a size above 0", name, mm));
    if (!(job.gap_mm >= 0)) throw UsageError(fmt::format("--gap: {:g} mm; it is 0 or more", job.gap_mm));
}

std::optional<io::SequenceLayer> parse_base(const std::string& text) {
    if (text.empty()) return std::nullopt;
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos)
        throw UsageError(fmt::format("--base {}: write ROLE=LENGTH, such as K=1mm", text));
    const double mm = parse_length_mm(text.substr(equals + 1), "--base");
    if (!(mm > 0)) throw UsageError(fmt::format("--base {}: must be thicker than 0; leave it out for none", text));
    return io::SequenceLayer{text.substr(0, equals), mm};
}

/// Borders on whole printed layers. Warns of layers that are thinner than half of one and vanish.
std::vector<io::SequenceLayer> rounded(const io::LayerSequence& sequence, double layer_mm, Progress& progress) {
    std::vector<LaminateLayer> layers;
    for (std::size_t i = 0; i < sequence.layers.size(); ++i) layers.push_back({i, sequence.layers[i].mm});
    std::vector<io::SequenceLayer> printed;
    for (const auto& [i, mm] : whole_layers(layers, layer_mm)) printed.push_back({sequence.layers[i].material, mm});
    if (printed.size() < layers.size())
        progress.warn(named_warning(
            "laminate-layers",
            fmt::format("{}: {} of its {} layers are thinner than half a printed layer of {:g} mm and vanish; search "
                        "with --layer {:g}mm",
                        sequence.name, layers.size() - printed.size(), layers.size(), layer_mm, layer_mm)));
    if (printed.empty())
        throw InputError(fmt::format("{}: is thinner than one printed layer ({:g} mm); there is nothing to print",
                                     sequence.name, layer_mm));
    return printed;
}

std::vector<Slab> slabs_of(const LaminatePrintJob& job, double layer_mm, Progress& progress) {
    const std::optional<io::SequenceLayer> base = parse_base(job.base);
    std::vector<Slab> slabs;
    for (const std::string& laminate : job.laminates) {
        const io::LayerSequence sequence = read_named_sequence(laminate, {.resins = job.resins});
        if (sequence.resins.empty())
            throw InputError(
                fmt::format("{}: its materials are measured profiles; no printer is loaded with those: name the "
                            "resins, \"W 0.3, K 0.1\"",
                            laminate));
        const optics::ResinSet set = io::find_resin_set(sequence.resins);
        Slab slab{sequence.name, rounded(sequence, layer_mm, progress)};
        if (base) slab.layers.push_back({base->material, std::max(1.0, std::round(base->mm / layer_mm)) * layer_mm});
        for (io::SequenceLayer& layer : slab.layers) {
            const int resin = set.find(layer.material);
            if (resin < 0)
                throw InputError(
                    fmt::format("{}: the resin set {} has no resin of the role {}; say which set has one with --resins",
                                laminate, set.name, layer.material));
            layer.material = set.resins[static_cast<std::size_t>(resin)].role;
            slab.height_mm += layer.mm;
        }
        slab.left_mm = static_cast<double>(slabs.size()) * (job.width_mm + job.gap_mm);
        slabs.push_back(std::move(slab));
    }
    return slabs;
}

slicer::BoxPrint boxes_of(const LaminatePrintJob& job, const std::vector<Slab>& slabs) {
    slicer::BoxPrint print;
    for (const Slab& slab : slabs)
        for (const io::SequenceLayer& layer : slab.layers)
            if (std::find(print.roles.begin(), print.roles.end(), layer.material) == print.roles.end())
                print.roles.push_back(layer.material);
    for (const Slab& slab : slabs) {
        double top = slab.height_mm;
        for (const io::SequenceLayer& layer : slab.layers) {
            slicer::PrintBox box{{slab.left_mm, 0, top - layer.mm},
                                 {slab.left_mm + job.width_mm, job.depth_mm, top},
                                 std::vector<double>(print.roles.size(), 0.0)};
            box.fractions[static_cast<std::size_t>(std::find(print.roles.begin(), print.roles.end(), layer.material) -
                                                   print.roles.begin())] = 1;
            print.boxes.push_back(std::move(box));
            top -= layer.mm;
        }
        print.size_mm =
            print.size_mm.cwiseMax(Eigen::Vector3d(slab.left_mm + job.width_mm, job.depth_mm, slab.height_mm));
    }
    return print;
}

JobResult result_of(const LaminatePrintJob& job, const slicer::PrinterProfile& printer, const std::vector<Slab>& slabs,
                    const Eigen::Vector3d& size_mm, const io::StackDescription& stack) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-print").add("version", 1).add("folder", job.out);
    json.add("printer", printer.id).add("layers", stack.layers).key("slabs").begin_list();
    std::string text = fmt::format("{}: {:.2f} x {:.2f} x {:.3f} mm, {} layers of {:g} um\n", job.out, size_mm.x(),
                                   size_mm.y(), size_mm.z(), stack.layers, printer.pitch_um.z());
    for (const Slab& slab : slabs) {
        json.begin_object().add("name", slab.name).add("left_mm", slab.left_mm).add("height_mm", slab.height_mm);
        json.key("layers").begin_list();
        for (const io::SequenceLayer& layer : slab.layers)
            json.begin_object().add("material", layer.material).add("mm", layer.mm).end_object();
        json.end_list().end_object();
        text += fmt::format("  {}, from x = {:g} mm: {} mm, top first ({:.3f} mm in all)\n", slab.name, slab.left_mm,
                            io::layers_text(slab.layers), slab.height_mm);
    }
    json.end_list().key("ml").begin_object();
    for (const io::StackResin& resin : stack.resins) json.add(resin.role, resin.ml);
    json.end_object().add("content_sha256", stack.content_sha256).end_object();
    return {json.text(), text};
}

}  // namespace

JobResult run_laminate_print(const LaminatePrintJob& job, Progress& progress) {
    check(job);
    const slicer::PrinterProfile printer = slicer::find_printer(job.printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    const std::vector<Slab> slabs = slabs_of(job, printer.sliced_pitch_mm().z(), progress);
    const slicer::BoxPrint print = boxes_of(job, slabs);
    const io::StackDescription stack =
        slicer::print_boxes(print, printer, job.out, job.outputs, job.overwrite, progress);
    return result_of(job, printer, slabs, print.size_mm, stack);
}

}  // namespace voxtone::scattering
