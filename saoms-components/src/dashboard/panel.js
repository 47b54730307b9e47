// What stands beside the map: orders, the chosen robot, conflicts, and all robots in a table.

import { Rows, h, keyed, shown, text, time } from "/assets/dom.js";
import { place, same } from "./state.js";

/** A block as people write it: `(3,1)`, `3,1` or `3 1`. */
export function block(written) {
  const [, x, y] = /^\s*\(?\s*(-?\d+)\s*[,;\s]\s*(-?\d+)\s*\)?\s*$/.exec(written) ?? [];
  return x === undefined ? null : { x: Number(x), y: Number(y) };
}

/** The form that sends luggage. A click on the map fills the field in which the cursor is. */
export function sending(floor, orders, map) {
  const field = (label, example) => h("input", { inputmode: "text", placeholder: example, "aria-label": label, size: 7, autocomplete: "off", oninput: () => mark() });
  const [from, to] = [field("Block where the luggage is", "from"), field("Block where it has to go", "to")];
  let last = null;
  for (const one of [from, to]) one.addEventListener("focus", () => (last = one));
  const button = orders.button("Send luggage", {
    kind: "primary",
    title: "saoms send \"luggage (3,1) to (3,10)\"",
    order: send,
    // It is on the floor, or so soon delivered that only the counts show it.
    isDone: ({ ends, known, summaries }) => floor.luggage.some((one) => !known.has(one.number) && same(one.from, ends[0]) && same(one.to, ends[1])) || floor.fleet.state.summaries.join() !== summaries,
  });
  const hint = h("p", { class: "muted hint" }, "Write blocks, or choose a field and click them on the map.");
  const form = h("form", { class: "sending", onsubmit: (event) => (event.preventDefault(), button.click()) }, from, h("span", { class: "muted" }, "to"), to, button);

  async function send() {
    const ends = [block(from.value), block(to.value)];
    const wrong = ends[0] === null ? from : ends[1] === null ? to : null;
    if (wrong) {
      wrong.focus();
      orders.tell("error", "A block is its column and its row, such as (3,1).");
      return null;
    }
    const known = new Set(floor.luggage.map((one) => one.number));
    const summaries = floor.fleet.state.summaries.join();
    const answer = await orders.line(floor.line(`luggage ${place(ends[0])} to ${place(ends[1])}`));
    if (answer === null) return null;
    from.value = to.value = "";
    last = null;
    mark();
    return { ends, known, summaries };
  }

  function mark() {
    map().marked = [block(from.value), block(to.value)];
    map().redraw();
  }

  /** Takes a block of the map; `false` if nobody wants one. */
  function pick(picked) {
    if (!last || !orders.mayOrder || !form.isConnected) return false;
    last.value = place(picked);
    const next = last === from && to.value === "" ? to : null;
    last = null;
    if (next) next.focus();
    else button.focus();
    mark();
    return true;
  }

  if (!orders.mayOrder) for (const one of [from, to]) one.disabled = true;
  return { element: h("section", { class: "panel" }, h("h2", {}, "Luggage"), form, hint), pick, hint };
}

/** The chosen robot, with the orders for it. */
export function chosen(floor, orders, open, path) {
  const robot = () => floor.robots.get(path) ?? {};
  const is = (wanted) => () => wanted(robot());
  const facts = h("dl", { class: "facts" });
  const state = h("span", { class: "state" });
  const more = h("a", { href: open(path) }, "Loops and why ›");
  const [stop, release, breakDown, wake, sleep] = [
    orders.button("Stop", { kind: "danger", title: "Emergency stop of this robot: saoms estop", order: () => orders.stop(path), isDone: is((one) => one.isStopped) }),
    orders.button("Release", { title: "saoms release", order: () => orders.release(path), isDone: is((one) => !one.isStopped) }),
    orders.button("Break down", { title: "saoms send \"breakdown ROBOT\"", confirm: `Let ${path} break down?`, order: () => orders.line(floor.line(`breakdown ${path}`)), isDone: is((one) => one.isBroken) }),
    orders.button("Wake", { title: "Schedule its component: saoms start", order: () => orders.component(path, "start"), isDone: is((one) => !one.isOff) }),
    orders.button("Sleep", { title: "Unschedule its component: saoms stop", order: () => orders.component(path, "stop"), isDone: is((one) => one.isOff) }),
  ];
  const buttons = h("div", { class: "orders" }, stop, release, breakDown, wake, sleep);
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, path), state, more), facts, buttons);

  function update() {
    const one = robot();
    text(state, one.state ?? "unknown");
    [stop.hidden, release.hidden] = [one.isStopped, !one.isStopped];
    [wake.hidden, sleep.hidden] = [!one.isOff, one.isOff];
    breakDown.hidden = one.isOff || one.isBroken;
    state.className = `state ${tone(one)}`;
    const rows = [
      ["battery", one.battery === undefined ? "–" : `${shown(one.battery)} %`],
      ["block", place(one.block)],
      ["delivered", shown(one.delivered)],
      ["job", one.job ?? "none"],
    ];
    if (one.waitsFor) rows.push(["waits for robot", `${one.waitsFor} since ${time(one.since)}`]);
    keyed(facts, rows, ([name]) => name, ([name]) => h("div", {}, h("dt", {}, name), h("dd", {})), (row, [, value]) => text(row.lastChild, value));
    element.classList.toggle("stale", Boolean(one.isStale));
  }

  return { element, update };
}

