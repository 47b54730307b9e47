// One component: what it says of itself, what its loops did, and why.

import { ago, classes, h, keyed, micros, s, shown, text, time } from "./dom.js";
import { state } from "./components.js";

/** Seconds of the time line. */
const SPANS = [30, 120, 600];
const [LANE, LEFT, RIGHT, TOP, BOTTOM] = [28, 150, 26, 8, 22];
/** Records that are listed. */
const LISTED = 200;
const OWN = "(itself)";

export function component(name, { fleet, orders, open }) {
  const title = h("h2", {}, name);
  const badge = h("span", { class: "state" });
  const kind = h("span", { class: "muted" });
  const age = h("span", { class: "muted age" });
  const is = (wanted) => () => wanted(fleet.components.get(name) ?? {});
  const [stop, release, start, end] = [
    orders.button("Emergency stop", { kind: "danger", title: "Stop its hardware at once: saoms estop", order: () => orders.stop(name), isDone: is((one) => one.emergency_stop) }),
    orders.button("Release", { title: "Release from the emergency stop: saoms release", order: () => orders.release(name), isDone: is((one) => !one.emergency_stop) }),
    orders.button("Start", { title: "Schedule the component: saoms start", order: () => orders.component(name, "start"), isDone: is((one) => one.state === "running") }),
    orders.button("Stop", { title: "Unschedule the component: saoms stop", order: () => orders.component(name, "stop"), isDone: is((one) => one.state === "idle") }),
  ];
  const buttons = h("div", { class: "orders" }, stop, release, start, end);
  const facts = h("dl", { class: "facts" });
  const line = new TimeLine((record) => explain(record.time_s));
  const list = h("ol", { class: "records" });
  const none = h("p", { class: "empty" }, "Its loops have recorded nothing yet.");
  const why = h("div", { class: "why" });
  const ask = h("button", { onclick: () => explain(null) }, "Explain its last action");
  const element = h(
    "section",
    { class: "panel component" },
    h("div", { class: "bar" }, h("a", { href: "#/components", class: "back", "aria-label": "All components" }, "‹"), title, badge, kind, age, buttons),
    facts,
    h("div", { class: "bar" }, h("h3", {}, "What its loops did"), line.legend, line.spans),
    line.element,
    h("div", { class: "columns" }, h("div", {}, h("div", { class: "bar" }, h("h3", {}, "Records")), none, list), h("div", {}, h("div", { class: "bar" }, h("h3", {}, "Why"), ask), why)),
  );

  async function explain(at) {
    why.replaceChildren(h("p", { class: "muted" }, "…"));
    const told = await fleet.why(name, at).catch(() => null);
    if (!told?.isOk) return why.replaceChildren(h("p", { class: "empty" }, told?.content?.error ?? "The fleet cannot be reached."));
    why.replaceChildren(...explanation(told.content.answer, name, open));
  }

  function update() {
    const one = fleet.components.get(name);
    if (!one?.name) {
      text(kind, fleet.components.size ? "The fleet has no such component." : "");
      return;
    }
    text(badge, state(one));
    badge.className = `state ${state(one)}`;
    text(kind, one.class);
    // A passive component is never scheduled.
    const isPeriodic = one.period_ms != null;
    [stop.hidden, release.hidden] = [one.emergency_stop, !one.emergency_stop];
    [start.hidden, end.hidden] = [!isPeriodic || one.state === "running", !isPeriodic || one.state !== "running"];
    const seconds = fleet.age(one);
    text(age, fleet.isFinished ? "" : seconds === null ? "it has said nothing yet" : `said ${ago(seconds)}`);
    element.classList.toggle("stale", fleet.isStale(one));
    const rows = Object.entries(one.values ?? {}).map(([field, value]) => [field.replaceAll("_", " "), shown(value)]);
    if (one.waits_for) rows.push(["waits for", one.waits_for]);
    if (one.period_ms) rows.push(["period", `${shown(one.period_ms)} ms`]);
    rows.push(["executions", shown(one.executions)], ["missed", shown(one.missed)], ["failures", shown(one.failures)], ["late, 99 %", micros(one.late_us?.p99)]);
    keyed(facts, rows, ([field]) => field, ([field]) => h("div", {}, h("dt", {}, field), h("dd", {})), (row, [, value]) => text(row.lastChild, value));
    const records = fleet.records.component === name ? fleet.records.all : [];
    none.hidden = records.length > 0;
    if (fleet.records.error) text(none, fleet.records.error);
    line.update(records, fleet.state.time_s);
    keyed(list, records.slice(-LISTED).reverse(), (record) => record.id, (record) => recordItem(record, () => explain(record.time_s)), () => {});
  }

  return { element, update, every: 400, wants: { component: name } };
}

/** A record in the list. Its button does what a click on its mark in the time line does, which no key reaches. */
function recordItem(record, choose) {
  return h(
    "li",
    {},
    h("button", { class: "link", title: "Explain this moment", onclick: choose }, h("time", { class: "figure" }, time(record.time_s, true))),
    h("span", { class: `phase ${record.phase}` }, record.phase),
    h("span", { class: "loop" }, record.loop ?? ""),
    h("span", { class: "what" }, record.text),
  );
}

