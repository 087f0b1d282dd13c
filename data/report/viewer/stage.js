// The view of the surface: what is shown, from where, and what is under the pointer.

class Stage {
  /// Throws where there is no WebGL2.
  constructor(surface, probe) {
    this.surface = surface;
    this.probe = probe;
    this.canvas = document.getElementById("viewer-canvas");
    this.box = this.canvas.parentElement;
    this.divider = document.getElementById("viewer-divider");
    this.mark = document.getElementById("viewer-mark");
    this.scene = new Scene(this.canvas, surface);
    this.camera = new Camera(surface.low, surface.high, surface.isPicture);
    this.names = surface.looks.map((look) => look.name);
    this.compared = this.names.includes(surface.expected) ? surface.expected : this.names[this.names.length - 1];
    this.state = { left: this.names[0], right: this.compared, at: 0.5, divided: this.names.length > 1, lit: false };
    this.section = null;
    this.marked = null;
    this.addButtons();
    this.listen();
    /// Fulfilled with the first picture, rejected where it cannot be unpacked.
    this.drawn = new Promise((drawn, failed) => Object.assign(this, { succeed: drawn, fail: failed }));
    this.resize();
    this.camera.reset();
    this.update();
  }

  /// Unpacks a look and gives it to the scene, for which the browser may have to wait.
  async load(name) {
    await this.surface.fetchShape();
    await this.surface.fetchLook(name);
    if (!this.scene.has(name)) this.scene.add(this.surface.look(name));
  }

  addButtons() {
    const looks = document.getElementById("viewer-looks");
    this.lookButtons = this.surface.looks.map((look, i) =>
      addChoice(looks, `${i + 1} ${look.name}`, look.caption, () => this.show(look.name)));
    const views = document.getElementById("viewer-views");
    views.hidden = this.surface.isPicture;
    if (!this.surface.isPicture)
      for (const name of Object.keys(VIEWS)) addChoice(views, name, `the ${name} view`, () => this.look(name));
    this.compare = document.getElementById("viewer-compare");
    this.compare.hidden = this.names.length < 2;
    this.compare.addEventListener("click", () => this.toggleCompare());
    this.lit = document.getElementById("viewer-lit");
    this.lit.hidden = this.surface.isPicture;
    this.lit.addEventListener("click", () => this.toggleLight());
    document.getElementById("viewer-reset").addEventListener("click", () => this.reset());
  }

