// Figures over time, as lines.

import { h, s, shown, text, time } from "./dom.js";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [520, 160, 58, 12, 10, 22];

/** A step of a scale: 1, 2 or 5 times a power of ten. */
function step(range, most) {
  const rough = range / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((times) => times * power).find((one) => one >= rough);
}

export class Plot {
  /** `lines` are the names of figures, with what they are called; `format` shows a value. */
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
    this.samples = [];
    this.at = null;
    this.svg.addEventListener("pointermove", (event) => this.#point(event));
    this.svg.addEventListener("pointerleave", () => this.#point(null));
  }

  #point(event) {
    if (!event || this.samples.length === 0) this.at = null;
    else {
      const box = this.svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * WIDTH;
      const [from, to] = this.range;
      const wanted = from + ((x - LEFT) / (WIDTH - LEFT - RIGHT)) * (to - from);
      this.at = this.samples.reduce((best, one) => (Math.abs(one.time_s - wanted) < Math.abs(best.time_s - wanted) ? one : best));
    }
    this.#values();
  }

  #values() {
    const shownAt = this.at ?? this.samples.at(-1);
    this.lines.forEach(({ name }, index) => text(this.values[index], shownAt ? this.format(shownAt[name]) : "–"));
    text(this.when, this.at ? `at ${time(this.at.time_s)}` : "");
    if (this.at && this.x) {
      const x = this.x(this.at.time_s);
      this.cursor.setAttribute("x1", x);
      this.cursor.setAttribute("x2", x);
    }
    this.cursor.setAttribute("visibility", this.at ? "visible" : "hidden");
  }

  update(samples) {
    this.samples = samples;
    const to = samples.at(-1)?.time_s ?? 0;
    const from = Math.min(samples[0]?.time_s ?? 0, to - 30);
    this.range = [from, to];
    const values = samples.flatMap((one) => this.lines.map(({ name }) => one[name])).filter(Number.isFinite);
    const highest = Math.max(0, ...values) || 1;
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
    this.lines.forEach(({ name }, index) => {
      let isOpen = false;
      const path = samples.map((one) => {
        if (!Number.isFinite(one[name])) return (isOpen = false), "";
        const point = `${isOpen ? "L" : "M"}${this.x(one.time_s).toFixed(1)} ${y(one[name]).toFixed(1)}`;
        isOpen = true;
        return point;
      });
      this.paths[index].setAttribute("d", path.join(""));
    });
    this.#values();
  }
}
