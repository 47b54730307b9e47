// The view of a fleet of robots: the map, and what stands beside it.

import { h, text } from "/assets/dom.js";
import { FloorMap } from "./draw.js";
import { chosen, conflicts, robots, sending } from "./panel.js";
import { Floor, siteOf } from "./state.js";

/** Robots from which on grants and chargers are left out unless they are asked for. */
const MANY = 200;

/** True for a fleet with robots. */
export const shows = (fleet) => fleet.topicList.some((topic) => topic.message === "Position");

export function view({ fleet, orders, open, follow }) {
  const floor = new Floor(fleet);
  floor.site = floor.sites()[0] ?? null;
  let card = null;
  const map = new FloorMap(floor, { choose, pick: (block) => sent.pick(block) });
  const sent = sending(floor, orders, () => map);
  const met = conflicts(floor, choose);
  const table = robots(floor, choose);
  const place = h("div", { hidden: true });
  const counts = h("p", { class: "counts", role: "status" });
  const toggle = (name, label) => {
    const box = h("input", { type: "checkbox", onchange: () => ((map.layers[name] = box.checked), follow({ topics: wanted() }), map.redraw()) });
    return Object.assign(h("label", { class: "layer" }, box, label), { box });
  };
  const layers = { grants: toggle("grants", "Grants"), chargers: toggle("chargers", "Chargers") };
  const isLarge = fleet.topicList.some((topic) => topic.message === "Position" && topic.publishers.length > MANY);
  for (const [name, { box }] of Object.entries(layers)) map.layers[name] = box.checked = !isLarge;
  const zoom = (label, sign, act) => h("button", { class: "plain", "aria-label": label, title: label, onclick: act }, sign);
  const tools = h("div", { class: "tools" }, ...Object.values(layers), zoom("Larger", "+", () => map.zoom(1.3)), zoom("Smaller", "−", () => map.zoom(1 / 1.3)), zoom("Whole map", "⤢", () => map.fit()));
  const sites = floor.sites();
  if (sites.length > 1) {
    const select = h("select", { "aria-label": "Site", onchange: () => (floor.show(select.value), (map.fitted = null), (map.isFitted = true), follow({ topics: wanted() })) }, ...sites.map((name) => h("option", { value: name }, siteOf(name) || "main")));
    tools.prepend(select);
  }
  const legend = h("p", { class: "legend" }, ...[["free", "free"], ["way", "goes to luggage"], ["carries", "carries"], ["charge", "charges"], ["off", "asleep"], ["broken", "stopped, or needs help"]].map(([name, label]) => h("span", { class: `robot-key ${name}` }, label)));
  const keys = h("p", { class: "muted keys" }, "Keys on the map: arrows move it, + and − change its size, 0 shows all, n and p choose a robot.");
  const element = h("div", { class: "floor" }, h("section", { class: "panel map" }, h("div", { class: "bar" }, counts, tools), map.canvas, legend, keys), h("div", { class: "side" }, place, fleet.isFinished ? null : sent.element, met.element, table.element));

  function wanted() {
    const types = ["Position", "Area", "Territory"];
    if (map.layers.grants) types.push("Grant");
    if (map.layers.chargers) types.push("RobotList");
    return types.flatMap((type) => floor.topics(type));
  }

  function choose(path) {
    map.selected = path;
    card = path === null ? null : chosen(floor, orders, open, path);
    place.hidden = card === null;
    place.replaceChildren(...(card ? [card.element] : []));
    card?.update();
    table.update(path);
    if (path) map.reveal(path);
    map.redraw();
  }

  let [last, later] = [-Infinity, null];
  function update() {
    floor.update();
    map.redraw();
    card?.update();
    const passed = performance.now() - last;
    if (passed < 400) return (later ??= setTimeout(() => ((later = null), update()), 400 - passed));
    last = performance.now();
    const stopped = [...floor.robots.values()].filter((robot) => robot.isBroken).length;
    const unclaimed = floor.luggage.filter((one) => one.waits).length;
    const parts = [floor.robots.size === 1 ? "1 robot" : `${floor.robots.size} robots`, floor.luggage.length === 1 ? "1 open piece" : `${floor.luggage.length} open pieces`];
    if (unclaimed) parts.push(`${unclaimed} without a robot`);
    if (floor.conflicts.size) parts.push(`${floor.conflicts.size} waiting for others`);
    if (stopped) parts.push(`${stopped} ${stopped === 1 ? "needs" : "need"} help`);
    text(counts, parts.join(" · "));
    map.canvas.setAttribute("aria-label", `Map: ${parts.join(", ")}. The table of robots has the same in words.`);
    met.update();
    table.update();
  }

  return { element, update, every: 100, wants: { topics: wanted() }, close: () => (clearTimeout(later), map.close(), table.close()) };
}