  listen() {
    followPointers(this.canvas, {
      drag: (dx, dy, event) => this.drag(dx, dy, event),
      pinch: (factor, x, y, dx, dy) => {
        this.zoom(factor, x, y);
        this.pan(dx, dy);
      },
      hover: (x, y) => this.probeAt(x, y),
    });
    this.canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== this.canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.pow(2, -event.deltaY / 300), event.offsetX, event.offsetY);
    }, { passive: false });
    this.canvas.addEventListener("dblclick", (event) => this.zoom(2, event.offsetX, event.offsetY));
    this.divider.addEventListener("pointerdown", (event) => this.divider.setPointerCapture(event.pointerId));
    this.divider.addEventListener("pointermove", (event) => {
      const { left, top, width } = this.canvas.getBoundingClientRect();
      if (this.divider.hasPointerCapture(event.pointerId)) this.divide((event.clientX - left) / width);
      else this.probeAt(event.clientX - left, event.clientY - top);
    });
    this.divider.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02 }[event.key];
      if (event.key === "Home") this.divide(0);
      else if (event.key === "End") this.divide(1);
      else if (by) this.divide(this.state.at + by);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    window.addEventListener("message", (event) => {
      if (window.parent === window || event.source !== window.parent || !event.data?.voxtoneView) return;
      this.camera.take(event.data.voxtoneView);
      this.isLed = true;
      this.update();
      this.isLed = false;
    });
  }

  /// Who shows two reports side by side (`voxtone serve`) turns both at once.
  tellFrame() {
    if (window.parent !== window && !this.isLed) window.parent.postMessage({ voxtoneView: this.camera.view() }, "*");
  }

  drag(dx, dy, event) {
    if (this.surface.isPicture || event.shiftKey || event.buttons & 6) this.pan(dx, dy);
    else this.orbit(-0.4 * dx, 0.4 * dy);
  }

  orbit(yaw, pitch) {
    this.camera.orbit(yaw, pitch);
    this.update();
  }

  /// By an arrow key: turns a body, moves a picture.
  step(x, y) {
    if (this.surface.isPicture) this.pan(60 * x, 60 * y);
    else this.orbit(-10 * x, 10 * y);
  }

  pan(dx, dy) {
    const perPx = 2 / this.canvas.clientHeight;
    this.camera.pan(-dx * perPx, dy * perPx);
    this.update();
  }

  zoom(factor, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    this.camera.zoom(factor, ...this.toView(x, y));
    this.update();
  }

  look(name) {
    this.camera.look(...VIEWS[name]);
    this.update();
  }

  reset() {
    this.camera.reset();
    this.marked = null;
    this.update();
  }

  /// One look alone.
  show(name) {
    if (name !== this.names[0]) this.compared = name;
    this.state = { ...this.state, left: name, right: name, divided: false };
    this.update();
  }

  toggleCompare() {
    const divided = !this.state.divided;
    const right = this.compared;
    this.state = { ...this.state, divided, left: divided ? this.names[0] : right, right };
    this.update();
  }

  /// Target for what is compared with it, and back; with a divider both change sides.
  flip() {
    if (this.names.length < 2) return;
    const { divided, left, right } = this.state;
    if (divided) this.state = { ...this.state, left: right, right: left };
    else this.show(right === this.names[0] ? this.compared : this.names[0]);
    this.update();
  }

  toggleLight() {
    if (this.surface.isPicture) return; // nothing to shade
    this.state.lit = !this.state.lit;
    this.update();
  }

  divide(at) {
    this.state.at = Math.min(1, Math.max(0, at));
    this.update();
  }

  /// Of cut.js: { axis, mm, ... } or null.
  cut(section) {
    this.section = section;
    this.update();
  }

  /// Turns to a place and marks it.
  visit(place, normal, span) {
    const size = Math.hypot(...this.surface.low.map((low, a) => this.surface.high[a] - low));
    this.camera.lookAt(place, normal, span || Math.min(10, size / 4));
    this.marked = place;
    // The place comes to the middle, where the divider would hide it and its mark: it is shown as printed.
    if (Math.abs(this.state.at - 0.5) < 0.1) this.state.at = 0.4;
    this.update();
    // Not along the line of sight: the tip of a thin part is easily missed.
    this.probe.show(nearestPlace(this.surface, this.camera.ray(0, 0), place, normal));
  }

  toView(x, y) {
    return [(2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight];
  }

  plane() {
    if (!this.section) return null;
    const { axis, mm } = this.section;
    const sign = this.camera.axes().towards[axis] >= 0 ? 1 : -1;
    const plane = [0, 0, 0, sign * mm];
    plane[axis] = sign;
    return plane;
  }

  probeAt(x, y) {
    this.probed = [x, y];
    if (this.probing) return;
    this.probing = true;
    requestAnimationFrame(() => {
      this.probing = false;
      this.probe.show(pick(this.surface, this.camera.ray(...this.toView(...this.probed)), this.plane()));
    });
  }

  probeMiddle() {
    this.probeAt(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
  }

  resize() {
    this.camera.aspect = Math.max(0.1, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
    this.update();
  }

  update() {
    this.tellFrame();
    const { left, right, divided, lit } = this.state;
    this.lookButtons.forEach((button, i) => press(button, !divided && this.names[i] === right));
    press(this.compare, divided);
    press(this.lit, lit);
    this.divider.hidden = !divided;
    this.divider.style.left = `${100 * this.state.at}%`;
    this.divider.setAttribute("aria-valuenow", String(Math.round(100 * this.state.at)));
    this.divider.children[0].textContent = left;
    this.divider.children[1].textContent = right;
    document.getElementById("viewer-legend").hidden = left !== "difference" && right !== "difference";
    this.describe(left, right);
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.draw());
  }

  /// In words what is shown.
  describe(left, right) {
    const words = [...new Set([left, right])].map((name) => {
      const { caption } = this.surface.look(name);
      return caption && caption !== name ? `${name}: ${caption}` : name;
    });
    document.getElementById("viewer-shown").textContent = words.join("; ") + ".";
  }

  draw() {
    this.waiting = false;
    const { left, right, divided, at, lit } = this.state;
    if (!this.scene.has(left) || !this.scene.has(right)) {
      // What is shown stays until what is wanted is there.
      this.load(left).then(() => this.load(right)).then(() => this.update(), this.fail);
      return;
    }
    const plane = this.plane();
    if (this.scene.section && plane) this.scene.section.plane = plane;
    this.scene.draw(this.camera, { left, right, divider: divided ? at : 0, lit });
    this.succeed();
    this.box.querySelector(".viewer-scale").hidden = !this.surface.toScale;
    if (this.surface.toScale) showScale(this.box, this.canvas.clientHeight / (2 * this.camera.halfHeight));
    this.mark.hidden = !this.marked;
    if (!this.marked) return;
    const [x, y] = this.camera.project(this.marked);
    this.mark.style.left = `${50 * (x + 1)}%`;
    this.mark.style.top = `${50 * (1 - y)}%`;
  }
}
