// SPDX-License-Identifier: GPL-3.0-or-later
// All jobs, as the service tells of them while it happens.
import {ask, guarded, keepingFocus, make, say, timeText} from "./tools.js";

const places = {running: 0, waiting: 1, held: 1, failed: 2, done: 2, cancelled: 2};
const acts = {
  waiting: ["hold", "up", "down", "cancel"], held: ["release", "up", "down", "cancel"], running: ["hold", "cancel"],
  failed: ["retry", "remove"], cancelled: ["retry", "remove"], done: ["remove"],
};

function before(a, b) {
  const place = places[a.state] - places[b.state];
  if (place) return place;
  return places[a.state] === 2 ? b.ended - a.ended : a.order - b.order;
}

export class Queue {
  constructor(chosen) {
    this.jobs = new Map();
    this.rows = new Map();
    this.chosen = chosen;
    this.element = document.getElementById("jobs");
    this.only = "";  // the queue whose jobs are shown; empty: all
  }

  /// Hot folders: what each waits for and said of late, and a choice of whose jobs are seen.
  watch(watches) {
    const place = document.getElementById("watches");
    const names = watches.map(({name}) => name).join(" ");
    if (place.dataset.names !== names) {  // else the choice stays, which may be open
      place.dataset.names = names;
      place.replaceChildren(...(names ? [make("p", {}, this.choice(watches)), make("div")] : []));
    }
    if (names) place.lastChild.replaceChildren(...watches.flatMap(({name, folder, options, waits, why, said}) => [
      make("p", {className: "soft"}, make("b", {}, name), ` takes what arrives in ${folder}, with ${options ? `the options of watch/${options}` : "default options"}`),
      waits ? make("p", {className: "warned"}, `${name}: ${waits} cannot be taken yet: ${why}`) : null,
      ...said.map((text) => make("p", {className: "soft"}, `${name}: ${text}`))].filter(Boolean)));
  }

  choice(watches) {
    const choice = make("select", {"aria-label": "which jobs are shown"}, make("option", {value: ""}, "all queues"), make("option", {value: "-"}, "handed in here"),
      ...watches.map(({name}) => make("option", {value: name}, name)));
    choice.addEventListener("change", () => {
      this.only = choice.value;
      for (const row of this.rows.values()) this.hideOthers(row);
      this.arrange();
    });
    return choice;
  }

  hideOthers(row) {
    row.hidden = Boolean(this.only) && (row.job.queue || "-") !== this.only;
  }

  all(jobs) {
    this.jobs = new Map(jobs.map((job) => [job.id, job]));
    for (const [id, row] of this.rows) if (!this.jobs.has(id)) { row.remove(); this.rows.delete(id); }
    for (const job of jobs) this.row(job);
    this.arrange();
  }

  take(job) {
    const known = this.jobs.get(job.id);
    if (known && known.revision > job.revision) return;
    this.jobs.set(job.id, job);
    this.row(job);
    if (!known || known.state !== job.state || known.order !== job.order) {
      this.arrange();
      if (known && known.state !== job.state) say(`${job.name}: ${job.state}`);
    }
  }

  gone(id) {
    const row = this.rows.get(id), next = row?.nextElementSibling ?? row?.previousElementSibling;
    if (row?.contains(document.activeElement)) next?.querySelector(".name").focus({preventScroll: true});
    this.jobs.delete(id);
    row?.remove();
    this.rows.delete(id);
    this.arrange();
  }

  arrange() {
    keepingFocus(this.element, () => this.place());
  }

  place() {
    const sorted = [...this.jobs.values()].sort(before);
    const seen = sorted.filter((job) => !this.rows.get(job.id)?.hidden);
    let at = this.element.firstElementChild;
    for (const job of sorted) {
      const row = this.rows.get(job.id);
      if (row === at) at = at.nextElementSibling;
      else this.element.insertBefore(row, at);
    }
    const count = (state) => seen.filter((job) => job.state === state).length;
    const told = ["running", "waiting", "held", "failed", "done"].filter(count).map((state) => `${count(state)} ${state}`).join(", ");
    document.getElementById("counts").textContent = told && `(${told})`;
    document.getElementById("empty").hidden = sorted.length > 0;
    document.getElementById("none").hidden = !sorted.length || seen.length > 0;
  }

