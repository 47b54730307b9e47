// The page of a run that has ended: its parts at a moment of the run, and a slider over time.

import { components } from "./components.js";
import { h, text, time } from "./dom.js";
import { load, ofViews, open, present, wants } from "./page.js";
import { alerts, log, plots } from "./panels.js";
import { RecordedFleet } from "./recorded.js";

/** Seconds of the run in a second. */
const SPEEDS = [0.5, 1, 2, 5, 10, 30, 60];
/** Time between two moments that are shown while it plays. */
const FRAME_MS = 100;
/** Parts of the run by which Page Up and Page Down go. */
const PAGES = 10;

/** Where nobody can order anything: a run that has ended has no buttons for that. */
const noOrders = { mayOrder: false, button: () => h("span", { hidden: true }), tell: () => {} };

async function begin() {
  const connection = document.getElementById("connection");
  const answer = await fetch("run").catch(() => null);
  if (!answer?.ok) {
    text(connection, "The run cannot be read: the program that shows it has ended.");
    connection.hidden = false;
    return;
  }
  const run = await answer.json();
  const fleet = new RecordedFleet(run);
  const page = { fleet, orders: noOrders, open, follow: (more) => fleet.follow({ ...wants(), ...more }) };
  const views = await Promise.all(run.views.map(load));
  head(fleet);
  present(
    [
      ...ofViews(views, page),
      { path: "components", title: "Components", make: () => components(page) },
      { path: "plots", title: "Plots", make: () => plots(page) },
      { path: "alerts", title: "Alerts", make: () => alerts(page) },
      { path: "log", title: "Log", make: () => log(page) },
    ],
    page,
  );
  player(fleet);
}

function head(fleet) {
  const place = { fleet: document.getElementById("fleet"), phase: document.getElementById("phase"), time: document.getElementById("time"), summary: document.getElementById("summary") };
  text(place.fleet, fleet.name);
  document.title = `${fleet.name} – SAOMS`;
  const reasons = fleet.outcome.reasons.join("\n");
  const update = () => {
    const isOver = fleet.state.time_s >= fleet.end;
    text(place.phase, isOver ? fleet.state.phase : fleet.state.paused ? "paused" : "running");
    // An operator who ends a run is no alarm.
    place.phase.className = `pill ${fleet.state.phase === "stopped" ? "elapsed" : fleet.state.phase}`;
    place.phase.title = isOver ? reasons : "";
    text(place.time, `${time(fleet.state.time_s)} of ${time(fleet.end)}`);
    text(place.summary, fleet.state.summaries.join(" · "));
  };
  fleet.addEventListener("change", update);
  update();
}

/** The slider over time, with play and pause. */
function player(fleet) {
  const end = Math.max(0.001, fleet.end);
  const range = h("input", { type: "range", id: "moment", min: 0, max: end, step: "any", value: 0, "aria-label": "Time of the run", oninput: () => (stop(), go(Number(range.value))) });
  const button = h("button", { id: "play", class: "primary", onclick: () => (timer === null ? play() : stop()) }, "Play");
  const speed = h("select", { id: "speed", "aria-label": "Speed" }, ...SPEEDS.map((one) => h("option", { value: one, selected: one === 1 }, `${one}×`)));
  const keys = h("p", { class: "muted keys" }, "Space plays and pauses; arrows go from sample to sample, Page Up and Page Down further, Home and End to the ends.");
  document.getElementById("player").append(button, range, speed, keys);
  let timer = null;
  let last = 0;

  function go(moment) {
    fleet.seek(moment);
    const now = fleet.state.time_s;
    if (Number(range.value) !== now) range.value = now;
    range.setAttribute("aria-valuetext", `${time(now, true)} of ${time(fleet.end, true)}`);
  }

  function play() {
    if (fleet.state.time_s >= fleet.end) go(0);
    text(button, "Pause");
    last = performance.now();
    timer = setInterval(() => {
      const now = performance.now();
      go(fleet.state.time_s + ((now - last) / 1000) * Number(speed.value));
      last = now;
      if (fleet.state.time_s >= fleet.end) stop();
    }, FRAME_MS);
  }

  function stop() {
    clearInterval(timer);
    timer = null;
    text(button, "Play");
  }

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const at = event.target;
    // Fields, lists and the map have keys of their own.
    if (at !== range && at.matches?.("input, select, textarea, canvas")) return;
    if (event.key === " " && at !== button && at.matches?.("button, a, summary")) return;
    const acts = {
      " ": () => (timer === null ? play() : stop()),
      ArrowRight: () => go(fleet.beside(1)), ArrowUp: () => go(fleet.beside(1)),
      ArrowLeft: () => go(fleet.beside(-1)), ArrowDown: () => go(fleet.beside(-1)),
      PageUp: () => go(fleet.state.time_s + end / PAGES), PageDown: () => go(fleet.state.time_s - end / PAGES),
      Home: () => go(0), End: () => go(fleet.end),
    };
    // Elsewhere these move the page.
    const isOfPage = ["ArrowUp", "ArrowDown", "PageUp", "PageDown"].includes(event.key) && at !== range;
    const act = isOfPage ? null : acts[event.key];
    if (!act) return;
    event.preventDefault();
    if (event.key !== " ") stop();
    act();
  });
  go(0);
}

begin();
