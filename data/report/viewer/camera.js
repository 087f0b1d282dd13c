// A camera without perspective that turns about the body: yaw about +z, then pitch. Views are named and turned as in
// the report's pictures (slicer/look/preview.h).

const VIEWS = {
  "three-quarter": [30, 30], front: [0, 0], right: [90, 0], back: [180, 0], left: [270, 0], top: [0, 90], bottom: [0, -90],
};

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

class Camera {
  constructor(low, high, flat) {
    this.low = low;
    this.high = high;
    this.flat = flat;
    this.aspect = 1;
    this.reset();
  }

  reset() {
    this.look(...(this.flat ? VIEWS.top : VIEWS["three-quarter"]));
  }

  /// From this direction, all of the body in view.
  look(yaw, pitch) {
    this.yaw = yaw;
    this.pitch = pitch;
    this.centre = this.low.map((x, a) => (x + this.high[a]) / 2);
    const size = this.low.map((x, a) => this.high[a] - x);
    const extent = (axis) => dot(axis.map(Math.abs), size);
    const { right, up } = this.axes();
    this.halfHeight = 0.53 * Math.max(extent(up), extent(right) / this.aspect);
  }

  axes() {
    const yaw = (this.yaw * Math.PI) / 180;
    const pitch = (this.pitch * Math.PI) / 180;
    const right = [Math.cos(yaw), Math.sin(yaw), 0];
    const towards = [Math.sin(yaw) * Math.cos(pitch), -Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch)];
    return { right, towards, up: cross(towards, right) };
  }

  orbit(byYaw, byPitch) {
    if (this.flat) return;
    this.yaw = (this.yaw + byYaw + 360) % 360;
    this.pitch = Math.min(90, Math.max(-90, this.pitch + byPitch));
  }

  /// In halves of the view's height.
  pan(byRight, byUp) {
    const { right, up } = this.axes();
    this.centre = this.centre.map((x, a) => x + this.halfHeight * (byRight * right[a] + byUp * up[a]));
  }

  /// What is at (x, y) of the view, in [-1, 1], stays there.
  zoom(factor, x = 0, y = 0) {
    const before = this.halfHeight;
    const largest = 2 * Math.hypot(...this.low.map((low, a) => this.high[a] - low));
    this.halfHeight = Math.min(largest, Math.max(0.2, before / factor));
    const by = before / this.halfHeight - 1;
    this.pan(x * this.aspect * by, y * by);
  }

  /// For another body's camera: place and size as parts of this body's box.
  view() {
    const size = this.low.map((low, a) => this.high[a] - low || 1);
    return { yaw: this.yaw, pitch: this.pitch, zoom: this.halfHeight / Math.hypot(...size),
             centre: this.centre.map((x, a) => (x - this.low[a]) / size[a]) };
  }

  /// Nothing happens where that is no view.
  take({ yaw, pitch, zoom, centre }) {
    if (![yaw, pitch, zoom, ...(Array.isArray(centre) && centre.length === 3 ? centre : [NaN])].every(Number.isFinite) || zoom <= 0) return;
    const size = this.low.map((low, a) => this.high[a] - low || 1);
    if (!this.flat) Object.assign(this, { yaw, pitch });
    this.halfHeight = zoom * Math.hypot(...size);
    this.centre = centre.map((x, a) => this.low[a] + x * size[a]);
  }

  /// Looks at a place along its normal, so that `mm` of it fill the view.
  lookAt(place, normal, mm) {
    if (!this.flat) {
      this.pitch = (Math.asin(Math.min(1, Math.max(-1, normal[2]))) * 180) / Math.PI;
      if (Math.hypot(normal[0], normal[1]) > 0.05)
        this.yaw = ((Math.atan2(normal[0], -normal[1]) * 180) / Math.PI + 360) % 360;
    }
    this.centre = [...place];
    this.halfHeight = mm / 2;
  }

  /// Column by column, for WebGL.
  matrix() {
    const { right, up, towards } = this.axes();
    const depth = 4 * Math.hypot(...this.low.map((low, a) => this.high[a] - low)) + 1;
    const rows = [
      [right, 1 / (this.halfHeight * this.aspect)],
      [up, 1 / this.halfHeight],
      [towards, -1 / depth],
    ];
    const matrix = new Float32Array(16);
    rows.forEach(([axis, scale], row) => {
      for (let a = 0; a < 3; ++a) matrix[4 * a + row] = scale * axis[a];
      matrix[12 + row] = -scale * dot(axis, this.centre);
    });
    matrix[15] = 1;
    return matrix;
  }

  /// The line of sight through (x, y) of the view, in [-1, 1].
  ray(x, y) {
    const { right, up, towards } = this.axes();
    const far = 4 * Math.hypot(...this.low.map((low, a) => this.high[a] - low)) + 1;
    const from = this.centre.map(
      (c, a) => c + this.halfHeight * (x * this.aspect * right[a] + y * up[a]) + far * towards[a]);
    return { from, along: towards.map((t) => -t) };
  }

  /// Where a point is in the view, in [-1, 1].
  project(point) {
    const { right, up } = this.axes();
    const from = point.map((p, a) => p - this.centre[a]);
    return [dot(right, from) / (this.halfHeight * this.aspect), dot(up, from) / this.halfHeight];
  }
}
