// SPDX-License-Identifier: GPL-3.0-or-later
// What was dropped: handed in, read, chosen for, estimated, sliced. Files that came together are a group with one form.
import {Form} from "./form.js";
import {ownOf, Plate} from "./plate.js";
import {alertOf, ask, bytesText, guarded, key, make, say, shellWord, sizeText, timeText} from "./tools.js";

const seen = ["rotate", "texture"];  // what changes the picture of a model
let table, lists;
const known = Promise.all([ask("GET", "/options"), ask("GET", "/printers"), ask("GET", "/resins")])
  .then(([options, printers, resins]) => { table = options; lists = {printers, resins}; });

async function filesOf(entry, path, found) {
  if (entry.isFile) {
    const file = await new Promise((done, failed) => entry.file(done, failed));
    if (!entry.name.startsWith(".")) found.push({file, name: path + entry.name});
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    const entries = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!entries.length) return;
    for (const inner of entries) await filesOf(inner, `${path}${entry.name}/`, found);
  }
}

async function dropped(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  const found = [];
  for (const entry of entries) await filesOf(entry, "", found);
  return entries.length ? found : [...transfer.files].map((file) => ({file, name: file.name}));
}

/// To files that are there, or as new ones.
async function send(files, upload = null) {
  alertOf("");
  const bar = make("progress", {max: files.reduce((sum, one) => sum + one.file.size, 0) || 1, value: 0});
  const told = make("p", {}, "Handing in ", String(files.length), files.length === 1 ? " file " : " files ", bar);
  document.getElementById("groups").prepend(told);
  let here = null;
  try {
    for (const {file, name} of files) {
      const address = `/uploads?name=${encodeURIComponent(name)}${upload ? `&into=${upload}` : ""}`;
      here = await ask("POST", address, file);
      upload = here.upload;
      bar.value += file.size;
    }
  } finally {
    told.remove();
  }
  return here;
}

async function handIn(files) {
  const here = await send(files), {upload} = here;
  await known;
  const jobFiles = here.files.filter((file) => file.name.toLowerCase().endsWith(".json"));
  let options = {};
  for (const file of jobFiles) {
    const job = await ask("GET", `/uploads/${upload}/job-file?name=${encodeURIComponent(file.name)}`).catch(() => null);
    if (!job) continue;
    options = job.options;
    if (job.left_out.length) alertOf(`of ${file.name} these are not said here: ${job.left_out.join(", ")}`);
  }
  if (!here.models.length)
    return alertOf(jobFiles.length ? `the job file names its model; drop the two together` :
      `none of ${here.files.map((file) => file.name).join(", ")} is a model or picture that can be sliced`);
  const group = new Group({upload}, here.files, here.models, options);
  group.offer(here.files.filter(({name, picture}) => picture && !here.models.includes(name)).map(({name}) => name));
  say(`${here.models.length} handed in`);
}

export class Group {
  /// `source`: {upload} or {job}, whose files they are. `from`: the finished job that is changed.
  constructor(source, files, models, options = {}, from = null) {
    Object.assign(this, {source, files, from, models: models.map((name) => ({name, figures: null})), who: key(), key: key(), round: 0});
    this.list = make("ul", {className: "models"});
    this.form = new Form(table, lists, files.map((file) => file.name), options, () => this.changed());
    this.line = make("code");
    this.copies = make("input", {type: "number", min: 1, max: 200, value: 1, "aria-label": "copies"});
    this.slice = make("button", {type: "button", className: "main", onclick: guarded(() => this.handIn(false))}, "Slice");
    this.plateHere = make("div");
    const more = make("input", {type: "file", multiple: true, onchange: guarded(() => this.addFiles(more))});
    this.tray = make("button", {type: "button", onclick: guarded(() => this.showPlate())}, "Arrange as one tray");
    this.stays = make("p", {className: "soft"});
    this.element = make("article", {className: "group"}, this.list, this.stays, this.form.element,
      make("details", {}, make("summary", {}, "The same at the console"), this.line,
        make("button", {type: "button", hidden: !navigator.clipboard, onclick: () => { this.tellConsole(); navigator.clipboard.writeText(this.line.textContent); say("copied"); }}, "copy")),
      this.plateHere,
      make("div", {className: "acts"}, this.slice, make("label", {}, "copies ", this.copies), this.tray,
        make("button", {type: "button", onclick: guarded(() => this.handIn(true))}, "Hand in, held"),
        source.upload ? make("label", {className: "button", title: "what a model names: its textures, its material library"}, "Add files", more) : null,
        make("button", {type: "button", onclick: () => this.remove()}, "Discard")));
    document.getElementById("groups").prepend(this.element);
    for (const model of this.models) this.show(model);
    // What is seen of them comes first: estimates take the same processor.
    this.seen = Promise.race([Promise.all(this.models.map((model) => this.read(model))), new Promise((done) => setTimeout(done, 2000))]);
    this.changed();
  }

