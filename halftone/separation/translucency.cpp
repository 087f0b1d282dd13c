// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/translucency.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/contracts.h"
#include "base/parallel.h"
#include "halftone/separation/cube_root_lattice.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/layer_modes.h"
#include "optics/layered/layered_appearance.h"
#include "optics/media/effective_medium.h"

namespace voxtone::halftone {

namespace {

/// Denser where an alpha moves most; 0 is clear resin.
constexpr std::array ladder{0.002, 0.005, 0.01, 0.02, 0.035, 0.055, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 0.8, 1.0};

/// Of light through the slab: less tells nothing any more, and eta goes on with k, as of all that is homogeneous.
constexpr double least_told = 1e-8;

/// Luminance of what channels show.
double luminance(const optics::ObservedColour<double>& observed, const std::vector<double>& value) {
    return Eigen::Vector3d(0.2126, 0.7152, 0.0722).dot(observed.absolute(value.data()));
}

/// Where `x` lies among rising values, by a line between (0, 0) and the first, and so on; at most 1 past the last.
float inverted(const std::array<double, ladder.size()>& rising, double x) {
    double before = 0, before_k = 0;
    for (std::size_t i = 0; i < ladder.size(); ++i) {
        const double k = std::sqrt(ladder[i]);
        if (rising[i] > x) return float(before_k + (k - before_k) * (x - before) / (rising[i] - before));
        before = rising[i], before_k = k;
    }
    return 1;
}

/// Reads slabs of a shell and its core, thinned; what they share is made once.
class SlabReader {
public:
    SlabReader(const optics::ShellAppearance& appearance, int clear)
        : geometry_(appearance.geometry()),
          clear_(std::size_t(clear)),
          channels_(appearance.channels()),
          medium_(appearance.set(), geometry_.pitch_mm, geometry_.seen),
          plan_(optics::appearance_plan(appearance.set().g, appearance.set().eta)),
          observed_(appearance.set().channels) {}

    [[nodiscard]] optics::SlabReading operator()(std::vector<double> shell, double k) const {
        VOXTONE_EXPECT(k > 0 && k <= 1);
        std::vector<double> core(shell.size());
        core[std::size_t(geometry_.core_resin)] = 1;
        for (auto* shares : {&shell, &core}) {
            for (double& share : *shares) share *= k;
            (*shares)[clear_] += 1 - k;
        }
        const bool both_sides = geometry_.seen == optics::SeenFrom::all_sides;
        const double slab = Translucency::slab_mm(geometry_),
                     shell_mm = std::min(geometry_.shell_mm / k, both_sides ? slab / 2 : slab),
                     core_mm = slab - (both_sides ? 2 : 1) * shell_mm;
        std::vector<double> on_white, through;
        for (std::size_t c = 0; c < channels_; ++c) {
            const Layer of_shell(plan_, medium_(shell, c)), of_core(plan_, medium_(core, c));
            const auto seen = [&](optics::Admittance law) {
                if (both_sides) law = of_shell.over(law, shell_mm);
                return optics::appearance(plan_, of_shell.over(of_core.over(law, core_mm), shell_mm));
            };
            on_white.push_back(seen(optics::Admittance::white_sheet(plan_)));
            through.push_back(seen(optics::Admittance::air(plan_, true)) - seen(optics::Admittance::air(plan_, false)));
        }
        return {luminance(observed_, on_white), luminance(observed_, through)};
    }

private:
    /// Modes of what is seen at all.
    struct Layer {
        Layer(const optics::OrdinatePlan& plan, const optics::Medium& medium) {
            if (medium.sigma_t() > 0) modes.emplace(plan, medium);
        }
        [[nodiscard]] optics::Admittance over(const optics::Admittance& law, double mm) const {
            return modes ? modes->over(law, mm) : law;
        }
        std::optional<optics::LayerModes> modes;
    };

