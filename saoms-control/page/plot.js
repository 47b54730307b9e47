// Figures over time, as lines.

import { h, s, shown, text, time } from "./dom.js";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [520, 160, 58, 12, 10, 22];
/** Points that a line has at most: more cannot be told apart. */
const POINTS = 900;
/** Seconds of growth from which on a figure of a minute says something. */
const LEAST_GROWTH_S = 3;

/** A step of a scale: 1, 2 or 5 times a power of ten. */
function step(range, most) {
  const rough = range / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((times) => times * power).find((one) => one >= rough);
}

/** The values of a line: those of its column, or how much it grows in so many seconds. */
function valuesOf(rows, { column, per_s }) {
  if (per_s === null) return rows.map((row) => row[column]);
  let first = 0;
  return rows.map(([now, ...values], index) => {
    while (first < index - 1 && rows[first + 1][0] <= now - per_s) first += 1;
    const seconds = now - rows[first][0];
    if (seconds <= 0 || seconds < Math.min(LEAST_GROWTH_S, per_s)) return null;
    const [before, after] = [rows[first][column], values[column - 1]];
    // Who counts has begun anew, or nobody counts: then nothing is known.
    if (!Number.isFinite(before) || !Number.isFinite(after) || after < before) return null;
    return Math.round(((after - before) / seconds) * per_s * 10) / 10;
  });
}

export class Plot {
  /** `lines` are titles with the columns of rows; `format` shows a value. */
  constructor(title, lines, format = shown) {
    Object.assign(this, { lines, format });
    this.svg = s("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": title, class: "plot" });
    this.grid = s("g", { class: "grid" });
    this.paths = lines.map((_, index) => s("path", { class: `line line${index}` }));
    this.cursor = s("line", { class: "cursor", y1: TOP, y2: HEIGHT - BOTTOM, visibility: "hidden" });
    this.svg.append(this.grid, ...this.paths, this.cursor);
    this.values = lines.map(() => h("b", { class: "figure" }));
    const legend = lines.map(({ title }, index) => h("span", { class: `key key${index}` }, title, " ", this.values[index]));
    this.when = h("span", { class: "when" });
    this.element = h("figure", {}, h("figcaption", {}, h("h2", {}, title), h("p", { class: "legend" }, ...legend, this.when)), this.svg);
    this.times = [];
    this.series = [];
    this.at = null;
    this.now = null;
    this.svg.addEventListener("pointermove", (event) => this.#point(event));
    this.svg.addEventListener("pointerleave", () => this.#point(null));
  }

  #point(event) {
    if (!event || this.times.length === 0) this.at = null;
    else {
      const box = this.svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * WIDTH;
      const [from, to] = this.range;
      this.at = this.#nearest(from + ((x - LEFT) / (WIDTH - LEFT - RIGHT)) * (to - from));
    }
    this.#values();
  }

  /** The place of the row whose time is nearest. */
  #nearest(wanted) {
    let [low, high] = [0, this.times.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < wanted) low = middle + 1;
      else high = middle;
    }
    return low > 0 && wanted - this.times[low - 1] < this.times[low] - wanted ? low - 1 : low;
  }

  #values() {
    const moment = this.at ?? (this.now === null ? null : this.#nearest(this.now));
    const place = moment ?? this.times.length - 1;
    this.series.forEach((values, index) => text(this.values[index], (values[place] ?? null) === null ? "–" : this.format(values[place])));
    text(this.when, this.at === null ? "" : `at ${time(this.times[this.at])}`);
    const marked = this.at === null ? this.now : this.times[this.at];
    if (marked !== null && this.x) {
      const x = this.x(marked);
      this.cursor.setAttribute("x1", x);
      this.cursor.setAttribute("x2", x);
    }
    this.cursor.setAttribute("visibility", marked === null ? "hidden" : "visible");
  }

  /** Shows these rows; `now` is a time to mark, of a run that has ended. */
  update(rows, now = null) {
    this.now = now;
    if (rows.length !== this.times.length) this.#draw(rows);
    this.#values();
  }

  #draw(rows) {
    this.times = rows.map(([at]) => at);
    this.series = this.lines.map((line) => valuesOf(rows, line));
    const to = this.times.at(-1) ?? 0;
    const from = Math.min(this.times[0] ?? 0, to - 10);
    this.range = [from, to];
    let highest = 0;
    for (const values of this.series) for (const value of values) if (value > highest) highest = value;
    highest ||= 1;
    const every = step(highest, 3) ?? 1;
    const top = Math.ceil(highest / every - 1e-9) * every;
    this.x = (at) => LEFT + ((at - from) / (to - from || 1)) * (WIDTH - LEFT - RIGHT);
    const y = (value) => HEIGHT - BOTTOM - (value / top) * (HEIGHT - TOP - BOTTOM);
    const grid = [];
    for (let value = 0; value <= top * 1.0001; value += every) {
      grid.push(s("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(value), y2: y(value) }));
      grid.push(s("text", { x: LEFT - 6, y: y(value) + 3.5, "text-anchor": "end" }, this.format(value)));
    }
    grid.push(s("text", { x: LEFT, y: HEIGHT - 6 }, time(Math.max(0, from))));
    grid.push(s("text", { x: WIDTH - RIGHT, y: HEIGHT - 6, "text-anchor": "end" }, time(to)));
    this.grid.replaceChildren(...grid);
    const group = Math.ceil(this.times.length / POINTS);
    this.series.forEach((values, index) => this.paths[index].setAttribute("d", this.#path(values, group, y)));
  }

  /** The path of a line. Of each group of values, the least and the greatest are drawn, so that no peak is lost. */
  #path(values, group, y) {
    let [path, isOpen] = ["", false];
    const point = (place) => {
      path += `${isOpen ? "L" : "M"}${this.x(this.times[place]).toFixed(1)} ${y(values[place]).toFixed(1)}`;
      isOpen = true;
    };
    for (let from = 0; from < values.length; from += group) {
      let [least, most] = [null, null];
      for (let place = from; place < Math.min(from + group, values.length); place++) {
        if (!Number.isFinite(values[place])) continue;
        if (least === null || values[place] < values[least]) least = place;
        if (most === null || values[place] > values[most]) most = place;
      }
      if (least === null) isOpen = false;
      else for (const place of new Set([Math.min(least, most), Math.max(least, most)])) point(place);
    }
    return path;
  }
}
