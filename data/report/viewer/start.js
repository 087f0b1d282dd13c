// Where the page comes to life. Without it, or where a browser lacks WebGL2, the page shows fixed views.

/// `tools`: the cut once there is one.
const listenToKeys = (stage, tools) => {
  const keys = {
    " ": () => stage.flip(), d: () => stage.toggleCompare(), l: () => stage.toggleLight(), 0: () => stage.reset(),
    p: () => stage.probeMiddle(), "+": () => stage.zoom(1.25), "=": () => stage.zoom(1.25), "-": () => stage.zoom(0.8),
    ArrowLeft: () => stage.step(1, 0), ArrowRight: () => stage.step(-1, 0),
    ArrowUp: () => stage.step(0, 1), ArrowDown: () => stage.step(0, -1),
    c: () => tools.cut && tools.cut.toggleInView(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    // Buttons and sliders keep what they take themselves; digits and letters act everywhere.
    const on = event.target;
    if (on.tagName === "INPUT" || (event.key === " " && on.closest("button, a, summary"))) return;
    if (event.key.startsWith("Arrow") && on !== stage.canvas) return;
    const look = stage.names[Number(event.key) - 1];
    if (look) stage.show(look);
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  });
};

const KEYS_OF_BODIES =
  "1, 2, 3 … show one alone; space flips; d compares with a divider (arrows move it where it has the focus); drag or " +
  "arrows turn; shift with drag pans; wheel (after a click), pinch, + and − zoom; 0 resets; l lights; p probes the " +
  "middle";
const KEYS_OF_PICTURES =
  "1, 2, 3 … show one alone; space flips; d compares with a divider (arrows move it where it has the focus); drag or " +
  "arrows pan; wheel (after a click), pinch, + and − zoom; 0 resets; p probes the middle";

const showWorst = (stage, worst) => {
  for (const button of document.querySelectorAll("button.place")) {
    const place = button.dataset.at
      ? { at_mm: JSON.parse(button.dataset.at), normal: JSON.parse(button.dataset.normal) }
      : worst[Number(button.dataset.place)];
    button.disabled = false;
    button.addEventListener("click", () => {
      stage.visit(place.at_mm, place.normal, place.span_mm);
      document.getElementById("viewer").scrollIntoView({ block: "nearest" });
    });
  }
};

const startStage = (surface, data) => {
  const section = document.getElementById("viewer");
  section.hidden = false;
  document.documentElement.classList.add("has-viewer");
  try {
    const stage = new Stage(surface, new Probe(surface, data.resins, data.viewing_distance_mm));
    section.querySelector("h2").textContent = data.heading;
    document.getElementById("viewer-note").textContent = `${surface.note} ${data.about}`;
    document.getElementById("viewer-keys").textContent =
      `${surface.isPicture ? KEYS_OF_PICTURES : KEYS_OF_BODIES}${data.cut ? "; c cuts the body" : ""}.`;
    if (surface.parts.length)
      document.getElementById("probe-hint").textContent = "Point at a square, or press p for the middle.";
    stage.canvas.addEventListener("webglcontextlost", endStage);
    return stage;
  } catch {
    endStage();
    return null;
  }
};

const endStage = () => {
  document.getElementById("viewer").hidden = true;
  document.documentElement.classList.remove("has-viewer");
};

/// Milliseconds since the page was asked for.
const note = (what) => {
  document.documentElement.dataset[what] = String(Math.ceil(performance.now()));
};

/// The voxels, which stand at the end of the page.
const startCut = (data, stage) => {
  const text = document.getElementById("voxel-data");
  const packed = text && JSON.parse(text.textContent);
  if (!packed || !packed.layers.length) return null;
  document.getElementById("cut").hidden = false;
  document.documentElement.classList.add("has-cut");
  const cut = new Cut(new Voxels(packed), data.resins, Boolean(data.surface && data.surface.size_px));
  cut.stage = stage;
  cut.inViewButton.hidden = !stage;
  if (stage) stage.probe.voxels = cut.voxels;
  return cut;
};

/// What the first picture could do without.
const unpackRest = async (stage, cut) => {
  if (stage) await stage.surface.fetchDifferences();
  if (cut) await cut.voxels.loadAll();
  if (!stage) return;
  stage.probe.again();
  for (const name of stage.names) {
    await others();
    await stage.surface.fetchLook(name);
  }
};

const parsed = () => new Promise((done) => {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", done);
  else done();
});

// First the picture that people open the page for, then what they ask of it.
const start = async () => {
  const text = document.getElementById("viewer-data");
  if (!text || typeof DecompressionStream === "undefined") return;
  const data = JSON.parse(text.textContent);
  const tools = { cut: null };
  const stage = data.surface ? startStage(new Surface(data.surface, data.viewing_distance_mm), data) : null;
  if (stage) {
    listenToKeys(stage, tools);
    await stage.drawn;
    await new Promise(requestAnimationFrame);
    note("shown");
  }
  await parsed();
  if (stage) showWorst(stage, data.worst);
  tools.cut = startCut(data, stage);
  await unpackRest(stage, tools.cut);
  note("ready");
};

// What cannot be read leaves the page as it is without this script.
start().catch(endStage);
