// The printed voxels that the page carries: every step-th along each axis, and some layers whole. Columns run along +x,
// rows from the largest y, layers from the bottom; two voxels a byte. A layer is unpacked when it is first asked for.

class Voxels {
  constructor(packed) {
    this.packed = packed;
    this.size = packed.size;
    this.pitch = packed.pitch_mm;
    this.step = packed.step;
    this.first = packed.layers[0].number;
    this.columns = Math.ceil(this.size[0] / this.step[0]);
    this.rows = Math.ceil(this.size[1] / this.step[1]);
    this.rowBytes = (this.columns + 1) >> 1;
    this.layers = packed.layers.map(() => null);
    this.whole = new Map();
    this.complete = false;
  }

  async load(k) {
    if (!this.layers[k]) this.layers[k] = await inflated(this.packed.layers[k].data);
  }

  /// All layers, in slices between which keys and pointers are heard.
  async loadAll() {
    let since = performance.now();
    for (let k = 0; k < this.layers.length; ++k) {
      await this.load(k);
      if (performance.now() - since < 8) continue;
      await others();
      since = performance.now();
    }
    this.complete = true;
  }

  /// Of the thinned voxels that are unpacked; 0 is air.
  at(column, row, layer) {
    const byte = this.layers[layer][row * this.rowBytes + (column >> 1)];
    return column & 1 ? byte >> 4 : byte & 15;
  }

  /// At a place, mm from the corner of the print.
  material(x, y, z) {
    const column = Math.floor(x / this.pitch[0] / this.step[0]);
    const row = Math.floor((this.size[1] - y / this.pitch[1]) / this.step[1]);
    const layer = Math.floor((z / this.pitch[2] - this.first) / this.step[2]);
    const inside = column >= 0 && row >= 0 && layer >= 0 && column < this.columns && row < this.rows &&
      layer < this.layers.length;
    return inside ? this.at(column, row, layer) : 0;
  }

  /// How many places there are to cut along an axis, in voxels of the print.
  places(axis) {
    return axis === 2 ? this.packed.layers.length * this.step[2] : this.size[axis];
  }

  /// mm from the corner of the print to the middle of the voxels.
  height(axis, index) {
    return (index + 0.5 + (axis === 2 ? this.first : 0)) * this.pitch[axis];
  }

  /// A picture of materials: across along x (y where the cut is through x), down from the largest y (z where the cut is
  /// upright). `pitch`: of a pixel, mm; `origin`: the upper left corner's mm; `voxel`: which one a pixel stands for.
  async cut(axis, index) {
    if (axis === 2) {
      const number = this.first + index;
      const whole = this.packed.whole.find((layer) => layer.number === number);
      if (whole) return this.wholeLayer(whole);
    }
    const counts = [this.columns, this.rows, this.layers.length];
    // Rows count from the largest y.
    const along = axis === 1 ? Math.floor((this.size[1] - 1 - index) / this.step[1]) : Math.floor(index / this.step[axis]);
    const fixed = Math.min(counts[axis] - 1, Math.max(0, along));
    if (axis === 2) await this.load(fixed);
    else await this.loadAll();
    const across = axis === 0 ? 1 : 0;
    const down = axis === 2 ? 1 : 2;
    const picture = {
      width: counts[across], height: counts[down], step: [this.step[across], this.step[down]], across, down,
      materials: new Uint8Array(counts[across] * counts[down]),
      pitch: [this.step[across] * this.pitch[across], this.step[down] * this.pitch[down]],
      exact: this.step[across] === 1 && this.step[down] === 1 && this.step[axis] === 1,
    };
    const place = [0, 0, 0];
    place[axis] = fixed;
    for (let v = 0, i = 0; v < picture.height; ++v)
      for (let u = 0; u < picture.width; ++u, ++i) {
        // y runs against the rows, z against the lines of the picture.
        place[across] = across === 1 ? this.rows - 1 - u : u;
        place[down] = down === 2 ? picture.height - 1 - v : v;
        picture.materials[i] = this.at(place[0], place[1], place[2]);
      }
    return picture;
  }

  async wholeLayer(layer) {
    if (!this.whole.has(layer.number)) this.whole.set(layer.number, await inflated(layer.data));
    const bytes = this.whole.get(layer.number);
    const [width, height] = this.size;
    const rowBytes = (width + 1) >> 1;
    const materials = new Uint8Array(width * height);
    for (let v = 0, i = 0; v < height; ++v)
      for (let u = 0; u < width; ++u, ++i) {
        const byte = bytes[v * rowBytes + (u >> 1)];
        materials[i] = u & 1 ? byte >> 4 : byte & 15;
      }
    return { width, height, step: [1, 1], across: 0, down: 1, materials, pitch: [this.pitch[0], this.pitch[1]], exact: true };
  }

  /// Which resins lie under a place of the surface, by depth, and how thick the body is there: along the normal inward,
  /// on lines within `radius` of it. Shares of the resins between each two of `depths`.
  inward(place, normal, depths, radius) {
    const side = Math.abs(normal[2]) < 0.9 ? cross(normal, [0, 0, 1]) : cross(normal, [1, 0, 0]);
    const length = Math.hypot(...side);
    const u = side.map((x) => x / length);
    const v = cross(normal, u);
    const step = 0.5 * Math.min(...this.pitch.map((pitch, a) => pitch * this.step[a]));
    const shares = depths.slice(1).map(() => new Map());
    const lines = 5;
    for (let i = -lines; i <= lines; ++i)
      for (let j = -lines; j <= lines; ++j) {
        if (i * i + j * j > lines * lines) continue;
        const from = place.map((p, a) => p + (radius / lines) * (i * u[a] + j * v[a]));
        for (let d = 0; d < shares.length; ++d)
          for (let depth = depths[d]; depth < depths[d + 1]; depth += step) {
            const m = this.material(...from.map((p, a) => p - depth * normal[a]));
            if (m) shares[d].set(m, (shares[d].get(m) || 0) + 1);
          }
      }
    return { shares, thickness: this.thickness(place, normal, step) };
  }

  /// The place may lie a little outside of the staircase of voxels.
  thickness(place, normal, step) {
    const largest = Math.hypot(...this.size.map((n, a) => n * this.pitch[a]));
    const solid = (depth) => this.material(...place.map((p, a) => p - depth * normal[a])) > 0;
    let depth = step;
    const close = 2 * Math.max(...this.pitch.map((pitch, a) => pitch * this.step[a]));
    while (depth < close && !solid(depth)) depth += step;
    if (!solid(depth)) return 0;
    while (depth < largest && solid(depth)) depth += step;
    return depth;
  }
}
