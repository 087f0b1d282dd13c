// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour of a place whose light is known by channel:
//
//   absolute          linear sRGB = M v
//   media-relative    linear sRGB = (M v) / (M w),   component by component, 0 where (M w) is not above 0
//
// M: linear_srgb_weights of the set's channels (channels.h); v: values by channel; w: those of the same place in white
// resin. Colours are made first and divided then: light that is added in the eye cannot be divided by channels before
// (three narrow channels that one cone sees would each become 1). The division is a von Kries scaling in the
// primaries of sRGB: for R, G, B, where M is the identity, it is v / w channel by channel, for all other channels it is
// a function of the two colours alone, so that sets whose channels differ and whose colours do not show the same.
//
// A place without any light (M w = 0) is black: nothing white can do about it. Values may be negative and above 1;
// nothing is clamped. `Real`: float or double.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "optics/colour/channels.h"

namespace voxtone::optics {

template <class Real>
class ObservedColour {
public:
    using Colour = Eigen::Matrix<Real, 3, 1>;
    using Weights = Eigen::Matrix<Real, 3, Eigen::Dynamic>;

    explicit ObservedColour(const Channels& channels) : weights_(linear_srgb_weights(channels).template cast<Real>()) {}

    [[nodiscard]] std::size_t channels() const { return static_cast<std::size_t>(weights_.cols()); }

    /// `value`: one number a channel, as everywhere here.
    [[nodiscard]] Colour absolute(const Real* value) const { return weights_ * by_channel(value); }

    [[nodiscard]] Colour relative(const Real* value, const Real* white) const {
        return over(absolute(value), absolute(white));
    }

    /// The matrix that makes media-relative colours of values where the white is always this one.
    [[nodiscard]] Weights relative_weights(const Real* white) const {
        const Colour of_white = absolute(white);
        Weights weights(3, weights_.cols());
        for (Eigen::Index c = 0; c < weights_.cols(); ++c) weights.col(c) = over(weights_.col(c), of_white);
        return weights;
    }

    /// d F / d value from d F / d colour. `white`: nullptr where the colour is absolute.
    void adjoint(const Colour& by_colour, const Real* white, Real* by_value) const {
        Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>> out(by_value, weights_.cols());
        out.noalias() = weights_.transpose() * (white ? over(by_colour, absolute(white)) : by_colour);
    }

private:
    [[nodiscard]] auto by_channel(const Real* value) const {
        return Eigen::Map<const Eigen::Matrix<Real, Eigen::Dynamic, 1>>(value, weights_.cols());
    }
    [[nodiscard]] static Colour over(const Colour& colour, const Colour& white) {
        Colour divided;
        for (Eigen::Index k = 0; k < 3; ++k) divided[k] = white[k] > 0 ? colour[k] / white[k] : Real{0};
        return divided;
    }

    Weights weights_;
};

}  // namespace voxtone::optics
