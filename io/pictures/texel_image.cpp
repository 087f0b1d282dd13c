// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/texel_image.h"

#include "base/parallel.h"

namespace voxtone::io {

void compose_over(TexelImage& image, const Eigen::Vector3f& under, const Eigen::Vector3f& tint, float tint_alpha) {
    const bool untinted = tint == Eigen::Vector3f::Ones() && tint_alpha == 1;
    parallel_for(0, image.pixels(), 1 << 16, [&](std::size_t i) {
        const float alpha = image.alpha(i) * tint_alpha;
        if (untinted && alpha == 1) return;
        image.set(i, Eigen::Vector3f(tint.cwiseProduct(image.rgb(i)) * alpha + under * (1 - alpha)));
    });
}

}  // namespace voxtone::io
