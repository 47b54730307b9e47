// The parts of the page that each fleet has: plots, topics, alerts, the log and the picture of its composites.

import { h, keyed, micros, shown, text, time } from "./dom.js";
import { Plot } from "./plot.js";

/** Rows of figures that the page keeps: beyond, every second one is left out. */
const ROWS = 7200;

/** The formats of figures by their units. */
const FORMATS = { us: micros, "%": (value) => (Number.isFinite(value) ? `${Math.round(value)} %` : "–"), "": shown };

export function plots({ fleet }) {
  const place = h("div", { class: "plots" });
  const none = h("p", { class: "empty" }, "…");
  const note = h("p", { class: "muted" }, "From the start of the run.");
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Plots"), note), none, place);
  let all = null;
  let rows = [];
  let isAsking = false;

  async function ask() {
    if (isAsking) return;
    isAsking = true;
    const found = await fleet.figures(rows.at(-1)?.[0] ?? null).catch(() => null);
    isAsking = false;
    if (!found) return;
    rows.push(...found.rows);
    if (rows.length > ROWS) rows = rows.filter((_, index) => index % 2 === 0);
    if (!all) {
      let next = 1;
      all = found.plots.map(({ title, unit, lines }) => new Plot(title, lines.map((line) => ({ ...line, column: next++ })), FORMATS[unit] ?? ((value) => `${shown(value)} ${unit}`)));
      place.append(...all.map((plot) => plot.element));
      none.remove();
    }
    draw();
  }

  const draw = () => all?.forEach((plot) => plot.update(rows, fleet.isFinished ? fleet.state.time_s : null));

  function update() {
    if (fleet.isFinished && all) draw();
    else ask();
  }

  return { element, update, every: fleet.isFinished ? 100 : 1000 };
}

export function topics({ fleet, follow, open }) {
  let chosen = null;
  const rows = h("tbody");
  const messages = h("tbody");
  const title = h("h3", {}, "Messages");
  const hint = h("p", { class: "empty" }, "Choose a topic to see its messages. A topic that nobody follows costs nothing.");
  const element = h(
    "section",
    { class: "panel" },
    h("div", { class: "bar" }, h("h2", {}, "Topics")),
    h("div", { class: "columns" },
      h("div", { class: "scroll" }, h("table", {}, h("thead", {}, h("tr", {}, ...["Topic", "Kind", "Messages", "Publishers", "Readers", "Waiting"].map((name) => h("th", { scope: "col" }, name)))), rows)),
      h("div", {}, title, hint, h("div", { class: "scroll" }, h("table", { class: "messages" }, messages)))),
  );

  function choose(topic) {
    chosen = chosen === topic.name ? null : topic.name;
    fleet.topics.delete(topic.name);
    messages.keyed?.clear();
    messages.replaceChildren();
    follow({ topics: chosen ? [chosen] : [] });
    update();
  }

  const waiting = (topic) => topic.readers.reduce((total, reader) => total + (reader.waiting ?? 0), 0);

  function update() {
    const make = (topic) => h("tr", {}, h("td", {}, h("button", { class: "plain link", onclick: () => choose(topic) }, topic.name)), h("td", {}, topic.kind), h("td", {}, topic.message), h("td", { class: "figure" }), h("td", { class: "figure" }), h("td", { class: "figure" }));
    keyed(rows, fleet.topicList, (topic) => topic.name, make, (row, topic) => {
      row.classList.toggle("chosen", topic.name === chosen);
      row.firstChild.firstChild.setAttribute("aria-pressed", topic.name === chosen);
      [topic.publishers.length, topic.readers.length, waiting(topic)].forEach((number, index) => text(row.children[3 + index], number));
    });
    hint.hidden = chosen !== null;
    text(title, chosen ?? "Messages");
    const known = [...(fleet.topics.get(chosen)?.entries() ?? [])].sort(([, a], [, b]) => b.time_s - a.time_s).slice(0, 100);
    const makeMessage = ([, one]) => h("tr", {}, h("td", { class: "figure" }), h("td", {}, h("a", { href: open(one.component) }, one.component)), h("td", { class: "what" }));
    keyed(messages, known, ([name]) => name, makeMessage, (row, [, one]) => {
      text(row.firstChild, time(one.time_s));
      text(row.lastChild, Object.entries(one.message ?? {}).map(([field, value]) => `${field} ${shown(value)}`).join(" · "));
    });
  }

  const timer = setInterval(() => fleet.isConnected && fleet.loadTopics().catch(() => {}), 3000);
  return { element, update, every: 500, close: () => clearInterval(timer) };
}