    const optics::ShellGeometry& geometry_;
    std::size_t clear_, channels_;
    optics::EffectiveMedium medium_;
    optics::OrdinatePlan plan_;
    optics::ObservedColour<double> observed_;
};

}  // namespace

double Translucency::slab_mm(const optics::ShellGeometry& geometry) {
    return std::min(geometry.shell_mm + geometry.core_mm, optics::translucency_slab_mm);
}

optics::SlabReading Translucency::reading(const Eigen::Vector3f& rgb, double k) const {
    return SlabReader(appearance_, clear_)(separation_.fractions(rgb), k);
}

Translucency::Translucency(const optics::ShellAppearance& appearance, const Separation& separation, int clear)
    : appearance_(appearance), separation_(separation), clear_(clear) {
    VOXTONE_EXPECT(clear >= 0 && std::size_t(clear) < separation.resins());
    const optics::TranslucencyScale scale(appearance.set().eta, slab_mm(appearance.geometry()));
    constexpr std::size_t colours = edge * edge * edge;
    const SlabReader reader(appearance, clear);
    static_assert(ladder.size() == steps);
    std::vector<std::array<double, steps>>& root_eta = root_eta_of_;
    root_eta.resize(colours);
    parallel_for(0, colours * ladder.size(), 1, [&](std::size_t i) {
        const std::size_t colour = i / ladder.size();
        const auto at = [](std::size_t n) { return float(std::pow(double(n) / (edge - 1), 3)); };
        const Eigen::Vector3f rgb(at(colour / (edge * edge)), at(colour / edge % edge), at(colour % edge));
        const optics::SlabReading read = reader(separation.fractions(rgb), ladder[i % ladder.size()]);
        if (read.through >= least_told) root_eta[colour][i % ladder.size()] = std::sqrt(scale.eta_per_cm(read));
    });
    for (auto& rising : root_eta) {
        for (std::size_t i = 1; i < rising.size(); ++i) {
            if (rising[i] == 0) rising[i] = rising[i - 1] * std::sqrt(ladder[i] / ladder[i - 1]);
            rising[i] = std::max(rising[i], rising[i - 1] + 1e-9);
        }
        most_root_eta_ = std::max(most_root_eta_, rising.back());
    }
    for (const auto& rising : root_eta)
        for (std::size_t e = 0; e < etas; ++e)
            root_kept_.push_back(inverted(rising, most_root_eta_ * double(e) / (etas - 1)));
    for (std::size_t a = 0; a < alphas; ++a) {
        const double eta = optics::translucency_eta_per_cm(double(a) / (alphas - 1));
        root_eta_.push_back(float(std::min(std::sqrt(eta) / most_root_eta_, 1.0)));
    }
}

std::uint32_t Translucency::kept_step(const Eigen::Vector3f& rgb, float alpha) const {
    if (!(alpha < 1)) return kept_steps - 1;
    if (!(alpha > 0)) return 0;
    const float a = alpha * (alphas - 1);
    const auto of_alpha = std::min(std::size_t(a), alphas - 2);
    const float root = root_eta_[of_alpha] + (a - float(of_alpha)) * (root_eta_[of_alpha + 1] - root_eta_[of_alpha]);
    const float e = root * (etas - 1);
    const auto of_eta = std::min(std::size_t(e), etas - 2);
    const float past = e - float(of_eta);
    float sum = 0;
    for_nodes_around(rgb, edge, [&](std::size_t colour, float weight) {
        const float* node = root_kept_.data() + colour * etas + of_eta;
        sum += weight * (node[0] + past * (node[1] - node[0]));
    });
    return std::uint32_t(std::lround(std::min(sum, 1.0f) * float(kept_steps - 1)));
}

double Translucency::shown_alpha(const Eigen::Vector3f& rgb, float k) const {
    if (!(k > 0)) return 0;
    const std::size_t step =
        std::min(std::size_t(std::ranges::lower_bound(ladder, double(k)) - ladder.begin()), steps - 1);
    const double from = step == 0 ? 0 : std::sqrt(ladder[step - 1]), to = std::sqrt(ladder[step]),
                 past = (std::sqrt(double(k)) - from) / (to - from);
    double root = 0;
    for_nodes_around(rgb, edge, [&](std::size_t colour, float weight) {
        const double before = step == 0 ? 0 : root_eta_of_[colour][step - 1];
        root += double(weight) * (before + past * (root_eta_of_[colour][step] - before));
    });
    return optics::translucency_alpha(root * root);
}

CumulativeMixture Translucency::diluted(const CumulativeMixture& mixture, float k) const {
    if (k >= 1) return mixture;
    CumulativeMixture out = mixture;
    constexpr float whole = 65536;
    const auto last = separation_.resins() - 1;
    for (std::size_t r = 0; r < last; ++r) {
        const float bound = mixture.bound[r] == 65535 ? whole : mixture.bound[r];
        const float diluted = k * bound + (int(r) >= clear_ ? (1 - k) * whole : 0);
        out.bound[r] = std::uint16_t(std::min(std::lround(diluted), 65535L));
    }
    return out;
}

}  // namespace voxtone::halftone
