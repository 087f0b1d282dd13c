// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/hildreth.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace voxtone::scattering {

Eigen::VectorXd hildreth_minimum(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::MatrixXd& C,
                                 const Eigen::VectorXd& c) {
    constexpr int most_sweeps = 500;
    const Eigen::LDLT<Eigen::MatrixXd> solver(A);
    const Eigen::MatrixXd to_step = solver.solve(C.transpose());
    const Eigen::MatrixXd G = C * to_step;
    Eigen::VectorXd p = -solver.solve(g), multiplier = Eigen::VectorXd::Zero(c.size());
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double change = 0;
        for (Eigen::Index r = 0; r < c.size(); ++r) {
            if (!(G(r, r) > 0)) continue;
            const double wanted = std::max(0.0, multiplier[r] - (C.row(r).dot(p) - c[r]) / G(r, r)),
                         add = wanted - multiplier[r];
            if (add == 0) continue;
            multiplier[r] = wanted;
            p += add * to_step.col(r);
            change = std::max(change, add * add * G(r, r));
        }
        if (change == 0) break;
    }
    return p;
}

}  // namespace voxtone::scattering
