// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/viewing_transport.h"

namespace voxtone::optics {

// psi = phi + 3 Omega . J in both products (viewing_gradient.h).
void ViewingTransport::derivatives(const ViewingField& forward, std::span<float> by_sigma_t, std::span<float> by_sigma_s) const {
    VOXTONE_EXPECT(scale_ > 0 && forward.scale == 0 && forward.cells.size() == source_.size());
    const auto linear = static_cast<float>(grid_.directions.linear);
    const float V = volume_ * scale_;
    parallel_ranges(0, source_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            by_sigma_t[cell] = by_sigma_s[cell] = 0;
            if (grid_.medium[cell] == 0) continue;
            const Moments a = moments_of(forward.cells[cell]);
            const Moments& b = source_[cell];
            const float share = 1 / media_->cells[grid_.medium[cell]].sigma_s;
            const float phi2 = a.phi * b.phi * share, J2 = linear != 0 ? (a.x * b.x + a.y * b.y + a.z * b.z) * share / (3 * linear) : 0;
            by_sigma_t[cell] = -V * (phi2 - 3 * J2);
            by_sigma_s[cell] = V * (phi2 - 3 * linear * J2);
        }
    });
}

}  // namespace voxtone::optics