/** Robots that wait for each other, now and before. */
export function conflicts(floor, choose) {
  const list = h("ol", { class: "conflicts" });
  const none = h("p", { class: "empty" }, "No robot waits for another one.");
  const element = h("section", { class: "panel" }, h("h2", {}, "Conflicts"), none, list);
  const robot = (path) => h("button", { class: "plain link", onclick: () => choose(path) }, path);

  function update() {
    const { fleet } = floor;
    const all = [...floor.conflicts.values(), ...floor.past.filter((one) => !floor.conflicts.has(one.key))].slice(0, 60);
    none.hidden = all.length > 0;
    const make = () => h("li", {}, h("p", {}), h("p", { class: "muted" }, h("span", {}), h("span", {})));
    keyed(list, all, (one) => one.key, make, (item, one) => {
      item.className = one.until === null ? "" : "past";
      const [head, why] = item.children;
      const block = place(one.block);
      if (head.dataset.of !== `${one.winner} ${block}`) {
        head.dataset.of = `${one.winner} ${block}`;
        // One that waits for the other to give way goes first itself.
        const waits = one.winner === one.robot ? [", and waits for ", robot(one.other), " to give way"] : [", ", robot(one.robot), " waits"];
        head.replaceChildren(robot(one.winner), " goes first", ...waits, one.block ? ` at ${block}` : "");
      }
      text(why.firstChild, one.reason);
      const lasts = (one.until ?? fleet.state.time_s) - one.since;
      text(why.lastChild, one.since === null ? "" : ` · ${lasts.toFixed(1)} s${one.until === null ? "" : `, until ${time(one.until)}`}`);
    });
  }

  return { element, update };
}

/** The class of a robot's state, for its colour. */
function tone(robot) {
  if (robot.isBroken) return "failed";
  if (robot.isStopped) return "stopped";
  return robot.state === "carries luggage" ? "running" : robot.state === "goes to luggage" ? "way" : robot.state === "charges" || robot.state === "goes to charge" ? "charge" : "";
}

/** All robots. */
export function robots(floor, choose) {
  let filter = "";
  const search = h("input", { type: "search", placeholder: "Filter", "aria-label": "Filter robots", oninput: () => ((filter = search.value.toLowerCase()), update()) });
  const body = h("tbody");
  const count = h("span", { class: "muted" });
  const head = ["Robot", "State", "Battery", "Block", "Delivered"].map((name, index) => h("th", { scope: "col", class: index > 1 ? "figure" : null }, name));
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Robots"), count, search), h("div", { class: "scroll tall" }, h("table", { class: "robots" }, h("thead", {}, h("tr", {}, ...head)), body)));
  let selected = null;

  const make = (robot) => {
    const button = h("button", { class: "plain link", onclick: () => choose(robot.path) }, robot.path);
    const state = h("span", { class: "state" });
    const row = h("tr", { "data-robot": robot.path }, h("td", {}, button), h("td", {}, state), ...[0, 1, 2].map(() => h("td", { class: "figure" })));
    return Object.assign(row, { state });
  };

  const show = (row, robot) => {
    text(row.state, robot.state);
    classed(row.state, `state ${tone(robot)}`);
    text(row.children[2], robot.battery === undefined ? "–" : `${Math.round(robot.battery)} %`);
    text(row.children[3], place(robot.block));
    text(row.children[4], shown(robot.delivered));
    classed(row, `${robot.path === selected ? "chosen" : ""} ${robot.isStale ? "stale" : ""}`.trim());
  };

  function update(path = selected) {
    selected = path;
    const all = [...floor.robots.values()];
    const wanted = filter ? all.filter((robot) => `${robot.path} ${robot.state} ${robot.job ?? ""}`.toLowerCase().includes(filter)) : all;
    text(count, wanted.length === all.length ? all.length : `${wanted.length} of ${all.length}`);
    rows.update(wanted, (robot) => robot.path);
  }

  const rows = new Rows(body, make, show);
  return { element, update, close: () => rows.close() };
}

function classed(element, value) {
  if (element.className !== value) element.className = value;
}
