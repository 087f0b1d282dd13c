// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layered_profiles.h"

#include <filesystem>
#include <utility>

#include "base/contracts.h"
#include "io/profiles/profile_map.h"
#include "io/profiles/resin_file.h"
#include "optics/media/resins.h"
#include "scattering/jobs/layered_options.h"
#include "scattering/local_profiles/luminance_channel.h"
#include "scattering/print/job_layers.h"
#include "scattering/print/layered_print.h"
#include "scattering/print/layers_check.h"
#include "slicer/options/option_table.h"
#include "slicer/part/other_print.h"
#include "slicer/printer/picture_slab.h"

namespace voxtone::scattering {

namespace {

class LayeredProfiles final : public slicer::OtherPrint {
public:
    LayeredProfiles(LayeredOptions options, io::ProfileMap map) : options_(std::move(options)), map_(std::move(map)) {}

    /// The printer's; those of published profiles where the map has other channels than these.
    std::string usual_resins(const slicer::PrinterProfile& printer) const override {
        const bool by_channel = options_.materials.empty() && !is_luminance(map_.channels);
        const std::string& of_printer = printer.default_resins;
        return by_channel && io::find_resin_set(of_printer).channels != map_.channels ? optics::vero_opaque().name
                                                                                      : of_printer;
    }
    void check(const slicer::LoadedResins& resins) const override { check_layers(options_, map_, resins); }
    std::vector<slicer::JobInput> inputs() const override {
        const std::string key = "profiles";
        const std::filesystem::path picture = std::filesystem::path(options_.profiles).parent_path() / map_.picture;
        std::vector<slicer::JobInput> inputs{{key, options_.profiles, {}},
                                             {key + ":" + map_.picture, picture.string(), {}}};
        for (const LaminateMaterialFile& material : options_.materials)
            inputs.push_back({"laminate-materials:" + material.role, material.file, {}});
        return inputs;
    }
    /// As docs/estimate.md measured it.
    std::vector<Work> work(const slicer::LoadedResins& resins) const override {
        constexpr double profiles_s_per_resin = 2, search_s_per_cluster = 0.05, corrected_search_s_per_cluster = 1;
        const bool corrected = correcting_rounds(options_) > 0;
        return {{slicer::Phase::profiles, profiles_s_per_resin * double(resins.set.resins.size())},
                {slicer::Phase::search,
                 (corrected ? corrected_search_s_per_cluster : search_s_per_cluster) * double(map_.target.size())}};
    }
    std::string what() const override { return "how light spreads"; }
    std::string why_no_resins() const override {
        return "Which resins the layers take is found by the search for their stacks, which is a part of the job.";
    }
    std::string why_whole() const override { return "layers of profiles are searched for once for the whole body"; }
    std::unique_ptr<slicer::Print> make(const slicer::OpenedJob& job, const slicer::JobBody& body,
                                        Progress& progress) const override {
        return std::make_unique<LayeredPrint>(job, options_, map_, body, progress);
    }

private:
    const LayeredOptions options_;
    const io::ProfileMap map_;
};

/// A picture without a size of its own is as wide as the map.
std::unique_ptr<const slicer::OtherPrint> open_layered(slicer::ResolvedJob& job) {
    const LayeredOptions* const options = layered_options(job);
    VOXTONE_EXPECT(options);
    io::ProfileMap map = io::read_profile_map(options->profiles);
    if (job.is_picture() && !slicer::is_sized(job.picture)) job.picture.width_mm = job.raw.width_mm = map.width_mm;
    return std::make_unique<const LayeredProfiles>(*options, std::move(map));
}

}  // namespace

void register_layered_profiles() {
    slicer::declare_show(layered_show_options());
    slicer::register_other_print(open_layered);
}

}  // namespace voxtone::scattering