/** What led to an act, as `saoms why` tells it. */
export function explanation(answer, name, open) {
  if (!answer || answer.time_s === null) return [h("p", { class: "empty" }, "It has not acted yet, or its records were overwritten.")];
  const parts = [h("p", {}, `It acted at ${time(answer.time_s)}; this led to it:`)];
  for (const chain of answer.chains) {
    const items = [...chain.acts, ...chain.reasons].map((record) =>
      h(
        "li",
        {},
        h("time", { class: "figure" }, time(record.time_s, true)),
        h("span", { class: `phase ${record.phase}` }, record.phase),
        h("span", { class: "loop" }, record.component === name ? "" : h("a", { href: open(record.component) }, record.component), record.component === name ? (record.loop ?? "") : ""),
        h("span", { class: "what" }, record.text),
      ),
    );
    parts.push(h("ol", { class: "records chain" }, ...items));
    if (chain.missing) parts.push(h("p", { class: "muted" }, "Earlier records were overwritten."));
  }
  if (answer.knowledge.length) {
    parts.push(h("h4", {}, "What it knew"));
    const rows = answer.knowledge.map(({ entry, value, since_s }) => h("div", {}, h("dt", {}, entry), h("dd", { title: since_s === null ? "from before" : `since ${time(since_s)}` }, shown(value))));
    parts.push(h("dl", { class: "facts" }, ...rows));
  }
  return parts;
}

/** Records in lanes, one for each loop: symptoms, decisions and effects, with what led to what. */
class TimeLine {
  constructor(choose) {
    this.choose = choose;
    this.span = SPANS[0];
    this.svg = s("svg", { class: "timeline", role: "img", "aria-label": "Symptoms, decisions and effects of each loop over time" });
    this.element = h("div", { class: "scroll" }, this.svg);
    const mark = (phase) => h("span", { class: "key" }, s("svg", { viewBox: "-7 -7 14 14", width: 14, height: 14, "aria-hidden": "true" }, shape(phase, 0, 0)), phase);
    this.legend = h("p", { class: "legend" }, mark("symptom"), mark("decision"), mark("effect"));
    const choices = SPANS.map((span) => h("button", { class: "plain", onclick: () => this.#look(span), "aria-pressed": span === this.span }, span < 120 ? `${span} s` : `${span / 60} min`));
    this.spans = h("div", { class: "choices", role: "group", "aria-label": "Length of the time line" }, ...choices);
    this.last = null;
  }

  #look(span) {
    this.span = span;
    [...this.spans.children].forEach((one, index) => one.setAttribute("aria-pressed", SPANS[index] === span));
    if (this.last) this.update(...this.last);
  }

  update(records, now) {
    this.last = [records, now];
    const lanes = [...new Set(records.map((record) => record.loop ?? OWN))];
    const height = TOP + lanes.length * LANE + BOTTOM;
    const width = Math.max(620, this.element.clientWidth);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    classes(this.svg, lanes.length ? "timeline" : "timeline none");
    const x = (at) => LEFT + (1 - (now - at) / this.span) * (width - LEFT - RIGHT);
    const y = (loop) => TOP + (lanes.indexOf(loop ?? OWN) + 0.5) * LANE;
    const seen = records.filter((record) => record.time_s >= now - this.span);
    const places = new Map();
    // What happens in one execution stands side by side.
    const taken = new Map();
    for (const record of seen) {
      const spot = `${record.loop}/${record.time_s}`;
      const shift = taken.get(spot) ?? 0;
      taken.set(spot, shift + 1);
      places.set(record.id, [x(record.time_s) + shift * 5, y(record.loop)]);
    }
    const parts = [];
    lanes.forEach((loop, index) => {
      const middle = TOP + (index + 0.5) * LANE;
      parts.push(s("line", { class: "lane", x1: LEFT, x2: width - RIGHT, y1: middle, y2: middle }));
      parts.push(s("text", { x: LEFT - 10, y: middle + 4, "text-anchor": "end" }, loop));
    });
    const tick = this.span / 6;
    for (let at = Math.ceil((now - this.span) / tick) * tick; at <= now; at += tick) {
      if (at < 0) continue;
      parts.push(s("line", { class: "tick", x1: x(at), x2: x(at), y1: TOP, y2: height - BOTTOM }));
      parts.push(s("text", { class: "at", x: x(at), y: height - 6, "text-anchor": "middle" }, time(Math.round(at))));
    }
    for (const record of seen) {
      const [from, to] = [places.get(record.cause), places.get(record.id)];
      if (from && from[1] !== to[1]) parts.push(s("path", { class: "cause", d: `M${from[0]} ${from[1]}C${from[0]} ${(from[1] + to[1]) / 2} ${to[0]} ${(from[1] + to[1]) / 2} ${to[0]} ${to[1]}` }));
    }
    for (const record of seen) {
      const mark = shape(record.phase, ...places.get(record.id));
      mark.append(s("title", {}, `${time(record.time_s)} ${record.phase}: ${record.text}`));
      mark.addEventListener("click", () => this.choose(record));
      parts.push(mark);
    }
    this.svg.replaceChildren(...parts);
  }
}

function shape(phase, x, y) {
  const forms = {
    symptom: () => s("circle", { cx: x, cy: y, r: 4.5 }),
    decision: () => s("path", { d: `M${x} ${y - 6}l6 6l-6 6l-6 -6z` }),
    effect: () => s("rect", { x: x - 4.5, y: y - 4.5, width: 9, height: 9, rx: 1.5 }),
  };
  const mark = (forms[phase] ?? forms.symptom)();
  mark.setAttribute("class", `mark ${phase}`);
  return mark;
}
