// SPDX-License-Identifier: GPL-3.0-or-later
// One job: what it came to, its report in place, and beside another's.
import {changeAndSliceAgain} from "./new.js";
import {ask, bytesText, guarded, keepingFocus, key, make, timeText} from "./tools.js";

export class Result {
  constructor(queue) {
    this.queue = queue;
    this.id = null;
    this.element = document.getElementById("result");
    this.body = document.getElementById("result-body");
    window.addEventListener("message", (event) => this.lead(event));
  }

  show(job) {
    this.id = job.id;
    this.reports = null;
    this.tell(job);
    this.element.hidden = false;
    this.queue.choose(job.id);
    document.getElementById("result-title").focus({preventScroll: true});
    this.element.scrollIntoView({block: "start"});
  }

  /// Where the job that is shown came to another state: who works elsewhere on the page stays there.
  take(job) {
    if (job.id === this.id && this.shown !== shownOf(job)) keepingFocus(this.body, () => this.tell(job));
  }

  tell(job) {
    this.shown = shownOf(job);
    document.getElementById("result-title").textContent = job.name;
    if (!this.reports || (job.has_report && !this.reports.firstChild)) this.reports = make("div", {className: "reports"}, job.has_report ? report(job) : null);
    const beside = this.body.querySelector("select")?.value;
    const parts = [...this.words(job), this.acts(job, beside), make("details", {}, make("summary", {}, "The same at the console"), make("code", {}, job.command))];
    for (const old of [...this.body.children]) if (old !== this.reports) old.remove();  // a frame that is moved begins anew
    if (this.reports.parentNode !== this.body) this.body.append(this.reports);
    this.reports.before(...parts);
  }

  gone(id) {
    if (id !== this.id) return;
    this.id = null;
    this.element.hidden = true;
  }

  /// Where one of two reports is looked at from, the other is looked at from, too.
  lead(event) {
    const frames = [...this.body.querySelectorAll("iframe")].map((frame) => frame.contentWindow);
    if (!frames.includes(event.source) || !event.data?.voxtoneView) return;
    for (const other of frames) if (other !== event.source) other.postMessage({voxtoneView: event.data.voxtoneView}, "*");
  }

  words(job) {
    const figures = [job.state, job.seconds ? timeText(job.seconds) : "", job.bytes ? bytesText(job.bytes) : ""].filter(Boolean).join(", ");
    return [
      make("p", {className: "soft"}, figures),
      job.reused ? make("p", {className: "soft"}, `taken over from the finished one: ${job.reused}`) : null,
      job.message ? make("p", {className: job.state === "failed" ? "failed" : "soft"}, job.message) : null,
      job.verdict ? make("p", {}, job.verdict.sentence) : null,
      ...job.warnings.map((text) => make("p", {className: "warned"}, text)),
    ].filter(Boolean);
  }

  acts(job, besides = "") {
    const others = [...this.queue.jobs.values()].filter((other) => other.has_report && other.id !== job.id);
    const beside = make("select", {"aria-label": "compare with"}, make("option", {value: ""}, "compare with …"),
      ...others.map((other) => make("option", {value: other.id}, `${other.name} (${Object.entries(other.options).map(([name, value]) => `${name} ${value}`).join(", ") || "as it comes"})`)));
    beside.value = others.some((other) => other.id === besides) ? besides : "";
    beside.addEventListener("change", () => {
      const other = this.queue.jobs.get(beside.value);
      this.reports.classList.toggle("two", Boolean(other));
      this.reports.replaceChildren(report(job), ...(other ? [report(other)] : []));
    });
    const again = async () => ask("POST", "/jobs", {job: job.id, ...(job.parts ? {parts: job.parts} : {model: job.model}), options: job.options,
      name: job.name, estimate: job.estimate}, {"Idempotency-Key": key()});
    return make("div", {className: "acts"},
      job.has_stack ? make("a", {className: "button", href: `/jobs/${job.id}/printer.zip`, download: ""}, "for the printer (ZIP)") : null,
      job.has_stack ? make("a", {className: "button", href: `/jobs/${job.id}/out.zip`, download: ""}, "all (ZIP)") : null,
      job.has_report ? make("a", {className: "button", href: `/jobs/${job.id}/report`, target: "_blank", rel: "noopener"}, "report in a page of its own") : null,
      make("button", {type: "button", onclick: guarded(again)}, "print again"),
      make("button", {type: "button", onclick: guarded(() => changeAndSliceAgain(job))}, "change and slice again"),
      make("button", {type: "button", onclick: guarded(() => ask("POST", `/jobs/${job.id}/${job.kept ? "unkeep" : "keep"}`, {}))}, job.kept ? "may go by age" : "keep"),
      make("a", {className: "button", href: `/jobs/${job.id}/log`, download: ""}, "what was said"),
      job.has_report && others.length ? beside : null);
  }
}

function shownOf(job) {
  return `${job.state} ${job.kept}`;
}

function report(job) {
  return make("iframe", {src: `/jobs/${job.id}/report`, title: `report of ${job.name}`, sandbox: "allow-scripts", loading: "lazy"});
}
