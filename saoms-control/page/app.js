// The page of a running fleet: its head, and its parts.

import { components } from "./components.js";
import { h, text, time } from "./dom.js";
import { Fleet } from "./fleet.js";
import { Orders } from "./orders.js";
import { load, ofViews, open, present, wants } from "./page.js";
import { alerts, assembly, log, plots, topics } from "./panels.js";

const connection = document.getElementById("connection");

async function begin() {
  const answer = await fetch("/v1/session").catch(() => null);
  if (answer?.status === 401) return location.assign("/login");
  if (!answer?.ok) {
    text(connection, "The fleet cannot be reached. Trying again …");
    connection.hidden = false;
    return setTimeout(begin, 2000);
  }
  connection.hidden = true;
  const session = await answer.json();
  const fleet = new Fleet();
  const orders = new Orders(fleet, session.right);
  await fleet.loadTopics().catch(() => {});
  const page = { fleet, orders, open, follow: (more) => fleet.follow({ ...wants(), ...more }) };
  const views = await Promise.all(session.views.map(load));
  const badge = h("span", { class: "badge", hidden: true });
  const parts = [
    ...ofViews(views, page),
    { path: "components", title: "Components", make: () => components(page) },
    { path: "plots", title: "Plots", make: () => plots(page) },
    { path: "topics", title: "Topics", make: () => topics(page) },
    { path: "alerts", title: "Alerts", badge, make: () => alerts(page) },
    { path: "log", title: "Log", make: () => log(page) },
    { path: "assembly", title: "Assembly", make: () => assembly(page) },
  ];
  head(fleet, orders, session, badge);
  fleet.addEventListener("connection", () => connected(fleet));
  present(parts, page);
}

/** The head: what the fleet does, and the orders to all of it. */
function head(fleet, orders, session, badge) {
  const place = { fleet: document.getElementById("fleet"), phase: document.getElementById("phase"), time: document.getElementById("time"), summary: document.getElementById("summary") };
  const isStopped = () => [...fleet.components.values()].some((one) => one.emergency_stop);
  const pause = orders.button("Pause", { title: "saoms pause", order: () => orders.send("POST", "/v1/pause"), isDone: () => fleet.state.paused });
  const resume = orders.button("Resume", { title: "saoms resume", order: () => orders.send("POST", "/v1/resume"), isDone: () => !fleet.state.paused });
  const release = orders.button("Release all", { title: "saoms release", order: () => orders.release(), isDone: () => !isStopped() });
  const stop = orders.button("Emergency stop", { kind: "danger", title: "Stop all machines at once: saoms estop", order: () => orders.stop(), isDone: (answer) => stopped(fleet, answer) });
  const right = h("span", { class: "muted right" }, session.right === "view" ? "View only" : "");
  const leave = h("form", { method: "post", action: "/logout" }, h("button", { class: "plain" }, "Log out"));
  // At the socket there is nothing to log out of.
  fetch("/login", { method: "HEAD" }).then((answer) => (leave.hidden = !answer.ok)).catch(() => {});
  document.getElementById("orders").append(right, pause, resume, release, stop, leave);

  const update = () => {
    const { about, state } = fleet;
    if (about) {
      text(place.fleet, about.name);
      const waiting = fleet.waiting().length;
      document.title = `${waiting ? `(${waiting}) ` : ""}${about.name} – SAOMS`;
      text(badge, waiting);
      badge.hidden = waiting === 0;
    }
    const phase = isStopped() ? "stopped" : state.paused ? "paused" : state.phase;
    text(place.phase, fleet.isConnected ? phase : "no connection");
    place.phase.className = `pill ${fleet.isConnected ? phase : "lost"}`;
    text(place.time, time(state.time_s));
    text(place.summary, state.summaries.join(" · "));
    pause.hidden = state.paused;
    resume.hidden = !state.paused;
    release.hidden = !isStopped();
  };
  // A fleet may write many lines in a second.
  let isDue = false;
  fleet.addEventListener("change", () => (isDue = true));
  setInterval(() => isDue && ((isDue = false), update()), 150);
  fleet.addEventListener("connection", update);
}

/** True once all that an emergency stop named are stopped. */
function stopped(fleet, answer) {
  const named = Array.isArray(answer.reply) ? answer.reply : [];
  return named.every((name) => fleet.components.get(name)?.emergency_stop);
}

function connected(fleet) {
  document.body.classList.toggle("lost", !fleet.isConnected);
  connection.hidden = fleet.isConnected;
  text(connection, fleet.isConnected ? "" : `The connection is lost: what you see is of ${time(fleet.state.time_s)} of the run. Trying again …`);
}

begin();
