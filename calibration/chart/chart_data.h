// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured mixtures as a fit takes them: shares by resin, colours as CIELAB's roots f(X/Xn), f(Y/Yn), f(Z/Zn), and how
// much a small step of them is seen: |W d| is CIEDE2000 (optics::ciede2000_metric). Repeats of one mixture are one row,
// their mean; how far they lie from it is the noise.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/chart/edge_values.h"
#include "calibration/patches/patch_table.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

/// Squares of known thickness upon a base, which tell lengths. They need not be on the chart. Of a chart of laminates
/// all that it holds.
struct ThinSquares {
    std::vector<Patch> patches;
    std::vector<bool> own_instrument;     ///< not the chart's: a perfect diffuser is 1, no surface is seen
    Eigen::MatrixX3d roots;               ///< measured
    std::vector<Eigen::Matrix3d> metric;  ///< as those of mixtures
};

struct ChartData {
    std::vector<std::string> roles;
    optics::Illuminant illuminant = optics::Illuminant::d50;
    Eigen::Vector3d white;                ///< XYZ of the illuminant
    Eigen::MatrixXd shares;               ///< a mixture a row, a resin a column; rows sum to 1
    Eigen::MatrixX3d roots, lab;          ///< measured, means of repeats
    Eigen::VectorXd repeats;              ///< measurements of each mixture
    std::vector<Eigen::Matrix3d> metric;  ///< CIEDE2000 of a small step d of the roots is |W d|
    std::vector<std::string> names;       ///< "C:25+W:75"
    ThinSquares squares;
    std::vector<EdgePriorValue> edges;  ///< what edge profiles know of the resins
    Eigen::MatrixXd spectra;            ///< a mixture a row, a wavelength a column; empty: colours were measured
    Eigen::MatrixX3d observer;          ///< wavelengths x 3: XYZ / white of light of each; columns sum to 1
    std::vector<double> nm;             ///< the wavelengths
    optics::DifferenceSummary noise;    ///< CIEDE2000 of repeats from their mean; count 0: none was repeated

    /// No mixtures: `squares` are laminates, which tell all.
    [[nodiscard]] bool is_of_laminates() const { return mixtures() == 0; }
    /// Whether anything tells millimetres.
    [[nodiscard]] bool tells_lengths() const { return !squares.patches.empty() || !edges.empty(); }
    [[nodiscard]] Eigen::Index mixtures() const { return shares.rows(); }
    [[nodiscard]] Eigen::Index resins() const { return shares.cols(); }
};

/// Thick patches of `table` are mixtures, thin ones squares, and so are the patches of `squares`; `edges` may have no
/// resins. Throws InputError where there are fewer than two mixtures and no laminates, where a square is of a resin
/// that no mixture holds, and where edges know of no resin of the chart.
[[nodiscard]] ChartData chart_data(const PatchTable& table, const PatchTable& squares = {},
                                   const ResinPrior& edges = {});

/// The mixtures `keep` alone, with all squares and edges; the squares `keep` alone.
[[nodiscard]] ChartData chart_rows(const ChartData& data, const std::vector<Eigen::Index>& keep);
[[nodiscard]] ThinSquares square_rows(const ThinSquares& squares, const std::vector<Eigen::Index>& keep);

/// lab = lab_of_roots * roots - (16, 0, 0)
[[nodiscard]] Eigen::Matrix3d lab_of_roots();

}  // namespace voxtone::calibration
