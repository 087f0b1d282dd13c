# SPDX-License-Identifier: GPL-3.0-or-later
"""rho(45 -> 0) of layers without end, by adding-doubling on arrays: many stacks at once, no line of the program.

Straight down is the view, so that the mean over azimuth is all that counts. Directions inside: Gauss-Legendre below and above the
critical angle, and the two of the instrument with next to no weight. Operators act on radiances: r = kernel * 2 mu w."""
import numpy as np


class Layers:
    def __init__(self, g, eta, below=8, above=8):
        critical = np.sqrt(1 - 1 / eta**2)
        refracted = lambda air: np.sqrt(1 - (1 - air**2) / eta**2)
        x, w = np.polynomial.legendre.leggauss(below)
        nodes, weights = critical * (x + 1) / 2, critical * w / 2
        x, w = np.polynomial.legendre.leggauss(above)
        air, w = (x + 1) / 2, w / 2
        self.mu = np.concatenate([nodes, refracted(air), [1.0, refracted(np.sqrt(0.5))]])
        self.weight = 2 * self.mu * np.concatenate([weights, w * air / (eta**2 * refracted(air)), [1e-12, 1e-12]])
        sine2 = np.minimum(eta**2 * (1 - self.mu**2), 1.0)
        out = np.sqrt(1 - sine2)
        s, p = (eta * self.mu - out) / (eta * self.mu + out), (self.mu - eta * out) / (self.mu + eta * out)
        self.inside = (s * s + p * p) / 2
        terms = 60
        legendre = np.polynomial.legendre.legvander(self.mu, terms - 1)
        order = np.arange(terms)
        self.on = (legendre * ((2 * order + 1) * g**order)) @ legendre.T
        self.back = (legendre * ((2 * order + 1) * (-g) ** order)) @ legendre.T
        self.eta = eta

    def layer(self, sigma_t, albedo, mm):
        """Reflection and transmission of layers; arrays of one length. Endless: mm = inf."""
        sigma_t, albedo, mm = np.broadcast_arrays(*map(np.atleast_1d, map(np.asarray, (sigma_t, albedo, mm))))
        depth = sigma_t * np.where(np.isinf(mm), 1e4 / np.maximum(sigma_t, 1e-9), mm)
        doublings = 33  # of fewer grazing light is off, of more (40: 1e-4) rounding adds up
        thin = (depth / 2.0**doublings)[:, None, None]
        single = albedo[:, None, None] * thin / (4 * self.mu[:, None] * self.mu[None, :]) * self.weight
        same = np.eye(len(self.mu))
        r = single * self.back
        t = same * np.exp(-thin / self.mu) + single * self.on
        for _ in range(doublings):
            echo = np.linalg.solve(same - r @ r, np.concatenate([r @ t, t], axis=2))
            n = len(self.mu)
            r, t = r + t @ echo[:, :, :n], t @ echo[:, :, n:]
        return r, t

    def upon(self, layer, base):
        """Reflection of a layer upon what reflects `base`."""
        r, t = layer
        return r + t @ np.linalg.solve(np.eye(len(self.mu)) - base @ r, base @ t)

    def on_air(self, layer):
        return self.upon(layer, np.diag(self.inside)[None])

    def through(self, layer):
        """Shares of a beam along the normal and of diffuse light, from below, that leave a slab in air upwards."""
        r, t = layer
        n, faces = len(self.mu), np.diag(self.inside)
        same = np.broadcast_to(np.eye(n), r.shape)
        # Upward at the lower face, downward there, upward at the upper face: u0 = q + B d0, d0 = r u0 + t B u1, u1 = t u0 + r B u1.
        matrix = np.block([[same, -same * self.inside, 0 * same], [-r, same, -t @ faces], [-t, 0 * same, same - r @ faces]])
        light = np.concatenate([self.eta**2 * (1 - self.inside), np.zeros(2 * n)])
        up = np.linalg.solve(matrix, np.broadcast_to(light, (len(r), 3 * n))[..., None])[:, 2 * n:, 0]
        out = (1 - self.inside) * up / self.eta**2
        lets = np.where(self.inside < 1 - 1e-12, self.weight, 0)
        return out[:, -2], out @ lets / lets.sum()

    def rho(self, reflection):
        out = np.linalg.solve(np.eye(len(self.mu)) - reflection * self.inside, reflection)
        kernel = out[:, -2, -1] / self.weight[-1]
        return (1 - self.inside[-2]) * (1 - self.inside[-1]) * kernel / self.eta**2


def lab_of_srgb(rgb):
    """CIELAB under D65 of linear sRGB, rows."""
    xyz = np.asarray(rgb) @ np.array([[0.4124564, 0.2126729, 0.0193339], [0.3575761, 0.7151522, 0.1191920], [0.1804375, 0.0721750, 0.9503041]])
    return lab_of_xyz(xyz / (0.9504700, 1.0000001, 1.0888300))


def lab_of_xyz(relative):
    f = np.where(relative > (6 / 29) ** 3, np.cbrt(relative), relative / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


def ciede2000(one, other):
    """Sharma, Wu, Dalal 2005; rows of CIELAB."""
    (l1, a1, b1), (l2, a2, b2) = np.asarray(one, float).T, np.asarray(other, float).T
    mean7 = ((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * np.sqrt(mean7 / (mean7 + 25.0**7))
    a1, a2 = a1 * stretch, a2 * stretch
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.degrees(np.arctan2(b1, a1)) % 360, np.degrees(np.arctan2(b2, a2)) % 360
    grey, gap, half = c1 * c2 == 0, h2 - h1, 180 + 1e-9
    turn = np.where(grey, 0, gap - 360 * np.sign(gap) * (np.abs(gap) > half))
    hue = np.where(grey, h1 + h2, np.where(np.abs(gap) <= half, (h1 + h2) / 2, (h1 + h2 + np.where(h1 + h2 < 360, 360, -360)) / 2))
    light, chroma = (l1 + l2) / 2, (c1 + c2) / 2
    cosine = lambda factor, shift: np.cos(np.radians(factor * hue + shift))
    t = 1 - 0.17 * cosine(1, -30) + 0.24 * cosine(2, 0) + 0.32 * cosine(3, 6) - 0.2 * cosine(4, -63)
    sl = 1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2)
    sc, sh = 1 + 0.045 * chroma, 1 + 0.015 * chroma * t
    rotation = -2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7)) * np.sin(np.radians(60 * np.exp(-(((hue - 275) / 25) ** 2))))
    dl, dc, dh = (l2 - l1) / sl, (c2 - c1) / sc, 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2)) / sh
    return np.sqrt(np.maximum(dl**2 + dc**2 + dh**2 + rotation * dc * dh, 0))
