// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which resins make a colour? Uses the installed library: the forward model of a coloured shell over white, inverted.
#include <cstdio>

#include <voxtone/halftone/separation/separation.h>
#include <voxtone/optics/layered/shell_appearance.h>
#include <voxtone/optics/media/resins.h>

int main() {
    using namespace voxtone;
    const optics::ResinSet resins = optics::vero_opaque();
    optics::ShellGeometry geometry;
    geometry.core_resin = resins.find("W");
    const optics::ShellAppearance shell(resins, geometry);
    const halftone::Separation separation(shell, {});
    const Eigen::Vector3f skin(0.60f, 0.36f, 0.26f);  // linear sRGB
    const std::vector<double> fractions = separation.fractions(skin);
    for (std::size_t r = 0; r < fractions.size(); ++r)
        std::printf("%-12s %5.1f %%\n", resins.resins[r].name.c_str(), 100 * fractions[r]);
    return 0;
}
