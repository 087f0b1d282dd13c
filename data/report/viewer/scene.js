// The surface in WebGL2: two looks left and right of a divider, unlit or lit, cut by a plane on which the resins show.
// A body has one colour a vertex, a picture one texel a pixel.

const VERTEX_SHADER = `#version 300 es
uniform mat4 toClip;
in vec3 place, normal;
in vec3 leftColour, rightColour;
in vec2 texel;
out vec3 at, facing, left, right;
out vec2 uv;
void main() {
  at = place;
  facing = normal;
  left = leftColour;
  right = rightColour;
  uv = texel;
  gl_Position = toClip * vec4(place, 1.0);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
uniform float divider;      // px from the left
uniform vec3 light;         // towards it; zero: none
uniform vec3 towards;       // the viewer
uniform vec4 cut;           // what is beyond it is not drawn
uniform bool textured;
uniform sampler2D leftTexture, rightTexture;
uniform float opacity;
in vec3 at, facing, left, right;
in vec2 uv;
out vec4 colour;
void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
  bool first = gl_FragCoord.x < divider;
  vec4 shown = vec4(first ? left : right, 1.0);
  if (textured) shown = first ? texture(leftTexture, uv) : texture(rightTexture, uv);
  if (shown.a < 0.5) discard;
  if (light != vec3(0)) {
    vec3 n = normalize(facing);
    if (dot(n, towards) < 0.0) n = -n;
    shown.rgb *= 0.35 + 0.65 * max(0.0, dot(n, light));
  }
  // What is clear is seen most where one looks along it.
  float shown_part = opacity;
  if (opacity < 1.0) shown_part = mix(0.5, opacity, abs(dot(normalize(facing), towards)));
  colour = vec4(shown.rgb, 1.0) * shown_part;
}`;

const ATTRIBUTES = ["place", "normal", "leftColour", "rightColour", "texel"];

/// Whether pictures are made by the processor, for which smoothing edges takes longer than all the rest of a picture.
const drawsInSoftware = () => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  let name = gl.getParameter(gl.RENDERER);
  const more = name === "WebKit WebGL" && gl.getExtension("WEBGL_debug_renderer_info");
  if (more) name = gl.getParameter(more.UNMASKED_RENDERER_WEBGL);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
};

class Scene {
  /// Throws where there is no WebGL2.
  constructor(canvas, surface) {
    const antialias = !drawsInSoftware();
    const gl = canvas.getContext("webgl2", { antialias, alpha: true, premultipliedAlpha: true });
    if (!gl) throw new Error("no WebGL2");
    this.gl = gl;
    this.canvas = canvas;
    this.surface = surface;
    this.program = this.link();
    this.uniforms = {};
    for (const name of ["toClip", "divider", "light", "towards", "cut", "textured", "leftTexture", "rightTexture", "opacity"])
      this.uniforms[name] = gl.getUniformLocation(this.program, name);
    this.looks = new Map();
    this.array = null;
    this.section = null;
  }

  link() {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ATTRIBUTES.forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("the shaders do not link");
    return program;
  }

