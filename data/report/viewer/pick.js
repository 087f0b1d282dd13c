// What a line of sight meets: the nearest point of the surface and the place whose colour is shown there.

/// `plane`: what is beyond is cut away. Null where the line meets nothing, or nothing is unpacked yet.
const pick = (surface, ray, plane) => {
  if (surface.isPicture) return surface.covered ? pickPicture(surface, ray) : null;
  return surface.positions ? pickBody(surface, ray, plane) : null;
};

const pickPicture = (surface, ray) => {
  const { low, high, size, covered } = surface;
  const depth = (high[2] - ray.from[2]) / ray.along[2];
  const at = ray.from.map((x, a) => x + depth * ray.along[a]);
  const column = Math.floor(((at[0] - low[0]) / (high[0] - low[0])) * size[0]);
  const row = Math.floor(((high[1] - at[1]) / (high[1] - low[1])) * size[1]);
  if (column < 0 || row < 0 || column >= size[0] || row >= size[1]) return null;
  const place = row * size[0] + column;
  return covered[place] ? { at, place, normal: [0, 0, 1], column, row } : null;
};

/// Through what is clear, unless there is nothing else.
/// T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2 (1997), both sides.
const pickBody = (surface, ray, plane) => {
  const { triangles, clear } = surface;
  const end = triangles.length - clear;
  return pickAmong(surface, ray, plane, 0, end) || (clear ? pickAmong(surface, ray, plane, end, triangles.length) : null);
};

const pickAmong = (surface, ray, plane, first, end) => {
  const { positions: p, triangles } = surface;
  const [fx, fy, fz] = ray.from;
  const [dx, dy, dz] = ray.along;
  let nearest = Infinity;
  let found = -1;
  let foundU = 0;
  let foundV = 0;
  for (let t = first; t < end; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = dy * vz - dz * vy, hy = dz * vx - dx * vz, hz = dx * vy - dy * vx;
    const determinant = ux * hx + uy * hy + uz * hz;
    if (determinant === 0) continue;
    const sx = fx - p[a], sy = fy - p[a + 1], sz = fz - p[a + 2];
    const u = (sx * hx + sy * hy + sz * hz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / determinant;
    if (v < 0 || u + v > 1) continue;
    const depth = (vx * qx + vy * qy + vz * qz) / determinant;
    if (depth < 0 || depth >= nearest) continue;
    if (plane && plane[0] * (fx + depth * dx) + plane[1] * (fy + depth * dy) + plane[2] * (fz + depth * dz) > plane[3])
      continue;
    nearest = depth;
    found = t;
    foundU = u;
    foundV = v;
  }
  if (found < 0) return null;
  const weights = [1 - foundU - foundV, foundU, foundV];
  const corner = weights.indexOf(Math.max(...weights));
  const place = triangles[found + corner];
  return {
    at: ray.from.map((x, a) => x + nearest * ray.along[a]), place,
    normal: [...surface.normals.subarray(3 * place, 3 * place + 3)],
  };
};

/// The place nearest to a point of the surface.
const nearestPlace = (surface, ray, at, normal) => {
  if (surface.isPicture) return pickPicture(surface, ray);
  const { positions: p } = surface;
  let nearest = Infinity;
  let place = 0;
  for (let i = 0; i < surface.places; ++i) {
    const distance = Math.hypot(p[3 * i] - at[0], p[3 * i + 1] - at[1], p[3 * i + 2] - at[2]);
    if (distance >= nearest) continue;
    nearest = distance;
    place = i;
  }
  return { at, place, normal };
};
