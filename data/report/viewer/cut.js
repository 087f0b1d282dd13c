// A plane through the printed voxels, along each axis: as a picture of single voxels, and in the body above.

const CUT_AXES = [
  { axis: 2, name: "layer", words: "a layer, from above" },
  { axis: 1, name: "front", words: "upright, from the front" },
  { axis: 0, name: "side", words: "upright, from the right" },
];

class Cut {
  /// `top`: begins with the uppermost layer, where a picture is.
  constructor(voxels, resins, top) {
    this.voxels = voxels;
    this.resins = resins;
    this.canvas = document.getElementById("cut-canvas");
    this.box = this.canvas.parentElement;
    this.slider = document.getElementById("cut-slider");
    this.label = document.getElementById("cut-label");
    this.stage = null;
    this.inView = false;
    this.indices = [0, 1, 2].map((axis) => Math.floor(voxels.places(axis) / 2));
    if (top) this.indices[2] = voxels.places(2) - 1;
    this.zoomed = 1;
    this.middle = [0.5, 0.5];
    this.image = document.createElement("canvas");
    this.addButtons();
    this.listen();
    this.describe();
    this.turn(2);
  }

  addButtons() {
    const axes = document.getElementById("cut-axes");
    this.axisButtons = CUT_AXES.map(({ axis, name, words }) => addChoice(axes, name, words, () => this.turn(axis)));
    const on = (id, act) => document.getElementById(id).addEventListener("click", act);
    on("cut-back", () => this.move(-1));
    on("cut-on", () => this.move(1));
    on("cut-closer", () => this.zoom(2));
    on("cut-farther", () => this.zoom(0.5));
    on("cut-fit", () => this.fit());
    on("cut-in-view", () => this.toggleInView());
    this.inViewButton = document.getElementById("cut-in-view");
  }