  show(model) {
    model.views = make("div", {className: "views"});
    model.told = make("div", {}, make("p", {className: "soft"}, "reading …"));
    model.holds = make("div");
    const file = this.files.find((one) => one.name === model.name);
    const remove = make("button", {type: "button", title: `leave out ${model.name}`, onclick: () => this.leaveOut(model)}, "×");
    const alone = make("button", {type: "button", title: `options of its own for ${model.name}`, onclick: () => this.alone(model)}, "options of its own");
    model.element = make("li", {}, model.views, make("div", {}, make("h3", {}, model.name, " ", make("span", {className: "soft"}, file ? bytesText(file.bytes) : "")), model.holds, model.told),
      make("div", {className: "acts"}, this.models.length > 1 ? alone : null, this.models.length > 1 ? remove : null));
    this.list.append(model.element);
  }

  /// What the file holds, in words and from three sides; sizes as they are chosen the estimate tells.
  async read(model) {
    const chosen = JSON.stringify(Object.fromEntries(Object.entries(this.form.values).filter(([option]) => seen.includes(option) && table.reads.includes(option))));
    if (model.readWith === chosen) return;
    model.readWith = chosen;
    const at = this.source.upload ? `/uploads/${this.source.upload}` : `/jobs/${this.source.job}`;
    const query = `name=${encodeURIComponent(model.name)}&options=${encodeURIComponent(chosen)}`;
    const told = await ask("GET", `${at}/read?${query}`).catch(() => null);
    if (model.readWith !== chosen) return;
    const file = told?.result.files[0];
    if (!file || file.error) {  // the estimate says why
      model.readWith = null;
      return;
    }
    model.holds.replaceChildren(make("p", {className: "soft"}, contentsText(file)));
    if (!model.figures) model.told.replaceChildren(...file.warnings.map((text) => make("p", {className: "warned"}, text)));
    if (told.has_picture) model.views.replaceChildren(make("img", {src: `${at}/look?${query}`, alt: file.format === "picture" ? model.name : `${model.name} from the right, the front and above`}));
  }

  body(model, more = {}) {
    return {...this.source, model: model.name, options: this.form.values, ...more};
  }

  changed() {
    const round = ++this.round;
    this.plate?.changed();
    this.tellConsole();
    this.stays.textContent = this.from ? staysText(this.from, this.form.values) : "";
    setTimeout(() => {
      if (round !== this.round) return;
      for (const model of this.models) this.read(model);
      this.estimate(round);
    }, 80);
  }

  /// A command for each print; a tray's plan is a file.
  tellConsole() {
    const wordsOf = (values) => Object.entries(values).flatMap(([option, value]) =>
      (Array.isArray(value) ? value : [value]).map((one) => one === true ? `--${option}` : one === false ? `--no-${option}` : `--${option}=${shellWord(String(one))}`));
    const lines = this.plate ? [`printf %s ${shellWord(JSON.stringify({format: "voxtone-tray", version: 1, parts: this.plate.parts()}))} >tray.json`,
      ["voxtone tray tray.json", ...wordsOf(this.plate.options()), "-o out/tray"].join(" ")] :
      this.models.map(({name}) => ["voxtone slice", shellWord(name), ...wordsOf(this.form.values), "-o", shellWord(`out/${name.replace(/\.[^.]*$/, "")}`)].join(" "));
    this.line.textContent = lines.join("\n");
  }

  async estimate(round) {
    await this.seen;
    for (const full of [false, true]) {
      for (const model of this.models) {
        if (round !== this.round) return;
        await this.estimateOne(model, full, round);
      }
      if (!full) await new Promise((done) => setTimeout(done, 300));
    }
  }

  async estimateOne(model, full, round) {
    try {
      const told = await ask("POST", "/estimate", this.body(model, {full, who: `${this.who}${model.name}`.slice(0, 70)}));
      if (round !== this.round) return;
      model.figures = told.result;
      this.tell(model, told);
      this.plate?.changed();
    } catch (error) {
      if (round !== this.round || error.status === 409) return;
      model.figures = null;
      model.told.replaceChildren(make("p", {className: "failed"}, error.message));
    }
  }

  tell(model, {result, warnings}) {
    const resins = result.resins.filter((resin) => resin.ml > 0).map((resin) => `${resin.role} ${resin.ml.toPrecision(2)}`).join(", ");
    model.told.replaceChildren(
      make("p", {}, `${sizeText(result.size_mm)}, ${result.layers} layers of ${result.layer_um} µm`),
      make("p", {}, `${timeText(result.seconds)}, ${result.ml.toPrecision(3)} ml`, resins ? ` (${resins})` : "",
        result.price ? `, ${result.price.toFixed(2)} ${result.currency}` : "", `, ${bytesText(result.memory_bytes)} of memory`),
      ...[...new Set([...result.warnings, ...warnings])].map((text) => make("p", {className: "warned"}, text)),
      ...result.notes.map((text) => make("p", {className: "soft"}, text)));
  }

  /// Beside those that are there: what was not found is looked for again.
  async addFiles(input) {
    const files = [...input.files].map((file) => ({file, name: file.name}));
    input.value = "";
    if (!files.length) return;
    this.files = (await send(files, this.source.upload)).files;
    for (const model of this.models) model.readWith = null;
    this.changed();
  }

