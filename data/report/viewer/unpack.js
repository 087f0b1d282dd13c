// Numbers out of the page's data: base64, deflated, differences (io/report/viewer_data.h says how they were packed).

const bytesOf = (base64) => {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
};

const inflated = async (base64) => {
  const stream = new Blob([bytesOf(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

/// Three codes a place.
const unpackColours = async (base64, places) => {
  const packed = await inflated(base64);
  const rgb = new Uint8Array(3 * places);
  for (let c = 0; c < 3; ++c) {
    let code = 0;
    for (let i = 0; i < places; ++i) rgb[3 * i + c] = code = (code + packed[c * places + i]) & 255;
  }
  return rgb;
};

/// Three coordinates a vertex, mm.
const unpackPositions = async (base64, count, low, high) => {
  const packed = await inflated(base64);
  const positions = new Float32Array(3 * count);
  for (let c = 0; c < 3; ++c) {
    const scale = (high[c] - low[c]) / 65535;
    let at = 0;
    for (let i = 0; i < count; ++i) {
      at = (at + packed[2 * c * count + i] + 256 * packed[(2 * c + 1) * count + i]) & 65535;
      positions[3 * i + c] = low[c] + scale * at;
    }
  }
  return positions;
};

/// Three vertices a triangle.
const unpackTriangles = async (base64, indices) => {
  const packed = await inflated(base64);
  const triangles = new Uint32Array(indices);
  let at = 0;
  let index = 0;
  for (let i = 0; i < indices; ++i) {
    let zigzag = 0;
    let shift = 0;
    let byte;
    do {
      byte = packed[at++];
      zigzag |= (byte & 127) << shift;
      shift += 7;
    } while (byte > 127);
    index += zigzag & 1 ? -((zigzag + 1) >>> 1) : zigzag >>> 1;
    triangles[i] = index;
  }
  return triangles;
};

/// The surface with all that is known of its places.
const unpackSurface = async (packed) => {
  const surface = {
    low: packed.low_mm, high: packed.high_mm, places: packed.places, placeMm: packed.place_mm, note: packed.note,
    isPicture: Boolean(packed.size_px), size: packed.size_px,
  };
  if (surface.isPicture) {
    surface.covered = await inflated(packed.covered);
  } else {
    surface.positions = await unpackPositions(packed.positions, packed.places, packed.low_mm, packed.high_mm);
    surface.triangles = await unpackTriangles(packed.triangles, packed.indices);
  }
  surface.looks = [];
  for (const { name, caption, rgb } of packed.looks)
    surface.looks.push({ name, caption, rgb: await unpackColours(rgb, packed.places) });
  if (packed.seen) surface.seen = await inflated(packed.seen);
  if (packed.single) surface.single = await inflated(packed.single);
  return surface;
};