  listen() {
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    followPointers(this.canvas, {
      drag: (dx, dy) => this.pan(dx, dy),
      pinch: (factor, x, y, dx, dy) => {
        this.zoom(factor, x, y);
        this.pan(dx, dy);
      },
      hover: (x, y) => this.point(x, y),
    });
    this.canvas.addEventListener("wheel", (event) => {
      if (event.ctrlKey) this.zoom(Math.pow(2, -event.deltaY / 200), event.offsetX, event.offsetY);
      else if (document.activeElement === this.canvas) this.move(event.deltaY > 0 ? -1 : 1);
      else return;
      event.preventDefault();
    }, { passive: false });
    this.canvas.addEventListener("dblclick", (event) => this.zoom(2, event.offsetX, event.offsetY));
    this.canvas.addEventListener("keydown", (event) => {
      const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 20, PageDown: -20 };
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (steps[event.key]) this.move(steps[event.key]);
      else if (event.key === "Home") this.go(0);
      else if (event.key === "End") this.go(this.voxels.places(this.axis) - 1);
      else if (event.key === "+" || event.key === "=") this.zoom(2);
      else if (event.key === "-") this.zoom(0.5);
      else if (event.key === "0") this.fit();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /// What is carried of the print.
  describe() {
    const { step, size, packed } = this.voxels;
    const words = step.map((s) => ["", "every", "every second", "every third"][s] || `every ${s}th`);
    const carried = step.every((s) => s === 1)
      ? "The page carries every voxel"
      : `The page carries ${words[0]} voxel along x, ${words[1]} along y and ${words[2]} layer`;
    const whole = packed.whole.length ? `, and ${packed.whole.length} of the ${size[2]} layers whole` : "";
    const more = packed.layer_file ? "; the bitmaps of all layers lie in the folder beside it" : "";
    document.getElementById("cut-note").textContent =
      `${carried}${whole}${more}. Colours are the resins' in the bitmaps, not those that are seen.`;
    const legend = document.getElementById("cut-resins");
    for (const resin of this.resins) {
      const swatch = element("span");
      swatch.className = "swatch";
      swatch.style.background = cssOf(resin.rgb);
      const entry = element("span");
      entry.append(swatch, `${resin.role ? resin.role + " " : ""}${resin.name}`);
      legend.append(entry);
    }
  }

  turn(axis) {
    this.axis = axis;
    this.axisButtons.forEach((button, i) => press(button, CUT_AXES[i].axis === axis));
    this.slider.max = String(this.voxels.places(axis) - 1);
    this.fit();
    this.go(this.indices[axis]);
  }

  move(by) {
    // Between two that the page carries there is nothing new to see.
    const step = this.axis === 2 ? 1 : this.voxels.step[this.axis];
    this.go(this.indices[this.axis] + by * step);
  }

  async go(index) {
    const axis = this.axis;
    this.indices[axis] = Math.min(this.voxels.places(axis) - 1, Math.max(0, index));
    const wanted = this.indices[axis];
    this.slider.value = String(wanted);
    this.slider.setAttribute("aria-valuetext", this.text());
    this.showLabel();
    const picture = await this.voxels.cut(axis, wanted);
    if (axis !== this.axis || wanted !== this.indices[axis]) return;
    this.picture = picture;
    this.paint();
    this.draw();
    this.showInView();
    this.canvas.dataset.shown = `${axis} ${wanted} ${picture.exact}`;
  }

  text() {
    const index = this.indices[this.axis];
    const mm = `${this.voxels.height(this.axis, index).toFixed(3)} mm`;
    if (this.axis === 2) return `layer ${this.voxels.first + index}, z = ${mm}`;
    return `${this.axis === 1 ? "y" : "x"} = ${mm}`;
  }

  showLabel() {
    this.label.textContent = this.text();
    const place = document.getElementById("cut-link");
    place.replaceChildren();
    if (this.axis !== 2 || !this.voxels.packed.layer_file) return;
    const link = element("a", "The bitmap of this layer");
    const digits = String(this.indices[2]).padStart(5, "0");
    link.href = this.voxels.packed.layer_file.replace("%05d", digits);
    place.append(link, " lies beside the page.");
  }

  /// The picture's pixels, air transparent.
  paint() {
    const { width, height, materials } = this.picture;
    const table = new Uint8ClampedArray(4 * 16);
    this.resins.forEach((resin, r) => table.set([...resin.rgb, 255], 4 * (r + 1)));
    const rgba = new Uint8ClampedArray(4 * width * height);
    for (let i = 0; i < materials.length; ++i) rgba.set(table.subarray(4 * materials[i], 4 * materials[i] + 4), 4 * i);
    this.rgba = rgba;
    this.image.width = width;
    this.image.height = height;
    this.image.getContext("2d").putImageData(new ImageData(rgba, width, height), 0, 0);
  }

  /// px of the page per mm, and where the picture's upper left corner lies.
  frame() {
    const { width, height, pitch } = this.picture;
    const [w, h] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const mm = [width * pitch[0], height * pitch[1]];
    const scale = 0.94 * Math.min(w / mm[0], h / mm[1]) * this.zoomed;
    return { scale, left: w / 2 - this.middle[0] * mm[0] * scale, top: h / 2 - this.middle[1] * mm[1] * scale, mm };
  }

  draw() {
    if (!this.picture) return;
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    this.canvas.height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    const context = this.canvas.getContext("2d");
    const { scale, left, top, mm } = this.frame();
    context.scale(ratio, ratio);
    // Smaller than pixels they are averaged, larger they are squares.
    context.imageSmoothingEnabled = scale * Math.min(...this.picture.pitch) < 0.7;
    context.imageSmoothingQuality = "high";
    context.drawImage(this.image, left, top, mm[0] * scale, mm[1] * scale);
    showScale(this.box, scale);
  }

  zoom(factor, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    if (!this.picture) return;
    const before = this.frame();
    // Until a voxel is 60 px wide.
    const closest = Math.max(1, (60 / Math.min(...this.voxels.pitch) / before.scale) * this.zoomed);
    this.zoomed = Math.min(closest, Math.max(0.5, this.zoomed * factor));
    const after = this.frame();
    const by = 1 / before.scale - 1 / after.scale;
    this.middle[0] += ((x - this.canvas.clientWidth / 2) * by) / before.mm[0];
    this.middle[1] += ((y - this.canvas.clientHeight / 2) * by) / before.mm[1];
    this.draw();
  }

  pan(dx, dy) {
    const { scale, mm } = this.frame();
    this.middle[0] -= dx / scale / mm[0];
    this.middle[1] -= dy / scale / mm[1];
    this.draw();
  }

  fit() {
    this.zoomed = 1;
    this.middle = [0.5, 0.5];
    this.draw();
  }

  point(x, y) {
    if (!this.picture) return;
    const { width, height, pitch, materials, across, down } = this.picture;
    const { scale, left, top } = this.frame();
    const u = Math.floor((x - left) / scale / pitch[0]);
    const v = Math.floor((y - top) / scale / pitch[1]);
    const words = document.getElementById("cut-probe");
    if (u < 0 || v < 0 || u >= width || v >= height) {
      words.textContent = "Point at the cut to see the resin of a voxel.";
      return;
    }
    const resin = this.resins[materials[v * width + u] - 1];
    const step = this.picture.step;
    const place = [0, 0, 0];
    place[this.axis] = this.indices[this.axis] + (this.axis === 2 ? this.voxels.first : 0);
    place[across] = across === 1 ? this.voxels.size[1] - 1 - (width - 1 - u) * step[0] : u * step[0];
    place[down] = down === 2 ? this.voxels.first + (height - 1 - v) * step[1] : this.voxels.size[1] - 1 - v * step[1];
    words.textContent = `${resin ? `${resin.name} (${resin.role})` : "nothing"}: voxel x ${place[0]}, y ${place[1]}, layer ${place[2]}`;
  }

  toggleInView() {
    this.inView = !this.inView && Boolean(this.stage);
    press(this.inViewButton, this.inView);
    this.showInView();
  }

  /// The same plane in the body.
  showInView() {
    if (!this.stage) return;
    if (!this.inView || !this.picture) {
      if (!this.stage.section) return;
      this.stage.scene.showSection(null);
      this.stage.cut(null);
      return;
    }
    const { width, height, pitch } = this.picture;
    const size = this.voxels.size.map((n, a) => n * this.voxels.pitch[a]);
    const mm = this.voxels.height(this.axis, this.indices[this.axis]);
    const bottom = this.voxels.first * this.voxels.pitch[2];
    // Rows and columns that the last step sticks out by are behind the picture's far ends.
    const across = width * pitch[0];
    const down = height * pitch[1];
    const corner = {
      2: (u, v) => [u * across, size[1] - v * down, mm],
      1: (u, v) => [u * across, mm, bottom + (1 - v) * down],
      0: (u, v) => [mm, size[1] - (1 - u) * across, bottom + (1 - v) * down],
    }[this.axis];
    this.stage.scene.showSection({
      corners: [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)], width, height,
      rgba: new Uint8Array(this.rgba.buffer), plane: [0, 0, 0, 1],
    });
    this.stage.cut({ axis: this.axis, mm });
  }
}
