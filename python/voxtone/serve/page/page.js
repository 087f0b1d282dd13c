// SPDX-License-Identifier: GPL-3.0-or-later
import {listen} from "./new.js";
import {Queue} from "./queue.js";
import {Result} from "./result.js";
import {alertOf, ask, Refused} from "./tools.js";

const queue = new Queue((job) => result.show(job));
const result = new Result(queue);

const away = "The service cannot be reached; what was handed in goes on with it. This page looks again by itself.";

function tellShop({paused, keeps, watches}) {
  queue.watch(watches);
  document.getElementById("shop").textContent = paused || keeps;
  document.getElementById("shop").className = paused ? "failed" : "";
}

/// From the whole list on; after a break from the whole list again.
async function follow() {
  const told = await ask("GET", "/jobs");
  tellShop(told);
  queue.all(told.jobs);
  const news = new EventSource(`/events?since=${told.revision}`);
  news.addEventListener("job", (event) => {
    const job = JSON.parse(event.data);
    queue.take(job);
    result.take(job);
  });
  news.addEventListener("gone", (event) => {
    const {id} = JSON.parse(event.data);
    queue.gone(id);
    result.gone(id);
  });
  news.addEventListener("shop", (event) => tellShop(JSON.parse(event.data)));
  news.addEventListener("open", () => alertOf(""));
  news.addEventListener("error", () => {
    news.close();
    alertOf(away);
    setTimeout(again, 2000);
  });
}

function again() {
  follow().catch((error) => {
    alertOf(error instanceof Refused ? error.message : away);
    setTimeout(again, 3000);
  });
}

listen();
again();
