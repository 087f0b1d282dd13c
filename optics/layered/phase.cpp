// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/phase.h"

#include <cmath>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {

PhaseMatrices henyey_greenstein(const Eigen::ArrayXd& nu, double g, int terms) {
    VOXTONE_EXPECT(g > -1 && g < 1 && terms >= 1);
    const Eigen::Index n = nu.size();
    PhaseMatrices h{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), std::pow(g, terms)};
    Eigen::VectorXd previous = Eigen::VectorXd::Zero(n), current = Eigen::VectorXd::Ones(n);
    double g_to_k = 1;
    for (int k = 0; k < terms; ++k) {
        const double weight = (2 * k + 1) * (g_to_k - h.truncated) / (1 - h.truncated);
        const Eigen::MatrixXd term = weight * current * current.transpose();
        h.same += term;
        h.opposite += k % 2 == 0 ? term : Eigen::MatrixXd(-term);
        // (k + 1) P_{k+1} = (2k + 1) x P_k - k P_{k-1}
        const Eigen::VectorXd next = ((2 * k + 1) * nu * current.array() - k * previous.array()) / (k + 1);
        previous = current;
        current = next;
        g_to_k *= g;
    }
    return h;
}

PhaseMatrices conserving_henyey_greenstein(const AngularGrid& grid, double g, int terms, double* correction) {
    PhaseMatrices h = henyey_greenstein(grid.nu, g, terms);
    const Eigen::ArrayXd w = grid.c / (2 * grid.nu);
    const Eigen::MatrixXd total = 0.5 * (h.same + h.opposite);
    // Sinkhorn scaling of a symmetric matrix that is already nearly normalised: d_j sum_i w_i d_i total_ij = 1.
    Eigen::ArrayXd d = Eigen::ArrayXd::Ones(grid.size());
    double change = 1;
    for (int iteration = 0; iteration < 200 && change > 1e-15; ++iteration) {
        const Eigen::ArrayXd next = (d / image(total, (w * d).matrix()).array()).sqrt();
        change = (next - d).abs().maxCoeff();
        d = next;
    }
    VOXTONE_ENSURE(change < 1e-12);
    h.same = scaled_columns(scaled_rows(d.matrix(), h.same), d.matrix());
    h.opposite = scaled_columns(scaled_rows(d.matrix(), h.opposite), d.matrix());
    if (correction) *correction = (d - 1).abs().maxCoeff();
    return h;
}

}  // namespace voxtone::optics
