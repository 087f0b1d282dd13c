// Where the page comes to life. Without it, or where a browser lacks WebGL2, the page shows fixed views.

const listenToKeys = (stage, cut) => {
  const keys = {
    " ": () => stage.flip(), d: () => stage.toggleCompare(), l: () => stage.toggleLight(), 0: () => stage.reset(),
    p: () => stage.probeMiddle(), "+": () => stage.zoom(1.25), "=": () => stage.zoom(1.25), "-": () => stage.zoom(0.8),
    ArrowLeft: () => stage.step(1, 0), ArrowRight: () => stage.step(-1, 0),
    ArrowUp: () => stage.step(0, 1), ArrowDown: () => stage.step(0, -1),
    c: () => cut && cut.toggleInView(),
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
  "middle; c cuts the body.";
const KEYS_OF_PICTURES =
  "1, 2, 3 … show one alone; space flips; d compares with a divider (arrows move it where it has the focus); drag or " +
  "arrows pan; wheel (after a click), pinch, + and − zoom; 0 resets; p probes the middle; c cuts the body.";

const showWorst = (stage, worst) => {
  for (const button of document.querySelectorAll("button.place")) {
    const place = worst[Number(button.dataset.place)];
    button.disabled = false;
    button.addEventListener("click", () => {
      stage.visit(place.at_mm, place.normal);
      document.getElementById("viewer").scrollIntoView({ block: "nearest" });
    });
  }
};

const startStage = (surface, data, voxels) => {
  const section = document.getElementById("viewer");
  section.hidden = false;
  try {
    const stage = new Stage(surface, new Probe(surface, voxels, data.resins, data.viewing_distance_mm));
    document.getElementById("viewer-note").textContent = `${surface.note} ${data.about}`;
    document.getElementById("viewer-keys").textContent = surface.isPicture ? KEYS_OF_PICTURES : KEYS_OF_BODIES;
    document.documentElement.classList.add("has-viewer");
    showWorst(stage, data.worst);
    stage.canvas.addEventListener("webglcontextlost", () => {
      section.hidden = true;
      document.documentElement.classList.remove("has-viewer");
    });
    return stage;
  } catch {
    section.hidden = true;
    return null;
  }
};

const start = async () => {
  const text = document.getElementById("viewer-data");
  if (!text || typeof DecompressionStream === "undefined") return;
  const data = JSON.parse(text.textContent);
  const voxels = data.voxels && data.voxels.layers.length ? new Voxels(data.voxels) : null;
  let stage = null;
  if (data.surface) {
    const surface = await unpackSurface(data.surface);
    const differences = surface.seen || surface.single;
    if (differences) {
      const where = surface.seen ? ` as seen from ${data.viewing_distance_mm} mm` : "";
      const caption = `CIEDE2000${where}: white 0, yellow 2, orange 5, red 10, black 20 and more`;
      // Before what is no colour of the print.
      const support = surface.looks.findIndex((look) => look.name === "support");
      const at = support < 0 ? surface.looks.length : support;
      surface.looks.splice(at, 0, { name: "difference", caption, rgb: differenceLook(differences) });
    }
    stage = startStage(surface, data, voxels);
  }
  let cut = null;
  if (voxels) {
    document.getElementById("cut").hidden = false;
    cut = new Cut(voxels, data.resins, Boolean(data.surface && data.surface.size_px));
    cut.stage = stage;
    cut.inViewButton.hidden = !stage;
    document.documentElement.classList.add("has-cut");
  }
  if (stage) listenToKeys(stage, cut);
  if (voxels) await voxels.ready;
  document.documentElement.dataset.ready = String(Math.ceil(performance.now()));
};

// What cannot be read leaves the page as it is without this script.
start().catch(() => {});
