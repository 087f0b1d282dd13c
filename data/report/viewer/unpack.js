// Numbers out of the page's data: base64, deflated, differences (io/report/viewer_data.h says how they were packed).

const bytesOf = (base64) => {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
};

const inflated = async (base64) => {
  const { readable, writable } = new DecompressionStream("deflate");
  const writer = writable.getWriter();
  const written = Promise.all([writer.write(bytesOf(base64)), writer.close()]);
  const [buffer] = await Promise.all([new Response(readable).arrayBuffer(), written]);
  return new Uint8Array(buffer);
};

/// Until what the browser has been asked for meanwhile is done: keys, pointers, frames.
const others = () => new Promise((done) => setTimeout(done));

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

/// Numbers of 16 bits.
const unpackNumbers = async (base64, count) => {
  const packed = await inflated(base64);
  return Uint16Array.from({ length: count }, (_, i) => packed[i] + 256 * packed[count + i]);
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