  /// Pictures beside models are taken for their textures; who means them themselves says so.
  offer(pictures) {
    if (!pictures.length) return;
    this.list.after(make("p", {className: "soft"}, "Taken for textures: ", ...pictures.map((name) => make("button", {type: "button", title: `print the picture ${name}`,
      onclick: (event) => { event.target.remove(); new Group(this.source, this.files, [name], this.form.values); }}, `print ${name}`))));
  }

  alone(model) {
    this.leaveOut(model);
    new Group(this.source, this.files, [model.name], this.form.values);
  }

  leaveOut(model) {
    this.models = this.models.filter((one) => one !== model);
    model.element.remove();
    if (!this.models.length) return this.remove();
    this.changed();
  }

  async showPlate(parts = null) {
    this.plate = new Plate(this, lists.printers, parts);
    this.plateHere.replaceChildren(this.plate.element);
    this.tellConsole();
    this.tray.hidden = this.copies.parentNode.hidden = true;
    this.slice.textContent = "Slice the tray";
  }

  async handIn(held) {
    this.slice.disabled = true;
    try {
      if (this.plate) {
        await ask("POST", "/jobs", {...this.source, parts: this.plate.parts(), options: this.plate.options(), held}, {"Idempotency-Key": this.key});
      } else {
        for (const [at, model] of this.models.entries())
          await ask("POST", "/jobs", this.body(model, {copies: Math.max(1, Math.round(Number(this.copies.value)) || 1), held,
            estimate: model.figures, changed_from: this.from?.id}), {"Idempotency-Key": `${this.key}-${at}`});
      }
    } finally {
      this.slice.disabled = false;
    }
    say("handed in");
    this.remove();
  }

  remove() {
    this.round = -1;
    this.element.remove();
    document.getElementById("new-title").scrollIntoView({block: "nearest"});
  }
}

/// What of a finished job is not made anew (again.py decides), before it is sliced again.
function staysText(job, values) {
  if (job.state !== "done") return "";
  if (job.parts) return "Parts that stay as they are keep what their loops came to.";
  const leaves = new Map(table.groups.flatMap((group) => group.options).map((option) => [option.name, option.leaves]));
  const changed = [...new Set([...Object.keys(job.options), ...Object.keys(values)])].filter((name) => String(job.options[name] ?? "") !== String(values[name] ?? ""));
  const anew = changed.filter((name) => leaves.get(name) === "nothing");
  if (anew.length) return `${anew.join(", ")}: the print is another, and all of it is made anew.`;
  const loop = changed.filter((name) => leaves.get(name).endsWith("loop"));
  if (loop.length && !job.keeps_loop) return "All of it is made anew.";
  if (loop.some((name) => leaves.get(name) === "settled-loop"))
    return "What the appearance loop came to stays where it would end as it did; layers and report are made anew.";
  if (loop.length) return "What the appearance loop came to stays; layers and report are made anew.";
  return "Nothing that the print depends on is changed: the finished one is taken over.";
}

/// Of `voxtone read`.
function contentsText(file) {
  const name = {1: "mm", 10: "cm", 25.4: "inch", 304.8: "foot", 1000: "m"}[file.unit?.mm] ?? `${file.unit?.mm} mm`;
  const unit = {assumed: "mm assumed, for it says no unit", file: `unit: ${name}`}[file.unit?.is] ?? "";
  const size = file.size_mm ? `${sizeText(file.size_mm)} in the file${unit && ` (${unit})`}` : "";
  const counts = file.triangles ? `${file.triangles} triangles${file.parts > 1 ? ` in ${file.parts} parts` : ""}` : "";
  const missing = (file.beside ?? []).filter((one) => !one.found).map((one) => one.file);
  return [file.format, size, counts, file.colour.length ? `colour: ${file.colour.join(", ")}` : "no colour",
    missing.length ? `not handed in: ${missing.join(", ")}` : ""].filter(Boolean).join("; ");
}

export async function changeAndSliceAgain(job) {
  await known;
  const told = await ask("GET", `/jobs/${job.id}/files`);
  if (job.parts) {
    const group = new Group({job: job.id}, told.files, [...new Set(job.parts.map((part) => part.model).filter(Boolean))], {...job.options, ...ownOf(job.parts[0])}, job);
    group.element.scrollIntoView();
    return group.showPlate(job.parts);
  }
  new Group({job: job.id}, told.files, [job.model], job.options, job).element.scrollIntoView();
}

export function listen() {
  const place = document.getElementById("drop");
  const take = guarded(async (files) => { if (files.length) await handIn(files); });
  for (const kind of ["dragenter", "dragover"])
    document.addEventListener(kind, (event) => { event.preventDefault(); place.classList.add("over"); });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) place.classList.remove("over"); });
  const drop = guarded(async (transfer) => take(await dropped(transfer)));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    place.classList.remove("over");
    drop(event.dataTransfer);
  });
  for (const id of ["choose", "choose-folder"])
    document.getElementById(id).addEventListener("change", (event) => {
      take([...event.target.files].map((file) => ({file, name: file.webkitRelativePath || file.name})));
      event.target.value = "";
    });
}
