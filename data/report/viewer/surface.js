// The surface and what is known of its places, unpacked when it is first asked for: the first picture needs two looks.

class Surface {
  /// `distance`: from where the print is seen, mm.
  constructor(packed, distance) {
    this.packed = packed;
    this.low = packed.low_mm;
    this.high = packed.high_mm;
    this.places = packed.places;
    this.placeMm = packed.place_mm;
    this.note = packed.note;
    /// Of a body: so many of the last indices of its triangles are of what is seen through.
    this.clear = packed.clear || 0;
    this.isPicture = Boolean(packed.size_px);
    this.size = packed.size_px;
    /// Names of the looks that are compared.
    this.asked = packed.asked;
    this.expected = packed.expected;
    this.toScale = packed.to_scale;
    /// Of a picture: what has a name and figures of its own.
    this.parts = packed.parts || [];
    this.looks = packed.looks.map(({ name, caption }) => ({ name, caption }));
    this.fetched = new Map();
    if (packed.seen || packed.single) this.addDifference(packed.seen ? ` as seen from ${distance} mm` : "");
  }

  addDifference(where) {
    const caption = `CIEDE2000${where}: white 0, yellow 2, orange 5, red 10, black 20 and more`;
    // Before what is no colour of the print.
    const support = this.looks.findIndex((look) => look.name === "support");
    this.looks.splice(support < 0 ? this.looks.length : support, 0, { name: "difference", caption });
  }

  look(name) {
    return this.looks.find((look) => look.name === name);
  }

  /// What `unpack` does is done once, whoever asks.
  once(name, unpack) {
    if (!this.fetched.has(name)) this.fetched.set(name, unpack());
    return this.fetched.get(name);
  }

  /// Where the places are: `positions` and `triangles` of a body, `covered` of a picture.
  fetchShape() {
    return this.once("the shape", async () => {
      const { packed } = this;
      if (this.isPicture) {
        this.covered = await inflated(packed.covered);
        if (packed.part_of) this.partOf = await unpackNumbers(packed.part_of, packed.places);
      } else {
        this.triangles = await unpackTriangles(packed.triangles, packed.indices);
        this.positions = await unpackPositions(packed.positions, packed.places, packed.low_mm, packed.high_mm);
      }
    });
  }

  /// The `rgb` of a look.
  fetchLook(name) {
    return this.once(`look ${name}`, async () => {
      if (name === "difference") await this.fetchDifferences();
      const packed = this.packed.looks.find((look) => look.name === name);
      this.look(name).rgb = packed
        ? await unpackColours(packed.rgb, this.places)
        : differenceLook(this.seen || this.single);
    });
  }

  /// `seen` and `single`, where there are such.
  fetchDifferences() {
    return this.once("differences", async () => {
      if (this.packed.seen) this.seen = await inflated(this.packed.seen);
      if (this.packed.single) this.single = await inflated(this.packed.single);
    });
  }

  /// Which part a place belongs to; undefined: none.
  partAt(place) {
    return this.partOf && this.parts[this.partOf[place] - 1];
  }

  get normals() {
    if (!this.madeNormals) this.madeNormals = normalsOf(this.positions, this.triangles);
    return this.madeNormals;
  }
}

/// Of vertices: the mean of their triangles', by area.
const normalsOf = (positions, triangles) => {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const i of [a, b, c]) {
      normals[i] += nx;
      normals[i + 1] += ny;
      normals[i + 2] += nz;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    normals[i] /= length;
    normals[i + 1] /= length;
    normals[i + 2] /= length;
  }
  return normals;
};
