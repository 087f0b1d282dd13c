// Without this script the page shows every view and the first layer; with it, tabs and a slider.
(() => {
  "use strict";
  const views = [...document.querySelectorAll(".view")];
  const tabs = document.querySelector(".tabs");
  if (views.length > 1) {
    const show = (chosen) => {
      views.forEach((view, i) => { view.hidden = i !== chosen; });
      [...tabs.children].forEach((tab, i) => tab.setAttribute("aria-pressed", i === chosen));
    };
    views.forEach((view, i) => {
      const tab = document.createElement("button");
      tab.type = "button";
      tab.textContent = view.dataset.name;
      tab.addEventListener("click", () => show(i));
      tabs.append(tab);
    });
    show(0);
  }

  window.addEventListener("beforeprint", () => {
    for (const picture of document.images) picture.loading = "eager";
    for (const details of document.querySelectorAll("details")) details.open = true;
  });

  const data = document.getElementById("layer-data");
  if (!data) return;
  let read = null;
  const layers = () => (read = read || JSON.parse(data.textContent));
  const picture = document.getElementById("layer-picture");
  const slider = document.getElementById("layer-slider");
  const label = document.getElementById("layer-label");
  const play = document.getElementById("layer-play");
  let timer = 0;
  const draw = () => {
    const layer = layers()[slider.value];
    picture.src = layer.src;
    picture.alt = label.textContent = layer.label;
  };
  const step = (by) => {
    const count = layers().length;
    slider.value = (Number(slider.value) + by + count) % count;
    draw();
  };
  const pause = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = "Play";
  };
  slider.addEventListener("input", () => { pause(); draw(); });
  play.addEventListener("click", () => {
    if (timer) return pause();
    play.textContent = "Pause";
    timer = setInterval(() => step(1), 120);
  });
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target === slider) return;
    if (document.documentElement.classList.contains("has-cut")) return;
    if (event.key === "ArrowRight" || event.key === "ArrowUp") step(1);
    else if (event.key === "ArrowLeft" || event.key === "ArrowDown") step(-1);
    else return;
    pause();
    event.preventDefault();
  });
  document.querySelector(".scrub").hidden = false;
  // A browser that comes back to the page keeps where the slider was.
  if (slider.value !== slider.defaultValue) draw();
})();