  row(job) {
    let row = this.rows.get(job.id);
    if (!row) {
      row = make("li", {});
      this.rows.set(job.id, row);
      row.name = make("button", {type: "button", className: "name", onclick: () => this.chosen(row.job)}, job.name);
      row.state = make("span");
      row.of = make("span", {className: "soft"});
      row.told = make("div");
      row.acts = make("div", {className: "acts"});
      row.append(make("div", {className: "head"}, make("span", {}, row.name, row.of), row.state), row.told, row.acts);
    }
    row.job = job;
    row.of.textContent = job.queue ? ` ${job.queue}` : "";
    this.hideOthers(row);
    row.state.className = `state ${job.state}`;
    row.state.textContent = job.wish === "cancel" ? "ends" : job.wish === "hold" ? "saves itself" : job.state;
    this.tell(row, job);
    if (row.actsOf !== job.state) {
      row.actsOf = job.state;
      keepingFocus(row.acts, () => row.acts.replaceChildren(...acts[job.state].map((act) => this.button(act, job)),
        ...(job.has_stack ? [make("a", {className: "button", href: `/jobs/${job.id}/printer.zip`, download: ""}, "for the printer (ZIP)")] : [])));
    }
    return row;
  }

  tell(row, job) {
    const {stage, done, steps, seconds_left: left} = job.progress;
    if (job.state === "running" && row.bar) {
      row.text.textContent = progressText(job);
      setBar(row.bar, done, steps);
      return;
    }
    row.bar = null;
    const lines = [];
    if (job.state === "running") {
      row.bar = make("progress", {max: 1, "aria-label": `progress of ${job.name}`});
      setBar(row.bar, done, steps);
      row.text = make("p", {className: "soft"}, progressText(job));
      lines.push(row.bar, row.text);
    }
    if (job.message && job.state !== "running") lines.push(make("p", {className: job.state === "failed" ? "failed" : "soft"}, job.message));
    if (job.verdict) lines.push(make("p", {}, job.verdict.sentence));
    if (job.state === "done") lines.push(make("p", {className: "soft"}, `made in ${timeText(job.seconds)}`, job.reused ? `, not anew: ${job.reused}` : "", job.warnings.length ? `, ${job.warnings.length} warning${job.warnings.length > 1 ? "s" : ""}` : ""));
    if (job.state === "waiting" && job.estimate?.seconds) lines.push(make("p", {className: "soft"}, `will take ${job.estimate.seconds < 1 ? "" : "about "}${timeText(job.estimate.seconds)}`));
    if (job.leaves) lines.push(make("p", {className: "warned"}, `goes ${new Date(job.leaves * 1000).toLocaleString()}, unless it is kept`));
    row.told.replaceChildren(...lines);
  }

  button(act, job) {
    const words = {release: "go on", up: "↑", down: "↓"};
    return make("button", {type: "button", title: `${act}: ${job.name}`, "aria-label": `${act}: ${job.name}`, onclick: guarded(async () => {
      if (act === "remove") {
        if (confirm(`Remove ${job.name} and all that it made?`)) await ask("DELETE", `/jobs/${job.id}`);
      } else {
        this.take(await ask("POST", `/jobs/${job.id}/${act}`, {}));
      }
    })}, words[act] ?? act);
  }

  choose(id) {
    for (const [other, row] of this.rows) row.classList.toggle("chosen", other === id);
  }
}

function setBar(bar, done, steps) {
  if (steps > 0) bar.value = Math.min(1, done / steps);
  else bar.removeAttribute("value");
}

function progressText(job) {
  const {stage, done, steps, seconds_left: left} = job.progress;
  return [stage ?? "starts", steps > 0 ? `${done} of ${steps}` : "", left > 0 ? `${timeText(left)} left` : ""].filter(Boolean).join(", ");
}
