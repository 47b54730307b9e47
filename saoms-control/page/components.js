// All components in a table.

import { Rows, classes, h, micros, shown, text } from "./dom.js";

const COLUMNS = [
  { name: "name", title: "Component", of: (one) => one.name },
  { name: "state", title: "State", of: (one) => (one.emergency_stop ? "stopped" : one.state) },
  { name: "details", title: "Details", of: (one) => details(one) },
  { name: "late", title: "Late, 99 %", of: (one) => one.late_us?.p99 ?? -1, show: (one) => micros(one.late_us?.p99), isFigure: true },
  { name: "missed", title: "Missed", of: (one) => one.missed ?? 0, isFigure: true },
  { name: "failures", title: "Failures", of: (one) => one.failures ?? 0, isFigure: true },
  { name: "executions", title: "Executions", of: (one) => one.executions ?? 0, isFigure: true },
];

/** True for lists that say nothing in a line. */
const isLong = (value) => Array.isArray(value) && (value.length === 0 || value.some((one) => typeof one === "object"));

/** What a component says of itself, in a line. */
export function details(component) {
  if (component.in_code_s > 1) return `has been in its code for ${component.in_code_s.toFixed(0)} s`;
  const values = Object.entries(component.values ?? {}).filter(([, value]) => value !== null && !isLong(value));
  const said = values.map(([name, value]) => (name === "state" ? shown(value) : `${name.replaceAll("_", " ")} ${shown(value)}`));
  return said.join(" · ") || (component.waits_for ? `waits for ${component.waits_for}` : "");
}

/** A word for the state of a component, with a colour. */
export const state = (component) => (component.emergency_stop ? "stopped" : (component.state ?? ""));

export function components({ fleet, open }) {
  let sorted = { column: null, isDown: false };
  let filter = "";
  const search = h("input", { type: "search", placeholder: "Filter", "aria-label": "Filter components", oninput: () => ((filter = search.value.toLowerCase()), update()) });
  const count = h("span", { class: "muted" });
  const heads = COLUMNS.map((column) =>
    h("th", { scope: "col", class: column.isFigure ? "figure" : null }, h("button", { class: "plain", onclick: () => sort(column) }, column.title)),
  );
  const body = h("tbody");
  const element = h("section", { class: "panel" }, h("div", { class: "bar" }, h("h2", {}, "Components"), count, search), h("div", { class: "scroll" }, h("table", { class: "components" }, h("thead", {}, h("tr", {}, ...heads)), body)));

  function sort(column) {
    sorted = sorted.column === column ? (sorted.isDown ? { column: null } : { column, isDown: true }) : { column, isDown: false };
    heads.forEach((head, index) => {
      if (COLUMNS[index] === sorted.column) head.setAttribute("aria-sort", sorted.isDown ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    update();
  }

  function make(one) {
    const link = h("a", { href: open(one.name) }, one.name);
    const badge = h("span", { class: "state" });
    const cells = COLUMNS.map((column) => h("td", { class: column.isFigure ? "figure" : column.name === "details" ? "details" : null }));
    cells[0].append(link);
    cells[1].append(badge);
    const row = h("tr", {}, ...cells);
    Object.assign(row, { badge, shownCells: cells });
    return row;
  }

  function show(row, one) {
    text(row.badge, state(one));
    classes(row.badge, `state ${state(one)}`);
    row.classList.toggle("stale", fleet.isStale(one));
    COLUMNS.forEach((column, index) => index > 1 && text(row.shownCells[index], column.show ? column.show(one) : column.of(one)));
    const said = row.shownCells[2];
    if (said.title !== said.textContent) said.title = said.textContent;
  }

  function update() {
    let all = [...fleet.components.values()].filter((one) => one.name);
    const total = all.length;
    if (filter) all = all.filter((one) => `${one.name} ${one.class} ${state(one)} ${details(one)}`.toLowerCase().includes(filter));
    const { column, isDown } = sorted;
    if (column) {
      const compare = (a, b) => (column.isFigure ? column.of(a) - column.of(b) : String(column.of(a)).localeCompare(String(column.of(b)), undefined, { numeric: true }));
      all.sort((a, b) => (isDown ? -compare(a, b) : compare(a, b)));
    }
    text(count, all.length === total ? `${total}` : `${all.length} of ${total}`);
    rows.update(all, (one) => one.name);
  }

  const rows = new Rows(body, make, show);
  return { element, update, every: 500, close: () => rows.close() };
}
