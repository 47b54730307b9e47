// The page: its head, its parts, and which of them is shown. What is shown follows the address, so that links, the
// buttons of the browser and bookmarks work.

import { component } from "./component.js";
import { components } from "./components.js";
import { h, text, time } from "./dom.js";
import { Fleet } from "./fleet.js";
import { Orders } from "./orders.js";
import { FIGURES, alerts, assembly, log, plots, topics } from "./panels.js";

const main = document.getElementById("main");
const connection = document.getElementById("connection");
const open = (name) => `#/component/${encodeURIComponent(name)}`;

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
  const page = { fleet, orders, open, figures: FIGURES, follow: (wants) => fleet.follow({ ...shownPart.wants, ...wants }) };
  const views = await Promise.all(session.views.map(load));
  const figures = views.flatMap(({ module }) => module.figures ?? []);
  page.figures = [...figures, ...FIGURES];
  fleet.series = page.figures.flatMap(({ lines }) => lines);
  const parts = [
    ...views.filter(({ module }) => module.shows(fleet)).map(({ name, title, module }) => ({ path: name, title, make: () => module.view(page) })),
    { path: "components", title: "Components", make: () => components(page) },
    { path: "plots", title: "Plots", make: () => plots(page) },
    { path: "topics", title: "Topics", make: () => topics(page) },
    { path: "alerts", title: "Alerts", make: () => alerts(page) },
    { path: "log", title: "Log", make: () => log(page) },
    { path: "assembly", title: "Assembly", make: () => assembly(page) },
  ];
  head(fleet, orders, session, parts);
  addEventListener("hashchange", () => show(parts, page));
  fleet.addEventListener("connection", () => connected(fleet));
  show(parts, page);
  setInterval(() => shownPart?.refresh(), 100);
}

/** A view of a crate of components, with its style sheet. */
async function load({ name, title }) {
  document.head.append(h("link", { rel: "stylesheet", href: `/assets/views/${name}/view.css` }));
  return { name, title, module: await import(`/assets/views/${name}/view.js`) };
}

/** A name in an address, as somebody may have typed it. */
function decoded(name) {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}

/** The part that is shown. */
let shownPart = null;

function show(parts, page) {
  const [, path, name] = location.hash.match(/^#\/([^/]*)(?:\/(.*))?$/) ?? [];
  const chosen = parts.find((part) => part.path === path) ?? parts[0];
  shownPart?.close?.();
  const part = path === "component" && name ? component(decoded(name), page) : chosen.make();
  main.replaceChildren(part.element);
  main.scrollTop = 0;
  let isDue = true;
  let last = 0;
  const changed = () => (isDue = true);
  page.fleet.addEventListener("change", changed);
  shownPart = {
    wants: part.wants ?? {},
    refresh() {
      if (document.hidden || !isDue || performance.now() - last < part.every) return;
      isDue = false;
      last = performance.now();
      part.update();
    },
    close() {
      page.fleet.removeEventListener("change", changed);
      part.close?.();
    },
  };
  page.fleet.follow(shownPart.wants);
  part.update();
  const now = path === "component" ? "components" : chosen.path;
  for (const tab of document.querySelectorAll("#tabs a")) {
    if (tab.dataset.path === now) tab.setAttribute("aria-current", "page");
    else tab.removeAttribute("aria-current");
  }
}

/** The head: what the fleet does, and the orders to all of it. */
function head(fleet, orders, session, parts) {
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

  const badge = h("span", { class: "badge", hidden: true });
  const tabs = parts.map((part) => h("a", { href: `#/${part.path}`, "data-path": part.path }, part.title, part.path === "alerts" ? badge : null));
  document.getElementById("tabs").append(...tabs);

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