export function alerts({ fleet, orders, open }) {
  const list = h("ol", { class: "alerts" });
  const none = h("p", { class: "empty" }, "No alerts: nothing needs a person.");
  const isTaken = (id) => fleet.alerts.get(id)?.acknowledged != null;
  const all = orders.button("Acknowledge all", { order: () => orders.acknowledge(), isDone: () => fleet.waiting().length === 0 });
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Alerts"), all), none, list);

  function make(alert) {
    const button = orders.button("Acknowledge", { order: () => orders.acknowledge(alert.id), isDone: () => isTaken(alert.id) });
    const since = h("time", { class: "figure", title: alert.date });
    const where = alert.component ? h("a", { href: open(alert.component) }, alert.component) : h("span", {}, "the fleet");
    const what = h("span", { class: "what" });
    const status = h("span", { class: "muted" });
    return Object.assign(h("li", {}, h("span", { class: "kind" }, alert.kind.replaceAll("_", " ")), h("span", { class: "body" }, where, " ", what, " ", status), since, button), { button, what, status, since });
  }

  function show(item, alert) {
    const isOver = alert.over_s !== null;
    item.className = isOver || alert.acknowledged ? "past" : "";
    text(item.what, alert.subject ? `${alert.text} (${alert.subject})` : alert.text);
    text(item.since, time(alert.time_s));
    const said = [alert.acknowledged && `acknowledged by ${alert.acknowledged.by}`, isOver && `over at ${time(alert.over_s)}`];
    text(item.status, said.filter(Boolean).join(", "));
    item.button.hidden = isOver || alert.acknowledged !== null;
  }

  function update() {
    const order = (alert) => (alert.over_s === null && alert.acknowledged === null ? 0 : 1);
    const sorted = [...fleet.alerts.values()].sort((a, b) => order(a) - order(b) || b.id - a.id);
    none.hidden = sorted.length > 0;
    all.hidden = fleet.waiting().length < 2;
    keyed(list, sorted, (alert) => alert.id, make, show);
  }

  return { element, update, every: 200 };
}

export function log({ fleet, open }) {
  const list = h("ol", { class: "log" });
  const levels = h("select", { "aria-label": "Level", onchange: () => update() }, ...["info", "warning", "error"].map((level) => h("option", { value: level }, level === "info" ? "all" : `${level}s`)));
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Log"), levels), list);
  const rank = { error: 3, warning: 2, info: 1 };
  let number = 0;

  function update() {
    const shownLines = fleet.log.filter((line) => (rank[line.level] ?? 0) >= rank[levels.value]).slice(-500).reverse();
    const make = (line) =>
      h("li", { class: line.level }, h("time", { class: "figure", title: line.date }, time(line.time_s)), h("span", { class: "who" }, line.component ? h("a", { href: open(line.component) }, line.component) : "fleet"), h("span", { class: "what" }, line.text));
    keyed(list, shownLines, (line) => (line.number ??= ++number), make, () => {});
  }

  return { element, update, every: 300 };
}

export function assembly() {
  const place = h("div", { class: "scroll picture" });
  const note = h("p", { class: "muted" }, "The composites as saoms graph draws them.");
  const whole = h("a", { href: "/v1/picture.svg", target: "_blank", rel: "noopener" }, "In a window of its own");
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Assembly"), note, whole), place);
  const picture = h("img", { src: "/v1/picture.svg", alt: "Components with their wires and topics" });
  picture.addEventListener("error", async () => {
    const answer = await fetch("/v1/picture.svg").catch(() => null);
    const content = await answer?.json().catch(() => null);
    place.replaceChildren(h("p", { class: "empty" }, content?.error ?? "The picture cannot be loaded."));
  });
  place.append(picture);
  return { element, update: () => {}, every: 60000 };
}