  buffer(values, target = this.gl.ARRAY_BUFFER) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, values, this.gl.STATIC_DRAW);
    return buffer;
  }

  attribute(name, buffer, size, type, normalised = false) {
    const gl = this.gl;
    const at = ATTRIBUTES.indexOf(name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, type, normalised, 0, 0);
  }

  has(name) {
    return this.looks.has(name);
  }

  /// A look that the surface has unpacked, and with the first one the surface itself.
  add({ name, rgb }) {
    if (this.surface.isPicture) {
      if (!this.array) this.addRectangle();
      this.looks.set(name, this.pictureTexture(rgb));
    } else {
      if (!this.array) this.addBody();
      this.looks.set(name, this.buffer(rgb));
    }
  }

  addBody() {
    const gl = this.gl;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    this.attribute("place", this.buffer(this.surface.positions), 3, gl.FLOAT);
    this.buffer(this.surface.triangles, gl.ELEMENT_ARRAY_BUFFER);
  }

  /// Only light needs them.
  addNormals() {
    this.normalBuffer = this.buffer(this.surface.normals);
    this.gl.bindVertexArray(this.array);
    this.attribute("normal", this.normalBuffer, 3, this.gl.FLOAT);
  }

  /// A rectangle in the plane of the box's upper side.
  rectangle(corners) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute("place", this.buffer(new Float32Array(corners.flat())), 3, gl.FLOAT);
    this.attribute("texel", this.buffer(new Float32Array([0, 0, 1, 0, 0, 1, 1, 1])), 2, gl.FLOAT);
    return array;
  }

  texture(width, height, rgba, mipmaps) {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, mipmaps ? gl.LINEAR_MIPMAP_LINEAR : gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    if (mipmaps) gl.generateMipmap(gl.TEXTURE_2D);
    return texture;
  }

  addRectangle() {
    const { low, high } = this.surface;
    const z = high[2];
    this.array = this.rectangle([[low[0], high[1], z], [high[0], high[1], z], [low[0], low[1], z], [high[0], low[1], z]]);
  }

  pictureTexture(rgb) {
    const { size, covered } = this.surface;
    const rgba = new Uint8Array(4 * covered.length);
    for (let i = 0, from = 0, to = 0; i < covered.length; ++i) {
      rgba[to++] = rgb[from++];
      rgba[to++] = rgb[from++];
      rgba[to++] = rgb[from++];
      rgba[to++] = covered[i] ? 255 : 0;
    }
    return this.texture(size[0], size[1], rgba, true);
  }

  /// The resins on the plane of a cut: `corners` upper left, upper right, lower left, lower right; null: no cut.
  showSection(section) {
    const gl = this.gl;
    if (this.section) {
      gl.deleteTexture(this.section.texture);
      gl.deleteVertexArray(this.section.array);
    }
    this.section = section && {
      array: this.rectangle(section.corners),
      texture: this.texture(section.width, section.height, section.rgba, false),
      plane: section.plane,
    };
  }

  /// `state`: left, right (names of looks that it has), divider in [0, 1], lit, background (three shares).
  draw(camera, state) {
    const gl = this.gl;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    const { right, up, towards } = camera.axes();
    const light = right.map((r, a) => 0.25 * r + 0.75 * up[a] + 0.6 * towards[a]);
    const length = Math.hypot(...light);
    gl.uniformMatrix4fv(this.uniforms.toClip, false, camera.matrix());
    gl.uniform1f(this.uniforms.divider, state.divider * width);
    gl.uniform3fv(this.uniforms.light, state.lit ? light.map((x) => x / length) : [0, 0, 0]);
    gl.uniform3fv(this.uniforms.towards, towards);
    gl.uniform4fv(this.uniforms.cut, this.section ? this.section.plane : [0, 0, 0, 1]);
    gl.uniform1i(this.uniforms.leftTexture, 0);
    gl.uniform1i(this.uniforms.rightTexture, 1);
    gl.uniform1f(this.uniforms.opacity, 1);
    this.drawSurface(state);
    if (this.section) this.drawSection();
    if (this.surface.clear) this.drawClear(state);
  }

  drawSurface(state) {
    const gl = this.gl;
    const left = this.looks.get(state.left);
    const right = this.looks.get(state.right);
    gl.bindVertexArray(this.array);
    gl.uniform1i(this.uniforms.textured, this.surface.isPicture ? 1 : 0);
    if ((state.lit || this.surface.clear) && !this.surface.isPicture && !this.normalBuffer) this.addNormals();
    if (this.surface.isPicture) {
      this.bindTextures(left, right);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      return;
    }
    this.attribute("leftColour", left, 3, gl.UNSIGNED_BYTE, true);
    this.attribute("rightColour", right, 3, gl.UNSIGNED_BYTE, true);
    this.bindTextures(this.blank(), this.blank());
    gl.drawElements(gl.TRIANGLES, this.surface.triangles.length - this.surface.clear, gl.UNSIGNED_INT, 0);
  }

  /// Over all that is behind it or in it, and hides nothing.
  drawClear(state) {
    const gl = this.gl;
    gl.bindVertexArray(this.array);
    gl.uniform1i(this.uniforms.textured, 0);
    gl.uniform4fv(this.uniforms.cut, this.section ? this.section.plane : [0, 0, 0, 1]);
    gl.uniform1f(this.uniforms.opacity, 0.12);
    this.attribute("leftColour", this.looks.get(state.left), 3, gl.UNSIGNED_BYTE, true);
    this.attribute("rightColour", this.looks.get(state.right), 3, gl.UNSIGNED_BYTE, true);
    this.bindTextures(this.blank(), this.blank());
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    const { length } = this.surface.triangles;
    gl.drawElements(gl.TRIANGLES, this.surface.clear, gl.UNSIGNED_INT, 4 * (length - this.surface.clear));
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawSection() {
    const gl = this.gl;
    gl.bindVertexArray(this.section.array);
    gl.uniform1i(this.uniforms.textured, 1);
    gl.uniform3fv(this.uniforms.light, [0, 0, 0]);
    gl.uniform4fv(this.uniforms.cut, [0, 0, 0, 1]);
    this.bindTextures(this.section.texture, this.section.texture);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  bindTextures(left, right) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, left);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, right);
    gl.activeTexture(gl.TEXTURE0);
  }

  /// What is bound where nothing is looked up.
  blank() {
    if (!this.blankTexture) this.blankTexture = this.texture(1, 1, new Uint8Array(4), false);
    return this.blankTexture;
  }
}
